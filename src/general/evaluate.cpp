#include "../kernel/run.hpp"

#include "drives.hpp"
#include "hysteresis_laws.hpp"
#include "verbs.hpp"

namespace strainwave::general {

namespace {

using kernel::initial_evaluation;
using kernel::time_tolerance;
using kernel::within_bounds;

/// f(drive).
template <class F>
auto with_drive(const Set& set, const F& f) {
    return Drives::with(set, set.numbers, f);
}
template <class F>
auto with_gear(const Set& set, const F& f) {
    return with_model<GeneralGear>(set, set.numbers, f);
}
template <class Drive>
State numbers_of(const Drive& drive, const typename Drive::State& x) {
    State numbers;
    kernel::each_number(drive, x, [&](double number) { numbers.push_back(number); });
    return numbers;
}
/// The numbers of f(drive), a state.
template <class F>
State state_from(const Set& set, const F& f) {
    return with_drive(set, [&](const auto& drive) { return numbers_of(drive, f(drive)); });
}
/// The numbers of f(drive, state), a state.
template <class F>
State changed(const Set& set, const State& x, const F& f) {
    return state_from(set, [&](const auto& drive) { return f(drive, kernel::state_of(drive, x.data())); });
}

}  // namespace

State rest(const Set& set) {
    return state_from(set, [](const auto& drive) { return drive.rest(); });
}

State started(const Set& set, const initial::Known<double>& known, const Input& u) {
    return state_from(set, [&](const auto& drive) { return initial::state(drive, known, u); });
}

State consistent(const Set& set, const State& x) {
    return changed(set, x, [](const auto& drive, const auto& state) { return drive.consistent(state); });
}

namespace {

/// Time tolerance if the length of the next step is not known [s].
double rounding(const control::Schedule<double>& schedule) { return 1e-9 * schedule.period; }

/// Time until a controller acts next [s].
double next_instant(const control::Schedule<double>& schedule, double within) {
    if (schedule.period == 0.0) return unbounded;
    const double output = schedule.first - schedule.period + schedule.delay;
    return output > within ? output : schedule.first;
}

template <class Drive>
Outcome step(const Drive& drive, typename Drive::State& x, const Interval<Input>& u, double dt) {
    Outcome outcome;
    integrate::Steps<double, Drive> steps;
    const auto smooth = [&steps](const Drive& moved, const auto& at, const auto& over, double h) {
        return kernel::smooth_step(moved, at, over, h, steps);
    };
    const double within = std::min(rounding(drive.schedule(x)), time_tolerance(dt));
    auto at = initial_evaluation(drive, x, u.start, within);
    if (!within_bounds<double>(drive, at, 0.0, outcome)) return outcome;
    for (double done = 0.0;;) {
        const double next = done + next_instant(drive.schedule(at.state), within);
        const bool last = next >= dt - within;
        const double end = last ? dt : next;
        at = strainwave::step<double>(drive, at, last && done == 0.0 ? u : u.part(done / dt, end / dt, dt), end - done, smooth);
        if (!within_bounds<double>(drive, at, end, outcome)) return outcome;
        x = at.state;
        if (last) return outcome;
        at = system::up_to_date(drive, at, u.at(end / dt, dt), within);
        done = end;
    }
}

}  // namespace

State begin(const Set& set, const State& x, const Input& u) {
    return changed(set, x, [&](const auto& drive, const auto& state) {
        return initial_evaluation(drive, state, u, rounding(drive.schedule(state))).state;
    });
}

bool has_events(const Set& set) {
    return with_drive(set, [](const auto& drive) { return drive.has_events(); });
}

control::Schedule<double> schedule(const Set& set, const State& x) {
    return with_drive(set, [&](const auto& drive) { return drive.schedule(kernel::state_of(drive, x.data())); });
}

State relaxed(const Set& set, const State& x, const Input& u, double dt) {
    return changed(set, x, [&](const auto& drive, const auto& state) { return drive.relaxed(state, u, dt); });
}

State advance_hysteresis(const Set& set, const State& x, double twist) {
    return changed(set, x, [&](const auto& drive, auto state) {
        drive.advance_hysteresis(state, twist);
        return state;
    });
}

State break_away(const Set& set, const State& x, const Input& u) {
    return changed(
        set, x, [&](const auto& drive, const auto& state) { return system::break_away(drive, drive.evaluate(state, u), u).state; });
}

Outcome step_once(const Set& set, State& x, const Interval<Input>& u, double dt) {
    return with_drive(set, [&](const auto& drive) {
        auto state = kernel::state_of(drive, static_cast<const double*>(x.data()));
        const Outcome outcome = step(drive, state, u, dt);
        kernel::write(drive, state, x.data());
        return outcome;
    });
}

double natural_frequency(const Set& set, double twist, double temperature) {
    return with_drive(set, [&](const auto& drive) { return own_motion::natural_frequency<double>(drive, twist, temperature); });
}

double max_rate(const Set& set, double twist, double temperature) {
    return with_drive(set, [&](const auto& drive) { return own_motion::max_rate<double>(drive, twist, temperature); });
}

double bristle_frequency(const Set& set) {
    return with_drive(set, [](const auto& drive) { return own_motion::bristle_frequency<double>(drive); });
}

std::vector<double> measure(const Set& set, const State& x, const Input& u) {
    return with_drive(set, [&](const auto& drive) {
        const auto seen = flattened<double>(drive.seen(drive.evaluate(kernel::state_of(drive, x.data()), u), u));
        return std::vector<double>(seen.item, seen.item + seen.size());
    });
}

std::vector<double> observe(const Set& set, const State& x, const Input& u) {
    return with_drive(set, [&](const auto& drive) {
        const auto all = kernel::shown<double>(drive, drive.evaluate(kernel::state_of(drive, x.data()), u), u);
        const kernel::Places places = kernel::outputs_of(drive);
        std::vector<double> values;
        for (int i = 0; i < places.count; ++i) values.push_back(all[places.slot[i]]);
        return values;
    });
}

void trace(const Set& set, const double* twist, std::size_t n, double* torque, const AtPoint& at_point) {
    with_gear(set, [&](const auto& gear) {
        with_quasi_static(gear, 0.0, [&](auto moved) {
            for (std::size_t i = 0; i < n; ++i) {
                at_point(i);
                moved.move(twist[i]);
                torque[i] = moved.torque(twist[i]);
            }
        });
    });
}

std::size_t twist(const Set& set, const double* torque, std::size_t n, double* twist, const AtPoint& at_point) {
    return with_gear(set, [&](const auto& gear) {
        return with_quasi_static(gear, 0.0, [&](auto moved) {
            for (std::size_t i = 0; i < n; ++i) {
                at_point(i);
                twist[i] = moved.twist(torque[i]);
                if (!(abs(twist[i]) <= unbounded) || !domain<double>(gear.stiffness, twist[i]).holds()) return i;
                moved.move(twist[i]);
            }
            return n;
        });
    });
}

}  // namespace strainwave::general
