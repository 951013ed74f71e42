"""Logs of moving drives: inertia, gravity and friction by the torque along a measured motion.

Models are compared by what they predict of stretches of the motion that took no part in their fit, in the full band, at every
sample. The estimates without a stretch follow from those with all by one step of Gauss and Newton, as least squares on a motion
is nearly linear. A part is added as long as it makes the error smaller; plain least squares stands beside all.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive, friction, loads
from strainwave.equality import ComparedByFields
from strainwave.identification.candidates.plain import Plain, fit_plain, held_out_residuals, moving
from strainwave.identification.experiments.motion_log import FRICTIONLESS, MotionLog, inertia_of, per_torque
from strainwave.identification.experiments.stages import series_compliance
from strainwave.identification.fitting.fit import Fit, fit, solved_problem
from strainwave.identification.results.held_out import HeldOut

Array = NDArray[np.float64]
Rows = NDArray[np.bool_]

STRETCHES = (0.0, 0.3, 0.7, 1.0)  # of the motion: each of the stretches between is held out once; the last 30 % are reported
QUADRANTS = ("driving_forward", "driving_reverse", "backdriving_forward", "backdriving_reverse")
LOSSES = tuple(f"gear.friction_mesh.{name}" for name in QUADRANTS)
INPUT = "gear.friction_input."
COULOMB = (f"{INPUT}coulomb", f"{INPUT}viscous")
FOLLOWS = {f"{INPUT}breakaway": f"{INPUT}coulomb"}
BENDS = np.geomspace(1e-3, 1.0, 7)  # rad of the input, in which a bristle bends: from where a fit starts
RIPPLE_ORDERS = (1.0, 2.0, 4.0)  # of the input rotation, found in every gear measured so far
MAX_RELATIVE_ERROR = 0.98  # of the held-out error of the simpler model: what leaves more is chance
MAX_ERROR = 0.995  # of the held-out error of the simpler model: what leaves more is not worth a part more
MAX_GAIN = 3.0  # times the upper quartile of the gains of blocks: a larger one counts as that
MIN_GAIN_SIGMA = 2.5  # standard deviations by which the squares of held-out residuals must become smaller
GAIN_BLOCKS = 10  # of each stretch, over which the gain of a model scatters
MIN_DELAY_SIGMA = 2.5  # standard deviations: a smaller delay is none
MAX_DELAY_SAMPLES = 5.0  # of the log
SHAPES = ("exponent", "stribeck_speed", "bristle_stiffness")  # numbers in which friction is not linear
RIPPLE = "ripple"  # begins the names of waves over the input angle
MIN_SINGULAR = 1e-6  # singular values below this share of the largest are taken as zero
START_FRICTION = 1e-3  # of the size of the regression's: from where a fit can start
NO_INERTIA = 1e-12  # kg.m2: a load must have some
MIN_INERTIA_SHARE = 0.02  # of all that turns: from where the fit of an inertia starts


@dataclass(frozen=True, eq=False)
class MotionModel(ComparedByFields):
    """A model of a joint to be fitted to a log.

    Attributes:
        name: of its friction, with what was added
        log: as it is compared
        drive: from which a fit starts
        free: paths of the numbers that are fitted
        ties: numbers that follow others, by path
    """

    name: str
    log: MotionLog
    drive: Drive
    free: tuple[str, ...]
    ties: Mapping[str, str]

    @property
    def law(self) -> Any:
        """The friction at the input."""
        return self.drive.gear.friction_input

    def having(self, what: str, *free: str, **parts: Any) -> MotionModel:
        """Return the same with other parts of the gear, and further numbers free."""
        drive = self.drive.replace(gear=self.drive.gear.replace(**parts))
        return replace(self, name=f"{self.name}, {what}", drive=drive, free=(*self.free, *free))


@dataclass(frozen=True, eq=False)
class MotionCandidate(ComparedByFields):
    """A model of a joint fitted to a log.

    Attributes:
        model: that was fitted, from where it started
        fit: to the whole log
        residuals: of each stretch held out, in the unit of the effort
    """

    model: MotionModel
    fit: Fit
    residuals: tuple[Array, ...]

    @property
    def name(self) -> str:
        return self.model.name

    @property
    def log(self) -> MotionLog:
        """The log as it was compared."""
        log = self.fit.parts[0].experiment
        assert isinstance(log, MotionLog)
        return log

    @cached_property
    def errors(self) -> Array:
        """Root mean square of the residuals of each stretch, shape (stretches,)."""
        return np.array([float(np.sqrt(np.mean(each**2))) for each in self.residuals])

    @cached_property
    def error(self) -> float:
        """Root mean square of the residuals of all stretches."""
        return float(np.sqrt(np.mean(np.concatenate(self.residuals) ** 2)))

    @property
    def ended(self) -> MotionModel:
        """The model from where its fit has ended."""
        return replace(self.model, drive=self.fit.model, log=self.log.starting(nuisances_of(self.fit).tolist()))

    def is_better_than(self, other: MotionCandidate) -> bool:
        """True if it predicts better by more than chance makes, all over the motion, and the last stretch no worse."""
        gains = np.array([block.sum() for pair in zip(other.residuals, self.residuals, strict=True) for block in _gain(*pair)])
        limit = MAX_GAIN * float(np.quantile(np.abs(gains), 0.75))  # so that a single event, as a jolt, decides nothing
        gains = np.clip(gains, -limit, limit)
        spread = float(np.std(gains, ddof=1)) * np.sqrt(len(gains))
        is_sure = float(gains.sum()) > MIN_GAIN_SIGMA * spread
        return is_sure and self.error < MAX_ERROR * other.error and MAX_ERROR * self.errors[-1] < other.errors[-1]

    def is_clearer_than(self, other: MotionCandidate) -> bool:
        """True if it explains more of its own, narrower band, and predicts no worse."""
        is_narrower = self.log.motion.cutoff < other.log.motion.cutoff
        return is_narrower and self.unexplained < other.unexplained and MAX_ERROR * self.error < other.error

    @cached_property
    def unexplained(self) -> float:
        """Root mean square of what is left in the band over that of the effort about its mean [1]."""
        part = self.fit.parts[0]
        return float(np.std(part.residuals) / np.std(part.experiment.measured))


def _gain(before: Array, after: Array) -> list[Array]:
    """By how much squares of residuals become smaller, in blocks of a stretch."""
    return np.array_split(before**2 - after**2, GAIN_BLOCKS)


def nuisances_of(found: Fit) -> Array:
    """Return the unknowns of the measurement that a fit ended with, shape (nuisances,)."""
    count = len(found.experiment.nuisances)
    return np.array([each.value for each in found.estimates[len(found.estimates) - count :]])


def stretches(log: MotionLog) -> list[Rows]:
    """Return the contiguous stretches of the motion that are held out in turn, the last 30 % at the end, shape (m,) each."""
    places = np.flatnonzero(moving(log))
    ends = [places[0] + round(share * (places[-1] + 1 - places[0])) for share in STRETCHES]
    every = np.arange(len(log.motion.time))
    return [(every >= begin) & (every < end) for begin, end in pairwise(ends)]


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
    """
    held_out = stretches(logs[0])
    plain = fit_plain(logs[0], drive)
    start, free = _start(drive, plain, inertia)
    zero = [plain.offset * per_torque(drive, logs[0].effort)] if logs[0].both_ways else []

    failures = list[str]()

    def tried(model: MotionModel) -> MotionCandidate | None:
        try:
            return _candidate(model, held_out, priors or {})
        except (ValueError, FloatingPointError) as error:  # beyond what a law allows, from its start
            failures.append(str(error))
            return None

    simple = MotionModel("Coulomb and viscous", logs[0], start, (*free, *COULOMB), FOLLOWS)
    found = [tried(replace(simple, log=log.starting((*zero, *plain.shares)))) for log in logs]
    every = [each for each in found if each is not None]
    if not every:
        raise ValueError(failures[0])
    best = every[0]
    for other in every[1:]:
        best = other if other.is_better_than(best) or other.is_clearer_than(best) else best
    left: list[Part] = [_delayed, _curved, _falling, _lossy, _bristled, _rippled]
    for less in (_without_gravity, _without_inertia, _without_viscous):
        simpler = tried(model) if (model := less(best.ended)) is not None else None
        if simpler is not None:
            every.append(simpler)
            best = simpler if simpler.error < best.error else best
    while left:
        grown = {part: tried(model) for part in left if (model := part(best.ended)) is not None}
        sensible = {part: each for part, each in grown.items() if each is not None and _is_sensible(each)}
        every += sensible.values()
        chosen = min(sensible, key=lambda part: sensible[part].error, default=None)
        if chosen is None or not sensible[chosen].is_better_than(best):
            break
        best = sensible[chosen]
        left = [part for part in left if part is not chosen and part in sensible]
    best = _no_worse_than_plain(
        best, tried(replace(simple, log=logs[0].in_full_band().starting((*zero, *plain.shares)))), drive
    )
    return best, *sorted((each for each in every if each is not best), key=lambda each: each.error)


