#include "simulate.hpp"

namespace strainwave::host {

namespace {

/// Writes outputs one after the other to their place among the samples.
struct Writer {
    const Rows& rows;
    std::size_t k = 0;

    void operator()(const Outputs<double>& values) {
        for (std::size_t r = 0; r < rows.recorded.size(); ++r) rows.out[r * rows.samples + k] = values[rows.recorded[r]];
        ++k;
    }
};

}  // namespace

Drive::State simulate(const Drive& drive, const Drive::State& start, const InputSchedule& schedule, Method method, const Rows& rows,
                      const Pause& pause) {
    Writer record{rows};
    const auto compiled = drive.compile();
    if (method == Method::exponential) return run<double>(compiled, start, schedule, record, pause);
    return run_specialised<double>(compiled, start, [&](const auto& special, const auto& from) {
        if (method == Method::rosenbrock)
            return run_stepwise<double>(special, from, schedule, record, pause,
                                        [](const auto& moved, const auto& at, const auto& u, double dt) {
                                            return moved.evaluate(integrate::rosenbrock_step(moved, at, u, dt), u.end);
                                        });
        return run_compiled<double>(special, from, schedule, record, pause,
                                    [](const auto& moved, const auto& at, const auto& u, double dt) {
                                        return moved.evaluate(integrate::moreau_jean_step(moved, at, u, dt), u.end);
                                    });
    });
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
    integrate::Steps<double, Compiled> kept;
    const auto smooth = [&](const Compiled& moved, const Evaluation& at, const auto& u, double h) {
        kept.begin(h);
        return called_step(moved, at, u, h, kept);
    };
    integrate::Adaptive<double, Compiled, decltype(smooth), Unbroken> adaptive(drive, x, smooth, tolerance,
                                                                               1e-2 * (ends.at[1] - ends.at[0]));
    long taken = 0;
    Pauses pauses(pause);
    for (std::size_t i = 0; i + 1 < ends.count; ++i) {
        const double begin = ends.at[i], dt = ends.at[i + 1] - begin;
        const Unbroken u(signals, begin);
        const Evaluation start = system::up_to_date(drive, drive.evaluate(x, u.at(0.0, dt)), u.at(0.0, dt), missed(dt));
        if (has_bounds) check_bounds<double>(drive, start, begin);
        const auto within = [&](double done, double to, const Evaluation& end, const auto& standing_at) {
            if (taken == most)
                throw StepsSpent{begin + done * dt, own_motion::natural_frequency<double>(drive, 0.0, u.at(done, dt).temperature),
                                 own_motion::bristle_frequency<double>(drive)};
            pauses(taken++, i);
            if (has_bounds) check_bounds<double>(drive, end, begin + to * dt);
            const double until = to < 1.0 ? begin + to * dt : ends.at[i + 1];
            while (record.k < wanted.count && wanted.at[record.k] <= until) {
                const double at = clip((wanted.at[record.k] - begin) / dt, done, to);
                record(shown<double>(drive, standing_at(at), u.at(at, dt)));
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
                                 const integrate::Tolerance& tolerance, long most, const Instants& wanted, const Rows& rows,
                                 Steps& steps, const Pause& pause) {
    Writer record{rows};
    return run_specialised<double>(drive.compile(), start, [&](const auto& special, const auto& from) {
        return run_adaptively(special, from, signals, ends, tolerance, most, wanted, record, steps, pause);
    });
}

Tally<double> simulate_member(const Drive& drive, const Drive::State& start, const InputSchedule& schedule, double max_rate,
                              const std::function<void(const Outputs<double>&)>& record, const Pause& pause) {
    return run_from<double>(drive, [&](const auto&, const auto&) { return start; }, schedule, max_rate, record, pause);
}

}  // namespace strainwave::host
