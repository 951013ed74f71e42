#pragma once
#include <strainwave/field.hpp>
#include <strainwave/math.hpp>

namespace strainwave::hysteresis {

template <class S>
struct PrandtlIshlinskii {
    static constexpr int capacity = 17;

    Sequence<S, capacity> threshold{};
    Sequence<S, capacity> weight{};

    static constexpr auto name = "prandtl_ishlinskii";
    static constexpr auto source = "KrejciKuhnen2001 (plays, the inverse of stops)";
    static constexpr auto doc = R"(
        Compliance of a spring with slip, as a sum of plays: the exact inverse of Maxwell-slip.

        .. math:: \delta = \sum_j w_j p_j, \quad p_j \leftarrow \operatorname{clip}(p_j, T - r_j, T + r_j)

        with T the torque, delta the twist, r_j = threshold, w_j = weight, up to 17 plays; a threshold of 0 is a plain spring.
        The clip is exact for any monotone step of the torque, whatever its size. Rate-independent; obeys Masing's rules,
        wiping-out and congruency; symmetric.

        Maxwell-slip in parallel with a spring has a virgin curve of straight pieces; this law has the same pieces with the
        axes exchanged. The last slope must be positive: slipping elements without a spring have no inverse.

        >>> from strainwave.hysteresis import MaxwellSlip
        >>> gear = MaxwellSlip(stiffness=[1000, 600, 300], breakaway=[0.5, 0.9, 0.9])  # with a spring of 500: 3 and -2.2 N.m
        >>> gear.inverse(500.0).trace([0.0, 3.0, -2.2]).round(12)
        array([ 0.   ,  0.002, -0.001]))";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_FIELD(m, threshold, "N.m", "Torque r_j by which each play lags", 0));
        visit(SW_FIELD(m, weight, "rad/(N.m)", "Compliance w_j of each play", 0));
    }

    constexpr const char* problem() const {
        return threshold.count == weight.count ? nullptr : "threshold and weight must have equally many elements";
    }

    struct State {
        S torque{0.0};
        Array<S, capacity> play{};

        template <class Self, class Visit>
        static constexpr void fields(Self& m, Visit&& visit) {
            visit(SW_FIELD(m, torque, "N.m", "Torque T that acts"));
            visit(SW_FIELD(m, play, "N.m", "Torque p_j at the output of each play"));
        }
    };

    /// The plays after the torque has changed by `increment` [N.m], monotonically.
    constexpr State advance(const State& x, const S& increment) const {
        State next{x.torque + increment, {}};
        for (int j = 0; j < threshold.count; ++j) next.play[j] = followed(x, j, next.torque);
        return next;
    }

    /// Twist [rad] once the torque has changed by `increment` [N.m]; the state stays as it is.
    constexpr S twist(const State& x, const S& increment) const {
        const S torque = x.torque + increment;
        S sum{0.0};
        for (int j = 0; j < threshold.count; ++j) sum = sum + weight[j] * followed(x, j, torque);
        return sum;
    }

private:
    constexpr S followed(const State& x, int j, const S& torque) const {
        return clip(x.play[j], torque - threshold[j], torque + threshold[j]);
    }
};

}  // namespace strainwave::hysteresis
