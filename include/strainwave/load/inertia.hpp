#pragma once
#include <strainwave/field.hpp>

namespace strainwave::load {

template <class S>
struct Inertia {
    S inertia{0.01};

    static constexpr auto name = "inertia";
    static constexpr auto source = "definition";
    static constexpr auto doc = R"(
        Balanced rotating body on the output shaft.

        .. math:: T_{load} = 0

        with inertia = inertia, about the output axis.

        >>> from strainwave.loads import Inertia
        >>> Inertia(inertia=0.005).inertia
        0.005)";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_FIELD(m, inertia, "kg.m2", "Inertia about the output axis", smallest));
    }

    constexpr S torque(const S&, const S&) const { return S(0.0); }
};

}  // namespace strainwave::load
