"""Width, area and closure of a loop, by every definition in use."""

from __future__ import annotations

from dataclasses import dataclass
from math import hypot, inf, nan

import numpy as np
from numpy.typing import NDArray

from strainwave.rig.analysis.regimes import CLOSING_TOLERANCE, Branch, Segmented, part
from strainwave.rig.analysis.result import Result, result
from strainwave.rig.loop import Loop

Array = NDArray[np.float64]

LOST_MOTION = 0.04  # of the rated torque, at which catalogues of strain wave gears state the lost motion
MIN_PEAK, MAX_PEAK = 0.9, 2.0  # of a cycle that is a test of lost motion, over 4 % of the rated torque
WIDTH_TOLERANCE = 1e-6  # of the widest separation: widths that differ by less are equal


@dataclass(frozen=True)
class Width:
    """Separation of the two branches in angle, at equal torque.

    Attributes:
        width: falling branch less rising branch [rad]
        torque: where it was taken [N.m]; the middle of the band, where it is as wide over a band
        band: torques between which it is as wide [N.m]
    """

    width: Result
    torque: float
    band: tuple[float, float]


def separation(falling: Branch, rising: Branch, torque: float, loop: Loop, freedom: float = inf) -> Result | None:
    """Return the angle of the falling branch less that of the rising one at a torque [rad]; None if one does not reach it.

    >>> from strainwave.rig import Loop
    >>> from strainwave.rig.analysis.regimes import segment
    >>> loop = Loop([3.0, 2.0, -3.0, -2.0, 3.0], [1.0, 0.0, -1.0, 0.0, 1.0], side="output", name="example", angle_sigma=0.1)
    >>> cut = segment(loop)
    >>> found = separation(cut.falling, cut.rising, 0.0, loop)
    >>> found.value, round(found.random, 4)  # two points, each known to 0.1
    (4.0, 0.1414)
    """
    if not max(falling.low, rising.low) <= torque <= min(falling.high, rising.high):
        return None
    (down, down_variance, down_slope), (up, up_variance, up_slope) = (_at(each, torque) for each in (falling, rising))
    return _width(down - up, down_variance + up_variance, abs(down_slope) + abs(up_slope), loop, freedom)


def is_lost_motion_cycle(falling: Branch, rising: Branch, rated: float) -> bool:
    """True if the peaks of a cycle are near plus and minus 4 % of the rated torque, as in a maker's test."""
    peaks = np.array([-min(falling.low, rising.low), max(falling.high, rising.high)]) / (LOST_MOTION * rated)
    return bool(np.all((peaks >= MIN_PEAK) & (peaks <= MAX_PEAK)))


def lost_motion(falling: Branch, rising: Branch, rated: float, loop: Loop, freedom: float = inf) -> Result | None:
    """Return the lost motion [rad]; None if a branch does not reach 4 % of the rated torque.

    Of a cycle to about these torques, as makers run it, it is the whole angle from one to the other, loading. A peak that
    misses its torque a little is corrected with the slope there. Of a larger cycle it is the mean separation of the branches
    at both.

    Source:
        Harmonic Drive AG, glossary of the engineering data: lost motion is the angle of the hysteresis curve at about ± 4 % of
        the rated torque, with the wave generator locked
    """
    level = LOST_MOTION * rated
    if is_lost_motion_cycle(falling, rising, rated):
        (top, above, steep), (bottom, below, flat) = _at(rising, level), _at(falling, -level)
        shared = hypot((top - bottom) * loop.angle_scale, (abs(steep) + abs(flat)) * level * loop.torque_scale)
        return result(top - bottom, "rad", random=float(np.sqrt(above + below)), shared=shared, freedom=freedom)
    low, high = (separation(falling, rising, sign * LOST_MOTION * rated, loop, freedom) for sign in (-1.0, 1.0))
    if low is None or high is None:
        return None
    random, shared = 0.5 * hypot(low.random, high.random), 0.5 * (low.shared + high.shared)
    return result(0.5 * (low.value + high.value), "rad", random=random, shared=shared, freedom=freedom)


