"""A recording compared with the prediction of a saved gear: the error, the error allowed, and the changes of its parts."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from math import isclose
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive, typeset
from strainwave.equality import ComparedByFields
from strainwave.files.gear_set import GearSet
from strainwave.files.identified_tables import Validation
from strainwave.files.recording import Recording
from strainwave.identification.experiments.friction_table import FRICTIONLESS
from strainwave.identification.results.file_result import MAX_UNEXPLAINED, Check
from strainwave.identification.results.pictures import Picture, pictures_figure
from strainwave.orders.lines import SpectrumLine
from strainwave.parameters import every
from strainwave.presentation import Pictured, Presented, Row
from strainwave.statistics.linear_fit import normal_inverse
from strainwave.statistics.scale import SIGNIFICANCE_SIGMA

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Array = NDArray[np.float64]

MAX_APART = 0.05  # between scales that are one: a loss under load is friction, and grows with the load
MAX_ERROR_FACTOR = 2.0  # of the error that a gear has on its own files: one half of a record predicts the other within 1.7
MAX_OFF_SAME = 1e-9  # relative difference of how much the channel of one recording varies, read twice: rounding
MAX_SHARE_LEFT_BY_CHANGES = 0.5  # of the error and of that of the mean, that is left with changes that are the cause

Verdict = Literal["agrees", "differs", "contradicts", "no evidence", "refused"]
MIN_CHANGE = 0.03  # of a scale [1], and of the zero over what the channel varies by: laws of friction are no better
MIN_CHANGE_TEXT = f"{100.0 * MIN_CHANGE:g} %"
MAX_SCALE_SIGMA = 0.5  # standard deviation of a scale [1]; a recording that determines it less well does not determine it
STEP_SIGMA = 0.1  # standard deviations of a number, between two predictions
SCATTER_BLOCKS = 20  # contiguous ones of a recording, over which residuals scatter
MIN_SLIDING_SAMPLES = 50  # of sliding, from which changes are determined
DRY, VISCOUS, FRICTION, ZERO, DELAY = "dry friction", "viscous friction", "friction", "zero", "delay"
INERTIA, GRAVITY, TEMPERATURE = "inertia of the load", "gravity of the load", "friction over temperature"
ZERO_OF_ANGLE = "zero of the angle"
VISCOUS_NUMBERS = ("viscous", "viscous_torque")  # with which viscous friction grows
FRICTION_PARTS = ("friction_input", "friction_mesh", "friction_output")


@dataclass(frozen=True, eq=False)
class Prediction(ComparedByFields, Pictured):
    """A recording compared with the prediction of a saved gear or drive, every sample in the full band.

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
        changes: of parts of the gear, by the recording
        error_with_changes: the error that is left with them
        lines: of the spectrum of the residual, as orders of the input or frequencies, the strongest evidence first
        curves: the abscissa, the channel, `predicted` and `residual`; None if it could not be read
        checks: that of the error; failed if the recording contradicts the gear
        remarks: assumptions and limits, in short sentences
        refused: why the recording cannot be predicted; empty if it can
        same_as: the file of the saved gear that contains the same recording; empty if none does, or if the gear names no files

    >>> import numpy as np
    >>> import strainwave as sw
    >>> gear = sw.Gear(friction_input=sw.friction.Coulomb(coulomb=0.05, viscous=3e-4))
    >>> speed = np.array([2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0])
    >>> torque = 1.2 * gear.friction_input.steady(speed)  # 20 % more friction than saved
    >>> table = sw.Recording({"speed": speed, "torque": torque}, {"speed": "rad/s", "torque": "N.m"})
    >>> (found,) = sw.predict(gear, {"friction": table})
    >>> round(found.error, 4), round(found.allowed, 4), found.unit, found.contradicts
    (0.0139, 0.0121, 'N.m', True)
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
    changes: tuple[PartChange, ...] = ()
    error_with_changes: float = np.nan
    lines: tuple[SpectrumLine, ...] = ()
    curves: Recording | None = None
    checks: tuple[Check, ...] = ()
    remarks: tuple[str, ...] = ()
    refused: str = ""
    same_as: str = ""

    @property
    def relative(self) -> float:
        """Error over that of a model that predicts nothing [1]."""
        return self.error / self.varies if self.varies > 0.0 else np.inf

    @property
    def picture(self) -> Picture | None:
        """Measured against predicted, to be drawn; None if the recording could not be read."""
        if self.curves is None:
            return None
        over, channel = self.curves.names[:2]
        columns = {over: self.curves[over], channel: self.curves[channel], "modelled": self.curves["predicted"]}
        units = {over: self.curves.unit(over), channel: self.unit, "modelled": self.unit}
        return Picture(Recording(columns, units), "table" if over == "speed" else "series")

    def plot(self) -> Figure:
        """Return a figure of the recording: measured and predicted by the saved gear, and the residual below.

        Raises:
            ValueError: the recording cannot be predicted
        """
        if (picture := self.picture) is None:
            raise ValueError(f"{self.name} cannot be drawn: {self.refused}")
        return pictures_figure([picture], f"{self.name}, predicted by {self.gear}")

    @property
    def verdict(self) -> Verdict:
        """`refused` if it cannot be predicted, `contradicts` if the error exceeds the allowed one, `no evidence` if the gear is
        identified from this recording, `differs` if only a part changed significantly, else `agrees`."""
        if self.refused:
            return "refused"
        if self.same_as and not self.contradicts:
            return "no evidence"
        return "contradicts" if self.contradicts else "differs" if self.changed else "agrees"

    @property
    def contradicts(self) -> bool:
        """True if the error is larger than the saved gear allows."""
        return any(check.failed for check in self.checks)

    @property
    def explained(self) -> bool:
        """True if the changes are the cause: with them the error is allowed, or at most half of `error` and of `varies`."""
        return self.error_with_changes <= max(self.allowed, MAX_SHARE_LEFT_BY_CHANGES * min(self.error, self.varies))

    @property
    def changed(self) -> tuple[PartChange, ...]:
        """Significant changes; none if they do not explain the error."""
        return tuple(each for each in self.changes if each.significant and self.explained)

    @property
    def common_scale(self) -> tuple[float, float] | None:
        """Scale of all torques and its standard deviation, if friction and load changed by one factor; else None.

        Then the torque constant or the range of a sensor is another one, and not the joint.
        """
        scales = {each.name: each for each in self.changes if each.unit == "1"}
        if GRAVITY in scales:
            scales.pop(INERTIA, None)  # it contains that of the rotor, which no torque constant scales
        significant = {each.name for each in self.changed} & scales.keys()
        if not (significant & {DRY, FRICTION} and significant & {INERTIA, GRAVITY}):
            return None
        weights = np.array([each.sigma**-2 for each in scales.values()])
        scale = float(np.average([each.value for each in scales.values()], weights=weights))
        sigma = float(weights.sum() ** -0.5)
        alike = all(abs(each.value - scale) < SIGNIFICANCE_SIGMA * each.sigma + MAX_APART for each in scales.values())
        return (scale, sigma) if alike and scale > SIGNIFICANCE_SIGMA * sigma else None

    def _headline(self) -> str:
        if self.refused:
            return f"{self.name} by {self.gear}: refused, {self.refused}"
        error, allowed = (typeset.quantity(each, self.unit) for each in (self.error, self.allowed))
        return f"{self.name} by {self.gear}: {self.verdict}, error {error}, allowed {allowed}"

    def _rows(self) -> Iterator[Row]:
        if self.refused:
            return
        yield Row(f"error of {self.channel.replace('_', ' ')}", self.error, self.unit, note="rms")
        yield Row("error allowed", self.allowed, self.unit)
        if np.isfinite(self.plain):
            yield Row("error of plain least squares", self.plain, self.unit, note="fitted to this recording itself")
        yield Row("error of the mean", self.varies, self.unit)
        yield Row("samples", self.samples)
        for each in self.changes:
            verdict = "changed" if each.significant else "not significant"
            yield Row(each.name, each.value, each.unit, each.sigma, f"saved {typeset.number(each.unchanged)}, {verdict}")
        if self.changes:
            yield Row("error with these changes", self.error_with_changes, self.unit)


