#pragma once
#include <strainwave/angle.hpp>
#include <strainwave/math.hpp>

namespace strainwave {

/// sum_h A_h sin(B_h theta + phi_h), arranged for speed: one sine and cosine, then the whole orders up to `highest` by angle
/// addition. Of other orders it holds up to `capacity`.
template <class S, int capacity, int highest_ = 32>
struct Harmonics {
    static constexpr int highest = highest_;
    using Waves = Array<S, 4>;  ///< what multiplies the sine and cosine of one order and of the next: four equal lanes

    struct Sum {
        S value, slope;
    };

    Array<Waves, highest / 2> value{}, slope{};
    int top = 0;
    Sequence<S, capacity> order{}, amplitude{}, phase{};

    template <int n>
    static constexpr Harmonics of(const Sequence<S, n>& order, const Sequence<S, n>& amplitude, const Sequence<S, n>& phase) {
        Harmonics sum{};
        for (int h = 0; h < order.count; ++h) {
            const int number = whole(order[h], highest);
            if (number > 0)
                sum.add_whole(number, order[h], amplitude[h], phase[h]);
            else
                sum.add(order[h], amplitude[h], phase[h]);
        }
        return sum;
    }

    constexpr Sum at(const Angle<S>& angle) const {
        Sum sum{};
        if (top > 0) sum = whole_orders(sincos(angle.within));
        for (int h = 0; h < order.count; ++h) {
            const S turned = finite(order[h] * angle.turns), within = finite(order[h] * angle.within);
            const SinCos<S> p = sincos(within + phase[h] + S(2.0 * pi) * (turned - rint(turned)));
            sum.value = sum.value + amplitude[h] * p.sin;
            sum.slope = sum.slope + amplitude[h] * order[h] * p.cos;
        }
        return sum;
    }

#if !defined(__CUDACC_RTC__)
    /// The sums at two angles, with the bits that each has alone: the four waves of an angle are one register, and neither angle
    /// waits for the other.
    Array<Sum, 2> at(const Angle<S>& one, const Angle<S>& other) const
        requires detail::takes_pairs<S>
    {
        using Two = typename detail::Vector<double, 2 * int(sizeof(double))>::type;
        if (top == 0 || order.count > 0 || !(abs(one.within) < elementary::farthest && abs(other.within) < elementary::farthest))
            return {{at(one), at(other)}};
        const auto [sine, cosine] = elementary::sincos(Two{one.within, other.within});
        Rotating first({sine[0], cosine[0]}), second({sine[1], cosine[1]});
        for (int n = 0; 2 * n < top; ++n) {
            first.add(value[n], slope[n]);
            second.add(value[n], slope[n]);
        }
        return {{first.sum(), second.sum()}};
    }
#endif

private:
#if !defined(__CUDACC_RTC__)
    /// The sums of `whole_orders`, in registers.
    struct Rotating {
        using Four = typename detail::Vector<double, 4 * int(sizeof(double))>::type;
        Four before, wave, step, values{}, slopes{};

        explicit Rotating(const SinCos<double>& base) {
            const double twice = base.sin + base.sin, sine = twice * base.cos, cosine = 1.0 - twice * base.sin;
            before = Four{-base.sin, base.cos, 0.0, 1.0};
            wave = Four{base.sin, base.cos, sine, cosine};
            step = Four{} + (cosine + cosine);
        }
        void add(const Waves& of_value, const Waves& of_slope) {
            values = values + all(of_value) * wave;
            slopes = slopes + all(of_slope) * wave;
            const Four next = step * wave - before;
            before = wave;
            wave = next;
        }
        Sum sum() const {
            return {(values[0] + values[1]) + (values[2] + values[3]), (slopes[0] + slopes[1]) + (slopes[2] + slopes[3])};
        }
        static Four all(const Waves& waves) {
            Four four;
            __builtin_memcpy(&four, &waves, sizeof four);
            return four;
        }
    };
#endif
    /// An angle so large that its place in the turn is lost, but of which a sine is a number in every scalar.
    static constexpr S finite(const S& angle) { return clip(angle, S(-1e18), S(1e18)); }

    constexpr void add_whole(int n, const S& order_, const S& amplitude_, const S& phase_) {
        const SinCos<S> p = sincos(phase_);
        const int pair = (n - 1) / 2, s = 2 * ((n - 1) % 2), c = s + 1;
        value[pair][s] = value[pair][s] + amplitude_ * p.cos;
        value[pair][c] = value[pair][c] + amplitude_ * p.sin;
        slope[pair][s] = -order_ * value[pair][c];
        slope[pair][c] = order_ * value[pair][s];
        top = top > n ? top : n;
    }
    constexpr void add(const S& order_, const S& amplitude_, const S& phase_) {
        const int i = order.count++;
        amplitude.count = phase.count = order.count;
        order[i] = order_;
        amplitude[i] = amplitude_;
        phase[i] = phase_;
    }

    /// sin(n x) and cos(n x) by the Chebyshev recurrence f(n + 2) = 2 cos(2 x) f(n) - f(n - 2), two orders at a time: half as
    /// many steps wait for each other.
    constexpr Sum whole_orders(const SinCos<S>& base) const {
        const S twice = base.sin + base.sin, sine = twice * base.cos, cosine = S(1.0) - twice * base.sin;
        const S step = cosine + cosine;
        Waves before{{-base.sin, base.cos, S(0.0), S(1.0)}}, wave{{base.sin, base.cos, sine, cosine}}, values{}, slopes{};
        for (int n = 0; 2 * n < top; ++n)
            for (int k = 0; k < 4; ++k) {
                values[k] = values[k] + value[n][k] * wave[k];
                slopes[k] = slopes[k] + slope[n][k] * wave[k];
                const S next = step * wave[k] - before[k];
                before[k] = wave[k];
                wave[k] = next;
            }
        return {(values[0] + values[1]) + (values[2] + values[3]), (slopes[0] + slopes[1]) + (slopes[2] + slopes[3])};
    }
};

}  // namespace strainwave
