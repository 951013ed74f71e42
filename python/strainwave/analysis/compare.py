"""Comparison of two recordings, or of two models."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import zip_longest
from math import hypot, isfinite, pi
from typing import Any, TypeAlias, overload

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive, arguments
from strainwave._core import Gear
from strainwave.analysis.friction_curve import FRICTION_LAW, compared_speeds, friction_curve, friction_sigma
from strainwave.analysis.torsion_loop import LAWS, SHARES_OF_TORQUE, loop_sigma, measured_torque, rated_torque, torsion_loop
from strainwave.files.described import parameters, parts
from strainwave.files.gear_file import at
from strainwave.files.gear_set import GearSet
from strainwave.files.recording import Recording
from strainwave.messages import listed, quoted, shortened
from strainwave.presentation import Statement

Array = NDArray[np.float64]
Model: TypeAlias = Gear | Drive | GearSet
MAX_ROUNDING_OF_PHASE = 1e-12  # rad: of a whole turn that is taken off
MIN_SHARE_OF_TORQUE = 0.5  # of the torque that a gear was measured to: a smaller loop has no standard deviation


@dataclass(frozen=True)
class Agreement(Statement):
    """Agreement of a column of one recording with that of another.

    Attributes:
        name, unit: of the column, as the first recording has it
        rms: root mean square of the difference, each sample of the first counted once [unit]
        largest: largest size of the difference [unit]
        time: when it is that large [s]
        correlation: Pearson's coefficient; None where one of them does not change
        samples: how many were compared

    >>> import strainwave as sw
    >>> units = {"time": "s", "torque": "N.m"}
    >>> measured = sw.Recording({"time": [0.0, 1.0, 2.0], "torque": [0.0, 10.0, 20.0]}, units)
    >>> (agreement,) = sw.compare(measured, measured.with_column("torque", [0.0, 10.4, 20.3], "N.m"))
    >>> round(agreement.rms, 3), round(agreement.largest, 3), agreement.unit, agreement.time
    (0.289, 0.4, 'N.m', 1.0)
    """

    name: str
    unit: str
    rms: float
    largest: float
    time: float
    correlation: float | None
    samples: int

    def _headline(self) -> str:
        related = "one is constant" if self.correlation is None else f"correlation {self.correlation:.6g}"
        sizes = f"rms {self.rms:.4g} {self.unit}, largest {self.largest:.4g} {self.unit} at t = {self.time:.4g} s"
        return f"{self.name}: {sizes}, {related}"


def agreements(first: Recording, second: Recording, names: Sequence[str] | None) -> list[Agreement]:
    """Return the agreement of each column that both recordings have, or of the named ones; see `compare`."""
    time, other = first.time, second.time
    if names is None:
        wanted = [name for name in first.names if name in second and name != "time"]
        if not wanted:
            raise ValueError(f"the recordings have no column in common: {listed(first.names)}; and {listed(second.names)}")
    elif not (wanted := arguments.names("names", names)) or "time" in wanted:
        raise ValueError(f"names = {shortened(wanted)} must name columns besides the time; there are {listed(first.names)}")
    common = (time >= other[0]) & (time <= other[-1])
    if not common.any():
        apart = time[-1] < other[0] or other[-1] < time[0]
        remedy = "shift the time of one" if apart else "no sample of the first lies within the second, so exchange them"
        one, two = (f"{of[0]:g} s to {of[-1]:g} s" for of in (time, other))
        raise ValueError(f"the recordings have no time in common: {one} and {two}; {remedy}")
    return [_agreement(name, first, second, common) for name in wanted]


def _agreement(name: str, first: Recording, second: Recording, common: NDArray[np.bool_]) -> Agreement:
    """All sums are of numbers up to 2, as squares of the largest and of the smallest numbers are none."""
    unit, at = first.unit(name), first.time[common]
    try:
        theirs = second.values(name, unit)
    except ValueError as error:
        others = "name the columns to compare"
        raise ValueError(f"{error}; {others}" if name in second else str(error)) from None
    ours = first[name][common]
    scale = max(np.abs(ours).max(), np.abs(theirs).max()) or 1.0
    ours, theirs = ours / scale, theirs / scale
    if not np.array_equal(second.time, at):  # between samples on a straight line
        with np.errstate(over="ignore", invalid="ignore"):  # a jump within no time; what is not finite is refused below
            theirs = np.interp(at, second.time, theirs)
    difference = theirs - ours
    worst = int(np.argmax(np.abs(difference)))
    with np.errstate(over="ignore"):
        rms, largest = (float(scale * part) for part in (np.sqrt(np.mean(difference**2)), abs(difference[worst])))
    if not isfinite(largest):
        raise ValueError(f"column {quoted(name)} differs by more than the largest number there is, at t = {at[worst]:g} s")
    return Agreement(name, unit, rms, largest, float(at[worst]), _correlation(ours, theirs), len(at))


def _correlation(first: Array, second: Array) -> float | None:
    """Pearson's coefficient; None where one of them does not change."""
    deviations = [values - values.mean() for values in (first, second)]
    sizes = [np.abs(each).max() for each in deviations]
    if min(np.ptp(first), np.ptp(second)) == 0.0 or min(sizes) == 0.0:
        return None
    one, other = (each / size for each, size in zip(deviations, sizes, strict=True))
    return float(np.clip((one @ other) / np.sqrt((one @ one) * (other @ other)), -1.0, 1.0))


