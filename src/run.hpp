#pragma once
#include <strainwave/integrate.hpp>
#include <strainwave/scalar/dual.hpp>
#include <strainwave/scalar/pack.hpp>

#include "narrow.hpp"

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <functional>
#include <new>

/// A drive run through time, for any scalar: the loop that Python's `simulate` and `fit` stand on.
namespace strainwave::host {

/// How many numbers drive a drive from outside.
inline constexpr int driving = size_of<double, Input<double>>;

/// The command over `steps` steps: instants[0..steps], and per step the inputs at its start, middle and end.
struct Course {
    const double* instants;
    const double* inputs;      ///< (steps, 3, driving): what `Input` holds
    const std::uint8_t* keep;  ///< (steps): whether to record the end of the step
    std::size_t steps;
};

// Calls f with what each lane of some scalars holds.
template <class F>
void each_lane(double a, double b, double c, F&& f) {
    f(a, b, c);
}
template <int n, class F>
void each_lane(const Dual<n>& a, const Dual<n>& b, const Dual<n>& c, F&& f) {
    f(a.value, b.value, c.value);
}
template <int n, class F>
void each_lane(const Pack<n>& a, const Pack<n>& b, const Pack<n>& c, F&& f) {
    for (int i = 0; i < n; ++i) f(a[i], b[i], c[i]);
}

template <class S>
Interval<Input<S>> interval(const double* inputs) {
    const auto at = [](const double* u) { return Input<S>{S(u[0]), S(u[1]), S(u[2]), S(u[3])}; };
    return {at(inputs), at(inputs + driving), at(inputs + 2 * driving)};
}

/// Called now and then with the number of steps done; may throw.
using Pause = std::function<void(std::size_t)>;

/// What an output may be at most: no angle beyond is told to within a radian.
inline constexpr double largest = 1e15;

/// 1 where every output is a number up to the largest, else 0.
template <class S>
S soundness(const Output<S>& output) {
    S sound{1.0};
    const auto values = flattened<S>(output);
    for (int c = 0; c < values.size(); ++c) sound = select(S(largest) >= abs(values[c]), sound, S(0.0));
    return sound;
}

/// A drive has left the range that one of its parts is valid in.
struct OutOfBounds {
    const char* part;
    Domain<double> domain;
    double time;
};

/// Throws OutOfBounds if a part is not valid where the drive stands, in any lane.
template <class S, class Drive>
void check_bounds(const Drive& drive, const typename Drive::Evaluation& at, double time) {
    drive.bounds(at.derivatives, [&](const char* part, const Domain<S>& domain) {
        if (all(domain.holds())) return;
        each_lane(domain.value, domain.low, domain.high, [&](double value, double low, double high) {
            const Domain<double> of_lane{domain.name, value, low, high, domain.unit, domain.remedy};
            if (value == value && !of_lane.holds()) throw OutOfBounds{part, of_lane, time};  // not a number: told at the end
        });
    });
}

/// Calls `pause` some twenty times a second: a step may take a tenth of a microsecond, or milliseconds.
class Pauses {
    using Clock = std::chrono::steady_clock;
    const Pause& pause;
    Clock::time_point due{};

public:
    explicit Pauses(const Pause& pause_) : pause(pause_) {}

