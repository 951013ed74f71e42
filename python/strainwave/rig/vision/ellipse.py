"""Circle and ellipse by distance: a circle that is seen askew is an ellipse."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from strainwave.statistics.linear_fit import normal_inverse

Array = NDArray[np.float64]
_MAX_ITERATIONS = 20  # of the ellipse fit


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
    for _ in range(_MAX_ITERATIONS):
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
