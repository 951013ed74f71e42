"""A recording compared with the prediction of a saved gear: the error, the error allowed, and the changes."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal

import numpy as np

from strainwave import typeset
from strainwave.equality import ComparedByFields
from strainwave.files.gear_set import GearSet
from strainwave.files.identified_tables import Validation
from strainwave.files.recording import Recording
from strainwave.identification.results.changes import DRY, FRICTION, GRAVITY, INERTIA, PartChange
from strainwave.identification.results.check import Check
from strainwave.identification.results.file_result import Picture
from strainwave.identification.results.held_out import MAX_UNEXPLAINED
from strainwave.orders.lines import SpectrumLine
from strainwave.presentation import Pictured, Row
from strainwave.statistics.scale import SIGNIFICANCE_SIGMA

if TYPE_CHECKING:
    from matplotlib.figure import Figure

MAX_APART = 0.05  # between scales that are one: a loss under load is friction, and grows with the load
MAX_ERROR_FACTOR = 2.0  # of the error that a gear has on its own files: one half of a record predicts the other within 1.7
MAX_SHARE_LEFT = 0.5  # of the error and of that of the mean, that is left with changes that are the cause

Verdict = Literal["agrees", "differs", "contradicts", "refused"]


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
        from strainwave.identification.results.picture_plot import pictures_figure

        if (picture := self.picture) is None:
            raise ValueError(f"{self.name} cannot be drawn: {self.refused}")
        return pictures_figure([picture], f"{self.name}, predicted by {self.gear}")

    @property
    def verdict(self) -> Verdict:
        """`refused` if it cannot be predicted, `contradicts` if the error exceeds the allowed one, `differs` if only a part
        changed significantly, else `agrees`."""
        if self.refused:
            return "refused"
        return "contradicts" if self.contradicts else "differs" if self.changed else "agrees"

    @property
    def contradicts(self) -> bool:
        """True if the error is larger than the saved gear allows."""
        return any(check.failed for check in self.checks)

    @property
    def explained(self) -> bool:
        """True if the changes are the cause: with them the error is allowed, or at most half of `error` and of `varies`."""
        return self.error_with_changes <= max(self.allowed, MAX_SHARE_LEFT * min(self.error, self.varies))

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
    channel, unit = prediction.channel.replace("_", " "), prediction.unit
    check = Check(
        "error of the prediction", prediction.name, prediction.error, allowed, unit, prediction.error > allowed,
        f"{prediction.gear} leaves {prediction.error:.3g} {unit} of {channel}, and allows {allowed:.3g} {unit}",
        "see what changed; if nothing did, see whether this is the same joint, and columns, units and sides are as before",
    )  # fmt: skip
    return replace(prediction, allowed=allowed, checks=(*prediction.checks, check))
