"""Round markers in a photograph of the target: spots by local brightness, the edge of each, and the pair of them."""

from __future__ import annotations

import cmath
import hashlib
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from datetime import datetime
from math import inf
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from strainwave import arguments
from strainwave.files.budget import RefusedFile, read_regular
from strainwave.messages import one_line
from strainwave.presentation import Presented
from strainwave.rig.bench.setup import Camera
from strainwave.rig.vision.camera import PERFECT, changes_nothing, flat, in_picture
from strainwave.rig.vision.decoding import MAX_PICTURE_BYTES, Grey
from strainwave.rig.vision.edge import WIDE_ARC, Edge, edge, fit_points, oblong, outline
from strainwave.rig.vision.image import Image, read_image

Array = NDArray[np.float64]
SMALLEST_RADIUS = 6.0  # px, unless another is given
_LEAST_ARC, _SHORTEST_ARC = 0.5, 0.25  # share of the edge [1]: of a marker, and of what a message mentions
_MIN_CONTRAST_RATIO = 0.3  # contrast of an edge over the contrast around it [1]
_MAX_RESIDUAL_SHARE = 0.02  # residual of an edge over its radius [1]
_MAX_SHARE_IF_SMALL, _MAX_RESIDUAL_IF_SMALL = 0.05, 0.5  # of a small marker: residual over its radius [1], and residual in px
_CELLS_PER_BLOCK = 4  # each way; the local brightness is the mean of a block
_MIN_CONTRAST_SHARE = 0.15  # contrast of a spot, as a share of the contrast of the picture [1]
_MIN_CONTRAST_NOISE = 4.0  # contrast of a spot over the noise of a cell [1]
MAX_SPOTS = 1000  # whose edges are looked at, which takes a few milliseconds each; a target has two
MAX_AREAS = 50_000  # connected cells of the size of a spot, of any shape
_MIN_ARC_SHARE = 0.9  # share of an edge that must be seen [1]; a warning gives a smaller one
_MAX_CLIPPED_SHARE = 0.02  # share of pixels at an end of the scale around an edge [1]; a warning gives a larger one
_MAX_BLUR_SHARE = 0.2  # blur over radius [1]; beyond it, inside and outside cannot be distinguished
_MAX_RADIUS_DIFFERENCE = 0.3  # relative difference of the radii of two markers [1]
_MAX_MARKERS_SHOWN = 4


class TooManySpots(ValueError):  # noqa: N818 - its message is why a picture is of no use
    """A picture has more spots that may be markers than can be looked at."""


@dataclass(frozen=True)
class Blob:
    """A connected spot that is darker, or brighter, than what is around it.

    Attributes:
        x, y: the middle of its box [px]
        radius: half the geometric mean of the sides of its box [px]
        dark: whether it is the darker one
        whole: whether it lies within the picture with all its edge
        contrast: of the brightest and the darkest around it, of the full scale
    """

    x: float
    y: float
    radius: float
    dark: bool
    whole: bool
    contrast: float


def blobs(grey: Grey, low: float, high: float) -> list[Blob]:
    """Spots whose radius lies between `low` and `high` [px] and whose box and area are not those of anything but a disc.

    A cell is dark if it lies below the middle between the darkest and the brightest block around it, within half the picture.

    Raises:
        TooManySpots: there are more than `MAX_SPOTS`
    """
    side = int(np.clip(low / 2.0, 1.0, 8.0))
    cells = averaged(grey, side)
    middle, contrast, clear = _middle(cells)
    found = []
    for dark in (True, False):
        mask = (cells < middle) if dark else (cells > middle)
        found += list(_spots(mask & clear, contrast, side, dark, low, high))
    if len(found) > MAX_SPOTS:
        raise TooManySpots(_too_many(len(found), MAX_SPOTS))
    return found


def _too_many(count: int, most: int) -> str:
    return f"{count} spots may be markers, and {most} can be looked at; limit them by radius=(least, most) in px"


