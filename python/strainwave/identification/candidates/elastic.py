"""Spring, hysteresis, damping and kinematic error of a gear by a log of the encoders at both of its sides.

The input is moved as it was measured, and the output of a model is compared with the measured one (`DrivenLog`). So neither
motor nor friction take part. The log determines ratios of the output stage: if inertia, gravity, stiffness, damping and
hysteresis were all twice as large, it would move in the same way. One torque must be known otherwise; the log along its motion
determines it, as gravity or inertia of the load (`candidates.motion`).

`elastic_starts` gives the initial values.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive, _core, kinematic_error, stiffness
from strainwave.equality import ComparedByFields
from strainwave.files.recording import Recording
from strainwave.identification.candidates.elastic_starts import UNREACHED_TORQUE, ElasticStart, elastic_starts
from strainwave.identification.candidates.motion_candidate import nuisances_of
from strainwave.identification.candidates.plain import MAX_DELAY_SAMPLES, MAX_RELATIVE_ERROR
from strainwave.identification.candidates.torsion.candidate import merged
from strainwave.identification.candidates.torsion.dissipation import maxwell, pairs
from strainwave.identification.experiments.drive_log import MAX_DRIVEN_CUTOFF_SHARE, DrivenLog
from strainwave.identification.experiments.friction_table import FRICTIONLESS
from strainwave.identification.experiments.motion import motion_of
from strainwave.identification.experiments.motion_log import MotionLog, inertia_of, transmitted_torque
from strainwave.identification.fitting.fit import ROUGH_TOLERANCE, Fit, fit_of, problem_of
from strainwave.identification.fitting.problem import Problem
from strainwave.identification.fitting.unknowns import Estimate, plan
from strainwave.statistics.linear_fit import linear_fit, order_waves, solved
from strainwave.statistics.residuals import correlation_length, is_white
from strainwave.statistics.scale import MIN_GAIN_SIGMA, sigmas_of_gain
from strainwave.statistics.spectrum import mean_power

Array = NDArray[np.float64]

TIME_BLOCKS = 10  # of a log, every second of which is held out while models are compared
COMPARED_TIME = 10.0  # s, of the part of a log on which models are compared
MAX_TIME = 40.0  # s, of a log to which the chosen model is fitted
MAX_STEP_OF_OUTPUT = 1e-3  # s, of the simulation
MAX_PHASE_STEP = 0.25  # rad, of the vibration of the output in a step, which changes its period by 3e-5 (RK4)
MIN_TWIST_SIGMA = 3.0  # standard deviations of the twist under load
MAX_RELATIVE_COST_AT_LAST = 1e-4  # of a step of the last fit: smaller steps move no number by a tenth of its deviation
MAX_STEPS_OF_FIT = 15  # steps of a fit
MAX_START_ERROR = 1.2  # times the smallest held-out error of the regressions: models beyond are not simulated
HELD_OUT_BLOCKS = 20  # of the data held out, over which the gain of a model scatters
MAX_CHANCE_ERROR = 1.1  # times the smallest held-out error: a larger one is never chance, as elements act at few reversals
MAX_CORRELATION_OF_NOISE = 2.0  # samples: residuals that correlate over more are an error of the model
SHARE_OF_LATER, LATER = 0.3, 2.5  # stiffness and slip of a further element over those of the one that is there (assumed)
MIN_RELATIVE_BEND = 0.02  # change of the stiffness at a knee (assumed)
MAX_STARTS = 4  # of the regressions that are simulated
MIN_SIGNAL = 4.0  # times the spectral density of the noise: motion, not chance
DIFFERENCES_OF_ANGLE = 3  # of the angle, whose spectra of motion and noise are compared
CUTOFF_MARGIN = 1.5  # cut-off over the highest frequency of the motion
PLACE_OF_SPEED = 2  # among the columns of the regression of the angle between the shafts
DELAY = "output_angle_delay"
LOAD_INERTIA, DAMPING_PATH = "load.inertia", "gear.damping"
BEGINNING_SHARES = (0.15, 0.3, 0.6)  # of a record, over which its vibration is followed (assumed)
SPRING, MEMORY = "gear.stiffness.", "gear.hysteresis."
GRAVITY_PATH = "load.gravity_torque"
FIRST_STIFFNESS = tuple(f"{SPRING}{name}" for name in ("k", "k1", "a1"))  # at zero twist, by the law
WAVE_PATHS = ("gear.kinematic_error.amplitude", "gear.kinematic_error.phase")
LEFT_OUT_BLOCKS = 12  # of a record, which differ in their motion


@dataclass(frozen=True, eq=False)
class ElasticCandidate(ComparedByFields):
    """A model of the gear fitted to the output of a log.

    Attributes:
        name: of spring and hysteresis
        fit: to the whole log
        sigmas: standard deviation of each estimate if the known torque is exact: by the fit, or by leaving out blocks of the
            log; with the distance to models that predict as well
        error: rms error of the output's angle on data held out [rad]
        twist: rms of the angle by which load and kinematic error turn the output [rad]
        reach: the largest torque that the gear transmits [N.m]
    """

    name: str
    fit: Fit
    sigmas: Array
    error: float
    twist: float
    reach: float

    @property
    def drive(self) -> Drive:
        """Fitted drive."""
        model: Drive = self.fit.model
        return model


def fit_elastic(
    recording: Recording, log: MotionLog, drive: Drive, scale: str, law: kinematic_error.Fourier
) -> ElasticCandidate:
    """Fit spring, hysteresis, damping and kinematic error between two encoders; return the simplest model of the best ones.

    Args:
        recording: `input_angle` and `output_angle`, which counts in the sense of the drive's ratio
        log: the same along its motion
        drive: with the load by the log along its motion, and the gear to start from
        scale: path of the number of that load that is taken as known, `load.gravity_torque` or `load.inertia`
        law: initial kinematic error, whose orders are fitted

    Raises:
        ValueError: noise hides the twist under load, or no model moves as the output does
        FloatingPointError: no model could be simulated
    """
    reach, late = _reach(recording, log, drive, law)
    gear = drive.gear.replace(friction_input=FRICTIONLESS, friction_mesh=FRICTIONLESS, kinematic_error=law)
    rigid = transmitted_torque(log, drive), late * log.motion.speed / gear.kinematics.ratio
    blocks = _training_blocks(log.motion.time)
    starts = elastic_starts(recording, log, drive.replace(gear=gear), *rigid, blocks, by_gravity=scale == GRAVITY_PATH)
    if abs(late) < MAX_DELAY_SAMPLES * log.motion.step:
        late_output = _fitted(recording, log, starts, scale, reach, delayed=True)
        delay = next(each.value for each in late_output.fit.estimates if each.path == DELAY)
        if abs(delay) < MAX_DELAY_SAMPLES * log.motion.step:
            return late_output
    return _fitted(recording, log, starts, scale, reach, delayed=False)


def _fitted(
    recording: Recording, log: MotionLog, starts: Sequence[ElasticStart], scale: str, reach: float, *, delayed: bool
) -> ElasticCandidate:
    """Return the simplest model that predicts as well as any; `delayed`: a delay of the output angle is an unknown."""
    drive = starts[0].drive
    compared = _compared(_stretch(recording, log, drive, COMPARED_TIME), log, drive, delayed=delayed)
    best, rivals = _chosen(compared, starts, scale, reach)
    whole = _compared(_stretch(recording, log, drive, MAX_TIME), log, best.drive, delayed=delayed)
    nuisances = best.nuisances if len(whole.time) == len(compared.time) else None  # a longer log begins elsewhere
    problem, x = _solved(whole, best.drive, best.free, None, MAX_RELATIVE_COST_AT_LAST, nuisances)
    whole_fit = fit_of(problem, x, problem.weights(x))
    sigmas = sigma_by_blocks(problem, x, whole_fit.estimates)
    apart = np.array([max((_apart(each.path, best, rival) for rival in rivals), default=0.0) for each in whole_fit.estimates])
    twist = float(np.std(whole.measured[0] - whole.angle / drive.gear.kinematics.ratio))
    reached = float(np.abs(whole.gear_torque(whole_fit.model, nuisances_of(whole_fit))).max())
    return ElasticCandidate(best.name, whole_fit, np.hypot(sigmas, apart), best.error, twist, reached)


def _reach(recording: Recording, log: MotionLog, drive: Drive, law: kinematic_error.Fourier) -> tuple[float, float]:
    """Return the largest torque along the rigid motion [N.m], and the delay of the output angle [s].

    The angle between the shafts is regressed on that torque, with orders, direction and speed, in the pass band of the log.

    Raises:
        ValueError: noise hides the twist
    """
    motion, ratio = log.motion, drive.gear.kinematics.ratio
    torque = transmitted_torque(log, drive)
    angles = recording.values("input_angle", "rad"), recording.values("output_angle", "rad")
    error = np.interp(motion.time, recording.time, angles[0] / ratio - angles[1])
    others = [torque, np.sign(motion.speed), motion.speed, np.ones_like(torque)]
    columns = motion.filtered(np.stack([*others, *order_waves(motion.angle, law.order).T])).T
    measured = motion.filtered(error[np.newaxis] - error.mean())[0]
    regression = linear_fit(columns, measured)
    softness, sigma = float(regression.values[0]), float(regression.sigma[0])
    reach = float(np.abs(torque[motion.compared]).max())
    late = ratio * regression.values[PLACE_OF_SPEED]
    if not softness > MIN_TWIST_SIGMA * sigma:
        raise ValueError(
            f"up to {reach:.3g} N·m wind the gear up by {softness * reach:.2g} ± {sigma * reach:.2g} rad, where encoders and "
            f"other effects leave {regression.rms:.2g} rad unexplained, and output_angle is {1e3 * late:.3g} ms behind: "
            "load it more, or measure the angles better"
        )
    return reach, float(late)


def _compared(recording: Recording, log: MotionLog, drive: Drive, *, delayed: bool) -> DrivenLog:
    """Return the output of a recording, late or not, in steps as short as the output of a drive vibrates.

    Torque and speed at its beginning are unknowns that start at those of the measured motion: an error of either makes a load
    without damping vibrate for ever, for which a fit makes up by gravity, inertia and hysteresis that are not there. The
    vibration has at most the torque that moves the rigid load.
    """
    gear: Any = drive.gear
    stiff, inertia = gear.stiffness.tangent(0.0) + sum(gear.hysteresis.stiffness), inertia_of(drive)
    step = min(MAX_STEP_OF_OUTPUT, MAX_PHASE_STEP * float(np.sqrt(inertia / stiff)))
    rigid = transmitted_torque(log, drive)
    output = motion_of(recording.time, recording.values("output_angle", "rad"), log.motion.cutoff)
    initial = {"torque": float(np.interp(recording.time[0], log.motion.time, rigid)), "output_speed": float(output.speed[0])}
    compared = DrivenLog.of(recording, drive, ["output_angle"], step, initial, _cutoff_of_signal(recording))
    largest = float(np.abs(rigid).max())
    compared = compared.with_unknown_begin(largest, largest / float(np.sqrt(stiff * inertia)))
    return compared.with_delays("output_angle") if delayed else compared


def _cutoff_of_signal(recording: Recording) -> float | None:
    """Return the cut-off above which the input angle is noise [Hz]; None if motion fills the band that samples can follow.

    Noise of the input makes a simulated output vibrate: a fit makes up for it by damping and hysteresis that are not there.
    Third differences are compared: a slow motion of angle or speed leaks by the window over the noise, up to the resonance.
    """
    step = float(np.median(np.diff(recording.time)))
    grid = np.arange(recording.time[0], recording.time[-1], step)
    angle = np.interp(grid, recording.time, recording.values("input_angle", "rad"))
    frequency, power = mean_power(np.diff(angle, DIFFERENCES_OF_ANGLE), len(angle) // 8)
    of_white = (2.0 * np.sin(np.pi * frequency)) ** (2 * DIFFERENCES_OF_ANGLE)
    upper = frequency > 0.25  # as in `spectra`: white noise alone
    noise = of_white * float(np.median(power[upper] / of_white[upper]))
    signal = frequency[power > MIN_SIGNAL * noise] / step
    cutoff = CUTOFF_MARGIN * float(signal.max(initial=0.0))
    return cutoff if 0.0 < cutoff < MAX_DRIVEN_CUTOFF_SHARE / step else None


def _stretch(recording: Recording, log: MotionLog, drive: Drive, length: float) -> Recording:
    """Return the part of a log, of this length [s] if the log is much longer, in which the torque varies most."""
    time = recording.time - recording.time[0]
    if time[-1] <= 1.5 * length:
        return recording
    grid, torque = log.motion.time - log.motion.time[0], transmitted_torque(log, drive)
    begins = np.arange(0.0, time[-1] - length, 0.25 * length)
    spreads = [float(np.std(torque[(grid >= begin) & (grid < begin + length)])) for begin in begins]
    begin = begins[int(np.argmax(spreads))]
    rows = (time >= begin) & (time <= begin + length)
    return Recording(
        {name: recording[name][rows] for name in recording.names}, {name: recording.unit(name) for name in recording.names}
    )


# ---- Models ----------------------------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class _TriedModel(ComparedByFields):
    """A model fitted to a part of the log: its name, free paths, drive, nuisances, and residuals on data held out [rad]."""

    name: str
    free: tuple[str, ...]
    drive: Drive
    nuisances: Array
    left: Array

    @cached_property
    def error(self) -> float:
        """Root mean square error on data held out [rad]."""
        return float(np.sqrt(np.mean(self.left**2)))

    def predicts_as_well_as(self, other: _TriedModel) -> bool:
        """True if its squared residuals are larger by no more than chance over the record makes, or by nearly nothing."""
        losses = np.array([each.mean() for each in np.array_split(self.left**2 - other.left**2, HELD_OUT_BLOCKS)])
        by_chance = self.error <= MAX_CHANCE_ERROR * other.error and sigmas_of_gain(losses) < MIN_GAIN_SIGMA
        return MAX_RELATIVE_ERROR * self.error <= other.error or by_chance

    @cached_property
    def values(self) -> dict[str, float]:
        """Fitted numbers by path."""
        return {path: value for path, value, *_ in _core.parameters(self.drive) if path in self.free}

    @property
    def springs(self) -> tuple[str, ...]:
        """Paths of the numbers of the spring."""
        return tuple(path for path in self.free if path.startswith(SPRING))

    @property
    def elements(self) -> int:
        """Count of the elements of hysteresis."""
        return sum(path.startswith(f"{MEMORY}breakaway") for path in self.free)


def _chosen(log: DrivenLog, starts: Sequence[ElasticStart], scale: str, reach: float) -> tuple[_TriedModel, list[_TriedModel]]:
    """Return the model with the fewest numbers of those that predict best, and those that predict as well.

    Springs and counts of elements are compared together, as a bend of the spring and an element can imitate each other.
    """
    near = [each for each in starts if each.error < MAX_START_ERROR * starts[0].error][:MAX_STARTS]
    tried = [model for each in near if (model := _with(log, each.drive, scale, reach)) is not None]
    if not tried:
        raise ValueError("no spring and hysteresis moves the output as it was measured")
    best = _simplest(log, tried, scale, reach)
    if drive := _with_later_element(best):
        more = _with(log, drive, scale, reach, best.nuisances)
        if more and more.error < best.error:
            tried.append(more)
            best = _simplest(log, tried, scale, reach)
    least = min(tried, key=lambda each: each.error)
    return best, [each for each in tried if each is not best and each.predicts_as_well_as(least)]


def _simplest(log: DrivenLog, tried: list[_TriedModel], scale: str, reach: float) -> _TriedModel:
    """Return the model with the fewest numbers of those that predict best; models with fewer are tried, and join the others."""
    best = min(tried, key=lambda each: each.error)
    while True:
        models = [_with(log, drive, scale, reach, best.nuisances) for drive in _simpler(best.drive, reach)]
        simpler = [model for model in models if model is not None]
        tried += simpler
        least = min(tried, key=lambda each: each.error)
        good = [each for each in tried if each.predicts_as_well_as(least)]
        before, best = best, min(good, key=lambda each: (len(each.free), each.error))
        if best is before or not any(best is each for each in simpler):
            return best


def _with_later_element(best: _TriedModel) -> Drive | None:
    """Return the drive with an element more, which slips later, if one stands for two: what it leaves correlates; else None."""
    gear: Any = best.drive.gear
    elements = pairs(gear)
    if len(elements) != 1 or correlation_length(best.left) < MAX_CORRELATION_OF_NOISE:
        return None
    ((k, f),) = elements
    later = maxwell([(k, f), (SHARE_OF_LATER * k, SHARE_OF_LATER * LATER * f)])
    return best.drive.replace(gear=gear.replace(hysteresis=later))


def _simpler(drive: Drive, reach: float) -> Iterator[Drive]:
    """Yield the drive with one bend of its spring less, and with one element less."""
    gear: Any = drive.gear
    spring = gear.stiffness
    if isinstance(spring, stiffness.ThreeSegment) and spring.t2 < reach:
        first = abs(spring.k2 - spring.k1) > abs(spring.k3 - spring.k2)  # the larger bend stays
        beyond = (reach - spring.t1) / ((spring.t2 - spring.t1) / spring.k2 + (reach - spring.t2) / spring.k3)
        t1, k2 = (spring.t1, beyond) if first else (spring.t2, spring.k3)
        two = stiffness.ThreeSegment(k1=spring.k1, k2=k2, k3=k2, t1=t1, t2=UNREACHED_TORQUE)
        yield drive.replace(gear=gear.replace(stiffness=two))
    if not isinstance(spring, stiffness.Linear):
        yield drive.replace(gear=gear.replace(stiffness=stiffness.Linear(k=float(spring.tangent(0.0)))))
    if len(gear.hysteresis.stiffness) > 1:
        yield drive.replace(gear=merged(gear))
    elif len(gear.hysteresis.stiffness):
        yield drive.replace(gear=gear.replace(hysteresis=maxwell([])))


def _apart(path: str, one: _TriedModel, other: _TriedModel) -> float:
    """Return the distance of a number of the gear in two models that predict alike; 0 if the other model has none alike.

    Numbers of elements are compared if both models have as many, those of a spring but its stiffness at zero twist if both have
    that kind.
    """
    if path.startswith(MEMORY) and one.elements != other.elements:
        return 0.0
    if path not in FIRST_STIFFNESS:
        alike = not path.startswith(SPRING) or one.springs == other.springs
        there = other.values.get(path) if alike else None
    else:
        there = next((other.values[each] for each in FIRST_STIFFNESS if each in other.values), None)
    return abs(one.values[path] - there) if path in one.values and there is not None else 0.0


def _with(log: DrivenLog, drive: Drive, scale: str, reach: float, nuisances: Array | None = None) -> _TriedModel | None:
    """Return the model fitted from a start; None if it leaves what its law allows, or if a knee of its spring shows nothing."""
    free, training = tuple(_free(drive, scale, reach)), _training_blocks(log.time)
    try:
        problem, x = _solved(log, drive, free, training, ROUGH_TOLERANCE, nuisances)
        fitted: Any = problem.records[0].model(x)
        fitted = fitted.replace(gear=fitted.gear.replace(hysteresis=maxwell(pairs(fitted.gear))))
        ((predicted, _),) = problem.predict(x)
    except (ValueError, FloatingPointError):
        return None
    if not _bends_within(fitted.gear.stiffness, reach):
        return None
    count = len(fitted.gear.hysteresis.stiffness)
    name = f"{fitted.gear.stiffness.name.replace('_', ' ')} spring, {count} Maxwell element{'s' if count > 1 else ''}"
    return _TriedModel(name, free, fitted, x[problem.records[0].nuisances], (log.measured - predicted)[0, ~training])


def _bends_within(spring: Any, reach: float) -> bool:
    """True if a spring bends visibly at each of its knees within a torque [N.m]; a knee that does not bend has no place."""
    if not isinstance(spring, stiffness.ThreeSegment):
        return True
    bends = [spring.k2 / spring.k1, *([spring.k3 / spring.k2] if spring.t2 < reach else [])]
    return spring.t1 <= reach and all(abs(bend - 1.0) > MIN_RELATIVE_BEND for bend in bends)


def _training_blocks(time: Array) -> NDArray[np.bool_]:
    """Return True for instants [s] in every second block of time, shape (n,)."""
    block = np.minimum((TIME_BLOCKS * (time - time[0]) / (time[-1] - time[0])).astype(int), TIME_BLOCKS - 1)
    training: NDArray[np.bool_] = block % 2 == 0
    return training


def _solved(
    log: DrivenLog,
    drive: Drive,
    free: Sequence[str],
    training: NDArray[np.bool_] | None,
    tolerance: float,
    nuisances: Array | None,
) -> tuple[Problem, Array]:
    """Return the least squares of a log of one channel, whose weight changes nothing, and the unknowns that solve it.

    The nuisances are initial values: those of another model of the same log.

    A natural frequency that gains or loses a period over the record is a minimum of its own, and regressions do not determine
    it as well as that. While residuals are not white, the fit starts again from longer and longer beginnings of the record: by
    inertia and damping, which make up for errors of the frequency; by all numbers, as that of a bent spring varies with the
    amplitude.
    """
    problem = problem_of(plan(drive, [""], free), drive, [log], [training])
    weights, inertia = problem.first_weights(), next(path for path in (LOAD_INERTIA, *FIRST_STIFFNESS) if path in free)
    begin = problem.start()
    if nuisances is not None:
        begin[problem.records[0].nuisances] = nuisances
    x = problem.solve(begin, weights, tolerance, trials=MAX_STEPS_OF_FIT)
    for tuned in ([inertia, DAMPING_PATH], free):
        if is_white(problem.residuals(x)[0][0]):
            break
        with suppress(ValueError, FloatingPointError):  # a beginning of too few samples, or one that the model leaves
            in_phase = _in_phase(problem, log, drive, begin, tuned)
            other = problem.solve(in_phase, weights, tolerance, trials=MAX_STEPS_OF_FIT)
            x = min(x, other, key=lambda unknowns: problem.cost(unknowns, weights))
    return problem, x


def _in_phase(problem: Problem, log: DrivenLog, drive: Drive, begin: Array, tuned: Sequence[str]) -> Array:
    """Return initial unknowns with these numbers and the unknowns of the measurement fitted to beginnings of a record."""
    whole, paths = begin.copy(), [unknown.path for unknown in problem.plan.unknowns]
    known = plan(drive, [""], tuned)
    first, last = log.time[[0, -1]].tolist()
    places = [*(paths.index(unknown.path) for unknown in known.unknowns), *range(len(paths), len(whole))]
    for share in BEGINNING_SHARES:
        beginning = problem_of(known, drive, [log.beginning(first + share * (last - first))], [None])
        whole[places] = beginning.solve(whole[places], beginning.first_weights(), ROUGH_TOLERANCE, trials=MAX_STEPS_OF_FIT)
    return whole


def _free(drive: Drive, scale: str, reach: float) -> Iterator[str]:
    """Yield the paths of the unknown numbers of the output stage; those beyond the largest torque are not determined."""
    spring = drive.gear.stiffness
    beyond = ("k3", "t2") if isinstance(spring, stiffness.ThreeSegment) and spring.t2 > reach else ()
    kept = {f"{SPRING}{name}" for name in beyond} | {scale}
    for path, *_ in _core.parameters(drive):
        if path.startswith((SPRING, MEMORY, *WAVE_PATHS, "gear.damping", "load.")) and path not in kept:
            yield path


# ---- Standard deviations ---------------------------------------------------------------------------------------------


def sigma_by_blocks(problem: Problem, x: Array, estimates: Sequence[Estimate]) -> Array:
    """Return the standard deviation of each estimate, shape (p,): that of the fit, or of the jackknife if it is larger.

    The covariance of a fit takes residuals for noise. If the model lacks something, residuals depend on the motion, and
    estimates change from one part of a record to another by more than noise moves them. The jackknife contains that (Tukey
    1958; over blocks of correlated series: Künsch 1989). Each step is one of Gauss and Newton, so that nothing is simulated
    again. It does not contain an error that moves all blocks alike.

    Args:
        problem: least squares
        x: the unknowns that solve it
        estimates: of the unknowns, none of them tied to another
    """
    weights = problem.weights(x)
    jacobian, (of_priors, _) = problem.jacobian(x, weights), problem.prior_rows()
    residuals = problem.residuals(x)
    left = np.concatenate([(each.rows * row).ravel() for each, row in zip(weights, residuals, strict=True)])
    place = np.concatenate([np.tile(np.arange(row.shape[1]) * LEFT_OUT_BLOCKS // row.shape[1], len(row)) for row in residuals])
    size = np.linalg.norm(np.concatenate((jacobian, of_priors)), axis=0)
    size = np.where(size > 0.0, size, 1.0)
    rows, before = jacobian / size, of_priors / size
    whole, moved = rows.T @ rows + before.T @ before, rows.T @ left
    steps = []
    for block in range(LEFT_OUT_BLOCKS):
        here = place == block
        rest = whole - rows[here].T @ rows[here]
        steps.append(solved(rest, moved - rows[here].T @ left[here]) / size)
    off = np.array(steps) - np.mean(steps, axis=0)
    by_blocks = np.sqrt((LEFT_OUT_BLOCKS - 1) / LEFT_OUT_BLOCKS * np.sum(off**2, axis=0))
    sigmas: Array = np.maximum(np.array([each.sigma for each in estimates]), by_blocks)
    return sigmas
