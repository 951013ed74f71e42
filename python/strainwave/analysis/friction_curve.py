"""Friction of a gear at its input over the speed, with standard deviations: a curve to compare laws by whose numbers differ."""

from __future__ import annotations

from collections.abc import Sequence
from math import pi
from typing import Any

import numpy as np
from numpy.typing import NDArray

from strainwave import friction
from strainwave.analysis.torsion_loop import curve_sigma
from strainwave.files.gear_set import GearSet
from strainwave.files.units import convert

Array = NDArray[np.float64]

USUAL_SPEEDS = (10.0 * pi / 30.0, 100.0 * pi / 30.0)  # rad/s of the input: 10 and 100 rpm
RATINGS_OF_SPEED = ("average_input_speed", "maximum_input_speed")  # of a gear that nobody measured, best first
FRICTION_LAW = "gear.friction_input."


def measured_speed(gear_set: GearSet) -> float | None:
    """Return the largest input speed that its files contain, or that its ratings allow [rad/s]; None without both."""
    ends = [np.abs(each.measured["input_speed"]).max() for each in gear_set.validation if "input_speed" in each.measured]
    ratings = (gear_set.ratings[name] for name in RATINGS_OF_SPEED if name in gear_set.ratings)
    rated = next((convert(float(each.value), each.unit, "rad/s") for each in ratings), None)
    return float(max(ends)) if ends else rated


def compared_speeds(first: GearSet, second: GearSet) -> list[float]:
    """Return the input speeds at which the friction of two sets is compared [rad/s]: usual ones, and the largest of both."""
    largest = [speed for each in (first, second) if (speed := measured_speed(each))]
    return [speed for speed in USUAL_SPEEDS if speed < min(largest, default=np.inf)] + ([min(largest)] if largest else [])


def friction_curve(gear: Any, speeds: Sequence[float]) -> Array:
    """Return the friction at the input without load at room temperature, in the mean over the angle [N.m].

    Args:
        gear: with the friction
        speeds: of the input [rad/s], shape (n,)

    Returns:
        torques at the input, shape (n,)

    >>> import strainwave as sw
    >>> law = sw.friction.Coulomb(coulomb=0.02, viscous=1e-3)
    >>> gear = sw.Gear(friction_input=sw.friction.Cyclic(law=law, order=[2], amplitude=[0.5], phase=[0]))
    >>> friction_curve(gear, [1.0, 10.0]).round(6).tolist()
    [0.021, 0.03]
    """
    law = _mean_over_angle(gear.friction_input)
    return np.array([float(law.steady(speed)) for speed in speeds])


def _mean_over_angle(law: Any) -> Any:
    """Return a law without what varies it with the angle, relative to its mean."""
    if isinstance(law, friction.Cyclic):
        return _mean_over_angle(law.law)
    return law.replace(law=_mean_over_angle(law.law)) if hasattr(law, "law") else law


def friction_sigma(gear_set: GearSet, speeds: Sequence[float]) -> Array | None:
    """Return the standard deviations of `friction_curve` by those of its numbers, shape (n,); None if one is not stated."""
    return curve_sigma(gear_set, (FRICTION_LAW,), lambda gear: friction_curve(gear, speeds))
