#pragma once
#include "columns.hpp"
#include "tallied.hpp"

/// Members of an ensemble, as many to a run as a scalar has lanes.
namespace strainwave::kernel {

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
