"""From points in a picture to where they lie on the target, in pixels of a picture without errors of the camera."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from strainwave.rig.bench.setup import Camera

Array = NDArray[np.float64]
PERFECT = Camera()
_MAX_ITERATIONS = 50  # of the inverse of the distortion


def flat(points: Array, camera: Camera, shape: tuple[int, int]) -> Array:
    """Return the points of a picture in the plane of the target.

    Undoes, in this order, the shape of the pixels, the distortion of the lens, the perspective, and the foreshortening by the
    tilt. The plane touches the picture at the centre: there, a length across the direction of the tilt keeps its size.

    Args:
        points: x and y in the picture [px], shape (n, 2)
        camera: what it does to lengths
        shape: of the picture, height and width [px]

    Returns:
        x and y in the plane, y pointing down [px], shape (n, 2)

    Raises:
        ValueError: a point that no point of the target can be: beyond where the distortion turns back, or beyond the horizon

    >>> flat(np.array([[421.0, 240.0]]), Camera(radial=(1e-6, 0.0), centre=(320.0, 240.0)), (480, 640))
    array([[420., 240.]])
    """
    if changes_nothing(camera):
        return np.array(points, np.float64)
    centre = np.array(camera.centre or ((shape[1] - 1) / 2.0, (shape[0] - 1) / 2.0))
    right, up = (points[:, 0] - centre[0]) * camera.aspect, centre[1] - points[:, 1]
    shrink = _without_distortion(np.hypot(right, up), camera.radial)
    right, up = right * shrink, up * shrink
    cosine, sine = np.cos(camera.tilt_direction), np.sin(camera.tilt_direction)
    receding, across = right * cosine + up * sine, up * cosine - right * sine
    shift = 0.0 if camera.distance is None else np.sin(camera.tilt) / camera.distance
    foreshortened = np.cos(camera.tilt) - shift * receding
    if np.any(foreshortened <= 0.0):
        raise ValueError(
            f"camera: with tilt = {camera.tilt:g} rad and distance = {camera.distance:g} px, the horizon is in the picture"
        )
    receding = receding / foreshortened
    across = across * (1.0 + shift * receding)
    right, up = receding * cosine - across * sine, across * cosine + receding * sine
    return np.column_stack((centre[0] + right, centre[1] - up))


def in_picture(point: Array, camera: Camera, shape: tuple[int, int], near: Array) -> tuple[Array, Array]:
    """The point of the picture that lies at a point of the plane, and how the latter varies with it, shape (2, 2).

    Args:
        point: x and y in the plane [px]
        near: a point of the picture near the result, where the search begins [px]
    """
    at = np.array(near, np.float64)
    for _ in range(_MAX_ITERATIONS):
        slopes = slopes_at(at, camera, shape)
        step = np.linalg.solve(slopes, point - flat(at[None], camera, shape)[0])
        at += step
        if np.max(np.abs(step)) < 1e-9:
            break
    return at, slopes


def slopes_at(point: Array, camera: Camera, shape: tuple[int, int]) -> Array:
    """Derivatives of the point in the plane (rows) by that in the picture (columns)."""
    half = 0.5
    around = point + half * np.array([[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]])
    there = flat(around, camera, shape)
    return np.column_stack((there[0] - there[1], there[2] - there[3])) / (2.0 * half)


def changes_nothing(camera: Camera) -> bool:
    """True if lengths are the same in the picture and on the target."""
    return replace(camera, sources={}, centre=None, distance=None, tilt_direction=0.0) == PERFECT


def _without_distortion(reach: Array, radial: tuple[float, float]) -> Array:
    """The radius before the lens over that behind it, `reach`, by Newton's method."""
    k1, k2 = radial
    before = reach.copy()
    for _ in range(_MAX_ITERATIONS):
        square = before * before
        slope = 1.0 + 3.0 * k1 * square + 5.0 * k2 * square * square
        if np.any(slope <= 0.0):
            raise ValueError(f"camera: with radial = {radial}, the distortion turns back within the picture")
        step = (before * (1.0 + k1 * square + k2 * square * square) - reach) / slope
        before -= step
        if np.max(np.abs(step), initial=0.0) < 1e-12 * max(1.0, float(np.max(reach, initial=0.0))):
            break
    return np.divide(before, reach, out=np.ones_like(reach), where=reach > 0.0)
