#pragma once
#include <strainwave/fault/fault.hpp>

namespace strainwave::fault {

template <class S>
struct Cogging {
    S severity{1.0};
    S torque{5e-3};

    static constexpr auto name = "cogging";
    static constexpr auto mode = "Cogging of the motor";
    static constexpr auto effect = "torque of magnets on teeth, which the motor must overcome";
    static constexpr auto signal = "the order cogging_order of the input in motor current, without load too, at low speed most";
    static constexpr auto source = "definition; the torque at severity 1 is assumed";
    static constexpr auto doc = R"(
        Increased cogging, for example from a rotor off its axis or a displaced magnet.

        .. math:: \tau_c \leftarrow \tau_c + s\, \Delta\tau

        with s = severity, Delta tau = torque, tau_c the cogging_torque of the motor. The motor determines the order: set its
        cogging_order, the least common multiple of its poles and its slots, or 1 for a rotor off its axis. Sources of torque or
        motion have no cogging.

        >>> from strainwave.fault import Cogging, Facts
        >>> Cogging(severity=0.5).changes(Facts())[0][:4]
        ('motor', 'cogging_torque', 'add', 0.0025))";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_FIELD(m, severity, "1", "Share s of the torque", 0, 1));
        visit(SW_FIELD(m, torque, "N.m", "Amplitude Delta tau that the cogging gains at severity 1", 0));
    }

    template <class Visit>
    constexpr void changes(const Facts<S>&, Visit&& visit) const {
        visit(add(motor_place, "cogging_torque", severity * torque, "brushless_dc"));
    }
};

}  // namespace strainwave::fault
