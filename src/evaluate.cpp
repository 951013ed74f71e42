#include "simulate.hpp"

namespace strainwave::host {

Drive::State rest(const Drive& drive) { return drive.compile().rest(); }

Drive::State started(const Drive& drive, const initial::Known<double>& known, const Input<double>& u) {
    return initial::state(drive.compile(), known, u);
}

Drive::State consistent(const Drive& drive, const Drive::State& x) { return drive.compile().consistent(x); }

namespace {

/// How far an instant may be missed by rounding where the coming step is not known [s].
double rounding(const control::Schedule<double>& schedule) { return 1e-9 * schedule.period; }

/// How long until a controller acts next [s].
double next_instant(const control::Schedule<double>& schedule, double within) {
    if (schedule.period == 0.0) return unbounded;
    const double output = schedule.first - schedule.period + schedule.delay;
    return output > within ? output : schedule.first;
}

}  // namespace

Drive::State begin(const Drive& drive, const Drive::State& x, const Input<double>& u) {
    const auto compiled = drive.compile();
    return begun(compiled, x, u, rounding(compiled.schedule(x))).state;
}

control::Schedule<double> schedule(const Drive& drive, const Drive::State& x) { return drive.compile().schedule(x); }

Drive::State aged(const Drive& drive, const Drive::State& x, const Input<double>& u, double dt) {
    return drive.compile().aged(x, u, dt);
}

Drive::State advance_hysteresis(const Drive& drive, Drive::State x, double twist) {
    drive.compile().advance_hysteresis(x, twist);
    return x;
}

Drive::State break_away(const Drive& drive, const Drive::State& x, const Input<double>& u) {
    const auto compiled = drive.compile();
    return system::break_away(compiled, compiled.evaluate(x, u), u).state;
}

Drive::State step_once(const Drive& drive, const Drive::State& x, const Interval<Input<double>>& u, double dt) {
    const auto compiled = drive.compile();
    integrate::Steps<double, std::remove_cv_t<decltype(compiled)>> steps;
    const auto smooth = called_steps(steps);
    const double within = std::min(rounding(compiled.schedule(x)), missed(dt));
    auto at = begun(compiled, x, u.start, within);
    check_bounds<double>(compiled, at, 0.0);
    for (double done = 0.0;;) {
        const double next = done + next_instant(compiled.schedule(at.state), within);
        const bool last = next >= dt - within;
        const double end = last ? dt : next;
        at = step<double>(compiled, at, last && done == 0.0 ? u : u.part(done / dt, end / dt, dt), end - done, smooth);
        check_bounds<double>(compiled, at, end);
        if (last) return at.state;
        at = system::up_to_date(compiled, at, u.at(end / dt, dt), within);
        done = end;
    }
}

double natural_frequency(const Drive& drive, double twist, double temperature) {
    return own_motion::natural_frequency<double>(drive.compile(), twist, temperature);
}

double max_rate(const Drive& drive, double twist, double temperature) {
    return own_motion::max_rate<double>(drive.compile(), twist, temperature);
}

double bristle_frequency(const Drive& drive) { return own_motion::bristle_frequency<double>(drive.compile()); }

Drive::Measurement measure(const Drive& drive, const Drive::State& x, const Input<double>& u) {
    const auto compiled = drive.compile();
    return compiled.seen(compiled.evaluate(x, u), u);
}

void observe(const Drive& drive, const Drive::State& x, const Input<double>& u, double* out) {
    const auto compiled = drive.compile();
    const auto values = shown<double>(compiled, compiled.evaluate(x, u), u);
    for (int c = 0; c < output_count; ++c) out[c] = values[c];
}

}  // namespace strainwave::host
