#pragma once
#include <strainwave/field.hpp>

namespace strainwave::sensor {

template <class S>
struct SecondOrder {
    S natural_frequency{1000.0};
    S damping_ratio{0.7};

    static constexpr auto name = "second_order";
    static constexpr auto source = "definition; position sensors of second order: " SW_ACTUATOR_PAPER;
    static constexpr auto doc = R"(
        Sensor with the dynamics of a damped oscillator.

        .. math:: \ddot y = \omega_0^2\,(x - y) - 2 \zeta \omega_0 \dot y

        with omega_0 = natural_frequency, zeta = damping_ratio. It lags a steady motion by 2 zeta / omega_0 seconds. At the
        start of a run the sensor has settled. Steps of a fixed length must not be longer than 1 / omega_0.

        >>> from strainwave.sensor import SecondOrder
        >>> SecondOrder(natural_frequency=1200.0).damping_ratio
        0.7)";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_REQUIRED(m, natural_frequency, "rad/s", "Natural frequency omega_0", smallest));
        visit(SW_FIELD(m, damping_ratio, "1", "Damping ratio zeta", 0));
    }

    struct State {
        S shown{0.0}, rate{0.0};

        template <class Self, class Visit>
        static constexpr void fields(Self& m, Visit&& visit) {
            visit(SW_FIELD(m, shown, "1", "Reading, in the unit of the measured quantity"));
            visit(SW_FIELD(m, rate, "1/s", "Rate of the reading"));
        }
    };

    constexpr S shown(const State& x, const S&) const { return x.shown; }
    constexpr State rate(const State& x, const S& value) const {
        return {x.rate, natural_frequency * (natural_frequency * (value - x.shown) - S(2.0) * damping_ratio * x.rate)};
    }
    constexpr State relaxation_rate() const { return {S(0.0), S(2.0) * damping_ratio * natural_frequency}; }
    constexpr State steady_state(const S& value) const { return {value, S(0.0)}; }
    constexpr S fastest() const { return natural_frequency; }
};

}  // namespace strainwave::sensor
