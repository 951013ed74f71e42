#pragma once
#include <strainwave/compiled.hpp>
#include <strainwave/fastest.hpp>
#include <strainwave/sensor/ideal.hpp>

namespace strainwave::sensor {

template <class S, class Law_ = Ideal<S>>
struct Delayed {
    using Law = Law_;
    static constexpr int sections = 4;

    Law law{};
    S delay{1e-3};

    static constexpr auto name = "delayed";
    static constexpr auto source =
        "Pade approximation of a delay, in four equal sections: FranklinPowellEmamiNaeini2002, chapter 5";
    static constexpr auto doc = R"(
        Sensor with a delay.

        .. math:: y = \left(\frac{1 - s \delta / 8}{1 + s \delta / 8}\right)^4 x \approx x(t - \delta)

        with x the reading of ``law``, delta = delay. Amplitudes do not change. The phase is 0.52 percent smaller than that of
        the delay at the frequency 1 / delta [rad/s], 2.01 percent at 2 / delta, and less at lower frequencies. A jump passes
        at once, and again, spread over the time around delta. Use the exact delay of a sampled controller for signals that
        jump. At the start of a run the sensor has settled. Steps of a fixed length must not be longer than delta / 8.

        >>> from strainwave.sensor import Delayed, Encoder
        >>> Delayed(law=Encoder(counts=8192), delay=2e-3).law.counts
        8192.0)";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_PART(m, law, "The sensor without delay"));
        visit(SW_REQUIRED(m, delay, "s", "Delay delta", smallest));
    }

    struct State {
        Array<S, sections> section{};
        typename Law::State law{};

        template <class Self, class Visit>
        static constexpr void fields(Self& m, Visit&& visit) {
            visit(SW_FIELD(m, section, "1", "State of each section of the delay, in the unit of the measured quantity"));
            visit(SW_PART(m, law, "State of the sensor without delay"));
        }
    };

    constexpr auto compile() const { return Delayed<S, decltype(compiled(law))>{compiled(law), delay}; }

    constexpr State initial_state() const { return {}; }
    constexpr S shown(const State& x, const S& value) const {
        S passing = law.shown(x.law, value);
        for (int i = 0; i < sections; ++i) passing = S(2.0) * x.section[i] - passing;
        return passing;
    }
    constexpr State rate(const State& x, const S& value) const {
        State rate{{}, law.rate(x.law, value)};
        S passing = law.shown(x.law, value);
        for (int i = 0; i < sections; ++i) {
            rate.section[i] = (passing - x.section[i]) * per_second();
            passing = S(2.0) * x.section[i] - passing;
        }
        return rate;
    }
    constexpr State relaxation_rate() const {
        // No section is stepped exactly: each follows another, so that a step which is exact for one is not exact for the chain.
        return {{}, law.relaxation_rate()};
    }
    constexpr S fastest() const { return max(strainwave::fastest<S>(law), per_second()); }
    constexpr State steady_state(const S& value) const {
        State x{{}, law.steady_state(value)};
        for (int i = 0; i < sections; ++i) x.section[i] = law.shown(x.law, value);
        return x;
    }

private:
    constexpr S per_second() const { return S(2.0 * sections) / delay; }
};

}  // namespace strainwave::sensor
