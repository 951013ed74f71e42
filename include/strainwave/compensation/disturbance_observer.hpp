#pragma once
#include <strainwave/compensation/compensator.hpp>

namespace strainwave::compensation {

template <class S>
struct DisturbanceObserver {
    S inertia{1e-4};
    S bandwidth{100.0};
    S limit{1.0};
    S torque_constant{0.0};

    static constexpr auto name = "disturbance_observer";
    static constexpr auto source = "OhnishiShibataMurakami1996; SariyildizOboeOhnishi2020, with a low-pass filter of first order";
    static constexpr auto doc = R"(
        Observer of the torque that the drive needs beyond what controller and model expect, and gives at once.

        .. math:: \hat d = \frac{g}{s + g}\,\big(\tau - \tau_f - J s\,(\omega - \omega_r)\big), \qquad
                  \tau \leftarrow \tau + \operatorname{clip}(\hat d, \pm d_{max})

        with tau the torque of the motor, tau_f what is fed forward, omega the input speed, omega_r the commanded one, J = inertia of
        all that turns with the input, g = bandwidth, d_max = limit. Without a model it supplies friction, load and the torque of
        acceleration; with one, what the model lacks. The filter is exact for what is constant over a period.

        tau is what the motor is given, or, with a torque_constant, that times the current measured: for a Cascade, whose actuation
        is a voltage. What a law of control feeds forward by gains of its own is not in tau_f, so the observer supplies it once
        more: set viscous_feedforward and coulomb_feedforward of the law to 0, and let the compensation have the friction. With a
        period T and a real inertia J_r of what turns, the observer alone is stable if g T J / J_r < 2; above the vibration of the
        load, J_r is the inertia of the input. A bandwidth near that vibration makes it grow.

        >>> from strainwave.compensation import DisturbanceObserver
        >>> DisturbanceObserver(inertia=2e-4, bandwidth=150.0, limit=0.3).bandwidth
        150.0)";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_REQUIRED(m, inertia, "kg.m2", "Inertia J at the input: rotor, wave generator, and load over ratio squared",
                          smallest));
        visit(SW_FIELD(m, bandwidth, "rad/s", "Bandwidth g of the filter", smallest));
        visit(SW_REQUIRED(m, limit, "N.m", "Largest torque that it adds", 0));
        visit(SW_FIELD(m, torque_constant, "N.m/A", "Torque per current measured; 0: by what the motor is given", 0));
    }

    struct State {
        S filtered{0.0};

        template <class Self, class Visit>
        static constexpr void fields(Self& m, Visit&& visit) {
            visit(SW_FIELD(m, filtered, "N.m", "Torque and momentum through the filter"));
        }
    };

    constexpr Request<S> request(const State& x, const Inputs<S>& inputs) const {
        return {S(0.0), S(0.0), S(0.0), clip(x.filtered - momentum(inputs), -limit, limit), S(0.0)};
    }
    constexpr State advance(const State& x, const Inputs<S>& inputs, const Request<S>&, const S& motor_torque,
                            const S& period) const {
        const S known = select(torque_constant > S(0.0), torque_constant * inputs.measured.current, motor_torque);
        const S kept = exp(-min(bandwidth * period, S(beyond_digits))), towards = known - inputs.request.torque + momentum(inputs);
        return {towards + kept * (x.filtered - towards)};
    }

private:
    /// Bandwidth times the momentum of the speed error [N.m].
    constexpr S momentum(const Inputs<S>& inputs) const {
        return bandwidth * inertia * (inputs.measured.input_speed - inputs.input_speed());
    }
};

}  // namespace strainwave::compensation
