#pragma once
#include <strainwave/motor/cogging.hpp>
#include <strainwave/motor/rotor.hpp>
#include <strainwave/motor/winding.hpp>
#include <strainwave/motor/winding_sets.hpp>

namespace strainwave::motor {

template <class S>
struct BrushlessDC {
    S resistance{1.0};
    S inductance{1e-3};
    S torque_constant{0.05};
    S inertia{1e-5};
    S supply_voltage{48.0};
    S current_limit{10.0};
    S resistance_rise{0.0};
    S cogging_torque{0.0};
    S cogging_order{24.0};
    S open_share{0.0};
    S shorted_share{0.0};

    static constexpr auto name = "brushless_dc";
    static constexpr auto actuation = "voltage";
    static constexpr auto source =
        SW_ACTUATOR_PAPER ", section Electric Motor: a brushless DC motor, simplified; the limits of amplifier and supply are ours";
    static constexpr auto doc = R"(
        Brushless DC motor as an equivalent DC motor, with the limits of its amplifier.

        .. math:: L \dot i = u - R i - K \omega, \qquad \tau = K i + \tau_c \sin(n \theta), \qquad
                  |u| \le U, \quad |u - K \omega| \le R I

        with u the voltage between the two phases that conduct, omega the input speed, R = resistance, L = inductance of those
        two phases in series, K = torque_constant, of torque and back-EMF both, U = supply_voltage, I = current_limit. The
        amplifier limits the voltage so that the current does not exceed I. It returns the possible voltage to the controller,
        whose integrals stop at this limit. R rises with the temperature of the winding by resistance_rise per kelvin above 20
        degC. If a load turns the motor faster than (U + R I) / K, the voltage of the supply is too small, and the current
        exceeds I.

        Of a redundant winding, of equal sets in parallel that one amplifier each feeds with the same voltage, the numbers are
        those of all sets together, and i is the sum of their currents. With the shares open_share and shorted_share of the
        sets lost, the rest has R / d, L / d and the limit d I, d = 1 - open_share - shorted_share, and the same K. The shorted
        sets brake with the torque shorted_share K^2 omega / R, which becomes heat. This leaves out their inductance: it is valid
        at electric frequencies below R / L, beyond which the torque of a shorted set falls, see PMSM.

        tau_c = cogging_torque, n = cogging_order, theta = the input angle; the energy of cogging is stored, not lost. Leaves
        out commutation and its ripple: see PMSM. Also leaves out that an amplifier can use all of its voltage at first: here
        the current approaches I with the time constant L / R.

        >>> from strainwave.motor import BrushlessDC
        >>> BrushlessDC(supply_voltage=24.0, current_limit=5.0).supply_voltage
        24.0)";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_FIELD(m, resistance, "Ohm", "Resistance R of two phases in series, at 20 degC", smallest));
        visit(SW_FIELD(m, inductance, "H", "Inductance L of two phases in series", smallest));
        visit(SW_FIELD(m, torque_constant, "N.m/A", "Torque per current K, and voltage per speed", 0));
        visit(SW_FIELD(m, inertia, "kg.m2", "Rotor inertia", 0));
        visit(SW_FIELD(m, supply_voltage, "V", "Largest voltage U, of either sign", smallest));
        visit(SW_FIELD(m, current_limit, "A", "Largest current I, of either sign", smallest));
        visit(SW_FIELD(m, resistance_rise, "1/K", "Relative rise of the resistance per kelvin", 0));
        visit(SW_OPTIONAL(m, cogging_torque, "N.m", "Amplitude tau_c of the cogging", 0));
        visit(SW_OPTIONAL(m, cogging_order, "1", "Periods n of the cogging per input revolution", 1, 1e4, true));
        visit(SW_OPTIONAL(m, open_share, "1", "Share of the winding sets whose terminals are open", 0, 0.999));
        visit(SW_OPTIONAL(m, shorted_share, "1", "Share of the winding sets whose terminals are short-circuited", 0, 0.999));
    }

    constexpr const char* problem() const { return WindingSets<S>::problem(open_share, shorted_share); }

    struct State {
        S current{0.0};

        template <class Self, class Visit>
        static constexpr void fields(Self& m, Visit&& visit) {
            visit(SW_FIELD(m, current, "A", "Motor current"));
        }
    };

    struct Output {
        S current, voltage;

        template <class Self, class Visit>
        static constexpr void fields(Self& m, Visit&& visit) {
            visit(SW_FIELD(m, current, "A", "Motor current"));
            visit(SW_FIELD(m, voltage, "V", "Motor voltage, as the amplifier limits it"));
        }
    };

    constexpr S torque(const State& x, const S&, const Rotor<S>& rotor) const {
        return cogging().added_to(sets().braked(torque_constant * x.current, [&] { return braking(rotor); }), rotor.angle);
    }
    constexpr S current(const State& x, const S&, const Rotor<S>&) const { return x.current; }
    constexpr Limits<S> limits(const State&, const Rotor<S>& rotor) const {
        const S induced = torque_constant * rotor.speed, most = winding().resistance_at(rotor.temperature) * current_limit;
        return Limits<S>{induced - most, induced + most}.within(supply_voltage);
    }
    constexpr Output output(const State& x, const S& asked, const Rotor<S>& rotor) const {
        return {x.current, limits(x, rotor).limited(asked)};
    }
    constexpr Power<S> power(const State& x, const S& asked, const Rotor<S>& rotor) const {
        const S i = x.current;
        const S lost = sets().braked(driving_resistance(rotor) * i * i, [&] { return -braking(rotor) * rotor.speed; });
        return {limits(x, rotor).limited(asked) * i, lost,
                cogging().stored_with(S(0.5) * driving_inductance() * i * i, rotor.angle)};
    }
    constexpr State rate(const State& x, const S& asked, const Rotor<S>& rotor) const {
        const S voltage = limits(x, rotor).limited(asked), resistance_now = driving_resistance(rotor);
        return {(voltage - resistance_now * x.current - torque_constant * rotor.speed) / driving_inductance()};
    }
    constexpr State relaxation_rate() const { return {resistance / inductance}; }

private:
    constexpr CoggingTorque<S> cogging() const { return CoggingTorque<S>::of(cogging_torque, cogging_order); }
    constexpr Winding<S> winding() const { return Winding<S>::of(resistance, resistance_rise); }
    constexpr WindingSets<S> sets() const { return WindingSets<S>::of(open_share, shorted_share); }
    constexpr S driving_resistance(const Rotor<S>& rotor) const {
        return sets().impedance(winding().resistance_at(rotor.temperature));
    }
    constexpr S driving_inductance() const { return sets().impedance(inductance); }
    /// Torque [N.m] of all sets, if all were short-circuited.
    constexpr S braking(const Rotor<S>& rotor) const {
        return -torque_constant * torque_constant * rotor.speed * winding().conductance_at(rotor.temperature);
    }
};

}  // namespace strainwave::motor