    /// After `taken` steps, `done` of those to report.
    void operator()(std::size_t taken, std::size_t done) {
        if (taken % 64 != 0) return;  // to look at the clock takes as long as the fastest steps
        const auto now = Clock::now();
        if (now < due) return;
        due = now + std::chrono::milliseconds(50);
        pause(done);
    }
};

/// A step without events, every call on the way inlined: worth its size where there is not too much to choose from.
template <class S, class Drive>
[[gnu::flatten, gnu::noinline]] typename Drive::Evaluation inlined_step(const Drive& drive, const typename Drive::Evaluation& from,
                                                                        const Interval<Input<S>>& u, const S& dt) {
    return drive.evaluate(integrate::exponential_step(drive, from, u, dt), u.end);
}
template <class S, class Drive>
[[gnu::noinline]] typename Drive::Evaluation called_step(const Drive& drive, const typename Drive::Evaluation& from,
                                                         const Interval<Input<S>>& u, const S& dt) {
    return drive.evaluate(integrate::exponential_step(drive, from, u, dt), u.end);
}

/// Runs a compiled drive from `start` through one step or more and calls record(output) at the end of each step to be kept.
/// `advance` takes a step. Returns the state at the end. What a step returns is made where it stays: to copy it would take a
/// twentieth of the step. A drive that has diverged, in all lanes, stays where that is noticed, and so do its outputs.
template <class S, class Drive, class Record, class Advance>
typename Drive::State run_compiled(const Drive& drive, const typename Drive::State& start, const Course& course, Record& record,
                                   const Pause& pause, const Advance& advance) {
    const bool has_bounds = drive.has_bounds();
    Pauses pauses(pause);
    Interval<Input<S>> u = interval<S>(course.inputs);
    using Evaluation = typename Drive::Evaluation;
    Evaluation places[2]{drive.evaluate(drive.consistent(start), u.start), {}}, *here = places, *there = places + 1;
    if (has_bounds) check_bounds<S>(drive, *here, course.instants[0]);
    bool lost = false;
    for (std::size_t i = 0; i < course.steps; ++i) {
        pauses(i, i);
        if (i % 64 == 0) lost = lost || !any(soundness(drive.output(*here, u.end)) > S(0.0));
        if (lost) {
            if (course.keep[i]) record(drive.output(*here, u.end));
            continue;
        }
        if (i > 0) {
            const double *const inputs = course.inputs + 3 * driving * i, *const before = inputs - driving;
            u = interval<S>(inputs);
            const bool jump = !std::equal(inputs, inputs + driving, before);
            if (jump) *here = drive.evaluate(here->state, u.start);
        }
        new (there) Evaluation(advance(drive, *here, u, S(course.instants[i + 1] - course.instants[i])));
        std::swap(here, there);
        if (has_bounds) check_bounds<S>(drive, *here, course.instants[i + 1]);
        if (course.keep[i]) record(drive.output(*here, u.end));
    }
    return here->state;
}

/// The state at the end of a run, which `runner` does in the code of the first of some lists of models that hold the drive; in that
/// of all models if none does. runner.operator()<whether its steps are inlined>(compiled drive, its state).
template <class S, class Runner, class First, class... Rest>
typename AnyPositionDrive<S>::State run_among(const AnyPositionDrive<S>& drive, const typename AnyPositionDrive<S>::State& start,
                                              const Runner& runner, First*, Rest*... rest) {
    NarrowDrive<S, First> narrow{};
    if (narrowed<S>(narrow, drive)) {
        const auto from = refilled<S, typename decltype(narrow.compile())::State>(start);
        return refilled<S, typename AnyPositionDrive<S>::State>(
            runner.template operator()<inlined<S, First>>(narrow.compile(), from));
    }
    if constexpr (sizeof...(Rest) > 0)
        return run_among<S>(drive, start, runner, rest...);
    else
        return runner.template operator()<false>(drive.compile(), start);
}

/// Runs `drive` in steps of fourth order, with events.
template <class S, class Record>
typename AnyPositionDrive<S>::State run(const AnyPositionDrive<S>& drive, const typename AnyPositionDrive<S>::State& start,
                                        const Course& course, Record&& record, const Pause& pause) {
    const auto runner = [&]<bool inlines, class Compiled>(const Compiled& compiled, const typename Compiled::State& from) {
        const auto advance = [](const Compiled& moved, const typename Compiled::Evaluation& at, const Interval<Input<S>>& u,
                                const S& dt) {
            if constexpr (inlines)
                return step(moved, at, u, dt, inlined_step<S, Compiled>);
            else
                return step(moved, at, u, dt, called_step<S, Compiled>);
        };
        return run_compiled<S>(compiled, from, course, record, pause, advance);
    };
    return run_among<S>(drive, start, runner, static_cast<DrivesOnBristles*>(nullptr), static_cast<DrivesWithoutMemory*>(nullptr),
                        static_cast<Small*>(nullptr));
}

}  // namespace strainwave::host
