#pragma once
#include "differentiate.hpp"
#include "inverse_dynamics.hpp"
#include "members.hpp"
#include "simulate.hpp"

/// The functions of a kernel's table, for a source of drives: Drives::with<S>(set, numbers, f) calls f(drive).
namespace strainwave::kernel {

/// Drives of one static type.
template <template <class> class Drive>
struct StaticDrives {
    template <class S, class F>
    static Outcome with(const Set& set, const S* numbers, const F& f) {
        Reader<S> from{set.laws, set.shape, numbers};
        return f(assembled<Drive<S>>(from).compile());
    }
};

template <class Drives>
struct Entries {
    static Outcome simulate(const Set& set, double* state, const Schedule& schedule, Method method, const Rows& rows,
                            const Progress& progress) {
        return Drives::with(set, set.numbers,
                            [&](const auto& drive) { return kernel::simulate(drive, state, schedule, method, rows, progress); });
    }
    static Outcome simulate_adaptively(const Set& set, double* state, const AdaptiveCourse& course, const Rows& rows,
                                       const Progress& progress) {
        return Drives::with(set, set.numbers,
                            [&](const auto& drive) { return kernel::simulate_adaptively(drive, state, course, rows, progress); });
    }
    template <class S>
    static Outcome run_members(const Set& set, const Variation& variation, std::size_t first, std::size_t count,
                               const double* starts, std::size_t state_size, const Schedule& schedule, double max_rate,
                               const Rows& rows, Tally* tallies, const Progress& progress) {
        Buffer<S> numbers(std::size_t(set.count));
        numbers_of_members(set, variation, first, count, numbers.data());
        return Drives::with(set, static_cast<const S*>(numbers.data()), [&](const auto& drive) {
            return kernel::run_members<S>(drive, variation.members, first, count, starts, state_size, schedule, max_rate, rows,
                                          tallies, progress);
        });
    }
    template <int n>
    static Outcome differentiate(const Set& set, const Beginning& beginning, const Schedule& schedule, const int* parameters,
                                 std::size_t count, const Rows& rows, double* derivatives, const Progress& progress) {
        Buffer<Dual<n>> numbers(std::size_t(set.count));
        Outcome outcome;
        for (std::size_t first = 0; outcome.ending == Ending::done && (first == 0 || first < count); first += n) {
            seed(set, parameters, count, first, numbers.data());
            outcome = Drives::with(set, static_cast<const Dual<n>*>(numbers.data()), [&](const auto& drive) {
                return differentiate_by<n>(drive, beginning, schedule, first, count, rows, derivatives, progress);
            });
        }
        return outcome;
    }
    template <int n>
    static void inverse_dynamics(const Set& set, const double* motion, const double* inputs, std::size_t instants,
                                 const int* parameters, std::size_t count, double* torque, double* derivatives) {
        if (count == 0)
            Drives::with(set, set.numbers, [&](const auto& drive) {
                needed_torques<double>(drive, motion, inputs, instants, [&](std::size_t i, double needed) { torque[i] = needed; });
                return Outcome{};
            });
        Buffer<Dual<n>> numbers(std::size_t(set.count));
        for (std::size_t first = 0; first < count; first += n) {
            seed(set, parameters, count, first, numbers.data());
            Drives::with(set, static_cast<const Dual<n>*>(numbers.data()), [&](const auto& drive) {
                needed_torques<Dual<n>>(drive, motion, inputs, instants, [&](std::size_t i, const Dual<n>& needed) {
                    torque[i] = needed.value;
                    for (std::size_t p = first; p < first + n && p < count; ++p)
                        derivatives[p * instants + i] = needed.slope[p - first];
                });
                return Outcome{};
            });
        }
    }
};

}  // namespace strainwave::kernel
