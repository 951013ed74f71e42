#pragma once
#include <strainwave/motor/cogging.hpp>
#include <strainwave/motor/rotor.hpp>
#include <strainwave/motor/winding.hpp>

namespace strainwave::motor {

template <class S>
struct DC {
    S resistance{1.0};
    S inductance{0.0};
    S torque_constant{0.05};
    S back_emf{0.05};
    S inertia{1e-5};
    S brush_drop{0.0};
    S resistance_rise{0.0};
    S cogging_torque{0.0};
    S cogging_order{24.0};

    static constexpr auto name = "dc";
    static constexpr auto actuation = "voltage";
    static constexpr auto source = SW_POSITION_ARTICLE ", armature equation u = R i + L di/dt + K_b omega";
    static constexpr auto doc = R"(
        Armature-controlled DC motor.

        .. math:: L \dot i = u - R i - K_b \omega - V_b \operatorname{sgn} i, \qquad \tau = K_m i + \tau_c \sin(n \theta), \qquad
                  R = R_0\,(1 + \alpha\,(T - 293.15\,\mathrm{K}))

        with u the voltage, omega the input speed, T the temperature of the winding, R_0 = resistance, L = inductance, K_m =
        torque_constant, K_b = back_emf, V_b = brush_drop, alpha = resistance_rise (0.00393 per kelvin for copper). With
        inductance = 0 the current follows at once, as the article assumes: i = (u - K_b omega) / R. With a brush drop no
        current flows while abs(u - K_b omega) does not exceed it. A brush drop needs inductance = 0. If K_b exceeds K_m the
        difference counts as a loss, as iron losses do, but only while the motor drives. A motor with K_b > K_m that brakes,
        and one with K_m > K_b that drives, gives more power than it takes. In SI units K_m = K_b of a motor without iron
        losses. tau_c = cogging_torque, n = cogging_order, theta = the input angle; the energy of cogging is stored, not lost.
        Leaves out limits of the supply: see BrushlessDC. For a motor whose amplifier controls the current use CurrentSource.

        >>> from strainwave.motor import DC
        >>> DC(resistance=2.0, torque_constant=0.05, back_emf=0.05).torque_constant
        0.05)";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_FIELD(m, resistance, "Ohm", "Armature resistance R_0 at 20 degC", smallest));
        visit(SW_FIELD(m, inductance, "H", "Armature inductance L; 0 lets the current follow at once", 0));
        visit(SW_FIELD(m, torque_constant, "N.m/A", "Torque per current K_m", 0));
        visit(SW_FIELD(m, back_emf, "V.s/rad", "Back-electromotive force per speed K_b", 0));
        visit(SW_FIELD(m, inertia, "kg.m2", "Rotor inertia", 0));
        visit(SW_FIELD(m, brush_drop, "V", "Voltage V_b that the brushes take from any current", 0));
        visit(SW_FIELD(m, resistance_rise, "1/K", "Relative rise alpha of the resistance per kelvin", 0));
        visit(SW_OPTIONAL(m, cogging_torque, "N.m", "Amplitude tau_c of the cogging", 0));
        visit(SW_OPTIONAL(m, cogging_order, "1", "Periods n of the cogging per input revolution", 1, 1e4, true));
    }

    constexpr const char* problem() const {
        return all((brush_drop == S(0.0)) | (inductance == S(0.0)))
                   ? nullptr
                   : "a brush_drop needs inductance = 0: with both, the current would stick at 0";
    }

    struct State {
        S current{0.0};

        template <class Self, class Visit>
        static constexpr void fields(Self& m, Visit&& visit) {
            visit(SW_FIELD(m, current, "A", "Armature current, a state if there is an inductance"));
        }
    };

    struct Output {
        S current, voltage;

        template <class Self, class Visit>
        static constexpr void fields(Self& m, Visit&& visit) {
            visit(SW_FIELD(m, current, "A", "Motor current"));
            visit(SW_FIELD(m, voltage, "V", "Motor voltage"));
        }
    };

    /// The motor with its divisions done.
    struct Compiled {
        using State = typename DC::State;
        using Output = typename DC::Output;
        Winding<S> winding;
        S per_inductance, torque_constant, back_emf, inertia, brush_drop;
        bool has_brush_drop;
        CoggingTorque<S> cogging;

        constexpr S torque(const State& x, const S& voltage, const Rotor<S>& rotor) const {
            return cogging.added_to(torque_constant * current(x, voltage, rotor), rotor.angle);
        }
        constexpr S current(const State& x, const S& voltage, const Rotor<S>& rotor) const {
            S driving = voltage - back_emf * rotor.speed;
            if (has_brush_drop) driving = driving - clip(driving, -brush_drop, brush_drop);
            return select(per_inductance > S(0.0), x.current, driving * winding.conductance_at(rotor.temperature));
        }
        constexpr Output output(const State& x, const S& voltage, const Rotor<S>& rotor) const {
            return {current(x, voltage, rotor), voltage};
        }
        constexpr Power<S> power(const State& x, const S& voltage, const Rotor<S>& rotor) const {
            const S i = current(x, voltage, rotor), copper = winding.resistance_at(rotor.temperature) * i * i;
            const S of_winding = select(per_inductance > S(0.0), S(1.0) / max(per_inductance, S(smallest)), S(0.0));
            return {voltage * i, copper + brush_drop * abs(i) + (back_emf - torque_constant) * rotor.speed * i,
                    cogging.stored_with(S(0.5) * of_winding * i * i, rotor.angle)};
        }
        constexpr State rate(const State& x, const S& voltage, const Rotor<S>& rotor) const {
            return {(voltage - winding.resistance_at(rotor.temperature) * x.current - back_emf * rotor.speed) * per_inductance};
        }
        /// Relaxation rate of the current [1/s].
        constexpr State relaxation_rate() const { return {winding.resistance * per_inductance}; }
    };

    constexpr Compiled compile() const {
        const S per_inductance = select(inductance > S(0.0), S(1.0) / max(inductance, S(smallest)), S(0.0));
        return {Winding<S>::of(resistance, resistance_rise),
                per_inductance,
                torque_constant,
                back_emf,
                inertia,
                brush_drop,
                is_differentiated(brush_drop) || any(brush_drop > S(0.0)),
                CoggingTorque<S>::of(cogging_torque, cogging_order)};
    }

    // The same, for a motor that is not compiled.
    constexpr S torque(const State& x, const S& voltage, const Rotor<S>& rotor) const {
        return compile().torque(x, voltage, rotor);
    }
    constexpr S current(const State& x, const S& voltage, const Rotor<S>& rotor) const {
        return compile().current(x, voltage, rotor);
    }
    constexpr Output output(const State& x, const S& voltage, const Rotor<S>& rotor) const {
        return compile().output(x, voltage, rotor);
    }
    constexpr Power<S> power(const State& x, const S& voltage, const Rotor<S>& rotor) const {
        return compile().power(x, voltage, rotor);
    }
    constexpr State rate(const State& x, const S& voltage, const Rotor<S>& rotor) const {
        return compile().rate(x, voltage, rotor);
    }
    constexpr State relaxation_rate() const { return compile().relaxation_rate(); }
};

}  // namespace strainwave::motor
