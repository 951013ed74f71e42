#pragma once
#include <strainwave/compensation/compensator.hpp>

namespace strainwave::compensation {

template <class S>
struct LostMotionMap {
    static constexpr int capacity = 32;

    Sequence<S, capacity> angle{};
    Sequence<S, capacity> forward{};
    Sequence<S, capacity> backward{};
    S reach{1e-3};

    static constexpr auto name = "lost_motion_map";
    static constexpr auto source = SW_TORSION_ARTICLE ", which asks for maps of compensation; between the two branches: Dahl1968";
    static constexpr auto doc = R"(
        Lead of the input by a table of measured lost motion over the output angle, for each sense of motion.

        .. math:: \theta = i\,\Big(r + \tfrac{1 + s}{2} f(r) + \tfrac{1 - s}{2} b(r)\Big), \qquad
                  ds = (\operatorname{sgn}(dr) - s)\, \frac{|dr|}{r_0}

        with r the commanded output angle, f and b the lines through forward and backward over angle. angle increases; beyond
        its ends f and b are constant. s is the sense of motion: at an angle r_0 = reach after a reversal 1/e of the lost
        motion is left. Before the first motion s = 0, the middle of both. The map needs no model. It does not depend on load
        and speed.

        >>> from strainwave.compensation import LostMotionMap
        >>> LostMotionMap(angle=[0.0], forward=[2e-4], backward=[-2e-4]).reach
        0.001)";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_FIELD(m, angle, "rad", "Output angles, rising"));
        visit(SW_FIELD(m, forward, "rad", "Lead at the output of forward motion"));
        visit(SW_FIELD(m, backward, "rad", "Lead at the output of backward motion"));
        visit(SW_FIELD(m, reach, "rad", "Output angle r_0 after a reversal over which the remaining lost motion falls to 1/e",
                       smallest));
    }

    constexpr const char* problem() const {
        if (angle.count != forward.count || angle.count != backward.count)
            return "angle, forward and backward must have equally many elements";
        for (int k = 1; k < angle.count; ++k)
            if (!all(angle[k] > angle[k - 1])) return "angle must increase";
        return nullptr;
    }

    struct State {
        S angle{0.0};
        S sense{0.0};
        S lead{0.0};
        S begun{0.0};

        template <class Self, class Visit>
        static constexpr void fields(Self& m, Visit&& visit) {
            visit(SW_FIELD(m, angle, "rad", "Output angle commanded"));
            visit(SW_FIELD(m, sense, "1", "Sense of motion, in [-1, 1]"));
            visit(SW_FIELD(m, lead, "rad", "Lead at the output"));
            visit(SW_FIELD(m, begun, "1", "1 after the first instant"));
        }
    };

    constexpr RequestAndState<S, State> step(const State& x, const control::Command<S>& command, const S& period) const {
        const S sense = slid_sense(x.sense, x.begun * (command.value - x.angle), reach);
        const S mean = S(0.5) * (on(forward, command.value) + on(backward, command.value));
        const S half = S(0.5) * (on(forward, command.value) - on(backward, command.value));
        const S lead = mean + sense * half, rate = x.begun * (lead - x.lead) / period;
        return {{command.ratio * lead, command.ratio * rate, command.ratio * lead, S(0.0), S(0.0)},
                {command.value, sense, lead, S(1.0)}};
    }

private:
    constexpr S on(const Sequence<S, capacity>& line, const S& at) const {
        if (angle.count == 0) return S(0.0);
        S value = line[0];
        for (int k = 1; k < angle.count; ++k) {
            const S share = clip((at - angle[k - 1]) / (angle[k] - angle[k - 1]), S(0.0), S(1.0));
            value = value + share * (line[k] - line[k - 1]);
        }
        return value;
    }
};

}  // namespace strainwave::compensation
