#pragma once
#include "run.hpp"

/// One trajectory.
namespace strainwave::kernel {

/// Writes outputs one after the other to their place among the samples.
struct Writer {
    const Rows& rows;
    const Places place;  ///< of each output of the drive
    std::size_t k = 0;

    template <int n>
    void operator()(const Array<double, n>& outputs) {
        for (std::size_t r = 0; r < rows.count; ++r) rows.out[r * rows.samples + k] = outputs[place.slot[rows.recorded[r]]];
        ++k;
    }
};

template <class Drive>
Outcome run_by(const Drive& drive, typename Drive::State& state, const Schedule& schedule, Method method, Writer& record,
               const Progress& progress) {
    if (method == Method::exponential) return run<double>(drive, state, schedule, record, progress);
    if (method == Method::rosenbrock) {
        const auto smooth = [](const Drive& moved, const auto& at, const auto& u, double dt) {
            return moved.evaluate(integrate::rosenbrock_step(moved, at, u, dt), u.end);
        };
        return run_steps<double>(drive, state, schedule, record, progress,
                                 [&](const Drive& moved, const auto& at, const auto& u, double dt) {
                                     return strainwave::step(moved, at, u, dt, smooth);
                                 });
    }
    return run_steps<double>(drive, state, schedule, record, progress,
                             [](const Drive& moved, const auto& at, const auto& u, double dt) {
                                 return moved.evaluate(integrate::moreau_jean_step(moved, at, u, dt), u.end);
                             });
}

template <class Drive>
Outcome simulate(const Drive& drive, double* numbers, const Schedule& schedule, Method method, const Rows& rows,
                 const Progress& progress) {
    Writer record{rows, outputs_of(drive)};
    typename Drive::State state = state_of(drive, static_cast<const double*>(numbers));
    const Outcome outcome = run_by(drive, state, schedule, method, record, progress);
    write(drive, state, numbers);
    return outcome;
}

/// The inputs from one instant until before the next at which one of them jumps.
struct Unbroken {
    const Signals& signals;
    const double begin;

    Input<double> at(double fraction, double dt) const {
        double inputs[input_count];
        signals.at(signals.context, begin, fraction, dt, inputs);
        return input_from<double>(inputs);
    }
    Interval<Input<double>> part(double from, double to, double dt) const {
        return {at(from, dt), at(0.5 * (from + to), dt), at(to, dt)};
    }
};

/// A run whose samples lie anywhere within its steps.
template <class Drive>
Outcome simulate_adaptively(const Drive& drive, double* numbers, const AdaptiveCourse& course, const Rows& rows,
                            const Progress& progress) {
    using Evaluation = typename Drive::Evaluation;
    Outcome outcome;
    Writer record{rows, outputs_of(drive)};
    const bool has_bounds = drive.has_bounds();
    typename Drive::State x = drive.consistent(state_of(drive, static_cast<const double*>(numbers)));
    integrate::Steps<double, Drive> kept;
    const auto smooth = [&](const Drive& moved, const Evaluation& at, const auto& u, double h) {
        kept.begin(h);
        return smooth_step(moved, at, u, h, kept);
    };
    integrate::Adaptive<double, Drive, decltype(smooth), Unbroken> adaptive(drive, x, smooth, course.tolerance,
                                                                            1e-2 * (course.ends[1] - course.ends[0]));
    long taken = 0;
    for (std::size_t i = 0; i + 1 < course.end_count; ++i) {
        const double begin = course.ends[i], dt = course.ends[i + 1] - begin;
        const Unbroken u{course.signals, begin};
        const Evaluation start = system::up_to_date(drive, drive.evaluate(x, u.at(0.0, dt)), u.at(0.0, dt), time_tolerance(dt));
        if (has_bounds && !within_bounds<double>(drive, start, begin, outcome)) return outcome;
        const auto within = [&](double done, double to, const Evaluation& end, const auto& standing_at) {
            if (taken == course.most) {
                outcome.ending = Ending::steps_spent;
                outcome.from = begin + done * dt;
                outcome.natural_frequency = own_motion::natural_frequency<double>(drive, 0.0, u.at(done, dt).temperature);
                outcome.bristle_frequency = own_motion::bristle_frequency<double>(drive);
                return false;
            }
            if (progress.stops(std::size_t(taken++), i)) {
                outcome.ending = Ending::stopped;
                return false;
            }
            if (has_bounds && !within_bounds<double>(drive, end, begin + to * dt, outcome)) return false;
            const double until = to < 1.0 ? begin + to * dt : course.ends[i + 1];
            while (record.k < course.wanted_count && course.wanted[record.k] <= until) {
                const double at = clip((course.wanted[record.k] - begin) / dt, done, to);
                record(shown<double>(drive, standing_at(at), u.at(at, dt)));
            }
            return true;
        };
        x = adaptive.through(start, u, dt, within).state;
        if (outcome.ending != Ending::done) return outcome;
        if (adaptive.gave_up()) {
            outcome.ending = Ending::tolerance_missed;
            outcome.from = begin;
            outcome.to = course.ends[i + 1];
            return outcome;
        }
    }
    write(drive, x, numbers);
    outcome.accepted = adaptive.accepted;
    outcome.rejected = adaptive.rejected;
    return outcome;
}

}  // namespace strainwave::kernel
