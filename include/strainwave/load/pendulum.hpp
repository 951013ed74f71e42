#pragma once
#include <strainwave/field.hpp>
#include <strainwave/math.hpp>

namespace strainwave::load {

template <class S>
struct Pendulum {
    S inertia{0.01};
    S gravity_torque{0.0};

    static constexpr auto name = "pendulum";
    static constexpr auto source = "definition; theta_out = 0 hangs down";
    static constexpr auto doc = R"(
        An unbalanced arm on a horizontal output shaft.

        .. math:: T_{load} = m g l \sin\theta_{out}

        with m g l = gravity_torque, hanging down at theta_out = 0.

        >>> from strainwave.loads import Pendulum
        >>> Pendulum(inertia=0.5, gravity_torque=15.0).gravity_torque
        15.0)";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_FIELD(m, inertia, "kg.m2", "Inertia about the output axis", smallest));
        visit(SW_FIELD(m, gravity_torque, "N.m", "Weight times distance of the centre of mass", 0));
    }

    constexpr S torque(const S& angle, const S&) const { return gravity_torque * sin(angle); }
    constexpr S steepest() const { return gravity_torque; }
};

}  // namespace strainwave::load
