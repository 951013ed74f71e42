#pragma once
#include <strainwave/array.hpp>
#include <strainwave/field.hpp>
#include <strainwave/math.hpp>

/// Interface of the vibration of the flexspline's ring, as the mesh under the lobes moves it. All of it is along the line of action
/// of the mesh, in a frame that turns with the lobes. Such a law has
///
///     capacity                         largest count of modes
///     size()                           their count
///     active()                         true if it has any
///     State                            displacements [m] and speeds [m/s]
///     displacement(state)              m, of the mesh: its deformation is less by this
///     displacement_rate(state, speed)  m/s, where the lobes pass the ring at `speed` [rad/s]
///     torque(state, force)             N.m, with which a force [N] of the mesh drives the lobes on
///     rate(state, force, speed)        -> State
///     steady_state(force, speed)       -> State, under a constant force
///     energies(state)                  -> Energies
///     compliance()                     m/N, of all modes at rest
///     mode(i)                          -> Mode
namespace strainwave::ring {

/// One mode along the line of action: mass [kg], stiffness [N/m], damping [N.s/m].
template <class S>
struct Mode {
    S mass, stiffness, damping;
};

template <class S>
struct Energies {
    S elastic{0.0};  ///< J
    S kinetic{0.0};  ///< J
    S damping{0.0};  ///< that the damping takes, W
};

}  // namespace strainwave::ring
