#pragma once
#include <strainwave/any.hpp>
#include <strainwave/integrate.hpp>

#include <cstdint>
#include <functional>

/// A drive run through time, for any scalar: the loop that Python's `simulate` and `fit` stand on.
namespace strainwave::host {

/// The command over `steps` steps: instants[0..steps], and per step the inputs at its start, middle and end.
struct Course {
    const double* instants;
    const double* inputs;      ///< (steps, 3, 3): command, command_rate, load_torque
    const std::uint8_t* keep;  ///< (steps): whether to record the end of the step
    std::size_t steps;
};

template <class S>
Interval<S> interval(const double* inputs) {
    const auto at = [](const double* u) { return Input<S>{S(u[0]), S(u[1]), S(u[2])}; };
    return {at(inputs), at(inputs + 3), at(inputs + 6)};
}

/// How many steps pass between two calls of `pause`, which may throw.
inline constexpr std::size_t steps_between_pauses = 1 << 14;

/// Runs `drive` from `x` and calls record(output) at the end of each step to be kept. Returns the state at the end.
template <class S, class Record>
typename AnyPositionDrive<S>::State run(const AnyPositionDrive<S>& drive, typename AnyPositionDrive<S>::State x,
                                        const Course& course, Record&& record, const std::function<void(std::size_t)>& pause) {
    const auto fast = drive.compile();
    x = fast.consistent(x);
    for (std::size_t i = 0; i < course.steps; ++i) {
        if (i % steps_between_pauses == 0) pause(i);
        const Interval<S> u = interval<S>(course.inputs + 9 * i);
        x = step<S>(fast, x, u, S(course.instants[i + 1] - course.instants[i]));
        if (course.keep[i]) record(fast.output(x, u.end));
    }
    return x;
}

}  // namespace strainwave::host
