#include "simulate.hpp"

namespace strainwave::host {

namespace {

/// Writes outputs one after the other to their place among `samples`.
struct Writer {
    double* out;
    std::size_t samples;
    std::size_t k = 0;

    void operator()(const Output<double>& output) {
        const auto values = flattened<double>(output);
        for (int c = 0; c < channels; ++c) out[c * samples + k] = values[c];
        ++k;
    }
};

/// Runs a drive with an own way to take a step: advance(drive, state, inputs, dt).
template <class Advance>
Drive::State run_by(const Drive& drive, const Drive::State& start, const Course& course, Writer& record, const Pause& pause,
                    const Advance& advance) {
    const auto runner = [&]<bool, class Compiled>(const Compiled& compiled, const typename Compiled::State& from) {
        return run_compiled<double>(compiled, from, course, record, pause, advance);
    };
    return run_among<double>(drive, start, runner, static_cast<Small*>(nullptr));
}

}  // namespace

Drive::State simulate(const Drive& drive, const Drive::State& start, const Course& course, Method method, double* out,
                      std::size_t samples, const Pause& pause) {
    Writer record{out, samples};
    if (method == Method::moreau_jean)
        return run_by(drive, start, course, record, pause, [](const auto& moved, const auto& at, const auto& u, double dt) {
            return moved.evaluate(integrate::moreau_jean_step(moved, at, u, dt), u.end);
        });
    if (method == Method::rosenbrock)
        return run_by(drive, start, course, record, pause, [](const auto& moved, const auto& at, const auto& u, double dt) {
            return step(moved, at, u, dt, [](const auto& m, const auto& from, const auto& over, double h) {
                return m.evaluate(integrate::rosenbrock_step(m, from, over, h), over.end);
            });
        });
    return run<double>(drive, start, course, record, pause);
}

namespace {

/// A run whose samples lie anywhere within its steps.
template <class Compiled>
typename Compiled::State run_adaptively(const Compiled& drive, typename Compiled::State x, const Signals& signals,
                                        const Instants& ends, const integrate::Tolerance& tolerance, long most,
                                        const Instants& wanted, Writer& record, Steps& steps, const Pause& pause) {
    using Evaluation = typename Compiled::Evaluation;
    const bool has_bounds = drive.has_bounds();
    x = drive.consistent(x);
    const auto smooth = called_step<double, Compiled>;
    integrate::Adaptive<double, Compiled, decltype(smooth), Unbroken> adaptive(drive, smooth, tolerance,
                                                                               1e-2 * (ends.at[1] - ends.at[0]));
    long taken = 0;
    Pauses pauses(pause);
    for (std::size_t i = 0; i + 1 < ends.count; ++i) {
        const double begin = ends.at[i], dt = ends.at[i + 1] - begin;
        const Unbroken u(signals, begin);
        const Evaluation start = drive.evaluate(x, u.at(0.0, dt));
        if (has_bounds) check_bounds<double>(drive, start, begin);
        const auto within = [&](double done, double to, const Evaluation& end, const auto& standing_at) {
            if (taken == most) throw StepsSpent{begin + done * dt, drive.vibration(0.0), drive.bristle_vibration()};
            pauses(taken++, i);
            if (has_bounds) check_bounds<double>(drive, end, begin + to * dt);
            const double until = to < 1.0 ? begin + to * dt : ends.at[i + 1];
            while (record.k < wanted.count && wanted.at[record.k] <= until) {
                const double at = clip((wanted.at[record.k] - begin) / dt, done, to);
                record(drive.output(standing_at(at), u.at(at, dt)));
            }
        };
        x = adaptive.through(start, u, dt, within).state;
        if (adaptive.gave_up()) throw ToleranceMissed{begin, ends.at[i + 1]};
    }
    steps = {adaptive.accepted, adaptive.rejected};
    return x;
}

}  // namespace

Drive::State simulate_adaptively(const Drive& drive, const Drive::State& start, const Signals& signals, const Instants& ends,
                                 const integrate::Tolerance& tolerance, long most, const Instants& wanted, double* out,
                                 std::size_t samples, Steps& steps, const Pause& pause) {
    Writer record{out, samples};
    const auto runner = [&]<bool, class Compiled>(const Compiled& compiled, const typename Compiled::State& from) {
        return run_adaptively(compiled, from, signals, ends, tolerance, most, wanted, record, steps, pause);
    };
    return run_among<double>(drive, start, runner, static_cast<Small*>(nullptr));
}

void observe(const Drive& drive, const Drive::State& x, const Input<double>& u, double* out) {
    Writer{out, 1}(drive.output(drive.evaluate(x, u), u));
}

}  // namespace strainwave::host
