#pragma once
#include <strainwave/field.hpp>
#include <strainwave/hysteresis/prandtl_ishlinskii.hpp>
#include <strainwave/math.hpp>

namespace strainwave::hysteresis {

template <class S>
struct MaxwellSlip {
    static constexpr int capacity = 16;

    Sequence<S, capacity> stiffness{};
    Sequence<S, capacity> breakaway{};

    static constexpr auto name = "maxwell_slip";
    static constexpr auto source = "Iwan1966; LampaertAlBenderSwevers2003, eq. (9); " SW_REVIEW
                                   ", section 4b, with a capture position that is dragged along in slip";
    static constexpr auto doc = R"(
        Maxwell-slip hysteresis of parallel springs that slip at their own torque: non-local memory.

        .. math:: T = \sum_i T_i, \quad T_i \leftarrow \operatorname{clip}(T_i + k_i \Delta\delta, \pm F_i)

        with delta the twist, k_i = stiffness, F_i = breakaway, up to 16 elements; without elements there is no hysteresis. The
        clip is exact for any monotone step of the twist, whatever its size. Rate-independent; obeys Masing's rules, wiping-out
        and congruency; symmetric.

        The rule printed in review articles, with a capture position frozen at the last sticking, makes the torque jump at a
        reversal.

        >>> from strainwave.hysteresis import MaxwellSlip
        >>> gear = MaxwellSlip(stiffness=[1000, 600, 300, 100], breakaway=[0.5, 0.9, 0.9, 0.6])
        >>> gear.trace([0.0, 0.004, -0.002]).round(12)
        array([ 0. ,  2.7, -2.5]))";

    static constexpr bool odd = true, return_point_memory = true, congruent = true, masing = true;

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_FIELD(m, stiffness, "N.m/rad", "Stiffness k_i of each element while it sticks", smallest));
        visit(SW_FIELD(m, breakaway, "N.m", "Torque F_i at which each element slips", 0));
    }

    constexpr const char* problem() const {
        return stiffness.count == breakaway.count ? nullptr : "stiffness and breakaway must have equally many elements";
    }

    struct State {
        Array<S, capacity> torque{};

        template <class Self, class Visit>
        static constexpr void fields(Self& m, Visit&& visit) {
            visit(SW_FIELD(m, torque, "N.m", "Torque T_i held by each element"));
        }
    };

    /// Move the twist by `increment` [rad], monotonically; only the elements that there are change.
    constexpr void move(State& x, const S& increment) const {
        for (int i = 0; i < stiffness.count; ++i) x.torque[i] = held(x, i, increment);
    }

    /// The elements after the twist has moved by `increment` [rad], monotonically.
    constexpr State advance(const State& x, const S& increment) const {
        State next{};
        for (int i = 0; i < stiffness.count; ++i) next.torque[i] = held(x, i, increment);
        return next;
    }

    /// Torque [N.m] once the twist has moved by `increment` [rad]; the state stays as it is.
    constexpr S torque(const State& x, const S& increment) const {
        S sum{0.0};
        for (int i = 0; i < stiffness.count; ++i) sum = sum + held(x, i, increment);
        return sum;
    }

    /// Work [J] done on the law while the twist moves by `increment` [rad], monotonically: spring work up to slip, then friction.
    constexpr S work(const State& x, const S& increment) const {
        const S sense = sign(increment), path = abs(increment);
        S sum{0.0};
        for (int i = 0; i < stiffness.count; ++i) {
            const S start = sense * x.torque[i], end = sense * held(x, i, increment);
            const S sticking = (end - start) / stiffness[i];
            sum = sum + S(0.5) * (start + end) * sticking + breakaway[i] * (path - sticking);
        }
        return sum;
    }

    /// Elastic energy [J] held by the elements.
    constexpr S stored(const State& x) const {
        S energy{0.0};
        for (int i = 0; i < stiffness.count; ++i) energy = energy + x.torque[i] * x.torque[i] / (S(2.0) * stiffness[i]);
        return energy;
    }

    /// Twist over torque of these elements in parallel with a `spring` [N.m/rad], exactly. The spring, the slope that remains once
    /// all elements slip, must be positive.
    constexpr PrandtlIshlinskii<S> inverse(const S& spring) const {
        const Elements sorted = by_slip();
        Array<S, capacity + 1> slope{};  // of the virgin curve, once so many elements slip
        slope[stiffness.count] = max(spring, S(smallest));
        for (int i = stiffness.count; i > 0; --i) slope[i - 1] = slope[i] + sorted.stiffness[i - 1];

        PrandtlIshlinskii<S> plays{};
        plays.threshold.count = plays.weight.count = stiffness.count + 1;
        plays.weight[0] = S(1.0) / slope[0];
        S slip{0.0};
        for (int i = 0; i < stiffness.count; ++i) {
            plays.threshold[i + 1] = plays.threshold[i] + slope[i] * (sorted.slip[i] - slip);
            plays.weight[i + 1] = S(1.0) / slope[i + 1] - S(1.0) / slope[i];
            slip = sorted.slip[i];
        }
        return plays;
    }

private:
    static_assert(PrandtlIshlinskii<S>::capacity == capacity + 1);

    struct Elements {
        Array<S, capacity> slip{}, stiffness{};
    };
    /// The elements by the twist at which they slip. Every lane has its own order: odd-even transposition.
    constexpr Elements by_slip() const {
        Elements e{};
        for (int i = 0; i < stiffness.count; ++i) {
            e.slip[i] = breakaway[i] / stiffness[i];
            e.stiffness[i] = stiffness[i];
        }
        for (int round = 0; round < stiffness.count; ++round)
            for (int i = round % 2; i + 1 < stiffness.count; i += 2) {
                const auto wrong = e.slip[i + 1] < e.slip[i];
                exchange(e.slip[i], e.slip[i + 1], wrong);
                exchange(e.stiffness[i], e.stiffness[i + 1], wrong);
            }
        return e;
    }
    template <class Mask>
    static constexpr void exchange(S& a, S& b, const Mask& wanted) {
        const S first = select(wanted, b, a), second = select(wanted, a, b);
        a = first;
        b = second;
    }

    constexpr S held(const State& x, int i, const S& increment) const {
        return clip(x.torque[i] + stiffness[i] * increment, -breakaway[i], breakaway[i]);
    }
};

}  // namespace strainwave::hysteresis
