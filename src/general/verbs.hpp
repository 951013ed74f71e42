#pragma once
#include <strainwave/control/law.hpp>
#include <strainwave/integrate/interval.hpp>

#include <functional>
#include <vector>

#include "../kernel/table.hpp"

/// Functions of the general drive: numbers in, numbers out.
namespace strainwave::general {

using kernel::Outcome;
using kernel::Set;
using State = std::vector<double>;
using Input = strainwave::Input<double>;

/// Long work by the general drive, as by a kernel.
extern const kernel::Table table;

// A drive at one instant.

/// The state at rest at `output_angle` = 0 up to the kinematic error, without twist and history.
State rest(const Set& drive);
/// The initial state with some quantities known; not finite if there is none.
State started(const Set& drive, const initial::Known<double>& known, const Input& u);
/// The state with the slip direction of each shaft that follows from its speed and its friction.
State consistent(const Set& drive, const State& x);
/// Initial state of a run: consistent, and sampled by a controller that samples.
State begin(const Set& drive, const State& x, const Input& u);
/// True if set-valued friction, or a brake, may hold a shaft at rest, so that steps are cut at events.
bool has_events(const Set& drive);
/// When its controller acts.
control::Schedule<double> schedule(const Set& drive, const State& x);
/// The state with the memory of friction after `dt` [s] at constant speeds.
State relaxed(const Set& drive, const State& x, const Input& u, double dt);
/// The state with its hysteresis brought up to date at a twist [rad].
State advance_hysteresis(const Set& drive, const State& x, double twist);
/// The state in which each shaft slips that is driven beyond its breakaway torque.
State break_away(const Set& drive, const State& x, const Input& u);
/// The state becomes that after one step.
Outcome step_once(const Set& drive, State& x, const Interval<Input>& u, double dt);

/// The outputs of a drive in state `x`.
std::vector<double> observe(const Set& drive, const State& x, const Input& u);
/// Measurement of its controller, in the order of `control::Measurement`.
std::vector<double> measure(const Set& drive, const State& x, const Input& u);

// Rates of a drive, as angular frequencies [rad/s], at twists up to one [rad], where a run of a temperature [K] begins.

/// Highest frequency of gear and load on their springs.
double natural_frequency(const Set& drive, double twist, double temperature);
/// The higher of that and the decay of speeds: fixed steps must resolve it.
double max_rate(const Set& drive, double twist, double temperature);
/// Highest frequency of a shaft on its bristles.
double bristle_frequency(const Set& drive);

// Spring and hysteresis of a gear, without history at the first point of a path.

/// Called at each point; may throw.
using AtPoint = std::function<void(std::size_t)>;

/// Torque [N.m] along a path of twist [rad].
void trace(const Set& gear, const double* twist, std::size_t n, double* torque, const AtPoint& at_point);
/// Twist [rad] along a path of torque [N.m], not finite at the first that no twist gives; that point's index, or n.
std::size_t twist(const Set& gear, const double* torque, std::size_t n, double* twist, const AtPoint& at_point);

// Derivatives.

/// The rates of the n continuous numbers of a state, its memory held, and then the m outputs: value i in out[i], its derivative
/// with respect to continuous number p, and then to the inputs, in slopes[p * (n + m) + i].
void differentiate_rates(const Set& drive, const State& x, const Input& u, std::size_t n, std::size_t m, double* out,
                         double* slopes);

/// Torque of a gear along a path of twist; derivatives in slopes[p * n + i], the last by a shift of all points but the first.
void differentiate_loop(const Set& gear, const double* twist, std::size_t n, const std::vector<int>& parameters, double* out,
                        double* slopes, const AtPoint& at_point);

/// Contacts that slide steadily, each member with as many numbers.
struct Sliding {
    const double *speed, *angle, *load, *temperature;
};

/// Steady friction torque at the input of a gear; derivatives in slopes[p * n + i].
void differentiate_steady(const Set& gear, const Sliding& sliding, std::size_t n, const std::vector<int>& parameters, double* out,
                          double* slopes, const AtPoint& at_point);

}  // namespace strainwave::general
