#pragma once
#include <strainwave/fault/fault.hpp>

namespace strainwave::fault {

template <class S>
struct PreloadLoss {
    S severity{1.0};
    S softening{0.4};
    S play{1.5e-4};

    static constexpr auto name = "preload_loss";
    static constexpr auto mode = "Loss of preload between the splines";
    static constexpr auto effect = "stiffness at low torque falls, and the teeth lose contact around zero torque";
    static constexpr auto signal = "twist at low torque, lost motion, a lower resonance at small amplitudes";
    static constexpr auto source = "the form, a soft and free centre, is assumed; so are softening and play";
    static constexpr auto doc = R"(
        Loss of preload between the splines: the gear is soft, then has play, around zero torque.

        .. math:: k_1 \leftarrow (1 - s\, f)\, k_1, \qquad c \leftarrow c + s\, \Delta c

        with s = severity, f = softening, Delta c = play, k_1 the stiffness of the first segment of a spring: k1 of ThreeSegment
        and Piecewise, a1 of Cubic, flexspline_stiffness of MultiCompliance. A Linear spring has no such segment and gets the
        play alone. At severity 1 the first segment has lost the share f of its stiffness, and the play at the output has grown
        by Delta c. k2 of Piecewise is an increment, so the stiffness above its knee falls by as much as k1. Leaves out that
        friction falls with the preload.

        >>> from strainwave.fault import Facts, PreloadLoss
        >>> PreloadLoss(severity=0.5).changes(Facts())[0][:4]
        ('gear.stiffness', 'k1', 'scale', 0.8))";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_FIELD(m, severity, "1", "Share s of softening and play", 0, 1));
        visit(SW_FIELD(m, softening, "1", "Share f of the stiffness at low torque that is lost at severity 1", 0, 0.95));
        visit(SW_FIELD(m, play, "rad", "Play Delta c at the output, from flank to flank, at severity 1", 0));
    }

    template <class Visit>
    constexpr void changes(const Facts<S>&, Visit&& visit) const {
        constexpr Array<const char*, 3> names{{"k1", "a1", "flexspline_stiffness"}};
        for (const char* quantity : names.item) visit(scale(spring_place, quantity, S(1.0) - severity * softening));
        visit(add(spring_place, "clearance", severity * play, "backlash"));
    }
};

}  // namespace strainwave::fault
