#pragma once
#include <strainwave/drive/own_motion.hpp>
#include <strainwave/initial.hpp>
#include <strainwave/integrate.hpp>
#include <strainwave/scalar/dual.hpp>
#include <strainwave/scalar/pack.hpp>

#include "outputs.hpp"

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <functional>
#include <new>
#include <string_view>

/// A drive run through time, for any scalar: the loop that Python's `simulate` and `fit` stand on.
namespace strainwave::host {

/// How many numbers drive a drive from outside.
inline constexpr int input_count = size_of<double, Input<double>>;

/// The command over `steps` steps: instants[0..steps], and per step the inputs at its start, middle and end.
struct InputSchedule {
    const double* instants;
    const double* inputs;      ///< (steps, 3, input_count): what `Input` holds
    const std::uint8_t* keep;  ///< (steps): whether to record the end of the step
    std::size_t steps;

    double first_step() const { return instants[1] - instants[0]; }
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
    const auto at = [](const double* u) {
        Array<S, input_count> numbers;
        for (int i = 0; i < input_count; ++i) numbers[i] = S(u[i]);
        return shaped<Input<S>>(numbers);
    };
    return {at(inputs), at(inputs + input_count), at(inputs + 2 * input_count)};
}

/// Called now and then with the number of steps done; may throw.
using Pause = std::function<void(std::size_t)>;

/// The outputs of a drive at one instant, by channel. Those that it does not have are 0.
template <class S>
class Outputs {
    const S* const first;
    const int count;

public:
    template <int n>
    Outputs(const Array<S, n>& values) : first(values.item), count(n) {}

