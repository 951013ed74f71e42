#pragma once
#include <strainwave/drive.hpp>

namespace strainwave {

/// The inputs over one step: at its start, middle and end.
template <class S>
struct Interval {
    Input<S> start{}, middle{}, end{};

    /// The stretch between two fractions of the step.
    constexpr Interval part(const S& from, const S& to, const S& dt) const {
        return {at(from, dt), at(S(0.5) * (from + to), dt), at(to, dt)};
    }

    /// At a fraction of the step. Between the three instants the command is Hermite's cubic, all else the parabola through them.
    constexpr Input<S> at(const S& fraction, const S& dt) const {
        const auto late = fraction > S(0.5);
        const S x = S(2.0) * fraction - select(late, S(1.0), S(0.0)), half = S(0.5) * dt;
        const S a = select(late, middle.command, start.command), b = select(late, end.command, middle.command);
        const S da = half * select(late, middle.command_rate, start.command_rate);
        const S db = half * select(late, end.command_rate, middle.command_rate);
        const S bend = S(3.0) * (b - a) - S(2.0) * da - db, turn = S(2.0) * (a - b) + da + db;
        const auto parabola = [&](S Input<S>::* signal) {
            const S from = start.*signal, bow = S(2.0) * (from - S(2.0) * (middle.*signal) + end.*signal);
            return from + fraction * ((end.*signal - from - bow) + fraction * bow);
        };
        return {a + x * (da + x * (bend + x * turn)), (da + x * (S(2.0) * bend + S(3.0) * x * turn)) / max(half, S(smallest)),
                parabola(&Input<S>::load_torque), parabola(&Input<S>::temperature)};
    }
};

}  // namespace strainwave
