r"""Test for a pure couple: a shaft that is pushed aside as well moves the centre about which its markers turn.

The point midway between the markers is, at angle :math:`\theta` and torque T,

.. math:: m = c + R(\theta) u + b T

with the centre c, the arm u of that point, and the shift b of the shaft per torque: of a pure couple b = 0. Least squares over
all photographs give the three.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from strainwave.presentation import Statement
from strainwave.rig.bench.setup import Rig
from strainwave.rig.bench.steps import Step
from strainwave.rig.bench.torque import Torque
from strainwave.rig.vision.angle import Angles
from strainwave.rig.vision.camera import changes_nothing, flat
from strainwave.statistics.linear_fit import normal_inverse

Array = NDArray[np.float64]
MIN_SHIFT_SIGMA = 4.0  # standard deviations beyond which a shift is reported
MIN_PHOTOGRAPHS = 6  # three vectors are fitted


@dataclass(frozen=True)
class Couple(Statement):
    """Shift of the centre of a turning shaft with the torque.

    Attributes:
        shift: of the centre per torque, right and up in the picture [px/(N.m)]
        sigma: standard deviation of each of both [px/(N.m)]
        rms: distance of the points from the fit [px]
        scale: size of a pixel at the target [m]; None where the distance of the markers is not known
        span: of the torque [N.m]
    """

    shift: tuple[float, float]
    sigma: float
    rms: float
    scale: float | None
    span: float

    @property
    def size(self) -> float:
        """Return the size of the shift [px/(N.m)]."""
        return float(np.hypot(*self.shift))

    @property
    def pure(self) -> bool:
        """True if the shift can be chance."""
        return self.size <= MIN_SHIFT_SIGMA * self.sigma

    def _headline(self) -> str:
        """The finding in one line."""
        moved = f"{self.size * self.span:.3g} px"
        if self.scale is not None:
            moved += f" ({1e6 * self.size * self.span * self.scale:.3g} um)"
        least = f"± {self.sigma * self.span:.2g} px over the span of the torque"
        if self.pure:
            return f"the centre of rotation stays within {least}: nothing speaks against a pure couple"
        return f"the centre of rotation moves by {moved} {least}: the torque was no pure couple, or the shaft's bearing yields"


def couple(middle: Array, angle: Array, torque: Array, scale: float | None = None) -> Couple:
    """Fit the centre, the arm and the shift to the points midway between the markers.

    Args:
        middle: of each photograph, right and up [px], shape (n, 2), n >= 6
        angle: of the shaft [rad], shape (n,)
        torque: on the shaft [N.m], shape (n,)
        scale: size of a pixel at the target [m]

    Raises:
        ValueError: too few photographs, or torque and angle do not separate the three

    >>> angle, torque = np.array([0.0, -0.3, -0.9, -1.0, -0.6, -0.1]), np.array([0.3, 0.1, -0.2, -0.3, 0.0, 0.3])
    >>> arm = np.stack([30.0 * np.cos(angle), 30.0 * np.sin(angle)], axis=1)
    >>> found = couple(arm + [320.0, -240.0] + np.outer(torque, [2.0, 0.0]), angle, torque)
    >>> round(found.size, 6), found.pure
    (2.0, False)
    """
    n = len(angle)
    if n < MIN_PHOTOGRAPHS:
        raise ValueError(f"the centre of rotation needs {MIN_PHOTOGRAPHS} photographs or more, not {n}")
    one, zero, c, s = np.ones(n), np.zeros(n), np.cos(angle), np.sin(angle)
    right = np.stack([one, zero, c, -s, torque, zero], axis=1)
    up = np.stack([zero, one, s, c, zero, torque], axis=1)
    design, seen = np.concatenate([right, up]), np.concatenate([middle[:, 0], middle[:, 1]])
    fit, _, rank, _ = np.linalg.lstsq(design, seen)
    if rank < 6:
        raise ValueError("torque and angle change together: they do not separate a shift of the shaft from its turn")
    residual = seen - design @ fit
    variance = float(residual @ residual) / (2 * n - 6)
    sigma = float(np.sqrt(variance * normal_inverse(design)[4, 4]))
    return Couple((float(fit[4]), float(fit[5])), sigma, float(np.sqrt(np.mean(residual**2))), scale, float(np.ptp(torque)))


def couple_of(angles: Angles, steps: Sequence[Step], torque: Torque, rig: Rig) -> Couple:
    """Fit the shift of the centre of rotation with the torque in a test.

    Args:
        angles: of the photographs
        steps: of the same position and unit, or more
        torque: of these steps
        rig: its camera, and the distance of the markers

    Raises:
        ValueError: as `couple`
    """
    of_image = {step.image: float(each) for step, each in zip(steps, torque.shaft, strict=True)}
    rows = [row for row, frame in enumerate(angles.useful) if np.isfinite(of_image.get(frame.name, np.nan))]
    centres = np.array([_centres(angles, row, rig) for row in rows]).reshape(-1, 2, 2)
    middle = centres.mean(axis=1) * [1.0, -1.0]
    apart = float(np.mean(np.hypot(*(centres[:, 1] - centres[:, 0]).T))) if rows else 0.0
    scale = rig.markers_distance.value / apart if rig.markers_distance is not None and apart > 0.0 else None
    return couple(middle, angles.angle[rows], np.array([of_image[angles.useful[row].name] for row in rows]), scale)


def _centres(angles: Angles, row: int, rig: Rig) -> Array:
    """Both markers of a photograph in the plane of the target [px], shape (2, 2)."""
    frame = angles.useful[row]
    points = np.array([[marker.x, marker.y] for marker in frame.markers or ()])
    return points if changes_nothing(rig.camera) else flat(points, rig.camera, (frame.size[1], frame.size[0]))


def remarks_on_couple(angles: Angles, steps: Sequence[Step], torque: Torque, rig: Rig) -> Iterator[str]:
    """Yield a remark if the centre of rotation contradicts a pure couple; none if the test does not determine it."""
    if not {frame.name for frame in angles.useful} & {step.image for step in steps}:
        return
    try:
        found = couple_of(angles, steps, torque, rig)
    except ValueError:
        return
    if not found.pure:
        yield str(found)
