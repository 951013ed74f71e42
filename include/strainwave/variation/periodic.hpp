#pragma once
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
    static constexpr auto source =
        "document R, which names the stiffness of the mesh among what varies with time; the form, and the reaction on the wave "
        "generator, follow from the energy of the spring";
    static constexpr auto doc = R"(
        A stiffness that changes as the wave generator turns: more or fewer teeth carry, the ball bearing rolls under the load.

        .. math:: k(\theta) = k \left(1 + \sum_h a_h \sin(B_h \theta + \varphi_h)\right)

        with theta the angle of the wave generator, a_h = amplitude, B_h = order, phi_h = phase, up to 8 harmonics. A spring that
        holds the energy V(x, theta) turns the wave generator with the torque -dV/dtheta: without it energy would come from
        nowhere, and with it a stiffness that varies shows in the motor current even where nothing moves the output. The
        amplitudes must add up to less than 1, so that the stiffness stays positive.

        >>> from strainwave.variation import Periodic
        >>> Periodic(order=[2], amplitude=[0.05], phase=[0.0]).amplitude
        (0.05,))";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_FIELD(m, order, "1", "Order B_h: periods per turn of the wave generator", 0));
        visit(SW_FIELD(m, amplitude, "1", "Amplitude a_h, relative to the mean stiffness", 0, 1));
        visit(SW_FIELD(m, phase, "rad", "Phase phi_h"));
    }

    constexpr const char* problem() const {
        if (order.count != amplitude.count || order.count != phase.count)
            return "order, amplitude and phase must have equally many elements";
        return all(largest() < S(2.0)) ? nullptr : "amplitude must add up to less than 1";
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

    /// The same sum, arranged for speed.
    constexpr Compiled compile() const { return {Harmonics<S, capacity>::of(order, amplitude, phase), largest(), active()}; }
};

}  // namespace strainwave::variation
