"""Friction over the temperature, from a long log of an axis that moves to and fro while it warms up."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from strainwave import arguments
from strainwave.files.recording import Recording, check_recording
from strainwave.identification.candidates.steady_shapes import MIN_TEMPERATURE_SPAN
from strainwave.identification.experiments.experiment import sensible
from strainwave.identification.experiments.steady_motion import MIN_MOVING_SPEED
from strainwave.identification.fitting.estimate import Estimate
from strainwave.statistics.linear_fit import normal_inverse, solved
from strainwave.statistics.scale import ONE_SIGMA, student

Array = NDArray[np.float64]

BLOCK_LENGTHS = (10, 30, 100)  # samples that may err together
MIN_BLOCKS = 10  # for a variance


@dataclass(frozen=True)
class Warming:
    """Friction of an axis over its temperature, F = F0 + F' (T - T0).

    Attributes:
        friction: its friction F0 at the reference temperature, in the unit of the effort
        slope: how it changes with the temperature F' [unit of the effort per K]
        fall: its relative fall with the temperature -F' / F0 [1/K], as `friction.Thermal.dry_fall`
        reference_temperature: T0, mean of the samples in motion [K]
        samples: count of those in motion
        together: length of the blocks of samples that the intervals rest on
        one_way: True if all motion is of one direction: then a weight and an offset of the effort are in F0
    """

    friction: Estimate
    slope: Estimate
    fall: Estimate
    reference_temperature: float
    samples: int
    together: int
    one_way: bool = False


def friction_over_temperature(recording: Recording, effort: str = "current", *, slowest: float | None = None) -> Warming:
    """Return the part of an effort that reverses with the motion, and its change while the axis warms up.

    Least squares of the effort by a constant and its drift with the temperature (weight, offset), by sgn(v) and sgn(v) times
    T - T0. Other torques, as that of the inertia, count as noise. Such noise correlates over a movement and longer: the
    variance is that of sums over blocks of neighbouring samples (LiangZeger1986), the largest of several lengths of block.

    A log of one warm-up does not separate temperature from other changes in the same time, as wear-in or another task. A
    motion of one direction does not separate the friction from a weight or an offset: its slope alone is that of the friction.

    Args:
        recording: columns speed, temperature and the effort, in the order of time
        effort: column of a current or a torque
        slowest: speed from which on the axis surely moves [rad/s]; a twentieth of the largest if not given

    Raises:
        ValueError: a temperature that hardly changes, too few samples in motion, or no friction
    """
    check_recording("recording", recording)
    speed, temperature = sensible(recording, "speed", "rad/s"), recording.values("temperature", "K")
    force, unit = recording[effort], recording.unit(effort)
    least = (
        MIN_MOVING_SPEED * float(np.abs(speed).max())
        if slowest is None
        else arguments.number("slowest", slowest, "rad/s", low=0.0)
    )
    moving = np.abs(speed) > least
    if moving.sum() < MIN_BLOCKS * BLOCK_LENGTHS[0]:
        raise ValueError(f"only {moving.sum()} samples move faster than {least:.3g} rad/s: record more of the motion")
    force, way, temperature = force[moving], np.sign(speed[moving]), temperature[moving]
    if np.ptp(temperature) < MIN_TEMPERATURE_SPAN:
        raise ValueError(
            f"the temperature changes by {np.ptp(temperature):.2g} K only; "
            f"record a warm-up of {MIN_TEMPERATURE_SPAN:g} K or more"
        )
    middle = float(np.mean(temperature))
    warmer = temperature - middle
    one_way = bool(np.ptp(way) == 0.0)
    of_load = [] if one_way else [np.ones_like(way), warmer]
    jacobian = np.stack([*of_load, way, way * warmer], axis=1)
    found = solved(jacobian, force)
    scores = jacobian * (force - jacobian @ found)[:, np.newaxis]
    inverse = normal_inverse(jacobian)
    covariances = [
        (length, _clustered(scores, inverse, length)) for length in BLOCK_LENGTHS if len(force) // length >= MIN_BLOCKS
    ]
    length, covariance = max(covariances, key=lambda each: each[1][-1, -1])
    freedom = len(force) / length - len(found)
    wider = student(ONE_SIGMA, freedom)
    level, slope = found[-2:].tolist()
    if level == 0.0:
        raise ValueError(
            f"no part of {effort} turns round with the motion: it shows no friction; give the current or torque of "
            "the motor that moves the axis"
        )
    of_fall = np.array([slope / level**2, -1.0 / level])
    covariance = covariance[-2:, -2:]
    sigmas = [np.sqrt(covariance[0, 0]), np.sqrt(covariance[1, 1]), np.sqrt(of_fall @ covariance @ of_fall)]
    numbers: Sequence[tuple[str, str, float]] = (
        ("friction", unit, level), ("slope", f"{unit}/K", slope), ("dry_fall", "1/K", -slope / level)
    )  # fmt: skip
    of_level, of_slope, of_both = (
        Estimate(name, of, 0.0, value, wider * float(sigma), False, freedom)
        for (name, of, value), sigma in zip(numbers, sigmas, strict=True)
    )
    return Warming(of_level, of_slope, of_both, middle, int(moving.sum()), length, one_way)


def _clustered(scores: Array, inverse: Array, length: int) -> Array:
    """Return the covariance if samples of one block may err together, and blocks err alone."""
    sums = np.add.reduceat(scores, np.arange(0, len(scores), length), axis=0)
    blocks = len(sums)
    covariance: Array = blocks / (blocks - 1.0) * inverse @ (sums.T @ sums) @ inverse
    return covariance
