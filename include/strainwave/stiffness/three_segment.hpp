#pragma once
#include <strainwave/field.hpp>
#include <strainwave/math.hpp>

namespace strainwave::stiffness {

template <class S>
struct ThreeSegment {
    S k1{3.1e4};
    S k2{5.0e4};
    S k3{5.7e4};
    S t1{14.0};
    S t2{48.0};

    static constexpr auto name = "three_segment";
    static constexpr auto source = "Harmonic Drive AG catalogue, torsional stiffness K1, K2, K3 with torques T1, T2";
    static constexpr auto doc = R"(
        Piecewise linear spring of the catalogue: three segments that meet at two torques, odd in the twist.

        .. math:: \delta(T) = T / K_1 \; (T \le T_1), \quad T_1/K_1 + (T - T_1)/K_2 \; (T \le T_2), \quad
                  T_1/K_1 + (T_2 - T_1)/K_2 + (T - T_2)/K_3

        with delta the twist, K_i = k1, k2, k3, T_i = t1, t2. The slope jumps at the knees. Individual gears differ from their
        catalogue by up to 30 %. Leaves out the hysteresis loss, which the catalogue states separately.

        The catalogue's worked example, size 32, ratio 100, 60 N.m:

        >>> from strainwave.stiffness import ThreeSegment
        >>> round(ThreeSegment(k1=67e3, k2=110e3, k3=120e3, t1=29.0, t2=108.0).twist(60.0), 16)
        0.0007146540027137)";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_REQUIRED(m, k1, "N.m/rad", "Stiffness below t1", smallest));
        visit(SW_REQUIRED(m, k2, "N.m/rad", "Stiffness between t1 and t2", smallest));
        visit(SW_REQUIRED(m, k3, "N.m/rad", "Stiffness above t2", smallest));
        visit(SW_REQUIRED(m, t1, "N.m", "Torque of the first knee", smallest));
        visit(SW_REQUIRED(m, t2, "N.m", "Torque of the second knee", smallest));
    }

    constexpr const char* problem() const { return all(t2 >= t1) ? nullptr : "t2 must be at least t1"; }

    constexpr S torque(const S& twist) const {
        const S x = abs(twist), x1 = first_knee(), x2 = second_knee();
        const S level = select(x < x1, k1 * x, select(x < x2, t1 + k2 * (x - x1), t2 + k3 * (x - x2)));
        return along(twist, level);
    }
    constexpr S twist(const S& torque) const {
        const S level = abs(torque);
        const S x =
            select(level < t1, level / k1, select(level < t2, first_knee() + (level - t1) / k2, second_knee() + (level - t2) / k3));
        return along(torque, x);
    }
    constexpr S tangent(const S& twist) const {
        const S x = abs(twist);
        return select(x < first_knee(), k1, select(x < second_knee(), k2, k3));
    }
    constexpr S energy(const S& twist) const {
        const S x = abs(twist), a = min(x, first_knee()), b = clip(x - first_knee(), S(0.0), second_knee() - first_knee()),
                c = max(x - second_knee(), S(0.0));
        return S(0.5) * k1 * a * a + (t1 + S(0.5) * k2 * b) * b + (t2 + S(0.5) * k3 * c) * c;
    }

private:
    constexpr S first_knee() const { return t1 / k1; }
    constexpr S second_knee() const { return first_knee() + (t2 - t1) / k2; }
};

}  // namespace strainwave::stiffness