def averaged(grey: Grey, side: int) -> Grey:
    """Means over squares of `side` pixels; what is left over at the right and the lower edge is cut off.

    >>> averaged(np.array([[0.0, 1.0, 5.0], [1.0, 2.0, 5.0]], np.float32), 2)
    array([[1.]], dtype=float32)
    """
    if side == 1:
        return grey
    height, width = (n // side * side for n in grey.shape)
    rows = grey[0:height:side, :width].copy()
    for i in range(1, side):
        rows += grey[i:height:side, :width]
    cells = rows[:, 0::side].copy()
    for i in range(1, side):
        cells += rows[:, i::side]
    cells *= np.float32(1.0 / side**2)
    return cells


def _middle(cells: Grey) -> tuple[Grey, Grey, NDArray[np.bool_]]:
    """The brightness that parts dark from bright at each cell; the contrast around each block; where that is clear."""
    from scipy.ndimage import maximum_filter, minimum_filter

    height, width = cells.shape
    padded = np.pad(cells, ((0, -height % _CELLS_PER_BLOCK), (0, -width % _CELLS_PER_BLOCK)), mode="edge")
    blocks = averaged(padded, _CELLS_PER_BLOCK)
    window = max(3, min(blocks.shape) // 2)
    brightest, darkest = maximum_filter(blocks, window), minimum_filter(blocks, window)
    contrast = brightest - darkest
    least = max(_MIN_CONTRAST_SHARE * float(blocks.max() - blocks.min()), _MIN_CONTRAST_NOISE * _noise(cells))

    def spread(values: NDArray[np.generic]) -> NDArray[np.generic]:
        return np.repeat(np.repeat(values, _CELLS_PER_BLOCK, axis=0), _CELLS_PER_BLOCK, axis=1)[:height, :width]

    middle: Grey = spread((brightest + darkest) * np.float32(0.5)).astype(np.float32, copy=False)
    return middle, contrast, spread(contrast > least).astype(bool, copy=False)


def _noise(cells: Grey) -> float:
    """Return the noise of a cell, from differences of neighbours; edges are few and do not change the median."""
    sample = cells[:: max(1, cells.shape[0] // 32)]
    return float(np.median(np.abs(np.diff(sample, axis=1))) / (0.6745 * np.sqrt(2.0)))


def _spots(mask: NDArray[np.bool_], contrast: Grey, side: int, dark: bool, low: float, high: float) -> Iterator[Blob]:
    from scipy.ndimage import find_objects, label

    labels, count = label(mask)
    areas = np.bincount(labels.ravel(), minlength=count + 1)[1:] * side**2
    rows, columns = mask.shape
    large = (areas >= 1.2 * low**2) & (areas <= 4.0 * high**2)
    places = np.flatnonzero(large)
    if len(places) > MAX_AREAS:
        raise TooManySpots(_too_many(len(places), MAX_AREAS))
    numbers = np.zeros(count + 1, np.int32)  # of the large ones alone, since the others may be millions
    numbers[places + 1] = np.arange(1, len(places) + 1)
    for i, (down, right) in zip(places, find_objects(numbers[labels]), strict=True):
        height, width = side * (down.stop - down.start), side * (right.stop - right.start)
        radius, share = np.sqrt(height * width) / 2.0, areas[i] / (height * width)
        whole = down.start > 0 and right.start > 0 and down.stop < rows and right.stop < columns
        slender = not 0.4 < width / height < 2.5
        if not low * 0.8 <= radius <= high + 2.0 * side or (whole and (slender or share < 0.5)) or share < 0.3:
            continue
        column, row = ((part.start + part.stop) / 2.0 for part in (right, down))
        around = float(contrast[int(row) // _CELLS_PER_BLOCK, int(column) // _CELLS_PER_BLOCK])
        yield Blob(side * column - 0.5, side * row - 0.5, float(radius), dark, whole, around)


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


@dataclass(frozen=True)
class Frame:
    """Markers and properties of one image.

    Attributes:
        name: of the file
        sha256: of its bytes
        markers: both, always in the same order; none if the image was of no use
        fault: why it was of no use, empty otherwise
        warnings: what makes it doubtful
        size: width and height [px]; 0, 0 if it could not be read
        taken: time by the file, or None
    """

    name: str
    sha256: str
    markers: tuple[Marker, Marker] | None
    fault: str = ""
    warnings: tuple[str, ...] = ()
    size: tuple[int, int] = (0, 0)
    taken: datetime | None = None


def look(
    source: str | Path | Image,
    *,
    camera: Camera = PERFECT,
    radius: tuple[float, float] | None = None,
    dark: bool | None = None,
) -> Frame:
    """Find both markers in an image. `fault` gives the reason if it cannot be read or shows another number of markers.

    Args:
        source: a file, or a picture as `read_image` and `as_image` give it
        camera, radius, dark: as `measure_angles` takes them

    Raises:
        ValueError: a number is out of its range

    >>> look("missing.png").fault
    'cannot be read: No such file or directory'
    """
    if isinstance(source, Image):
        image = source
    else:
        path = Path(source)
        try:
            image = read_image(path)
        except (OSError, ValueError) as error:
            reason = error.strerror or str(error) if isinstance(error, OSError) else str(error)
            return Frame(path.name, _digest(path), None, one_line(f"cannot be read: {reason}"))
    size = (image.grey.shape[1], image.grey.shape[0])
    try:
        found, partial = found_and_partial(image.grey, radius, dark, camera)
    except TooManySpots as error:
        return Frame(image.name, image.sha256, None, str(error), (), size, image.taken)
    pair, fault = _pair(found, partial)
    if not found:
        fault = _nothing(image.grey, partial)
    blurred = [each for each in pair or () if each.blur > _MAX_BLUR_SHARE * each.radius]
    if blurred:
        pair, fault = (
            None,
            f"too blurred: an edge is spread by {blurred[0].blur:.1f} px, at a radius of {blurred[0].radius:.1f} px",
        )
    warnings = tuple(text for i, each in enumerate(pair or (), 1) for text in _warnings(i, each))
    return Frame(image.name, image.sha256, pair, fault, warnings, size, image.taken)


def _digest(path: Path) -> str:
    try:
        return hashlib.sha256(read_regular(path, MAX_PICTURE_BYTES)).hexdigest()
    except (OSError, RefusedFile):
        return ""


def _pair(found: Sequence[Marker], partial: Sequence[Marker]) -> tuple[tuple[Marker, Marker] | None, str]:
    """The two markers; or why there are not two."""
    groups = [[each for each in found if each.dark == dark] for dark in (True, False)]
    groups.sort(key=len, reverse=True)
    most, fewer = groups
    rings = [math.hypot(disc.x - each.x, disc.y - each.y) + each.radius < disc.radius for disc in fewer for each in most]
    if len(most) == 2 and all(rings):  # discs that contain both markers
        return (most[0], most[1]), ""
    if len(found) == 1:
        alike = [
            each
            for each in partial
            if abs(each.radius / found[0].radius - 1.0) < _MAX_RADIUS_DIFFERENCE and each.dark == found[0].dark
        ]
        rest = f"; of another, {_place(alike[0])}, only {alike[0].arc:.0%} of the edge is seen" if alike else ""
        return None, f"one marker instead of two: {_place(found[0])}{rest}"
    shown = ", ".join(f"{'dark' if each.dark else 'bright'} {_place(each)}" for each in found[:_MAX_MARKERS_SHOWN])
    more = f", and {len(found) - _MAX_MARKERS_SHOWN} more" if len(found) > _MAX_MARKERS_SHOWN else ""
    return None, f"{len(found)} markers instead of two: {shown}{more}; select them by radius=(least, most) in px, or by dark"


def _nothing(grey: Grey, partial: Sequence[Marker]) -> str:
    if partial:
        return f"no marker: of one {_place(partial[0])} only {partial[0].arc:.0%} of the edge is seen"
    low, high = (float(each) for each in np.percentile(grey[::2, ::2], (1.0, 99.0)))
    if low >= 0.99:
        return "no marker: over-exposed, nearly all pixels are at full scale"
    if high - low < 0.01:
        return f"no marker: the picture is even, {low:.1%} to {high:.1%} of full scale"
    bright = float(np.mean(grey >= 1.0))
    more = f"; over-exposed, {bright:.0%} of the pixels are at full scale" if bright > 0.2 else ""
    return f"no marker: nothing round with a clear edge{more}"


def _warnings(number: int, marker: Marker) -> list[str]:
    warnings = []
    if marker.arc < _MIN_ARC_SHARE:
        warnings.append(f"marker {number}: {marker.arc:.0%} of the edge is seen; look for shadows, reflections or dirt there")
    if marker.clipped > _MAX_CLIPPED_SHARE:
        share = f"{marker.clipped:.0%} of the pixels on one side of its edge are black or at full scale"
        warnings.append(f"marker {number}: {share}; its centre may be in error by more than its sigma")
    return warnings


def _place(marker: Marker) -> str:
    return f"at x = {marker.x:.0f}, y = {marker.y:.0f} px with radius {marker.radius:.1f} px"
