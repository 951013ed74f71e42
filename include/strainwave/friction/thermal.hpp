#pragma once
#include <strainwave/compiled.hpp>
#include <strainwave/friction/coulomb.hpp>

namespace strainwave::friction {

template <class S, class Law_ = Coulomb<S>>
struct Thermal {
    using Law = Law_;

    Law law{};
    S dry_fall{0.0};
    S viscous_fall{0.0};
    S reference_temperature{room_temperature};

    static constexpr auto name = "thermal";
    static constexpr auto source = "exponential fall of lubricant viscosity with temperature (Reynolds1886); rates: the user's";
    static constexpr auto doc = R"(
        Friction that falls exponentially with the temperature.

        .. math:: F_{dry} \propto e^{-\kappa_d (T - T_0)}, \qquad F_{viscous} \propto e^{-\kappa_v (T - T_0)}

        with T the temperature, T_0 = reference_temperature, kappa_d = dry_fall, kappa_v = viscous_fall, law the friction at
        T_0. The factors multiply its dry levels (Coulomb, breakaway) and its viscous torque. No catalogue gives the rates;
        identify them. For the viscous part 0.02 to 0.03 per kelvin is an order of magnitude (assumed). Valid over some tens of
        kelvin. Leaves out the heat of friction: the temperature is an input.

        >>> from strainwave.friction import Coulomb, Thermal
        >>> law = Thermal(law=Coulomb(coulomb=0.0, viscous=0.01), viscous_fall=0.025, reference_temperature=293.15)
        >>> round(float(law.steady(10.0, temperature=333.15)), 9)
        0.036787944)";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_PART(m, law, "Friction law at the reference temperature"));
        visit(SW_FIELD(m, dry_fall, "1/K", "Relative fall kappa_d of dry friction per kelvin"));
        visit(SW_FIELD(m, viscous_fall, "1/K", "Relative fall kappa_v of viscous friction per kelvin"));
        visit(SW_FIELD(m, reference_temperature, "K", "Temperature T_0 at which the law was measured", smallest));
    }

    using State = typename Law::State;

    /// Factors of friction at its temperature.
    struct Modulator {
        S dry_fall, viscous_fall, reference_temperature;

        constexpr Factors<S> factors(const Contact<S>& contact) const {
            const S warmer = contact.temperature - reference_temperature;
            const S dry = fallen(dry_fall * warmer);
            return {dry, dry, fallen(viscous_fall * warmer)};
        }

    private:
        static constexpr S fallen(const S& exponent) { return exp(clip(-exponent, S(-beyond_digits), S(beyond_digits))); }
    };
    constexpr Modulator modulator() const { return {dry_fall, viscous_fall, reference_temperature}; }

    constexpr auto compile() const { return Modulated<S, decltype(compiled(law)), Modulator>{modulator(), compiled(law)}; }

    constexpr Contact<S> modulated(const Contact<S>& contact) const { return contact.scaled(modulator().factors(contact)); }
};

}  // namespace strainwave::friction