def _no_worse_than_plain(best: MotionCandidate, simple: MotionCandidate | None, drive: Drive) -> MotionCandidate:
    """Return the best model, or plain least squares if that predicts better: inertia, gravity, Coulomb and viscous friction."""
    blocks = stretches(best.log)
    left = held_out_residuals(replace(best.log, regressors=_of_other_joints(best.log)), drive, blocks)
    plain = float(np.sqrt(np.mean(np.concatenate(left) ** 2)))
    if simple is None or plain > MAX_RELATIVE_ERROR * best.error:
        return best
    return simple if simple.error < best.error else best


# ---- Parts that a record may not show -------------------------------------------------------------------------------------


def _without(free: Sequence[str], name: str) -> tuple[str, ...]:
    """Return the paths but those of numbers whose names begin so."""
    return tuple(path for path in free if not path.rpartition(".")[2].startswith(name))


def _without_gravity(model: MotionModel) -> MotionModel | None:
    """Return the model of a joint whose axis is upright."""
    if "load.gravity_torque" not in model.free:
        return None
    load = loads.Inertia(inertia=inertia_of(model.drive))
    return replace(
        model, name=f"{model.name}, no gravity", drive=model.drive.replace(load=load), free=_without(model.free, "gravity")
    )


def _without_inertia(model: MotionModel) -> MotionModel | None:
    """Return the model of a joint that hardly accelerates."""
    if "load.inertia" not in model.free:
        return None
    drive = model.drive.replace({"load.inertia": NO_INERTIA})
    return replace(model, name=f"{model.name}, no inertia", drive=drive, free=_without(model.free, "inertia"))


