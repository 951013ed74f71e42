"""Logs of moving drives: inertia, gravity and friction by the torque along a measured motion.

Numbers are estimated in the pass band and from sliding alone: there no vibration of the load and no bending of bristles biases
them. What they predict is judged as a user reads it: on contiguous stretches that took no part in the fit, in the full band, at
every sample. A part is added as long as it predicts better; bristles that bend at reversals are added to the prediction without
moving the estimates. Estimates without a stretch follow from those with all by one step of Gauss and Newton, as least squares
on a motion is nearly linear. Plain least squares is fitted, too.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive, friction, loads
from strainwave.analysis.torsion_loop import series_compliance
from strainwave.identification.candidates.motion_candidate import GRAVITY_PATHS, MAX_ERROR, MotionCandidate, candidate_of
from strainwave.identification.candidates.motion_model import (
    BREAKAWAY_FOLLOWS,
    INPUT,
    MotionModel,
    sizes_of_waves,
    slope_of,
    with_curved_viscous_part,
    with_delay,
    with_friction_at_low_speed,
    with_loss_under_load,
    with_ripple,
    without,
)
from strainwave.identification.candidates.plain import (
    MAX_DELAY_SAMPLES,
    MAX_RELATIVE_ERROR,
    Plain,
    best_delay,
    fit_plain,
    held_out_residuals,
    moving,
    one_speed,
    stretches,
)
from strainwave.identification.experiments.friction_table import FRICTIONLESS
from strainwave.identification.experiments.motion_log import MIN_INERTIA, MIN_INERTIA_SHARE, MotionLog, inertia_of, per_torque

Array = NDArray[np.float64]
Rows = NDArray[np.bool_]

COULOMB_AND_VISCOUS = (f"{INPUT}coulomb", f"{INPUT}viscous")
AS_IN_SET = "split as in the start set"
MIN_STRETCH = 20  # samples of a stretch that is held out
MIN_SLIDING = 50  # samples of sliding in the pass band: with fewer the log is compared in the full band, at reversals, too
START_FRICTION = 1e-3  # of the size of the regression's: from where a fit can start
MAX_SMALL_PART = 1.0  # of the held-out error: a larger part of the effort is never left out
SPREAD_OF_VISCOUS = 1.0  # relative standard deviation of the viscous friction by the start set's share of it (assumed)
MIN_SPREAD_OF_SHARE = 0.15  # standard deviation of the share of viscous friction by the start set (assumed)


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
        inertia: the inertia that is not known, `load.inertia` or `motor.inertia`
        priors: what is known of free parameters: value and standard deviation

    Returns:
        candidates, best first

    Raises:
        ValueError: no model can be fitted
    """
    held_out = stretches(logs[0])
    _check_compared(logs[0], held_out)
    logs = [each for each in logs if len(each.motion.rows) >= MIN_SLIDING] or [logs[0].in_full_band()]
    simple, of_split = _simple(logs[0], drive, inertia)
    search = _Search(drive, held_out, {**(priors or {}), **of_split})
    best = search.first([replace(simple, log=log.starting([each.start for each in simple.log.nuisances])) for log in logs])
    delay = best_delay(logs[0], drive)
    late = with_delay(best.model, delay) if delay else None  # alone, and with each other part, as each may hide the other
    delayed = [] if late is None else [late, *(part(late) for part in PARTS if part is not with_delay)]
    with_delays = [each for model in delayed if (each := search.tried(model)) is not None]
    best = _completed(search, best)
    if with_delays:
        start = with_delays[0]  # a delay alone, unless a part beside it explains more
        for each in with_delays[1:]:
            start = each if each.explains_more_than(start) else start
        other, beside = _completed(search, start), _completed(search, min(with_delays, key=lambda each: each.error_in_band))
        other = beside if beside.explains_more_than(other) else other
        is_stand_in = bool(sizes_of_waves(best.model)) and not best.predicts_as_well_as(other)  # waves for a delay
        best = other if is_stand_in or other.explains_more_than(best) else best
    best = search.no_worse_than_plain(best, replace(simple, log=simple.log.in_full_band()))
    others = sorted((each for each in search.every if each.model is not best.model), key=lambda each: each.error)
    return (best, *others)


def _completed(search: _Search, best: MotionCandidate) -> MotionCandidate:
    """Return the model without the parts that the record does not show, and with those that make it predict better.

    What varies over the angle hides smaller parts, and may stand for a part that is missing: it comes first, or last.
    """
    best = _with(best, search.tried(_with_own_split(best.model)))
    rippled, plain = search.rippled(best), _with_parts(search, best)
    if rippled is best:
        return plain
    return _waving(_with_parts(search, rippled), plain)


