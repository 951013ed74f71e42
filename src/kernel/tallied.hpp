#pragma once
#include "lanes.hpp"
#include "run.hpp"

/// A run of a member of an ensemble, with its tally.
namespace strainwave::kernel {

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
        note(shown<S>(drive, initial_evaluation(drive, state, at_start, S(time_tolerance(schedule.first_step()))), at_start));
        outcome = run<S>(drive, state, schedule, note, progress);
        if (outcome.ending != Ending::done) return outcome;
        fastest = select(too_fast, at_rest, own_motion::max_rate<S>(drive, twist, at_start.temperature));
        twist = select(too_fast, S(0.0), twist);
    }
    for (std::size_t i = 0; i < count; ++i)
        tallies[i] = {lane_of(twist, i), lane_of(fastest, i), lane_of(on_bristles, i), lane_of(sound, i) > 0.0};
    return outcome;
}

}  // namespace strainwave::kernel
