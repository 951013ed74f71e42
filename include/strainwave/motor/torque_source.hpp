#pragma once
#include <strainwave/motor/rotor.hpp>

namespace strainwave::motor {

template <class S>
struct TorqueSource {
    S inertia{1e-5};

    static constexpr auto name = "torque_source";
    static constexpr auto actuation = "motor_torque";
    static constexpr auto source = "definition";
    static constexpr auto doc = R"(
        Motor whose torque equals its command, at any speed.

        .. math:: \tau = u

        with u the actuation of the controller [N.m]. For studies of the gear alone, and for drives with an unknown motor.

        >>> from strainwave.motor import TorqueSource
        >>> TorqueSource(inertia=2e-5).inertia
        2e-05)";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_FIELD(m, inertia, "kg.m2", "Rotor inertia", 0));
    }

    using State = Stateless<S>;
    struct Output {
        S motor_torque;

        template <class Self, class Visit>
        static constexpr void fields(Self& m, Visit&& visit) {
            visit(SW_FIELD(m, motor_torque, "N.m", "Torque of the motor"));
        }
    };

    constexpr S torque(const State&, const S& asked, const Rotor<S>&) const { return asked; }
    constexpr S current(const State&, const S&, const Rotor<S>&) const { return S(0.0); }
    constexpr Output output(const State&, const S& asked, const Rotor<S>&) const { return {asked}; }
    constexpr Power<S> power(const State&, const S& asked, const Rotor<S>& rotor) const {
        return {asked * rotor.speed, S(0.0), S(0.0)};
    }
    constexpr State rate(const State&, const S&, const Rotor<S>&) const { return {}; }
    constexpr State relaxation_rate() const { return {}; }
};

}  // namespace strainwave::motor
