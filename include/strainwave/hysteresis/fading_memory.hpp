#pragma once
#include <strainwave/decayed.hpp>
#include <strainwave/field.hpp>
#include <strainwave/math.hpp>

namespace strainwave::hysteresis {

template <class S>
struct FadingMemory {
    static constexpr int capacity = 8;

    Sequence<S, capacity> stiffness{};
    Sequence<S, capacity> forgetting{};

    static constexpr auto name = "fading_memory";
    static constexpr auto source = SW_REVIEW ", section 4a; Dahl1968 (order 1)";
    static constexpr auto doc = R"(
        Hysteresis with a memory that fades exponentially with the twist travelled.

        .. math:: T = \sum_j T_j, \quad dT_j = A_j\, d\delta - \alpha_j T_j |d\delta|

        with delta the twist, A_j = stiffness, alpha_j = forgetting, up to 8 parallel branches; without branches there is no
        hysteresis. The branches sum up to the memory kernel Phi(u) = sum A_j exp(-alpha_j u) of the twist travelled u. Exact
        over any monotone step: with s the sense of motion, T_j approaches s A_j / alpha_j as exp(-alpha_j |Delta delta|). The
        elastic energy is sum T_j^2 / (2 A_j); alpha_j T_j^2 / A_j is lost per twist travelled, in either sense.

        Rate-independent: the review calls it rate-dependent. One branch is Dahl's model of order 1, and BoucWen with
        sharpness 1 and shape 1. Its minor loops do not close, unlike those of a gear: prefer MaxwellSlip if small reversals
        matter.

        >>> from strainwave.hysteresis import FadingMemory
        >>> FadingMemory(stiffness=1000.0, forgetting=2000.0).trace([0.0, 0.002, -0.001]).round(6)
        array([ 0.      ,  0.490842, -0.497544]))";

    static constexpr bool odd = true;
    static constexpr bool return_point_memory = false;
    static constexpr bool congruent = false;
    static constexpr bool masing = false;

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_FIELD(m, stiffness, "N.m/rad", "Stiffness A_j of each branch right after a reversal from zero torque", smallest));
        visit(SW_FIELD(m, forgetting, "1/rad", "Rate alpha_j at which each branch forgets the twist travelled", smallest));
    }

    constexpr const char* problem() const {
        return stiffness.count == forgetting.count ? nullptr : "stiffness and forgetting must have equally many elements";
    }

    struct State {
        Array<S, capacity> held{};

        template <class Self, class Visit>
        static constexpr void fields(Self& m, Visit&& visit) {
            visit(SW_FIELD(m, held, "N.m", "Torque T_j held by each branch"));
        }
    };

    /// The memory after the twist has moved by `increment` [rad], monotonically.
    constexpr State advance(const State& x, const S& increment) const {
        State next{};
        for (int j = 0; j < stiffness.count; ++j) next.held[j] = held(x, j, increment);
        return next;
    }

    /// Torque [N.m] once the twist has moved by `increment` [rad]; the state stays as it is.
    constexpr S torque(const State& x, const S& increment) const {
        S sum{0.0};
        for (int j = 0; j < stiffness.count; ++j) sum = sum + held(x, j, increment);
        return sum;
    }

    /// Work [J] done on the law while the twist moves by `increment` [rad], monotonically.
    constexpr S work(const State& x, const S& increment) const {
        S sum{0.0};
        for (int j = 0; j < stiffness.count; ++j) {
            const auto decayed = Decayed<S>::along_path(forgetting[j], abs(increment));
            sum = sum + along(increment, x.held[j]) * decayed.once + stiffness[j] * decayed.twice;
        }
        return sum;
    }

    /// Elastic energy [J] held by the branches.
    constexpr S stored(const State& x) const {
        S energy{0.0};
        for (int j = 0; j < stiffness.count; ++j) energy = energy + x.held[j] * x.held[j] / (S(2.0) * stiffness[j]);
        return energy;
    }

private:
    /// Slope of the torque [N.m/rad], in the sense of the motion, as the motion starts.
    constexpr S rise(const State& x, int j, const S& increment) const {
        return stiffness[j] - forgetting[j] * along(increment, x.held[j]);
    }
    constexpr S held(const State& x, int j, const S& increment) const {
        const S once = Decayed<S>::along_path(forgetting[j], abs(increment)).once;
        return x.held[j] + along(increment, rise(x, j, increment) * once);
    }
};

}  // namespace strainwave::hysteresis
