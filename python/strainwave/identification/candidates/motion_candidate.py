"""A model of a joint as a log determines it, and what it predicts of stretches that took no part."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive, _core
from strainwave.equality import ComparedByFields
from strainwave.identification.candidates.leave_out import SHAPES, without_rows
from strainwave.identification.candidates.motion_model import MotionModel, bristled
from strainwave.identification.candidates.plain import MAX_RELATIVE_ERROR
from strainwave.identification.candidates.ripple import by_full_band
from strainwave.identification.experiments.motion_log import MotionLog
from strainwave.identification.fitting.fit import Fit, fit, problem_of
from strainwave.identification.fitting.problem import Problem
from strainwave.identification.fitting.unknowns import plan
from strainwave.parameters import plain
from strainwave.statistics.scale import MIN_GAIN_SIGMA, sigmas_of_gain, without_single_events

Array = NDArray[np.float64]
Rows = NDArray[np.bool_]

MAX_ERROR = 0.995  # of the held-out error of the simpler model: what leaves more is not worth a part more
GAIN_BLOCKS = 10  # of each stretch, over which the gain of a model scatters
MAX_RELATIVE_COST = 1e-3  # change of the cost by a step, at which a fit ends while models are compared
MAX_STEPS = 8  # of a fit while models are compared


@dataclass(frozen=True, eq=False)
class Fold(ComparedByFields):
    """A model by what the motion outside a stretch determines.

    Attributes:
        stretch: samples of the grid that took no part, shape (m,)
        drive: with the numbers determined
        nuisances: likewise
        in_band: residuals of the samples of the stretch that are compared in the pass band
        residual: at every sample of the grid, in the full band, shape (m,)
    """

    stretch: Rows
    drive: Drive
    nuisances: Array
    in_band: Array
    residual: Array


@dataclass(frozen=True, eq=False)
class MotionCandidate(ComparedByFields):
    """A model of a joint as a log determines it, and what it predicts.

    Attributes:
        model: near its least squares, from where a fit starts
        priors: what is known of its numbers before
        unexplained: root mean square of what is left in the band over that of the effort about its mean [1]
        folds: the model without each stretch
        bend: angle of the input in which bristles bend at reversals [rad]; 0 for none
    """

    model: MotionModel
    priors: Mapping[str, tuple[float, float]]
    unexplained: float
    folds: tuple[Fold, ...]
    bend: float = 0.0

    @property
    def name(self) -> str:
        return self.model.name + ", bristles that bend at reversals" * (self.bend > 0.0)

    @property
    def log(self) -> MotionLog:
        """The log as it was compared."""
        return self.model.log

    @property
    def values(self) -> tuple[float, ...]:
        """The numbers that are free, near their least squares."""
        numbers = {path: value for path, value, *_ in _core.parameters(self.model.drive)}
        return tuple(numbers[path] for path in self.model.free)

    @cached_property
    def fit(self) -> Fit:
        """The fit to the whole log, with the covariance of its estimates."""
        return self.fitted_to(None)

    def fitted_to(self, training: Rows | None) -> Fit:
        """Return the fit to some of the samples compared, shape (n,), or to all."""
        model = self.model
        return fit(model.drive, model.log, model.free, ties=model.ties, priors=self.priors, training=training)

    def predicting(self, drive: Drive) -> Drive:
        """Return the drive that predicts at reversals, too: a fitted one, with bristles that bend."""
        return bristled(drive, self.bend) if self.bend else drive

    def left(self, drive: Drive, nuisances: Array) -> Array:
        """Return measured less predicted effort at every sample, shape (m,)."""
        return self.log.residual(self.predicting(drive), nuisances)

    def predicted_anew(self) -> MotionCandidate:
        """Return the same, with the residuals of what it predicts."""
        return replace(self, folds=tuple(replace(each, residual=self.left(each.drive, each.nuisances)) for each in self.folds))

    @cached_property
    def residuals(self) -> list[Array]:
        """Residuals of each stretch held out, in the full band and the unit of the effort."""
        return [each.residual[each.stretch] for each in self.folds]

    @cached_property
    def errors(self) -> Array:
        """Root mean square of the residuals of each stretch, shape (stretches,)."""
        return np.array([float(np.sqrt(np.mean(each**2))) for each in self.residuals])

    @cached_property
    def error(self) -> float:
        """Root mean square of the residuals of all stretches."""
        return float(np.sqrt(np.mean(np.concatenate(self.residuals) ** 2)))

    @cached_property
    def error_in_band(self) -> float:
        """Root mean square of the residuals of all stretches in the pass band."""
        return float(np.sqrt(np.mean(np.concatenate([each.in_band for each in self.folds]) ** 2)))

    def predicts_no_worse_than(self, other: MotionCandidate) -> bool:
        """True if its errors on all stretches and on the last one are no larger, but for chance."""
        return MAX_ERROR * self.error < other.error and MAX_ERROR * self.errors[-1] < other.errors[-1]

    def explains_more_than(self, other: MotionCandidate) -> bool:
        """True if it predicts sliding in the pass band clearly better, and the full band and the last stretch no worse."""
        no_worse = self.predicts_no_worse_than(other)
        return no_worse and self.error_in_band < MAX_RELATIVE_ERROR * other.error_in_band

    def is_better_than(self, other: MotionCandidate) -> bool:
        """True if it predicts better by more than chance makes, all over the motion, and the last stretch no worse."""
        is_sure = self.gain_over(other) > MIN_GAIN_SIGMA
        return is_sure and self.error < MAX_ERROR * other.error and MAX_ERROR * self.errors[-1] < other.errors[-1]

    def gain_over(self, other: MotionCandidate) -> float:
        """Return by how many standard deviations the squares of the residuals are smaller than those of another model."""
        stretches = [before**2 - after**2 for before, after in zip(other.residuals, self.residuals, strict=True)]
        gains = [block.sum() for stretch in stretches for block in np.array_split(stretch, GAIN_BLOCKS)]
        return sigmas_of_gain(without_single_events(np.array(gains)))

    def predicts_as_well_as(self, other: MotionCandidate) -> bool:
        """True if its error in the pass band is no larger, but for chance: what bends at reversals is compared nowhere else."""
        own, error = self.comparable_errors(other)
        return MAX_RELATIVE_ERROR * own < error

    def comparable_errors(self, other: MotionCandidate) -> tuple[float, float]:
        """Return its error and that of another model in the pass band, or in the full band if their pass bands differ."""
        is_one_band = self.log.motion.cutoff == other.log.motion.cutoff
        return (self.error_in_band, other.error_in_band) if is_one_band else (self.error, other.error)

    def is_clearer_than(self, other: MotionCandidate) -> bool:
        """True if it explains more of its own, narrower band, and predicts no worse."""
        is_narrower = self.log.motion.cutoff < other.log.motion.cutoff
        return is_narrower and self.unexplained < other.unexplained and MAX_ERROR * self.error < other.error


def candidate_of(model: MotionModel, held_out: Sequence[Rows], priors: Mapping[str, tuple[float, float]]) -> MotionCandidate:
    """Fit a model as nearly as comparisons need, from where it starts."""
    before = {plain(path): prior for path, prior in priors.items()}
    (by_all,) = by_full_band(model, [np.ones(len(model.log.motion.time), bool)])
    known = {**{path: before[plain(path)] for path in model.free if plain(path) in before}, **by_all}
    asked = plan(model.drive, [""], model.free, ties=model.ties, priors=known)
    problem = problem_of(asked, model.drive, [model.log], [None])
    x = problem.solve(problem.start(), problem.first_weights(), MAX_RELATIVE_COST, trials=MAX_STEPS)
    (record,) = problem.records
    ((predicted, _),) = problem.predict(x)
    ended = replace(model, drive=record.model(x), log=model.log.starting(x[record.nuisances].tolist()))
    unexplained = float(np.std(model.log.measured - predicted) / max(float(np.std(model.log.measured)), 1e-300))
    return MotionCandidate(ended, known, unexplained, tuple(_folds(problem, x, ended, held_out)))


def _folds(problem: Problem, x: Array, ended: MotionModel, held_out: Sequence[Rows]) -> Iterator[Fold]:
    """Yield the model without each stretch; shapes of friction stay as the fit to all has them."""
    (record,), log = problem.records, ended.log
    places = {each.path: place for place, each in enumerate(problem.plan.unknowns)}
    by_fold = by_full_band(ended, [~stretch for stretch in held_out])
    ((predicted, slopes),) = problem.predict(x)
    out = [stretch[log.motion.rows] for stretch in held_out]
    without = without_rows(problem, x, out, SHAPES)
    for stretch, rows, there, waves in zip(held_out, out, without, by_fold, strict=True):
        for path, (value, _) in waves.items():
            there[places[path]] = value
        model, nuisances = record.model(there), there[record.nuisances]
        in_band = (log.measured - predicted)[0, rows] - slopes[:, 0, rows].T @ (there - x)
        yield Fold(stretch, model, nuisances, in_band, log.residual(model, nuisances))


def nuisances_of(found: Fit) -> Array:
    """Return the unknowns of the measurement that a fit ended with, shape (nuisances,)."""
    count = len(found.experiment.nuisances)
    return np.array([each.value for each in found.estimates[len(found.estimates) - count :]])
