#pragma once
#include <strainwave/field.hpp>
#include <strainwave/math.hpp>

namespace strainwave::stiffness {

template <class S>
struct Piecewise {
    S k1{8e3};
    S k2{2e3};
    S knee{1e-3};

    static constexpr auto name = "piecewise";
    static constexpr auto source = SW_REVIEW ", section 3, piecewise linear";
    static constexpr auto doc = R"(
        Piecewise linear spring of two segments, stiffer beyond a twist, odd in the twist.

        .. math:: T = k_1 \delta + k_2 \operatorname{sgn}(\delta) \max(|\delta| - \delta_k, 0)

        with delta the twist, k_1 = k1, k_2 = k2, delta_k = knee. The review's k_2 is an increment: the slope
        above the knee is k1 + k2, so to match a slope K there set k2 = K - k1. The slope jumps at the knee; at the knee
        itself it is k1. Leaves out the soft centre and the hysteresis.

        >>> from strainwave.stiffness import Piecewise
        >>> spring = Piecewise(k1=8000.0, k2=2000.0, knee=0.001)
        >>> spring.torque(0.003), spring.tangent(0.003)
        (28.0, 10000.0))";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_REQUIRED(m, k1, "N.m/rad", "Stiffness up to the knee", smallest));
        visit(SW_REQUIRED(m, k2, "N.m/rad", "Increment k_2 of the stiffness above the knee", 0));
        visit(SW_REQUIRED(m, knee, "rad", "Twist of the knee", 0));
    }

    constexpr S torque(const S& twist) const {
        const S x = abs(twist);
        return along(twist, k1 * x + k2 * past_knee(x));
    }
    constexpr S twist(const S& torque) const {
        const S level = abs(torque), level_at_knee = k1 * knee;
        return along(torque, select(level > level_at_knee, knee + (level - level_at_knee) / (k1 + k2), level / k1));
    }
    constexpr S tangent(const S& twist) const { return select(abs(twist) > knee, k1 + k2, k1); }
    constexpr S energy(const S& twist) const {
        const S past = past_knee(abs(twist));
        return S(0.5) * k1 * twist * twist + S(0.5) * k2 * past * past;
    }

private:
    constexpr S past_knee(const S& x) const { return max(x - knee, S(0.0)); }
};

}  // namespace strainwave::stiffness