def _waving(waving: MotionCandidate | None, plain: MotionCandidate) -> MotionCandidate:
    """Return the model with waves if it predicts the full band or the pass band better than one without, and neither worse."""
    if waving is None or not waving.predicts_as_well_as(plain):
        return plain
    return waving if waving.explains_more_than(plain) or waving.is_better_than(plain) else plain


def _with_parts(search: _Search, best: MotionCandidate) -> MotionCandidate:
    """Return the model without and with parts, those over the angle last."""
    for part in ("gravity", "inertia", "viscous part"):
        best = search.reduced(best, _without(best, part))
    best = search.rippled(search.grown(best, list(PARTS)))
    return _with(best, search.tried(_with_own_split(best.model)))  # which a delay hides


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
            candidate = candidate_of(model, self.held_out, self.priors)
        except (ValueError, FloatingPointError) as error:
            self.failures.append(str(error))
            return None
        if not _is_sensible(candidate):
            return None
        candidate = _with(candidate, candidate.with_bristles())
        self.every.append(candidate)
        return candidate

    def first(self, models: Sequence[MotionModel]) -> MotionCandidate:
        """Return the simplest model, in the band in which it shows most."""
        candidates = [each for model in models if (each := self.tried(model)) is not None]
        if not candidates:
            raise ValueError(self.failures[0])
        best = candidates[0]
        for other in candidates[1:]:
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
            candidates = {part: each for part, each in tried.items() if each is not None}
            chosen = min(candidates, key=lambda part: candidates[part].error_in_band, default=None)
            if chosen is None or not candidates[chosen].explains_more_than(best):
                break
            promising = [part for part, each in candidates.items() if each.error_in_band < MAX_ERROR * best.error_in_band]
            parts = [part for part in promising if part is not chosen]
            best = candidates[chosen]
        return best

    def rippled(self, best: MotionCandidate) -> MotionCandidate:
        """Return the model with the waves over the angle that predict better."""
        return _waving(self.tried(with_ripple(best.model)), best)

    def no_worse_than_plain(self, best: MotionCandidate, model: MotionModel) -> MotionCandidate:
        """Return the best model; if plain least squares predicts clearly better, the best of those better at the end."""
        log = best.log
        left = held_out_residuals(log, self.drive, self.held_out)
        ratios = np.array([float(np.sqrt(np.mean(each**2))) for each in left]) / best.errors
        if min(float(np.median(ratios)), float(ratios[-1])) > MAX_RELATIVE_ERROR:
            return best
        bristled, limit = best.with_bristles(), MAX_RELATIVE_ERROR * best.errors[-1]
        if bristled is not None and bristled.error < best.error and bristled.errors[-1] < limit:  # no estimate moves
            return bristled
        self.tried(model)
        return min((each for each in self.every if each.errors[-1] < limit), key=lambda each: each.error, default=best)


def _simple(log: MotionLog, drive: Drive, inertia: str) -> tuple[MotionModel, dict[str, tuple[float, float]]]:
    """Return the model with Coulomb and viscous friction alone, as plain least squares has it, and priors of their numbers.

    A record at one speed has its ramps alone to separate them: the share of the viscous friction by the start set is the prior.
    """
    plain, speed = fit_plain(log, drive), one_speed(log)
    start, free = _start(drive, plain, inertia)
    friction_free: tuple[str, ...] = COULOMB_AND_VISCOUS
    priors = dict[str, tuple[float, float]]()
    if speed:
        start, friction_free = _with_viscous_share(start, drive.gear.friction_input, speed), COULOMB_AND_VISCOUS[:1]
        priors = {COULOMB_AND_VISCOUS[1]: prior_of_viscous(start.gear.friction_input, speed)}
    zero = [plain.offset * per_torque(drive, log.effort)] if log.both_ways else []
    name = "Coulomb and viscous" + (f", {AS_IN_SET}" if speed else "")
    near = log.starting((*zero, *plain.shares))
    return MotionModel(name, near, start, (*free, *friction_free), BREAKAWAY_FOLLOWS, speed), priors


def _with_own_split(model: MotionModel) -> MotionModel | None:
    """Return the model of a record at one speed with the division of friction that its ramps show."""
    if not model.one_speed or (viscous := model.path_of("viscous")) in model.free:
        return None
    return replace(model, name=model.name.replace(AS_IN_SET, "split by ramps"), free=(*model.free, viscous))


def prior_of_viscous(law: Any, speed: float) -> tuple[float, float]:
    """Return the viscous friction of a law, as the start set's share of the friction at a speed [rad/s], and its spread."""
    viscous = float(law.viscous)
    return viscous, max(SPREAD_OF_VISCOUS * viscous, MIN_SPREAD_OF_SHARE * (law.coulomb / speed + viscous))


# ---- Parts that a record may not show -------------------------------------------------------------------------------------


