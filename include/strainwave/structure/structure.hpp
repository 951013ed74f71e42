#pragma once
#include <strainwave/angle.hpp>

/// Bodies and springs between the two shafts of a gear, in addition to its spring `stiffness`. At the output's scale such a
/// structure has
///
///     State, Output                          of the bodies within the gear, and their channels in recordings
///     rigid()                                true if no body within the gear moves by itself
///     generator(inner, shafts)               -> Generator
///     generator_acceleration(rate, input)    rad/s2, by the rate of its state and the acceleration of the input
///     gap(inner, shafts)                     rad: deformation, before the kinematic error is subtracted
///     spring_twist(inner, shafts, deformation)     rad: that deformation, or a state of its own
///     spring_twist_rate(inner, shafts, mesh)       rad/s
///     deformation_rate(inner, mesh)          rad/s, of the gap less the error
///     reaction(inner, shafts, mesh, load)    -> Reaction
///     even_reaction(inner, shafts, mesh, load)   -> Reaction, if no spring of its own varied: linear
///     energies(inner, shafts, mesh, load)    -> Energies
///     output(inner, shafts, mesh, friction)  -> Output, with the friction at the output [N.m]
///     steady_state(inner, shafts, mesh, load)     -> SteadyState: at rest under the torque of the spring
///     compliance(shafts, mesh)               rad/(N.m), of all but the spring
///     natural_frequency(bodies)              rad/s, of the fastest mode
///     uneven_frequency(bodies, unevenness)   rad/s, of the part that the even reaction leaves out
///     uneven_decay(bodies, unevenness)       1/s, of the speed of the wave generator, by an error that follows it
///     decay(bodies)                          1/s, by damping alone
namespace strainwave::structure {

/// Angles and speeds of the two shafts of a gear, and its temperature.
template <class S>
struct Shafts {
    Angle<S> input_angle;
    S input_speed;         ///< rad/s
    S transmission_error;  ///< theta_in / i - theta_out, rad
    S output_speed;        ///< rad/s
    S inverse_ratio;       ///< 1 / i
    S temperature;         ///< K
};

/// Angle and speed of the wave generator.
template <class S>
struct Generator {
    Angle<S> angle;
    S speed;  ///< rad/s
};

/// Deformation of the bearing, where a structure puts bodies between wave generator and spring.
template <class S>
struct Between {
    S deformation;       ///< Gap less the error, rad
    S deformation_rate;  ///< rad/s
    S per_twist;         ///< Slope of the error over the twist of the spring, rad/rad
};

/// Deformation and torques of a gear between its two shafts; `Inner` is the state of the bodies within it.
template <class S, class Inner>
struct Mesh {
    using Apart = typename detail::Either<size_of<S, Inner> == 0, Stateless<S>, Between<S>>::type;

    S error;         ///< Kinematic error e, rad
    S per_input;     ///< Deformation per angle of the wave generator: 1/i - e', rad/rad
    S per_output;    ///< and per output angle, without its sign; not 1 where the error of a rigid structure follows the load
    S twist;         ///< of the spring, rad
    S twist_rate;    ///< rad/s
    S spring;        ///< Torque of the spring, its hysteresis, damping and material, N.m
    S torque;        ///< on the output shaft, N.m
    S input_torque;  ///< that holds the input shaft back, N.m
    Apart apart;
    Inner rate;  ///< of the bodies within the gear
};

/// Load of the rest of the gear on the bodies within it.
template <class S>
struct Load {
    S spring;             ///< of the spring, its hysteresis, damping and material, N.m
    S turning;            ///< with which a spring whose stiffness varies holds the wave generator back, N.m
    S generator_inertia;  ///< kg.m2
};

template <class S, class State>
struct Reaction {
    S torque;        ///< on the output shaft, N.m
    S input_torque;  ///< that holds the input shaft back, N.m
    State rate;      ///< of the bodies within the gear
};

/// Energies and losses of the bodies within a gear.
template <class S>
struct Energies {
    S elastic{0.0};      ///< J
    S kinetic{0.0};      ///< J
    S damping{0.0};      ///< that their damping takes, W
    S under_error{0.0};  ///< elastic torque that works where the kinematic error changes, N.m
};

template <class S, class State>
struct SteadyState {
    State state;
    S transmission_error;  ///< rad
};

/// Parts of the vibration: the inertias [kg.m2] of the shafts and of the wave generator, stiffness [N.m/rad] and damping
/// [N.m.s/rad] of the spring, stiffness of the load.
template <class S>
struct Bodies {
    S input_inertia, generator_inertia, output_inertia, inverse_ratio, stiffness, damping, load_stiffness;
};

/// Largest part of a gear that the even reaction leaves out.
template <class S>
struct Unevenness {
    S stiffness;  ///< of the spring, in excess of its value at rest, N.m/rad
    S slope;      ///< of the kinematic error over the angle of the wave generator, rad/rad
    S per_twist;  ///< over the twist of the spring, rad/rad
    S per_speed;  ///< and over the speed of the wave generator, rad.s/rad
};

}  // namespace strainwave::structure
