#pragma once
#include <strainwave/variation/variation.hpp>

namespace strainwave::variation {

template <class S>
struct Constant {
    static constexpr auto name = "constant";
    static constexpr auto source = "definition";
    static constexpr auto doc = R"(
        Stiffness that does not depend on the angle of the wave generator.

        .. math:: k(\theta) = k_0

        >>> from strainwave.variation import Constant
        >>> Constant()
        Constant())";

    template <class Self, class Visit>
    static constexpr void fields(Self&, Visit&&) {}

    static constexpr bool active() { return false; }
    constexpr Factor<S> at(const Angle<S>&) const { return {}; }
    constexpr S largest() const { return S(1.0); }
};

}  // namespace strainwave::variation
