#pragma once
#include <strainwave/field.hpp>

namespace strainwave::material {

template <class S>
struct Elastic {
    static constexpr auto name = "elastic";
    static constexpr auto source = "definition";
    static constexpr auto doc = R"(
        Elastic material: nothing relaxes.

        .. math:: T = 0

        >>> from strainwave.material import Elastic
        >>> Elastic().loss(10.0)
        0.0)";

    template <class Self, class Visit>
    static constexpr void fields(Self&, Visit&&) {}

    using State = Stateless<S>;

    static constexpr bool active() { return false; }
    constexpr S largest_stiffness() const { return S(0.0); }
    constexpr S torque(const State&) const { return S(0.0); }
    constexpr State rate(const State&, const S&) const { return {}; }
    constexpr State relaxation_rate() const { return {}; }
    constexpr S lost(const State&) const { return S(0.0); }
    constexpr S stored(const State&) const { return S(0.0); }
    constexpr State advance(const State&, const S&, const S&) const { return {}; }
    constexpr S work(const State&, const S&, const S&) const { return S(0.0); }
    constexpr S storage(const S&) const { return S(0.0); }
    constexpr S loss(const S&) const { return S(0.0); }
};

}  // namespace strainwave::material
