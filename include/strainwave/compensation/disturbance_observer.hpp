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
        Observer of the disturbance torque: its estimate is added to the torque of the motor.

        .. math:: \hat d = \frac{g}{s + g}\,\big(\tau - \tau_f - J s\,(\omega - \omega_r)\big), \qquad
                  \tau \leftarrow \tau + \operatorname{clip}(\hat d, \pm d_{max})

        with tau the torque of the motor, tau_f the feed-forward, omega the input speed, omega_r its command, J = inertia at
        the input, g = bandwidth, d_max = limit. Without a model the observer supplies friction, load and inertial torque. With
        a model it supplies the difference. The filter is exact for a torque that is constant over a period.

        tau is the actuation of the motor over actuation_per_torque. With a torque_constant it is that times the measured
        current, as a Cascade needs, whose actuation is a voltage. tau_f does not contain the torque that the law of control
        computes from its command or model. The observer would supply that torque twice. Set viscous_feedforward and
        coulomb_feedforward of the law to 0, and compensate friction by the model. Do not use the observer with
        FeedbackLinearisation or KinematicErrorTracking. The observer alone is stable if g T J / J_r < 2, with T the period and
        J_r the true inertia. Above the vibration of the load, J_r is the inertia of the input. A bandwidth near that vibration
        excites it.

        >>> from strainwave.compensation import DisturbanceObserver
        >>> DisturbanceObserver(inertia=2e-4, bandwidth=150.0, limit=0.3).bandwidth
        150.0)";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_REQUIRED(m, inertia, "kg.m2", "Inertia J at the input: rotor, wave generator, and load over ratio squared",
                          smallest));
        visit(SW_FIELD(m, bandwidth, "rad/s", "Bandwidth g of the filter", smallest));
        visit(SW_REQUIRED(m, limit, "N.m", "Largest torque that it adds", 0));
        visit(SW_FIELD(m, torque_constant, "N.m/A", "Torque per measured current; 0: the torque by the actuation", 0));
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