@dataclass(frozen=True)
class Difference(Statement):
    """A place where two models differ.

    Attributes:
        path: of a number, as "gear.stiffness.k1", of the model of a part, as "gear.stiffness", of a rating, or a place of the
            torsion loop or the friction over the speed in words
        first, second: the numbers, or the models' names; None where one of them does not have it
        unit: of the numbers, empty for names
        sigma: standard deviation of the second less the first, as if they were independent; None unless both sets state one
            and a measurement determines one of both numbers

    >>> import strainwave as sw
    >>> gear = sw.load("csg-25-100")
    >>> (difference,) = sw.compare(gear, gear.replace({"stiffness.k1": 0.8 * gear.stiffness.k1}))
    >>> difference.path, round(difference.change, 3)
    ('gear.stiffness.k1', -0.2)
    """

    path: str
    first: float | str | None
    second: float | str | None
    unit: str = ""
    sigma: float | None = None

    @property
    def deviations(self) -> float | None:
        """The second less the first in standard deviations; None where none is stated, or it is 0."""
        if isinstance(self.first, str | None) or isinstance(self.second, str | None) or not self.sigma:
            return None
        return (wrapped(self.second - self.first) if self.is_phase else self.second - self.first) / self.sigma

    @property
    def is_phase(self) -> bool:
        """True for a phase: a whole turn makes no difference."""
        return self.unit == "rad" and self.path.partition("[")[0].endswith("phase")

    @property
    def change(self) -> float | None:
        """The second less the first, relative to the first; None where that is no number, and of phases."""
        if isinstance(self.first, str | None) or isinstance(self.second, str | None) or self.first == 0 or self.is_phase:
            return None
        change = (self.second - self.first) / self.first
        return change if isfinite(change) else None

    def _headline(self) -> str:
        unit = "" if self.unit in ("", "1") else f" {self.unit}"
        first, second = (text if value is None else text + unit for text, value in zip(self.texts, self._values, strict=True))
        parts = [f"{100.0 * self.change:+.3g} %"] if self.change is not None else []
        parts += [f"{self.deviations:+.2g} σ"] if self.deviations is not None else []
        change = f" ({', '.join(parts)})" if parts else ""
        return f"{self.path}: {first} against {second}{change}"

    @property
    def texts(self) -> tuple[str, str]:
        """Return both numbers or names as texts, without their unit; numbers with so many digits that they differ."""
        digits = next(digits for digits in (6, 10, 17) if digits == 17 or len({_shown(v, digits) for v in self._values}) == 2)
        first, second = (_shown(value, digits) for value in self._values)
        return first, second

    @property
    def _values(self) -> tuple[float | str | None, float | str | None]:
        return self.first, self.second


def _shown(value: float | str | None, digits: int) -> str:
    return "nothing" if value is None else value if isinstance(value, str) else f"{value:.{digits}g}"


def differences(first: Model, second: Model) -> list[Difference]:
    """Return every number and every law in which two models differ; see `compare`."""
    ours, theirs = _parts(first), _parts(second)
    if isinstance(first, Gear) or isinstance(second, Gear):
        return _between("gear", ours["gear"], theirs["gear"])
    differing = [difference for name in ours for difference in _between(name, ours[name], theirs[name])]
    if not (isinstance(first, GearSet) and isinstance(second, GearSet)):
        return differing
    for place, each in enumerate(differing):
        if (
            isinstance(each.first, float | int)
            and isinstance(each.second, float | int)
            and _determined((each.path,), first, second)
        ):
            one, other = first.sources[each.path].sigma(each.first), second.sources[each.path].sigma(each.second)
            if one is not None and other is not None:
                differing[place] = replace(each, sigma=hypot(one, other))
    of_ratings = _ratings(first, second)
    return _with_loop(_with_friction(differing, first, second), first, second) + of_ratings