def _without(best: MotionCandidate, part: Literal["gravity", "inertia", "viscous part"]) -> MotionModel | None:
    """Return the model without a part, if nobody gave its number and the number makes little of the effort.

    That is gravity of a joint whose axis is upright, inertia of one that hardly accelerates, and the viscous part of one that
    moves at one speed, where Coulomb's friction stands for all of it.
    """
    model, motion, ratio = best.model, best.log.motion, best.model.drive.gear.kinematics.ratio
    path, torque = {  # of a unit of the number
        "gravity": ("load.gravity_torque", np.sin(motion.output_angle(ratio)) / ratio),
        "inertia": ("load.inertia", motion.acceleration / ratio**2),
        "viscous part": (model.path_of("viscous"), motion.speed),
    }[part]
    if path not in model.free or path in best.priors:
        return None
    scale = per_torque(model.drive, best.log.effort) * best.values[model.free.index(path)]
    if not float(np.std(scale * torque)) < MAX_SMALL_PART * best.error:
        return None
    if part == "gravity":
        drive = model.drive.replace(load=loads.Inertia(inertia=inertia_of(model.drive)))
    else:
        drive = model.drive.replace({path: MIN_INERTIA if part == "inertia" else 0.0})
    return replace(model, name=f"{model.name}, no {part}", drive=drive, free=without(model.free, part.split()[0]))


# ---- Parts that may be added -------------------------------------------------------------------------------------------

Part = Callable[[MotionModel], MotionModel | None]
PARTS: tuple[Part, ...] = (
    with_delay, with_curved_viscous_part, partial(with_friction_at_low_speed, share=1.3),
    partial(with_friction_at_low_speed, share=0.7), with_loss_under_load,
)  # fmt: skip


def _is_sensible(candidate: MotionCandidate) -> bool:
    """True unless a part was fitted that cannot be: a delay longer than a clock makes it, a change of friction at speeds beyond
    the fastest motion, or none of the viscous friction that is known before."""
    log, model = candidate.log, candidate.model
    if model.path_of("viscous") in candidate.priors and model.law.viscous <= 0.0:
        return False
    falls = model.path_of("stribeck_speed") in model.free
    sensible = not falls or (model.law.stribeck_speed < float(np.abs(log.motion.speed).max()))
    return bool(abs(log.delay) < MAX_DELAY_SAMPLES * log.motion.step and sensible)


# ---- Parts of the prediction alone -----------------------------------------------------------------------------------------


def _with(candidate: MotionCandidate, more: MotionCandidate | None) -> MotionCandidate:
    """Return a model with a part of the prediction, if that is better by more than chance."""
    return more if more is not None and more.is_better_than(candidate) else candidate


# ---- Fit -----------------------------------------------------------------------------------------------------------------


def _start(drive: Drive, plain: Plain, inertia: str) -> tuple[Drive, list[str]]:
    """The drive near the measurement, and what is free of it."""
    ratio, least = drive.gear.kinematics.ratio, START_FRICTION * max(abs(plain.coulomb), 1e-6)
    coulomb = max(plain.coulomb, least)
    law = friction.Coulomb(coulomb=coulomb, breakaway=coulomb, viscous=max(plain.viscous, 0.0))
    drive = drive.replace(gear=drive.gear.replace(friction_input=law, friction_mesh=FRICTIONLESS))
    total, carried = max(plain.inertia, 1e-9), inertia_of(drive)
    if inertia == "load.inertia":
        rotor = drive.motor.inertia + drive.gear.input_inertia
        carried = max(total - rotor, MIN_INERTIA_SHARE * total) * ratio**2
    else:
        rest = total - drive.gear.input_inertia - carried / ratio**2
        drive = drive.replace(motor=drive.motor.replace(inertia=max(rest, MIN_INERTIA_SHARE * total)))
    load = loads.Pendulum(inertia=carried, gravity_torque=plain.gravity, gravity_phase=plain.phase)
    return drive.replace(load=load), [inertia, *GRAVITY_PATHS]


def _with_viscous_share(drive: Drive, law: Any, speed: float) -> Drive:
    """Return the drive whose viscous friction is the share of all friction at a speed [rad/s] that another law has there."""
    own: Any = drive.gear.friction_input
    before = float(law.steady(speed))
    share = min(max(slope_of(law, speed) * speed / before, 0.0), 1.0) if before > 0.0 else 0.0
    total = float(own.steady(speed))
    coulomb = (1.0 - share) * total
    shared = own.replace(coulomb=coulomb, breakaway=coulomb, viscous=share * total / speed)
    return drive.replace(gear=drive.gear.replace(friction_input=shared))


def natural_frequency(drive: Drive, carried: float) -> float:
    """Return the natural frequency of an inertia on the gear's spring, input held [Hz]; infinite if rigid or with play."""
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
