#pragma once
#include <strainwave/compensation/compensator.hpp>
#include <strainwave/compensation/wave.hpp>

namespace strainwave::compensation {

template <class S>
struct IterativeLearning {
    static constexpr int cells = 32;

    S low{-1.0};
    S high{1.0};
    S reach{1e-3};
    S gain{5.0};
    S smoothing{0.0};
    S lag{0.0};
    S min_speed{1.0};
    S max_speed{300.0};
    S limit{1e-3};

    static constexpr auto name = "iterative_learning";
    static constexpr auto source =
        "BristowTharayilAlleyne2006, iterative learning control with a filter Q, over the output angle in place of time and for "
        "each sense of motion; between the two senses: Dahl1968";
    static constexpr auto doc = R"(
        Learning of errors that repeat over the output angle, such as lost motion, for each sense of motion.

        .. math:: \hat e = \sum_j w_j(r)\,\Big(\tfrac{1 + s}{2} f_j + \tfrac{1 - s}{2} b_j\Big), \qquad
                  ds = (\operatorname{sgn}(dr) - s)\, \frac{|dr|}{r_0}

        .. math:: \dot f_j = \tfrac{1 + s}{2} \Big(\gamma\, w_j(r - \dot r\, t_{lag})\,(r - \theta_{out})
                  - \sigma\, w_j(r)\,\big(f_j - \tfrac{1}{2}(f_{j-1} + f_{j+1})\big)\Big)

        with r the commanded and theta_out the measured output angle, w_j the hat functions of 32 angles from ``low`` to
        ``high``, f_j and b_j the tables of forward and backward motion, gamma = gain, sigma = smoothing, t_lag = lag of the
        position loop, s the sense of motion, r_0 = reach; b_j follows likewise with 1 - s. The input leads by i e^. Beyond the
        ends the lead is constant. Learning needs an angle within ``low`` and ``high`` and an input speed between ``min_speed``
        and ``max_speed``. No value exceeds ``limit``. Keep reach above the way of the command in a period: after a reversal
        the lead changes at 2 |dr/dt| / reach times half of f - b.

        A pass at output speed v over cells of width h leaves 1 - gamma h / v of an error that does not vary over the angle; at
        the ends half as much is learnt. gamma is at most v / h and at most one per period, whatever ``gain``: no pass learns
        more than the whole error. The cells within v t_lag of the end of a pass are not learnt. A wave of the error is learnt
        if the position loop lags by less than 90 degrees beyond ``lag``, as it must up to ``max_speed``. The output encoder is
        needed. Errors that change within two cells are not learnt: Repetitive and AdaptiveFourier learn errors that repeat
        with the input.

