"""The common base of the kinds of measurement, remarks that they share, and the ranking of all models of a file."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from typing import ClassVar, Literal

import numpy as np

from strainwave.files.gear_set import GearSet
from strainwave.files.ratings import check_ratings
from strainwave.files.recording import Recording
from strainwave.identification.kinds import KINDS, kind_named
from strainwave.identification.reading.mapping import FileMapping
from strainwave.identification.reading.recognise import Recognised
from strainwave.identification.reading.roles import Column, ColumnRoles
from strainwave.identification.results.file_result import FileResult
from strainwave.identification.results.gear_so_far import GearSoFar
from strainwave.identification.results.prediction import Prediction
from strainwave.progress import Progress, in_turn

NOT_PREDICTED = "only logs and tables of friction are predicted"


@dataclass(frozen=True)
class Ranked:
    """A model of a file, and how well it predicts.

    Attributes:
        name: of the model
        parameters: number of fitted parameters of the gear and its drive
        error: rms error on data held out, in `unit`
        standard_error: of that error; not a number if it was not computed
        unit: of both
        correlation: correlation length of the residuals in samples [1]: 1 for white noise, which leaves nothing to explain
        cost: time of the model per sample [µs]; not a number if it was not measured
    """

    name: str
    parameters: int
    error: float
    standard_error: float
    unit: str
    correlation: float
    cost: float = np.nan


@dataclass(frozen=True)
class Kind(ABC):
    """A kind of measurement: the columns of its files, and how one is fitted, ranked and drawn.

    A new kind is a class in a file of this package, and a line of `KINDS`. How a file is drawn stands in the pictures that its
    `fit` returns.

    Attributes:
        name: as `KINDS` has it
        needs: columns by which it is recognised, in words; empty if these are not as simple
        time: whether its files need a time, or use one if they have it
        section: heading of the section of the report that lists files of this kind together; empty if each stands by itself
    """

    name: str
    needs: ClassVar[str] = ""
    time: ClassVar[Literal["needed", "used", "none"]] = "none"
    section: ClassVar[str] = ""

    @property
    def title(self) -> str:
        """Title of a file of this kind in reports."""
        return KINDS[self.name].title

    def recognises(self, columns: Sequence[Column], mapping: FileMapping) -> bool:
        """True if columns are those of this kind; the kinds that `KINDS` has after it were asked before, and declined.

        Raises:
            QuestionError: they may be those of several kinds
        """
        return False

    @abstractmethod
    def roles(self, columns: Sequence[Column], mapping: FileMapping) -> ColumnRoles:
        """Return the channel of each column.

        Raises:
            QuestionError: the columns are not those of this kind; states which are needed
        """

    def takes(self, file: Recognised, known: GearSoFar, files: Sequence[Recognised]) -> bool:
        """True if a file, one of several, is fitted as this kind, whatever its columns were recognised as."""
        return file.kind == self.name

    def turn(self, file: Recognised, kinds: Collection[str]) -> tuple[str, int]:
        """Return the kind in whose turn a file is fitted, and its place there; `kinds` are those of all files."""
        return self.name, 0

    @abstractmethod
    def fit(self, file: Recognised, known: GearSoFar) -> tuple[FileResult, GearSoFar]:
        """Return the result of a file, and the gear with it.

        Raises:
            ValueError: nothing can be determined; states why
        """

    def fit_together(self, files: Sequence[Recognised], known: GearSoFar) -> tuple[tuple[FileResult, ...], GearSoFar]:
        """Return what all files of this kind determine together, and the gear with it; called in the turn of the kind."""
        return (), known

    def fit_last(self, files: Sequence[Recognised], known: GearSoFar) -> tuple[tuple[FileResult, ...], GearSoFar]:
        """Return the same of what rests on the fits of all other files."""
        return (), known

    def rank(self, file: Recognised, known: GearSoFar) -> tuple[Ranked, ...]:
        """Return all models of a file, the one to take first.

        Raises:
            ValueError: this kind has no models to rank, or the file cannot be fitted
        """
        ranked = "tables of friction, torsion loops, presliding loops and logs have models to rank"
        raise ValueError(f"only {ranked}; strainwave orders finds orders")

    def predict(self, file: Recognised, gear_set: GearSet) -> Prediction:
        """Return a file compared with what a saved gear or drive predicts.

        Raises:
            ValueError: files of this kind are not predicted, or the saved gear lacks what a prediction needs
        """
        raise ValueError(f"it is {self.title}: {NOT_PREDICTED}")


# ---- Remarks ---------------------------------------------------------------------------------------------------------


def exceeded(start: GearSet, load: Recording) -> Iterator[str]:
    """Yield the ratings of a gear that a measurement exceeded."""
    yield from (f"beyond what the maker allows: {check}" for check in check_ratings(start, load) if check.exceeded)


def thinned(samples: int, taken: int) -> Iterator[str]:
    """Yield how many samples were compared, if these are not all."""
    if samples > taken:
        yield f"of its {samples} samples {taken} were compared"


def unused(recording: Recording, used: Sequence[str]) -> Iterator[str]:
    """Yield the columns that the fit does not use."""
    if names := [name for name in recording.names if name not in used]:
        yield f"not used: {', '.join(names)}"


# ---- Ranking ---------------------------------------------------------------------------------------------------------


def rank(start: GearSet, file: Recognised, progress: Progress = None) -> tuple[Ranked, ...]:
    """Return all models of a file, the one to take first: the simplest whose error is larger by no more than chance may make.

    Args:
        start: the set to start from
        file: a table of friction, a torsion loop, a presliding loop, or a log
        progress: as of `sw.simulate`

    Raises:
        ValueError: the file is none of these, or cannot be fitted
    """
    with in_turn(progress) as turn:
        turn(f"models of {file.path.name}")
        return kind_named(file.kind).rank(file.at_ratio(start.gear.kinematics.ratio), GearSoFar(start))


def table_of(ranked: Sequence[Ranked]) -> list[str]:
    """Return the lines of a table to print."""
    width = max(len(each.name) for each in ranked)
    unit = ranked[0].unit
    head = f"{'model':{width}}  numbers  error held out [{unit}]  residuals together  cost [µs]"
    return [head, *(_line(each, width) for each in ranked)]


def _line(each: Ranked, width: int) -> str:
    error = f"{each.error:.4g}" + (f" ± {each.standard_error:.2g}" if np.isfinite(each.standard_error) else "")
    cost = f"{each.cost:.2g}" if np.isfinite(each.cost) else "-"
    return f"{each.name:{width}}  {each.parameters:7}  {error:>22}  {each.correlation:18.3g}  {cost:>9}"
