"""Result of one file: its estimates, its checks, and what is drawn of it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Literal

import numpy as np

from strainwave import typeset
from strainwave.equality import ComparedByFields
from strainwave.files.recording import Recording
from strainwave.identification.kinds import KINDS
from strainwave.identification.reading.recognise import Recognised
from strainwave.identification.results.check import Check
from strainwave.identification.results.held_out import HeldOut
from strainwave.presentation import Pictured, Presented, Row, counted
from strainwave.questions import QuestionError

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from strainwave.identification.fitting.fit import Fit

State = Literal["identified", "identified in combination", "not identified", "kept"]
Look = Literal["table", "loop", "series", "means", "turn"]
Subject = Literal["torque", "friction", "twist", "error", ""]
UNITS_OF_EFFORT = ("N.m", "A", "V")
MAX_RELATIVE_SIGMA = 0.5  # standard deviation over the value; an estimate with a larger one is not identified
IN_CURRENT = "in A"  # law of an estimate without the torque constant
ASSUMED_BY_RECORDER = "it is the stiffness that the recorder assumed, and was not measured"
BEHIND_GEAR = "the torque was measured behind the gear: it contains no friction of it"
TOO_UNCERTAIN = "standard deviation exceeds half the value"


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
        return f"{self.label} = {typeset.uncertain_quantity(self.value, self.sigma, self.unit)}, {self.state}"


@dataclass(frozen=True, eq=False)
class Picture(ComparedByFields):
    """Measured against modelled, to be drawn.

    Attributes:
        curves: the abscissa, the channel measured, and `modelled`, as the functions of `results.curves` return them
        look: style of the drawing
        label: of the channel in words; its name if not given
        title: of the picture, if a file has several
        model: in words, if it is not that of the file
        orders: of an error over a turn, each with its amplitude and the standard deviation of that
    """

    curves: Recording
    look: Look = "series"
    label: str = ""
    title: str = ""
    model: str = ""
    orders: tuple[tuple[float, float, float], ...] = ()

    @property
    def subject(self) -> Subject:
        """Pictures of the first screen: torque over time, friction over speed, twist over torque, error over a turn."""
        if self.look == "turn":
            return "error"
        if self.look == "loop":
            return "twist" if "twist" in self.curves else ""
        if self.look == "table":
            return "friction"
        return "torque" if self.look == "series" and self.curves.unit(self.curves.names[1]) in UNITS_OF_EFFORT else ""


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
        candidates: name of each model tried and its error on data held out, in the unit of the fit, best first
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
        from strainwave.identification.results.picture_plot import pictures_figure

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
