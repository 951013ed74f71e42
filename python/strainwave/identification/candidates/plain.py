"""Plain least squares on a log: the simplest model of a joint, from which fits start and which no answer may be worse than.

It also determines the place at which the torque was measured, which decides which inertias and which friction the torque
contains. A torque of the motor accelerates the motor's rotor and the wave generator; one behind the motor the wave generator
alone; one behind the gear neither, and it contains no friction of the gear. The inertias of the start set are guesses. If all
that turns has less than they have, the torque was measured behind them, or they are smaller.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive
from strainwave.equality import ComparedByFields
from strainwave.files.recording import Recording
from strainwave.identification.experiments.friction_table import FRICTIONLESS
from strainwave.identification.experiments.motion import END_SAMPLES
from strainwave.identification.experiments.motion_log import FAST_QUANTILE, MIN_INERTIA, MotionLog, per_torque, turnover_speed
from strainwave.statistics.linear_fit import linear_fit, own_share, solved
from strainwave.statistics.scale import SIGNIFICANCE_SIGMA

Array = NDArray[np.float64]
Rows = NDArray[np.bool_]

STRETCH_ENDS = (0.0, 0.3, 0.7, 1.0)  # of the motion: each of the stretches between is held out once; the last 30 % are reported
MAX_RELATIVE_ERROR = 0.98  # of the held-out error of the simpler log: along a recorded speed, or with a delay, it must be less
MAX_DELAY_SAMPLES = 5  # of the log
MIN_SPEED = 0.01  # of a fast speed: the motion begins and ends where it is exceeded
MIN_SLIDING_SPEED = 0.1  # of a fast speed: slower samples show how friction begins, which plain least squares does not describe
MIN_OWN_SHARE_OF_SPEED = 0.1  # of the speed: if less differs from its sign, the record has one speed
MAX_ROWS_OF_SIGMA = 4000  # samples from which the standard deviation of an inertia is computed
BLOCKS_PER_STRETCH = 10  # over which the residual scatters
ROTOR_MARGIN = 1.2  # times the inertia of the rotor: a joint torque with less of it was measured behind the rotor
MIN_FRICTION_SHARE = 1e-3  # of the friction of the start set: a joint torque with less was measured behind the gear
MIN_FRICTION_OF_INPUT = 0.1  # of the friction of the start set: with less, a joint torque may lack the rotor (assumed)
NO_ROTOR = 10.0 * MIN_INERTIA  # kg.m2: a drive must have some, and MIN_INERTIA stands for a rotor that is not known
SHARE_OF_ROTOR = 0.5  # of all that turns, if the start set's rotor has more than that


@dataclass(frozen=True, eq=False)
class Plain(ComparedByFields):
    """Offset, inertia, gravity, Coulomb and viscous friction of a log by linear least squares, referred to the input.

    Attributes:
        inertia: of everything that turns [kg.m2]
        viscous: [N.m.s/rad]
        coulomb: [N.m]
        offset: [N.m]
        gravity: amplitude at the output [N.m]
        phase: of the gravity [rad]
        shares: of other bodies in the torque of the output, as many as the log has regressors [1]
        explained: share of the variation of the torque [1]
        sense: 1 if inertia is positive and friction brakes the motion, -1 if both are the other way round, as of an effort that
            is counted against the motion; between where they disagree, by their shares in the torque [1]
    """

    inertia: float
    viscous: float
    coulomb: float
    offset: float
    gravity: float
    phase: float
    shares: tuple[float, ...]
    explained: float
    sense: float


def from_motion_to_motion(log: MotionLog) -> Rows:
    """Return the sound samples from the first motion to the last, whatever the band of the log, shape (m,)."""
    speed = np.abs(log.motion.speed)
    fast = np.flatnonzero(speed > MIN_SPEED * np.quantile(speed, FAST_QUANTILE))
    rows = np.zeros(len(speed), bool)
    rows[fast[0] : fast[-1] + 1] = True
    return rows & log.sound


def moving(log: MotionLog) -> Rows:
    """Return the sound samples from the first motion to the last, without the ends that filters spoil, shape (m,)."""
    rows, spoilt = from_motion_to_motion(log), END_SAMPLES * log.motion.every
    rows[:spoilt] = rows[-spoilt:] = False
    return rows


def fit_plain(log: MotionLog, drive: Drive) -> Plain:
    """Fit a log by linear least squares, in the full band, at every sample from the first motion to the last.

    torque = J a + b v + c sgn v + o + (g_s sin q + g_c cos q) / i + shares of other bodies
    """
    columns, torque, rows = _columns(log, drive), _torque(log, drive), moving(log)
    weights = solved(columns[rows], torque[rows])
    left = (torque - columns @ weights)[rows]
    by_inertia, by_friction = columns[rows, 0] * weights[0], columns[rows, 1:3] @ weights[1:3]
    powers = np.array([np.mean(by_inertia**2), np.mean(by_friction**2)])
    senses = np.sign([weights[0], np.mean(by_friction * log.motion.speed[rows])])
    inertia, viscous, coulomb, offset = (float(each) for each in weights[:4])
    return Plain(
        inertia, viscous, coulomb, offset,
        float(np.hypot(*weights[4:6])),
        float(np.arctan2(weights[5], weights[4])),
        tuple(weights[6:].tolist()),
        1.0 - float(np.var(left) / max(float(np.var(torque[rows])), 1e-300)),
        float(senses @ powers / max(powers.sum(), 1e-300)),
    )  # fmt: skip


def one_speed(log: MotionLog) -> float:
    """Return the size of the speed of the input if a log has one only, so that friction has no shape over it; else 0 [rad/s].

    Coulomb and viscous friction are then one number: the speed is made up by its sign, a constant, and inertia.
    """
    motion = log.motion
    speed = motion.speed[motion.compared]
    columns = np.stack([speed, np.sign(speed), np.ones_like(speed), motion.acceleration[motion.compared]], axis=1)
    if len(speed) == 0 or own_share(columns)[0] > MIN_OWN_SHARE_OF_SPEED:
        return 0.0
    return float(np.median(np.abs(speed)))


def gravity_sigma(log: MotionLog, drive: Drive) -> float:
    """Return the standard deviation of gravity at the output with slow drift or curved friction as rivals [N.m].

    A motion over part of a turn does not separate a sine of the angle from what else changes slowly over it. The load hangs at
    the angle of the output. If that was not measured, the gear winds up by as much as the spring of the drive predicts, and the
    whole change of gravity by that is uncertain.
    """
    motion, ratio = log.motion, drive.gear.kinematics.ratio
    angle, speed, time = motion.output_angle(ratio), motion.speed, motion.time - float(np.mean(motion.time))
    sign = np.sign(speed)
    own = [np.sin(angle) / ratio, np.cos(angle) / ratio, motion.acceleration, speed, sign, np.ones_like(speed)]
    rivals = [time, time**2, speed * np.abs(speed), sign * np.sqrt(np.abs(speed)), sign * time]
    series = motion.filtered(np.stack([_torque(log, drive), *own, *rivals]))
    target, columns, others = series[0], series[1 : 1 + len(own)].T, series[1 + len(own) :].T
    regression = linear_fit(columns, target, rivals=others)
    amplitudes: Array = regression.values[:2]
    share = amplitudes / max(float(np.linalg.norm(amplitudes)), 1e-300)
    variance = float(share @ regression.covariance[:2, :2] @ share)
    if motion.wind_up is None:
        of_sine, of_cosine, inertia = regression.values[:3]
        torque = of_sine * np.sin(angle) + of_cosine * np.cos(angle) + ratio * inertia * motion.acceleration
        steepness = (of_sine * np.cos(angle) - of_cosine * np.sin(angle)) / ratio
        by_wind_up = motion.filtered((steepness * drive.gear.stiffness.twist(torque))[np.newaxis])[0]
        variance += float(share @ solved(columns, by_wind_up)[:2]) ** 2
    return float(np.sqrt(variance)) if variance >= 0.0 else np.inf  # nan of an infinite variance, too


def along_best_motion(log: MotionLog, recording: Recording, drive: Drive) -> tuple[MotionLog, bool]:
    """Return the log along its angle or its recorded speed, whichever predicts better; and True for the speed."""
    measured = log.with_measured_speed(recording, drive.gear.kinematics.ratio)
    if measured is None:
        return log, False
    is_better = held_out_rms(measured, drive) < MAX_RELATIVE_ERROR * held_out_rms(log, drive)
    return (measured, True) if is_better else (log, False)


def held_out_rms(log: MotionLog, drive: Drive) -> float:
    """Return the root mean square of what plain least squares leaves of stretches held out, in the unit of the effort."""
    return float(np.sqrt(np.mean(np.concatenate(held_out_residuals(log, drive, stretches(log))) ** 2)))


def best_delay(log: MotionLog, drive: Drive) -> float:
    """Return the delay of the effort behind the motion, in whole samples, with which plain least squares predicts best [s].

    0 unless it predicts clearly better than without.
    """
    errors = {}
    for shift in range(-MAX_DELAY_SAMPLES, MAX_DELAY_SAMPLES + 1):
        series = {name: np.roll(getattr(log, name), -shift) for name in ("force", "recorded", "sound")}
        errors[shift] = held_out_rms(replace(log, **series), drive)
    best = min(errors, key=lambda shift: errors[shift])
    return best * log.motion.step if errors[best] < MAX_RELATIVE_ERROR * errors[0] else 0.0


def stretches(log: MotionLog) -> list[Rows]:
    """Return the contiguous stretches of the motion that are held out in turn, the last 30 % at the end, shape (m,) each."""
    places = np.flatnonzero(moving(log))
    ends = [places[0] + round(share * (places[-1] + 1 - places[0])) for share in STRETCH_ENDS]
    every = np.arange(len(log.motion.time))
    return [(every >= begin) & (every < end) & log.sound for begin, end in pairwise(ends)]


def held_out_residuals(log: MotionLog, drive: Drive, blocks: Sequence[Rows]) -> list[Array]:
    """Return what plain least squares leaves of the effort in each block by the rest of the motion, each of shape (block,)."""
    columns, torque, rows = _columns(log, drive), _torque(log, drive), moving(log)
    scale, residuals = abs(per_torque(drive, log.effort)), []
    for block in blocks:
        weights = solved(columns[rows & ~block], torque[rows & ~block])
        residuals.append(scale * (torque - columns @ weights)[block])
    return residuals


def sliding_squares(log: MotionLog, drive: Drive) -> tuple[Array, Array]:
    """Return the sum of squares of what plain least squares leaves of each block of the motion, and the samples of each block.

    Samples of sliding alone are fitted and compared; each stretch is predicted by the others. Squares are over the variance of
    the effort, so that they compare whatever its unit and sign, shape (blocks,) each.
    """
    columns, torque, speed = _columns(log, drive), _torque(log, drive), np.abs(log.motion.speed)
    rows = moving(log) & (speed > MIN_SLIDING_SPEED * np.quantile(speed, FAST_QUANTILE))
    variance = max(float(np.var(torque[moving(log)])), 1e-300)
    squares, samples = list[float](), list[int]()
    for stretch in stretches(log):
        others = rows & ~stretch
        left = (torque - columns @ solved(columns[others], torque[others])) ** 2 / variance
        for block in np.array_split(np.flatnonzero(stretch), BLOCKS_PER_STRETCH):
            squares.append(float(left[block[rows[block]]].sum()))
            samples.append(int(rows[block].sum()))
    return np.array(squares), np.array(samples)


def _columns(log: MotionLog, drive: Drive) -> Array:
    motion, ratio = log.motion, drive.gear.kinematics.ratio
    angle = motion.output_angle(ratio)
    sign = np.tanh(motion.speed / turnover_speed(motion.speed))
    offset = np.full_like(angle, float(log.both_ways))  # which one direction alone does not separate from friction
    series = [motion.acceleration, motion.speed, sign, offset, np.sin(angle) / ratio, np.cos(angle) / ratio]
    return np.stack([*series, *(each / ratio for each in log.regressors.values())], axis=1)


def _torque(log: MotionLog, drive: Drive) -> Array:
    """The torque of the motor at the input without what is known of it, on the grid [N.m]."""
    torque = (log.recorded - log.induced(drive)) / per_torque(drive, log.effort)
    return np.asarray(torque - log.extra / drive.gear.kinematics.ratio)


# ---- Place of the torque ---------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class TorquePlace:
    """The part of a drive that a torque accelerates.

    Attributes:
        drive: with the inertias that the torque contains
        open_inertia: inertia at the input that the torque may contain or not [kg.m2]; 0 if the record decides
        has_friction: False if the torque contains no friction of the gear
        remark: what was decided and why; empty if the torque is that of the motor, as is assumed
    """

    drive: Drive
    open_inertia: float = 0.0
    has_friction: bool = True
    remark: str = ""


def torque_place(log: MotionLog, drive: Drive, motor_given: bool = False) -> TorquePlace:
    """Return the place at which the torque of a log was measured, by the sizes of its inertia and friction.

    Args:
        log: of the torque
        drive: with the inertias of motor and gear, and the friction of the gear, as guessed before
        motor_given: True if a person knows the motor's inertia, so that the torque is that of the motor; that of the gear is
            a guess all the same
    """
    ratio, motor, gear = drive.gear.kinematics.ratio, drive.motor.inertia, drive.gear.input_inertia
    columns, torque, rows = _columns(log, drive), _torque(log, drive), moving(log)
    every = max(int(rows.sum()) // MAX_ROWS_OF_SIGMA, 1)
    by_regression = linear_fit(columns[rows][::every], torque[rows][::every])
    inertia, sigma = float(by_regression.values[0]), float(by_regression.sigma[0])
    rotor, total = motor + gear, max(inertia + SIGNIFICANCE_SIGMA * sigma, 0.0)  # no more than that turns
    sizes = f"all that turns has {inertia * ratio**2:.3g} kg·m² at the output, the rotor {rotor * ratio**2:.3g} kg·m²"
    if motor_given:
        rest = max(inertia - motor, 0.0)
        if total >= rotor or total < motor:
            return TorquePlace(drive)
        return TorquePlace(
            _with_rotor(drive, motor, SHARE_OF_ROTOR * rest), total - motor,
            remark=f"{sizes}: that of the start set's wave generator is too large; the load's is not separable from it",
        )  # fmt: skip
    if log.effort == "joint_torque":
        plain, speed = fit_plain(log, drive), float(np.median(np.abs(log.motion.speed[moving(log)])))
        before = float(drive.gear.friction_input.steady(speed))
        share = max(plain.coulomb + plain.viscous * speed, 0.0) / before if before > 0.0 else 1.0
        if share < MIN_FRICTION_SHARE or total < ROTOR_MARGIN * rotor:
            why = "it contains no friction of the gear" if share < MIN_FRICTION_SHARE else sizes
            behind = _with_rotor(drive, NO_ROTOR, 0.0)
            return TorquePlace(
                behind if share >= MIN_FRICTION_SHARE else frictionless(behind),
                0.0 if total < rotor else rotor, share >= MIN_FRICTION_SHARE,
                f"{log.effort} was measured behind the rotor: {why}; the load's inertia is all that it contains",
            )  # fmt: skip
        return TorquePlace(drive, rotor if share < MIN_FRICTION_OF_INPUT else 0.0)
    if log.effort == "input_torque" and gear < total < rotor:
        return TorquePlace(
            _with_rotor(drive, NO_ROTOR, gear), motor, remark=f"{log.effort} was measured behind the motor's rotor: {sizes}"
        )
    if total >= rotor:
        return TorquePlace(drive)
    less = SHARE_OF_ROTOR * total / rotor
    return TorquePlace(
        _with_rotor(drive, less * motor, less * gear), total,
        remark=f"{sizes}: that of the start set is too large, or the torque was measured behind it; the inertia of the load is "
        "not separable from it",
    )  # fmt: skip


def _with_rotor(drive: Drive, motor: float, gear: float) -> Drive:
    """Return the drive with other inertias of motor and wave generator [kg.m2]."""
    return drive.replace(
        motor=drive.motor.replace(inertia=max(motor, MIN_INERTIA)), gear=drive.gear.replace(input_inertia=gear)
    )


def frictionless(drive: Drive) -> Drive:
    """Return the drive without friction at input and mesh, which a torque behind the gear does not contain."""
    return drive.replace(gear=drive.gear.replace(friction_input=FRICTIONLESS, friction_mesh=FRICTIONLESS))
