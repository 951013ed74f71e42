#include "simulate.hpp"

namespace strainwave::host {

Drive::State rest(const Drive& drive) { return drive.compile().rest(); }

Drive::State consistent(const Drive& drive, const Drive::State& x) { return drive.compile().consistent(x); }

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
    const auto before = compiled.evaluate(compiled.consistent(x), u.start);
    check_bounds<double>(compiled, before, 0.0);
    const auto after = step<double>(compiled, before, u, dt, called_step<double, std::remove_cv_t<decltype(compiled)>>);
    check_bounds<double>(compiled, after, dt);
    return after.state;
}

double vibration(const Drive& drive, double twist) { return drive.compile().vibration(twist); }

double fastest(const Drive& drive, double twist) { return drive.compile().fastest(twist); }

double bristle_vibration(const Drive& drive) { return drive.compile().bristle_vibration(); }

void observe(const Drive& drive, const Drive::State& x, const Input<double>& u, double* out) {
    const auto compiled = drive.compile();
    const auto values = flattened<double>(compiled.output(compiled.evaluate(x, u), u));
    for (int c = 0; c < channels; ++c) out[c] = values[c];
}

}  // namespace strainwave::host
