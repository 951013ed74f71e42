#pragma once
#include <strainwave/angle.hpp>
#include <strainwave/friction/coulomb.hpp>
#include <strainwave/gear.hpp>
#include <strainwave/hysteresis/maxwell_slip.hpp>
#include <strainwave/kinematic_error/fourier.hpp>
#include <strainwave/kinematic_error/steepest.hpp>
#include <strainwave/kinematic_error/stochastic.hpp>
#include <strainwave/kinematics.hpp>
#include <strainwave/load/inertia.hpp>
#include <strainwave/load/load.hpp>
#include <strainwave/softening/thermal_softening.hpp>
#include <strainwave/stiffness/linear.hpp>

/// Gear and load that a controller contains as a model of its drive.
namespace strainwave::drive_model {

template <class S>
using PlainGear = Gear<S, kinematics::StrainWave<S>, kinematic_error::Fourier<S>, kinematic_error::Stochastic<S>,
                       stiffness::Linear<S>, hysteresis::MaxwellSlip<S>, friction::Coulomb<S>, friction::Coulomb<S>,
                       friction::Coulomb<S>, softening::ThermalSoftening<S>>;
template <class S>
using PlainLoad = load::Inertia<S>;

/// True for a load that prescribes the motion of the output. For a choice, that of the chosen load.
template <class Load>
constexpr bool moves_output(const Load& load) {
    if constexpr (requires { load.model; })
        return load.visit([](const auto& chosen) { return moves_output(chosen); });
    else
        return prescribes(load);
}

/// Contradiction of a load that needs no torque.
template <class S, class Load>
constexpr Contradiction<S> problem_of_load(const Load& load) {
    if (!moves_output(load)) return {};
    return {
        "load must not be Prescribed, which moves the output by itself and needs no torque; give the load that a motor "
        "moves"};
}

/// |ratio| times the steepest slope of the kinematic error: below 1 the output moves in one sense as the input turns.
template <class S, class Gear>
constexpr S contraction(const Gear& gear) {
    return abs(gear.kinematics.ratio()) * kinematic_error::steepest<S>(gear.kinematic_error);
}

/// Contradiction of a model that a law of control divides by: the output must follow the input in one sense.
template <class S, class Gear, class Load>
constexpr Contradiction<S> problem_of_motion(const Gear& gear, const Load& load) {
    if (const auto contradiction = problem_of_load<S>(load); contradiction.text) return contradiction;
    const S share = contraction<S>(gear);
    if (all(share < S(1.0))) return {};
    return {
        "|ratio| times the steepest slope of the kinematic error is {}, and must be less than 1: the output must follow the input",
        share};
}

/// Value and slope of the kinematic error, and its second derivative [1/rad].
template <class S>
struct ErrorWithCurvature {
    S value, slope, curvature;
};
/// The error of a gear at an input angle [rad]. The second derivative is a difference over 1 mrad to each side.
template <class S, class Gear>
constexpr ErrorWithCurvature<S> error_with_curvature(const Gear& gear, const S& angle) {
    constexpr double step = 1e-3;
    const Angle<S> at = reduced(angle);
    const auto error = gear.kinematic_error.at(at);
    const auto after = gear.kinematic_error.at(Angle<S>{at.within + S(step), at.turns});
    const auto before = gear.kinematic_error.at(Angle<S>{at.within - S(step), at.turns});
    return {error.value, error.slope, (after.slope - before.slope) * S(0.5 / step)};
}

}  // namespace strainwave::drive_model
