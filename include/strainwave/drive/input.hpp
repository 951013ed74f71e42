#pragma once
#include <strainwave/field.hpp>
#include <strainwave/math.hpp>
#include <strainwave/room_temperature.hpp>

namespace strainwave {

/// Inputs of a drive at one instant: one signal for each part that takes one, and its rate.
template <class S>
struct Input {
    S command{0.0};
    S command_rate{0.0};
    S load{0.0};
    S load_rate{0.0};
    S temperature{room_temperature};  ///< K
    S temperature_rate{0.0};

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_FIELD(m, command, "1", "Command of the controller, in the unit that it takes"));
        visit(SW_FIELD(m, command_rate, "1/s", "Rate of the command"));
        visit(SW_FIELD(m, load, "1", "Input of the load: a torque that holds the output back, a brake torque or an output angle"));
        visit(SW_FIELD(m, load_rate, "1/s", "Rate of the input of the load"));
        visit(SW_FIELD(m, temperature, "K", "Temperature around the drive"));
        visit(SW_FIELD(m, temperature_rate, "K/s", "Rate of the temperature around the drive"));
    }

    /// Inputs at a fraction of a step. The command is Hermite's cubic between the three instants, all else the parabola through
    /// them.
    static constexpr Input between(const Input& start, const Input& middle, const Input& end, const S& fraction, const S& dt) {
        const auto late = fraction > S(0.5);
        const S x = S(2.0) * fraction - select(late, S(1.0), S(0.0)), half = S(0.5) * dt;
        const S a = select(late, middle.command, start.command), b = select(late, end.command, middle.command);
        const S da = half * select(late, middle.command_rate, start.command_rate);
        const S db = half * select(late, end.command_rate, middle.command_rate);
        const S bend = S(3.0) * (b - a) - S(2.0) * da - db, turn = S(2.0) * (a - b) + da + db;
        const auto parabola = [&](S Input::* signal) {
            const S from = start.*signal, bow = S(2.0) * (from - S(2.0) * (middle.*signal) + end.*signal);
            return from + fraction * ((end.*signal - from - bow) + fraction * bow);
        };
        return {a + x * (da + x * (bend + x * turn)),
                (da + x * (S(2.0) * bend + S(3.0) * x * turn)) / max(half, S(smallest)),
                parabola(&Input::load),
                parabola(&Input::load_rate),
                parabola(&Input::temperature),
                parabola(&Input::temperature_rate)};
    }
};

}  // namespace strainwave
