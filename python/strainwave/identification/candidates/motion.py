"""Logs of moving drives: inertia, gravity and friction by the torque along a measured motion.

Numbers are estimated in the pass band and from sliding alone: there no vibration of the load and no bending of bristles biases
them. What they predict is judged as a user reads it: on contiguous stretches that took no part in the fit, in the full band, at
every sample. A part is added as long as it predicts better; what shows in the full band alone, bristles that bend at reversals
and ripple over the turn, is added to the prediction without moving the estimates. Estimates without a stretch follow from those
with all by one step of Gauss and Newton, as least squares on a motion is nearly linear. Plain least squares stands beside all.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive, _core, friction, loads
from strainwave.equality import ComparedByFields
from strainwave.files.recording import Recording
from strainwave.identification.candidates.motion_model import (
    FOLLOWS,
    INPUT,
    MotionModel,
    bristled,
    with_another_friction_at_low_speed,
    with_curved_viscous_part,
    with_delay,
    with_loss_under_load,
    without,
)
from strainwave.identification.candidates.plain import (
    MAX_DELAY_SAMPLES,
    Plain,
    best_delay,
    fit_plain,
    held_out_residuals,
    moving,
    stretches,
)
from strainwave.identification.experiments.motion_log import FRICTIONLESS, MotionLog, inertia_of, per_torque
from strainwave.identification.experiments.stages import series_compliance
from strainwave.identification.fitting.fit import Fit, fit, problem_of, solved_problem
from strainwave.identification.fitting.loss import LOSSES as COSTS
from strainwave.identification.fitting.problem import Problem
from strainwave.identification.fitting.unknowns import plan
from strainwave.identification.results.held_out import MAX_SHARE_OF_PLAIN, HeldOut

Array = NDArray[np.float64]
Rows = NDArray[np.bool_]

COULOMB = (f"{INPUT}coulomb", f"{INPUT}viscous")
GRAVITY = ("load.gravity_torque", "load.gravity_phase")
BENDS = np.geomspace(3e-3, 1.0, 16)  # rad of the input, in which bristles bend
RIPPLE_ORDERS = (1.0, 2.0, 4.0)  # of the input rotation, found in every gear measured so far
MAX_RELATIVE_ERROR = 0.98  # of the held-out error of the simpler model: what leaves more is chance
MAX_ERROR = 0.995  # of the held-out error of the simpler model: what leaves more is not worth a part more
MAX_GAIN = 3.0  # times the upper quartile of the gains of blocks: a larger one counts as that
MIN_GAIN_SIGMA = 2.5  # standard deviations by which the squares of held-out residuals must become smaller
GAIN_BLOCKS = 10  # of each stretch, over which the gain of a model scatters
MIN_STRETCH = 20  # samples of a stretch that is held out
MIN_SLIDING = 50  # samples of sliding in the pass band: with fewer the log is compared in the full band, at reversals, too
SQUARED = COSTS["linear"]
NEAR = 1e-3  # relative, of the cost: models are compared as near to their best as that
JACKKNIFE_BLOCKS = 10  # of a log, each of which is left out once
MAX_REFITS = 6  # models that are fitted to all but the last stretch if the best one is not confirmed
MAX_STEPS = 8  # of a fit while models are compared
SHAPES = ("exponent", "stribeck_speed")  # numbers in which friction is not linear
MIN_SINGULAR = 1e-6  # singular values below this share of the largest are taken as zero
START_FRICTION = 1e-3  # of the size of the regression's: from where a fit can start
MAX_SMALL_PART = 1.0  # of the held-out error: a larger part of the effort is never left out
NO_INERTIA = 1e-12  # kg.m2: a load must have some
MIN_INERTIA_SHARE = 0.02  # of all that turns: from where the fit of an inertia starts


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
        rippled: True if a torque that repeats with the input's rotation is part of the prediction
    """

    model: MotionModel
    priors: Mapping[str, tuple[float, float]]
    unexplained: float
    folds: tuple[Fold, ...]
    bend: float = 0.0
    rippled: bool = False

    @property
    def name(self) -> str:
        more = [", bristles that bend at reversals"] * (self.bend > 0.0) + [", ripple"] * self.rippled
        return "".join([self.model.name, *more])

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

    def left(self, drive: Drive, nuisances: Array, training: Rows) -> Array:
        """Return measured less predicted effort at every sample, ripple by that of the samples of training, shape (m,)."""
        residual = self.log.residual(self.predicting(drive), nuisances)
        if not self.rippled:
            return residual
        angle = self.log.motion.angle
        waves = np.stack([wave(order * angle) for order in RIPPLE_ORDERS for wave in (np.sin, np.cos)], axis=1)
        rows = training & moving(self.log) & ~self.log.motion.resting
        shares = np.linalg.lstsq(waves[rows], residual[rows], rcond=MIN_SINGULAR)[0]
        return np.asarray(residual - np.where(self.log.motion.resting, 0.0, waves @ shares))

    def predicted_anew(self) -> MotionCandidate:
        """Return the same, with the residuals of what it predicts."""
        folds = [replace(each, residual=self.left(each.drive, each.nuisances, ~each.stretch)) for each in self.folds]
        return replace(self, folds=tuple(folds))

    @cached_property
    def residuals(self) -> list[Array]:
        """Of each stretch held out, in the full band, in the unit of the effort."""
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
        gains = np.array([block.sum() for pair in zip(other.residuals, self.residuals, strict=True) for block in _gain(*pair)])
        limit = MAX_GAIN * float(np.quantile(np.abs(gains), 0.75))  # so that a single event, as a jolt, decides nothing
        gains = np.clip(gains, -limit, limit)
        spread = float(np.std(gains, ddof=1)) * np.sqrt(len(gains))
        return float(gains.sum()) / spread if spread > 0.0 else 0.0

    def predicts_as_well_as(self, other: MotionCandidate) -> bool:
        """True if its error in the pass band is no larger, but for chance: what bends at reversals is compared nowhere else."""
        return MAX_RELATIVE_ERROR * self.error_in_band < other.error_in_band

    def is_clearer_than(self, other: MotionCandidate) -> bool:
        """True if it explains more of its own, narrower band, and predicts no worse."""
        is_narrower = self.log.motion.cutoff < other.log.motion.cutoff
        return is_narrower and self.unexplained < other.unexplained and MAX_ERROR * self.error < other.error


