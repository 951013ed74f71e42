"""A recording compared with what a saved gear predicts: the error, what the gear allows, and what changed."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive
from strainwave.equality import ComparedByFields
from strainwave.files.gear_set import GearSet
from strainwave.files.identified_tables import Validation
from strainwave.files.recording import Recording
from strainwave.identification.experiments.motion_log import FRICTIONLESS
from strainwave.identification.results.check import Check
from strainwave.orders.lines import Line
from strainwave.parameters import every

Array = NDArray[np.float64]

SIGNIFICANCE_SIGMA = 3.0  # standard deviations by which a change must differ from none
MIN_CHANGE = 0.03  # of a scale [1], and of the zero over what the channel varies by: laws of friction are no better
MAX_APART = 0.05  # between scales that are one: a loss under load is friction, and grows with the load
MAX_SCALE_SIGMA = 0.5  # standard deviation of a scale [1]; a recording that determines it less well does not determine it
DIFFERENCE = 0.1  # standard deviations of a number, over which the difference of two predictions is taken
BLOCKS = 20  # contiguous ones of a recording, over which what is left scatters
MIN_SAMPLES = 50  # of sliding, from which changes are determined
MAX_ERROR_FACTOR = 2.0  # of the error that a gear has on its own files: one half of a record predicts the other within 1.7
MAX_UNEXPLAINED = 0.5  # of what varies, for a gear without errors on its own files
DRY, VISCOUS, FRICTION, ZERO = "dry friction", "viscous friction", "friction", "zero"
INERTIA, GRAVITY, TEMPERATURE = "inertia of the load", "gravity of the load", "friction over temperature"
PLACES = ("friction_input", "friction_mesh", "friction_output")


@dataclass(frozen=True)
class Change:
    """What a recording shows of a part of a saved gear or drive.

    Attributes:
        name: of the part: `dry friction`, `viscous friction`, `friction` if the recording does not separate both, `zero` of the
            channel, `inertia of the load`, `gravity of the load`, `friction over temperature`
        value: its scale, 1 if it is as saved; of the zero its value; over temperature the relative change per kelvin
        sigma: standard deviation of `value`, with that of the saved numbers
        unit: of both
        unchanged: `value` of the saved gear
        smallest: difference from it that matters; a smaller one is none, however sure
    """

    name: str
    value: float
    sigma: float
    unit: str
    unchanged: float
    smallest: float = 0.0

    @property
    def significance(self) -> float:
        """The difference from the saved gear in standard deviations [1]."""
        off = abs(self.value - self.unchanged)
        return off / self.sigma if self.sigma > 0.0 else (0.0 if off == 0.0 else np.inf)

    @property
    def significant(self) -> bool:
        """True if it differs from the saved gear by what matters, and by more than chance makes."""
        return self.significance > SIGNIFICANCE_SIGMA and abs(self.value - self.unchanged) >= self.smallest


@dataclass(frozen=True, eq=False)
class Direction(ComparedByFields):
    """How a channel changes with a part of a gear.

    Attributes:
        name, unit, unchanged, smallest: as of a `Change`
        effect: derivative of the channel, shape (n,)
    """

    name: str
    unit: str
    unchanged: float
    effect: Array
    smallest: float = MIN_CHANGE


@dataclass(frozen=True, eq=False)
class Prediction(ComparedByFields):
    """A recording compared with what a saved gear or drive predicts, every sample in the full band.

    Attributes:
        name: of the file
        gear: name of the saved gear
        kind: of the measurement, as `KINDS` has it; empty if it could not be read
        channel: that is predicted
        unit: of all errors
        error: root mean square of measured less predicted; at rest of what no friction that holds makes up for
        varies: root mean square of the channel about its mean: the error of a model that predicts nothing
        plain: error of plain least squares fitted to this recording itself; not a number without
        allowed: largest error that agrees with the saved gear: twice that on its own files and by its covariance
        samples: compared
        changes: what the recording shows of parts of the gear
        error_with_changes: the error that is left with them
        lines: of the spectrum of the residual, as orders of the input or frequencies, the strongest evidence first
        curves: what it is drawn over, the channel, `predicted` and `residual`; None if it could not be read
        checks: that of the error; failed if the recording contradicts the gear
        remarks: assumptions and limits, in short sentences
        refused: why the recording cannot be predicted; empty if it can
    """

    name: str
    gear: str
    kind: str = ""
    channel: str = ""
    unit: str = "1"
    error: float = np.nan
    varies: float = np.nan
    plain: float = np.nan
    allowed: float = np.nan
    samples: int = 0
    changes: tuple[Change, ...] = ()
    error_with_changes: float = np.nan
    lines: tuple[Line, ...] = ()
    curves: Recording | None = None
    checks: tuple[Check, ...] = ()
    remarks: tuple[str, ...] = ()
    refused: str = ""

    @property
    def relative(self) -> float:
        """The error over that of a model that predicts nothing [1]."""
        return self.error / self.varies if self.varies > 0.0 else np.inf

    @property
    def contradicts(self) -> bool:
        """True if the error is larger than the saved gear allows."""
        return any(check.failed for check in self.checks)

    @property
    def changed(self) -> tuple[Change, ...]:
        """The significant changes."""
        return tuple(each for each in self.changes if each.significant)

    @property
    def common_scale(self) -> tuple[float, float] | None:
        """The scale and its standard deviation of all torques together, if friction and load changed by one factor; else None.

        Then the torque constant or the range of a sensor is another one, and not the joint.
        """
        scales = {each.name: each for each in self.changes if each.unit == "1"}
        if GRAVITY in scales:
            scales.pop(INERTIA, None)  # beside it turns that of the rotor, which no torque constant scales
        significant = {name for name, each in scales.items() if each.significant}
        if not (significant & {DRY, FRICTION} and significant & {INERTIA, GRAVITY}):
            return None
        weights = np.array([each.sigma**-2 for each in scales.values()])
        scale = float(np.average([each.value for each in scales.values()], weights=weights))
        sigma = float(weights.sum() ** -0.5)
        alike = all(abs(each.value - scale) < SIGNIFICANCE_SIGMA * each.sigma + MAX_APART for each in scales.values())
        return (scale, sigma) if alike else None


def validations(gear_set: GearSet, channel: str) -> list[Validation]:
    """Return the errors that a saved gear has on its own files, of one channel."""
    return [each for each in gear_set.validation if each.channel == channel]


def model_error(gear_set: GearSet, channel: str) -> float:
    """Return the largest error that a saved gear has on its own files, of one channel; 0 if it contains none."""
    return max((max(each.error, each.held_out) for each in validations(gear_set, channel)), default=0.0)


def judged(prediction: Prediction, gear_set: GearSet, variance: float) -> Prediction:
    """Return the same with the error that a saved gear allows, and the check of it.

    Args:
        prediction: with its error
        gear_set: the saved one
        variance: mean variance of what it predicts by the covariance of its numbers, in the unit of the channel squared
    """
    own = validations(gear_set, prediction.channel)
    shares = [each.relative for each in own or gear_set.validation]
    if shares:
        base = max(max(shares) * prediction.varies, model_error(gear_set, prediction.channel))
        allowed = MAX_ERROR_FACTOR * float(np.hypot(base, np.sqrt(variance)))
    else:
        allowed = MAX_UNEXPLAINED * prediction.varies
    channel, unit = prediction.channel.replace("_", " "), prediction.unit
    check = Check(
        "error of the prediction", prediction.name, prediction.error, allowed, unit, prediction.error > allowed,
        f"{prediction.gear} leaves {prediction.error:.3g} {unit} of {channel}, and allows {allowed:.3g} {unit}",
        "see what changed; if nothing did, see whether this is the same joint, and columns, units and sides are as before",
    )  # fmt: skip
    return replace(prediction, allowed=allowed, checks=(*prediction.checks, check))


# ---- What changed ----------------------------------------------------------------------------------------------------


def friction_directions(gear: Any, at: Callable[[Any], Array]) -> Iterator[Direction]:
    """Yield how a channel changes with the scales of dry and of viscous friction.

    Args:
        gear: the saved one
        at: what a gear predicts, shape (n,)
    """
    whole = at(gear)
    total = whole - at(gear.replace(**dict.fromkeys(PLACES, FRICTIONLESS)))
    numbers = _viscous_numbers(gear)
    viscous = (
        2.0 * (whole - at(gear.replace({path: 0.5 * value for path, value in numbers.items()}))) if numbers else 0.0 * whole
    )
    yield Direction(DRY, "1", 1.0, total - viscous)
    yield Direction(VISCOUS, "1", 1.0, viscous)


def _viscous_numbers(gear: Any) -> dict[str, float]:
    """Return the numbers of a gear that its viscous friction grows with, by path."""
    names = ("viscous", "viscous_torque")
    found = {path: each.value for path, each in every(gear).items() if path.partition(".")[0] in PLACES}
    return {path: value for path, value in found.items() if path.rpartition(".")[2] in names and value != 0.0}


def changes_of(
    left: Array, directions: Sequence[Direction], by_numbers: Array, covariance: Array, coherent: float = 0.0
) -> tuple[tuple[Change, ...], Array]:
    """Return what a residual shows of parts of a gear, and the part of the residual that they explain, shape (n,).

    Least squares of the residual on all directions together. Their variance is the scatter of contiguous blocks, within which
    residuals correlate (Liang and Zeger 1986), that of the saved numbers, and that by an error of the laws, which another
    motion turns into other apparent changes: it is taken as coherent within each block. A scale that the residual does not
    determine is left out; dry and viscous friction that it does not separate are one.

    Args:
        left: measured less predicted, shape (n,)
        directions: of parts that may have changed
        by_numbers: derivatives of what is predicted by the saved numbers, shape (n, p)
        covariance: of these numbers, shape (p, p)
        coherent: root mean square error of the laws, in the unit of the residual
    """
    asked = [each for each in directions if np.linalg.norm(each.effect) > 0.0]
    while asked:
        columns = np.stack([each.effect for each in asked], axis=1)
        size = np.linalg.norm(columns, axis=0)
        inverse = np.linalg.pinv(columns / size) / size[:, np.newaxis]
        values = inverse @ left
        explained = columns @ values
        variance = _scatter(inverse, left - explained, len(asked)) + coherent**2 * _coherent(inverse)
        sigma = np.sqrt(variance + _by_saved(inverse @ by_numbers, covariance))
        unsure = [k for k, each in enumerate(asked) if each.unit == "1" and sigma[k] > MAX_SCALE_SIGMA]
        if not unsure:
            break
        asked = _without(asked, max(unsure, key=lambda k: float(sigma[k])))
    else:
        return (), np.zeros_like(left)
    shown = zip(asked, values.tolist(), sigma.tolist(), strict=True)
    changes = (
        Change(each.name, each.unchanged + value, s, each.unit, each.unchanged, each.smallest) for each, value, s in shown
    )
    return tuple(changes), explained


def _without(asked: Sequence[Direction], worst: int) -> list[Direction]:
    """Return the directions without one; dry and viscous friction become one first."""
    names = {each.name: each for each in asked}
    if asked[worst].name in (DRY, VISCOUS) and {DRY, VISCOUS} <= names.keys():
        both = Direction(FRICTION, "1", 1.0, names[DRY].effect + names[VISCOUS].effect)
        return [both, *(each for each in asked if each.name not in (DRY, VISCOUS))]
    return [each for k, each in enumerate(asked) if k != worst]


def _blocks(values: Array) -> Array:
    """Return the sums over contiguous blocks, shape (k, n) becomes (blocks, k)."""
    blocks = min(BLOCKS, max(values.shape[1] // 2, 1))
    return np.array([part.sum(axis=1) for part in np.array_split(values, blocks, axis=1)])


def _scatter(inverse: Array, left: Array, unknowns: int) -> Array:
    """Return the variances of estimates by the scatter of blocks, shape (k,)."""
    sums = _blocks(inverse * left)
    return np.asarray((sums**2).sum(axis=0) * len(sums) / max(len(sums) - unknowns, 1))


def _coherent(inverse: Array) -> Array:
    """Return the variances of estimates by an error of size 1 that is coherent within each block, shape (k,)."""
    return np.asarray((_blocks(np.abs(inverse)) ** 2).sum(axis=0))


def _by_saved(slopes: Array, covariance: Array) -> Array:
    """Return the variances of estimates by those of saved numbers, shape (k,)."""
    return np.asarray(np.einsum("kp,pq,kq->k", slopes, covariance, slopes))


def slopes_by_numbers(
    gear_set: GearSet, model: Any, at: Callable[[Any], Array], beginnings: str | tuple[str, ...]
) -> tuple[Array, Array]:
    """Return the derivatives of a channel by saved numbers, shape (n, p), and the covariance of these, shape (p, p).

    Args:
        gear_set: the saved one
        model: its gear or drive, at which they are taken
        at: what such a model predicts, shape (n,)
        beginnings: of the paths of numbers that the channel depends on
    """
    here, known = at(model), gear_set.covariance
    own = None if known is None else known.among([path for path in known.paths if path.startswith(beginnings)])
    if own is None:
        return np.zeros((len(here), 0)), np.zeros((0, 0))
    steps = DIFFERENCE * np.sqrt(np.diag(own.array))
    prefix = "" if isinstance(model, Drive) else "gear."
    slopes = [_slope(model, path.removeprefix(prefix), step, here, at) for path, step in zip(own.paths, steps, strict=True)]
    return np.stack(slopes, axis=1), own.array


def _slope(model: Any, path: str, step: float, here: Array, at: Callable[[Any], Array]) -> Array:
    """Return the derivative of a channel by one number, shape (n,); 0 by one that the model lacks."""
    if path not in (numbers := every(model)):
        return np.zeros_like(here)
    number = numbers[path]
    move = step if number.value + step < number.high else -step
    return np.asarray((at(model.replace({path: number.value + move})) - here) / move)
