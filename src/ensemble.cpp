#include "ensemble.hpp"

#include <atomic>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <exception>
#include <future>
#include <limits>
#include <mutex>
#include <thread>

namespace strainwave::host {

MemberStart MemberStarts::of(std::size_t member) {
    const kernel::Variation& variation = members.variation;
    MemberStart found{parts.numbers};
    for (std::size_t p = 0; p < variation.count; ++p)
        found.numbers[std::size_t(variation.places[p])] = variation.values[p * variation.members + member];
    set_numbers(members.description, &drive, found.numbers.data());
    found.problem = problem_of(members.description, &drive);
    if (!found.problem.empty()) return found;
    const kernel::Set set{parts.laws.data(), parts.shape.data(), found.numbers.data(), int(found.numbers.size())};
    Array<double, kernel::input_count> input;
    std::copy_n(members.first_input, kernel::input_count, input.item);
    found.state =
        members.start.at_rest ? general::rest(set) : general::started(set, members.start.of(member), shaped<Input<double>>(input));
    if (!std::isfinite(found.state[members.error_place])) found.state.clear();
    return found;
}

std::vector<MemberStart> starts_of(const Members& members, int threads) {
    std::vector<MemberStart> found(members.variation.members);
    const std::size_t part = found.size() / std::size_t(std::max(threads, 1)) + 1;
    std::vector<std::future<void>> team;
    for (std::size_t first = 0; first < found.size(); first += part)
        team.push_back(std::async(std::launch::async, [&members, &found, first, last = std::min(first + part, found.size())] {
            MemberStarts starts(members);
            for (std::size_t member = first; member < last; ++member) found[member] = starts.of(member);
        }));
    for (std::future<void>& each : team) each.get();
    return found;
}

namespace {

using kernel::Ending;

/// Data of a run of many members that all threads share.
class EnsembleRun {
    const kernel::Table& kernel;
    const Ensemble& ensemble;
    const Parts parts;
    const kernel::Rows rows;
    const std::size_t lanes, members;
    std::vector<MemberResult> results;
    std::atomic<std::size_t> next{0}, done{0};
    std::atomic<bool> stopping{false};

public:
    EnsembleRun(const kernel::Table& kernel_, const Ensemble& ensemble_)
        : kernel(kernel_),
          ensemble(ensemble_),
          parts(parts_of(ensemble.members.description, &ensemble.members.drive)),
          rows{ensemble.recorded.data(), ensemble.recorded.size(), ensemble.out, ensemble.samples},
          lanes(std::size_t(kernel.lanes)),
          members(ensemble.members.variation.members),
          results(members) {}

    std::size_t packs() const { return (members + lanes - 1) / lanes; }
    std::size_t steps_done() const { return done; }
    std::vector<MemberResult> result() { return std::move(results); }
    void stop() { stopping = true; }

    /// Runs packs until none is left.
    void work() {
        MemberStarts starts(ensemble.members);
        for (std::size_t pack; !stopping && (pack = next++) < packs();) {
            const std::size_t first = pack * lanes, count = std::min(lanes, members - first);
            if (count == 1 || !run_together(starts, first, count))
                for (std::size_t member = first; member < first + count; ++member) run_alone(starts, member);
            done += count * ensemble.schedule.steps;
        }
    }

private:
    /// Runs members as a pack; false where one of them cannot go all the way.
    bool run_together(MemberStarts& starts, std::size_t first, std::size_t count) {
        std::vector<double> states;
        for (std::size_t member = first; member < first + count; ++member) {
            const MemberStart start = starts.of(member);
            if (start.state.empty()) return false;
            states.insert(states.end(), start.state.begin(), start.state.end());
        }
        return run(first, count, states).ending != Ending::out_of_bounds;
    }

    kernel::Outcome run(std::size_t first, std::size_t count, const std::vector<double>& starts) {
        const kernel::Progress progress{[](void* self, std::size_t) { return bool(static_cast<EnsembleRun*>(self)->stopping); },
                                        this};
        std::vector<kernel::Tally> tallies(count);
        const kernel::Outcome outcome =
            kernel.run_members(parts.set(), ensemble.members.variation, first, count, starts.data(), starts.size() / count,
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

    void run_alone(MemberStarts& starts, std::size_t member) {
        clear(member, 1);
        const MemberStart start = starts.of(member);
        results[member].problem = start.problem;
        results[member].has_beginning = !start.problem.empty() || !start.state.empty();
        if (start.state.empty()) return;
        const kernel::Outcome outcome = run(member, 1, start.state);
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
