#pragma once
#include <strainwave/field.hpp>
#include <strainwave/math.hpp>

/// Pure kinematic error e(theta_in), at the output: what two encoders see of a gear that transmits no torque.
namespace strainwave::kinematic_error {

/// Input angle as the drive carries it: exact after any number of turns.
template <class S>
struct Angle {
    S within{0.0};  ///< rad, in [-pi, pi]
    S turns{0.0};   ///< whole revolutions
};

template <class S>
struct Error {
    S value{0.0};  ///< rad
    S slope{0.0};  ///< rad/rad
};

template <class S>
struct Fourier {
    static constexpr int capacity = 16;

    Sequence<S, capacity> order{};
    Sequence<S, capacity> amplitude{};
    Sequence<S, capacity> phase{};

    static constexpr auto name = "fourier";
    static constexpr auto source = "document R, eq. (1a); sign convention: theta_error = theta_in / i - theta_out";
    static constexpr auto doc = R"(
        Kinematic error as a sum of harmonics of the wave generator's rotation.

        .. math:: e(\theta) = \sum_h A_h \sin(B_h \theta + \varphi_h)

        with theta the input angle, A_h = amplitude at the output, B_h = order, phi_h = phase; up to 16 harmonics, none at all is
        a perfect gear. Orders need not be whole: 2 z_c / z_f occurs. Independent of load and speed.

        >>> from strainwave.kinematic_error import Fourier
        >>> Fourier(order=[2], amplitude=[3e-4], phase=[0.0]).slope(0.0)
        0.0006)";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_FIELD(m, order, "1", "Order B_h: periods per input revolution", 0));
        visit(SW_FIELD(m, amplitude, "rad", "Amplitude A_h at the output", 0));
        visit(SW_FIELD(m, phase, "rad", "Phase phi_h"));
    }

    constexpr const char* problem() const {
        return order.count == amplitude.count && order.count == phase.count
                   ? nullptr
                   : "order, amplitude and phase must have equally many elements";
    }

    constexpr Error<S> at(const Angle<S>& angle) const { return compile().at(angle); }

    /// The same sum, arranged for speed: one sine and cosine, then the whole orders by angle addition.
    struct Compiled {
        static constexpr int highest = 32;
        using Waves = Array<S, 4>;  ///< what multiplies the sine and cosine of one order and of the next: four equal lanes

        Array<Waves, highest / 2> value{}, slope{};
        int top = 0;
        Sequence<S, capacity> order{}, amplitude{}, phase{};

        constexpr Error<S> at(const Angle<S>& angle) const {
            Error<S> error{};
            if (top > 0) error = whole_orders(sincos(angle.within));
            for (int h = 0; h < order.count; ++h) {
                const S turned = order[h] * angle.turns;
                const SinCos<S> p = sincos(order[h] * angle.within + phase[h] + S(2.0 * pi) * (turned - rint(turned)));
                error.value = error.value + amplitude[h] * p.sin;
                error.slope = error.slope + amplitude[h] * order[h] * p.cos;
            }
            return error;
        }

    private:
        /// sin(n x) and cos(n x) by the Chebyshev recurrence f(n + 2) = 2 cos(2 x) f(n) - f(n - 2), two orders at a time: half as
        /// many steps wait for each other.
        constexpr Error<S> whole_orders(const SinCos<S>& base) const {
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

    constexpr Compiled compile() const {
        Compiled sum{};
        for (int h = 0; h < order.count; ++h) {
            const int n = whole(order[h], Compiled::highest);
            if (n > 0) {
                const SinCos<S> p = sincos(phase[h]);
                const int pair = (n - 1) / 2, s = 2 * ((n - 1) % 2), c = s + 1;
                auto &value = sum.value[pair], &slope = sum.slope[pair];
                value[s] = value[s] + amplitude[h] * p.cos;
                value[c] = value[c] + amplitude[h] * p.sin;
                slope[s] = -order[h] * value[c];
                slope[c] = order[h] * value[s];
                sum.top = sum.top > n ? sum.top : n;
            } else {
                const int i = sum.order.count++;
                sum.amplitude.count = sum.phase.count = sum.order.count;
                sum.order[i] = order[h];
                sum.amplitude[i] = amplitude[h];
                sum.phase[i] = phase[h];
            }
        }
        return sum;
    }
};

}  // namespace strainwave::kinematic_error
