#pragma once
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "describe.hpp"
#include "general/verbs.hpp"
#include "kernel/table.hpp"
#include "parameter_drive.hpp"

namespace strainwave::host {

/// Initial conditions of members: at rest, or known quantities: values[q * members + m] is quantity `quantities[q]` of member m.
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

/// Beginning of a member: its parameters and its state.
struct MemberStart {
    std::vector<double> numbers{};  ///< its parameters
    std::string problem{};          ///< what is wrong with them, if anything is
    general::State state{};         ///< empty if it has none
};

/// Result of the run of a member.
struct MemberResult {
    kernel::Tally tally{};
    std::optional<kernel::Outcome> refusal{};  ///< what ended it, if anything did
    std::string problem{};                     ///< what is wrong with its numbers, if anything is
    bool has_beginning = true;                 ///< whether there is a state that it can begin in
};

/// Drives that differ in some numbers, and the inputs where they begin.
struct Members {
    const ParameterDrive& drive;
    const Description& description;
    kernel::Variation variation;
    const Start& start;
    const double* first_input;  ///< what `Input` holds
    std::size_t error_place;    ///< of the transmission error among the numbers of a state
};

/// The beginnings of members, one after the other.
class MemberStarts {
    const Members& members;
    const Parts parts;
    ParameterDrive drive;  // of whoever asks

public:
    explicit MemberStarts(const Members& members_)
        : members(members_), parts(parts_of(members_.description, &members_.drive)), drive(members_.drive) {}

    MemberStart of(std::size_t member);
};

/// The beginnings of all members, found on several threads.
std::vector<MemberStart> starts_of(const Members& members, int threads);

/// An ensemble to run: drives that differ in some numbers, and where their samples go.
struct Ensemble {
    const Members& members;
    const kernel::Schedule& schedule;
    const std::vector<int>& recorded;
    double max_rate;
    double* out;  ///< output c of sample k of member m goes to out[(c * members + m) * samples + k]
    std::size_t samples;
};

/// Runs members side by side, as many to a pack as the kernel takes and packs on several threads. A member that ends early leaves
/// not-a-number behind. Of a member whose gear vibrates faster than `max_rate` [rad/s] at rest the twist is 0. Calls `pause` with
/// the number of steps done, on this thread; it may throw.
std::vector<MemberResult> run_ensemble(const kernel::Table& kernel, const Ensemble& ensemble, int threads,
                                       const std::function<void(std::size_t)>& pause);

}  // namespace strainwave::host
