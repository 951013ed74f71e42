#pragma once
#include <strainwave/fault/fault.hpp>

namespace strainwave::fault {

template <class S>
struct LinkagePlay {
    S severity{1.0};
    S play{5e-4};

    static constexpr auto name = "linkage_play";
    static constexpr auto mode = "Play in the linkage between gear and load";
    static constexpr auto effect = "play in series with the spring of the gear, at the output";
    static constexpr auto signal = "lost motion of the load; blows at reversals; limit cycles of a loop closed at the output";
    static constexpr auto source = "definition: play in series with a spring; its amount is assumed";
    static constexpr auto doc = R"(
        Play of a worn joint, key or coupling between the gear and its load.

        .. math:: c \leftarrow c + s\, \Delta c

        with s = severity, Delta c = play, c the clearance in series with the spring of the gear. At severity 1 the play at the
        output has grown by Delta c. The inertia between gear and linkage is left out: play of the linkage and play of the
        teeth then are one number, and no measurement at input and load separates them. An encoder on the output shaft of the
        gear, before the linkage, separates them; the model has its output encoder at the load. Hysteresis and damping of the
        gear also act within the play.

        >>> from strainwave.fault import Facts, LinkagePlay
        >>> LinkagePlay(severity=0.5).changes(Facts())[0][:4]
        ('gear.stiffness', 'clearance', 'add', 0.00025))";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_FIELD(m, severity, "1", "Share s of the play", 0, 1));
        visit(SW_FIELD(m, play, "rad", "Play Delta c at the output, from flank to flank, at severity 1", 0));
    }

    template <class Visit>
    constexpr void changes(const Facts<S>&, Visit&& visit) const {
        visit(add(spring_place, "clearance", severity * play, "backlash"));
    }
};

}  // namespace strainwave::fault