    int size() const { return count; }
    S operator[](int channel) const { return channel < count ? first[channel] : S(0.0); }
};
inline constexpr int twist_channel = [] {
    int channel = -1, count = 0;
    AnyDrive<double>::Output output{};
    AnyDrive<double>::Output::fields(output, [&](const auto&, const Field& field) {
        if (std::string_view(field.name) == "twist") channel = count;
        ++count;
    });
    return channel;
}();

template <class S, class Drive>
auto shown(const Drive& drive, const typename Drive::Evaluation& at, const Input<S>& u) {
    return flattened<S>(drive.output(at, u));
}

/// What an output may be at most: no angle beyond is told to within a radian.
inline constexpr double largest = 1e15;

/// 1 where every output is a number up to the largest, else 0.
template <class S>
S soundness(const Outputs<S>& values) {
    S sound{1.0};
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

/// A step without events, every call on the way inlined. Where each access is checked that takes minutes to compile.
template <class S, class Drive>
#ifndef SW_CHECKED
[[gnu::flatten, gnu::noinline]]
#endif
typename Drive::Evaluation inlined_step(const Drive& drive, const typename Drive::Evaluation& from, const Interval<Input<S>>& u,
                                        const S& dt) {
    return drive.evaluate(integrate::exponential_step(drive, from, u, dt), u.end);
}
/// The same, for the compiler to decide. Of a drive whose gear has bodies within `steps` keeps what they ask for.
template <class S, class Drive>
[[gnu::noinline]] typename Drive::Evaluation called_step(const Drive& drive, const typename Drive::Evaluation& from,
                                                         const Interval<Input<S>>& u, const S& dt,
                                                         integrate::Steps<S, Drive>& steps) {
    return drive.evaluate(steps(drive, from, u, dt), u.end);
}
/// Such steps, one after the other.
template <class S, class Drive>
auto called_steps(integrate::Steps<S, Drive>& steps) {
    return [&steps](const Drive& drive, const typename Drive::Evaluation& from, const Interval<Input<S>>& u, const S& dt) {
        return called_step(drive, from, u, dt, steps);
    };
}

/// A state from outside where a run begins.
template <class S, class Drive>
typename Drive::Evaluation begun(const Drive& drive, const typename Drive::State& start, const Input<S>& u, const S& within) {
    return system::up_to_date(drive, drive.evaluate(drive.consistent(start), u), u, within);
}
/// How far an instant may be missed by rounding, where a step of `dt` [s] begins: instants are a step apart at the least.
inline constexpr double missed(double dt) { return 0.5 * dt; }

/// Runs a compiled drive from `start` through one step or more and calls record(outputs) at the end of each step to be kept.
/// `advance` takes a step. Returns the state at the end. What a step returns is made where it stays: to copy it would take a
/// twentieth of the step. A drive that has diverged, in all lanes, stays where that is noticed, and so do its outputs.
template <class S, class Drive, class Record, class Advance>
typename Drive::State run_compiled(const Drive& drive, const typename Drive::State& start, const InputSchedule& schedule,
                                   Record& record, const Pause& pause, const Advance& advance) {
    const bool has_bounds = drive.has_bounds();
    Pauses pauses(pause);
    Interval<Input<S>> u = interval<S>(schedule.inputs);
    using Evaluation = typename Drive::Evaluation;
    Evaluation places[2]{begun(drive, start, u.start, S(missed(schedule.first_step()))), {}}, *here = places, *there = places + 1;
    if (has_bounds) check_bounds<S>(drive, *here, schedule.instants[0]);
    bool lost = false;
    for (std::size_t i = 0; i < schedule.steps; ++i) {
        pauses(i, i);
        if (i % 64 == 0) lost = lost || !any(soundness<S>(shown<S>(drive, *here, u.end)) > S(0.0));
        if (lost) {
            if (schedule.keep[i]) record(shown<S>(drive, *here, u.end));
            continue;
        }
        if (i > 0) {
            const double *const inputs = schedule.inputs + 3 * input_count * i, *const before = inputs - input_count;
            u = interval<S>(inputs);
            const bool jump = !std::equal(inputs, inputs + input_count, before);
            if (jump) *here = drive.evaluate(here->state, u.start);
            const S within(missed(schedule.instants[i + 1] - schedule.instants[i]));
            if (system::due(drive, here->state, within)) *here = system::sampled(drive, *here, u.start, within);
        }
        new (there) Evaluation(advance(drive, *here, u, S(schedule.instants[i + 1] - schedule.instants[i])));
        std::swap(here, there);
        if (has_bounds) check_bounds<S>(drive, *here, schedule.instants[i + 1]);
        if (schedule.keep[i]) record(shown<S>(drive, *here, u.end));
    }
    return here->state;
}

/// Runs `drive`, or the same drive of a usual type, with `step` as the step without events.
template <class S, class Drive, class Record, class Step>
typename Drive::State run_stepwise(const Drive& drive, const typename Drive::State& start, const InputSchedule& schedule,
                                   Record& record, const Pause& pause, const Step& step) {
    const auto advance = [&](const Drive& moved, const typename Drive::Evaluation& at, const Interval<Input<S>>& u, const S& dt) {
        return strainwave::step(moved, at, u, dt, step);
    };
    return run_compiled<S>(drive, start, schedule, record, pause, advance);
}

/// Whether `drive` fits a special type; then calls run(special drive, its state) and sets `end`.
template <class S, class Special, class Run>
bool run_as(const CompiledDrive<S>& drive, const typename CompiledDrive<S>::State& start, const Run& run,
            typename CompiledDrive<S>::State& end) {
    Special special{};
    if (!specialise<S>(special, drive)) return false;
    end = converted<S>(start, run(special, converted<S>(special.initial_state(), start)));
    return true;
}

/// The state at the end of run(drive, start), of the drive as the most special type that it fits.
template <class S, class Run>
typename CompiledDrive<S>::State run_specialised(const CompiledDrive<S>& drive, const typename CompiledDrive<S>::State& start,
                                                 const Run& run) {
    typename CompiledDrive<S>::State end{};
    if (run_as<S, DriveOnBristles<S>>(drive, start, run, end)) return end;
    if (run_as<S, DriveWithoutMemory<S>>(drive, start, run, end)) return end;
    if (run_as<S, ShortDrive<S>>(drive, start, run, end)) return end;
    return run(drive, start);
}

/// Whether all that a step of such a drive calls is inlined. With more models to choose from that takes long to compile: for
/// slopes, which are carried along less already, it does not pay, for packs only where a build is to be used more than compiled.
template <class S, class Drive>
inline constexpr bool inlines = !std::is_same_v<Drive, CompiledDrive<S>>;
template <class S>
inline constexpr bool inlines<S, ShortDrive<S>> = std::is_same_v<S, double>;
#ifdef SW_TO_BE_USED
template <int n>
inline constexpr bool inlines<Pack<n>, ShortDrive<Pack<n>>> = true;
#endif

/// Runs `drive` in steps of fourth order, with events, and calls record(outputs) at the end of each step to be kept.
template <class S, class Record>
typename CompiledDrive<S>::State run(const CompiledDrive<S>& drive, const typename CompiledDrive<S>::State& start,
                                     const InputSchedule& schedule, Record&& record, const Pause& pause) {
    return run_specialised<S>(drive, start, [&]<class Special>(const Special& special, const typename Special::State& from) {
        if constexpr (inlines<S, Special>) {
            return run_stepwise<S>(special, from, schedule, record, pause, inlined_step<S, Special>);
        } else {
            integrate::Steps<S, Special> steps;
            const auto smooth = called_steps(steps);
            const auto advance = [&](const Special& moved, const auto& at, const auto& u, const S& dt) {
                steps.begin(dt);
                return strainwave::step(moved, at, u, dt, smooth);
            };
            return run_compiled<S>(special, from, schedule, record, pause, advance);
        }
    });
}

/// How a run went.
template <class S>
struct Tally {
    S twist{0.0};              ///< largest recorded, rad
    S max_rate{0.0};           ///< what steps had to follow up to that twist, rad/s
    S bristle_frequency{0.0};  ///< the fastest of a shaft on its bristles, rad/s
    S sound{0.0};              ///< 1 where all outputs at all samples are numbers up to the largest
};

/// Runs a drive from start(drive, input) and calls record(outputs) there, too. Where the gear vibrates faster than `max_rate`
/// [rad/s] at rest only that is told, with a twist of 0; where it does in all lanes nothing is run.
template <class S, class Start, class Record>
Tally<S> run_from(const AnyDrive<S>& given, const Start& start, const InputSchedule& schedule, double max_rate, Record&& record,
                  const Pause& pause) {
    const CompiledDrive<S> drive = given.compile();
    const Input<S> at_start = interval<S>(schedule.inputs).start;
    const S at_rest = own_motion::max_rate<S>(drive, S(0.0), at_start.temperature),
            on_bristles = own_motion::bristle_frequency<S>(drive);
    const auto too_fast = at_rest > S(max_rate);
    if (all(too_fast)) return {S(0.0), at_rest, on_bristles, S(0.0)};
    S twist{0.0}, sound{1.0};
    const auto note = [&](const Outputs<S>& values) {
        record(values);
        sound = min(sound, soundness<S>(values));
        twist = max(twist, abs(values[twist_channel]));
    };
    const auto from = start(drive, at_start);
    note(shown<S>(drive, begun(drive, from, at_start, S(missed(schedule.first_step()))), at_start));
    run<S>(drive, from, schedule, note, pause);
    return {select(too_fast, S(0.0), twist), select(too_fast, at_rest, own_motion::max_rate<S>(drive, twist, at_start.temperature)),
            on_bristles, sound};
}

}  // namespace strainwave::host
