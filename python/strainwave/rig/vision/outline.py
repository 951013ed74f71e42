"""Edge of a round spot, to some tenths of a pixel: the largest change of brightness along rays from within."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from strainwave.rig.vision.circle import geometric
from strainwave.rig.vision.ellipse import Ellipse, circle, fit_ellipse

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]
Grey = NDArray[np.float32]
RAY_COUNT = 64  # from the middle of a spot
_OUTLIER_SCATTER = 4.5  # distance over the scatter from which a point is an outlier [1]
_WIDE_ARC = 0.6  # share of the edge that an ellipse needs
_MAX_BLUR_SHARE = 0.4  # blur over radius [1]
_FLANK_SAMPLES = 12  # from the middle of an edge to either end
_ELLIPSE_TOLERANCE = 0.08  # distance of points of an ellipse from a circle, over its radius [1]


@dataclass(frozen=True)
class Outline:
    """A curve to some tenths of a pixel, the share of the rays that meet it, the blur there [px], and the contrast."""

    curve: Ellipse
    arc: float
    blur: float
    contrast: float


def outline(grey: Grey, x: float, y: float, radius: float, dark: bool) -> Outline | None:
    """Return the places where brightness first changes much along rays from a point inside; None if that is not round."""
    turn = turns(RAY_COUNT)
    step = max(0.5, 1.3 * radius / 60.0)
    along = np.arange(0.3 * radius, 1.6 * radius, step)
    profile = _sampled(grey, x + np.cos(turn)[:, None] * along, y + np.sin(turn)[:, None] * along)
    change = (profile[:, 2:] - profile[:, :-2]) * np.float32(1.0 if dark else -1.0)
    change = np.nan_to_num(change[:, :-2] + change[:, 1:-1] + change[:, 2:]) / 3.0
    at, peak = _first_peak(change)
    if not np.any(peak > 0.0):
        return None
    clear = peak > 0.4 * median(peak[peak > 0.0])
    reach = along[at + 2]
    curve, used = _robust(x + reach * np.cos(turn), y + reach * np.sin(turn), clear, radius)
    if curve is None:
        return None
    row, middle, last = np.arange(RAY_COUNT), at + 2, profile.shape[1] - 1
    rise = np.abs(
        profile[row, np.minimum(middle + _FLANK_SAMPLES, last)] - profile[row, np.maximum(middle - _FLANK_SAMPLES, 0)]
    )
    contrast, slope = median(np.nan_to_num(rise[used])), median(peak[used]) / (2.0 * step)
    blur = float(np.sqrt(max((contrast / slope) ** 2 / (2.0 * np.pi) - step**2, 0.25)))  # the wider, the less steep
    return Outline(curve, float(np.mean(used)), blur, contrast) if blur < _MAX_BLUR_SHARE * curve.radius else None


@cache
def turns(count: int) -> Array:
    return 2.0 * np.pi * (np.arange(count) + 0.5) / count - np.pi


def _sampled(grey: Grey, x: Array, y: Array) -> Array:
    """Brightness between pixels, linearly; not a number outside of the picture."""
    from scipy.ndimage import map_coordinates

    values: Array = map_coordinates(grey, [y, x], output=np.float64, order=1, mode="constant", cval=np.nan)
    return values


def _first_peak(change: Array) -> tuple[NDArray[np.int_], Array]:
    """Along each row, where the first of the large changes is largest, and how large."""
    rows, columns = np.arange(len(change))[:, None], np.arange(change.shape[1])
    first = np.argmax(change >= 0.5 * change.max(axis=1, keepdims=True), axis=1)[:, None]
    near = np.where((columns >= first) & (columns <= first + 6), change, -np.inf)
    at = np.argmax(near, axis=1)
    return at, change[rows[:, 0], at]


def _robust(x: Array, y: Array, clear: Mask, radius: float) -> tuple[Ellipse | None, Mask]:
    """The curve that most of the points lie on, and which do."""
    nothing = None, np.zeros(len(x), bool)
    if np.count_nonzero(clear) < 8:
        return nothing
    used, start = _most(x, y, clear, _ELLIPSE_TOLERANCE * radius + 0.5)
    for _ in range(3):
        if np.count_nonzero(used) < 8:
            return nothing
        try:
            start = near_curve(x[used], y[used], float(np.mean(used)), start)
        except (np.linalg.LinAlgError, ValueError):
            return nothing
        distance, before = np.abs(start.distance(x, y)), used
        used = clear & (distance <= max(_OUTLIER_SCATTER * scatter(distance[used]), 0.3))
        if np.array_equal(used, before):
            break
    return start, used


def _most(x: Array, y: Array, clear: Mask, near: float) -> tuple[Mask, Ellipse]:
    """Return the circle through three points that most points are near."""
    n = len(x)
    first = np.arange(n)
    triples = np.stack([np.concatenate((first, first)), np.concatenate((first + n // 3, first + n // 6)) % n,
                        np.concatenate((first + 2 * n // 3, first + n // 3)) % n])  # fmt: skip
    triples = triples[:, np.all(clear[triples], axis=0)]
    (ax, bx, cx), (ay, by, cy) = x[triples], y[triples]
    bx, by, cx, cy = bx - ax, by - ay, cx - ax, cy - ay
    with np.errstate(divide="ignore", invalid="ignore"):
        double, b, c = 2.0 * (bx * cy - by * cx), bx**2 + by**2, cx**2 + cy**2
        right, down = (cy * b - by * c) / double, (bx * c - cx * b) / double
        reach = np.hypot(right, down)
        distance = np.hypot(x - (ax + right)[:, None], y - (ay + down)[:, None]) - reach[:, None]
        votes = np.count_nonzero((np.abs(distance) < near) & clear, axis=1)
    if len(votes) == 0:
        return np.zeros(n, bool), circle(0.0, 0.0, 1.0)
    best = int(np.argmax(votes))
    used = (np.abs(distance[best]) < near) & clear
    return used, circle(float(ax[best] + right[best]), float(ay[best] + down[best]), float(reach[best]))


def near_curve(x: Array, y: Array, arc: float, start: Ellipse) -> Ellipse:
    """The ellipse through points, or the circle where too short an arc of it is seen."""
    if arc < _WIDE_ARC:
        fit = geometric(x, y)
        return circle(fit.x, fit.y, fit.radius)
    return fit_ellipse(x, y, start, 1e-2)


def scatter(sizes: Array) -> float:
    """Standard deviation of normal errors by the median of their sizes, which outliers do not change."""
    return median(sizes) / 0.6745


def median(values: Array) -> float:
    """The upper one of two in the middle: numpy's own median takes several times as long for few values."""
    half = len(values) // 2
    return float(np.partition(values, half)[half])