def _gain(before: Array, after: Array) -> list[Array]:
    """By how much squares of residuals become smaller, in blocks of a stretch."""
    return np.array_split(before**2 - after**2, GAIN_BLOCKS)


def nuisances_of(found: Fit) -> Array:
    """Return the unknowns of the measurement that a fit ended with, shape (nuisances,)."""
    count = len(found.experiment.nuisances)
    return np.array([each.value for each in found.estimates[len(found.estimates) - count :]])


def fit_motion(
    logs: Sequence[MotionLog],
    drive: Drive,
    *,
    inertia: str = "load.inertia",
    priors: Mapping[str, tuple[float, float]] | None = None,
) -> tuple[MotionCandidate, ...]:
    """Fit a rigid drive to a log by every friction that it may have, and rank the models by what they predict.

    Args:
        logs: one log as it may be compared, in several bands; the first unless another one predicts clearly better
        drive: to start from, with a load of inertia or pendulum
        inertia: the inertia that is not known, as a path of the drive
        priors: what is known of free parameters: value and standard deviation

    Returns:
        candidates, best first

    Raises:
        ValueError: no model can be fitted
    """
    held_out = stretches(logs[0])
    _check_compared(logs[0], held_out)
    search = _Search(drive, held_out, priors or {})
    logs = [each for each in logs if len(each.motion.rows) >= MIN_SLIDING] or [logs[0].in_full_band()]
    simple = _simple(logs[0], drive, inertia)
    best = search.first([replace(simple, log=log.starting([each.start for each in simple.log.nuisances])) for log in logs])
    delay = best_delay(logs[0], drive)
    late = [search.tried(each) for each in _delayed(best.model, delay)] if delay else []
    best = _completed(search, best)
    if found := [each for each in late if each is not None]:
        other = _completed(search, min(found, key=lambda each: each.error_in_band))
        best = other if other.explains_more_than(best) else best
    best = search.no_worse_than_plain(best, replace(simple, log=simple.log.in_full_band()))
    return best, *sorted((each for each in search.every if each.model is not best.model), key=lambda each: each.error)


def _delayed(model: MotionModel, delay: float) -> list[MotionModel | None]:
    """Return a model with a delay from where it starts, and with each other part beside it, as each may hide the other."""
    late = with_delay(model, delay)
    return [late] if late is None else [late, *(part(late) for part in PARTS if part is not with_delay)]


