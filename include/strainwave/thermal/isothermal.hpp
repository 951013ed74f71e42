#pragma once
#include <strainwave/field.hpp>
#include <strainwave/thermal/thermal.hpp>

namespace strainwave::thermal {

template <class S>
struct Isothermal {
    static constexpr auto name = "isothermal";
    static constexpr auto source = "definition";
    static constexpr auto doc = R"(
        Isothermal drive: gear and winding have the temperature of the run.

        .. math:: T_w = T_g = T(t)

        with T(t) the input temperature.

        >>> from strainwave.thermal import Isothermal
        >>> Isothermal()
        Isothermal())";

    template <class Self, class Visit>
    static constexpr void fields(Self&, Visit&&) {}

    using State = Stateless<S>;
    using Output = Stateless<S>;
    static constexpr bool active() { return false; }

    constexpr Temperatures<S> at(const State&, const S& ambient) const { return {ambient, ambient}; }
    constexpr State rate(const State&, const Heat<S>&, const S&) const { return {}; }
    constexpr S gear_rate(const State&, const S& ambient_rate) const { return ambient_rate; }
    constexpr Output output(const State&, const S&) const { return {}; }
};

}  // namespace strainwave::thermal
