#pragma once
#include "columns.hpp"
#include "run.hpp"

/// One trajectory and its derivatives by parameters.
namespace strainwave::kernel {

/// The numbers of a set, parameters number `first` and following being those that derivatives are taken by.
template <int n>
void seed(const Set& set, const int* parameters, std::size_t count, std::size_t first, Dual<n>* numbers) {
    for (int i = 0; i < set.count; ++i) numbers[i] = Dual<n>(set.numbers[i]);
    for (std::size_t p = first; p < first + n && p < count; ++p) numbers[parameters[p]].slope[p - first] = 1.0;
}

template <class S>
initial::Known<S> in_scalars(const initial::Known<double>& known) {
    initial::Known<S> found{};
    for (int q = 0; q < initial::quantities; ++q)
        if (known.given[q]) found.set(initial::Quantity(q), S(known.value[q]));
    return found;
}

/// A run that gives the derivatives by the parameters number `first` and following of `count`.
template <int n, class Drive>
Outcome differentiate_by(const Drive& drive, const Beginning& beginning, const Schedule& schedule, std::size_t first,
                         std::size_t count, const Rows& rows, double* derivatives, const Progress& progress) {
    using S = Dual<n>;
    const std::size_t last = std::min(count, first + n);
    const auto write_row = [&](std::size_t r, const S* held, std::size_t gathered, std::size_t from) {
        for (std::size_t k = 0; k < gathered; ++k) rows.out[r * rows.samples + from + k] = held[k].value;
        for (std::size_t p = first; p < last; ++p) {
            double* const row = derivatives + (p * rows.count + r) * rows.samples + from;
            for (std::size_t k = 0; k < gathered; ++k) row[k] = held[k].slope[p - first];
        }
    };
    Columns<S, decltype(write_row)> record(rows, outputs_of(drive), write_row);
    const Input<S> at_start = input_from<S>(schedule.inputs);
    typename Drive::State state =
        beginning.at_rest ? drive.rest() : initial::state(drive, in_scalars<S>(beginning.known), at_start);
    record(shown<S>(drive, initial_evaluation(drive, state, at_start, S(time_tolerance(schedule.first_step()))), at_start));
    const Outcome outcome = run<S>(drive, state, schedule, record, progress);
    record.flush();
    return outcome;
}

}  // namespace strainwave::kernel
