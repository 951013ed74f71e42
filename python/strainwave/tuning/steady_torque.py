"""Torque that a gear takes at its input at constant speed under a constant load, in the closed form of its equations."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from strainwave import Gear
from strainwave.simulation.excitation import ROOM_TEMPERATURE

Array = NDArray[np.float64]


class SteadyTorque(NamedTuple):
    """Torques at the input beyond the load over the ratio, each in the shape of speed and angle.

    Attributes:
        friction: of all places [N.m], positive where it opposes a positive speed
        reaction: change of the load's torque by the kinematic error [N.m]
    """

    friction: Array
    reaction: Array


def steady_torque(
    gear: Gear, speed: ArrayLike, angle: ArrayLike = 0.0, load: float = 0.0, temperature: float = ROOM_TEMPERATURE
) -> SteadyTorque:
    """Return the torques of a gear that turns steadily.

    Args:
        gear: with its twist at rest
        speed: of the input [rad/s]
        angle: of the input [rad]; speed and angle are broadcast
        load: torque at the output that opposes forward motion [N.m]
        temperature: of the gear [K]
    """
    turning, where = (np.array(each) for each in np.broadcast_arrays(np.asarray(speed, float), np.asarray(angle, float)))
    inverse = 1.0 / gear.kinematics.ratio
    full = np.asarray(gear.kinematic_error.slope(where.ravel())).reshape(where.shape)
    transmitted = np.full(where.shape, load)
    for _ in range(2):  # friction of the output is transmitted too, and eases the error a little
        slope = full / (1.0 + getattr(gear.kinematic_error, "load_sensitivity", 0.0) * np.abs(transmitted))
        per_input = inverse - slope
        at_output = gear.friction_output.steady(turning * per_input, where * inverse, load, temperature)
        transmitted = load + at_output
    at_mesh = gear.friction_mesh.steady(turning * per_input, where * inverse, transmitted, temperature)
    at_input = gear.friction_input.steady(turning, where, per_input * transmitted, temperature)
    return SteadyTorque(np.asarray(at_input + per_input * (at_mesh + at_output)), np.asarray(-load * slope))