def _without_viscous(model: MotionModel) -> MotionModel | None:
    """Return the model of a joint that moves at one speed, where Coulomb's friction stands for all of it."""
    if f"{INPUT}viscous" not in model.free:
        return None
    drive = model.drive.replace({f"{INPUT}viscous": 0.0})
    return replace(model, name=f"{model.name}, no viscous part", drive=drive, free=_without(model.free, "viscous"))


# ---- Parts that may be added -------------------------------------------------------------------------------------------

Part = Callable[[MotionModel], MotionModel | None]


def _delayed(model: MotionModel) -> MotionModel | None:
    """With a delay of the effort behind the motion."""
    if model.log.delayed:
        return None
    log = model.log.with_delay()
    before = {each.name: each.start for each in model.log.nuisances}
    return replace(
        model, name=f"{model.name}, a delay", log=log.starting([before.get(each.name, 0.0) for each in log.nuisances])
    )


def _curved(model: MotionModel) -> MotionModel | None:
    """With a viscous torque that bends over the speed."""
    law = model.law
    if not isinstance(law, friction.Coulomb):
        return None
    fastest = float(np.abs(model.log.motion.speed).max())
    curved = friction.CurvedViscous(
        coulomb=law.coulomb, breakaway=law.coulomb, viscous_torque=max(law.viscous * fastest, 1e-3 * law.coulomb, 1e-12),
        exponent=0.9, reference_speed=fastest,
    )  # fmt: skip
    names = (f"{INPUT}viscous_torque", f"{INPUT}exponent")
    return replace(model, free=_without(model.free, "viscous")).having("a curved viscous part", *names, friction_input=curved)


def _falling(model: MotionModel) -> MotionModel | None:
    """With friction that falls at low speed."""
    law, names = model.law, (f"{INPUT}breakaway", f"{INPUT}stribeck_speed")
    if isinstance(law, friction.LuGre) and names[0] not in model.free:
        falling: Any = law.replace(breakaway=1.3 * law.coulomb, stribeck_speed=3.0)
    elif isinstance(law, friction.Coulomb):
        falling = friction.Stribeck(coulomb=law.coulomb, breakaway=1.3 * law.coulomb, stribeck_speed=3.0, viscous=law.viscous)
    else:
        return None
    ties = {path: other for path, other in model.ties.items() if path not in FOLLOWS}
    return replace(model, ties=ties).having("a fall at low speed", *names, friction_input=falling)


def _lossy(model: MotionModel) -> MotionModel | None:
    """With a loss under load, the same in all quadrants: one for each cannot be separated from inertia and gravity."""
    if LOSSES[0] in model.free:
        return None
    lossy = friction.LoadDependent(**dict.fromkeys(QUADRANTS, 0.02))
    ties = {**model.ties, **dict.fromkeys(LOSSES[1:], LOSSES[0])}
    return replace(model, ties=ties).having("a loss under load", LOSSES[0], friction_mesh=lossy)


def _bristled(model: MotionModel) -> MotionModel | None:
    """With a bristle that bends at reversals, from the bend that predicts best."""
    law = model.law
    if not isinstance(law, friction.Coulomb | friction.Stribeck) or law.coulomb <= 0.0:
        return None
    speed = law.stribeck_speed if isinstance(law, friction.Stribeck) else 1.0
    model = replace(model, log=model.log.in_full_band())
    nuisances, rows = np.array([each.start for each in model.log.nuisances]), moving(model.log)

    def bent(bend: float) -> MotionModel:
        bristle = friction.LuGre(
            coulomb=law.coulomb, breakaway=law.breakaway, stribeck_speed=speed,
            bristle_stiffness=law.coulomb / bend, bristle_damping=0.0, viscous=law.viscous,
        )  # fmt: skip
        return model.having("a bristle at reversals", f"{INPUT}bristle_stiffness", friction_input=bristle)

    def error(bend: float) -> float:
        return float(np.mean(model.log.residual(bent(bend).drive, nuisances)[rows] ** 2))

    return bent(min(BENDS.tolist(), key=error))


