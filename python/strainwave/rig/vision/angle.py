"""The angle of the shaft in each photograph of a test."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import Path

import numpy as np

from strainwave.messages import quoted, shortened
from strainwave.progress import Progress, in_turn
from strainwave.rig.bench.setup import Camera
from strainwave.rig.vision.camera import PERFECT
from strainwave.rig.vision.follow import Angles, camera_seen, follow
from strainwave.rig.vision.frame import Frame, look
from strainwave.rig.vision.image import VIDEOS, Image, picture_files, video_images
from strainwave.rig.vision.marker import Marker

__all__ = ["Angles", "Frame", "Marker", "camera_seen", "follow", "look", "measure_angles", "turn"]

Source = str | Path | Image
Point = tuple[float, float]


def measure_angles(
    images: Source | Iterable[Source],
    *,
    camera: Camera = PERFECT,
    reference: str | None = None,
    radius: tuple[float, float] | None = None,
    dark: bool | None = None,
    progress: Progress = None,
) -> Angles:
    """Return the angles of a target with two round markers, from its photographs in the order of the test.

    An image that does not show two markers, or cannot be read, has a fault and no angle; the others have theirs. The angle is
    followed from image to image through any number of turns: by the smaller turn where both markers look alike, which is right
    up to 90 degrees from one image to the next, else by which marker is the larger one, right up to 180 degrees.

    Args:
        images: files, or pictures as `read_image` and `as_image` give them; or a folder, or a video
        camera: what it does to lengths
        reference: name of the image whose angle is 0; the first with an angle if None
        radius: the smallest and the largest that a marker may have [px]; from 6 px to half the picture if None
        dark: whether markers are darker than the ground; either if None
        progress: as of `sw.simulate`

    Returns:
        Angles [rad], positive against the clock, and their standard deviations, shape (images with an angle,), and remarks.

    Raises:
        OSError: there is no such folder or video
        ValueError: no image gives an angle; the reference is none of them, or gives none; a number is out of its range
        ImportError: a video, and opencv is not installed

    >>> from strainwave.rig.vision.image import as_image
    >>> from strainwave.rig.virtual.render import Scene, render
    >>> scene, random = Scene(size=(320, 240), radius=20.0, distance=150.0, noise=0.01), np.random.default_rng(1)
    >>> pictures = [as_image(f"{degrees}.png", render(scene, np.radians(degrees), random)) for degrees in (0, 50, 100)]
    >>> np.degrees(measure_angles(pictures).angle).round(1).tolist()
    [0.0, 50.0, 100.0]
    """
    frames = []
    with in_turn(progress) as turn_of:
        for source in _sources(images):
            turn_of(source.name if isinstance(source, Image) else Path(source).name)
            frames.append(look(source, camera=camera, radius=radius, dark=dark))
    return follow(frames, camera=camera, reference=reference)


def turn(before: tuple[Point, Point], after: tuple[Point, Point]) -> float:
    """Return the turn of two markers, counter-clockwise in the picture, within half a turn [rad].

    It is the angle between the vectors from the first marker to the second, by atan2 of their cross and dot products; the
    difference of two arctangents of slopes wraps (erratum T1).

    Args:
        before, after: x and y of both markers in the picture, y pointing down

    Raises:
        ValueError: both markers at the same place

    >>> round(float(np.degrees(turn(((0, 0), (1, 0)), ((0, 0), (0, -1))))), 12)
    90.0
    """
    (ax, ay), (bx, by) = ((pair[1][0] - pair[0][0], pair[0][1] - pair[1][1]) for pair in (before, after))
    if (ax == 0.0 and ay == 0.0) or (bx == 0.0 and by == 0.0):
        raise ValueError("both markers are at the same place; their direction is not defined")
    return float(np.arctan2(ax * by - ay * bx, ax * bx + ay * by))


def _sources(images: Source | Iterable[Source]) -> Iterator[Source]:
    if isinstance(images, Image):
        yield images
    elif isinstance(images, str | Path):
        path = Path(images)
        if path.is_dir():
            yield from picture_files(path)
        elif path.suffix.lower() in VIDEOS:
            yield from video_images(path)
        elif not path.exists():
            raise FileNotFoundError(f"{quoted(str(path))} is no file or folder")
        else:
            yield path
    else:
        for each in images:
            if not isinstance(each, str | Path | Image):
                raise TypeError(f"images must be files or pictures, not {shortened(each)}")
            yield each
