"""Motion at constant speed: its stretches in a record, and the level of the torque on each, without gravity."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from strainwave.analysis.branches import thinned
from strainwave.statistics.covariance import posterior_of
from strainwave.statistics.linear_fit import solved
from strainwave.statistics.residuals import chance_of_gain, correlation_length
from strainwave.statistics.scale import noise_sigma

Array = NDArray[np.float64]

MAX_CHANGE = 0.05  # of the speed of a stretch, besides its irregularity
IRREGULARITY_SIGMA = 3.0  # of the speed over the middle of a stretch: a larger difference at an end is acceleration
MAX_CURVATURE = 0.8  # share of the variation of the speed that a parabola explains: more is an oscillation
MAX_BACKWARD = 0.1  # of the way: a record one way does not go back by more
MIN_MOVING_SPEED = 0.05  # of the largest speed of a record: slower parts rest
MIN_MOTION_SIGMA = 8.0  # of the noise of the angle, by which a shaft moves over a part of the record
MEAN_SPEED_PARTS = 50  # of a record, each with a mean speed
MIN_ROWS = 40  # of a record whose angle determines speeds
MIN_ROWS_OF_STRETCH = 20
MIN_STEADY_SHARE = 0.5  # of the moving time, that stretches at constant speed fill; a record that has less is a log
MAX_ROWS_OF_LEVEL = 2_000  # of a stretch, of which its level is found; a longer one is thinned
MIN_GRAVITY_ANGLE = 0.2  # rad: over less gravity is a constant
ASYMMETRY_SIGMA = 0.1  # relative, of the friction of one direction to that of the other (assumed)
MAX_CHANCE = 1e-3  # probability that chance explains as much as gravity does
MAX_RELATIVE_SIGMA = 0.5  # of a level over the usual level: beyond, gravity cannot be separated from it


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
    if rows < MIN_ROWS:
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
    found = [part for piece in pieces if (part := _constant(time, angle, piece)) is not None]
    steady = sum(float(time[part.stop - 1] - time[part.start]) for part in found)
    turned = [float(angle[piece.stop - 1] - angle[piece.start]) for piece in pieces]
    one_way = abs(sum(turned)) > (1.0 - MAX_BACKWARD) * sum(map(abs, turned))
    return found if one_way and steady >= MIN_STEADY_SHARE * moved else []


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

    Gravity is one wave over the angle for all stretches: their angles must count from one zero. Short stretches at one place
    determine only the sum of gravity and of a friction that differs between the directions. Therefore levels at equal speeds
    both ways are taken to be equal within 10 % (assumed).

    Args:
        torques: of each stretch [N.m]
        angles: of the joint at these torques [rad]; None if it was not measured
        speeds: of each stretch, with its sign [rad/s], shape (n,)
    """
    shorter = [_shorter(torque, angle) for torque, angle in zip(torques, angles, strict=True)]
    alone, before = _means(torques), [torque - torque.mean() for torque, _ in shorter]
    known = [angle for _, angle in shorter if angle is not None]
    if len(known) < len(shorter) or np.ptp(np.concatenate(known)) < MIN_GRAVITY_ANGLE:
        return alone
    found, left = _with_gravity(shorter, _symmetry(speeds, alone.torque))
    entangled = found.sigma.max() > MAX_RELATIVE_SIGMA * float(np.median(np.abs(found.torque)))
    return alone if entangled or _chance(before, left, len(shorter) + 2) > MAX_CHANCE else found


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


def _with_gravity(stretches: Sequence[tuple[Array, Array | None]], before: Array) -> tuple[Levels, list[Array]]:
    """Return the levels fitted together with one wave over the angle, and the residual of each stretch."""
    counts, many = [len(torque) for torque, _ in stretches], len(stretches)
    angle = np.concatenate([angle for _, angle in stretches if angle is not None])
    columns = np.repeat(np.eye(many), counts, axis=0)
    jacobian = np.column_stack((columns, np.cos(angle), np.sin(angle)))
    torque = np.concatenate([torque for torque, _ in stretches])
    known = np.column_stack((before, np.zeros((len(before), 2))))

    def left_by(found: Array) -> list[Array]:
        return np.split(torque - jacobian @ found, np.cumsum(counts)[:-1])

    first = left_by(solved(jacobian, torque))
    alike = sum(float(each @ each) * max(correlation_length(each), 1.0) for each in first) / len(torque)
    scale = max(float(np.sqrt(alike)), 1e-300)  # of a row, so that rows that are alike do not outweigh what is assumed
    rows, values = np.concatenate((jacobian / scale, known)), np.concatenate((torque / scale, np.zeros(len(known))))
    found = solved(rows, values)
    residuals = left_by(found)
    covariance, _ = posterior_of(jacobian / scale, [each[np.newaxis] / scale for each in residuals], known)
    cosine, sine = found[many:].tolist()
    of_cosine, of_sine = np.sqrt(np.diag(covariance)[many:]).tolist()
    return Levels(found[:many], covariance[:many, :many], cosine, sine, (of_cosine, of_sine)), residuals


def _chance(before: Sequence[Array], left: Sequence[Array], unknowns: int) -> float:
    """Return the probability that chance explains as much as two unknowns more do (F test, of independent rows)."""
    independent = sum(len(each) / max(correlation_length(each), 1.0) for each in left)
    whole, rest = (sum(float(each @ each) for each in residuals) for residuals in (before, left))
    return chance_of_gain(whole, rest, 2, independent - unknowns)
