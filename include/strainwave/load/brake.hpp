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
        A friction brake on the output shaft, as of a load rig: it resists motion, and holds at rest.

        .. math:: T_{load} = B(t) \operatorname{sgn} \omega_{out} \quad (\omega_{out} \ne 0), \qquad
                  |T_{load}| \le \kappa B(t) \quad (\omega_{out} = 0)

        with B(t) the run's input brake_torque [N.m], of which a negative one counts as 0, kappa = breakaway_ratio. It sticks
        exactly. While the shaft sticks, torque that friction of the gear at the output holds besides cannot be told from the
        brake's; it is shared in proportion to what each can hold.

        >>> from strainwave.loads import Brake
        >>> Brake(inertia=0.02).breakaway_ratio
        1.0)";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_FIELD(m, inertia, "kg.m2", "Inertia about the output axis", smallest));
        visit(SW_FIELD(m, breakaway_ratio, "1", "What it holds at rest per what it resists in motion", 1));
    }

    /// The input that this load takes.
    static constexpr Field input{"brake_torque", "N.m", "Torque with which the brake resists motion", 0};

    constexpr S torque(const S&, const S&) const { return S(0.0); }
    constexpr S slip(const S& input) const { return max(input, S(0.0)); }
    constexpr S hold(const S& input) const { return breakaway_ratio * slip(input); }
};

}  // namespace strainwave::load
