#pragma once
#include <strainwave/compiled.hpp>
#include <strainwave/fastest.hpp>
#include <strainwave/random.hpp>
#include <strainwave/sensor/ideal.hpp>

namespace strainwave::sensor {

template <class S, class Law_ = Ideal<S>>
struct Noisy {
    using Law = Law_;

    Law law{};
    S amplitude{0.0};
    S bandwidth{1000.0};
    S seed{0.0};

    static constexpr auto name = "noisy";
    static constexpr auto source = "spectral representation: ShinozukaDeodatis1991; random numbers: WichmannHill1982";
    static constexpr auto doc = R"(
        Sensor with noise of a flat spectrum up to a bandwidth, the same for the same seed.

        .. math:: y = x + A \sqrt{\frac{2}{N}} \sum_{k=1}^{N} \cos(2 \pi f_k t + \varphi_k)

        with x the reading of ``law``, t the time since the start of the run, A = amplitude. The band from 0 to bandwidth has N
        = 32 equal cells. Each cell contains one frequency f_k; ``seed`` draws its place in the cell and its phase phi_k. The
        noise is a smooth function of time, independent of step length and method. Its values are close to Gaussian. Samples
        that are 1 / (2 bandwidth) apart, or a multiple of that, are close to independent. Steps must resolve the bandwidth.
        Give each sensor its own seed if their noise must differ.

        >>> from strainwave.sensor import FirstOrder, Noisy
        >>> Noisy(law=FirstOrder(time_constant=1e-3), amplitude=0.02, bandwidth=500.0, seed=7).amplitude
        0.02)";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_PART(m, law, "The sensor without noise"));
        visit(SW_REQUIRED(m, amplitude, "1", "Root mean square A, in the unit of the measured quantity", 0));
        visit(SW_FIELD(m, bandwidth, "Hz", "Highest frequency of the noise", smallest));
        visit(SW_FIELD(m, seed, "1", "Seed of the random numbers, a whole number", 0, 16777215, true));
    }

    struct State {
        S clock{0.0};
        typename Law::State law{};

        template <class Self, class Visit>
        static constexpr void fields(Self& m, Visit&& visit) {
            visit(SW_FIELD(m, clock, "s", "Time since the start"));
            visit(SW_PART(m, law, "State of the sensor without noise"));
        }
    };

    /// The sensor with its frequencies and phases drawn.
    struct Compiled {
        using Inner = decltype(compiled(Law{}));
        using State = typename Noisy<S, Inner>::State;
        Inner law{};
        S weight{0.0};
        Spectrum<S> spectrum{};

        constexpr State initial_state() const { return {}; }
        constexpr S shown(const State& x, const S& value) const { return law.shown(x.law, value) + weight * spectrum.sum(x.clock); }
        constexpr State rate(const State& x, const S& value) const { return {S(1.0), law.rate(x.law, value)}; }
        constexpr State relaxation_rate() const { return {S(0.0), law.relaxation_rate()}; }
        constexpr State steady_state(const S& value) const { return {S(0.0), law.steady_state(value)}; }
        constexpr S fastest() const { return strainwave::fastest<S>(law); }
    };
    constexpr Compiled compile() const {
        return {compiled(law), S(Spectrum<S>::weight) * amplitude, Spectrum<S>::drawn(S(0.0), bandwidth, seed)};
    }

    constexpr State initial_state() const { return {}; }
    constexpr S shown(const State& x, const S& value) const { return compile().shown(x, value); }
    constexpr State rate(const State& x, const S& value) const { return compile().rate(x, value); }
    constexpr State relaxation_rate() const { return compile().relaxation_rate(); }
    constexpr State steady_state(const S& value) const { return compile().steady_state(value); }
    constexpr S fastest() const { return strainwave::fastest<S>(law); }
};

}  // namespace strainwave::sensor
