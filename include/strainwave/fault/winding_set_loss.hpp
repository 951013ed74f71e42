#pragma once
#include <strainwave/fault/fault.hpp>

namespace strainwave::fault {

/// State of the terminals of a winding set that no longer drives.
enum class Terminals { open, shorted };
constexpr Array<const char*, 2> choices(Terminals) { return {{"open", "shorted"}}; }

template <class S>
struct WindingSetLoss {
    S severity{1.0};
    S sets{2.0};
    Terminals terminals{Terminals::open};

    static constexpr auto name = "winding_set_loss";
    static constexpr auto mode = "Loss of one winding set of a redundant motor";
    static constexpr auto effect = "the other sets carry the current, at more resistance and a lower limit; a shorted set brakes";
    static constexpr auto signal =
        "ratio of voltage to current at low speed, largest torque; of a shorted set, current in proportion to low speed";
    static constexpr auto source = "Kirchhoff's laws of equal winding sets in parallel, without mutual inductance";
    static constexpr auto doc = R"(
        Loss of one of several equal three-phase winding sets on one shaft, whose terminals are open or short-circuited.

        .. math:: \beta \leftarrow \beta + \frac{s}{n}

        with s = severity, n = sets, beta the open_share of the motor, or its shorted_share if the ``terminals`` are shorted.
        The numbers of the motor are those of all sets in parallel. An inverter that has failed leaves its set open or
        short-circuits it. Severity 1 is the whole set, less is that share of its parallel coils.

        >>> from strainwave.fault import Facts, WindingSetLoss
        >>> WindingSetLoss(sets=2, terminals="shorted").changes(Facts())[0][:4]
        ('motor', 'shorted_share', 'add', 0.5))";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_FIELD(m, severity, "1", "Share s of the set that is lost", 0, 1));
        visit(SW_FIELD(m, sets, "1", "Number n of equal winding sets", 2, 100, true));
        visit(SW_FIELD(m, terminals, "1", "Terminals of the set that is lost"));
    }

    template <class Visit>
    constexpr void changes(const Facts<S>&, Visit&& visit) const {
        visit(add(motor_place, terminals == Terminals::open ? "open_share" : "shorted_share", severity / sets, "pmsm"));
    }
};

}  // namespace strainwave::fault
