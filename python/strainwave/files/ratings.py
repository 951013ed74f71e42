"""Limits by the maker of a gear, compared with a recording."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive, arguments
from strainwave.files.entries import Quantity
from strainwave.files.gear_set import GearSet
from strainwave.files.recording import Recording
from strainwave.files.units import convert
from strainwave.messages import shortened
from strainwave.presentation import Statement

Array = NDArray[np.float64]


class RatingWarning(UserWarning):
    """A simulation exceeded what the ratings of its gear set allow.

    >>> import warnings
    >>> import strainwave as sw
    >>> with warnings.catch_warnings(record=True) as caught:
    ...     warnings.simplefilter("always")
    ...     run = sw.simulate(sw.GearSet.read("robot-joint"), sw.scenario.step(2.0, duration=0.1))
    >>> print(str(caught[1].message).partition(" (")[0])
    Robot joint: peak torque: 266.2 N.m exceeds the limit of 204 N.m, first at t = 0.0096 s
    """


@dataclass(frozen=True)
class RatingCheck(Statement):
    """One limit of a gear set, and what a recording reached of it.

    Attributes:
        name: name of the rating, as "peak_torque"
        limit: the rating, with its source
        reached: what the recording shows, in the unit of the limit
        time: when it was exceeded for the first time [s]; None where it was not, where the limit is one of a mean, or
            where the recording has no time
        recording: title of the recording

    >>> import strainwave as sw
    >>> run = sw.Recording({"time": [0.0, 0.1, 0.2], "torque": [0.0, -129.0, 60.0]}, {"time": "s", "torque": "N.m"})
    >>> check = sw.check_ratings(sw.GearSet.read("csg-20-100"), run)[0]
    >>> check.name, check.reached, check.limit.value, check.exceeded, check.time
    ('peak_torque', 129.0, 107.0, True, 0.1)
    """

    name: str
    limit: Quantity
    reached: float
    time: float | None
    recording: str

    @property
    def exceeded(self) -> bool:
        """True if the recording exceeded the limit."""
        return self.reached > self.limit.value

    def _headline(self) -> str:
        """The check in one line."""
        unit = self.limit.unit
        verdict = "exceeds" if self.exceeded else "keeps"
        when = "" if self.time is None else f", first at t = {self.time:.4g} s"
        limit = f"the limit of {self.limit.value:g} {unit}{when} ({self.limit.source})"
        return f"{self.name.replace('_', ' ')}: {self.reached:.4g} {unit} {verdict} {limit}"


def check_ratings(gear_set: GearSet, *recordings: Recording) -> list[RatingCheck]:
    """Compare recordings with the limits that a gear set states.

    | rating | what is compared with it |
    |---|---|
    | peak_torque, momentary_torque, ratcheting_torque, buckling_torque | the largest torque at the output |
    | average_torque | the cubic mean of this torque, weighted by the input speed: (∫|n| |T|³ dt / ∫|n| dt)^(1/3) |
    | maximum_input_speed | the largest input speed |
    | average_input_speed | the mean of the input speed's size over time |

    The torque is the column `torque`, the speed `input_speed`. In a friction table, which has the columns `speed` and
    `torque`, both belong to the input: its speed is compared, its torque is not. Ratings by other names are no limits of
    this kind (the rated torque is one of life), and what a recording has no columns for is not compared.

    Args:
        gear_set: the set with its `ratings`
        recordings: runs, logs, torsion loops or friction tables; each is compared by itself

    Returns:
        One check for each limit and recording that can be compared, in the order of the recordings and ratings.

    Raises:
        TypeError: an argument is not of its kind
        ValueError: a rating or a column has a unit that does not measure torque or speed

    >>> import strainwave as sw
    >>> gear_set = sw.GearSet.read("csg-20-100")
    >>> run = sw.Recording({"time": [0.0, 0.1, 0.2], "torque": [0.0, -129.0, 60.0]}, {"time": "s", "torque": "N.m"})
    >>> for check in check_ratings(gear_set, run):
    ...     if check.exceeded:
    ...         print(check)
    peak torque: 129 N.m exceeds the limit of 107 N.m, first at t = 0.1 s (Harmonic Drive AG catalogue, limit for repeated \
peak torque, CSG-20-100)
    """
    if not isinstance(gear_set, GearSet):
        raise TypeError(f"gear_set must be a GearSet, as sw.GearSet.read(...) gives it, not {shortened(gear_set)}")
    for recording in recordings:
        if not isinstance(recording, Recording):
            raise TypeError(f"recordings must hold a Recording each, not {shortened(recording)}")
    checks = (_check(name, limit, each) for each in recordings for name, limit in gear_set.ratings.items())
    return [check for check in checks if check is not None]


def drive_of(model: object) -> Drive:
    """The drive to run: itself, or that of a gear set."""
    return model.drive if isinstance(model, GearSet) else arguments.drive(model)


def warn_of_ratings(model: Drive | GearSet, run: Recording) -> None:
    """Warns the caller of a simulation of a gear set of every limit that the run exceeded; a drive has no limits."""
    for check in check_ratings(model, run) if isinstance(model, GearSet) else ():
        if check.exceeded:
            warnings.warn(f"{model.name}: {check}", RatingWarning, stacklevel=3)


def _check(name: str, limit: Quantity, recording: Recording) -> RatingCheck | None:
    """Return the check of one limit; None if it is none of this kind, or the recording lacks the quantity."""
    measure = _LARGEST.get(name, _MEAN.get(name))
    measured = None if measure is None else measure(recording)
    if measured is None:
        return None
    try:
        reached = convert(measured.sizes, measured.unit, limit.unit)
    except ValueError as error:
        raise ValueError(f"ratings.{name}: {error}") from None
    beyond = reached > limit.value
    timed = name in _LARGEST and "time" in recording and beyond.any()
    time = float(recording.time[np.argmax(beyond)]) if timed else None
    return RatingCheck(name, limit, float(reached.max()), time, recording.title)


# What is measured


class _Measured(NamedTuple):
    """Sizes of a quantity, at every sample or one mean, and their unit."""

    sizes: Array
    unit: str


def _output_torque(recording: Recording) -> _Measured | None:
    if "torque" not in recording or "speed" in recording:  # of a friction table it is the input's
        return None
    return _Measured(np.abs(recording.values("torque", "N.m")), "N.m")


def _input_speed(recording: Recording) -> _Measured | None:
    for name in ("input_speed", "speed"):
        if name in recording:
            return _Measured(np.abs(recording.values(name, "rad/s")), "rad/s")
    return None


def _mean_torque(recording: Recording) -> _Measured | None:
    torque, speed = _output_torque(recording), _input_speed(recording)
    if torque is None or speed is None or "time" not in recording:
        return None
    turned = np.trapezoid(speed.sizes, recording.time)
    if not turned > 0.0:
        return None
    return _Measured(np.array([np.cbrt(np.trapezoid(speed.sizes * torque.sizes**3, recording.time) / turned)]), "N.m")


def _mean_speed(recording: Recording) -> _Measured | None:
    speed = _input_speed(recording)
    if speed is None or "time" not in recording or len(recording) < 2:
        return None
    lasted = recording.time[-1] - recording.time[0]
    return _Measured(np.array([np.trapezoid(speed.sizes, recording.time) / lasted]), "rad/s")


Measure = Callable[[Recording], _Measured | None]
_LARGEST: dict[str, Measure] = {
    "peak_torque": _output_torque,
    "momentary_torque": _output_torque,
    "ratcheting_torque": _output_torque,
    "buckling_torque": _output_torque,
    "maximum_input_speed": _input_speed,
}
_MEAN: dict[str, Measure] = {"average_torque": _mean_torque, "average_input_speed": _mean_speed}