        >>> from strainwave.compensation import IterativeLearning
        >>> IterativeLearning(low=-0.5, high=0.5).limit
        0.001)";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_FIELD(m, low, "rad", "Least output angle of the tables", -1e6, 1e6));
        visit(SW_FIELD(m, high, "rad", "Largest output angle of the tables", -1e6, 1e6));
        visit(SW_FIELD(m, reach, "rad", "Output angle r_0 after a reversal over which the old sense falls to 1/e", 1e-9));
        visit(SW_FIELD(m, gain, "1/s", "Rate gamma at which a value follows the error", 0));
        visit(SW_FIELD(m, smoothing, "1/s", "Rate sigma at which a value follows its neighbours", 0));
        visit(SW_FIELD(m, lag, "s", "Lag t_lag of the position loop", 0));
        visit(SW_FIELD(m, min_speed, "rad/s", "Least input speed of learning", 0));
        visit(SW_FIELD(m, max_speed, "rad/s", "Largest input speed of learning", smallest));
        visit(SW_FIELD(m, limit, "rad", "Largest value at the output", 0));
    }

    constexpr const char* problem() const {
        return all(high - low >= S(1e-6)) ? nullptr : "high must exceed low by 1e-6 rad or more";
    }

    struct State {
        Array<S, cells> forward{}, backward{};
        S angle{0.0};
        S sense{0.0};
        S begun{0.0};

        template <class Self, class Visit>
        static constexpr void fields(Self& m, Visit&& visit) {
            visit(SW_FIELD(m, forward, "rad", "Lead at the output of forward motion, at each angle"));
            visit(SW_FIELD(m, backward, "rad", "Lead at the output of backward motion, at each angle"));
            visit(SW_FIELD(m, angle, "rad", "Output angle commanded"));
            visit(SW_FIELD(m, sense, "1", "Sense of motion, in [-1, 1]"));
            visit(SW_FIELD(m, begun, "1", "1 after the first instant"));
        }
    };

    constexpr Request<S> request(const State& x, const Inputs<S>& inputs) const {
        const S sense = sense_at(x, inputs.command.value), place = placed(inputs.command.value);
        const S ahead = S(0.5) * (S(1.0) + sense), astern = S(0.5) * (S(1.0) - sense);
        S lead(0.0), slope(0.0), half(0.0);
        for (int j = 0; j < cells; ++j) {
            const S value = ahead * x.forward[j] + astern * x.backward[j], apart = place - S(j);
            lead = lead + hat(apart) * value;
            half = half + S(0.5) * hat(apart) * (x.forward[j] - x.backward[j]);
            slope = slope - select(abs(apart) < S(1.0), sign(apart), S(0.0)) * value;
        }
        const S rate = inputs.command.rate, turned = (sign(rate) - sense) * abs(rate) / reach;
        const S along = select(within(inputs.command.value) > S(0.0), slope * per_angle() * rate, S(0.0));
        return {inputs.command.ratio * lead, inputs.command.ratio * (along + half * turned), S(0.0), S(0.0), S(0.0)};
    }
    constexpr State advance(const State& x, const Inputs<S>& inputs, const Request<S>&, const S&, const S& period) const {
        const S at = inputs.command.value, speed = abs(inputs.input_speed()), error = at - inputs.measured.output_angle;
        const S below = select(speed < max_speed, period * within(at), S(0.0));
        const S step = select(speed < min_speed, S(0.0), below), sense = sense_at(x, at);
        const S caused_at = at - inputs.command.rate * lag, late = placed(caused_at), place = placed(at);
        State next{x.forward, x.backward, at, sense, S(1.0)};
        const S rate = min(min(gain, abs(inputs.command.rate) * per_angle()), S(1.0) / period);
        const S change = within(caused_at) * rate * error;
        learn(next.forward, x.forward, S(0.5) * (S(1.0) + sense) * step, late, place, change);
        learn(next.backward, x.backward, S(0.5) * (S(1.0) - sense) * step, late, place, change);
        return next;
    }

private:
    constexpr void learn(Array<S, cells>& next, const Array<S, cells>& table, const S& step, const S& late, const S& place,
                         const S& change) const {
        const S share = min(smoothing * step, S(1.0));
        for (int j = 0; j < cells; ++j) {
            const S even = S(0.5) * (table[j == 0 ? 0 : j - 1] + table[j == cells - 1 ? j : j + 1]);
            const S moved = step * hat(late - S(j)) * change - share * hat(place - S(j)) * (table[j] - even);
            next[j] = clip(table[j] + moved, -limit, limit);
        }
    }
    constexpr S sense_at(const State& x, const S& angle) const { return slid_sense(x.sense, x.begun * (angle - x.angle), reach); }
    constexpr S per_angle() const { return S(cells - 1) / (high - low); }
    /// 1 within the ends, else 0.
    constexpr S within(const S& angle) const { return select(angle < low, S(0.0), select(angle > high, S(0.0), S(1.0))); }
    /// Position of an angle in the tables [cells]; that of an end beyond it.
    constexpr S placed(const S& angle) const { return clip((angle - low) * per_angle(), S(0.0), S(cells - 1)); }
};

}  // namespace strainwave::compensation
