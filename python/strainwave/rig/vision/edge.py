"""The edge of a round marker: an outline to some tenths of a pixel, then its points to some hundredths.

The outline is where brightness changes most along rays from within. All pixels near it are compared with a sharp edge that is
blurred by a Gaussian. Each pixel belongs to the sector of the edge that it is nearest to, and each sector, a radial profile of
some thirty pixels, gives the distance of the edge from the curve. No pixel is interpolated and none is used twice: the errors
of the sectors are independent, and their scatter gives the standard deviation of the centre. All sectors share the brightness
inside and outside, a plane each, since light changes over a marker; a wrong slope of a plane shifts the whole edge, which is
added.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from strainwave.rig.vision.circle import Ellipse, centre_covariance, circle, fit_ellipse, geometric
from strainwave.statistics.linear_fit import solved

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]
Grey = NDArray[np.float32]
SECTOR_LENGTH = 3.5  # px of the edge
_MIN_SECTORS, _MAX_SECTORS = 24, 180  # sectors
_LEAST_USED = 8
_BAND_BLURS = 3.5  # distance from the edge, in blurs, within which pixels determine it [1]
_MAX_SHIFT_BLURS = 3.0  # shift of a sector, in blurs [1]; beyond it the first-order fit does not hold
_OUTLIER_SCATTER = 4.5  # distance over the scatter from which a point is an outlier [1]
_MAX_VARIANCE_RATIO = 4.0  # variance of the pixels of a sector over the usual one [1]
_NEGLIGIBLE_PIXEL_SHARE = 0.003  # share of the pixels of a side that may change between two passes at the end [1]
_MAX_PASSES = 5  # of the edge fit
_MAX_LAST_SHIFT = 0.15  # px: the next pass would move the centre by about its square
_MAX_LAST_WIDENING = 0.06  # share of the blur [1]: the next pass would change the blur by about its square
_ELLIPSE_TRIAL_SHARE = 0.7  # share of the next limit below which no ellipse is fitted [1]
_ELLIPSE_VARIANCE_RATIO = 12.0  # beyond it the points are an ellipse's [1]: 4e-5 of all circles of 70 points reach it
WIDE_ARC = 0.6  # share of the edge that an ellipse needs
RAY_COUNT = 64  # from the middle of a spot
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
    if arc < WIDE_ARC:
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


@dataclass(frozen=True, eq=False)
class Edge:
    """Points of an edge, one of each sector that was seen and is not an outlier.

    Attributes:
        x, y: of each point [px], shape (n,)
        curve: the ellipse through them, a circle unless the points contradict it
        covariance: of x and y of its centre [px^2], shape (2, 2)
        residual: rms distance of the points from the curve [px]
        inside, outside: brightness of the marker and of the ground around it, of the full scale
        blur: standard deviation of the edge's spread [px]
        arc: share of the sectors that are used
        clipped: share of the pixels about the edge, inside or outside, that are at an end of the scale
    """

    x: Array
    y: Array
    curve: Ellipse
    covariance: Array
    residual: float
    inside: float
    outside: float
    blur: float
    arc: float
    clipped: float


@dataclass(frozen=True, eq=False)
class _Pixels:
    """Pixels about a curve, x and y [px], and their brightness."""

    x: Array
    y: Array
    value: Array

    def __getitem__(self, chosen: Mask) -> _Pixels:
        return _Pixels(self.x[chosen], self.y[chosen], self.value[chosen])


def edge(grey: Grey, found: Outline) -> Edge | None:
    """The edge near an outline, or None where there is none."""
    curve = found.curve
    width = min(_BAND_BLURS * found.blur + 1.0, 0.6 * curve.radius)
    around, distance = _around(grey, curve, width + max(4.0, 0.25 * curve.radius))
    inside = around[distance < -width]
    outside = around[distance > width]
    if len(inside.x) < 12:
        inside = around[distance < -0.5 * curve.radius]
    if len(inside.x) < 4 or len(outside.x) < 12:
        return None
    levels = _level(inside, curve), _level(outside, curve)
    step = levels[1].middle - levels[0].middle
    try:
        fit = _fitted(around[np.abs(distance) < width], levels, found)
        if fit is None or step == 0.0:
            return None
        x, y, blur, arc = fit
        curve, covariance, residual = fit_points(x, y, arc)
    except (np.linalg.LinAlgError, ValueError):  # on no curve
        return None
    shift = np.sqrt(np.pi) * blur * curve.radius / step  # of the centre, by a slope of either plane
    covariance = covariance + shift**2 * (levels[0].slopes_covariance + levels[1].slopes_covariance)
    clipped = _clipped(inside, outside, float(grey.max()))
    return Edge(x, y, curve, covariance, residual, levels[0].middle, levels[1].middle, blur, arc, clipped)


def _fitted(band: _Pixels, levels: tuple[_Level, _Level], found: Outline) -> tuple[Array, Array, float, float] | None:
    """Return x and y of the edge, its blur [px] and the share of the sectors that have it; None where these are too few."""
    curve, blur = found.curve, found.blur
    sectors = int(np.clip(2.0 * np.pi * curve.radius / SECTOR_LENGTH, _MIN_SECTORS, _MAX_SECTORS))
    low, high = (level.at(band.x, band.y) for level in levels)
    for _ in range(_MAX_PASSES):
        before, blur_before = curve, blur
        profiles = _profiles(band, low, high - low, curve, blur, sectors)
        if np.count_nonzero(profiles.good) < _LEAST_USED:
            return None
        x, y, good, blur = profiles.x, profiles.y, profiles.good, profiles.blur
        for _ in range(2):
            curve = near_curve(x[good], y[good], float(np.mean(good)), curve)
            off, count = np.abs(curve.distance(x, y)), np.count_nonzero(good)
            good = good & (off <= max(_OUTLIER_SCATTER * scatter(off[good]), 1e-3))
            if np.count_nonzero(good) < _LEAST_USED:
                return None
            if np.count_nonzero(good) == count:
                break
        if (
            np.hypot(curve.x - before.x, curve.y - before.y) < _MAX_LAST_SHIFT
            and abs(blur / blur_before - 1.0) < _MAX_LAST_WIDENING
        ):
            break
    return x[good], y[good], blur, float(np.mean(good))


def _around(grey: Grey, curve: Ellipse, reach: float) -> tuple[_Pixels, Array]:
    """The pixels of the picture within a box about a curve, and how far outside of it each lies."""
    half = curve.half_axes[0] + reach
    height, width = grey.shape
    left, right = max(int(curve.x - half), 0), min(int(curve.x + half) + 2, width)
    top, bottom = max(int(curve.y - half), 0), min(int(curve.y + half) + 2, height)
    x, y = np.meshgrid(np.arange(left, right, dtype=np.float64), np.arange(top, bottom, dtype=np.float64))
    distance = curve.distance(x, y)
    near = distance < reach
    pixels = _Pixels(x[near], y[near], grey[top:bottom, left:right][near].astype(np.float64))
    return pixels, distance[near]


@dataclass(frozen=True, eq=False)
class _Level:
    """Brightness on one side of an edge: a plane, since light changes over a marker."""

    x: float
    y: float
    middle: float
    slopes: Array
    slopes_covariance: Array

    def at(self, x: Array, y: Array) -> Array:
        level: Array = self.middle + self.slopes[0] * (x - self.x) + self.slopes[1] * (y - self.y)
        return level


def _level(pixels: _Pixels, curve: Ellipse) -> _Level:
    """The plane through brightness at the centre of a curve; pixels that do not belong to it have no weight."""
    right, down = pixels.x - curve.x, pixels.y - curve.y
    middle = median(pixels.value[::4])
    rest, plane, inverse, variance = pixels.value - middle, np.array([middle, 0.0, 0.0]), np.zeros((3, 3)), 0.0
    used = np.zeros(len(rest), bool)
    for _ in range(3):
        spread, before = np.abs(rest), used
        used = spread <= max(_OUTLIER_SCATTER * scatter(spread[::4]), 1e-6)
        if np.count_nonzero(used) < 12 or np.count_nonzero(used != before) <= _NEGLIGIBLE_PIXEL_SHARE * len(used):
            break
        columns = np.stack((np.ones(np.count_nonzero(used)), right[used], down[used]))
        inverse[:] = np.linalg.inv(columns @ columns.T)
        plane = inverse @ (columns @ pixels.value[used])
        rest = pixels.value - (plane[0] + plane[1] * right + plane[2] * down)
        variance = float(np.mean(rest[used] ** 2))
    return _Level(curve.x, curve.y, float(plane[0]), plane[1:], inverse[1:, 1:] * variance)


@dataclass(frozen=True, eq=False)
class _Profiles:
    """A point of the edge in each sector [px], which sectors are seen and look like an edge, and the blur [px]."""

    x: Array
    y: Array
    good: Mask
    blur: float


def _profiles(band: _Pixels, low: Array, step: Array, curve: Ellipse, blur: float, sectors: int) -> _Profiles:
    """One step of Gauss-Newton in how far the edge lies from the curve in each sector, and in the blur of all."""
    from scipy.special import ndtr

    turn, scaled = curve.turns(band.x, band.y), curve.distance(band.x, band.y) / blur
    sector = np.minimum(((turn + np.pi) * (sectors / (2.0 * np.pi))).astype(np.intp), sectors - 1)
    rest = band.value - low - step * ndtr(scaled)
    slope = np.exp(-0.5 * scaled**2) * step * (-1.0 / (blur * np.sqrt(2.0 * np.pi)))  # as the edge moves outwards
    square = slope * slope

    def total(values: Array) -> Array:
        sums: Array = np.bincount(sector, weights=values, minlength=sectors).astype(np.float64, copy=False)
        return sums

    known, weighted, count = total(square), total(slope * rest), np.bincount(sector, minlength=sectors)
    usual = median(known[known > 0.2 * np.max(known)]) if np.any(known > 0.0) else np.inf
    seen = (known > 0.5 * usual) & (count > 2)
    known[~seen] = 1.0
    move = weighted / known
    seen &= np.abs(move) < _MAX_SHIFT_BLURS * blur
    misfit = (total(rest * rest) - weighted * move) / np.maximum(count - 1, 1)
    good = seen & (misfit <= max(_MAX_VARIANCE_RATIO * median(misfit[seen]), 1e-6)) if np.any(seen) else seen
    x, y = curve.points(np.where(seen, total(square * turn) / known, turns(sectors)))
    move[~seen] = 0.0
    right, down = curve.normal(x, y)
    widening = slope * scaled
    weight = float(np.sum((widening * widening)[good[sector]]))
    wider = float(np.sum((widening * rest)[good[sector]])) / weight if weight > 0.0 else 0.0
    return _Profiles(x + move * right, y + move * down, good, float(np.clip(blur + wider, 0.6 * blur, 1.7 * blur)))


def fit_points(x: Array, y: Array, arc: float) -> tuple[Ellipse, Array, float]:
    """The circle through points by distance, or the ellipse where they clearly are one's.

    Args:
        x, y: of the points [px], shape (n,)
        arc: share of the edge that they cover

    Returns:
        the curve, the covariance of its centre [px^2], the rms distance of the points from it [px]
    """
    n = len(x)
    fit = geometric(x, y)
    plain = circle(fit.x, fit.y, fit.radius), fit.covariance[:2, :2], fit.rms
    if arc < WIDE_ARC or n < 10:
        return plain
    squeezed, sigma = oblong(x, y, plain[0], fit.rms)
    limit = _ELLIPSE_TRIAL_SHARE * _ELLIPSE_VARIANCE_RATIO
    if abs(squeezed) ** 2 < 2.0 * limit * sigma**2:  # the gain of an ellipse, to first order
        return plain
    curve = fit_ellipse(x, y, plain[0])
    rest = float(np.sum(curve.distance(x, y) ** 2))
    if (n * fit.rms**2 - rest) / 2.0 <= _ELLIPSE_VARIANCE_RATIO * rest / (n - 5):
        return plain
    return curve, centre_covariance(curve, x, y) * (rest / (n - 5)), float(np.sqrt(rest / n))


def oblong(x: Array, y: Array, curve: Ellipse, residual: float) -> tuple[complex, float]:
    """Return the flattening of the points of an edge: the share by which one axis is shorter, and its direction.

    A circle squeezed by e lies e R/2 cos(2 (turn - direction)) inside of the mean circle. Of points that scatter by s, both
    parts err by s sqrt(2/n), so that a mean over many pictures shows what each by itself does not.

    Args:
        x, y: of the points, all round [px], shape (n,)
        curve: through them
        residual: rms distance of the points from it [px]

    Returns:
        e exp(2 i direction), the direction from x towards the top of the picture; the standard deviation of both of its parts
    """
    turn = np.arctan2(curve.y - y, x - curve.x)
    reach = np.hypot(x - curve.x, y - curve.y)
    columns = np.column_stack((np.ones_like(turn), np.cos(turn), np.sin(turn), np.cos(2.0 * turn), np.sin(2.0 * turn)))
    found = solved(columns, reach)
    n, twice = len(x), 2.0 / float(found[0])
    sigma = twice * residual * float(np.sqrt(2.0 / max(n - 5, 1)))
    return complex(-twice * found[3], -twice * found[4]), sigma


def _clipped(inside: _Pixels, outside: _Pixels, top: float) -> float:
    """The larger of both shares of pixels that are black, or as bright as the picture can be."""
    bits = np.log2(top * 65535.0 + 1.0) if top < 1.0 else 16.0
    full = top if top >= 1.0 or (bits >= 10.0 and abs(bits - round(bits)) < 1e-6) else np.inf
    return max(float(np.mean((part.value <= 0.0) | (part.value >= full))) for part in (inside, outside))
