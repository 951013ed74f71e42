#pragma once
#include <strainwave/compensation/compensator.hpp>
#include <strainwave/compensation/wave.hpp>

namespace strainwave::compensation {

template <class S>
struct Repetitive {
    static constexpr int cells = 32;

    S gain{5.0};
    S smoothing{0.0};
    S lag{0.0};
    S min_speed{1.0};
    S max_speed{30.0};
    S limit{1e-3};

    static constexpr auto name = "repetitive";
    static constexpr auto source =
        "HaraYamamotoOmataNakano1988, repetitive control with a filter Q, over the input angle in place of time and with local "
        "functions in place of a delay";
    static constexpr auto doc = R"(
        Learning of errors of any shape that repeat with each turn of the input: a table over the input angle.

        .. math:: \hat e(\theta) = \sum_j c_j\, w_j(\theta), \qquad \dot c_j = \gamma\, w_j(\theta - \omega\, t_{lag})\,
                  (r - \theta_{out}) - \sigma\, w_j(\theta)\,\big(c_j - \tfrac{1}{2}(c_{j-1} + c_{j+1})\big)

        with w_j the hat functions of 32 equal cells of a turn, gamma = gain, sigma = smoothing, t_lag = lag of the position loop.
        The term of sigma is the filter Q: it removes differences between neighbouring cells. The input leads by i e^. Learning
        needs an input speed between ``min_speed`` and ``max_speed``. At max_speed the highest order of the error must lag by less
        than 90 degrees. No value exceeds ``limit``. Orders above 8 are learnt in part only. Errors that do not repeat with each
        turn of the input are not learnt: AdaptiveFourier learns any order.

        >>> from strainwave.compensation import Repetitive
        >>> Repetitive(gain=10.0).limit
        0.001)";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_FIELD(m, gain, "1/s", "Rate gamma at which a cell follows the error", 0));
        visit(SW_FIELD(m, smoothing, "1/s", "Rate sigma at which a cell follows its neighbours", 0));
        visit(SW_FIELD(m, lag, "s", "Lag t_lag of the position loop", 0));
        visit(SW_FIELD(m, min_speed, "rad/s", "Least input speed of learning", 0));
        visit(SW_FIELD(m, max_speed, "rad/s", "Largest input speed of learning", smallest));
        visit(SW_FIELD(m, limit, "rad", "Largest value at the output", 0));
    }

    struct State {
        Array<S, cells> value{};

        template <class Self, class Visit>
        static constexpr void fields(Self& m, Visit&& visit) {
            visit(SW_FIELD(m, value, "rad", "Value at the beginning of each cell"));
        }
    };

    constexpr Request<S> request(const State& x, const Inputs<S>& inputs) const {
        const S place = placed(inputs.measured.input_angle);
        S value(0.0), slope(0.0);
        for (int j = 0; j < cells; ++j) {
            const S apart = distance(place, j);
            value = value + hat(apart) * x.value[j];
            slope = slope - select(abs(apart) < S(1.0), sign(apart), S(0.0)) * x.value[j];
        }
        const S ratio = inputs.command.ratio, per_angle = S(cells / (2.0 * pi));
        return {ratio * value, ratio * slope * per_angle * inputs.input_speed(), S(0.0), S(0.0), S(0.0)};
    }
    constexpr State advance(const State& x, const Inputs<S>& inputs, const Request<S>&, const S&, const S& period) const {
        const S speed = inputs.input_speed(), error = inputs.command.value - inputs.measured.output_angle;
        const S below = select(abs(speed) < max_speed, period, S(0.0)), step = select(abs(speed) < min_speed, S(0.0), below);
        const S place = placed(inputs.measured.input_angle), late = placed(inputs.measured.input_angle - speed * lag);
        const S taken = min(smoothing * step, S(1.0));
        State next = x;
        for (int j = 0; j < cells; ++j) {
            const S even = S(0.5) * (x.value[(j + cells - 1) % cells] + x.value[(j + 1) % cells]);
            const S moved = gain * step * hat(distance(late, j)) * error - taken * hat(distance(place, j)) * (x.value[j] - even);
            next.value[j] = clip(x.value[j] + moved, -limit, limit);
        }
        return next;
    }

private:
    /// Position of an angle in the table [cells].
    static constexpr S placed(const S& angle) {
        const S turns = angle * S(0.5 / pi);
        return S(cells) * (turns - rint(turns));
    }
    /// Distance from the begin of cell j, wrapped to half a turn [cells].
    static constexpr S distance(const S& place, int j) {
        const S apart = place - S(j);
        return apart - S(cells) * rint(apart * S(1.0 / cells));
    }
};

}  // namespace strainwave::compensation
