#pragma once
#include <strainwave/meter/meter.hpp>

namespace strainwave::meter {

template <class S>
struct NoMeter {
    static constexpr auto name = "none";
    static constexpr auto source = "definition";
    static constexpr auto doc = R"(
        No meter: powers and energies are not calculated.

        .. math:: E(t) = \text{not known}

        >>> from strainwave.meter import NoMeter
        >>> NoMeter()
        NoMeter())";

    template <class Self, class Visit>
    static constexpr void fields(Self&, Visit&&) {}

    using State = Stateless<S>;
    using Output = Stateless<S>;
    static constexpr bool active() { return false; }

    constexpr State rate(const Powers<S>&) const { return {}; }
    constexpr Output output(const State&, const Powers<S>&, const Stored<S>&) const { return {}; }
};

}  // namespace strainwave::meter
