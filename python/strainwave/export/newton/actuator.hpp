// A drive behind a joint of Newton: its numbers, its state, and its steps. The joint prescribes the motion of the output shaft.
#pragma once
// Mathematics of the C library under the names of <cmath>, for compilers that come without the C++ library, such as Warp's for the
// CPU.
#define SW_NO_STANDARD_LIBRARY
#if !defined(__CUDACC_RTC__)
namespace std {
#include "mathematics.hpp"
}  // namespace std
#endif
#include <strainwave/kernel/assemble.hpp>

#include "contradictions.hpp"
#include "drive.hpp"  // S, Drive, laws, shape, parameter_count, output_count, command_is, is_followed; written for each drive
#include "stretches.hpp"

namespace actuator {

using Compiled = decltype(Drive<S>{}.compile());
using Evaluation = Compiled::Evaluation;
using State = Compiled::State;
using Input = strainwave::Input<S>;
using Steps = strainwave::integrate::Steps<S, Compiled>;

inline constexpr int settling_rounds = 8;  // the kinematic error depends on the angle that it changes

// Motion and command of a joint at an instant.
struct Instant {
    S position, speed, command, command_rate;
};
// A gear between two calls: whether it has begun, the last instant, the numbers of its state.
inline constexpr int first_state = 5, memory_count = first_state + strainwave::size_of<S, State>;

// A gear with its numbers, made once.
struct Prepared {
    Compiled drive;
    S temperature;  // K
};
static_assert(alignof(Prepared) <= 8 && __is_trivially_copyable(Prepared));
inline constexpr int prepared_words = (sizeof(Prepared) + 7) / 8;  // of 8 bytes

// Write the size of a gear, in words of 8 bytes.
inline void measure(int* words) { words[0] = prepared_words; }

// Make gear `i` of its numbers, a row of `numbers`; the last is the temperature. `problems[i]` is 1 if they contradict each other.
inline void prepare(int i, const S* numbers, double* prepared, int* problems) {
    strainwave::kernel::Reader<S> from{laws, shape, numbers + i * (parameter_count + 1)};
    const auto model = strainwave::kernel::assembled<Drive<S>>(from);
    strainwave::exported::Contradictions found;
    found.of(model);
    problems[i] = found.text != nullptr;
    *reinterpret_cast<Prepared*>(prepared + i * prepared_words) = {model.compile(), *from.numbers};
}

// The motion of a joint from one instant to the next: Hermite's cubic. The command of the first goes on at its rate; a command that
// is followed and has no rate moves to the next in a line.
class Motion {
    Instant from;
    S temperature, span, begin, bend, turn;

public:
    constexpr Motion(const Instant& from_, const Instant& to, const S& dt, const S& temperature_)
        : from(from_), temperature(temperature_), span(dt), begin(dt * from_.speed), bend{}, turn{} {
        const S moved = to.position - from.position, end = dt * to.speed;
        bend = S(3.0) * moved - S(2.0) * begin - end;
        turn = begin + end - S(2.0) * moved;
    }
    constexpr Input at(const S& time) const {
        const S x = time / span;
        return {from.command + from.command_rate * time,
                from.command_rate,
                from.position + x * (begin + x * (bend + x * turn)),
                (begin + x * (S(2.0) * bend + S(3.0) * x * turn)) / span,
                temperature,
                S(0.0)};
    }
};

// The drive untwisted, at the angle and the speed of its joint.
constexpr State at_joint(const Compiled& drive, const Input& u) {
    State x = drive.rest();
    const S ratio = drive.gear.kinematics.ratio();
    x.continuous.input_speed = ratio * u.load_rate;  // first, as the bodies within a gear move with the shafts
    x.continuous.output_speed = u.load_rate;
    for (int i = 0; i < settling_rounds; ++i) {
        const S angle = ratio * (u.load + x.continuous.transmission_error);
        x.turns = strainwave::rint(angle / S(2.0 * strainwave::pi));
        x.continuous.input_angle = angle - x.turns * S(2.0 * strainwave::pi);
        drive.settle_gear(x, drive.geometry(x, x.continuous, u), S(0.0), S(0.0), u.temperature);
    }
    x.continuous.sensors = drive.sensors.steady_state(drive.measurable(x, x.continuous, u, S(0.0)));
    return drive.consistent(x);
}

// Take gear `i` of `count` to the present instant of its joint, `dt` [s] after the last. A number of one gear lies next to that
// of the next gear. `places` are those of position, speed, target position and target speed; `feedforward` may be null.
inline void advance(int i, int count, const double* prepared, int prepared_count, const S* before, S* after, const float* position,
                    const float* speed, const float* target_position, const float* target_speed, const float* feedforward,
                    const unsigned* position_place, const unsigned* speed_place, const unsigned* target_position_place,
                    const unsigned* target_speed_place, double dt, double max_step, float* torque, float* outputs) {
    const int number = prepared_count > 1 ? i : 0;
    const auto& gear = *reinterpret_cast<const Prepared*>(prepared + number * prepared_words);
    const unsigned driven = target_speed_place[i];
    Instant now{S(position[position_place[i]]), S(speed[speed_place[i]]), S(0.0), S(0.0)};
    if constexpr (command_is == CommandIs::position) {
        now.command = S(target_position[target_position_place[i]]);
        now.command_rate = S(target_speed[driven]);
    } else if constexpr (command_is == CommandIs::speed) {
        now.command = S(target_speed[driven]);
    } else if (feedforward) {
        now.command = S(feedforward[driven]);
    }
    const bool has_begun = before[i] != S(0.0);
    Instant last{before[count + i], before[2 * count + i], before[3 * count + i], before[4 * count + i]};
    S rate = now.command_rate;
    if (has_begun && is_followed && last.command_rate == S(0.0) && rate == S(0.0))
        last.command_rate = rate = (now.command - last.command) / S(dt);
    const Input u{now.command, rate, now.position, now.speed, gear.temperature, S(0.0)};
    Evaluation here{};
    if (has_begun) {
        strainwave::Flat<S, State> numbers{};
        for (int k = 0; k < memory_count - first_state; ++k) numbers[k] = before[(first_state + k) * count + i];
        const Motion motion(last, now, S(dt), gear.temperature);
        here = gear.drive.evaluate(strainwave::refilled(gear.drive.initial_state(), numbers), motion.at(S(0.0)));
        Steps steps;
        strainwave::exported::advance(
            gear.drive, here, [&motion](const S& after) { return motion.at(after); }, S(dt), S(max_step), steps,
            [](const S&) { return true; });
        here = gear.drive.evaluate(here.state, u);
    } else {
        here = gear.drive.evaluate(at_joint(gear.drive, u), u);
    }
    const S kept[first_state] = {S(1.0), now.position, now.speed, now.command, now.command_rate};
    for (int k = 0; k < first_state; ++k) after[k * count + i] = kept[k];
    const auto numbers = strainwave::flattened<S>(here.state);
    for (int k = 0; k < memory_count - first_state; ++k) after[(first_state + k) * count + i] = numbers[k];
    const auto shown = gear.drive.output(here, u);
    const auto all = strainwave::flattened<S>(shown);
    static_assert(strainwave::size_of<S, decltype(shown)> == output_count);
    for (int k = 0; k < output_count; ++k) outputs[k * count + i] = float(all[k]);
    torque[i] = float(shown.load_torque);
}

}  // namespace actuator
