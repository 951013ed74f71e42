#include <atomic>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <exception>
#include <limits>
#include <mutex>
#include <thread>

#include "describe.hpp"
#include "simulate.hpp"
#include "state.hpp"

namespace strainwave::host {

namespace {

using Lanes = Pack<lanes>;

/// Thrown in a thread whose work nobody wants any more.
struct Stopped {};

double lane_of(double x, std::size_t) { return x; }
double lane_of(const Lanes& x, std::size_t i) { return x[int(i)]; }
void write(double x, double* to) { *to = x; }
void write(const Lanes& x, double* to) { x.write(to); }

/// Rows of samples, one for each output recorded of each of some members, filled column by column. They lie far apart, so a stretch
/// of columns is gathered before it is written.
template <class S>
class Gathered {
    static constexpr std::size_t stretch = 16, width = sizeof(S) / sizeof(double);
    const std::vector<int>& recorded;
    double* const out;
    const std::size_t members, samples, count;
    std::vector<double> held;
    std::size_t written = 0, gathered = 0;

public:
    /// `count` rows of each output from `out_` on, those of an output `members_` rows from those of the one before.
    Gathered(const std::vector<int>& recorded_, double* out_, std::size_t members_, std::size_t samples_, std::size_t count_)
        : recorded(recorded_),
          out(out_),
          members(members_),
          samples(samples_),
          count(count_),
          held(recorded_.size() * stretch * width) {}

    void add(const Outputs<S>& values) {
        for (std::size_t c = 0; c < recorded.size(); ++c) write(values[recorded[c]], &held[(c * stretch + gathered) * width]);
        if (++gathered == stretch) flush();
    }
    bool empty() const { return written == 0; }
    void flush() {
        for (std::size_t c = 0; c < recorded.size(); ++c)
            for (std::size_t i = 0; i < count; ++i) {
                double* const row = out + (c * members + i) * samples + written;
                for (std::size_t k = 0; k < gathered; ++k) row[k] = held[(c * stretch + k) * width + i];
            }
        written += gathered;
        gathered = 0;
    }
};

/// A run of many members: what all threads share.
class EnsembleRun {
    const Parts parts;
    const Variation& variation;
    const Start& start;
    const InputSchedule& schedule;
    const std::vector<int>& recorded;
    const double max_rate;
    double* const out;
    const std::size_t samples;
    std::vector<int> place_of;  // of each number in the variation, or -1
    std::vector<MemberResult> results;
    std::atomic<std::size_t> next{0}, done{0};
    std::atomic<bool> stopping{false};

public:
    EnsembleRun(const Drive& drive, const Variation& variation_, const Start& start_, const InputSchedule& schedule_,
                const std::vector<int>& recorded_, double max_rate_, double* out_, std::size_t kept)
        : parts(parts_of(drive)),
          variation(variation_),
          start(start_),
          schedule(schedule_),
          recorded(recorded_),
          max_rate(max_rate_),
          out(out_),
          samples(kept + 1),
          place_of(parts.numbers.size(), -1),
          results(variation.members) {
        for (std::size_t p = 0; p < variation.numbers.size(); ++p) place_of[variation.numbers[p]] = int(p);
    }

    std::size_t packs() const { return (variation.members + lanes - 1) / lanes; }
    std::size_t steps_done() const { return done; }
    std::vector<MemberResult> result() { return std::move(results); }
    void stop() { stopping = true; }

    /// Runs packs until none is left.
    void work() {
        for (std::size_t pack; (pack = next++) < packs();) {
            const std::size_t first = pack * lanes, count = std::min<std::size_t>(lanes, variation.members - first);
            if (!run_together(first, count))
                for (std::size_t member = first; member < first + count; ++member) run_alone(member);
            done += count * schedule.steps;
        }
    }

private:
    double number(int i, std::size_t member) const {
        const int place = place_of[i];
        return place < 0 ? parts.numbers[i] : variation.values[place * variation.members + member];
    }

    /// Members `first` and following as one drive; a pack that is not full repeats its last member.
    template <class S>
    AnyDrive<S> assembled_from(std::size_t first, std::size_t count) const {
        return assembled<AnyDrive<S>, S>(parts.shape, [&](int i) {
            if constexpr (std::is_same_v<S, double>) {
                return number(i, first);
            } else {
                S x;
                for (int lane = 0; lane < lanes; ++lane) x.set(lane, number(i, first + std::min<std::size_t>(lane, count - 1)));
                return x;
            }
        });
    }

