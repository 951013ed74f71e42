#pragma once
#include <strainwave/field.hpp>
#include <strainwave/math.hpp>
#include <strainwave/room_temperature.hpp>

namespace strainwave::softening {

template <class S>
struct ThermalSoftening {
    S stiffness_fall{0.0};
    S hysteresis_fall{0.0};
    S reference_temperature{room_temperature};

    static constexpr auto name = "thermal_softening";
    static constexpr auto source = SW_REVIEW
        ", section on temperature, which states the direction only: the exponential form is assumed, its rates are the "
        "user's";
    static constexpr auto doc = R"(
        Stiffness and hysteresis that fall exponentially with the temperature.

        .. math:: T = e^{-\kappa_s (T_g - T_0)}\, T_{stiffness} + e^{-\kappa_h (T_g - T_0)}\, T_{hysteresis} + c\,\dot\delta

        with T_g the temperature of the gear, T_0 = reference_temperature, kappa_s = stiffness_fall, kappa_h = hysteresis_fall.
        The laws of stiffness and hysteresis are those at T_0. No catalogue gives the rates; the elastic modulus of steel falls
        by some 2e-4 to 3e-4 per kelvin (assumed). Valid over some tens of kelvin. Elastic energy that the spring loses while
        it warms up turns to heat.

        >>> from strainwave.softening import ThermalSoftening
        >>> ThermalSoftening(stiffness_fall=3e-4).stiffness_fall
        0.0003)";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_FIELD(m, stiffness_fall, "1/K", "Relative fall kappa_s of the stiffness per kelvin"));
        visit(SW_FIELD(m, hysteresis_fall, "1/K", "Relative fall kappa_h of the hysteresis per kelvin"));
        visit(SW_FIELD(m, reference_temperature, "K", "Temperature T_0 of the laws of stiffness and hysteresis", smallest));
    }

    /// True if the law has an effect, or a derivative by its parameters.
    constexpr bool active() const {
        return is_differentiated(stiffness_fall) || is_differentiated(hysteresis_fall) || any(!(stiffness_fall == S(0.0))) ||
               any(!(hysteresis_fall == S(0.0)));
    }
    /// The share of the elastic energy that turns to heat each second [1/s], where the gear warms up at `warming` [K/s].
    constexpr S dissipation_rate(const S& warming) const { return stiffness_fall * warming; }
    /// Factors of the torque of the spring and of that of the hysteresis.
    constexpr S of_stiffness(const S& temperature) const { return fallen(stiffness_fall * (temperature - reference_temperature)); }
    constexpr S of_hysteresis(const S& temperature) const {
        return fallen(hysteresis_fall * (temperature - reference_temperature));
    }

private:
    static constexpr S fallen(const S& exponent) { return exp(clip(-exponent, S(-beyond_digits), S(beyond_digits))); }
};

}  // namespace strainwave::softening
