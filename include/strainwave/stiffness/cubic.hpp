#pragma once
#include <strainwave/field.hpp>
#include <strainwave/math.hpp>

namespace strainwave::stiffness {

template <class S>
struct Cubic {
    S a1{1e4};
    S a3{0.0};

    static constexpr auto name = "cubic";
    static constexpr auto source = SW_REVIEW ", section 3, cubic polynomial; Tuttle1992";
    static constexpr auto doc = R"(
        Cubic spring: it stiffens smoothly under load.

        .. math:: T = a_1 \delta + a_3 \delta^3

        with delta the twist, a_1 = a1 > 0, a_3 = a3 >= 0. Odd and strictly increasing, so every torque has one twist. Valid
        over the fitted range; beyond it the cubic stiffens faster than any gear.

        >>> from strainwave.stiffness import Cubic
        >>> spring = Cubic(a1=1.2e4, a3=1e9)
        >>> round(spring.twist(spring.torque(1e-3)), 12)
        0.001)";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_REQUIRED(m, a1, "N.m/rad", "Stiffness at zero twist", smallest));
        visit(SW_FIELD(m, a3, "N.m/rad3", "Hardening", 0));
    }

    constexpr S torque(const S& twist) const { return (a1 + a3 * twist * twist) * twist; }

    /// The one real root of the depressed cubic, by Newton's method from above: neither part alone would give way less. In a form
    /// without differences, which neither cancels nor overflows.
    constexpr S twist(const S& torque) const {
        const S level = abs(torque), alone = exp((log(level) - log(select(a3 > S(0.0), a3, S(1.0)))) / S(3.0));
        S x = value_only(min(level / a1, alone));
        for (int i = 0; i < newton_steps; ++i) {
            const S hardening = a3 * x * x, slope = a1 + S(3.0) * hardening;
            x = min(level / slope + S(2.0) * hardening / slope * x, S(unbounded));
        }
        return along(torque, x);
    }

    constexpr S tangent(const S& twist) const { return a1 + S(3.0) * a3 * twist * twist; }
    constexpr S energy(const S& twist) const { return (S(0.5) * a1 * twist + S(0.25) * (a3 * twist) * twist * twist) * twist; }

private:
    // The start is at most 1.5 times too far, and each step doubles the digits.
    static constexpr int newton_steps = 8;
};

}  // namespace strainwave::stiffness