def validations(gear_set: GearSet, kind: str, channel: str) -> list[Validation]:
    """Return the errors that a saved gear has on its own files of one kind of measurement, of one channel."""
    return [each for each in gear_set.validation if (each.kind, each.channel) == (kind, channel)]


def model_error(gear_set: GearSet, kind: str, channel: str) -> float:
    """Return the largest of these errors; 0 if the gear contains none."""
    return max((max(each.error, each.held_out) for each in validations(gear_set, kind, channel)), default=0.0)


def judged(prediction: Prediction, gear_set: GearSet, variance: float) -> Prediction:
    """Return the same with the error that a saved gear allows, and the check of it.

    Args:
        prediction: with its error
        gear_set: the saved one
        variance: mean variance of the prediction by the covariance of its numbers, in the unit of the channel squared
    """
    own = validations(gear_set, prediction.kind, prediction.channel)
    alike = [each for each in gear_set.validation if each.kind == prediction.kind]  # of any channel
    shares = [each.relative for each in own or alike]
    if shares:
        base = max(max(shares) * prediction.varies, model_error(gear_set, prediction.kind, prediction.channel))
        allowed = MAX_ERROR_FACTOR * float(np.hypot(base, np.sqrt(variance)))
    else:
        allowed = MAX_UNEXPLAINED * prediction.varies
    same_as = next((each.file for each in own if isclose(each.varies, prediction.varies, rel_tol=MAX_OFF_SAME)), "")
    channel, unit = prediction.channel.replace("_", " "), prediction.unit
    check = Check(
        "error of the prediction", prediction.name, prediction.error, allowed, unit, prediction.error > allowed,
        f"{prediction.gear} leaves {prediction.error:.3g} {unit} of {channel}, and allows {allowed:.3g} {unit}",
        "see what changed; if nothing did, see whether this is the same joint, and columns, units and sides are as before",
    )  # fmt: skip
    return replace(prediction, allowed=allowed, checks=(*prediction.checks, check), same_as=same_as)


