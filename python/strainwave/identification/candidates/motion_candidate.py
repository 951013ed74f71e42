"""A model of a joint as a log determines it: what it predicts of stretches that took no part, and the spread of its numbers.

Least squares on a motion is nearly linear: one bounded step of Gauss and Newton from the fit to all samples gives what a fit
without some of them would.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive, _core
from strainwave.equality import ComparedByFields
from strainwave.files.recording import Recording
from strainwave.identification.candidates.motion_model import (
    INPUT,
    LOSSES,
    MotionModel,
    best_bend,
    bristled,
    by_full_band,
    slope_of,
)
from strainwave.identification.candidates.plain import (
    BLOCKS_PER_STRETCH,
    MAX_RELATIVE_ERROR,
    MIN_SLIDING_SPEED,
    held_out_residuals,
    moving,
    stretches,
)
from strainwave.identification.experiments.motion_log import FAST_QUANTILE, MIN_INERTIA_SHARE, MotionLog, inertia_of
from strainwave.identification.fitting.fit import ROUGH_TOLERANCE, Fit, fit, problem_of, solved_problem
from strainwave.identification.fitting.problem import Problem
from strainwave.identification.fitting.unknowns import plan
from strainwave.identification.results.file_result import HeldOut
from strainwave.identification.results.steady_friction import STEADY_FRICTION
from strainwave.parameters import plain
from strainwave.statistics.linear_fit import solved
from strainwave.statistics.residuals import rms
from strainwave.statistics.scale import MIN_GAIN_SIGMA, sigmas_of_gain, without_single_events

Array = NDArray[np.float64]
Rows = NDArray[np.bool_]

MAX_ERROR = 0.995  # of the held-out error of the simpler model: what leaves more is not worth a part more
MAX_STEPS_OF_COMPARED_FIT = 8  # of a fit while models are compared
GRAVITY_PATHS = ("load.gravity_torque", "load.gravity_phase")
SHAPE_NUMBERS = ("exponent", "stribeck_speed")  # numbers in which friction is not linear
JACKKNIFE_BLOCKS = 10  # of a log, each of which is left out once
MIN_COULOMB_DIFFERENCE = 0.1  # relative, from which another law of friction is named
OF_ALL_LAWS = (f"{INPUT}coulomb", f"{INPUT}viscous")  # numbers of friction that mean the same in each law
FAST_SHARE = 0.95  # of the rows: laws of friction are compared by their slope at the speed that they do not exceed
MAX_REFITS = 6  # further models that are fitted to all but the last stretch if the best one is not confirmed
MOTOR, LOAD = "motor.inertia", "load.inertia"
RELATIVE_ROTOR_STEP = 1e-3  # of all that turns, for a derivative
SHARE_OF_UNKNOWN_ROTOR = 3.0**-0.5  # rms share of the rotor in all that turns, if any share is as likely as another


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

    def with_bristles(self) -> MotionCandidate | None:
        """Return the same with bristles of the best bend, which moves no estimate; None if its law of friction has none."""
        last, drive = self.folds[-1], self.model.drive
        rows = moving(self.log) & ~last.stretch  # the last stretch takes no part
        bend = None if bristled(drive, 1.0) is drive else best_bend(self.log, last.drive, last.nuisances, rows)
        if bend is None:
            return None
        bent = replace(self, bend=bend)
        folds = (replace(each, residual=bent.left(each.drive, each.nuisances)) for each in self.folds)
        return replace(bent, folds=tuple(folds))

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
        gains = [block.sum() for stretch in stretches for block in np.array_split(stretch, BLOCKS_PER_STRETCH)]
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
    known_before = {**{path: before[plain(path)] for path in model.free if plain(path) in before}, **by_all}
    asked = plan(model.drive, [""], model.free, ties=model.ties, priors=known_before)
    problem = problem_of(asked, model.drive, [model.log], [None])
    x = problem.solve(problem.start(), problem.first_weights(), ROUGH_TOLERANCE, trials=MAX_STEPS_OF_COMPARED_FIT)
    (record,) = problem.records
    ((predicted, _),) = problem.predict(x)
    ended = replace(model, drive=record.model(x), log=model.log.starting(x[record.nuisances].tolist()))
    unexplained = float(np.std(model.log.measured - predicted) / max(float(np.std(model.log.measured)), 1e-300))
    return MotionCandidate(ended, known_before, unexplained, tuple(_folds(problem, x, ended, held_out)))


def _folds(problem: Problem, x: Array, ended: MotionModel, held_out: Sequence[Rows]) -> Iterator[Fold]:
    """Yield the model without each stretch; shapes of friction stay as the fit to all has them."""
    (record,), log = problem.records, ended.log
    places = {each.path: place for place, each in enumerate(problem.plan.unknowns)}
    by_fold = by_full_band(ended, [~stretch for stretch in held_out])
    ((predicted, slopes),) = problem.predict(x)
    out = [stretch[log.motion.rows] for stretch in held_out]
    without = without_rows(problem, x, out, SHAPE_NUMBERS)
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


# ---- Estimates without some of the samples ---------------------------------------------------------------------------


def without_rows(problem: Problem, x: Array, outs: Sequence[Rows], kept: Sequence[str]) -> Iterator[Array]:
    """Yield the unknowns without each of some parts of the samples: one step of Gauss and Newton from the fit to all.

    Numbers at a limit, and those of the names kept, stay as all samples have them.
    """
    (record,) = problem.records
    low, high = problem.limits().T
    moves = [
        each.path.rpartition(".")[2] not in kept and not each.at_limit(value)
        for each, value in zip(problem.plan.unknowns, x.tolist(), strict=False)
    ]
    linear = np.array(moves + [True] * len(record.experiment.nuisances))
    ((predicted, slopes),) = problem.predict(x)
    left, rows = (record.measured - predicted)[0], slopes[:, 0].T
    before, right = problem.prior_rows()
    noise = float(np.std(left))
    size = np.linalg.norm(rows, axis=0)
    size[size == 0.0] = 1.0
    paths = [each.path for each in problem.plan.unknowns]
    gravity = [paths.index(path) for path in GRAVITY_PATHS] if set(GRAVITY_PATHS) <= set(paths) else []
    low = np.where(np.isin(np.arange(len(x)), gravity), -np.inf, low)  # turned round rather than negative
    for out in outs:
        system = (np.concatenate([rows[~out], noise * before]) / size)[:, linear]
        there = x.copy()
        room = ((low - x) * size)[linear], ((high - x) * size)[linear]
        there[linear] += _bounded(system, np.concatenate([left[~out], noise * (right - before @ x)]), *room) / size[linear]
        if gravity:  # a linear step is exact in its sine and cosine
            (amplitude, phase), (step, turn) = x[gravity], there[gravity] - x[gravity]
            moved = complex(amplitude + step, amplitude * turn)
            there[gravity] = abs(moved), phase + np.angle(moved)
        yield there


def _bounded(system: Array, right: Array, low: Array, high: Array) -> Array:
    """Return the unknowns of least squares within limits, shape (unknowns,)."""
    from scipy.optimize import lsq_linear

    orthogonal, triangle = np.linalg.qr(system)
    found = lsq_linear(triangle, orthogonal.T @ right, (np.minimum(low, 0.0), np.maximum(high, 0.0)), method="bvls", tol=1e-8)
    return np.asarray(found.x)


# ---- Choice by the last stretch, and spread --------------------------------------------------------------------------


def confirmed(
    best: MotionCandidate, others: Sequence[MotionCandidate], drive: Drive
) -> tuple[MotionCandidate, HeldOut, Recording]:
    """Return the best model that predicts the last 30 % of the motion no worse than plain least squares and than the mean.

    Models were compared by one step of Gauss and Newton, which may hide numbers that the rest of the motion does not determine.

    Returns:
        the model, of all tried the one with the smallest error if none is as good; its error and the smallest one of plain
        least squares, with terms of other joints or without; and its prediction, as `refit`
    """
    logs, tried = {tuple(each.log.regressors): each.log for each in (best, *others)}.values(), []
    of_plain = [(log, held_out_residuals(log, drive, stretches(log))) for log in logs]
    counted = [left for log, left in of_plain if not (log.regressors and beats_by_chance(left, best.residuals))]
    plain = min((rms(left[-1]) for left in counted), default=np.nan)
    for each in (best, *sorted(others, key=lambda other: other.error)[:MAX_REFITS]):
        held_out, predicted = refit(each)
        held_out = replace(held_out, plain=plain)
        tried.append((each, held_out, predicted))
        if not held_out.share_of_plain > held_out.max_share_of_plain and held_out.relative < 1.0:
            return tried[-1]
    return min(tried, key=lambda refitted: refitted[1].error)


def beats_by_chance(left: Sequence[Array], of_model: Sequence[Array]) -> bool:
    """True if residuals are smaller than those of a model in the last stretch, but not in all together."""
    return rms(left[-1]) < rms(of_model[-1]) and rms(np.concatenate(left)) > rms(np.concatenate(of_model))


def refit(best: MotionCandidate) -> tuple[HeldOut, Recording]:
    """Return the error on the last 30 % of the motion of the model fitted to what comes before, and its prediction of all.

    Returns:
        the error; and time, effort, `modelled` and `held_out` (1 in the stretch), as
        they are drawn, from the first motion to the last
    """
    log, last = best.log, best.folds[-1].stretch
    (waves,) = by_full_band(best.model, [~last])
    best = replace(best, priors={**best.priors, **waves})
    refitted = best.fitted_to(~last[log.motion.rows])
    residual = best.left(refitted.model, nuisances_of(refitted))
    left, rows = residual[last], moving(log)
    before = float(np.mean(log.recorded[rows & ~last]))
    (part,) = refitted.parts
    spread = float(np.std(log.measured[0, ~part.training])) if not part.training.all() else 0.0
    in_band = float(part.rms(held_out=True)[0]) / spread if spread > 0.0 else np.nan
    held_out = HeldOut(
        "last 30 % of the motion", log.effort, log.units[0],
        float(np.sqrt(np.mean(left**2))), float(np.sqrt(np.mean((log.recorded[last] - before) ** 2))),
        samples=int(last.sum()), in_band=in_band,
    )  # fmt: skip
    columns = {
        "time": log.motion.time,
        log.effort: log.recorded,
        "modelled": log.recorded - residual,
        "held_out": last.astype(float),
    }
    units = {"time": "s", log.effort: log.units[0], "modelled": log.units[0], "held_out": "1"}
    return held_out, Recording({name: values[rows] for name, values in columns.items()}, units)


def spread_by_blocks(best: MotionCandidate) -> dict[str, float]:
    """Return the standard deviations of the numbers of a fit by how they move without each block of the motion, by path.

    The jackknife (Quenouille1956, Tukey1958) over contiguous blocks: it takes no model of the noise, and sees what differs from
    one part of a record to another. A law that has no number of its own for low speed need not hold there: how far numbers move
    without the slow samples is part of their spread. Numbers at a limit have none.
    """
    problem, x = solved_problem(best.fit)
    rows, speed = np.arange(len(best.log.motion.rows)), np.abs(best.log.motion.speed)
    blocks = [(rows >= each[0]) & (rows <= each[-1]) for each in np.array_split(rows, JACKKNIFE_BLOCKS)]
    slow = speed[best.log.motion.rows] < MIN_SLIDING_SPEED * np.quantile(speed, FAST_QUANTILE)
    if best.model.path_of("stribeck_speed") in best.model.free:
        slow[:] = False
    values = np.array([x, *without_rows(problem, x, [slow, *blocks], ())]).T
    numbers = {plain(each.path): own for each, own in zip(problem.plan.unknowns, values, strict=False)}
    if speed_of_all := best.model.one_speed:
        numbers[STEADY_FRICTION] = numbers[f"{INPUT}coulomb"] + speed_of_all * numbers.get(f"{INPUT}viscous", np.zeros(1))
    return {
        path: float(np.hypot(np.sqrt((JACKKNIFE_BLOCKS - 1) * np.var(own[2:])), own[1] - own[0]))
        for path, own in numbers.items()
    }


def spread_by_models(best: MotionCandidate, others: Sequence[MotionCandidate]) -> dict[str, float]:
    """Return how far numbers lie apart in models that predict as well, by path: the choice of a model is part of their spread.

    Of another law of friction that predicts the pass band better, its Coulomb torque and its slope at fast speeds are compared:
    its other numbers have another meaning, and a law that predicts worse has more freedom than the record needs.
    """
    values = _numbers(best)
    apart = dict.fromkeys(values, 0.0)
    for other in others:
        if not other.predicts_as_well_as(best):
            continue
        is_one_law = type(other.model.law) is type(best.model.law)
        own, error = other.comparable_errors(best)
        of_laws = OF_ALL_LAWS if own < error else ()
        for path, value in _numbers(other).items():
            if path in apart and (is_one_law or not path.startswith(INPUT) or path in of_laws):
                off = abs(value - values[path])
                turned = abs(np.remainder(off + np.pi, 2.0 * np.pi) - np.pi) if "phase" in path else off
                apart[path] = max(apart[path], float(turned))
    return apart


def _numbers(candidate: MotionCandidate) -> dict[str, float]:
    """Return the numbers that are free, and those of all laws of friction or that at the one speed of a record, by path."""
    model, law = candidate.model, candidate.model.law
    numbers = dict(zip(map(plain, model.free), candidate.values, strict=True))
    if model.one_speed:
        numbers[STEADY_FRICTION] = float(law.coulomb + model.one_speed * law.viscous)
        return numbers
    fast = float(np.quantile(np.abs(model.log.motion.speed[model.log.motion.rows]), FAST_SHARE))
    return {**numbers, OF_ALL_LAWS[0]: float(law.coulomb), OF_ALL_LAWS[1]: slope_of(law, fast)}


def other_laws(best: MotionCandidate, others: Sequence[MotionCandidate]) -> list[MotionCandidate]:
    """Return the models with another law of friction that predict as well with another Coulomb torque, the best of each law."""
    laws = {type(best.model.law): best}
    for other in sorted(others, key=lambda each: each.error):
        if other.predicts_as_well_as(best):
            laws.setdefault(type(other.model.law), other)
    coulomb = best.model.law.coulomb
    return [each for each in laws.values() if abs(each.model.law.coulomb - coulomb) > MIN_COULOMB_DIFFERENCE * coulomb]


# ---- Inertia of the rotor, which a fit takes as known ----------------------------------------------------------------


def inertia_at_input(best: MotionCandidate) -> float:
    """Return the inertia of the load at the input [kg.m2]; if that of the motor is not known, it includes it."""
    drive = best.fit.parts[0].model
    return float(inertia_of(drive) / drive.gear.kinematics.ratio**2)


def slopes_by_rotor(best: MotionCandidate) -> Mapping[str, float]:
    """Return the change of each estimate over that of the rotor's inertia, by path; empty without a loss under load."""
    if LOSSES[0] not in best.model.free:
        return {}
    problem, x = solved_problem(best.fit)
    (part,) = best.fit.parts
    ((predicted, slopes),) = problem.predict(x)
    drive, nuisances = part.model, nuisances_of(best.fit)
    step = RELATIVE_ROTOR_STEP * (inertia_at_input(best) + drive.motor.inertia)
    other, _ = part.experiment.predict(drive.replace({MOTOR: drive.motor.inertia + step}), [], nuisances)
    before, _ = problem.prior_rows()
    noise = float(np.std(part.residuals))
    rows = np.concatenate([slopes[:, 0].T, noise * before])
    moved = -solved(rows, np.concatenate([(other - predicted)[0] / step, np.zeros(len(before))]))
    return {each.path: float(slope) for each, slope in zip(problem.plan.unknowns, moved, strict=False)}


def with_rotor(best: MotionCandidate, inertia: float) -> MotionCandidate:
    """Return the model fitted anew with an inertia of the motor [kg.m2] that the wind-up of the gear shows."""
    drive = best.fit.parts[0].model
    carried = inertia_of(drive) - inertia * drive.gear.kinematics.ratio**2
    start = drive.replace({MOTOR: inertia, LOAD: max(carried, MIN_INERTIA_SHARE * inertia_of(drive))})
    return replace(best, model=replace(best.model, drive=start))
