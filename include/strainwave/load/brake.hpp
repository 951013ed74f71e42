#pragma once
#include <strainwave/field.hpp>
#include <strainwave/math.hpp>

namespace strainwave::load {

template <class S>
struct Brake {
    S inertia{0.01};
    S breakaway_ratio{1.0};

    static constexpr auto name = "brake";
    static constexpr auto source = "definition: dry friction of a commanded level, set-valued at rest";
    static constexpr auto doc = R"(
        Friction brake on the output shaft, as of a load rig.

        .. math:: T_{load} = B(t) \operatorname{sgn} \omega_{out} \quad (\omega_{out} \ne 0), \qquad
                  |T_{load}| \le \kappa B(t) \quad (\omega_{out} = 0)

        with B(t) the run's input brake_torque [N.m], kappa = breakaway_ratio. A negative B counts as 0. The brake sticks
        exactly. While the shaft sticks, the torques of the brake and of friction at the output of the gear are not determined
        separately: each is reported in proportion to its breakaway torque.

        >>> from strainwave.loads import Brake
        >>> Brake(inertia=0.02).breakaway_ratio
        1.0)";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_FIELD(m, inertia, "kg.m2", "Inertia about the output axis", smallest));
        visit(SW_FIELD(m, breakaway_ratio, "1", "Brake torque at rest over brake torque in motion", 1));
    }

    /// The input that this load takes.
    static constexpr Field input{"brake_torque", "N.m", "Torque with which the brake resists motion", 0};

    constexpr S torque(const S&, const S&) const { return S(0.0); }
    constexpr S slip(const S& torque_asked) const { return max(torque_asked, S(0.0)); }
    constexpr S hold(const S& torque_asked) const { return breakaway_ratio * slip(torque_asked); }
};

}  // namespace strainwave::load
