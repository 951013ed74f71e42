#pragma once
#include <strainwave/compiled.hpp>
#include <strainwave/fastest.hpp>
#include <strainwave/sensor/ideal.hpp>

namespace strainwave::sensor {

template <class S, class Law_ = Ideal<S>>
struct Quantised {
    using Law = Law_;

    Law law{};
    S resolution{1e-3};

    static constexpr auto name = "quantised";
    static constexpr auto source = "definition: a uniform quantiser, as an analogue-to-digital converter is";
    static constexpr auto doc = R"(
        Sensor with a quantised reading, as of an analogue-to-digital converter.

        .. math:: y = q \operatorname{round}\left(\frac{x}{q}\right)

        with x the reading of ``law``, its noise and delay included, q = resolution. If the reading changes by many steps, the
        root mean square of the error is q / sqrt(12). A controller that is not sampled jumps with each step of the reading, as
        with the counts of an Encoder, whose steps are those of an angle. Derivatives ignore the rounding.

        >>> from strainwave.sensor import FirstOrder, Noisy, Quantised
        >>> speed = Noisy(law=FirstOrder(time_constant=1e-3), amplitude=0.05)
        >>> Quantised(law=speed, resolution=0.1).law.amplitude
        0.05)";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_PART(m, law, "The sensor without steps"));
        visit(SW_REQUIRED(m, resolution, "1", "Step q of the reading, in the unit of the measured quantity", smallest));
    }

    struct State {
        typename Law::State law{};

        template <class Self, class Visit>
        static constexpr void fields(Self& m, Visit&& visit) {
            visit(SW_PART(m, law, "State of the sensor without steps"));
        }
    };

    constexpr auto compile() const { return Quantised<S, decltype(compiled(law))>{compiled(law), resolution}; }

    constexpr State initial_state() const { return {}; }
    constexpr S shown(const State& x, const S& value) const {
        const S exact = law.shown(x.law, value), read = resolution * rint(exact / resolution);
        if constexpr (differentiates<S>)
            return exact + value_only(read - exact);
        else
            return read;
    }
    constexpr State rate(const State& x, const S& value) const { return {law.rate(x.law, value)}; }
    constexpr State relaxation_rate() const { return {law.relaxation_rate()}; }
    constexpr State steady_state(const S& value) const { return {law.steady_state(value)}; }
    constexpr S fastest() const { return strainwave::fastest<S>(law); }
};

}  // namespace strainwave::sensor