def _rippled(model: MotionModel) -> MotionModel | None:
    """With a torque that repeats with the input's rotation."""
    if any(name.startswith(RIPPLE) for name in model.log.regressors):
        return None
    angle, ratio = model.log.motion.angle, abs(model.drive.gear.kinematics.ratio)
    waves = {
        f"{RIPPLE} {way} {order:g}": ratio * wave(order * angle)
        for order in RIPPLE_ORDERS
        for way, wave in (("sin", np.sin), ("cos", np.cos))
    }
    starts = [each.start for each in model.log.nuisances]
    log = replace(model.log.in_full_band(), regressors={**model.log.regressors, **waves}, starts=(*starts, *[0.0] * len(waves)))
    return replace(model, name=f"{model.name}, ripple", log=log)


def _is_sensible(candidate: MotionCandidate) -> bool:
    """True unless a part was fitted that the motion does not show: a delay that is none, or longer than a clock makes it; a fall
    of the friction that is none, or beyond the fastest motion."""
    found = {each.path.removeprefix(INPUT): each for each in candidate.fit.estimates}
    if (delay := found.get("delay")) is not None:
        return MIN_DELAY_SIGMA * delay.sigma < abs(delay.value) < MAX_DELAY_SAMPLES * candidate.log.motion.step
    if (speed := found.get("stribeck_speed")) is not None:
        fastest = float(np.abs(candidate.log.motion.speed).max())
        return speed.value < fastest and found["breakaway"].value > found["coulomb"].value
    return True


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
    known = {path: prior for path, prior in priors.items() if path in model.free}
    found = fit(model.drive, model.log, model.free, ties=model.ties, priors=known)
    return MotionCandidate(model, found, tuple(_held_out(found, model.log, held_out)))


def refit(best: MotionCandidate, drive: Drive, priors: Mapping[str, tuple[float, float]]) -> HeldOut:
    """Return the error on the last 30 % of the motion of the model fitted to what comes before, beside plain least squares."""
    log, model = best.log, best.ended
    last = stretches(log)[-1]
    known = {path: prior for path, prior in priors.items() if path in model.free}
    training = ~last[log.motion.rows]
    found = fit(model.drive, model.log, model.free, ties=model.ties, priors=known, training=training)
    left = log.residual(found.model, nuisances_of(found))[last]
    (plain,) = held_out_residuals(replace(log, regressors=_of_other_joints(log)), drive, [last])
    return HeldOut(
        "last 30 % of the motion", log.effort, log.units[0],
        float(np.sqrt(np.mean(left**2))), float(np.std(log.recorded[last])), float(np.sqrt(np.mean(plain**2))), int(last.sum()),
    )  # fmt: skip


def _of_other_joints(log: MotionLog) -> dict[str, Array]:
    """Return the regressors that are torques of other bodies."""
    return {name: each for name, each in log.regressors.items() if not name.startswith(RIPPLE)}


def _held_out(found: Fit, log: MotionLog, held_out: Sequence[Rows]) -> Iterator[Array]:
    """The residuals of each stretch, by what the rest of the log determines: a step of Gauss and Newton from the whole.

    Shapes of the friction curve, in which it is not linear, stay as the whole log has them, and so do numbers at a limit.
    """
    problem, x = solved_problem(found)
    (record,) = problem.records
    low, high = problem.limits().T
    moves = [
        each.path.rpartition(".")[2] not in SHAPES and not each.at_limit(value)
        for each, value in zip(problem.plan.unknowns, x.tolist(), strict=False)
    ]
    linear = np.array(moves + [True] * len(log.nuisances))
    ((predicted, slopes),) = problem.predict(x)
    left, rows = (log.measured - predicted)[0], slopes[:, 0].T
    before, right = problem.prior_rows()
    noise = float(np.std(left))
    size = np.linalg.norm(rows, axis=0)
    size[size == 0.0] = 1.0
    for stretch in held_out:
        keep = ~stretch[log.motion.rows]
        system = (np.concatenate([rows[keep], noise * before]) / size)[:, linear]
        step = np.linalg.lstsq(system, np.concatenate([left[keep], noise * (right - before @ x)]), rcond=MIN_SINGULAR)[0]
        there = x.copy()
        there[linear] += step / size[linear]
        there = np.clip(there, low, high)
        yield log.residual(record.model(there), there[record.nuisances])[stretch]
