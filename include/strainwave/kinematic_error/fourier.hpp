#pragma once
#include <strainwave/harmonics.hpp>
#include <strainwave/kinematic_error/error.hpp>

namespace strainwave::kinematic_error {

template <class S>
struct Fourier {
    static constexpr int capacity = 16;

    Sequence<S, capacity> order{};
    Sequence<S, capacity> amplitude{};
    Sequence<S, capacity> phase{};

    static constexpr auto name = "fourier";
    static constexpr auto source = SW_REVIEW ", eq. (1a); sign convention: theta_error = theta_in / i - theta_out";
    static constexpr auto doc = R"(
        Kinematic error as a sum of harmonics of the wave generator's rotation.

        .. math:: e(\theta) = \sum_h A_h \sin(B_h \theta + \varphi_h)

        with theta the input angle, A_h = amplitude at the output, B_h = order, phi_h = phase; up to 16 harmonics; without
        harmonics there is no error. Orders need not be whole numbers: 2 z_c / z_f occurs. Independent of load and speed.

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

    struct Compiled {
        Harmonics<S, capacity> sum;
        constexpr Error<S> at(const Angle<S>& angle) const {
            const auto [value, slope] = sum.at(angle);
            return {value, slope};
        }
        constexpr Array<Error<S>, 2> at(const Angle<S>& one, const Angle<S>& other) const
            requires detail::takes_pairs<S>
        {
            const auto sums = sum.at(one, other);
            return {{{sums[0].value, sums[0].slope}, {sums[1].value, sums[1].slope}}};
        }
    };

    constexpr Error<S> at(const Angle<S>& angle) const { return compile().at(angle); }

    /// Upper bound of the magnitude of the slope [rad/rad]: the sum over all waves.
    constexpr S steepest() const {
        S sum(0.0);
        for (int h = 0; h < order.count; ++h) sum = sum + abs(order[h] * amplitude[h]);
        return sum;
    }

    /// The sum, arranged for speed.
    constexpr Compiled compile() const { return {Harmonics<S, capacity>::of(order, amplitude, phase)}; }
};

}  // namespace strainwave::kinematic_error