def widest(falling: Branch, rising: Branch, loop: Loop, freedom: float = inf) -> Width | None:
    """Return the widest separation at equal torque, the article's hysteresis; None if no torque is shared.

    Of noisy points the widest is, by about the noise, wider than that of the loop without noise. An error of the pulleys'
    friction moves the branches apart, and with them the torque at which they are widest: at a knee the width changes by twice
    the error times the compliance of the stiffer branch there, on whose side the widest moves.
    """
    low, high = max(falling.low, rising.low), min(falling.high, rising.high)
    if low >= high:
        return None
    knots = np.unique(np.clip(np.concatenate((falling.torque, rising.torque)), low, high))
    both = [
        _read(falling.torque, falling.angle, knots, side) - _read(rising.torque, rising.angle, knots, side)
        for side in ("left", "right")
    ]
    torque, apart = np.repeat(knots, 2)[1:-1], np.column_stack(both).ravel()[1:-1]  # no limit from beyond the ends
    most = float(apart.max())
    wide = torque[apart >= most - WIDTH_TOLERANCE * abs(most)]
    band = (float(wide.min()), float(wide.max()))
    at = float(torque[int(np.argmax(apart))]) if band[1] - band[0] == 0.0 else 0.5 * (band[0] + band[1])
    (_, down, _), (_, up, _) = _at(falling, at), _at(rising, at)
    (down_before, down_after), (up_before, up_after) = _slopes(falling, at), _slopes(rising, at)
    stiffer = max(min(down_before, up_after), max(down_after, up_before))
    return Width(_width(most, down + up, 2.0 * stiffer, loop, freedom), at, band)


def widest_in_torque(falling: Branch, rising: Branch) -> tuple[float, float]:
    """Return the widest separation in torque at equal angle [N.m], and that angle [rad].

    It is twice what friction holds, where all of it slips.

    >>> from strainwave.rig import Loop
    >>> from strainwave.rig.analysis.regimes import segment
    >>> loop = Loop([3.0, 2.0, -3.0, -2.0, 3.0], [1.0, 0.0, -1.0, 0.0, 1.0], side="output", name="example")
    >>> cut = segment(loop)
    >>> widest_in_torque(cut.falling, cut.rising)
    (0.8, -2.0)
    """
    from scipy.optimize import isotonic_regression

    curves = [(isotonic_regression(each.angle).x, each.torque) for each in (falling, rising)]
    low, high = max(angle[0] for angle, _ in curves), min(angle[-1] for angle, _ in curves)
    knots = np.unique(np.clip(np.concatenate([angle for angle, _ in curves]), low, high))
    (down_angle, down), (up_angle, up) = curves
    found = []
    for side in ("left", "right"):
        apart = _read(up_angle, up, knots, side) - _read(down_angle, down, knots, side)
        inner = slice(1, None) if side == "left" else slice(None, -1)
        found.append((apart[inner], knots[inner]))
    apart, angle = (np.concatenate(each) for each in zip(*found, strict=True))
    if not len(apart):
        return 0.0, float(low)
    return float(apart.max()), float(angle[int(np.argmax(apart))])


def area(loop: Loop, freedom: float = inf) -> Result:
    """Return the energy lost in a cycle [J]: the area of the polygon of its points, closed by a straight line.

    >>> loop = Loop([1.0, -1.0, -1.0, 1.0], [-1.0, -1.0, 1.0, 1.0], side="output", name="a square")
    >>> area(loop).value
    4.0
    """
    angle, torque = loop.angle - loop.angle.mean(), loop.torque - loop.torque.mean()
    by_angle = 0.5 * (np.roll(torque, 1) - np.roll(torque, -1))
    by_torque = 0.5 * (np.roll(angle, -1) - np.roll(angle, 1))
    value = float(by_angle @ angle)
    random = float(np.sqrt(np.sum((by_angle * loop.angle_sigma) ** 2 + (by_torque * loop.torque_sigma) ** 2)))
    turned = float(np.abs(np.diff(loop.angle)).sum())
    shared = hypot(value * loop.angle_scale, value * loop.torque_scale, turned * loop.friction_sigma)
    return result(value, "J", random=random, shared=shared, freedom=freedom)


