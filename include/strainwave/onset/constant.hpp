#pragma once
#include <strainwave/onset/onset.hpp>

namespace strainwave::onset {

template <class S>
struct Constant {
    static constexpr auto name = "constant";
    static constexpr auto source = "definition";
    static constexpr auto doc = R"(
        Fault that is present from the beginning.

        .. math:: g(u) = 1

        >>> from strainwave.onset import Constant
        >>> Constant().share(0.0)
        1.0)";

    template <class Self, class Visit>
    static constexpr void fields(Self&, Visit&&) {}

    constexpr S share(const S&) const { return S(1.0); }
};

}  // namespace strainwave::onset
