#pragma once
#include <strainwave/motor/phases.hpp>
#include <strainwave/motor/rotor.hpp>
#include <strainwave/motor/winding.hpp>
#include <strainwave/motor/winding_sets.hpp>

namespace strainwave::motor {

template <class S>
struct PMSM {
    S resistance{0.5};
    S direct_inductance{1e-3};
    S quadrature_inductance{1e-3};
    S flux_linkage{0.01};
    S pole_pairs{4.0};
    S inertia{1e-5};
    S supply_voltage{48.0};
    S current_limit{10.0};
    S direct_current{0.0};
    S cogging_torque{0.0};
    S cogging_order{24.0};
    S current_offset{0.0};
    S resistance_rise{0.0};
    S phase_resistance_excess{0.0};
    S dead_time_voltage{0.0};
    S dead_time_current{0.1};
    S open_share{0.0};
    S shorted_share{0.0};

    static constexpr auto name = "pmsm";
    static constexpr auto actuation = "voltage";
    static constexpr auto source =
        "PillayKrishnan1989, eqs. (1)-(7), in amplitudes; dead time: JeongPark1991; the uneven phase is the same equations with "
        "three "
        "resistances, a short-circuited winding set at steady speed those without voltage; limits of the inverter and their order "
        "of precedence are ours";
    static constexpr auto doc = R"(
        Permanent-magnet synchronous motor in the frame of its rotor, with a field-oriented inverter.

        .. math:: L_d \dot i_d = u_d - R i_d + p \omega L_q i_q, \qquad
                  L_q \dot i_q = u_q - R i_q - p \omega\,(L_d i_d + \psi), \\
                  \tau = \tfrac{3}{2} p\,(\psi i_q + (L_d - L_q) i_d i_q) + \tau_c \sin(n \theta)

        Currents and voltages are amplitudes of a phase. omega is the input speed, theta the input angle, R = resistance, L_d,
        L_q = direct_ and quadrature_inductance, psi = flux_linkage, p = pole_pairs, tau_c = cogging_torque, n = cogging_order.
        The controller gives u_q. The inverter gives u_d = R i_d0 - p omega L_q i_q, so that i_d settles at i_d0 =
        direct_current: 0 for most motors, negative for reluctance torque (if L_q exceeds L_d) or for a constant field
        weakening.

        The inverter reaches a voltage of the length U = supply_voltage / sqrt(3). u_d has precedence, and u_q is limited to
        the rest. u_q is also limited so that the length of the current does not exceed current_limit. The inverter returns the
        possible u_q to the controller. Automatic field weakening is left out: at the voltage limit the current falls. If a
        load turns the motor so fast that the inverter does not reach these voltages, the current exceeds its limit. If u_d
        alone exceeds U, u_q is 0 and the currents may oscillate without end, which an inverter that keeps the direction of its
        voltage avoids. Such a run only shows that the motor is beyond its range.

        Each sensor of a phase current may have a constant offset. In the frame of the rotor the offset turns: the controller
        measures i_q + I_o sin(p theta), I_o = current_offset, which causes a ripple of the torque. The same ripple of i_d is
        left out. The energy of cogging is stored, not lost. R rises with the temperature of the winding by resistance_rise per
        kelvin above 20 degC. Leaves out iron losses, saturation, harmonics of the flux and the switching of the inverter; and
        that an inverter can use all of its voltage at first: here i_q approaches the limit of the current with the time
        constant L_q / R.

        Two faults subtract voltages v_d, v_q from u_d and u_q. The first phase, which faces the magnets at theta = 0, has the
        resistance R + DR, DR = phase_resistance_excess. With phi = p theta:

        .. math:: v_d = \tfrac{2}{3} \Delta R \cos\varphi \; i_1, \qquad
                  v_q = -\tfrac{2}{3} \Delta R \sin\varphi \; i_1, \qquad i_1 = i_d \cos\varphi - i_q \sin\varphi

        The currents and the torque get a ripple of order 2 p. DR does not depend on the temperature. DR far above R and p
        omega L_q is an open phase: i_1 tends to 0 as 1 / DR, and two phases remain. No value of DR is an exactly open phase,
        which has one current less.

