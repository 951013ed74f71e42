#pragma once
#include "columns.hpp"
#include "run.hpp"

/// Members of an ensemble, as many to a run as a scalar has lanes.
namespace strainwave::kernel {

inline double lane_of(double x, std::size_t) { return x; }
template <int n>
double lane_of(const Pack<n>& x, std::size_t i) {
    return x[int(i)];
}
inline void set_lane(double& x, std::size_t, double value) { x = value; }
template <int n>
void set_lane(Pack<n>& x, std::size_t i, double value) {
    x.set(int(i), value);
}
template <class S>
inline constexpr std::size_t lanes = sizeof(S) / sizeof(double);

/// Runs a drive from a state and calls record(outputs) there, too. If the gear vibrates faster than `max_rate` [rad/s] at rest, in
/// all lanes, nothing is run; where it does in some, their twist is 0.
template <class S, class Drive, class Record>
Outcome run_from(const Drive& drive, typename Drive::State state, const Schedule& schedule, double max_rate, Record& record,
                 const Progress& progress, Tally* tallies, std::size_t count) {
    const Input<S> at_start = input_from<S>(schedule.inputs);
    const S at_rest = own_motion::max_rate<S>(drive, S(0.0), at_start.temperature),
            on_bristles = own_motion::bristle_frequency<S>(drive);
    const auto too_fast = at_rest > S(max_rate);
    S twist{0.0}, sound{1.0}, fastest = at_rest;
    Outcome outcome;
    if (all(too_fast)) {
        sound = S(0.0);
    } else {
        auto note = [&](const auto& outputs) {
            record(outputs);
            sound = min(sound, soundness(outputs));
            twist = max(twist, abs(outputs[twist_place]));
        };
        note(shown<S>(drive, begun(drive, state, at_start, S(time_tolerance(schedule.first_step()))), at_start));
        outcome = run<S>(drive, state, schedule, note, progress);
        if (outcome.ending != Ending::done) return outcome;
        fastest = select(too_fast, at_rest, own_motion::max_rate<S>(drive, twist, at_start.temperature));
        twist = select(too_fast, S(0.0), twist);
    }
    for (std::size_t i = 0; i < count; ++i)
        tallies[i] = {lane_of(twist, i), lane_of(fastest, i), lane_of(on_bristles, i), lane_of(sound, i) > 0.0};
    return outcome;
}

/// A value of each lane, those of members beyond the last being its.
template <class S, class Value>
S together(std::size_t count, const Value& value) {
    S x{};
    for (std::size_t lane = 0; lane < lanes<S>; ++lane) set_lane(x, lane, value(std::min(lane, count - 1)));
    return x;
}

/// The numbers of members `first` and following, lane by lane.
template <class S>
void numbers_of_members(const Set& set, const Variation& variation, std::size_t first, std::size_t count, S* numbers) {
    for (int i = 0; i < set.count; ++i) numbers[i] = S(set.numbers[i]);
    for (std::size_t p = 0; p < variation.count; ++p)
        numbers[variation.places[p]] =
            together<S>(count, [&](std::size_t lane) { return variation.values[p * variation.members + first + lane]; });
}

template <class S, class Drive>
Outcome run_members(const Drive& drive, std::size_t members, std::size_t first, std::size_t count, const double* starts,
                    std::size_t state_size, const Schedule& schedule, double max_rate, const Rows& rows, Tally* tallies,
                    const Progress& progress) {
    Buffer<S> numbers(state_size);
    for (std::size_t i = 0; i < state_size; ++i)
        numbers[i] = together<S>(count, [&](std::size_t lane) { return starts[lane * state_size + i]; });
    const auto write = [&](std::size_t r, const S* held, std::size_t gathered, std::size_t from) {
        for (std::size_t lane = 0; lane < count; ++lane) {
            double* const row = rows.out + (r * members + first + lane) * rows.samples + from;
            for (std::size_t k = 0; k < gathered; ++k) row[k] = lane_of(held[k], lane);
        }
    };
    Columns<S, decltype(write)> record(rows, outputs_of(drive), write);
    const Outcome outcome = run_from<S>(drive, state_of(drive, static_cast<const S*>(numbers.data())), schedule, max_rate, record,
                                        progress, tallies, count);
    record.flush();
    return outcome;
}

}  // namespace strainwave::kernel
