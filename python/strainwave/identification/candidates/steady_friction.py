"""Friction of runs at constant speed: levels of torque without gravity, over the motor's angle, over the temperature.

Over the angle it is that of the position control article, f = s1 q^2 + s2 q + s3 + b |v| + sum_k (a_k cos k q + b_k sin k q), k
up to 10 (equations of f_aver, f_peri and f_visc). It prints neither a_k and b_k nor B; a constant a_0 / 2 or B is the same as
s3 (its erratum 9).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from strainwave import arguments
from strainwave.analysis.branches import thinned
from strainwave.equality import ComparedByFields
from strainwave.files.recording import Recording, check_recording
from strainwave.friction import PositionDependent
from strainwave.identification.candidates.steady_shapes import MIN_TEMPERATURE_SPAN
from strainwave.identification.experiments.experiment import sensible
from strainwave.identification.fitting.unknowns import Estimate
from strainwave.statistics.covariance import covariance_of, posterior_of
from strainwave.statistics.linear_fit import normal_inverse, solved
from strainwave.statistics.residuals import chance_of_gain, correlation_length, shape
from strainwave.statistics.scale import ONE_SIGMA, noise_sigma, student

Array = NDArray[np.float64]

MAX_CHANGE = 0.05  # of the speed of a stretch, besides its irregularity
IRREGULARITY_SIGMA = 3.0  # of the speed over the middle of a stretch: a larger difference at an end is acceleration
MAX_CURVATURE = 0.8  # share of the variation of the speed that a parabola explains: more is an oscillation
MAX_BACKWARD = 0.1  # of the way: a record one way does not go back by more
MIN_MOVING_SPEED = 0.05  # of the largest speed of a record: slower parts rest
MIN_MOTION_SIGMA = 8.0  # of the noise of the angle, by which a shaft moves over a part of the record
MEAN_SPEED_PARTS = 50  # of a record, each with a mean speed
MIN_ROWS_OF_RECORD = 40  # of a record whose angle determines speeds
MIN_ROWS_OF_STRETCH = 20
MIN_STEADY_SHARE = 0.5  # of the moving time, that stretches at constant speed fill; a record that has less is a log
MAX_ROWS_OF_LEVEL = 2_000  # of a stretch, of which its level is found; a longer one is thinned
MIN_GRAVITY_ANGLE = 0.2  # rad: over less gravity is a constant
ASYMMETRY_SIGMA = 0.1  # relative, of the friction of one direction to that of the other (assumed)
MAX_CHANCE_OF_GRAVITY = 1e-3  # probability that chance explains as much as gravity does
MAX_CHANGE_OF_GRAVITY = 0.1  # by a wave of order two: beyond, a residual with a shape is that of another load
MAX_LEVEL_SIGMA = 0.5  # of a level over the usual level: beyond, gravity cannot be separated from it
FULL_TURN = 2.0 * np.pi  # rad
ORDER_COUNT = 10  # harmonics of the position control article, and of the law
MIN_SAMPLES_PER_PERIOD = 4  # of the highest order
BLOCK_LENGTHS = (10, 30, 100)  # samples that may err together
MIN_BLOCKS = 10  # for a variance


# ---- Levels of stretches at constant speed ---------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Levels:
    """Torques at constant speed, one a stretch, and gravity, which acts besides.

    Attributes:
        torque: level of each stretch without gravity, or its mean if gravity is not determined [N.m], shape (n,)
        covariance: of the levels [N2.m2], shape (n, n)
        cosine, sine: gravity c cos q + s sin q over the angle [N.m]; 0 if it is not determined
        gravity_sigma: standard deviations of both; None if gravity is not determined
    """

    torque: Array
    covariance: Array
    cosine: float = 0.0
    sine: float = 0.0
    gravity_sigma: tuple[float, float] | None = None

    @property
    def sigma(self) -> Array:
        """Standard deviation of each level [N.m], shape (n,)."""
        return np.sqrt(np.diag(self.covariance))


def constant_speeds(time: Array, angle: Array) -> list[slice]:
    """Return the rows of each stretch at constant speed; none if the record is a log of other motion.

    Slow motion may be irregular: a speed counts as constant if it changes at the ends of a stretch by no more than over its
    middle, and if its change is no bow, as that of a sine between two reversals.

    >>> time = np.linspace(0.0, 10.0, 1001)
    >>> constant_speeds(time, np.clip(0.5 * (time - 2.0), 0.0, 3.0))
    [slice(212, 789, None)]
    >>> constant_speeds(time, np.sin(time))
    []
    """
    rows = len(time)
    if rows < MIN_ROWS_OF_RECORD:
        return []
    apart = max(rows // MEAN_SPEED_PARTS, 1)
    ahead = np.arange(rows - apart)
    elapsed = np.maximum(time[ahead + apart] - time[ahead], 1e-300)
    speed = (angle[ahead + apart] - angle[ahead]) / elapsed
    least = MIN_MOTION_SIGMA * noise_sigma(angle) / float(np.median(elapsed))
    moving = np.abs(speed) > max(MIN_MOVING_SPEED * float(np.abs(speed).max()), least)
    ways = np.where(moving, np.sign(speed), 0.0)
    there = np.flatnonzero(ways)
    if not len(there):
        return []
    turns = np.flatnonzero(np.diff(ways[there]) != 0.0)
    ends = [0, *(turns + 1).tolist(), len(there)]
    pieces = [slice(int(there[first]), int(there[last - 1]) + apart + 1) for first, last in pairwise(ends)]
    moved = sum(float(time[piece.stop - 1] - time[piece.start]) for piece in pieces)
    stretches = [part for piece in pieces if (part := _constant(time, angle, piece)) is not None]
    steady = sum(float(time[part.stop - 1] - time[part.start]) for part in stretches)
    turned = [float(angle[piece.stop - 1] - angle[piece.start]) for piece in pieces]
    one_way = abs(sum(turned)) > (1.0 - MAX_BACKWARD) * sum(map(abs, turned))
    return stretches if one_way and steady >= MIN_STEADY_SHARE * moved else []


def _constant(time: Array, angle: Array, piece: slice) -> slice | None:
    """Return the part of one way at constant speed; None if there is none."""
    t, q = time[piece], angle[piece]
    if len(t) < MIN_ROWS_OF_STRETCH:
        return None
    apart = max(len(t) // MEAN_SPEED_PARTS, 1)
    middle = 0.5 * (t[apart:] + t[:-apart])
    speed = (q[apart:] - q[:-apart]) / np.maximum(t[apart:] - t[:-apart], 1e-300)
    fifth = len(speed) // 5
    usual = speed[fifth : len(speed) - fifth]
    level, spread = float(np.median(usual)), float(np.std(usual))
    steady = np.abs(speed - level) <= max(MAX_CHANGE * abs(level), IRREGULARITY_SIGMA * spread)
    first, last = int(np.argmax(steady)), len(steady) - int(np.argmax(steady[::-1]))
    way = np.sign(level) * q[first : last + apart]
    if last - first < MIN_ROWS_OF_STRETCH or np.max(np.maximum.accumulate(way) - way) > MAX_BACKWARD * np.ptp(way):
        return None
    u = middle[first:last] - middle[first:last].mean()
    left = speed[first:last] - np.polyval(np.polyfit(u, speed[first:last], 2), u)
    varied = float(np.var(speed[first:last]))
    if np.sqrt(varied) > MAX_CHANGE * abs(level) and 1.0 - np.var(left) / varied > MAX_CURVATURE:
        return None
    return slice(piece.start + first + apart, piece.start + last)  # without a part at each end, which may hide acceleration


def levels_of(torques: Sequence[Array], angles: Sequence[Array | None], speeds: Array) -> Levels:
    """Return the level of the torque of each stretch, with gravity over the angle taken out if the stretches determine it.

    Gravity is one wave over the angle for all stretches: their angles must count from one zero. Friction may vary over the
    angle, too, so that motion one way does not separate them. Short stretches at one place determine only the sum of gravity
    and of a friction that differs between the directions. Therefore levels at equal speeds both ways are taken to be equal
    within 10 % (assumed). A load of another order over the angle is no gravity, if the residual shows it.

    Args:
        torques: of each stretch [N.m]
        angles: of the joint at these torques [rad]; None if it was not measured
        speeds: of each stretch, with its sign [rad/s], shape (n,)
    """
    shorter = [_shorter(torque, angle) for torque, angle in zip(torques, angles, strict=True)]
    alone = _means(torques)
    measured_angles = [angle for _, angle in shorter if angle is not None]
    if len(measured_angles) < len(shorter) or np.ptp(np.concatenate(measured_angles)) < MIN_GRAVITY_ANGLE:
        return alone
    levels, left, before = _with_gravity(shorter, speeds, _symmetry(speeds, alone.torque))
    entangled = levels.sigma.max() > MAX_LEVEL_SIGMA * float(np.median(np.abs(levels.torque)))
    by_chance = _chance(before, left, len(shorter) + 4) > MAX_CHANCE_OF_GRAVITY
    return alone if entangled or by_chance or _is_another_load(shorter, levels, left) else levels


def _is_another_load(stretches: Sequence[tuple[Array, Array | None]], levels: Levels, left: Sequence[Array]) -> bool:
    """True if the residual has a shape over the angle, and its wave of order two moves gravity by more than a tenth."""
    angle, residual = np.concatenate([angle for _, angle in stretches if angle is not None]), np.concatenate(left)
    of_residual = shape(residual, angle)
    if of_residual is None or of_residual.chance > MAX_CHANCE_OF_GRAVITY:
        return False
    columns = np.repeat(np.eye(len(left)), [len(part) for part in left], axis=0)
    waves = [wave(order * angle) for order in (1.0, 2.0) for wave in (np.cos, np.sin)]
    moved = solved(np.column_stack((columns, *waves)), residual)[len(left) : len(left) + 2]
    return bool(np.hypot(*moved) > MAX_CHANGE_OF_GRAVITY * np.hypot(levels.cosine, levels.sine))


def _means(torques: Sequence[Array]) -> Levels:
    """Return the mean of each stretch, with the standard deviation that its scatter gives it."""
    variance = []
    for torque in torques:
        left = torque - torque.mean()
        together = correlation_length(left) if np.ptp(left) > 0.0 and len(left) > 10 else 1.0
        variance.append(float(np.var(left)) * together / len(left))
    return Levels(np.array([float(torque.mean()) for torque in torques]), np.diag(variance))


def _shorter(torque: Array, angle: Array | None) -> tuple[Array, Array | None]:
    if len(torque) <= MAX_ROWS_OF_LEVEL:
        return torque, angle
    if angle is None:
        return thinned(torque, samples=MAX_ROWS_OF_LEVEL)[0], None
    angle, torque = thinned(angle, torque, samples=MAX_ROWS_OF_LEVEL)
    return torque, angle


def _symmetry(speeds: Array, torque: Array) -> Array:
    """Return rows of equations of unit uncertainty: levels at equal speeds both ways add up to 0, shape (pairs, n)."""
    sizes, rows = np.round(np.log(np.abs(speeds)), 1), []
    for size in np.unique(sizes):
        forward, backward = ((sizes == size) & (np.sign(speeds) == way) for way in (1.0, -1.0))
        if forward.any() and backward.any():
            half = 0.5 * abs(float(torque[forward].mean() - torque[backward].mean()))
            rows.append((forward / forward.sum() + backward / backward.sum()) / max(2.0 * ASYMMETRY_SIGMA * half, 1e-300))
    return np.array(rows).reshape(-1, len(speeds))


def _with_gravity(
    stretches: Sequence[tuple[Array, Array | None]], speeds: Array, before: Array
) -> tuple[Levels, list[Array], list[Array]]:
    """Return the levels fitted with gravity, the residual of each stretch, and its residual without gravity.

    Gravity is one wave over the angle. Friction varies by another wave over it, which turns over with the motion; its mean over
    a stretch is the level. In motion one way the waves are one: then gravity and levels have an infinite standard deviation.
    The deviation of gravity contains its difference to a fit whose friction does not vary over the angle.
    """
    counts, many = np.array([len(torque) for torque, _ in stretches]), len(stretches)
    angle = np.concatenate([angle for _, angle in stretches if angle is not None])
    columns, waves = np.repeat(np.eye(many), counts, axis=0), np.column_stack((np.cos(angle), np.sin(angle)))
    means = columns.T @ waves / counts[:, np.newaxis]
    of_friction = np.repeat(np.sign(speeds), counts)[:, np.newaxis] * (waves - columns @ means)
    jacobian = np.column_stack((columns, waves, of_friction))
    torque = np.concatenate([torque for torque, _ in stretches])
    symmetry = np.column_stack((before, np.zeros((len(before), 4))))

    def left_by(columns: Array, coefficients: Array) -> list[Array]:
        return np.split(torque - columns @ coefficients, np.cumsum(counts)[:-1])

    first = left_by(jacobian, solved(jacobian, torque))
    alike = sum(float(each @ each) * max(correlation_length(each), 1.0) for each in first) / len(torque)
    scale = max(float(np.sqrt(alike)), 1e-300)  # of a row, so that rows that are alike do not outweigh what is assumed
    rows, values = np.concatenate((jacobian / scale, symmetry)), np.concatenate((torque / scale, np.zeros(len(symmetry))))
    coefficients = solved(rows, values)
    residuals = left_by(jacobian, coefficients)
    covariance, _ = posterior_of(jacobian / scale, [each[np.newaxis] / scale for each in residuals], symmetry)
    cosine, sine = coefficients[many : many + 2].tolist()
    shift = solved(rows[:, : many + 2], values)[many:] - coefficients[many : many + 2]
    of_cosine, of_sine = np.hypot(np.sqrt(np.diag(covariance)[many : many + 2]), shift).tolist()
    levels = Levels(coefficients[:many], covariance[:many, :many], cosine, sine, (of_cosine, of_sine))
    alone = np.column_stack((columns, of_friction))
    return levels, residuals, left_by(alone, solved(alone, torque))


def _chance(before: Sequence[Array], left: Sequence[Array], unknowns: int) -> float:
    """Return the probability that chance explains as much as two unknowns more do (F test, of independent rows)."""
    independent = sum(len(each) / max(correlation_length(each), 1.0) for each in left)
    whole, rest = (sum(float(each @ each) for each in residuals) for residuals in (before, left))
    return chance_of_gain(whole, rest, 2, independent - unknowns)


# ---- Over the angle --------------------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class PositionFit(ComparedByFields):
    """Friction over the angle, as the position control article describes it.

    Attributes:
        law: fitted friction, valid over the angles measured
        estimates: its numbers, as `quadratic` and `cosine[0]`, by least squares over all samples
        residual: measured less fitted friction [N.m], shape (n,)
        angle: of the samples of all runs, one after the other [rad], shape (n,)
        friction: their friction, positive if it opposes the motion [N.m], shape (n,)
        integrated: the same law by the article's integrals over whole turns; None for fewer than three whole turns
    """

    law: PositionDependent
    estimates: tuple[Estimate, ...]
    residual: Array
    angle: Array
    friction: Array
    integrated: PositionDependent | None


def fit_position(recordings: Recording | Sequence[Recording], gravity_order: float | None = None) -> PositionFit:
    """Fit friction over the angle to runs at constant speed.

    Least squares over all samples, so that turns need not be whole; and the article's own way if a run has three whole turns:
    the means of whole turns give the parabola, the integrals of the rest give a_k and b_k. The mean of a parabola over a turn
    exceeds its middle by s1 pi^2 / 3, which is taken off.

    Args:
        recordings: runs at constant speed with columns angle and torque of the motor, and speed if there are several speeds;
            motions towards negative angles are allowed
        gravity_order: turns of the joint for each of the motor, if runs both ways determine a gravity, which is fitted as well

    Raises:
        ValueError: less than a turn, or too few samples for the orders
    """
    runs = [_run(each) for each in ([recordings] if isinstance(recordings, Recording) else recordings)]
    if not runs:
        raise ValueError("recordings is empty; give at least one run at constant speed")
    angle, level, speed, senses = map(np.concatenate, zip(*runs, strict=True))
    start, end = float(angle.min()), float(angle.max())
    if end - start < FULL_TURN:
        raise ValueError(f"the runs cover {(end - start) / FULL_TURN:.2f} turns; record a whole turn or more")
    if len(angle) < max(MIN_SAMPLES_PER_PERIOD * ORDER_COUNT * (end - start) / FULL_TURN, 2 * ORDER_COUNT + 5):
        raise ValueError(
            f"{len(angle)} samples over {(end - start) / FULL_TURN:.1f} turns do not separate {ORDER_COUNT} orders; record more"
        )
    several = len(np.unique(np.round(speed / max(float(speed.max()), 1e-300), 2))) > 1
    middle, half = 0.5 * (start + end), 0.5 * (end - start)
    u, k = (angle - middle) / half, np.arange(1, ORDER_COUNT + 1)
    waves = (*np.cos(np.outer(k, angle)), *np.sin(np.outer(k, angle)))
    gravity = [] if gravity_order is None else [senses * wave(gravity_order * angle) for wave in (np.cos, np.sin)]
    of_friction = [u**2, u, np.ones_like(u), *waves, *([speed] if several else [])]
    jacobian = np.stack([*of_friction, *gravity], axis=1)
    coefficients = solved(jacobian, level)
    by_gravity = jacobian[:, len(of_friction) :] @ coefficients[len(of_friction) :]
    residual = level - jacobian @ coefficients
    covariance, freedom = covariance_of(jacobian, residual[np.newaxis])
    back = np.eye(len(coefficients))  # from the parabola in u to that in q
    back[:3, :3] = [
        [half**-2, 0.0, 0.0],
        [-2.0 * middle / half**2, 1.0 / half, 0.0],
        [(middle / half) ** 2, -middle / half, 1.0],
    ]
    numbers = (back @ coefficients)[: len(of_friction)]
    sigma = np.sqrt(np.diag(back @ covariance @ back.T))[: len(of_friction)]
    names = ["quadratic", "linear", "constant", *(f"{n}[{i}]" for n in ("cosine", "sine") for i in range(ORDER_COUNT))]
    units = ["N.m/rad2", "N.m/rad", *(2 * ORDER_COUNT + 1) * ["N.m"]]
    if several:
        names, units = [*names, "viscous"], [*units, "N.m.s/rad"]
    estimates = tuple(
        Estimate(name, unit, 0.0, float(value), float(off), False, freedom)
        for name, unit, value, off in zip(names, units, numbers, sigma, strict=True)
    )
    law = _law(numbers, start, end, viscous=float(numbers[-1]) if several else 0.0)
    friction = level - by_gravity
    each_run = zip(runs, np.split(friction, np.cumsum([len(run[0]) for run in runs])[:-1]), strict=True)
    whole = [integrated for run, part in each_run if (integrated := _integrated(run[0], part)) is not None]
    by_integrals = _law(np.mean(whole, axis=0), start, end) if whole and not several else None
    return PositionFit(law, estimates, residual, angle, friction, by_integrals)


def _law(numbers: Array, start: float, end: float, viscous: float = 0.0) -> PositionDependent:
    quadratic, linear, constant, *waves = numbers.tolist()
    return PositionDependent(
        quadratic=quadratic,
        linear=linear,
        constant=constant,
        cosine=waves[:ORDER_COUNT],
        sine=waves[ORDER_COUNT : 2 * ORDER_COUNT],
        viscous=max(viscous, 0.0),
        domain_start=start,
        domain_end=end,
    )


def _run(recording: Recording) -> tuple[Array, Array, Array, Array]:
    """Return angle, torque against the motion, size of the speed, and sense of that torque over the measured one, of a run."""
    check_recording("recordings", recording)
    angle, torque = sensible(recording, "angle", "rad"), sensible(recording, "torque", "N.m")
    if np.any(np.abs(np.diff(angle)) > np.pi):  # an encoder that wraps
        angle = np.unwrap(angle)
    way = float(np.sign(angle[-1] - angle[0]))
    if way == 0.0:
        raise ValueError("the angle ends where it began; give each run one way, at constant speed, by itself")
    speed = np.abs(recording.values("speed", "rad/s")) if "speed" in recording.names else np.zeros_like(angle)
    sense = way if np.mean(torque) * way > 0.0 or np.any(torque < 0.0) else 1.0
    return angle, sense * torque, speed, np.full_like(angle, sense)


def _integrated(angle: Array, level: Array) -> Array | None:
    """Return the article's integrals over the whole turns of a run: s1, s2, s3, a_k, b_k; None for fewer than three turns."""
    order = np.argsort(angle, kind="stable")
    angle, level = angle[order], level[order]
    first, turns = float(angle[0]), int((angle[-1] - angle[0]) // FULL_TURN)
    if turns < 3:
        return None
    centres, means = [], []
    for turn in range(turns):
        q, f = _between(angle, level, first + turn * FULL_TURN, first + (turn + 1) * FULL_TURN)
        centres.append(first + (turn + 0.5) * FULL_TURN)
        means.append(np.trapezoid(f, q) / FULL_TURN)
    quadratic, linear, constant = np.polyfit(centres, means, 2)
    constant -= quadratic * np.pi**2 / 3.0
    q, f = _between(angle, level, first, first + turns * FULL_TURN)
    left = f - np.polyval([quadratic, linear, constant], q)
    k = np.arange(1, ORDER_COUNT + 1)[:, np.newaxis]
    waves = np.concatenate([np.cos(k * q), np.sin(k * q)])
    return np.concatenate([[quadratic, linear, constant], 2.0 / (turns * FULL_TURN) * np.trapezoid(left * waves, q, axis=1)])


def _between(angle: Array, level: Array, start: float, end: float) -> tuple[Array, Array]:
    """Return the samples of a stretch, and both its ends."""
    inside = (angle > start) & (angle < end)
    ends = np.interp([start, end], angle, level)
    return np.concatenate([[start], angle[inside], [end]]), np.concatenate([ends[:1], level[inside], ends[1:]])


# ---- Over the temperature --------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Warming:
    """Friction of an axis over its temperature, F = F0 + F' (T - T0).

    Attributes:
        friction: its friction F0 at the reference temperature, in the unit of the effort
        slope: how it changes with the temperature F' [unit of the effort per K]
        fall: its relative fall with the temperature -F' / F0 [1/K], as `friction.Thermal.dry_fall`
        reference_temperature: T0, mean of the samples in motion [K]
        samples: count of those in motion
        together: length of the blocks of samples that the intervals rest on
        one_way: True if all motion is of one direction: then a weight and an offset of the effort are in F0
    """

    friction: Estimate
    slope: Estimate
    fall: Estimate
    reference_temperature: float
    samples: int
    together: int
    one_way: bool = False


def friction_over_temperature(recording: Recording, effort: str = "current", *, slowest: float | None = None) -> Warming:
    """Return the part of an effort that reverses with the motion, and its change while the axis warms up.

    Least squares of the effort by a constant and its drift with the temperature (weight, offset), by sgn(v) and sgn(v) times
    T - T0. Other torques, as that of the inertia, count as noise. Such noise correlates over a movement and longer: the
    variance is that of sums over blocks of neighbouring samples (LiangZeger1986), the largest of several lengths of block.

    A log of one warm-up does not separate temperature from other changes in the same time, as wear-in or another task. A
    motion of one direction does not separate the friction from a weight or an offset: its slope alone is that of the friction.

    Args:
        recording: columns speed, temperature and the effort, in the order of time
        effort: column of a current or a torque
        slowest: speed from which on the axis surely moves [rad/s]; a twentieth of the largest if not given

    Raises:
        ValueError: a temperature that hardly changes, too few samples in motion, or no friction
    """
    check_recording("recording", recording)
    speed, temperature = sensible(recording, "speed", "rad/s"), recording.values("temperature", "K")
    force, unit = recording[effort], recording.unit(effort)
    least = (
        MIN_MOVING_SPEED * float(np.abs(speed).max())
        if slowest is None
        else arguments.number("slowest", slowest, "rad/s", low=0.0)
    )
    moving = np.abs(speed) > least
    if moving.sum() < MIN_BLOCKS * BLOCK_LENGTHS[0]:
        raise ValueError(f"only {moving.sum()} samples move faster than {least:.3g} rad/s: record more of the motion")
    force, way, temperature = force[moving], np.sign(speed[moving]), temperature[moving]
    if np.ptp(temperature) < MIN_TEMPERATURE_SPAN:
        raise ValueError(
            f"the temperature changes by {np.ptp(temperature):.2g} K only; "
            f"record a warm-up of {MIN_TEMPERATURE_SPAN:g} K or more"
        )
    middle = float(np.mean(temperature))
    warmer = temperature - middle
    one_way = bool(np.ptp(way) == 0.0)
    of_load = [] if one_way else [np.ones_like(way), warmer]
    jacobian = np.stack([*of_load, way, way * warmer], axis=1)
    coefficients = solved(jacobian, force)
    scores = jacobian * (force - jacobian @ coefficients)[:, np.newaxis]
    inverse = normal_inverse(jacobian)
    covariances = [
        (length, _clustered(scores, inverse, length)) for length in BLOCK_LENGTHS if len(force) // length >= MIN_BLOCKS
    ]
    length, covariance = max(covariances, key=lambda each: each[1][-1, -1])
    freedom = len(force) / length - len(coefficients)
    wider = student(ONE_SIGMA, freedom)
    level, slope = coefficients[-2:].tolist()
    if level == 0.0:
        raise ValueError(
            f"no part of {effort} turns round with the motion: it shows no friction; give the current or torque of "
            "the motor that moves the axis"
        )
    of_fall = np.array([slope / level**2, -1.0 / level])
    covariance = covariance[-2:, -2:]
    sigmas = [np.sqrt(covariance[0, 0]), np.sqrt(covariance[1, 1]), np.sqrt(of_fall @ covariance @ of_fall)]
    numbers: Sequence[tuple[str, str, float]] = (
        ("friction", unit, level), ("slope", f"{unit}/K", slope), ("dry_fall", "1/K", -slope / level)
    )  # fmt: skip
    of_level, of_slope, of_both = (
        Estimate(name, of, 0.0, value, wider * float(sigma), False, freedom)
        for (name, of, value), sigma in zip(numbers, sigmas, strict=True)
    )
    return Warming(of_level, of_slope, of_both, middle, int(moving.sum()), length, one_way)


def _clustered(scores: Array, inverse: Array, length: int) -> Array:
    """Return the covariance if samples of one block may err together, and blocks err alone."""
    sums = np.add.reduceat(scores, np.arange(0, len(scores), length), axis=0)
    blocks = len(sums)
    covariance: Array = blocks / (blocks - 1.0) * inverse @ (sums.T @ sums) @ inverse
    return covariance
