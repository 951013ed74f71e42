#pragma once
#include <strainwave/control/reference.hpp>
#include <strainwave/field.hpp>

namespace strainwave::control {

template <class S>
struct OpenLoop {
    S gain{1.0};

    static constexpr auto name = "open_loop";
    static constexpr auto command_unit = "V";
    static constexpr auto source = "definition";
    static constexpr auto doc = R"(
        No controller: the command, times a gain, is the motor's voltage.

        .. math:: u = g r

        with r the command [V], g = gain (an amplifier's).

        >>> from strainwave.control import OpenLoop
        >>> OpenLoop().gain
        1.0)";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_FIELD(m, gain, "1", "Voltage per command"));
    }

    using State = Stateless<S>;

    constexpr S voltage(const State&, const Reference<S>& reference) const { return gain * reference.command; }
    constexpr State rate(const State&, const Reference<S>&) const { return {}; }
};

}  // namespace strainwave::control
