#pragma once
#include <strainwave/field.hpp>
#include <strainwave/math.hpp>

namespace strainwave::load {

template <class S>
struct TorsionSpring {
    S inertia{0.01};
    S stiffness{0.0};
    S damping{0.0};
    S rest_angle{0.0};

    static constexpr auto name = "torsion_spring";
    static constexpr auto source = "definition";
    static constexpr auto doc = R"(
        Body on a spring and a damper to the housing.

        .. math:: T_{load} = k\,(\theta_{out} - \theta_0) + c\,\omega_{out}

        with k = stiffness, c = damping, theta_0 = rest_angle.

        >>> from strainwave.loads import TorsionSpring
        >>> TorsionSpring(inertia=0.05, stiffness=200.0).rest_angle
        0.0)";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_FIELD(m, inertia, "kg.m2", "Inertia about the output axis", smallest));
        visit(SW_FIELD(m, stiffness, "N.m/rad", "Torque per angle k", 0));
        visit(SW_FIELD(m, damping, "N.m.s/rad", "Torque per speed c", 0));
        visit(SW_FIELD(m, rest_angle, "rad", "Angle theta_0 at which the spring is relaxed"));
    }

    constexpr S torque(const S& angle, const S& speed) const { return stiffness * (angle - rest_angle) + damping * speed; }
    constexpr S steepest() const { return stiffness; }
};

}  // namespace strainwave::load
