"""What of a torque or current is no ripple: friction over speed, inertia, gravity over the angle."""

from __future__ import annotations

from dataclasses import dataclass
from math import tau

import numpy as np
from numpy.typing import NDArray

from strainwave.orders.floor import taper
from strainwave.orders.turning import direction, reach_of, smooth_speed

Array = NDArray[np.float64]

STEADY = 1e-3  # of the speed: what varies by less is constant
KNOTS = 6  # of the friction over speed, in each direction
TREND = 4  # periods of the angle, the longest somewhat longer than the span, in the slow trend over it
GATE = 0.05  # of a fast speed: around it a sample counts half; friction turns over at rest, where ripple is not told
LOST = 0.98  # of the residual, that a loss under load must leave at most to be taken for one
OUTLIER = 8.0  # robust standard deviations of the residual, beyond which a sample counts as a mistake


@dataclass(frozen=True)
class Moving:
    """A shaft and what drives it, evenly in time.

    Attributes:
        angle: of the shaft [rad], shape (n,)
        speed: of it [rad per sample], shape (n,)
        sense: 1 forward, -1 backward, shape (n,)
        series: torque or current less its smooth part, shape (n,)
        smooth: the smooth part, shape (n,)
        load: smooth part without what turns over with the direction, shape (n,)
        weight: 0 at rest and at the ends, up to 1 elsewhere, shape (n,)
        outliers: samples that do not count
    """

    angle: Array
    speed: Array
    sense: Array
    series: Array
    smooth: Array
    load: Array
    weight: Array
    outliers: int


def moving(angle: Array, torque: Array) -> Moving:
    """Takes the smooth part out of a torque, by least squares over speed, direction, acceleration and angle."""
    reach = reach_of(len(angle))
    speed = smooth_speed(angle, reach)
    sense = direction(speed)
    acceleration = smooth_speed(speed, reach)
    fast = float(np.quantile(np.abs(speed), 0.95)) or 1.0
    friction = _friction(speed / fast, sense)
    rest = np.concatenate([_trend(angle), acceleration[:, None]], axis=1)
    gate = speed**2 / (speed**2 + (GATE * fast) ** 2)
    weight = gate * taper(len(angle))
    smooth, turning = _fitted(torque, friction, rest, weight)
    if np.any(sense > 0.0) and np.any(sense < 0.0):  # a share of the load is lost, one way and the other
        lossy = np.concatenate([friction, (sense * np.abs(smooth - turning))[:, None]], axis=1)
        other, otherwise = _fitted(torque, lossy, rest, weight)
        if np.sum((weight * (torque - other)) ** 2) < LOST * np.sum((weight * (torque - smooth)) ** 2):
            friction, smooth, turning = lossy, other, otherwise
    left = torque - smooth
    wrong = _outliers(left, weight)
    if wrong.any():
        weight = np.where(wrong, 0.0, weight)
        smooth, turning = _fitted(torque, friction, rest, weight)
        left = torque - smooth
    return Moving(angle, speed, sense, left, smooth, smooth - turning, weight, int(wrong.sum()))


def _fitted(torque: Array, friction: Array, rest: Array, weight: Array) -> tuple[Array, Array]:
    """The smooth part, and the friction in it."""
    columns = np.concatenate([friction, rest], axis=1)
    size = np.linalg.norm(columns, axis=0)
    size[size == 0.0] = 1.0
    found = np.linalg.lstsq(columns / size * weight[:, None], torque * weight, rcond=1e-8)[0] / size
    count = friction.shape[1]
    return columns @ found, friction @ found[:count]


def _friction(speed: Array, sense: Array) -> Array:
    """Piecewise linear over speed and odd in it, and a share of it that is even; a constant is left to the load."""
    columns = [sense] if np.any(sense > 0.0) and np.any(sense < 0.0) else []
    swift = np.abs(speed)
    knots = np.unique(np.quantile(swift, np.linspace(0.0, 0.9, KNOTS)))
    if float(np.ptp(swift)) > STEADY * float(swift.max()):
        for knot in knots:
            above = np.maximum(swift - knot, 0.0)
            columns += [sense * above, above] if columns and columns[0] is sense else [above]
    return np.stack(columns, axis=1) if columns else np.zeros((len(speed), 0))


def _trend(angle: Array) -> Array:
    """Constant, gravity over a revolution, and what else varies slowly with the angle."""
    span = max(float(np.ptp(angle)), 1e-12)
    columns = [np.ones_like(angle)]
    for period in (1.2 * span / np.arange(1, TREND + 1)).tolist():
        columns += [np.sin(tau * (angle - angle[0]) / period), np.cos(tau * (angle - angle[0]) / period)]
    if span > 0.5:
        columns += [np.sin(angle), np.cos(angle)]
    return np.stack(columns, axis=1)


def _outliers(left: Array, weight: Array) -> NDArray[np.bool_]:
    """Samples far out of the bulk around them, compared with the median of five, so that a fast change is none."""
    from scipy.ndimage import median_filter

    off = left - median_filter(left, 5, mode="nearest")
    swift = weight > 0.5  # elsewhere friction turns over
    bulk = 1.4826 * float(np.median(np.abs(off[swift]))) if swift.any() else 0.0
    found: NDArray[np.bool_] = swift & (np.abs(off) > OUTLIER * bulk) if bulk > 0.0 else np.zeros(len(left), dtype=bool)
    return found
