#pragma once
#include <strainwave/field.hpp>

namespace strainwave::sensor {

template <class S>
struct FirstOrder {
    S time_constant{1e-3};

    static constexpr auto name = "first_order";
    static constexpr auto source = "definition; speed sensors of first order: " SW_ACTUATOR_PAPER;
    static constexpr auto doc = R"(
        Sensor with a lag of first order.

        .. math:: \tau \dot y = x - y

        with tau = time_constant. At the start of a run the sensor has settled.

        >>> from strainwave.sensor import FirstOrder
        >>> FirstOrder(time_constant=2e-3).time_constant
        0.002)";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_REQUIRED(m, time_constant, "s", "Time constant tau", smallest));
    }

    struct State {
        S shown{0.0};

        template <class Self, class Visit>
        static constexpr void fields(Self& m, Visit&& visit) {
            visit(SW_FIELD(m, shown, "1", "Reading, in the unit of the measured quantity"));
        }
    };

    constexpr S shown(const State& x, const S&) const { return x.shown; }
    constexpr State rate(const State& x, const S& value) const { return {(value - x.shown) / time_constant}; }
    constexpr State relaxation_rate() const { return {S(1.0) / time_constant}; }
    constexpr State steady_state(const S& value) const { return {value}; }
};

}  // namespace strainwave::sensor