def _completed(search: _Search, best: MotionCandidate) -> MotionCandidate:
    """Return the model without the parts that the record does not show, and with those that make it predict better."""
    for less in (_without_gravity, _without_inertia, _without_viscous):
        best = search.reduced(best, less(best))
    best = search.grown(best, list(PARTS))
    for more in (_with_bristles, _with_ripple):
        added = more(best)
        best = added if added is not None and added.is_better_than(best) else best
    return best


def _check_compared(log: MotionLog, held_out: Sequence[Rows]) -> None:
    """
    Raises:
        ValueError: the motion is too short to hold a stretch of it out, or the effort does not vary
    """
    fewest = min(int(each.sum()) for each in held_out)
    if fewest < MIN_STRETCH:
        raise ValueError(
            f"the motion lasts {int(moving(log).sum())} sound samples: a third of it must be held out, and {fewest} of "
            f"{MIN_STRETCH} are left for that; record longer or faster"
        )
    if np.std(log.force) == 0.0:
        raise ValueError(f"{log.effort} does not vary where the shaft moves: a set value, or a channel that was not recorded")


class _Search:
    """Models of one log, each with what it predicts of the stretches held out."""

    def __init__(self, drive: Drive, held_out: Sequence[Rows], priors: Mapping[str, tuple[float, float]]) -> None:
        self.drive, self.held_out, self.priors = drive, held_out, priors
        self.every, self.failures = list[MotionCandidate](), list[str]()

    def tried(self, model: MotionModel | None) -> MotionCandidate | None:
        """Return a model fitted to the log; None if it goes beyond what its laws, a clock or the motion allow."""
        if model is None:
            return None
        try:
            found = _candidate(model, self.held_out, self.priors)
        except (ValueError, FloatingPointError) as error:
            self.failures.append(str(error))
            return None
        if not _is_sensible(found):
            return None
        self.every.append(found)
        return found

    def first(self, models: Sequence[MotionModel]) -> MotionCandidate:
        """Return the simplest model, in the band in which it shows most."""
        found = [each for model in models if (each := self.tried(model)) is not None]
        if not found:
            raise ValueError(self.failures[0])
        best = found[0]
        for other in found[1:]:
            best = other if other.is_clearer_than(best) else best
        return best

    def reduced(self, best: MotionCandidate, model: MotionModel | None) -> MotionCandidate:
        """Return the model with a part less, if that predicts better, and sliding in the pass band no worse."""
        simpler = self.tried(model)
        if simpler is None or simpler.error >= best.error or MAX_ERROR * simpler.error_in_band >= best.error_in_band:
            return best
        return simpler

    def grown(self, best: MotionCandidate, parts: list[Part]) -> MotionCandidate:
        """Return the model with those parts that explain more, the one that explains most first."""
        while parts:
            tried = {part: self.tried(part(best.model)) for part in parts}
            found = {part: each for part, each in tried.items() if each is not None}
            chosen = min(found, key=lambda part: found[part].error_in_band, default=None)
            if chosen is None or not found[chosen].explains_more_than(best):
                break
            promising = [part for part, each in found.items() if each.error_in_band < MAX_ERROR * best.error_in_band]
            parts = [part for part in promising if part is not chosen]
            best = found[chosen]
        return best

    def no_worse_than_plain(self, best: MotionCandidate, model: MotionModel) -> MotionCandidate:
        """Return the best model; if plain least squares predicts better, the best of those tried that is no worse than it."""
        log = best.log
        left = held_out_residuals(log, self.drive, self.held_out)
        ratios = np.array([float(np.sqrt(np.mean(each**2))) for each in left]) / best.errors
        if min(float(np.median(ratios)), float(ratios[-1])) > MAX_RELATIVE_ERROR:
            return best
        bristled, limit = _with_bristles(best), MAX_RELATIVE_ERROR * best.errors[-1]
        if bristled is not None and bristled.error < best.error and bristled.errors[-1] < limit:  # no estimate moves
            return bristled
        self.tried(model)
        return min((each for each in self.every if each.errors[-1] < limit), key=lambda each: each.error, default=best)


def _simple(log: MotionLog, drive: Drive, inertia: str) -> MotionModel:
    """Return the model with Coulomb and viscous friction alone, as plain least squares has it."""
    plain = fit_plain(log, drive)
    start, free = _start(drive, plain, inertia)
    zero = [plain.offset * per_torque(drive, log.effort)] if log.both_ways else []
    return MotionModel("Coulomb and viscous", log.starting((*zero, *plain.shares)), start, (*free, *COULOMB), FOLLOWS)