# ---- Changes of parts of the gear ------------------------------------------------------------------------------------


@dataclass(frozen=True)
class PartChange(Presented):
    """Change of a part of a saved gear or drive by a recording.

    Attributes:
        name: of the part: `dry friction`, `viscous friction`, `friction` if the recording does not separate both, `zero` of the
            channel, its `delay` behind the motion, `inertia of the load`, `gravity of the load`, `zero of the angle` at the
            output, `friction over temperature`
        value: its scale, 1 if it is as saved; of zero and delay its value; over temperature the relative change per kelvin; of
            the zero of the angle the angle in the saved position of the load, less that saved
        sigma: standard deviation of `value`, with that of the saved numbers
        unit: of both
        unchanged: `value` of the saved gear
        smallest: difference from it that matters; a smaller one is none, however small its standard deviation
        limit: `smallest` in words, as `3 % of what the current varies`

    >>> change = PartChange("dry friction", 1.3, 0.02, "1", unchanged=1.0, smallest=0.03)
    >>> round(change.significance, 9), change.significant
    (15.0, True)
    """

    name: str
    value: float
    sigma: float
    unit: str
    unchanged: float
    smallest: float = 0.0
    limit: str = ""

    @property
    def significance(self) -> float:
        """Difference from the saved gear in standard deviations [1]."""
        off = abs(self.value - self.unchanged)
        return off / self.sigma if self.sigma > 0.0 else (0.0 if off == 0.0 else np.inf)

    @property
    def significant(self) -> bool:
        """True if it differs from the saved gear by more than chance makes, and by `smallest` or more."""
        return self.significance > SIGNIFICANCE_SIGMA and not self.is_small

    @property
    def is_small(self) -> bool:
        """True if the difference from the saved gear is below `smallest`."""
        return abs(self.value - self.unchanged) < self.smallest

    def _headline(self) -> str:
        verdict = "changed" if self.significant else "no significant change"
        return (
            f"{self.name} {typeset.uncertain_quantity(self.value, self.sigma, self.unit)}, saved {self.unchanged:g}: {verdict}"
        )


@dataclass(frozen=True, eq=False)
class Direction(ComparedByFields):
    """Derivative of a channel by a part of a gear.

    Attributes:
        name, unit, unchanged, smallest, limit: as of a `PartChange`
        effect: derivative of the channel, shape (n,)
        max_sigma: standard deviation beyond which the recording does not determine the part
        here: value at which the channel is predicted; `unchanged` if not given
    """

    name: str
    unit: str
    unchanged: float
    effect: Array
    smallest: float = MIN_CHANGE
    limit: str = MIN_CHANGE_TEXT
    max_sigma: float = MAX_SCALE_SIGMA
    here: float | None = None

    @property
    def start(self) -> float:
        """Value at which the channel is predicted."""
        return self.unchanged if self.here is None else self.here

    def changed_by(self, more: float, sigma: float) -> PartChange:
        """Return the change of a part whose value differs from `start` by `more`."""
        return PartChange(self.name, self.start + more, sigma, self.unit, self.unchanged, self.smallest, self.limit)


def friction_directions(gear: Any, at: Callable[[Any], Array]) -> Iterator[Direction]:
    """Yield the derivatives of a channel by the scales of dry and of viscous friction.

    Args:
        gear: the saved one
        at: returns the prediction of a gear, shape (n,)
    """
    whole = at(gear)
    total = whole - at(gear.replace(**dict.fromkeys(FRICTION_PARTS, FRICTIONLESS)))
    numbers = {
        path: each.value for path, each in every(gear).items()
        if path.partition(".")[0] in FRICTION_PARTS and path.rpartition(".")[2] in VISCOUS_NUMBERS and each.value != 0.0
    }  # fmt: skip
    halved = at(gear.replace({path: 0.5 * value for path, value in numbers.items()})) if numbers else whole
    viscous = 2.0 * (whole - halved)
    yield Direction(DRY, "1", 1.0, total - viscous)
    yield Direction(VISCOUS, "1", 1.0, viscous)


