#pragma once
#include <strainwave/control/law.hpp>

namespace strainwave::control {

template <class S>
struct OpenLoop {
    S gain{1.0};

    static constexpr auto name = "open_loop";
    static constexpr auto command_unit = "";  // that of what the motor takes
    static constexpr auto source = "definition";
    static constexpr auto doc = R"(
        No controller: the actuation of the motor is the command times a gain.

        .. math:: u = g r

        with r the command, u the voltage [V] of a DC, a BrushlessDC or a PMSM, the current [A] of a CurrentSource, the torque
        [N.m] of a TorqueSource or the acceleration [rad/s2] of an AccelerationSource, g = gain (an amplifier's). The command
        has the unit of u.

        >>> from strainwave.control import OpenLoop
        >>> OpenLoop().gain
        1.0)";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_FIELD(m, gain, "1", "Actuation per command"));
    }

    using State = Stateless<S>;

    constexpr S act(const State&, const Command<S>& command, const Measurement<S>&) const {
        return gain * command.value + command.feedforward;
    }
    constexpr State rate(const State&, const Command<S>&, const Measurement<S>&) const { return {}; }
    constexpr State relaxation_rate() const { return {}; }
};

}  // namespace strainwave::control
