"""Pictures of a turned target as a camera would take them."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from strainwave import arguments
from strainwave.rig.bench.setup import Camera, Rig

Array = NDArray[np.float64]
CELLS_PER_PIXEL = 4  # each way, on which edges are computed
POINTS_PER_EDGE = 2048  # of a marker: the sagitta between two is 5e-5 px at a radius of 40 px


@dataclass(frozen=True)
class Scene:
    """Two round markers on a turning target, the light on it, and the camera that looks at it.

    Lengths are pixels of a picture without errors of the camera; the middle of its first pixel is 0, 0, x points right, y down.

    Args:
        size: width and height of the picture [px]
        radius: of each marker [px]
        distance: between the centres of the markers [px]
        middle: about which the target turns [px], x and y; the middle of the picture if None
        offset: of the point midway between the markers from there, at angle 0 [px], right and down
        direction: from the first marker to the second at angle 0 [rad], from x towards the top of the picture
        markers: brightness of each marker, of the full scale [1]; a marker as bright as the ground is not seen
        ground: brightness around them, of the full scale [1]
        gradient: change of the illumination over the width of the picture, relative to that in its middle [1]
        gradient_direction: in which it becomes brighter [rad], from x towards the top of the picture
        exposure: times the brightness; what exceeds the full scale is clipped [1]
        blur: standard deviation of the spread of a point by lens and motion [px]
        noise: standard deviation of each pixel by itself, of the full scale [1]
        bits: of a pixel, 8 or 16
        camera: what it does to lengths

    Raises:
        ValueError: a number out of its range

    >>> Scene(size=(320, 240), radius=15.0, distance=120.0).bits
    8
    """

    size: tuple[int, int] = (640, 480)
    radius: float = 40.0
    distance: float = 300.0
    middle: tuple[float, float] | None = None
    offset: tuple[float, float] = (0.0, 0.0)
    direction: float = 0.0
    markers: tuple[float, float] = (0.12, 0.12)
    ground: float = 0.78
    gradient: float = 0.0
    gradient_direction: float = 0.0
    exposure: float = 1.0
    blur: float = 1.2
    noise: float = 0.0
    bits: int = 8
    camera: Camera = field(default_factory=Camera)

    def __post_init__(self) -> None:
        for axis, pixels in zip(("width", "height"), self.size, strict=True):
            arguments.whole(f"size: {axis}", pixels, 8, 20_000)
        for name in ("radius", "distance", "exposure"):
            arguments.number(name, getattr(self, name), low=0.0)
        for name in ("ground", "blur", "noise"):
            arguments.number(name, getattr(self, name), brackets="[)", low=0.0)
        for i, brightness in enumerate(self.markers):
            arguments.number(f"markers[{i}]", brightness, brackets="[)", low=0.0)
        arguments.number("gradient", self.gradient, low=-2.0, high=2.0)
        if self.bits not in (8, 16):
            raise ValueError(f"bits = {self.bits} must be 8 or 16")

    def centres(self, angle: float) -> Array:
        """Return the centres of the markers in the picture after a turn by `angle` [rad], px, shape (2, 2)."""
        return seen(self._flat_centres(angle), self.camera, self.size)

    def _flat_centres(self, angle: float) -> Array:
        width, height = self.size
        middle = self.middle or ((width - 1) / 2.0, (height - 1) / 2.0)
        along = self.distance / 2.0 * np.array([np.cos(self.direction), -np.sin(self.direction)])
        at_zero = np.array([self.offset - along, self.offset + along])
        cosine, sine = np.cos(angle), np.sin(angle)  # against the clock, y pointing down
        turned: Array = middle + at_zero @ np.array([[cosine, -sine], [sine, cosine]])
        return turned


def usual_scene(rig: Rig) -> Scene:
    """Return the scene of a rig's camera: two markers, noise of an 8-bit camera, light from one side.

    >>> from strainwave.rig import load
    >>> round(255.0 * usual_scene(load("couple-rig")).noise, 9)
    4.0
    """
    return Scene(camera=rig.camera, gradient=0.3, noise=4.0 / 255.0)


def seen(points: Array, camera: Camera, size: tuple[int, int]) -> Array:
    """Return the places in the picture of points in the plane of the target.

    The plane is turned by the tilt about a line through the centre, seen in perspective, distorted by the lens, and divided
    into pixels, in this order. A camera that does nothing sees each point where it is.

    Args:
        points: x and y, as a camera that does nothing sees them [px], shape (n, 2)
        camera: what it does
        size: width and height of the picture [px]

    Returns:
        x and y in the picture [px], shape (n, 2)

    >>> seen(np.array([[420.0, 240.0]]), Camera(radial=(1e-6, 0.0), centre=(320.0, 240.0)), (640, 480))
    array([[421., 240.]])
    """
    centre = np.array(camera.centre or ((size[0] - 1) / 2.0, (size[1] - 1) / 2.0))
    right, up = (points[:, 0] - centre[0]), -(points[:, 1] - centre[1])
    cosine, sine = np.cos(camera.tilt_direction), np.sin(camera.tilt_direction)
    receding, across = right * cosine + up * sine, up * cosine - right * sine
    depth = 1.0 if camera.distance is None else 1.0 + receding * np.sin(camera.tilt) / camera.distance
    receding, across = receding * np.cos(camera.tilt) / depth, across / depth
    square = receding**2 + across**2
    stretch = 1.0 + camera.radial[0] * square + camera.radial[1] * square**2
    right, up = stretch * (receding * cosine - across * sine), stretch * (across * cosine + receding * sine)
    return np.column_stack((centre[0] + right / camera.aspect, centre[1] - up))


def render(scene: Scene, angle: float, random: np.random.Generator) -> NDArray[Any]:
    """Return the picture of a target that has turned by an angle.

    The share of each pixel that a marker covers is exact to 1e-4, blurred by a Gaussian that is integrated over the
    pixel: no edge is moved by a grid.

    Args:
        scene: what is seen
        angle: of the target, against the clock [rad]
        random: gives the noise

    Returns:
        grey values, uint8 or uint16, shape (height, width)

    >>> picture = render(Scene(), 0.1, np.random.default_rng(1))
    >>> picture.shape, picture.dtype.name, int(picture.min()), int(picture.max())
    ((480, 640), 'uint8', 31, 199)
    """
    light = np.full(scene.size[::-1], scene.ground, np.float32)
    for brightness, centre in zip(scene.markers, scene._flat_centres(angle), strict=True):
        _add(light, (brightness - scene.ground), scene, _edge(scene, centre))
    light *= _illumination(scene)
    if scene.noise > 0.0:
        light += np.float32(scene.noise) * random.standard_normal(light.shape, np.float32)
    full = 2**scene.bits - 1
    np.clip(light, 0.0, 1.0, out=light)
    light *= full
    return np.rint(light, out=light).astype(np.uint8 if scene.bits == 8 else np.uint16)


def _illumination(scene: Scene) -> NDArray[np.float32]:
    width, height = scene.size
    right = (np.arange(width) - (width - 1) / 2.0) * (np.cos(scene.gradient_direction) / width)
    up = ((height - 1) / 2.0 - np.arange(height)) * (np.sin(scene.gradient_direction) / width)
    rows, columns = scene.exposure * (1.0 + scene.gradient * up), scene.exposure * scene.gradient * right
    plane: NDArray[np.float32] = rows.astype(np.float32)[:, None] + columns.astype(np.float32)
    np.maximum(plane, np.float32(0.0), out=plane)
    return plane


@dataclass(frozen=True)
class _Edge:
    """The edge of a marker in the picture, in polar coordinates about the image of its centre.

    Attributes:
        centre: x and y [px]
        turn: rising angles over more than a full turn [rad]
        reach: radius at each [px]
        slope: its derivative over the angle, relative to it [1]
    """

    centre: Array
    turn: Array
    reach: Array
    slope: Array

    def inside(self, x: Array, y: Array) -> tuple[Array, Array]:
        """Return the depth of points inside the edge [px], and the direction of its normal [rad]; exact near the edge."""
        right, down = x - self.centre[0], y - self.centre[1]
        at = np.arctan2(down, right)
        slope = np.interp(at, self.turn, self.slope)
        depth = (np.interp(at, self.turn, self.reach) - np.hypot(right, down)) / np.sqrt(1.0 + slope**2)
        return depth, at - np.arctan(slope)


def _edge(scene: Scene, centre: Array) -> _Edge:
    turn = 2.0 * np.pi * np.arange(POINTS_PER_EDGE) / POINTS_PER_EDGE
    circle = centre + scene.radius * np.column_stack((np.cos(turn), np.sin(turn)))
    image, (middle,) = seen(circle, scene.camera, scene.size), seen(centre[None], scene.camera, scene.size)
    (right, down) = (image - middle).T
    at, reach = np.arctan2(down, right), np.hypot(right, down)
    order = np.argsort(at)
    around, reach = at[order], reach[order]
    around = np.concatenate(([around[-1] - 2.0 * np.pi], around, [around[0] + 2.0 * np.pi]))
    reach = np.concatenate((reach[-1:], reach, reach[:1]))
    return _Edge(middle, around, reach, np.gradient(np.log(reach), around))


def _add(light: NDArray[np.float32], step: float, scene: Scene, edge: _Edge) -> None:
    """Add a blurred marker that differs by a step of brightness from what is there."""
    taps = _spread(scene.blur)
    beyond = len(taps) // CELLS_PER_PIXEL // 2  # pixels that a point spreads over, each way
    low, high = (edge.centre + sign * (edge.reach.max() + beyond) for sign in (-1.0, 1.0))
    first, last = np.floor(low).astype(int), np.ceil(high).astype(int)
    x, y = (np.arange(a - beyond, b + beyond + 1) for a, b in zip(first, last, strict=True))
    rows, columns = (np.clip([a, b + 1], 0, n) for a, b, n in zip(first[::-1], last[::-1], light.shape, strict=True))
    if rows[0] == rows[1] or columns[0] == columns[1]:
        return
    share = _blurred(_blurred(_covered(edge, x, y), taps).T, taps).T
    within = share[rows[0] - first[1] : rows[1] - first[1], columns[0] - first[0] : columns[1] - first[0]]
    light[rows[0] : rows[1], columns[0] : columns[1]] += (step * within).astype(np.float32)


def _blurred(share: Array, taps: Array) -> Array:
    """Return the share of each pixel, from the cells above and below it."""
    windows = np.lib.stride_tricks.sliding_window_view(share, len(taps), axis=0)[::CELLS_PER_PIXEL]
    taken: Array = np.einsum("ijk,k->ij", windows, taps)
    return taken


def _covered(edge: _Edge, x: NDArray[np.int_], y: NDArray[np.int_]) -> Array:
    """The share of each cell of these pixels that the marker covers, shape (CELLS_PER_PIXEL len(y), CELLS_PER_PIXEL len(x))."""
    depth, _ = edge.inside(*np.broadcast_arrays(x.astype(float), y[:, None].astype(float)))
    share: Array = np.repeat(np.repeat((depth > 0.0).astype(np.float64), CELLS_PER_PIXEL, axis=0), CELLS_PER_PIXEL, axis=1)
    row, column = np.nonzero(np.abs(depth) < 1.5)
    within = (np.arange(CELLS_PER_PIXEL) + 0.5) / CELLS_PER_PIXEL - 0.5
    fine_x = np.broadcast_to(x[column][:, None, None] + within, (len(row), CELLS_PER_PIXEL, CELLS_PER_PIXEL))
    fine_y = np.broadcast_to(y[row][:, None, None] + within[:, None], (len(row), CELLS_PER_PIXEL, CELLS_PER_PIXEL))
    covered = _half_plane(*edge.inside(fine_x, fine_y))
    cells = share.reshape(len(y), CELLS_PER_PIXEL, len(x), CELLS_PER_PIXEL).transpose(0, 2, 1, 3)
    cells[row, column] = covered
    return share


def _half_plane(depth: Array, normal: Array) -> Array:
    """The share of a cell that lies on the inner side of a straight edge, whose middle lies `depth` [px] inside of it.

    A square's shadow along the normal is that of two boxes, one after the other: a trapezium, here integrated.
    """
    wide, narrow = (np.maximum(np.abs(f(normal)), 1e-7) / CELLS_PER_PIXEL for f in (np.cos, np.sin))
    corners = ((1.0, 1.0, 1.0), (-1.0, 1.0, -1.0), (-1.0, -1.0, 1.0), (1.0, -1.0, -1.0))
    area = sum(sign * np.maximum(depth + (a * wide + b * narrow) / 2.0, 0.0) ** 2 for sign, a, b in corners)
    share: Array = np.clip(np.asarray(area) / (2.0 * wide * narrow), 0.0, 1.0)
    return share


@cache
def _spread(blur: float) -> Array:
    """Return the weights by which a pixel averages the cells of its row: blur, then the pixel's own width."""
    from scipy.special import ndtr

    beyond = math.ceil(6.0 * blur)
    ends = np.arange(-beyond * CELLS_PER_PIXEL, (beyond + 1) * CELLS_PER_PIXEL + 1) / CELLS_PER_PIXEL - 0.5

    def step(t: Array) -> Array:  # blurred, and integrated
        if blur == 0.0:
            return np.maximum(t, 0.0)
        return np.asarray(t * ndtr(t / blur) + blur / np.sqrt(2.0 * np.pi) * np.exp(-0.5 * (t / blur) ** 2))

    taken: Array = np.diff(step(ends + 0.5) - step(ends - 0.5))
    return taken
