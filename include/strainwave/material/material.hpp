#pragma once

/// Interface of the material of a gear: torque that depends on the rate of the twist and relaxes, in parallel to the spring. It has
///
///     State                            torques that relax; without history they are 0
///     active()                         true if it has an effect
///     largest_stiffness()              N.m/rad, while nothing relaxes
///     torque(state)                    -> N.m
///     rate(state, twist_rate)          -> State
///     relaxation_rate()                -> State, 1/s
///     lost(state)                      -> W
///     stored(state)                    -> J
///     advance(state, increment, dt)    -> State, after a twist at a constant rate: exact
///     work(state, increment, dt)       -> J, done on it meanwhile
///     storage(frequency)               N.m/rad, in phase with a sine of the twist of this angular frequency [rad/s]
///     loss(frequency)                  N.m/rad, a quarter of a period ahead
namespace strainwave::material {}
