#pragma once
#include <strainwave/field.hpp>
#include <strainwave/math.hpp>

namespace strainwave::load {

template <class S>
struct Pendulum {
    S inertia{0.01};
    S gravity_torque{0.0};
    S gravity_phase{0.0};

    static constexpr auto name = "pendulum";
    static constexpr auto source = "definition";
    static constexpr auto doc = R"(
        Unbalanced arm on a horizontal output shaft.

        .. math:: T_{load} = m g l \sin(\theta_{out} + \varphi)

        with m g l = gravity_torque, phi = gravity_phase: it hangs down at theta_out = -phi. phi is the offset of an encoder
        whose zero is not the lowest place.

        >>> from strainwave.loads import Pendulum
        >>> Pendulum(inertia=0.5, gravity_torque=15.0).gravity_torque
        15.0)";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_FIELD(m, inertia, "kg.m2", "Inertia about the output axis", smallest));
        visit(SW_FIELD(m, gravity_torque, "N.m", "Weight times distance of the centre of mass", 0));
        visit(SW_FIELD(m, gravity_phase, "rad", "Angle phi from hanging down to theta_out = 0"));
    }

    constexpr S torque(const S& angle, const S&) const { return gravity_torque * sin(angle + gravity_phase); }
    constexpr S steepest() const { return gravity_torque; }
};

}  // namespace strainwave::load
