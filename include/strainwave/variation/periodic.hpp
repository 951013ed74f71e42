#pragma once
#include <strainwave/condition.hpp>
#include <strainwave/harmonics.hpp>
#include <strainwave/variation/variation.hpp>

namespace strainwave::variation {

template <class S>
struct Periodic {
    static constexpr int capacity = 8;

    Sequence<S, capacity> order{};
    Sequence<S, capacity> amplitude{};
    Sequence<S, capacity> phase{};

    static constexpr auto name = "periodic";
    static constexpr auto source = SW_REVIEW
        ", which names the stiffness of the mesh among what varies with time; the form, and the reaction on the wave "
        "generator, follow from the energy of the spring";
    static constexpr auto doc = R"(
        Stiffness that varies with the angle of the wave generator, in harmonics of its turn.

        .. math:: k(\theta) = k_0 \left(1 + \sum_h a_h \sin(B_h \theta + \varphi_h)\right)

        with k_0 the stiffness of its law, theta the angle of the wave generator, a_h = amplitude, B_h = order, phi_h = phase,
        up to 8 harmonics. Two lobes make order 2. The cause is the changing number of loaded teeth and of loaded balls of the
        bearing. A spring of the energy V(x, theta), x its deformation, turns the wave generator with the torque -dV/dtheta.
        Without this torque energy is not conserved. With it, the variation is visible in the motor current even if the output
        is at rest. The amplitudes must add up to less than 1, so that the stiffness stays positive.

        >>> from strainwave.variation import Periodic
        >>> Periodic(order=[2], amplitude=[0.05], phase=[0.0]).amplitude
        (0.05,))";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_FIELD(m, order, "1", "Order B_h: periods per turn of the wave generator", 0));
        visit(SW_FIELD(m, amplitude, "1", "Amplitude a_h, relative to the mean stiffness", 0, 1));
        visit(SW_FIELD(m, phase, "rad", "Phase phi_h"));
    }

    constexpr Contradiction<S> problem() const {
        if (order.count != amplitude.count || order.count != phase.count)
            return {"order, amplitude and phase must have equally many elements"};
        if (!all(largest() < S(2.0))) return {"amplitude must add up to less than 1, not {}", largest() - S(1.0)};
        return {};
    }

    struct Compiled {
        Harmonics<S, capacity> sum;
        S most{1.0};
        bool engaged = false;

        constexpr bool active() const { return engaged; }
        constexpr S largest() const { return most; }
        constexpr Factor<S> at(const Angle<S>& angle) const {
            const auto [value, slope] = sum.at(angle);
            return {S(1.0) + value, slope};
        }
    };

    constexpr bool active() const { return order.count > 0; }
    constexpr S largest() const {
        S most{1.0};
        for (int h = 0; h < amplitude.count; ++h) most = most + amplitude[h];
        return most;
    }
    constexpr Factor<S> at(const Angle<S>& angle) const { return compile().at(angle); }

    /// The sum, arranged for speed.
    constexpr Compiled compile() const { return {Harmonics<S, capacity>::of(order, amplitude, phase), largest(), active()}; }
};

}  // namespace strainwave::variation
