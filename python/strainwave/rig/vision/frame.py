"""Evaluation of one photograph of the target."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path

import numpy as np

from strainwave.files.budget import RefusedFile, read_regular
from strainwave.messages import one_line
from strainwave.rig.bench.setup import Camera
from strainwave.rig.vision.blob import TooManySpots
from strainwave.rig.vision.camera import PERFECT
from strainwave.rig.vision.decoding import MAX_PICTURE_BYTES, Grey
from strainwave.rig.vision.image import Image, read_image
from strainwave.rig.vision.marker import Marker, found_and_partial

_MIN_ARC_SHARE = 0.9  # share of an edge that must be seen [1]; a warning gives a smaller one
_MAX_CLIPPED_SHARE = 0.02  # share of pixels at an end of the scale around an edge [1]; a warning gives a larger one
_MAX_BLUR_SHARE = 0.2  # blur over radius [1]; beyond it, inside and outside cannot be distinguished
_MAX_RADIUS_DIFFERENCE = 0.3  # relative difference of the radii of two markers [1]
_MAX_MARKERS_SHOWN = 4


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
    if len(most) == 2 and all(_holds(each, most) for each in fewer):
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


def _holds(disc: Marker, markers: Sequence[Marker]) -> bool:
    """True if a disc contains all markers."""
    return all(math.hypot(disc.x - each.x, disc.y - each.y) + each.radius < disc.radius for each in markers)


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