# ---- Parts that a record may not show -------------------------------------------------------------------------------------


def _is_small(best: MotionCandidate, path: str, unit: Array) -> bool:
    """True if a number makes so little of the effort that the model may do without: `unit` is what one unit of it makes."""
    value = next((value for name, value, *_ in _core.parameters(best.model.drive) if name == path), 0.0)
    scale = per_torque(best.model.drive, best.log.effort)
    return path in best.model.free and float(np.std(scale * value * unit)) < MAX_SMALL_PART * best.error


def _without_gravity(best: MotionCandidate) -> MotionModel | None:
    """Return the model of a joint whose axis is upright."""
    model, ratio = best.model, best.model.drive.gear.kinematics.ratio
    if not _is_small(best, "load.gravity_torque", np.sin(best.log.motion.angle / ratio) / ratio):
        return None
    load = loads.Inertia(inertia=inertia_of(model.drive))
    return replace(
        model, name=f"{model.name}, no gravity", drive=model.drive.replace(load=load), free=without(model.free, "gravity")
    )


def _without_inertia(best: MotionCandidate) -> MotionModel | None:
    """Return the model of a joint that hardly accelerates."""
    model = best.model
    if not _is_small(best, "load.inertia", best.log.motion.acceleration / model.drive.gear.kinematics.ratio**2):
        return None
    drive = model.drive.replace({"load.inertia": NO_INERTIA})
    return replace(model, name=f"{model.name}, no inertia", drive=drive, free=without(model.free, "inertia"))


def _without_viscous(best: MotionCandidate) -> MotionModel | None:
    """Return the model of a joint that moves at one speed, where Coulomb's friction stands for all of it."""
    model = best.model
    if not _is_small(best, f"{INPUT}viscous", best.log.motion.speed):
        return None
    drive = model.drive.replace({f"{INPUT}viscous": 0.0})
    return replace(model, name=f"{model.name}, no viscous part", drive=drive, free=without(model.free, "viscous"))


# ---- Parts that may be added -------------------------------------------------------------------------------------------

Part = Callable[[MotionModel], MotionModel | None]
PARTS: tuple[Part, ...] = (with_delay, with_curved_viscous_part, with_another_friction_at_low_speed, with_loss_under_load)


def _is_sensible(candidate: MotionCandidate) -> bool:
    """True unless a part was fitted that the motion does not show: a delay longer than a clock makes it, or a change of the
    friction at speeds beyond the fastest motion."""
    log, law = candidate.log, candidate.model.law
    delay = next((each.start for each in log.nuisances if each.name == "delay"), 0.0)
    falls = f"{INPUT}stribeck_speed" in candidate.model.free
    sensible = not falls or (law.stribeck_speed < float(np.abs(log.motion.speed).max()))
    return bool(abs(delay) < MAX_DELAY_SAMPLES * log.motion.step and sensible)


# ---- Parts of the prediction alone -----------------------------------------------------------------------------------------


def _with_bristles(best: MotionCandidate) -> MotionCandidate | None:
    """Return the same with bristles, of the bend that explains most; None if its law of friction has none."""
    drive, rows = best.model.drive, moving(best.log)
    if bristled(drive, BENDS[0]) is drive:
        return None
    nuisances = np.array([each.start for each in best.log.nuisances])

    def error(bend: float) -> float:
        return float(np.mean(best.log.residual(bristled(drive, bend), nuisances)[rows] ** 2))

    return replace(best, bend=min(BENDS.tolist(), key=error)).predicted_anew()


def _with_ripple(best: MotionCandidate) -> MotionCandidate:
    """Return the same with a torque that repeats with the input's rotation."""
    return replace(best, rippled=True).predicted_anew()


# ---- Fit -----------------------------------------------------------------------------------------------------------------