def closure(cut: Segmented, freedom: float = inf) -> Result | None:
    """Return the angle at the end of the cycle less that at its beginning, at equal torque [rad]; None where it does not close.

    Where the end lacks a little torque, the angle goes on straight as it went before, and may be wrong by all of that.
    """
    if not cut.closed:
        return None
    cycle = part(cut.loop, cut.cycle, cut.loop.name)
    lacking = float(cycle.torque[0] - cycle.torque[-1])
    further = 0.0
    if lacking:
        away = np.abs(cycle.torque - cycle.torque[-1]) > CLOSING_TOLERANCE * np.ptp(cycle.torque)
        first = int(np.flatnonzero(away)[-1])
        further = float((cycle.angle[-1] - cycle.angle[first]) / (cycle.torque[-1] - cycle.torque[first])) * lacking
    value = float(cycle.angle[-1] - cycle.angle[0]) + further
    random = hypot(float(cycle.angle_sigma[-1]), float(cycle.angle_sigma[0]), further)
    return result(value, "rad", random=random, shared=abs(value) * cycle.angle_scale, freedom=freedom)


def drift(centres: Array, sigma: float) -> Result:
    """Return the movement of the middle of the loop [rad per cycle], by the straight line through the cycles.

    Args:
        centres: angle half way between the branches at zero torque, of each cycle [rad], shape (n,), n >= 2
        sigma: standard deviation of each [rad]; from three cycles on, their scatter about the line counts where it is more

    >>> drift(np.array([0.0, 0.1, 0.2]), 0.0).value
    0.1
    """
    number = np.arange(len(centres)) - 0.5 * (len(centres) - 1)
    lever = number / (number @ number)
    slope = float(lever @ centres)
    freedom = len(centres) - 2
    spread = float(np.sqrt(np.sum((centres - centres.mean() - slope * number) ** 2) / freedom)) if freedom else nan
    scattered = spread > sigma or np.isnan(sigma)
    each = spread if scattered else sigma
    return result(
        slope, "rad", random=each * float(np.sqrt(lever @ lever)), freedom=float(freedom or inf) if scattered else inf
    )


# ---- Reading a branch -------------------------------------------------------------------------------------------------


def _width(value: float, variance: float, compliance: float, loop: Loop, freedom: float) -> Result:
    """Return a width, with the friction of the rig, which moves the branches apart, among the shared errors."""
    shared = hypot(value * loop.angle_scale, compliance * loop.friction_sigma)
    return result(value, "rad", random=float(np.sqrt(variance)), shared=shared, freedom=freedom)


def _at(branch: Branch, torque: float) -> tuple[float, float, float]:
    """Return the angle at a torque on the straight line between the neighbours, its variance, and the slope there."""
    after = int(np.clip(np.searchsorted(branch.torque, torque, "right"), 1, len(branch.torque) - 1))
    if branch.torque[after] == branch.torque[after - 1]:  # a level stretch that ends here
        after = int(np.clip(np.searchsorted(branch.torque, torque, "left"), 1, len(branch.torque) - 1))
    before, last = after - 1, len(branch.torque) - 1
    while branch.torque[after] == branch.torque[before] and (before > 0 or after < last):  # a level stretch at an end
        before, after = (before - 1, after) if before > 0 else (before, after + 1)
    low, high = float(branch.torque[before]), float(branch.torque[after])
    near = [before, after]
    weights = np.array([high - torque, torque - low]) / (high - low)
    slope = float(np.diff(branch.angle[near])[0]) / (high - low)
    variance = weights**2 @ (branch.angle_sigma[near] ** 2 + (slope * branch.torque_sigma[near]) ** 2)
    return float(weights @ branch.angle[near]), float(variance), slope


def _slopes(branch: Branch, torque: float) -> tuple[float, float]:
    """Return the change of angle per torque just below and above a torque; at an end, both are those of the last stretch."""
    knots, rows = np.unique(branch.torque, return_index=True)
    last = np.append(rows[1:] - 1, len(branch.torque) - 1)  # of a level stretch, where the next one begins
    slopes = (branch.angle[rows[1:]] - branch.angle[last[:-1]]) / np.diff(knots)
    below, above = (np.clip(np.searchsorted(knots, torque, side) - 1, 0, len(slopes) - 1) for side in ("left", "right"))
    return float(slopes[below]), float(slopes[above])


def _read(x: Array, y: Array, at: Array, side: str) -> Array:
    """Return values of a chain of straight lines, at steps the limit from one side; x ascends, if not strictly."""
    right = np.searchsorted(x, at, "right")
    left = np.searchsorted(x, at, "left")
    value = np.interp(at, x, y)
    on = right > left  # at a knot
    index = np.clip(left if side == "left" else right - 1, 0, len(x) - 1)
    return np.where(on, y[index], value)
