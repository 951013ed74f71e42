#pragma once
#include <strainwave/motor/rotor.hpp>

namespace strainwave::motor {

template <class S>
struct AccelerationSource {
    S inertia{1e-5};

    static constexpr auto name = "acceleration_source";
    static constexpr auto actuation = "input_acceleration";
    static constexpr auto source = "definition; its torque is Newton's second law of the input shaft";
    static constexpr auto doc = R"(
        Motor that prescribes the acceleration of the input shaft, whatever torque it needs.

        .. math:: \dot\omega = u, \qquad \tau = J_{in} u + (T + F_{mesh})\,(1/i - e') + F_{in}

        with u the actuation of the controller [rad/s2], and omega the input speed. Angle and speed at the start are initial
        values of the run; InputMotion of strainwave.simulation.motion calculates both from a measured angle. The torque tau is a
        result: the torque that a motor of that inertia must give. The motion of input and output does not depend on inertia
        and friction at the input, nor on friction of the mesh. At instants of rest, set-valued friction of both is reported as
        0.

        >>> from strainwave.motor import AccelerationSource
        >>> AccelerationSource(inertia=2e-5).inertia
        2e-05)";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_FIELD(m, inertia, "kg.m2", "Rotor inertia", 0));
    }

    using State = Stateless<S>;
    struct Output {
        S input_acceleration, motor_torque;

        template <class Self, class Visit>
        static constexpr void fields(Self& m, Visit&& visit) {
            visit(SW_FIELD(m, input_acceleration, "rad/s2", "Acceleration of the input"));
            visit(SW_FIELD(m, motor_torque, "N.m", "Torque that the motor must give"));
        }
    };

    constexpr S acceleration(const S& asked) const { return asked; }
    constexpr S torque(const State&, const S&, const Rotor<S>& rotor) const { return rotor.torque; }
    constexpr S current(const State&, const S&, const Rotor<S>&) const { return S(0.0); }
    constexpr Output output(const State&, const S& asked, const Rotor<S>& rotor) const { return {asked, rotor.torque}; }
    constexpr Power<S> power(const State&, const S&, const Rotor<S>& rotor) const {
        return {rotor.torque * rotor.speed, S(0.0), S(0.0)};
    }
    constexpr State rate(const State&, const S&, const Rotor<S>&) const { return {}; }
    constexpr State relaxation_rate() const { return {}; }
};

}  // namespace strainwave::motor
