"""Positioning error to be expected of a gear: kinematic error, wind-up at a load, and lost motion."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive, Gear, arguments, typeset
from strainwave.analysis.output_torque import check_static
from strainwave.files.gear_set import GearSet, gear_set_of
from strainwave.files.units import convert
from strainwave.parameters import every
from strainwave.presentation import Presented

Array = NDArray[np.float64]

TYPICAL_SHARE = 0.5  # of the maker's bound, that an assumed hysteresis or error of a set is: docs/reference/catalogue.md
ASSUMED_SPREAD = 0.3  # of a stiffness without a stated spread
BOUND_SIGMA = 3.0  # standard deviations of an identified number, up to which its bound reaches
ANGLES_PER_TURN = 3600  # of the input
LOST_MOTION_SHARE = 0.04  # of the rated torque, either way, between which makers state the lost motion
MAX_LOAD = 1e9  # N.m


@dataclass(frozen=True)
class ErrorBound(Presented):
    """A part of the positioning error.

    Attributes:
        name: of the part
        typical: by the numbers of the set [rad]
        bound: that a gear does not exceed, by the maker's bounds and the spreads or standard deviations of the set [rad]
        why: of the bound, in words

    >>> import strainwave as sw
    >>> kinematic, *_ = sw.analysis.positioning_error("csg-20-100")
    >>> kinematic.name, 4.0 < 206265.0 * kinematic.bound < 60.0  # arc seconds
    ('kinematic error, peak to peak', True)
    """

    name: str
    typical: float
    bound: float
    why: str

    def _headline(self) -> str:
        typical, bound = (typeset.quantity(each, "rad") for each in (self.typical, self.bound))
        return f"{self.name}: typically {typical}, at most {bound}"


def positioning_error(gear: GearSet | Drive | Gear | str | Path, *, load: float | None = None) -> tuple[ErrorBound, ...]:
    """Return the positioning error of the output that a gear makes: kinematic error, wind-up at a load, and lost motion.

    The kinematic error is peak to peak over a turn of the input. The wind-up is the twist under the load, from rest. The loop
    at no torque is the width of the hysteresis after that load in both senses. The lost motion is the way between 4 % of the
    rated torque either way, if the set has that rating.

    An assumed error or hysteresis of a set is half of the maker's bound, so the bound is twice as large. Identified numbers
    count with three standard deviations, all others with the spread that the set states, 30 % if it states none.

    Args:
        gear: a set, a gear or a drive, or the name or path of a file
        load: torque of the output [N.m]; the rated torque if not given

    Raises:
        TypeError: `gear` is none of these
        ValueError: there is no load and the set has no rated_torque, the load is not positive, or the gear has stages or a
            stiffness that varies with the angle

    >>> import strainwave as sw
    >>> for each in positioning_error("csg-20-100", load=20.0):
    ...     print(f"{each.name}: {3600 * 180 / 3.14159265 * each.bound:.0f} arcsec")
    kinematic error, peak to peak: 48 arcsec
    wind-up at 20 N·m: 257 arcsec
    loop at no torque after ±20 N·m: 60 arcsec
    lost motion between ±2.08 N·m: 55 arcsec
    """
    gear_set = gear_set_of(gear)
    check_static(gear_set.gear, gear_set.name)
    rating = gear_set.ratings.get("rated_torque")
    rated = None if rating is None else convert(rating.value, rating.unit, "N.m")
    if load is None and rated is None:
        raise ValueError(f"{gear_set.name} has no rating rated_torque; give a load [N.m]")
    load = rated if load is None else arguments.number("load", load, "N.m", low=0.0, high=MAX_LOAD)
    assert load is not None
    angle = np.linspace(0.0, 2.0 * pi, ANGLES_PER_TURN, endpoint=False)
    error = float(np.ptp(np.asarray(gear_set.gear.kinematic_error.error(angle))))
    twist = float(np.abs(np.asarray(gear_set.gear.twist(np.array([0.0, load]))))[-1])
    bounds = [
        _bounded("kinematic error, peak to peak", error, gear_set, "kinematic_error"),
        _bounded(f"wind-up at {load:g} N·m", twist, gear_set, "stiffness"),
        _loop(gear_set, load),
    ]
    if rated is not None:
        bounds.append(_lost_motion(gear_set, LOST_MOTION_SHARE * rated))
    return tuple(bounds)


def _loop(gear_set: GearSet, load: float) -> ErrorBound:
    """Return the width of the loop at no torque between two loads."""
    path = np.asarray(gear_set.gear.twist(load * np.array([0.0, 1.0, 0.0, -1.0, 0.0, 1.0, 0.0])))
    return _bounded(f"loop at no torque after ±{load:g} N·m", float(abs(path[-1] - path[-3])), gear_set, "hysteresis")


def _lost_motion(gear_set: GearSet, torque: float) -> ErrorBound:
    """Return the way from a torque to the opposite one."""
    path = np.asarray(gear_set.gear.twist(torque * np.array([0.0, 1.0, -1.0, 1.0])))
    parts = [_bounded("", float(abs(path[-1] - path[-2])), gear_set, "stiffness"), _loop(gear_set, torque)]
    width = parts[0].bound + parts[1].bound - parts[1].typical
    return ErrorBound(f"lost motion between ±{torque:g} N·m", parts[0].typical, width, f"{parts[0].why}; {parts[1].why}")


def _bounded(name: str, typical: float, gear_set: GearSet, part: str) -> ErrorBound:
    """Return the bound of a part of the error, which is proportional to the numbers of a part of the gear."""
    factor, why = _factor(gear_set, part)
    return ErrorBound(name, typical, factor * typical, why)


def _factor(gear_set: GearSet, part: str) -> tuple[float, str]:
    begin = f"gear.{part}."
    all_numbers = every(Drive(gear=gear_set.gear)).items()
    numbers = {path: each.value for path, each in all_numbers if path.startswith(begin) and each.value}
    names = {path.partition("[")[0] for path in numbers}
    sources = {path: entry for path, entry in gear_set.sources.items() if path.partition("[")[0] in names}
    deviations = []
    if gear_set.covariance is not None:
        sigmas = np.sqrt(np.diag(np.asarray(gear_set.covariance.array))).tolist()
        identified = zip(gear_set.covariance.paths, sigmas, strict=True)
        deviations = [
            sigma / abs(numbers[path]) for path, sigma in identified if path in numbers and not path.endswith("phase")
        ]
    if deviations:
        spread = BOUND_SIGMA * max(deviations)
        return 1.0 + spread, f"{part.replace('_', ' ')} is identified: three standard deviations, {100.0 * spread:.2g} %"
    if part != "stiffness" and any(entry.assumed for entry in sources.values()):
        return 1.0 / TYPICAL_SHARE, f"{part.replace('_', ' ')} is assumed: a typical gear has half of the maker's bound"
    spread = max((entry.spread for entry in sources.values() if entry.spread), default=ASSUMED_SPREAD)
    return 1.0 + spread, f"{part.replace('_', ' ')} of single gears differs by {100.0 * spread:.3g} %"
