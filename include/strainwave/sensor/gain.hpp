#pragma once
#include <strainwave/field.hpp>

namespace strainwave::sensor {

template <class S>
struct Gain {
    S gain{1.0};
    S offset{0.0};

    static constexpr auto name = "gain";
    static constexpr auto source = "definition; current sensors of order zero: " SW_ACTUATOR_PAPER;
    static constexpr auto doc = R"(
        Sensor with a gain and an offset, without lag.

        .. math:: y = g x + y_0

        with g = gain, y_0 = offset.

        >>> from strainwave.sensor import Gain
        >>> Gain(gain=1.02, offset=0.05).gain
        1.02)";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_FIELD(m, gain, "1", "Reading per true value"));
        visit(SW_FIELD(m, offset, "1", "Reading at the true value 0, in the unit of the measured quantity"));
    }

    using State = Stateless<S>;

    constexpr S shown(const State&, const S& value) const { return gain * value + offset; }
    constexpr State rate(const State&, const S&) const { return {}; }
    constexpr State relaxation_rate() const { return {}; }
    constexpr State steady_state(const S&) const { return {}; }
};

}  // namespace strainwave::sensor