        The inverter waits between its two switches: each phase k loses dead_time_voltage against its current, which is the
        voltage of the supply times the dead time times the switching frequency. The loss is smaller in proportion below
        dead_time_current, at which the current recharges the switches within the dead time:

        .. math:: v_d = \tfrac{2}{3} \sum_k w_k \cos\varphi_k, \quad v_q = -\tfrac{2}{3} \sum_k w_k \sin\varphi_k, \quad
                  w_k = V \operatorname{clip}(i_k / i_c, \pm 1), \quad \varphi_k = \varphi - (k - 1) \tfrac{2 \pi}{3}

        V = dead_time_voltage, i_c = dead_time_current. The ripple has the order 6 p. Dead time takes no energy: the inverter
        gives less. The column voltage is the set voltage of the inverter, before these losses. The inverter measures i_q to
        limit it, so that its limits include v_q. i_d is not controlled by a measurement, and is no longer exactly i_d0. Fixed
        steps must follow the decay by 2/3 DR / L and by V / (i_c L), L being the smaller of L_d and L_q.

        A redundant winding has several equal sets of three phases, one inverter each. The numbers of the motor are those of all
        sets in parallel: currents are the sums of those of the sets, R, L_d and L_q those of a set over the number of sets. With
        the shares open_share and shorted_share of the sets lost, the rest has R / d, L_d / d, L_q / d and the limit d I of the
        current, with d = 1 - open_share - shorted_share; i_d0 and i_c are multiplied by d, too. The torque per current stays.
        The shorted sets brake, beta = shorted_share, with the torque of their steady currents,

        .. math:: \tau_b = \tfrac{3}{2} p \beta\,(\psi + (L_d - L_q) j_d)\, j_q, \qquad
                  j_q = \frac{-p \omega \psi R}{R^2 + p^2 \omega^2 L_d L_q}, \qquad j_d = \frac{p \omega L_q}{R} j_q

        which is - 3/2 beta p^2 psi^2 omega / R at low speed, and largest at p omega = R / L. Its power is heat. Leaves out the
        transient of these currents, which takes the time L / R, and the mutual inductance of the sets: as of sets in slots of
        their own.

