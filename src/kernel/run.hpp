#pragma once
#include <strainwave/drive/own_motion.hpp>
#include <strainwave/initial.hpp>
#include <strainwave/integrate.hpp>

#include "lanes.hpp"
#include "places.hpp"
#include "table.hpp"

/// A drive run through time, for any scalar: the loop that `simulate` and `fit` stand on.
namespace strainwave::kernel {

template <class S>
constexpr Input<S> input_from(const double* u) {
    Array<S, input_count> numbers;
    for (int i = 0; i < input_count; ++i) numbers[i] = S(u[i]);
    return shaped<Input<S>>(numbers);
}
template <class S>
constexpr Interval<Input<S>> interval(const double* inputs) {
    return {input_from<S>(inputs), input_from<S>(inputs + input_count), input_from<S>(inputs + 2 * input_count)};
}

/// All that a drive of a type can show at one instant.
template <class S, class Drive>
auto shown(const Drive& drive, const typename Drive::Evaluation& at, const Input<S>& u) {
    return flattened<S>(drive.output(at, u));
}

/// The twist among the outputs.
inline constexpr int twist_place = [] {
    using None = Stateless<double>;
    int place = -1, count = 0;
    Output<double, None, None, None, None> output{};
    Output<double, None, None, None, None>::fields(output, [&](const auto&, const Field& field) {
        if (same(field.name, "twist")) place = count;
        ++count;
    });
    return place;
}();

/// 1 where every output is a number up to the largest, else 0.
template <class S, int n>
S soundness(const Array<S, n>& outputs) {
    S sound{1.0};
    for (int c = 0; c < n; ++c) sound = select(S(largest) >= abs(outputs[c]), sound, S(0.0));
    return sound;
}

/// True if all parts are valid at this instant, in all lanes; otherwise `outcome` names the first that is not.
template <class S, class Drive>
bool within_bounds(const Drive& drive, const typename Drive::Evaluation& at, double time, Outcome& outcome) {
    drive.bounds(at.derivatives, [&](const char* part, const Domain<S>& domain) {
        if (outcome.ending == Ending::out_of_bounds || all(domain.holds())) return;
        each_lane(domain.value, domain.low, domain.high, [&](double value, double low, double high) {
            const Domain<double> of_lane{domain.name, value, low, high, domain.unit, domain.remedy};
            if (outcome.ending == Ending::out_of_bounds || value != value || of_lane.holds())
                return;  // not a number: seen at the end
            outcome.ending = Ending::out_of_bounds;
            outcome.part = part;
            outcome.domain = of_lane;
            outcome.from = time;
        });
    });
    return outcome.ending != Ending::out_of_bounds;
}

/// Half a step of `dt` [s]: two instants closer than this are the same instant.
inline constexpr double time_tolerance(double dt) { return 0.5 * dt; }

/// A state from outside where a run begins.
template <class S, class Drive>
typename Drive::Evaluation initial_evaluation(const Drive& drive, const typename Drive::State& start, const Input<S>& u,
                                              const S& within) {
    return system::up_to_date(drive, drive.evaluate(drive.consistent(start), u), u, within);
}

/// A step without events. A kernel may ask to inline every call on the way.
template <class S, class Drive>
#ifdef SW_INLINE_STEPS
[[gnu::flatten]]
#endif
#if defined(__CUDACC_RTC__)
__noinline__
#else
[[gnu::noinline]]
#endif
    typename Drive::Evaluation smooth_step(const Drive& drive, const typename Drive::Evaluation& from, const Interval<Input<S>>& u,
                                           const S& dt, integrate::Steps<S, Drive>& steps) {
    if constexpr (Drive::foresees) {
        return integrate::foreseeing_step(drive, from, u, dt);
    } else {
        typename Drive::Evaluation at{steps(drive, from, u, dt), {}};
        drive.refresh(at, u.end);
        return at;
    }
}

/// Runs a drive from `state` through one step or more and calls record(outputs) at the end of each step to be kept. `advance` takes
/// a step. `state` becomes that at the end. What a step returns is made where it stays: to copy it would take a twentieth of the
/// step. A drive that has diverged, in all lanes, stays where that is noticed, and so do its outputs.
template <class S, class Drive, class Record, class Advance>
Outcome run_steps(const Drive& drive, typename Drive::State& state, const Schedule& schedule, Record& record,
                  const Progress& progress, const Advance& advance) {
    Outcome outcome;
    const bool has_bounds = drive.has_bounds();
    Interval<Input<S>> u = interval<S>(schedule.inputs);
    using Evaluation = typename Drive::Evaluation;
    Evaluation places[2]{initial_evaluation(drive, state, u.start, S(time_tolerance(schedule.first_step()))), {}},
        *here = places, *there = places + 1;
    if (has_bounds && !within_bounds<S>(drive, *here, schedule.instants[0], outcome)) return outcome;
    bool lost = false;
    for (std::size_t i = 0; i < schedule.steps; ++i) {
        if (progress.stops(i, i)) {
            outcome.ending = Ending::stopped;
            return outcome;
        }
        if (i % 64 == 0) lost = lost || !any(soundness(shown<S>(drive, *here, u.end)) > S(0.0));
        if (lost) {
            if (schedule.keep[i]) record(shown<S>(drive, *here, u.end));
            continue;
        }
        const double dt = schedule.instants[i + 1] - schedule.instants[i];
        if (i > 0) {
            const double *const inputs = schedule.inputs + 3 * input_count * i, *const before = inputs - input_count;
            u = interval<S>(inputs);
            const bool jump = !std::equal(inputs, inputs + input_count, before);
            if (jump) *here = drive.evaluate(here->state, u.start);
            const S within(time_tolerance(dt));
            if (system::due(drive, here->state, within)) *here = system::sampled(drive, *here, u.start, within);
        }
        new (there) Evaluation(advance(drive, *here, u, S(dt)));
        std::swap(here, there);
        if (has_bounds && !within_bounds<S>(drive, *here, schedule.instants[i + 1], outcome)) return outcome;
        if (schedule.keep[i]) record(shown<S>(drive, *here, u.end));
    }
    state = here->state;
    return outcome;
}

/// Runs a drive in steps of fourth order, with events.
template <class S, class Drive, class Record>
Outcome run(const Drive& drive, typename Drive::State& state, const Schedule& schedule, Record& record, const Progress& progress) {
    integrate::Steps<S, Drive> steps;
    const auto smooth = [&steps](const Drive& moved, const auto& at, const auto& u, const S& dt) {
        return smooth_step(moved, at, u, dt, steps);
    };
    return run_steps<S>(drive, state, schedule, record, progress,
                        [&](const Drive& moved, const auto& at, const auto& u, const S& dt) {
                            steps.begin(dt);
                            return strainwave::step(moved, at, u, dt, smooth);
                        });
}

}  // namespace strainwave::kernel
