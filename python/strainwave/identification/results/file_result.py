"""Result of one file: its estimates, its checks, its error on held-out data, and what is drawn of it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Literal

import numpy as np

from strainwave.equality import ComparedByFields
from strainwave.identification.kinds import KINDS
from strainwave.identification.reading.recognise import Recognised
from strainwave.identification.results.pictures import Picture, pictures_figure
from strainwave.presentation import Pictured, Presented, Row, counted
from strainwave.questions import QuestionError
from strainwave.typeset import percent, quantity, uncertain_quantity

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from strainwave.identification.fitting.fit import Fit

State = Literal["identified", "identified in combination", "not identified", "kept"]
MAX_RELATIVE_SIGMA = 0.5  # standard deviation over the value; an estimate with a larger one is not identified
COULOMB_PATH, BREAKAWAY_PATH = "gear.friction_input.coulomb", "gear.friction_input.breakaway"
LOAD_INERTIA, GRAVITY_PATH, MOTOR_INERTIA = "load.inertia", "load.gravity_torque", "motor.inertia"
IN_CURRENT = "in A"  # law of an estimate without the torque constant
ASSUMED_BY_RECORDER = "it is the stiffness that the recorder assumed, and was not measured"
BEHIND_GEAR = "the torque was measured behind the gear: it contains no friction of it"
TOO_UNCERTAIN = "standard deviation exceeds half the value"
WAVE_UNDETERMINED = "the size of its wave is not determined"
MAX_UNEXPLAINED = 0.5  # of the signal on held-out data: a model that leaves more explains nothing
MAX_SHARE_OF_PLAIN = 1.02  # of the error of plain least squares: a model that leaves more is no answer
MAX_SHARE_VIBRATING = 1.1  # likewise, if sliding in the pass band is predicted to MAX_IN_BAND: both leave vibrations
MAX_IN_BAND = 0.01  # of the signal in the pass band


@dataclass(frozen=True)
class Check(Presented):
    """A consistency check of a measurement, or of several together.

    Attributes:
        name: of the check, the same for every file, as `ratio of two encoders`
        source: the file, or the files, that it concerns
        value: the number that is checked
        limit: the threshold that it must not exceed
        unit: of both
        failed: True if the value exceeds the limit
        message: the numbers that disagree, and why they should not; one sentence
        remedy: what to check first, or the option that settles it
    """

    name: str
    source: str
    value: float
    limit: float
    unit: str
    failed: bool
    message: str = ""
    remedy: str = ""

    def _headline(self) -> str:
        return f"{self.name} of {self.source}: {quantity(self.value, self.unit)}, {self._verdict()}"

    def _verdict(self) -> str:
        return f"{'FAILED' if self.failed else 'passed'}, limit {quantity(self.limit, self.unit)}"


def error_in_words(error: float, unit: str, varies: float, plain: float = np.nan) -> str:
    """Return an RMS error in the unit of its signal, beside that of plain least squares, and its share of the signal.

    Args:
        error: root mean square of measured less predicted
        unit: of all
        varies: root mean square of the signal about its mean; not positive if it does not vary
        plain: what plain least squares leaves; not a number without

    >>> error_in_words(0.147, "A", 1.79, 0.185), error_in_words(8.3e-3, "N.m", 0.054)
    ('0.147 A (plain least squares 0.185 A), 8.2 % of the signal', '8.3 mN·m, 15 % of the signal')
    """
    beside = f" (plain least squares {quantity(plain, unit)})" if np.isfinite(plain) else ""
    return f"{quantity(error, unit)}{beside}{f', {percent(error / varies)} of the signal' if varies > 0.0 else ''}"


@dataclass(frozen=True)
class HeldOut(Presented):
    """The error of a model over a contiguous stretch that its numbers were not fitted to: every sample, in the full band.

    Models were chosen by such stretches, this one among them, so that a new record has a somewhat larger error.

    Attributes:
        stretch: the stretch, as `last 30 % of the motion`
        channel: that is predicted
        unit: of all errors
        error: root mean square of measured less predicted, at rest of what no friction that holds makes up for
        zero: error of the mean of the channel in the rest of the motion: of a model that predicts nothing
        plain: error of plain least squares there (offset, inertia, gravity, Coulomb and viscous friction); not a number without
        samples: compared
        in_band: the error over that of the mean in the pass band of the fit, where slow sliding alone is compared [1]
    """

    stretch: str
    channel: str
    unit: str
    error: float
    zero: float
    plain: float = np.nan
    samples: int = 0
    in_band: float = np.nan

    @property
    def words(self) -> str:
        """The error in words, as `error_in_words`."""
        return error_in_words(self.error, self.unit, self.zero, self.plain)

    @property
    def relative(self) -> float:
        """Error over that of a model that predicts nothing [1]."""
        return self.error / self.zero if self.zero > 0.0 else np.inf

    @property
    def share_of_plain(self) -> float:
        """Error over that of plain least squares [1]; not a number without."""
        return self.error / max(self.plain, 1e-300)

    @property
    def max_share_of_plain(self) -> float:
        """Limit of `share_of_plain` [1]."""
        return MAX_SHARE_VIBRATING if self.in_band < MAX_IN_BAND else MAX_SHARE_OF_PLAIN

    def _headline(self) -> str:
        plain = f", plain least squares {quantity(self.plain, self.unit)}" if np.isfinite(self.plain) else ""
        return f"error on held-out data {quantity(self.error, self.unit)}{plain}"

    def _rows(self) -> Iterator[Row]:
        yield Row("error on held-out data", self.error, self.unit, note=f"of {self.channel}, {self.stretch}")
        if np.isfinite(self.plain):
            yield Row("error of plain least squares", self.plain, self.unit)
        yield Row("error of the mean", self.zero, self.unit)
        yield Row("samples held out", self.samples)


def is_uncertain(value: float, sigma: float) -> bool:
    """True if the standard deviation of an estimate is too large for it to be identified."""
    return bool(sigma > MAX_RELATIVE_SIGMA * abs(value))


@dataclass(frozen=True)
class FileEstimate(Presented):
    """Estimate of a parameter by one file.

    Attributes:
        path: of the parameter in a gear set
        unit: its unit
        value: in SI units
        sigma: its standard deviation
        law: the law that it belongs to; parameters of different laws are not compared
        why: the reason why the file does not determine it; empty if it does
        common: the part of `sigma` that files share: of the torque constant, and of the inertia of the rotor
        in_combination: True if the file determines it only together with another parameter, see `why`
        shift_by_kept: relative change by one standard deviation of each kept parameter that matters, by its path [1]
    """

    path: str
    unit: str
    value: float
    sigma: float
    law: str
    why: str = ""
    common: float = 0.0
    in_combination: bool = False
    shift_by_kept: Mapping[str, float] = field(default_factory=dict, hash=False)

    @property
    def state(self) -> State:
        """State of the parameter by this file."""
        return "identified" if not self.why else "identified in combination" if self.in_combination else "not identified"

    @property
    def own(self) -> float:
        """Part of the standard deviation that no other file shares."""
        return float(np.sqrt(max(self.sigma**2 - self.common**2, 0.0)))

    def resting_on(self, relative: float, offset: float = 0.0) -> FileEstimate:
        """Return the same with the uncertainty of the torque constant, if it grows with that.

        Args:
            relative: standard deviation of the torque constant over its value [1]
            offset: part of the number that does not grow with the constant, as the inertia of the motor, or the voltage that a
                motor induces
        """
        return self.sharing(relative * (abs(self.value) + offset)) if self.is_of_torque else self

    def sharing(self, common: float) -> FileEstimate:
        """Return the same with more of its standard deviation in common with other files."""
        return replace(self, sigma=float(np.hypot(self.sigma, common)), common=float(np.hypot(self.common, common)))

    def unless_uncertain(self) -> FileEstimate:
        """Return the same, not identified if its standard deviation is too large."""
        return replace(self, why=self.why or (TOO_UNCERTAIN if is_uncertain(self.value, self.sigma) else ""))

    def in_current(self) -> FileEstimate:
        """Return the same estimate in A, for a torque constant that is not known."""
        if not self.is_of_torque:
            return self
        return replace(self, unit=self.unit.replace("N.m", "A").replace("kg.m2", "A.s2/rad"), law=IN_CURRENT)

    @property
    def label(self) -> str:
        """Path, with the law or speed that distinguishes it from others of that path."""
        return f"{self.path} ({self.law})" if self.law.startswith(("in ", "of ", "at ")) else self.path

    @property
    def is_of_torque(self) -> bool:
        """True if it grows in proportion to all torques."""
        return self.unit.startswith(("N.m", "kg.m2"))

    @property
    def is_phase(self) -> bool:
        """True for an angle that begins anew with each turn, so that its size means nothing."""
        return "phase" in self.path.rpartition(".")[2]

    def _headline(self) -> str:
        return f"{self.label} = {uncertain_quantity(self.value, self.sigma, self.unit)}, {self.state}"


def with_waves(estimates: Sequence[FileEstimate]) -> tuple[FileEstimate, ...]:
    """Return the estimates, with a phase not identified if the size of its wave is not."""
    open_ones = {each.path for each in estimates if each.state == "not identified"}
    return tuple(
        replace(each, why=WAVE_UNDETERMINED)
        if each.is_phase and each.state == "identified" and open_ones & _sizes_of_wave(each.path)
        else each
        for each in estimates
    )


def _sizes_of_wave(phase: str) -> set[str]:
    """Return the paths that the size of the wave of a phase may have."""
    part, _, name = phase.rpartition(".")
    return {f"{part}.{name.replace('phase', size)}" for size in ("amplitude", "torque")}


@dataclass(frozen=True, eq=False)
class FileResult(ComparedByFields, Pictured):
    """Result of one file.

    Attributes:
        name: of the file
        recognised: its kind and channels, with the reasons; None if it could not be read
        model: the model chosen, in words
        estimates: of its parameters
        remarks: assumptions and limits, in short sentences
        checks: consistency checks of the file
        refused: why the file cannot be used; empty if it can
        question: that the file leaves open, if that is why it cannot be used
        same_as: the file that contains the same measurement; empty if none does
        what: the file in words, if not the title of its kind
        part_of: the table that it is a point of, together with others; empty if it stands by itself
        pictures: measured against modelled
        held_out: error on data that took no part in the fit; None if nothing was held out
        candidates: name of each model tried and its error on held-out data, in the unit of the fit, best first
        fit: the fit of the model, with the covariance of its estimates; None if nothing was fitted
        bend: angle of the input in which bristles of its friction bend at reversals [rad]; 0 if it does not show them
        between: the fit of the gear between both encoders; None without one
        unchecked: numbers of the drive with which its estimates scale, and that nothing in it checks: their values, by name
    """

    name: str
    recognised: Recognised | None = None
    model: str = ""
    estimates: tuple[FileEstimate, ...] = ()
    remarks: tuple[str, ...] = ()
    checks: tuple[Check, ...] = ()
    refused: str = ""
    question: QuestionError | None = None
    same_as: str = ""
    what: str = ""
    part_of: str = ""
    pictures: tuple[Picture, ...] = ()
    held_out: HeldOut | None = None
    candidates: tuple[tuple[str, float], ...] = ()
    fit: Fit | None = None
    bend: float = 0.0
    between: Fit | None = None
    unchecked: Mapping[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        object.__setattr__(self, "estimates", with_waves(self.estimates))

    @property
    def fits(self) -> tuple[Fit, ...]:
        """All fits of the file."""
        return tuple(each for each in (self.fit, self.between) if each is not None)

    @property
    def title(self) -> str:
        """Kind of the file in words."""
        return self.what or ("not read" if self.recognised is None else KINDS[self.recognised.kind].title)

    @property
    def is_in_current(self) -> bool:
        """True if its torques are in A, as the torque constant is not known."""
        return any(each.law == IN_CURRENT for each in self.estimates)

    @property
    def friction(self) -> str:
        """Fitted laws of friction, which give its numbers their meaning."""
        if self.fit is None:
            return self.model
        return f"{self.fit.gear.friction_input.name}, {self.fit.gear.friction_mesh.name}"

    def plot(self) -> Figure:
        """Return a figure of the file: measured and modelled, and the residual below, for each of its pictures.

        Samples that were held out are shaded. Dashed lines contain 95 % of the residuals; a band is the interval of 95 % of the
        model.

        Raises:
            ValueError: the file was refused, or is a point of a table of several files
        """
        if not self.pictures:
            raise ValueError(f"{self.name} has nothing to draw: {self.refused or f'a part of the {self.part_of}'}")
        return pictures_figure(self.pictures, f"Measured and modelled: {self.name}")

    @property
    def failed(self) -> tuple[Check, ...]:
        """Checks that failed."""
        return tuple(check for check in self.checks if check.failed)

    def _headline(self) -> str:
        return f"{self.name}: {self.in_words}"

    @property
    def in_words(self) -> str:
        """Kind of the file, its model, and the error of that or why the file was not used."""
        if self.refused:
            return f"{self.title}, NOT USED: {self.refused}"
        failed = f", {counted(len(self.failed), 'check')} FAILED" if self.failed else ""
        held_out = "" if self.held_out is None else f", {self.held_out._headline()}"
        return f"{self.title}, {self.model}{held_out}{failed}"

    def _rows(self) -> Iterator[Row]:
        yield Row("file", self.name)
        for each in self.estimates:
            yield Row(each.label, each.value, each.unit, each.sigma, each.why)
        if self.held_out is not None:
            yield from self.held_out._rows()
        for check in self.checks:
            yield Row(check.name, check.value, check.unit, note=check._verdict())
