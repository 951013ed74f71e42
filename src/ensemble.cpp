#include "ensemble.hpp"

#include <atomic>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <exception>
#include <limits>
#include <mutex>
#include <thread>

#include "general/verbs.hpp"

namespace strainwave::host {

namespace {

using kernel::Ending;

/// A run of many members: what all threads share.
class EnsembleRun {
    const kernel::Table& kernel;
    const Ensemble& ensemble;
    const Parts parts;
    const kernel::Rows rows;
    const std::size_t error_place, lanes, members;
    std::vector<MemberResult> results;
    std::atomic<std::size_t> next{0}, done{0};
    std::atomic<bool> stopping{false};

public:
    EnsembleRun(const kernel::Table& kernel_, const Ensemble& ensemble_)
        : kernel(kernel_),
          ensemble(ensemble_),
          parts(parts_of(ensemble.description, &ensemble.drive)),
          rows{ensemble.recorded.data(), ensemble.recorded.size(), ensemble.out, ensemble.samples},
          error_place(ensemble.error_place),
          lanes(std::size_t(kernel.lanes)),
          members(ensemble.variation.members),
          results(members) {}

    std::size_t packs() const { return (members + lanes - 1) / lanes; }
    std::size_t steps_done() const { return done; }
    std::vector<MemberResult> result() { return std::move(results); }
    void stop() { stopping = true; }

    /// Runs packs until none is left.
    void work() {
        ParameterDrive drive = ensemble.drive;  // of this thread
        for (std::size_t pack; !stopping && (pack = next++) < packs();) {
            const std::size_t first = pack * lanes, count = std::min(lanes, members - first);
            if (count == 1 || !run_together(drive, first, count))
                for (std::size_t member = first; member < first + count; ++member) run_alone(drive, member);
            done += count * ensemble.schedule.steps;
        }
    }

private:
    /// The numbers of a member.
    std::vector<double> numbers_of(std::size_t member) const {
        std::vector<double> numbers = parts.numbers;
        for (std::size_t p = 0; p < ensemble.variation.count; ++p)
            numbers[std::size_t(ensemble.variation.places[p])] = ensemble.variation.values[p * members + member];
        return numbers;
    }
    /// The contradiction between these numbers, which `drive` takes; empty if there is none.
    std::string problem(ParameterDrive& drive, const std::vector<double>& numbers) const {
        set_numbers(ensemble.description, &drive, numbers.data());
        return problem_of(ensemble.description, &drive);
    }
    /// The initial state of a member; empty if there is none.
    general::State beginning(const std::vector<double>& numbers, std::size_t member) const {
        const kernel::Set set{parts.laws.data(), parts.shape.data(), numbers.data(), int(numbers.size())};
        general::State state = ensemble.start.at_rest
                                   ? general::rest(set)
                                   : general::started(set, ensemble.start.of(member), shaped<Input<double>>(first_input()));
        if (!std::isfinite(state[error_place])) state.clear();
        return state;
    }
    Array<double, kernel::input_count> first_input() const {
        Array<double, kernel::input_count> input;
        std::copy_n(ensemble.schedule.inputs, kernel::input_count, input.item);
        return input;
    }

    /// Runs members as a pack; false where one of them cannot go all the way.
    bool run_together(ParameterDrive& drive, std::size_t first, std::size_t count) {
        std::vector<double> starts;
        for (std::size_t member = first; member < first + count; ++member) {
            const std::vector<double> numbers = numbers_of(member);
            if (!problem(drive, numbers).empty()) return false;
            const general::State state = beginning(numbers, member);
            if (state.empty()) return false;
            starts.insert(starts.end(), state.begin(), state.end());
        }
        return run(first, count, starts).ending != Ending::out_of_bounds;
    }

    kernel::Outcome run(std::size_t first, std::size_t count, const std::vector<double>& starts) {
        const kernel::Progress progress{[](void* self, std::size_t) { return bool(static_cast<EnsembleRun*>(self)->stopping); },
                                        this};
        std::vector<kernel::Tally> tallies(count);
        const kernel::Outcome outcome =
            kernel.run_members(parts.set(), ensemble.variation, first, count, starts.data(), starts.size() / count,
                               ensemble.schedule, ensemble.max_rate, rows, tallies.data(), progress);
        if (outcome.ending != Ending::done) return outcome;
        bool ran = false;
        for (std::size_t i = 0; i < count; ++i) {
            results[first + i].tally = tallies[i];
            ran = ran || !(tallies[i].max_rate > ensemble.max_rate && tallies[i].twist == 0.0);
        }
        if (!ran) clear(first, count);
        return outcome;
    }

    /// Leaves not-a-number in the rows of members.
    void clear(std::size_t first, std::size_t count) {
        for (std::size_t c = 0; c < rows.count; ++c) {
            double* const row = rows.out + (c * members + first) * rows.samples;
            std::fill(row, row + count * rows.samples, std::numeric_limits<double>::quiet_NaN());
        }
    }

    void run_alone(ParameterDrive& drive, std::size_t member) {
        clear(member, 1);
        const std::vector<double> numbers = numbers_of(member);
        results[member].problem = problem(drive, numbers);
        if (!results[member].problem.empty()) return;
        const general::State state = beginning(numbers, member);
        results[member].has_beginning = !state.empty();
        if (state.empty()) return;
        const kernel::Outcome outcome = run(member, 1, state);
        if (outcome.ending == Ending::out_of_bounds) results[member].refusal = outcome;
    }
};

}  // namespace

std::vector<MemberResult> run_ensemble(const kernel::Table& kernel, const Ensemble& ensemble, int threads,
                                       const std::function<void(std::size_t)>& pause) {
    EnsembleRun running(kernel, ensemble);
    std::mutex lock;
    std::condition_variable ended;
    std::exception_ptr failure;
    std::size_t working = std::min<std::size_t>(std::size_t(std::max(threads, 1)), running.packs());
    const auto work = [&] {
        std::exception_ptr caught;
        try {
            running.work();
        } catch (...) {
            caught = std::current_exception();
            running.stop();
        }
        const std::lock_guard held(lock);
        if (caught) failure = caught;
        --working;
        ended.notify_one();
    };
    std::vector<std::jthread> team;
    try {
        for (std::size_t i = working; i > 0; --i) team.emplace_back(work);
    } catch (...) {  // no more threads to be had
        running.stop();
        throw;
    }
    std::unique_lock held(lock);
    while (!ended.wait_for(held, std::chrono::milliseconds(50), [&] { return working == 0; })) {
        held.unlock();
        try {
            pause(running.steps_done());
        } catch (...) {
            running.stop();
            throw;  // the threads are joined on the way
        }
        held.lock();
    }
    if (failure) std::rethrow_exception(failure);
    return running.result();
}

}  // namespace strainwave::host