def _start(drive: Drive, plain: Plain, inertia: str) -> tuple[Drive, list[str]]:
    """The drive near the measurement, and what is free of it."""
    ratio, least = drive.gear.kinematics.ratio, START_FRICTION * max(abs(plain.coulomb), 1e-6)
    coulomb = max(plain.coulomb, least)
    law = friction.Coulomb(coulomb=coulomb, breakaway=coulomb, viscous=max(plain.viscous, 0.0))
    drive = drive.replace(gear=drive.gear.replace(friction_input=law, friction_mesh=FRICTIONLESS))
    total = max(plain.inertia, 1e-9)
    if inertia == "load.inertia":
        rotor = drive.motor.inertia + drive.gear.input_inertia
        carried = max(total - rotor, MIN_INERTIA_SHARE * total) * ratio**2
        load: Any = loads.Pendulum(inertia=carried, gravity_torque=plain.gravity, gravity_phase=plain.phase)
        return drive.replace(load=load), [inertia, "load.gravity_torque", "load.gravity_phase"]
    rest = total - drive.gear.input_inertia - inertia_of(drive) / ratio**2
    return drive.replace(motor=drive.motor.replace(inertia=max(rest, MIN_INERTIA_SHARE * total))), [inertia]


def natural_frequency(drive: Drive, carried: float) -> float:
    """Of an inertia on the spring of the gear, its input held [Hz]; infinite where nothing gives way, or it has play."""
    softness = 1.0 / stiffness if (stiffness := drive.gear.stiffness.tangent(0.0)) > 0.0 else 0.0
    softness += series_compliance(drive.gear)
    return float(1.0 / (2.0 * np.pi * np.sqrt(softness * carried))) if softness * carried > 0.0 else np.inf


def bands(log: MotionLog, drive: Drive) -> list[MotionLog]:
    """Return the log as it may be compared: where the angle is known well, and below the vibration of the load.

    A spring that was taken from a catalogue may be none of this drive, so that each band is tried.
    """
    rotor, ratio = drive.motor.inertia + drive.gear.input_inertia, drive.gear.kinematics.ratio
    frequency = natural_frequency(drive, max(fit_plain(log, drive).inertia - rotor, 0.0) * ratio**2)
    try:
        below = [log.below(frequency)]
    except ValueError:  # it moves as fast as it vibrates
        below = []
    return [log, *below]


def _candidate(model: MotionModel, held_out: Sequence[Rows], priors: Mapping[str, tuple[float, float]]) -> MotionCandidate:
    """Fit a model as nearly as comparisons need, from where it starts."""
    known = {path: prior for path, prior in priors.items() if path in model.free}
    asked = plan(model.drive, [""], model.free, ties=model.ties, priors=known)
    problem = problem_of(asked, [""], [model.drive], [model.log], [None])
    x = problem.solve(problem.start(), problem.first_weights(), SQUARED, NEAR, trials=MAX_STEPS)
    (record,) = problem.records
    ((predicted, _),) = problem.predict(x)
    ended = replace(model, drive=record.model(x), log=model.log.starting(x[record.nuisances].tolist()))
    unexplained = float(np.std(model.log.measured - predicted) / max(float(np.std(model.log.measured)), 1e-300))
    return MotionCandidate(ended, known, unexplained, tuple(_folds(problem, x, ended.log, held_out)))


def confirmed(
    best: MotionCandidate, others: Sequence[MotionCandidate], drive: Drive
) -> tuple[MotionCandidate, HeldOut, Recording]:
    """Return the best model that predicts the last 30 % of the motion no worse than plain least squares and than their mean.

    Models were compared by one step of Gauss and Newton, which may hide numbers that the rest of the motion does not determine.

    Returns:
        the model, of all tried the one with the smallest error if none is as good; its error and that of plain least squares,
        with the terms of other joints or without, whichever is smaller; and its prediction, as `refit`
    """
    last, tried = best.folds[-1].stretch, []
    logs = {tuple(each.log.regressors): each.log for each in (best, *others)}.values()
    plain = min(float(np.sqrt(np.mean(held_out_residuals(log, drive, [last])[0] ** 2))) for log in logs)
    for each in (best, *sorted(others, key=lambda other: other.error)[:MAX_REFITS]):
        held_out, predicted = refit(each)
        held_out = replace(held_out, plain=plain)
        tried.append((each, held_out, predicted))
        if held_out.share_of_plain < MAX_SHARE_OF_PLAIN and held_out.relative < 1.0:
            return tried[-1]
    return min(tried, key=lambda found: found[1].error)


