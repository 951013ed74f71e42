#pragma once
#include <strainwave/field.hpp>
#include <strainwave/math.hpp>

namespace strainwave::stiffness {

template <class S>
struct Linear {
    S k{1e4};

    static constexpr auto name = "linear";
    static constexpr auto source = "Hooke's law; " SW_POSITION_ARTICLE ", K_s";
    static constexpr auto doc = R"(
        Linear spring: constant stiffness.

        .. math:: T = k \delta

        with delta the twist, k = k. Leaves out that a strain wave gear stiffens under load.

        >>> from strainwave.stiffness import Linear
        >>> Linear(k=150.0).torque(0.1)
        15.0)";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_REQUIRED(m, k, "N.m/rad", "Stiffness", smallest));
    }

    constexpr S torque(const S& twist) const { return k * twist; }
    constexpr S twist(const S& torque) const { return torque / k; }
    constexpr S tangent(const S&) const { return k; }
    constexpr S energy(const S& twist) const { return S(0.5) * k * twist * twist; }
};

}  // namespace strainwave::stiffness
