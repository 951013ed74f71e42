#pragma once
#include "tallied.hpp"

/// Members of an ensemble on a GPU, one to a thread.
namespace strainwave::kernel {

/// Arguments of a launch: arrays of the device, with the members of the launch.
template <class S>
struct DeviceEnsemble {
    const int* shape;  ///< of the set of parameters
    const S* numbers;  ///< (members, number_count)
    int number_count;
    const S* starts;  ///< (members, start_count)
    int start_count;
    Schedule schedule;
    double max_rate;  ///< rad/s
    const int* recorded;
    int recorded_count;
    S* out;         ///< (samples, recorded_count, members)
    double* tally;  ///< (5, members): twist, max_rate, bristle_frequency, sound, ending
    int members;
};

/// Runs a member as `run_members` does.
template <template <class> class Drive, class S>
void run_member(const DeviceEnsemble<S>& ensemble, int member) {
    Reader<S> from{nullptr, ensemble.shape, ensemble.numbers + std::size_t(member) * ensemble.number_count};
    const auto drive = assembled<Drive<S>>(from).compile();
    const Places place = outputs_of(drive);
    S* sample = ensemble.out + member;
    const auto record = [&](const auto& outputs) {
        for (int r = 0; r < ensemble.recorded_count; ++r, sample += ensemble.members)
            *sample = outputs[place.slot[ensemble.recorded[r]]];
    };
    const Progress never_stops{[](void*, std::size_t) { return false; }, nullptr};
    Tally tally;
    const Outcome outcome = run_from<S>(drive, state_of(drive, ensemble.starts + std::size_t(member) * ensemble.start_count),
                                        ensemble.schedule, ensemble.max_rate, record, never_stops, &tally, 1);
    const double found[]{tally.twist, tally.max_rate, tally.bristle_frequency, double(tally.sound), double(outcome.ending)};
    for (int i = 0; i < 5; ++i) ensemble.tally[std::size_t(i) * ensemble.members + member] = found[i];
}

}  // namespace strainwave::kernel
