"""Circular markers in a picture."""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass
from math import inf

import numpy as np
from numpy.typing import NDArray

from strainwave import arguments
from strainwave.presentation import Presented
from strainwave.rig.bench.setup import Camera
from strainwave.rig.vision.blob import blobs
from strainwave.rig.vision.camera import PERFECT, changes_nothing, flat, in_picture
from strainwave.rig.vision.edge import WIDE_ARC, Edge, edge, fit_points, oblong
from strainwave.rig.vision.outline import Grey, outline

Array = NDArray[np.float64]
SMALLEST_RADIUS = 6.0  # px, unless another is given
_LEAST_ARC, _SHORTEST_ARC = 0.5, 0.25  # share of the edge [1]: of a marker, and of what a message mentions
_MIN_CONTRAST_RATIO = 0.3  # contrast of an edge over the contrast around it [1]
_MAX_RESIDUAL_SHARE = 0.02  # residual of an edge over its radius [1]
_MAX_SHARE_IF_SMALL, _MAX_RESIDUAL_IF_SMALL = 0.05, 0.5  # of a small marker: residual over its radius [1], and residual in px


@dataclass(frozen=True)
class Marker(Presented):
    """A circular marker in an image; x points right, y down, and the middle of the first pixel is 0, 0.

    Attributes:
        x, y: its centre [px]
        radius: mean radius of its edge [px]
        covariance: of x with itself, of x with y, of y with itself [px^2]
        residual: rms distance of the edge from the fitted curve [px]
        contrast: difference of brightness across the edge, of the full scale [1]
        blur: standard deviation of the edge's spread [px]
        arc: share of the edge that was seen and used [1]
        dark: whether it is darker than the ground
        ratio: of the shorter axis to the longer, where the camera is known after its tilt was undone [1]; 1 where less than
            six tenths of the edge are seen
        short_direction: of the shorter axis, from x towards the top of the image [rad]
        ratio_sigma: standard deviation of the ratio, along the axes and between them [1]
        clipped: share of the pixels inside or outside of the edge that are at an end of the scale [1]

    >>> import numpy as np
    >>> import strainwave as sw
    >>> scene = sw.rig.Scene(size=(320, 240), radius=20.0, distance=150.0)
    >>> image = sw.rig.as_image("001.png", sw.rig.render(scene, 0.0, np.random.default_rng(1)))
    >>> marker = sw.rig.find_markers(image.grey)[0]
    >>> round(marker.x, 2), round(marker.y, 2), round(marker.radius, 2), marker.dark
    (84.5, 119.5, 20.01, True)
    """

    x: float
    y: float
    radius: float
    covariance: tuple[float, float, float]
    residual: float
    contrast: float
    blur: float
    arc: float
    dark: bool = True
    ratio: float = 1.0
    short_direction: float = 0.0
    ratio_sigma: float = inf
    clipped: float = 0.0

    @property
    def sigma(self) -> float:
        """Standard deviation of a coordinate of the centre [px]: root of the mean of both variances."""
        return math.sqrt(0.5 * (self.covariance[0] + self.covariance[2]))


def find_markers(
    grey: Grey,
    *,
    radius: tuple[float, float] | None = None,
    dark: bool | None = None,
    camera: Camera = PERFECT,
) -> list[Marker]:
    """Return all round markers of a picture, the larger before the smaller.

    Spots are searched for by local brightness. The edge of each is found by radial profiles, outliers left out, and a circle
    fitted by distance: an ellipse if its points clearly require it. With a camera that is known, the points are first brought
    into the plane of the target, where the edge is a circle again, whose centre an ellipse does not show.

    Args:
        grey: brightness, of the full scale, shape (height, width)
        radius: the smallest and the largest that a marker may have [px]; from 6 px to half the picture if None
        dark: whether markers are darker than the ground; either if None
        camera: what it does to lengths

    Returns:
        Centres and radii [px] with their covariance; none if there are no markers.

    Raises:
        ValueError: a radius out of order; a camera that cannot have taken this picture; more than 1000 spots of this size

    >>> from strainwave.rig.virtual.render import Scene, render
    >>> scene = Scene(size=(320, 240), radius=20.0, distance=150.0, blur=1.0)
    >>> picture = render(scene, 0.0, np.random.default_rng(1)).astype(np.float32) / 255.0
    >>> [(round(marker.x, 1), round(marker.y, 1), round(marker.radius, 1)) for marker in find_markers(picture)]
    [(84.5, 119.5, 20.0), (234.5, 119.5, 20.0)]
    """
    return found_and_partial(grey, radius, dark, camera)[0]


