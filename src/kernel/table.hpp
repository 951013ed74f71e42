#pragma once
#include <strainwave/condition.hpp>
#include <strainwave/drive/input.hpp>
#include <strainwave/initial_quantities.hpp>
#include <strainwave/integrate/tolerance.hpp>

#include "assemble.hpp"

/// Interface of a kernel: numbers in, numbers out, so that one built by any compiler serves. The general drive has the same table.
namespace strainwave::kernel {

/// Number of inputs of a drive.
inline constexpr int input_count = size_of<double, Input<double>>;

/// The command over `steps` steps: instants[0..steps], and per step the inputs at its start, middle and end.
struct Schedule {
    const double* instants;
    const double* inputs;      ///< (steps, 3, input_count): what `Input` holds
    const std::uint8_t* keep;  ///< (steps): whether to record the end of the step
    std::size_t steps;

    double first_step() const { return instants[1] - instants[0]; }
};

/// The most members that a kernel takes together: those of the widest register.
inline constexpr int max_lanes = 8;
/// Derivatives that are taken together. The same everywhere, for the bits of a derivative may depend on which others it is taken
/// with.
inline constexpr int slopes = 4;

/// Upper bound of a sound output: larger angles are not resolved to a radian.
inline constexpr double largest = 1e15;

/// Method of the steps.
enum class Method { exponential, moreau_jean, rosenbrock };

/// Destination of the outputs of a run: output recorded[r] of sample k to out[r * samples + k].
struct Rows {
    const int* recorded;
    std::size_t count;
    double* out;
    std::size_t samples;
};

/// Asked every 64 steps, with how many are done, whether to stop.
struct Progress {
    bool (*stop)(void* context, std::size_t done);
    void* context;

    bool stops(std::size_t taken, std::size_t done) const { return taken % 64 == 0 && stop(context, done); }
};

enum class Ending { done, stopped, out_of_bounds, tolerance_missed, steps_spent };

/// End of a run, and the reason if it is early: the part that is not valid at this state; the instants [s] between which no step
/// keeps the tolerance; where all steps are spent [s], and the vibrations that they followed [rad/s].
struct Outcome {
    Ending ending = Ending::done;
    const char* part = "";
    Domain<double> domain{};
    double from = 0.0, to = 0.0, natural_frequency = 0.0, bristle_frequency = 0.0;
    long accepted = 0, rejected = 0;  ///< adaptive steps
};

/// Inputs that are asked for as steps need them: at a fraction of `dt` [s] after `begin` [s], before the next jump.
struct Signals {
    void (*at)(const void* context, double begin, double fraction, double dt, double* inputs);
    const void* context;
};

/// Steps as long as a tolerance allows, at most `most`, that end at all of `ends`, of which the first is the begin. Samples are
/// those at `wanted` [s].
struct AdaptiveCourse {
    Signals signals;
    const double* ends;
    std::size_t end_count;
    integrate::Tolerance tolerance;
    long most;
    const double* wanted;
    std::size_t wanted_count;
};

/// Drives that differ in some of their numbers: number places[p] of member m is values[p * members + m].
struct Variation {
    const int* places;
    std::size_t count;
    const double* values;
    std::size_t members;
};

/// Result of the run of a member.
struct Tally {
    double twist = 0.0;              ///< largest recorded, rad
    double max_rate = 0.0;           ///< what steps had to follow up to that twist, rad/s
    double bristle_frequency = 0.0;  ///< the fastest of a shaft on its bristles, rad/s
    bool sound = false;              ///< whether all outputs at all samples are numbers up to the largest
};

/// Initial condition of a run with derivatives: at rest, or known quantities.
struct Beginning {
    bool at_rest;
    initial::Known<double> known;
};

/// The functions of a kernel; null for a job that it was not compiled for.
struct Table {
    int lanes;  ///< members that `run_members` takes at most at a time

    /// One trajectory from `state`, whose place the state at the end takes.
    Outcome (*simulate)(const Set& set, double* state, const Schedule& schedule, Method method, const Rows& rows,
                        const Progress& progress);
    Outcome (*simulate_adaptively)(const Set& set, double* state, const AdaptiveCourse& course, const Rows& rows,
                                   const Progress& progress);
    /// Members `first` and following from starts[i * state_size ...], into rows of (recorded, members, samples). Where the gear of
    /// all vibrates faster than `max_rate` [rad/s] at rest nothing is run, and the twists are 0.
    Outcome (*run_members)(const Set& set, const Variation& variation, std::size_t first, std::size_t count, const double* starts,
                           std::size_t state_size, const Schedule& schedule, double max_rate, const Rows& rows, Tally* tallies,
                           const Progress& progress);
    /// One trajectory and its derivatives by numbered parameters: outputs o of sample k to rows, derivatives to
    /// slopes[(p * rows.count + r) * samples + k].
    Outcome (*differentiate)(const Set& set, const Beginning& beginning, const Schedule& schedule, const int* parameters,
                             std::size_t parameter_count, const Rows& rows, double* slopes, const Progress& progress);
    /// The torque that each of n motions of the input needs, and its derivatives by numbered parameters: motion[4 i ...] are angle
    /// [rad], speed [rad/s], acceleration [rad/s2] and the time since the motion before [s], inputs[input_count i ...] the inputs;
    /// slopes[p * n + i].
    void (*inverse_dynamics)(const Set& set, const double* motion, const double* inputs, std::size_t n, const int* parameters,
                             std::size_t parameter_count, double* torque, double* slopes);
};

}  // namespace strainwave::kernel