def refit(best: MotionCandidate) -> tuple[HeldOut, Recording]:
    """Return the error on the last 30 % of the motion of the model fitted to what comes before, and its prediction of all.

    Returns:
        the error; and time, effort, `modelled` and `held_out` (1 in the stretch), as
        they are drawn, from the first motion to the last
    """
    log, last = best.log, best.folds[-1].stretch
    found = best.fitted_to(~last[log.motion.rows])
    residual = best.left(found.model, nuisances_of(found), ~last)
    left, rows = residual[last], moving(log)
    before = float(np.mean(log.recorded[rows & ~last]))
    (part,) = found.parts
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
    one part of a record to another. Numbers at a limit have none.
    """
    problem, x = solved_problem(best.fit)
    rows = np.arange(len(best.log.motion.rows))
    blocks = [(rows >= each[0]) & (rows <= each[-1]) for each in np.array_split(rows, JACKKNIFE_BLOCKS)]
    without = np.array(list(_without_rows(problem, x, blocks, ())))
    spread = np.sqrt((JACKKNIFE_BLOCKS - 1) * np.var(without, axis=0))
    return {each.path: float(sigma) for each, sigma in zip(problem.plan.unknowns, spread, strict=False)}


def spread_by_models(best: MotionCandidate, others: Sequence[MotionCandidate]) -> dict[str, float]:
    """Return how far numbers lie apart in models of the same law that predict as well, by path: the choice of a model is part
    of their uncertainty. A number of another law of friction has another meaning."""
    values = dict(zip(best.model.free, best.values, strict=True))
    found = dict.fromkeys(values, 0.0)
    for other in others:
        if other.predicts_as_well_as(best) and type(other.model.law) is type(best.model.law):
            for path, value in zip(other.model.free, other.values, strict=True):
                if path in found:
                    off = abs(value - values[path])
                    turned = abs(np.remainder(off + np.pi, 2.0 * np.pi) - np.pi) if path.endswith("_phase") else off
                    found[path] = max(found[path], float(turned))
    return found


def other_laws(best: MotionCandidate, others: Sequence[MotionCandidate]) -> list[MotionCandidate]:
    """Return the models with another law of friction that predict as well, the best of each law."""
    laws = {type(best.model.law): best}
    for other in sorted(others, key=lambda each: each.error_in_band):
        if other.predicts_as_well_as(best):
            laws.setdefault(type(other.model.law), other)
    return list(laws.values())[1:]


def _folds(problem: Problem, x: Array, log: MotionLog, held_out: Sequence[Rows]) -> Iterator[Fold]:
    """The model by what the rest of the log determines without each stretch; shapes of friction stay as the whole has them."""
    (record,) = problem.records
    ((predicted, slopes),) = problem.predict(x)
    out = [stretch[log.motion.rows] for stretch in held_out]
    for stretch, rows, there in zip(held_out, out, _without_rows(problem, x, out, SHAPES), strict=True):
        model, nuisances = record.model(there), there[record.nuisances]
        in_band = (log.measured - predicted)[0, rows] - slopes[:, 0, rows].T @ (there - x)
        yield Fold(stretch, model, nuisances, in_band, log.residual(model, nuisances))


def _without_rows(problem: Problem, x: Array, outs: Sequence[Rows], kept: Sequence[str]) -> Iterator[Array]:
    """The unknowns without some of the samples compared: a step of Gauss and Newton from the whole.

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
    gravity = [paths.index(path) for path in GRAVITY] if set(GRAVITY) <= set(paths) else []
    low = np.where(np.isin(np.arange(len(x)), gravity), -np.inf, low)  # turned round rather than negative
    for out in outs:
        system = (np.concatenate([rows[~out], noise * before]) / size)[:, linear]
        there = x.copy()
        room = ((low - x) * size)[linear], ((high - x) * size)[linear]
        there[linear] += _bounded(system, np.concatenate([left[~out], noise * (right - before @ x)]), *room) / size[linear]
        if gravity:
            there[gravity] = _turned(x[gravity], there[gravity])
        yield there


def _turned(before: Array, after: Array) -> Array:
    """Return amplitude and phase of a gravity after a linear step, which is exact in its sine and cosine."""
    step, turn = after - before
    moved = complex(before[0] + step, before[0] * turn)
    return np.array([abs(moved), before[1] + np.angle(moved)])


def _bounded(system: Array, right: Array, low: Array, high: Array) -> Array:
    """The unknowns of least squares within limits."""
    from scipy.optimize import lsq_linear

    orthogonal, triangle = np.linalg.qr(system)
    found = lsq_linear(triangle, orthogonal.T @ right, (np.minimum(low, 0.0), np.maximum(high, 0.0)), method="bvls", tol=1e-8)
    return np.asarray(found.x)