        >>> from strainwave.motor import PMSM
        >>> motor = PMSM(flux_linkage=0.02, pole_pairs=7)
        >>> round(1.5 * motor.pole_pairs * motor.flux_linkage, 12)  # torque per current, N.m/A
        0.21)";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_FIELD(m, resistance, "Ohm", "Resistance R of a phase, at 20 degC", smallest));
        visit(SW_FIELD(m, direct_inductance, "H", "Inductance L_d along the magnets", smallest));
        visit(SW_FIELD(m, quadrature_inductance, "H", "Inductance L_q across the magnets", smallest));
        visit(SW_FIELD(m, flux_linkage, "V.s/rad", "Amplitude psi of the flux of the magnets, linked with a phase", 0));
        visit(SW_FIELD(m, pole_pairs, "1", "Pairs p of poles", 1, 1000, true));
        visit(SW_FIELD(m, inertia, "kg.m2", "Rotor inertia", 0));
        visit(SW_FIELD(m, supply_voltage, "V", "Voltage of the direct-current supply of the inverter", smallest));
        visit(SW_FIELD(m, current_limit, "A", "Largest amplitude of a phase current", smallest));
        visit(SW_FIELD(m, direct_current, "A", "Current i_d0 along the magnets"));
        visit(SW_FIELD(m, cogging_torque, "N.m", "Amplitude tau_c of the cogging", 0));
        visit(SW_FIELD(m, cogging_order, "1", "Periods n of the cogging per input revolution", 1, 1e4, true));
        visit(SW_FIELD(m, current_offset, "A", "Amplitude I_o that the current sensors add", 0));
        visit(SW_FIELD(m, resistance_rise, "1/K", "Relative rise of the resistance per kelvin", 0));
        visit(SW_OPTIONAL(m, phase_resistance_excess, "Ohm", "Excess resistance DR of one phase", 0));
        visit(SW_OPTIONAL(m, dead_time_voltage, "V", "Voltage V that a phase loses by the dead time of the inverter", 0));
        visit(SW_OPTIONAL(m, dead_time_current, "A", "Phase current i_c below which the voltage of the dead time falls", smallest));
        visit(SW_OPTIONAL(m, open_share, "1", "Share of the winding sets whose terminals are open", 0, 0.999));
        visit(SW_OPTIONAL(m, shorted_share, "1", "Share beta of the winding sets whose terminals are short-circuited", 0, 0.999));
    }

    constexpr const char* problem() const {
        if (!all(abs(direct_current) < current_limit)) return "direct_current must lie within current_limit";
        return WindingSets<S>::problem(open_share, shorted_share);
    }

    struct State {
        S quadrature_current{0.0}, direct_current{0.0};

        template <class Self, class Visit>
        static constexpr void fields(Self& m, Visit&& visit) {
            visit(SW_FIELD(m, quadrature_current, "A", "Current i_q across the magnets, which makes the torque"));
            visit(SW_FIELD(m, direct_current, "A", "Current i_d along the magnets"));
        }
    };

    struct Output {
        S current, voltage, direct_current, direct_voltage;

        template <class Self, class Visit>
        static constexpr void fields(Self& m, Visit&& visit) {
            visit(SW_FIELD(m, current, "A", "Current i_q across the magnets, which makes the torque"));
            visit(SW_FIELD(m, voltage, "V", "Voltage u_q across the magnets, as the inverter limits it"));
            visit(SW_FIELD(m, direct_current, "A", "Current i_d along the magnets"));
            visit(SW_FIELD(m, direct_voltage, "V", "Voltage u_d along the magnets"));
        }
    };

    constexpr S torque(const State& x, const S&, const Rotor<S>& rotor) const {
        const S saliency = sets().impedance(direct_inductance - quadrature_inductance) * x.direct_current;
        const S electric = S(1.5) * pole_pairs * (flux_linkage + saliency) * x.quadrature_current;
        return sets().braked(electric, [&] { return braking(rotor); }) + cogging_torque * sin(cogging_order * rotor.angle.within);
    }
    constexpr S current(const State& x, const S&, const Rotor<S>& rotor) const {
        return x.quadrature_current + current_offset * sin(pole_pairs * rotor.angle.within);
    }
    constexpr Limits<S> limits(const State& x, const Rotor<S>& rotor) const {
        const S direct = direct_voltage(x, rotor), reach = sqrt(max(length() * length() - direct * direct, S(smallest)));
        const S along = max(abs(x.direct_current), abs(settled_direct_current()));  // i_d is on its way from one to the other
        const S largest = sets().current(current_limit), others = sqrt(max(largest * largest - along * along, S(smallest)));
        const S most = driving_resistance(rotor) * others;
        const S induced = has_faults() ? back_emf(x, rotor) + fault_drop(x, rotor).across : back_emf(x, rotor);
        return Limits<S>{induced - most, induced + most}.within(reach);
    }
    constexpr Output output(const State& x, const S& asked, const Rotor<S>& rotor) const {
        return {x.quadrature_current, limits(x, rotor).limited(asked), x.direct_current, direct_voltage(x, rotor)};
    }
    constexpr Power<S> power(const State& x, const S& asked, const Rotor<S>& rotor) const {
        const S i_q = x.quadrature_current, i_d = x.direct_current;
        S supplied = limits(x, rotor).limited(asked) * i_q + direct_voltage(x, rotor) * i_d;
        S lost = driving_resistance(rotor) * (i_q * i_q + i_d * i_d);
        if (has_faults()) {
            const auto phases = phases_of(x, rotor);
            const auto kept = phases.dead_time_drop(dead_time_voltage, sets().current(dead_time_current));
            supplied = supplied - (kept.across * i_q + kept.along * i_d);
            lost = lost + S(2.0 / 3.0) * phase_resistance_excess * phases.first * phases.first;
        }
        const S magnetic = S(0.75) * sets().impedance(quadrature_inductance * i_q * i_q + direct_inductance * i_d * i_d);
        const S cogging = cogging_torque / cogging_order * cos(cogging_order * rotor.angle.within);
        return {S(1.5) * supplied, sets().braked(S(1.5) * lost, [&] { return -braking(rotor) * rotor.speed; }), magnetic + cogging};
    }
    constexpr State rate(const State& x, const S& asked, const Rotor<S>& rotor) const {
        const S resistance_now = driving_resistance(rotor), speed = pole_pairs * rotor.speed;
        S across = limits(x, rotor).limited(asked) - resistance_now * x.quadrature_current - back_emf(x, rotor);
        S along = direct_voltage(x, rotor) - resistance_now * x.direct_current +
                  speed * sets().impedance(quadrature_inductance) * x.quadrature_current;
        if (has_faults()) {
            const auto drop = fault_drop(x, rotor);
            across = across - drop.across;
            along = along - drop.along;
        }
        return {across / sets().impedance(quadrature_inductance), along / sets().impedance(direct_inductance)};
    }
    constexpr State relaxation_rate() const { return {resistance / quadrature_inductance, resistance / direct_inductance}; }
    /// Steps do not take the decay by faults exactly: it turns with the rotor.
    constexpr S fastest() const {
        const S decay = S(2.0 / 3.0) * phase_resistance_excess + dead_time_voltage / sets().current(dead_time_current);
        return S(1.0 / 2.5) * decay / sets().impedance(min(direct_inductance, quadrature_inductance));
    }