def _determined(places: tuple[str, ...], first: GearSet, second: GearSet) -> bool:
    """True if a measurement of one of two sets determines one of these numbers, or of these laws, as "gear.stiffness.".

    The scatter of a catalogue is no measurement.
    """
    entries = [(path, entry) for each in (first, second) for path, entry in each.sources.items()]
    measured = (path for path, entry in entries if entry.uncertainty is not None)
    return any(path == place or (place.endswith(".") and path.startswith(place)) for path in measured for place in places)


def _with_friction(differing: list[Difference], first: GearSet, second: GearSet) -> list[Difference]:
    """Return differences with those of the friction at the input over the speed behind those of its law, if the laws differ."""
    places = [place for place, each in enumerate(differing) if each.path.startswith(FRICTION_LAW.removesuffix("."))]
    if not any(isinstance(differing[place].first, str) for place in places):
        return differing
    speeds = compared_speeds(first, second)
    names = [f"friction at {speed * 30.0 / pi:.4g} rpm" for speed in speeds]
    curves = [friction_curve(each.gear, speeds) for each in (first, second)]
    sigmas = [friction_sigma(each, speeds) for each in (first, second)]
    curve = _of_curves(names, ["N.m"] * len(names), curves, sigmas, _determined((FRICTION_LAW,), first, second))
    return [*differing[: places[-1] + 1], *curve, *differing[places[-1] + 1 :]]


def _of_curves(
    names: Sequence[str], units: Sequence[str], curves: Sequence[Array], sigmas: Sequence[Array | None], is_determined: bool
) -> list[Difference]:
    """Return the differences of two curves, with standard deviations where both have them and a measurement determines one."""
    stated = [each for each in sigmas if each is not None]
    both = np.hypot(*stated).tolist() if len(stated) == 2 and is_determined else [None] * len(names)
    first, second = (each.tolist() for each in curves)
    rows = zip(names, first, second, units, both, strict=True)
    return [Difference(name, one, other, unit, sigma) for name, one, other, unit, sigma in rows]


def _with_loop(differing: list[Difference], first: GearSet, second: GearSet) -> list[Difference]:
    """Return differences with those of the torsion loop in place of those of single elements of hysteresis, if any differ.

    The loop goes to the smaller of the torques that both gears were measured or are rated to. A gear says little of less than
    half the torque that it was measured to: there no standard deviation is stated, but these torques.
    """
    measured = [measured_torque(each) for each in (first, second)]
    torque = min(own or rated_torque(each) or 0.0 for own, each in zip(measured, (first, second), strict=True))
    if not torque or not any(each.path.startswith(("gear.hysteresis", "gear.stiffness")) for each in differing):
        return differing
    is_far_below = any(torque < MIN_SHARE_OF_TORQUE * (own or 0.0) for own in measured)
    curves = [torsion_loop(each.gear, torque) for each in (first, second)]
    sigmas = [None if is_far_below else loop_sigma(each, torque) for each in (first, second)]
    places = [*(f"twist falling through {share * torque:.4g} N.m" for share in SHARES_OF_TORQUE), "loss"]
    names = [f"loop to {torque:.4g} N.m: {place}" for place in places]
    units = [*["rad"] * len(SHARES_OF_TORQUE), "J"]
    loop = _of_curves(names, units, curves, sigmas, _determined(LAWS, first, second))
    reached = (
        [Difference(f"loop to {torque:.4g} N.m: was measured to", measured[0], measured[1], "N.m")] if is_far_below else []
    )
    return [*(each for each in differing if not each.path.startswith("gear.hysteresis.")), *reached, *loop]


def _parts(model: Model) -> dict[str, Any]:
    """The parts of a drive by name; None where a set does not have one."""
    return {"gear": model} if isinstance(model, Gear) else {each.name: getattr(model, each.name) for each in parts(Drive())}


def _between(path: str, first: Any, second: Any) -> list[Difference]:
    if type(first) is not type(second):
        one, other = (None if each is None else str(each.name) for each in (first, second))
        return [Difference(path, one, other)]
    if first is None:
        return []
    differing: list[Difference] = []
    for number in parameters(first):
        one, other = getattr(first, number.name), getattr(second, number.name)
        for place, pair in _pairs(f"{path}.{number.name}", one, other):
            difference = Difference(place, *pair, number.unit or "")
            if difference.is_phase:
                difference = replace(difference, first=_phase(difference.first), second=_phase(difference.second))
            if _differ(difference):
                differing.append(difference)
    for part in parts(first):
        differing += _between(f"{path}.{part.name}", getattr(first, part.name), getattr(second, part.name))
    return differing


