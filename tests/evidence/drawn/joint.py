"""Logs of a drawn joint: a smooth motion, the torque that it takes, sampling, noise. Shares nothing with the package."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Friction = Callable[[Array, Array], Array]  # of the speed and the torque that the input transmits [rad/s, N.m], at the input

TIMES_FINER = 10  # steps of the drawn motion in a sample


@dataclass(frozen=True)
class Motion:
    """Motion of a joint at the instants of its samples.

    Attributes:
        time: [s], shape (n,)
        angle, speed, acceleration: of the output [rad, rad/s, rad/s2], shape (n,)
    """

    time: Array
    angle: Array
    speed: Array
    acceleration: Array


def several_speeds(random: np.random.Generator) -> Motion:
    """Return a motion to and fro over several speeds: sines of different periods."""
    rate, duration = float(random.choice([100.0, 200.0, 500.0])), float(random.uniform(20.0, 40.0))
    time = np.arange(0.0, duration, 1.0 / rate)
    angle, speed, acceleration = np.zeros((3, len(time)))
    for frequency in random.uniform(0.05, 0.5, int(random.integers(2, 5))):
        size, phase, w = float(random.uniform(0.2, 0.6)), float(random.uniform(0.0, 6.28)), 2.0 * np.pi * frequency
        angle += size * np.sin(w * time + phase)
        speed += size * w * np.cos(w * time + phase)
        acceleration -= size * w**2 * np.sin(w * time + phase)
    return Motion(time, angle, speed, acceleration)


def torque_of_input(
    motion: Motion, ratio: float, rotor: float, load: float, gravity: float, friction: Friction
) -> tuple[Array, Array]:
    """Return the torque at the input [N.m] that a motion takes, and the part of it that the gear transmits.

    Args:
        motion: of the output
        ratio: speed of the input over that of the output
        rotor: inertia at the input [kg.m2]
        load: inertia at the output [kg.m2]
        gravity: largest torque of gravity at the output [N.m]
        friction: at the input
    """
    carried = (load * motion.acceleration + gravity * np.sin(motion.angle)) / ratio
    return rotor * ratio * motion.acceleration + carried + friction(ratio * motion.speed, carried), carried