def changes_of(
    left: Array, directions: Sequence[Direction], by_numbers: Array, covariance: Array, coherent: float = 0.0
) -> tuple[tuple[PartChange, ...], Array]:
    """Return changes of parts of a gear by a residual, and the part of the residual that they explain, shape (n,).

    Least squares of the residual on all directions together. Their variance is the scatter of contiguous blocks, within which
    residuals correlate (Liang and Zeger 1986), that of the saved numbers, and that by an error of the laws, which another
    motion turns into other apparent changes: it is taken as coherent within each block. A scale that the residual does not
    determine is left out, the least determined first; dry and viscous friction that it does not separate are one.

    Args:
        left: measured less predicted, shape (n,)
        directions: of parts that may have changed
        by_numbers: derivatives of the prediction by the saved numbers, shape (n, p)
        covariance: of these numbers, shape (p, p)
        coherent: root mean square error of the laws, in the unit of the residual
    """
    asked = [each for each in directions if np.linalg.norm(each.effect) > 0.0]
    while asked:
        columns = np.stack([each.effect for each in asked], axis=1)
        inverse = normal_inverse(columns) @ columns.T
        values = inverse @ left
        explained = columns @ values
        by_laws = coherent**2 * (_blocks(np.abs(inverse)) ** 2).sum(axis=0)
        slopes = inverse @ by_numbers
        by_saved = np.einsum("kp,pq,kq->k", slopes, covariance, slopes)
        sums = _blocks(inverse * (left - explained))
        by_scatter = (sums**2).sum(axis=0) * len(sums) / max(len(sums) - len(asked), 1)
        sigma = np.sqrt(by_scatter + by_laws + by_saved)
        excess = sigma / np.array([each.max_sigma for each in asked])
        if excess.max() <= 1.0:
            break
        asked = _without(asked, int(np.argmax(excess)))
    else:
        return (), np.zeros_like(left)
    shown = zip(asked, values.tolist(), sigma.tolist(), strict=True)
    return tuple(each.changed_by(value, s) for each, value, s in shown), explained


def _without(asked: Sequence[Direction], worst: int) -> list[Direction]:
    """Return the directions without one; dry and viscous friction become one first."""
    names = {each.name: each for each in asked}
    if asked[worst].name in (DRY, VISCOUS) and {DRY, VISCOUS} <= names.keys():
        both = Direction(FRICTION, "1", 1.0, names[DRY].effect + names[VISCOUS].effect)
        return [both, *(each for each in asked if each.name not in (DRY, VISCOUS))]
    return [each for k, each in enumerate(asked) if k != worst]


def _blocks(values: Array) -> Array:
    """Return the sums over contiguous blocks, shape (k, n) becomes (blocks, k)."""
    blocks = min(SCATTER_BLOCKS, max(values.shape[1] // 2, 1))
    return np.array([part.sum(axis=1) for part in np.array_split(values, blocks, axis=1)])


def slopes_by_numbers(
    gear_set: GearSet, model: Any, at: Callable[[Any], Array], beginnings: str | tuple[str, ...]
) -> tuple[Array, Array]:
    """Return the derivatives of a channel by saved numbers, shape (n, p), and the covariance of these, shape (p, p).

    Args:
        gear_set: the saved one
        model: its gear or drive, at which they are taken
        at: returns the prediction of such a model, shape (n,)
        beginnings: of the paths of numbers that the channel depends on
    """
    here, saved = at(model), gear_set.covariance
    own = None if saved is None else saved.among([path for path in saved.paths if path.startswith(beginnings)])
    if own is None:
        return np.zeros((len(here), 0)), np.zeros((0, 0))
    steps = STEP_SIGMA * np.sqrt(np.diag(own.array))
    prefix, numbers = "" if isinstance(model, Drive) else "gear.", every(model)
    slopes = np.zeros((len(here), len(steps)))  # of a number that the model lacks
    for place, (path, step) in enumerate(zip(own.paths, steps, strict=True)):
        if (number := numbers.get(path := path.removeprefix(prefix))) is not None:
            move = step if number.value + step < number.high else -step
            slopes[:, place] = (at(model.replace({path: number.value + move})) - here) / move
    return slopes, own.array