    /// Where a member begins.
    Drive::State beginning(const Drive& drive, std::size_t member) const {
        return start.at_rest ? rest(drive) : started(drive, start.of(member), interval<double>(schedule.inputs).start);
    }
    /// Whether that is a state.
    static bool is_state(const Drive::State& from) { return std::isfinite(from.continuous.transmission_error); }
    /// The states of members as those of one drive.
    AnyDrive<Lanes>::State together(const std::vector<std::vector<double>>& numbers, std::size_t first) const {
        return state_of(assembled_from<Lanes>(first, numbers.size()), [&](int i) {
            Lanes x;
            for (int lane = 0; lane < lanes; ++lane) x.set(lane, numbers[std::min<std::size_t>(lane, numbers.size() - 1)][i]);
            return x;
        });
    }

    /// Runs members as a pack; false where one of them cannot go all the way.
    bool run_together(std::size_t first, std::size_t count) {
        std::vector<std::vector<double>> numbers;
        for (std::size_t member = first; member < first + count; ++member) {
            const Drive drive = assembled_from<double>(member, 1);
            if (!problem_of(drive).empty()) return false;
            const Drive::State from = beginning(drive, member);
            if (!is_state(from)) return false;
            numbers.push_back(numbers_of(drive, from));
        }
        try {
            run_members<Lanes>(first, count, together(numbers, first));
        } catch (const OutOfBounds&) {
            return false;
        }
        return true;
    }

    template <class S>
    void run_members(std::size_t first, std::size_t count, const typename AnyDrive<S>::State& from) {
        Gathered<S> rows(recorded, out + first * samples, variation.members, samples, count);
        const auto record = [&](const Outputs<S>& values) { rows.add(values); };
        const auto pause = [this](std::size_t) {
            if (stopping) throw Stopped{};
        };
        const Tally<S> tally = [&] {
            const auto drive = assembled_from<S>(first, count);
            if constexpr (std::is_same_v<S, double>)
                return simulate_member(drive, from, schedule, max_rate, record, pause);
            else
                return run_from<S>(drive, [&](const auto&, const auto&) { return from; }, schedule, max_rate, record, pause);
        }();
        rows.flush();
        if (rows.empty()) clear(first, count);
        for (std::size_t i = 0; i < count; ++i)
            results[first + i] = {lane_of(tally.twist, i),
                                  lane_of(tally.max_rate, i),
                                  lane_of(tally.bristle_frequency, i),
                                  lane_of(tally.sound, i) > 0.0,
                                  {},
                                  {},
                                  true};
    }

    /// Leaves not-a-number in the rows of members.
    void clear(std::size_t first, std::size_t count) {
        for (std::size_t c = 0; c < recorded.size(); ++c) {
            double* const rows = out + (c * variation.members + first) * samples;
            std::fill(rows, rows + count * samples, std::numeric_limits<double>::quiet_NaN());
        }
    }

    void run_alone(std::size_t member) {
        clear(member, 1);
        const Drive drive = assembled_from<double>(member, 1);
        results[member].problem = problem_of(drive);
        if (!results[member].problem.empty()) return;
        const Drive::State from = beginning(drive, member);
        results[member].has_beginning = is_state(from);
        if (!results[member].has_beginning) return;
        try {
            run_members<double>(member, 1, from);
        } catch (const OutOfBounds& error) {
            results[member].refusal = error;
        }
    }
};

}  // namespace

std::vector<MemberResult> simulate_many(const Drive& drive, const Variation& variation, const Start& start,
                                        const InputSchedule& schedule, const std::vector<int>& recorded, double max_rate,
                                        int threads, double* out, std::size_t kept, const Pause& pause) {
    EnsembleRun ensemble(drive, variation, start, schedule, recorded, max_rate, out, kept);
    std::mutex lock;
    std::condition_variable ended;
    std::exception_ptr failure;
    std::size_t working = std::min<std::size_t>(std::max(threads, 1), ensemble.packs());
    const auto work = [&] {
        std::exception_ptr caught;
        try {
            ensemble.work();
        } catch (const Stopped&) {
        } catch (...) {
            caught = std::current_exception();
            ensemble.stop();
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
        ensemble.stop();
        throw;
    }
    std::unique_lock held(lock);
    while (!ended.wait_for(held, std::chrono::milliseconds(50), [&] { return working == 0; })) {
        held.unlock();
        try {
            pause(ensemble.steps_done());
        } catch (...) {
            ensemble.stop();
            throw;  // the threads are joined on the way
        }
        held.lock();
    }
    if (failure) std::rethrow_exception(failure);
    return ensemble.result();
}

}  // namespace strainwave::host
