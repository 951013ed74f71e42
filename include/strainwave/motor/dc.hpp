#pragma once
#include <strainwave/field.hpp>
#include <strainwave/math.hpp>

namespace strainwave::motor {

template <class S>
struct DC {
    S resistance{1.0};
    S inductance{0.0};
    S torque_constant{0.05};
    S back_emf{0.05};
    S inertia{1e-5};

    static constexpr auto name = "dc";
    static constexpr auto actuation = "voltage";
    static constexpr auto source = "document P, armature equation u = R i + L di/dt + K_b omega";
    static constexpr auto doc = R"(
        Armature-controlled DC motor.

        .. math:: L \dot i = u - R i - K_b \omega, \qquad \tau = K_m i

        with u the voltage, omega the input speed, R = resistance, L = inductance, K_m = torque_constant, K_b = back_emf. With
        inductance = 0 the current follows at once, i = (u - K_b omega) / R, as document P assumes. Leaves out cogging, iron
        losses, saturation and the warming of the winding. A motor whose current is controlled by its amplifier
        is a CurrentSource.

        >>> from strainwave.motor import DC
        >>> DC(resistance=2.0, torque_constant=0.05, back_emf=0.05).torque_constant
        0.05)";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_FIELD(m, resistance, "Ohm", "Armature resistance R", smallest));
        visit(SW_FIELD(m, inductance, "H", "Armature inductance L; 0 lets the current follow at once", 0));
        visit(SW_FIELD(m, torque_constant, "N.m/A", "Torque per current K_m", 0));
        visit(SW_FIELD(m, back_emf, "V.s/rad", "Back-electromotive force per speed K_b", 0));
        visit(SW_FIELD(m, inertia, "kg.m2", "Rotor inertia", 0));
    }

    struct State {
        S current{0.0};

        template <class Self, class Visit>
        static constexpr void fields(Self& m, Visit&& visit) {
            visit(SW_FIELD(m, current, "A", "Armature current, where the inductance gives it a life of its own"));
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

    constexpr S torque(const State& x, const S& voltage, const S& speed) const { return compile().torque(x, voltage, speed); }
    constexpr S current(const State& x, const S& voltage, const S& speed) const { return compile().current(x, voltage, speed); }
    constexpr Output output(const State& x, const S& voltage, const S& speed) const { return compile().output(x, voltage, speed); }
    constexpr State rate(const State& x, const S& voltage, const S& speed) const { return compile().rate(x, voltage, speed); }
    /// How fast the current relaxes [1/s].
    constexpr State relaxation_rate() const { return compile().relaxation_rate(); }

    /// The same motor with its divisions done.
    struct Compiled {
        using State = typename DC::State;
        using Output = typename DC::Output;
        S resistance, conductance, per_inductance, torque_constant, back_emf, inertia;

        constexpr S torque(const State& x, const S& voltage, const S& speed) const {
            return torque_constant * current(x, voltage, speed);
        }
        constexpr S current(const State& x, const S& voltage, const S& speed) const {
            return select(per_inductance > S(0.0), x.current, (voltage - back_emf * speed) * conductance);
        }
        constexpr Output output(const State& x, const S& voltage, const S& speed) const {
            return {current(x, voltage, speed), voltage};
        }
        constexpr State rate(const State& x, const S& voltage, const S& speed) const {
            return {(voltage - resistance * x.current - back_emf * speed) * per_inductance};
        }
        constexpr State relaxation_rate() const { return {resistance * per_inductance}; }
    };

    constexpr Compiled compile() const {
        const S per_inductance = select(inductance > S(0.0), S(1.0) / max(inductance, S(smallest)), S(0.0));
        return {resistance, S(1.0) / resistance, per_inductance, torque_constant, back_emf, inertia};
    }
};

}  // namespace strainwave::motor
