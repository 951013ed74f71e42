#pragma once
#include "run.hpp"
#include "signal.hpp"

#include <optional>
#include <string>
#include <vector>

/// The ways to run a drive, compiled once for every instruction set.
namespace strainwave::host {

using Drive = AnyDrive<double>;

/// How many members of a ensemble take every step together, and how many derivatives a run gives: those of one register. Whatever
/// the number, each has the bits that it has alone.
inline constexpr int lanes = strainwave::detail::register_width;
/// The most there can be.
inline constexpr int max_lanes = 8;

/// Drives that differ from one in some of its numbers: number `numbers[p]` of member m is values[p * members + m].
struct Variation {
    std::vector<int> numbers;
    const double* values;
    std::size_t members;
};

/// Where runs begin: at rest, or where some quantities are known: values[q * members + m] is quantity `quantities[q]` of member m.
struct Start {
    bool at_rest = true;
    std::vector<int> quantities{};
    const double* values = nullptr;
    std::size_t members = 1;

    initial::Known<double> of(std::size_t member) const {
        initial::Known<double> known{};
        for (std::size_t q = 0; q < quantities.size(); ++q)
            known.set(initial::Quantity(quantities[q]), values[q * members + member]);
        return known;
    }
};

/// How the run of a member went.
struct MemberResult {
    double twist = 0.0;                    ///< largest recorded, rad
    double max_rate = 0.0;                 ///< what steps had to follow up to that twist, rad/s
    double bristle_frequency = 0.0;        ///< the fastest of a shaft on its bristles, rad/s
    bool sound = false;                    ///< whether it ran, and all outputs at all samples are numbers up to the largest
    std::optional<OutOfBounds> refusal{};  ///< what ended it, if anything did
    std::string problem{};                 ///< what is wrong with its numbers, if anything is
    bool has_beginning = true;             ///< whether there is a state that it can begin in
};

/// How steps are taken.
enum class Method { exponential, moreau_jean, rosenbrock };

/// Where a run writes: row r of sample k, from out[0] on, to out[r * samples + k], being channel recorded[r].
struct Rows {
    const std::vector<int>& recorded;
    double* out;
    std::size_t samples;
};

/// One trajectory in the steps of its schedule.
Drive::State simulate(const Drive& drive, const Drive::State& start, const InputSchedule& schedule, Method method, const Rows& rows,
                      const Pause& pause);

/// No step was short enough to keep the tolerance, between two instants [s].
struct ToleranceMissed {
    double from, to;
};

/// All steps that were allowed led no further than to an instant [s]; the vibrations that steps must follow [rad/s]: of the gear at
/// rest, and of a shaft on its bristles.
struct StepsSpent {
    double at, natural_frequency, bristle_frequency;
};

/// How many steps were taken, and how many given up for shorter ones.
struct Steps {
    long accepted = 0, rejected = 0;
};

/// Instants [s], in order.
struct Instants {
    const double* at;
    std::size_t count;
};

/// One trajectory in at most `most` steps, as long as a tolerance allows, that end at all of `ends`, of which the first is its
/// begin and between which no signal jumps. Samples are those at `wanted`. `pause` is called with the number of ends reached.
/// Throws OutOfBounds, ToleranceMissed, StepsSpent.
Drive::State simulate_adaptively(const Drive& drive, const Drive::State& start, const Signals& signals, const Instants& ends,
                                 const integrate::Tolerance& tolerance, long most, const Instants& wanted, const Rows& rows,
                                 Steps& steps, const Pause& pause);

/// Members side by side, several to a pack and packs on several threads. Writes their `recorded` channels, beginning
/// with the start: channel c of sample k of member m to out[(c * members + m) * (kept + 1) + k]. A member that ends early leaves
/// not-a-number behind. Of a member whose gear vibrates faster than `max_rate` [rad/s] at rest only that is told, with a twist of
/// 0. `pause` is called with the number of steps done, on this thread.
std::vector<MemberResult> simulate_many(const Drive& drive, const Variation& variation, const Start& start,
                                        const InputSchedule& schedule, const std::vector<int>& recorded, double max_rate,
                                        int threads, double* out, std::size_t kept, const Pause& pause);

// A drive at one instant.

/// At rest at `output_angle` = 0 up to the kinematic error, untwisted and without history.
Drive::State rest(const Drive& drive);
/// Where it begins if some quantities are known: its transmission error is not finite where there is no such state.
Drive::State started(const Drive& drive, const initial::Known<double>& known, const Input<double>& u);
/// With the slip direction of each shaft as its speed and its friction have it.
Drive::State consistent(const Drive& drive, const Drive::State& x);
/// Where a run begins: consistent, and sampled by a controller that samples.
Drive::State begin(const Drive& drive, const Drive::State& x, const Input<double>& u);
/// When its controller acts.
control::Schedule<double> schedule(const Drive& drive, const Drive::State& x);
/// With what friction remembers after `dt` [s] at constant speeds.
Drive::State aged(const Drive& drive, const Drive::State& x, const Input<double>& u, double dt);
/// With its hysteresis brought up to date at a twist [rad].
Drive::State advance_hysteresis(const Drive& drive, Drive::State x, double twist);
/// With those shafts slipping that stick and are driven beyond what holds them.
Drive::State break_away(const Drive& drive, const Drive::State& x, const Input<double>& u);
/// After one step. Throws OutOfBounds.
Drive::State step_once(const Drive& drive, const Drive::State& x, const Interval<Input<double>>& u, double dt);

// How fast a drive moves by itself, as angular frequencies [rad/s], at twists up to one [rad], where a run of a temperature [K]
// begins.

/// Of gear and load on their springs.
double natural_frequency(const Drive& drive, double twist, double temperature);
/// That, or the decay of speeds: what fixed steps must follow.
double max_rate(const Drive& drive, double twist, double temperature);
/// Of a shaft on its bristles.
double bristle_frequency(const Drive& drive);

/// The outputs of a drive in state `x`.
void observe(const Drive& drive, const Drive::State& x, const Input<double>& u, double* out);
Drive::Measurement measure(const Drive& drive, const Drive::State& x, const Input<double>& u);

/// A member that runs alone; writes its outputs through `record`.
Tally<double> simulate_member(const Drive& drive, const Drive::State& start, const InputSchedule& schedule, double max_rate,
                              const std::function<void(const Outputs<double>&)>& record, const Pause& pause);

/// One trajectory and its derivatives with respect to the numbered parameters of the drive.
/// Writes values, beginning with the start, to out[c * (kept + 1) + k], derivatives to slopes[(p * channels + c) * (kept + 1) + k].
void differentiate(const Drive& drive, const Start& start, const InputSchedule& schedule, const std::vector<int>& parameters,
                   double* out, double* slopes, std::size_t kept, const Pause& pause);

/// The rates of the n continuous numbers of a state, its memory held, and then the outputs: value i in out[i], its derivative with
/// respect to continuous number p, and then to the inputs, in slopes[p * (n + channels) + i].
void differentiate_rates(const Drive& drive, const Drive::State& x, const Input<double>& u, double* out, double* slopes);

/// Quasi-static torque of a gear, virgin at the first point, along a path of twist; derivatives in slopes[p * n + i], the last
/// by a shift of all points but the first.
void differentiate_loop(const AnyGear<double>& gear, const double* twist, std::size_t n, const std::vector<int>& parameters,
                        double* out, double* slopes, const Pause& pause);

/// Contacts that slide steadily, each member with as many numbers.
struct Sliding {
    const double *speed, *angle, *load, *temperature;