def found_and_partial(
    grey: Grey, radius: tuple[float, float] | None, dark: bool | None, camera: Camera
) -> tuple[list[Marker], list[Marker]]:
    """Markers, and what looks like one of which less than half of the edge is seen."""
    low, high = _limits(grey.shape, radius)
    found: list[Marker] = []
    for blob in blobs(grey, low, high):
        if dark is not None and blob.dark != dark:
            continue
        rough = outline(grey, blob.x, blob.y, blob.radius, blob.dark)
        if rough is None or rough.arc < _SHORTEST_ARC or rough.contrast < _MIN_CONTRAST_RATIO * blob.contrast:
            continue
        if not 0.8 * low <= rough.curve.radius <= 1.2 * high:
            continue
        fine = edge(grey, rough)
        if fine is not None and _is_round(fine, blob.dark) and low <= fine.curve.radius <= high:
            found.append(_marker(fine, camera, grey.shape, blob.dark))
    found = _without_rings(sorted(found, key=lambda each: (-round(each.radius), each.x, each.y)))
    return [each for each in found if each.arc >= _LEAST_ARC], [each for each in found if each.arc < _LEAST_ARC]


def _limits(shape: tuple[int, ...], radius: tuple[float, float] | None) -> tuple[float, float]:
    if radius is None:
        return SMALLEST_RADIUS, 0.5 * min(shape)
    low = arguments.number("radius[0]", radius[0], "px", brackets="[)", low=2.0)
    return low, arguments.number("radius[1]", radius[1], "px", low=low)


def _is_round(fine: Edge, dark: bool) -> bool:
    longer, shorter = fine.curve.half_axes
    smooth = fine.residual <= max(
        _MAX_RESIDUAL_SHARE * fine.curve.radius, min(_MAX_SHARE_IF_SMALL * fine.curve.radius, _MAX_RESIDUAL_IF_SMALL)
    )
    return smooth and shorter > 0.4 * longer and (fine.outside > fine.inside) == dark


def _marker(fine: Edge, camera: Camera, shape: tuple[int, ...], dark: bool) -> Marker:
    curve, covariance = fine.curve, fine.covariance
    x, y, radius = curve.x, curve.y, curve.radius
    points = np.column_stack((fine.x, fine.y))
    if not changes_nothing(camera):
        size = (shape[0], shape[1])
        points = flat(points, camera, size)
        curve, _, _ = fit_points(points[:, 0], points[:, 1], fine.arc)
        (x, y), _ = in_picture(np.array([curve.x, curve.y]), camera, size, np.array([x, y]))
    squeezed, sigma = oblong(points[:, 0], points[:, 1], curve, fine.residual) if fine.arc >= WIDE_ARC else (0j, inf)
    return Marker(
        x=float(x),
        y=float(y),
        radius=radius + 0.5 * fine.blur**2 / radius,  # the blurred edge of a disc lies that far inside
        covariance=(float(covariance[0, 0]), float(covariance[0, 1]), float(covariance[1, 1])),
        residual=fine.residual,
        contrast=abs(fine.outside - fine.inside),
        blur=fine.blur,
        arc=fine.arc,
        dark=dark,
        ratio=1.0 - abs(squeezed),
        short_direction=0.5 * cmath.phase(squeezed),
        ratio_sigma=sigma,
        clipped=fine.clipped,
    )


def _without_rings(markers: list[Marker]) -> list[Marker]:
    """Return the outermost of markers with the same centre: a marker may have a ring or a hole."""
    kept: list[Marker] = []
    for marker in markers:
        if all(math.hypot(marker.x - each.x, marker.y - each.y) > 0.5 * each.radius for each in kept):
            kept.append(marker)
    return kept
