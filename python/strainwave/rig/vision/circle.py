"""Circles through points of an edge, by four methods.

The distances of the points from the circle are what noise makes; only `geometric` minimises their squares. The others minimise
a polynomial in the coordinates, which needs no start and no iterations. Kåsa's shrinks a circle of which only an arc is seen
(erratum T2); Pratt's and Taubin's nearly do not.

Source: N. Chernov, Circular and Linear Regression, 2010, chapters 4 to 7; I. Kåsa 1976, V. Pratt 1987, G. Taubin 1991.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from strainwave import arguments
from strainwave.equality import ComparedByFields
from strainwave.presentation import Presented
from strainwave.statistics.linear_fit import normal_inverse, solved

Array = NDArray[np.float64]
Series = Sequence[float] | Array
_MAX_ITERATIONS = 100  # of the circle fit
_MAX_ELLIPSE_ITERATIONS = 20  # of the ellipse fit


@dataclass(frozen=True, eq=False)
class Circle(ComparedByFields, Presented):
    """A circle fitted to points.

    Attributes:
        x, y: its centre
        radius: of the circle, in the unit of the points
        covariance: of x, y and radius, shape (3, 3), from the scatter of the points about the circle, all independent and
            alike; infinite for three points, which no circle misses
        rms: root of the mean squared distance of the points from the circle

    >>> import numpy as np
    >>> import strainwave as sw
    >>> circle = sw.rig.geometric([1.01, 0.0, -1.0, 0.0], [0.0, 1.0, 0.0, -0.99])
    >>> round(circle.radius, 3), round(circle.rms, 3), round(float(np.sqrt(circle.covariance[2, 2])), 3)
    (1.0, 0.005, 0.005)
    """

    x: float
    y: float
    radius: float
    covariance: Array
    rms: float


def kasa(x: Series, y: Series) -> Circle:
    """Return Kåsa's circle, which the torsional stiffness article uses: least squares of (x - a)^2 + (y - b)^2 - r^2.

    Args:
        x, y: of the points, three or more, not all on a line

    Returns:
        Centre and radius in the unit of the points, and their covariance.

    Raises:
        ValueError: too few points, or all on a line

    >>> fit = kasa([5, 4, 1, -3, -5, -4, 0, 3], [0.1, 3, 4.95, 4, 1.02, -3, -4.97, -4.04])
    >>> round(fit.x, 9), round(fit.y, 9), round(fit.radius, 9)
    (-0.019256772, 0.017582826, 5.019737017)
    """
    points = _Points.of(x, y)
    a, b, rest = solved(np.column_stack((2.0 * points.u, 2.0 * points.v, np.ones(points.count))), points.square)
    return points.circle(a, b, float(np.sqrt(rest + a * a + b * b)))


def pratt(x: Series, y: Series) -> Circle:
    """Return Pratt's circle: Kåsa's squares over 4 r^2, which are the squared distances to first order.

    Args:
        x, y: as of `kasa`

    Raises:
        ValueError: as `kasa`

    >>> round(pratt([1.0, 0.0, -1.0], [0.0, 1.0, 0.0]).radius, 12)
    1.0
    """
    points = _Points.of(x, y)
    matrix = np.zeros((points.count + 1, 4))  # the row of zeros gives three points a fourth axis
    matrix[:-1] = np.column_stack((points.square, points.u, points.v, np.ones(points.count)))
    _, values, axes = np.linalg.svd(matrix, full_matrices=False)
    if values[-1] <= 1e-12 * values[0]:
        return points.conic(*axes[-1])
    root = axes.T * values @ axes
    constraint = np.array([[0.0, 0.0, 0.0, -0.5], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [-0.5, 0.0, 0.0, 0.0]])
    found, vectors = np.linalg.eigh(root @ constraint @ root)
    return points.conic(*np.linalg.solve(root, vectors[:, np.argsort(found)[1]]))  # the smallest eigenvalue that is positive


def taubin(x: Series, y: Series) -> Circle:
    """Return Taubin's circle: Kåsa's squares over the mean squared gradient.

    Args:
        x, y: as of `kasa`

    Raises:
        ValueError: as `kasa`

    >>> round(taubin([1.0, 0.0, -1.0], [0.0, 1.0, 0.0]).radius, 12)
    1.0
    """
    points = _Points.of(x, y)
    mean = float(points.square.mean())
    scaled = (points.square - mean) / (2.0 * np.sqrt(mean))
    axes = np.linalg.svd(np.column_stack((scaled, points.u, points.v)), full_matrices=False)[2]
    a, b, c = axes[-1]
    a /= 2.0 * np.sqrt(mean)
    return points.conic(a, b, c, -mean * a)


def geometric(x: Series, y: Series) -> Circle:
    """Return the circle with the least sum of squared distances: the most likely one if noise is normal and equal all round.

    Gauss-Newton from Taubin's circle, damped where a step does not help.

    Args:
        x, y: as of `kasa`

    Raises:
        ValueError: as `kasa`

    >>> fit = geometric([5, 4, 1, -3, -5, -4, 0, 3], [0.1, 3, 4.95, 4, 1.02, -3, -4.97, -4.04])
    >>> round(fit.x, 8), round(fit.y, 8), round(fit.radius, 8)
    (-0.01893071, 0.01756893, 5.0196117)
    """
    points, start = _Points.of(x, y), taubin(x, y)
    at = np.array([start.x - points.middle[0], start.y - points.middle[1], start.radius]) / points.scale
    distance, slopes = points.distances(*at)
    damping = 0.0
    for _ in range(_MAX_ITERATIONS):
        square = slopes.T @ slopes
        step = np.linalg.solve(square + damping * np.diag(np.diag(square)), -(slopes.T @ distance))
        further, there = points.distances(*(at + step))
        if further @ further <= distance @ distance * (1.0 + 1e-12):  # what rounding makes of a step near the end
            at, distance, slopes, damping = at + step, further, there, damping / 10.0 if damping > 1e-9 else 0.0
        else:
            damping = max(10.0 * damping, 1e-6)
        if np.max(np.abs(step)) <= 1e-13 * at[2]:
            break
    return points.circle(*at)


@dataclass(frozen=True, eq=False)
class _Points:
    """Points about their middle, of the size 1, so that no power of a coordinate swamps another."""

    u: Array
    v: Array
    middle: tuple[float, float]
    scale: float

    @classmethod
    def of(cls, x: Series, y: Series) -> _Points:
        right, up = arguments.numbers("x", x), arguments.numbers("y", y)
        if right.ndim != 1 or right.shape != up.shape:
            raise ValueError(f"x and y have shapes {right.shape} and {up.shape}; they must be series of the same length")
        if len(right) < 3:
            raise ValueError(f"a circle needs three points or more, not {len(right)}")
        if not (np.all(np.isfinite(right)) and np.all(np.isfinite(up))):
            raise ValueError("x and y must be finite")
        middle = float(right.mean()), float(up.mean())
        u, v = right - middle[0], up - middle[1]
        spread = np.linalg.svd(np.column_stack((u, v)), compute_uv=False)
        if spread[1] <= 1e-10 * spread[0]:
            raise ValueError("the points lie on a line; a circle needs three that do not")
        scale = float(np.sqrt(np.mean(u * u + v * v)))
        return cls(u / scale, v / scale, middle, scale)

    @property
    def count(self) -> int:
        return len(self.u)

    @property
    def square(self) -> Array:
        return self.u**2 + self.v**2

    def distances(self, a: float, b: float, radius: float) -> tuple[Array, Array]:
        """Outwards, shape (n,), and their derivatives by a, b and radius, shape (n, 3)."""
        du, dv = self.u - a, self.v - b
        reach = np.maximum(np.hypot(du, dv), 1e-300)
        return reach - radius, np.column_stack((-du / reach, -dv / reach, -np.ones(self.count)))

    def conic(self, a: float, b: float, c: float, d: float) -> Circle:
        """The circle a (u^2 + v^2) + b u + c v + d = 0."""
        if abs(a) <= 1e-10 * np.hypot(b, c):
            raise ValueError("the points lie on a line within their noise; a circle needs three that do not")
        return self.circle(-b / (2.0 * a), -c / (2.0 * a), float(np.sqrt(b * b + c * c - 4.0 * a * d) / (2.0 * abs(a))))

    def circle(self, a: float, b: float, radius: float) -> Circle:
        distance, slopes = self.distances(a, b, radius)
        total = float(distance @ distance)
        if self.count > 3:
            covariance = normal_inverse(slopes) * (total / (self.count - 3)) * self.scale**2
        else:
            covariance = np.full((3, 3), np.inf)
        covariance.flags.writeable = False
        centre = self.middle[0] + self.scale * a, self.middle[1] + self.scale * b
        rms = self.scale * float(np.sqrt(total / self.count))
        return Circle(float(centre[0]), float(centre[1]), float(self.scale * radius), covariance, rms)


@dataclass(frozen=True)
class Ellipse:
    """All p with |M (p - centre)| = 1, where M is symmetric; of a circle it is the unit matrix over its radius.

    Attributes:
        x, y: its centre [px]
        xx, xy, yy: the matrix M [1/px]
    """

    x: float
    y: float
    xx: float
    xy: float
    yy: float

    @property
    def radius(self) -> float:
        """The geometric mean of both half-axes [px]."""
        return float(1.0 / np.sqrt(self.xx * self.yy - self.xy**2))

    @property
    def half_axes(self) -> tuple[float, float]:
        """The longer, the shorter [px]."""
        mean, half = 0.5 * (self.xx + self.yy), float(np.hypot(0.5 * (self.xx - self.yy), self.xy))
        return 1.0 / (mean - half), 1.0 / (mean + half)

    @property
    def short_direction(self) -> float:
        """Return the direction of the shorter axis, from x towards the top of the picture, from -pi/2 to pi/2 [rad]."""
        return float(-0.5 * np.arctan2(2.0 * self.xy, self.xx - self.yy))

    def points(self, turn: Array) -> tuple[Array, Array]:
        """The points centre + M^-1 (cos turn, sin turn) of the curve."""
        determinant = self.xx * self.yy - self.xy**2
        cosine, sine = np.cos(turn), np.sin(turn)
        right, down = self.yy * cosine - self.xy * sine, self.xx * sine - self.xy * cosine
        return self.x + right / determinant, self.y + down / determinant

    def turns(self, x: Array, y: Array) -> Array:
        """The `turn` of the point of the curve on the ray to each point."""
        u, v = self._scaled(x, y)
        turn: Array = np.arctan2(v, u)
        return turn

    def distance(self, x: Array, y: Array) -> Array:
        """Return the distance of points outside the ellipse [px], to first order."""
        u, v = self._scaled(x, y)
        reach = np.maximum(np.sqrt(u * u + v * v), 1e-9)
        a, b = self.xx * u + self.xy * v, self.xy * u + self.yy * v
        slope: Array = np.maximum(np.sqrt(a * a + b * b), reach / (4.0 * self.radius))  # which the centre alone makes larger
        return (reach - 1.0) * reach / slope

    def normal(self, x: Array, y: Array) -> tuple[Array, Array]:
        """Both components of the direction outwards at points."""
        u, v = self._scaled(x, y)
        a, b = self.xx * u + self.xy * v, self.xy * u + self.yy * v
        slope = np.maximum(np.sqrt(a * a + b * b), 1e-300)
        return a / slope, b / slope

    def _scaled(self, x: Array, y: Array) -> tuple[Array, Array]:
        """M (p - centre)."""
        right, down = x - self.x, y - self.y
        return self.xx * right + self.xy * down, self.xy * right + self.yy * down


def circle(x: float, y: float, radius: float) -> Ellipse:
    """The ellipse that is this circle."""
    return Ellipse(x, y, 1.0 / radius, 0.0, 1.0 / radius)


def fit_ellipse(x: Array, y: Array, start: Ellipse, tolerance: float = 1e-8) -> Ellipse:
    """The ellipse with the least sum of squared distances, by Gauss-Newton.

    Args:
        x, y: points near it all round [px], shape (n,), n >= 5
        start: near the result
        tolerance: of the last step, relative to the radius

    Raises:
        numpy.linalg.LinAlgError: the points do not determine an ellipse
    """
    at, scale = np.array([start.x, start.y, start.xx, start.xy, start.yy]), start.radius
    size = np.array([scale, scale, 1.0 / scale, 1.0 / scale, 1.0 / scale])
    for _ in range(_MAX_ELLIPSE_ITERATIONS):
        distance, slopes = _slopes(Ellipse(*at.tolist()), x, y)
        square = slopes.T @ slopes
        step = np.linalg.solve(square, -(slopes.T @ distance))
        if not np.max(np.abs(step) / size) < 0.5:
            raise np.linalg.LinAlgError("the points do not determine an ellipse")
        at += step
        if np.max(np.abs(step) / size) < tolerance:
            break
    return Ellipse(*at.tolist())


def centre_covariance(curve: Ellipse, x: Array, y: Array) -> Array:
    """Return the covariance of a fitted ellipse's centre over the variance of a distance, shape (2, 2)."""
    _, slopes = _slopes(curve, x, y)
    return normal_inverse(slopes)[:2, :2]


def _slopes(curve: Ellipse, x: Array, y: Array) -> tuple[Array, Array]:
    """Distances, and their derivatives by the parameters, as they are on the curve."""
    a, b = curve.normal(x, y)
    right, down = x - curve.x, y - curve.y
    u, v = curve.xx * right + curve.xy * down, curve.xy * right + curve.yy * down
    reach = np.sqrt(u * u + v * v)
    u, v = u / reach, v / reach
    slope = np.hypot(curve.xx * u + curve.xy * v, curve.xy * u + curve.yy * v)
    return curve.distance(x, y), np.column_stack((-a, -b, u * right / slope, (u * down + v * right) / slope, v * down / slope))