private:
    constexpr bool has_faults() const {
        return is_differentiated(phase_resistance_excess) || is_differentiated(dead_time_voltage) ||
               any(max(phase_resistance_excess, dead_time_voltage) > S(0.0));
    }
    constexpr Phases<S> phases_of(const State& x, const Rotor<S>& rotor) const {
        return Phases<S>::of(x.direct_current, x.quadrature_current, pole_pairs * rotor.angle.within);
    }
    constexpr RotorVoltage<S> fault_drop(const State& x, const Rotor<S>& rotor) const {
        const auto phases = phases_of(x, rotor);
        return phases.resistance_drop(phase_resistance_excess) +
               phases.dead_time_drop(dead_time_voltage, sets().current(dead_time_current));
    }
    constexpr WindingSets<S> sets() const { return WindingSets<S>::of(open_share, shorted_share); }
    constexpr S driving_resistance(const Rotor<S>& rotor) const {
        return sets().impedance(winding().resistance_at(rotor.temperature));
    }
    constexpr S settled_direct_current() const { return sets().current(direct_current); }
    /// Torque [N.m] of all sets at a steady speed, if all were short-circuited.
    constexpr S braking(const Rotor<S>& rotor) const {
        const S speed = pole_pairs * rotor.speed, resistance_now = winding().resistance_at(rotor.temperature);
        const S square = resistance_now * resistance_now + speed * speed * direct_inductance * quadrature_inductance;
        const S across = -speed * flux_linkage * resistance_now / square;
        const S along = speed * quadrature_inductance / resistance_now * across;
        return S(1.5) * pole_pairs * (flux_linkage + (direct_inductance - quadrature_inductance) * along) * across;
    }
    constexpr Winding<S> winding() const { return Winding<S>::of(resistance, resistance_rise); }
    /// The longest voltage that the inverter can give, V.
    constexpr S length() const { return supply_voltage * S(0.57735026918962576); }
    constexpr S back_emf(const State& x, const Rotor<S>& rotor) const {
        return pole_pairs * rotor.speed * (sets().impedance(direct_inductance) * x.direct_current + flux_linkage);
    }
    constexpr S direct_voltage(const State& x, const Rotor<S>& rotor) const {
        const S wanted = driving_resistance(rotor) * settled_direct_current() -
                         pole_pairs * rotor.speed * sets().impedance(quadrature_inductance) * x.quadrature_current;
        return clip(wanted, -length(), length());
    }
};

}  // namespace strainwave::motor