def wrapped(angle: float) -> float:
    """Return an angle within half a turn, in (-pi, pi] [rad].

    >>> wrapped(-pi) == pi, round(wrapped(7.0), 3)
    (True, 0.717)
    """
    return pi - (pi - angle) % (2.0 * pi)


def _phase(value: float | str | None) -> float | str | None:
    return wrapped(value) if isinstance(value, float | int) else value


def _differ(difference: Difference) -> bool:
    if difference.is_phase and isinstance(difference.first, float) and isinstance(difference.second, float):
        return abs(wrapped(difference.second - difference.first)) > MAX_ROUNDING_OF_PHASE
    return difference.first != difference.second


def _pairs(path: str, first: Any, second: Any) -> list[tuple[str, tuple[Any, Any]]]:
    """The two numbers at each place; None where one of two sequences has ended."""
    if isinstance(first, float | int | str):
        return [(path, (first, second))]
    return [(f"{path}[{i}]", pair) for i, pair in enumerate(zip_longest(first, second))]


def _ratings(first: GearSet, second: GearSet) -> list[Difference]:
    """The ratings that differ, in the unit of the first set."""
    differing = []
    for name in [*first.ratings, *(name for name in second.ratings if name not in first.ratings)]:
        ratings = [of.ratings.get(name) for of in (first, second)]
        unit = next(rating.unit for rating in ratings if rating is not None)
        with at(f"ratings.{name}:"):
            one, other = (None if rating is None else float(rating.to(unit).value) for rating in ratings)
        if one != other:
            differing.append(Difference(f"ratings.{name}", one, other, unit))
    return differing


@overload
def compare(first: Recording, second: Recording, names: Sequence[str] | None = None) -> list[Agreement]: ...
@overload
def compare(first: Model, second: Model) -> list[Difference]: ...
def compare(first: Any, second: Any, names: Sequence[str] | None = None) -> Any:
    """Compare two recordings, or two models.

    Of recordings each column that both have is compared, over the time that both cover: the second is read off at the samples
    of the first, between its own on a straight line. Columns of other units are converted. Of models all numbers are compared,
    and which law stands at which place; of a gear and a drive the gear. Of two sets the ratings are compared, too. Elements of
    hysteresis are not unique: of two sets the torsion loop is compared in their place, to a torque that both were measured or
    are rated to. Where laws of friction at the input differ, the torque is compared at 10 and 100 rpm, and at the largest speed
    that both were measured or are rated to.

    Args:
        first, second: two recordings with the column `time`; or two of gear, drive and set
        names: the columns to compare; without it all that both recordings have

    Returns:
        Of recordings the agreement of each column, in the order of the first or of `names`. Of models the differences, none if
        they are equal.

    Raises:
        TypeError: they are not of one kind, or `names` is given for models
        ValueError: the recordings have no time or no other column in common, do not overlap, or a column measures something
            else in one of them

    >>> import strainwave as sw
    >>> one = sw.Recording({"time": [0.0, 1.0, 2.0], "torque": [0.0, 1.0, 2.0]}, {"time": "s", "torque": "N.m"})
    >>> other = sw.Recording({"time": [0.5, 2.5], "torque": [400.0, 2600.0]}, {"time": "s", "torque": "mN.m"})
    >>> print(*sw.compare(one, other))
    torque: rms 0.05 N.m, largest 0.05 N.m at t = 2 s, correlation 1
    >>> print(*sw.compare(sw.load("csg-25-100"), sw.load("csg-32-100"))[:1])
    gear.damping: 4.526 N.m.s/rad against 13.46 N.m.s/rad (+197 %)
    """
    kinds = [_kind(name, each) for name, each in (("first", first), ("second", second))]
    if kinds[0] != kinds[1]:
        raise TypeError(f"first is {kinds[0]}, second {kinds[1]}; give two recordings, or two of gear, drive and set")
    if isinstance(first, Recording):
        return agreements(first, second, names)
    if names is not None:
        raise TypeError(f"names = {shortened(names)}: of models all numbers are compared; leave it out")
    return differences(first, second)


def _kind(name: str, each: object) -> str:
    if not isinstance(each, Recording | Model):
        raise TypeError(f"{name} = {shortened(each)} must be a recording, a gear, a drive or a set")
    return "a recording" if isinstance(each, Recording) else "a model"