    template <class S>
    friction::Contact<S> contact(std::size_t i) const {
        const double turns = std::rint(angle[i] / (2.0 * pi));
        return {S(speed[i]), S(1.0), {S(angle[i] - 2.0 * pi * turns), S(turns)}, S(load[i]), S(temperature[i])};
    }
};

/// Steady friction torque at the input; derivatives in slopes[p * n + i].
void differentiate_steady(const AnyGear<double>& gear, const Sliding& sliding, std::size_t n, const std::vector<int>& parameters,
                          double* out, double* slopes, const Pause& pause);

/// All of them, as one module holds them.
struct Kernels {
    decltype(&host::evaluate) evaluate;
    decltype(&host::lay_out) lay_out;
    decltype(&host::rest) rest;
    decltype(&host::started) started;
    decltype(&host::consistent) consistent;
    decltype(&host::begin) begin;
    decltype(&host::schedule) schedule;
    decltype(&host::aged) aged;
    decltype(&host::advance_hysteresis) advance_hysteresis;
    decltype(&host::break_away) break_away;
    decltype(&host::step_once) step_once;
    decltype(&host::natural_frequency) natural_frequency;
    decltype(&host::max_rate) max_rate;
    decltype(&host::bristle_frequency) bristle_frequency;
    decltype(&host::observe) observe;
    decltype(&host::measure) measure;
    decltype(&host::simulate) simulate;
    decltype(&host::simulate_adaptively) simulate_adaptively;
    decltype(&host::simulate_many) simulate_many;
    decltype(&host::differentiate) differentiate;
    decltype(&host::differentiate_rates) differentiate_rates;
    decltype(&host::differentiate_loop) differentiate_loop;
    decltype(&host::differentiate_steady) differentiate_steady;
};

}  // namespace strainwave::host
