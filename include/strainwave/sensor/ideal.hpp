#pragma once
#include <strainwave/field.hpp>

namespace strainwave::sensor {

template <class S>
struct Ideal {
    static constexpr auto name = "ideal";
    static constexpr auto source = "definition";
    static constexpr auto doc = R"(
        Ideal sensor: the reading is the true value.

        .. math:: y = x

        >>> from strainwave.sensor import Ideal
        >>> Ideal()
        Ideal())";

    template <class Self, class Visit>
    static constexpr void fields(Self&, Visit&&) {}

    using State = Stateless<S>;

    constexpr S shown(const State&, const S& value) const { return value; }
    constexpr State rate(const State&, const S&) const { return {}; }
    constexpr State relaxation_rate() const { return {}; }
    constexpr State steady_state(const S&) const { return {}; }
};

}  // namespace strainwave::sensor
