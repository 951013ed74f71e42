"""Angle of the shaft in each photograph of a test: which marker is which, how far the target has turned, and about what."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from strainwave.equality import ComparedByFields
from strainwave.messages import quoted, shortened
from strainwave.presentation import Presented, counted
from strainwave.progress import Progress, in_turn
from strainwave.rig.bench.setup import Camera
from strainwave.rig.vision.camera import PERFECT, changes_nothing, flat, slopes_at
from strainwave.rig.vision.image import (
    MAX_FRAMES,
    SERIES,
    VIDEOS,
    Image,
    as_image,
    by_number,
    picture_files,
    series_images,
    video_images,
)
from strainwave.rig.vision.marker import Frame, Marker, look
from strainwave.statistics.linear_fit import solved

Source = str | Path | Image
Array = NDArray[np.float64]
_MAX_RELATIVE_DIFFERENCE = 0.05  # of radii or distances by errors of measurement or a tilted view [1]
_HALF_TURN_MARGIN = 15.0  # degrees before the turn at which its direction is ambiguous
_LEAST_TURN = np.radians(2.0)  # between images, to determine the centre of the turn
_WIDE_TURN = 0.5  # rad between images, to separate what turns with the target from what does not
_MAX_BLUR_RATIO = 1.5  # over the usual blur [1]
_MAX_RESIDUAL_RATIO = 3.0  # over the usual residual [1]
_MAX_TILT_ERROR_SIGMA = 10.0  # error of an angle by the tilt of the camera, in standard deviations of the angle


def measure_angles(
    images: Source | Iterable[Source | NDArray[Any]],
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
        images: files, or pictures as `read_image` and `as_image` give them; or a folder, a video, an animated GIF or a TIFF of
            several pages; or arrays of pixels one after the other, as `imageio.v3.imiter` and libraries of cameras give them
        camera: what it does to lengths
        reference: name of the image whose angle is 0; the first with an angle if None
        radius: the smallest and the largest that a marker may have [px]; from 6 px to half the picture if None
        dark: whether markers are darker than the ground; either if None
        progress: as of `sw.simulate`

    Returns:
        Angles [rad], positive against the clock, and their standard deviations, shape (images with an angle,), and remarks.

    Raises:
        OSError: there is no such folder or video
        TypeError: images are neither files nor pictures, or pixels are of another type than uint8 and uint16
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


def _sources(images: Source | Iterable[Source | NDArray[Any]]) -> Iterator[Source]:
    if isinstance(images, Image):
        yield images
    elif isinstance(images, str | Path):
        path = Path(images)
        if path.is_dir():
            yield from picture_files(path)
        elif path.suffix.lower() in VIDEOS:
            yield from video_images(path)
        elif path.suffix.lower() in SERIES and path.exists():
            yield from series_images(path)
        elif not path.exists():
            raise FileNotFoundError(f"{quoted(str(path))} is no file or folder")
        else:
            yield path
    elif not isinstance(images, Iterable):
        raise TypeError(f"images must be a file, a folder, or pictures one after the other, not {shortened(images)}")
    elif isinstance(images, np.ndarray) and (images.ndim < 3 or images.shape[2:] == (3,)):
        raise ValueError(f"images is one array of shape {images.shape}; give a list of pictures, as [first, second]")
    else:
        for number, picture in enumerate(images, 1):
            if isinstance(picture, np.ndarray):
                if number > MAX_FRAMES:
                    raise ValueError(f"images has more than {MAX_FRAMES} pictures; cut out what shows the test")
                yield as_image(f"picture {number}", picture)
                continue
            if not isinstance(picture, str | Path | Image):
                raise TypeError(f"images must be files or pictures, not {shortened(picture)}")
            yield picture


@dataclass(frozen=True, eq=False)
class Angles(ComparedByFields, Presented):
    """Angles of the images that give one, in their order.

    Attributes:
        frames: every image, useful or not
        angle: from the reference, positive against the clock [rad], shape (useful frames,)
        sigma: standard deviation of each by itself [rad], same shape; the difference of two angles has the root of the sum
            of both squares, and so has the angle of an image from the reference
        reference: name of the image whose angle is 0
        scale: standard deviation of what all angles share, relative to the angle [1]: by how much the markers show, or may
            hide, that the picture is squeezed, by a tilt or by pixels that are not square
        centre: about which the shaft turned [px], x and y, and the rms distance of the markers from their circles;
            None if the turn is too small to determine it
        remarks: what holds for all images and makes the angles doubtful

    >>> import numpy as np
    >>> import strainwave as sw
    >>> scene, random = sw.rig.Scene(size=(320, 240), radius=20.0, distance=150.0), np.random.default_rng(1)
    >>> pictures = [sw.rig.as_image(f"{turn}.png", sw.rig.render(scene, np.radians(turn), random)) for turn in (0, 5, 10)]
    >>> angles = sw.rig.measure_angles(pictures)
    >>> np.degrees(angles.angle).round(2), angles.reference, bool(np.degrees(angles.sigma).max() < 1e-3)
    (array([ 0.,  5., 10.]), '0.png', True)
    """

    frames: tuple[Frame, ...]
    angle: Array
    sigma: Array
    reference: str
    scale: float
    centre: tuple[float, float, float] | None
    remarks: tuple[str, ...] = ()

    @property
    def useful(self) -> tuple[Frame, ...]:
        """The images whose angles these are."""
        return tuple(frame for frame in self.frames if frame.markers is not None)


def follow(
    frames: Sequence[Frame],
    *,
    camera: Camera = PERFECT,
    reference: str | None = None,
) -> Angles:
    """The angles of images, of which `look` has found the markers, in the order of the test.

    Args:
        frames: of the images
        camera, reference: as `measure_angles` takes them

    Raises:
        ValueError: no image gives an angle; the reference is none of them, or gives none
    """
    frames = _out_of_order(_of_one_target(list(frames), camera))
    useful = [i for i, frame in enumerate(frames) if frame.markers is not None]
    if not useful:
        reason = f"none of {len(frames)} images gives an angle; {quoted(frames[0].name)}: {frames[0].fault}" if frames else ""
        raise ValueError(reason or "there is no image")
    zero = _chosen(frames, useful, reference)
    sights = [_Sight.of(frames[i], camera) for i in useful]
    apart = (
        min(abs(sight.difference) for sight in sights) > _MAX_RELATIVE_DIFFERENCE
    )  # the radii distinguish them in every image
    angle, steps = np.zeros(len(useful)), np.zeros(len(useful))
    for k, i in enumerate(useful):
        swapped, steps[k] = _step(sights[k - 1] if k else None, sights[k], apart)
        if swapped:
            sights[k] = sights[k].swapped()
        angle[k] = angle[k - 1] + steps[k] if k else 0.0
        frames[i] = replace(frames[i], markers=(sights[k].markers[0], sights[k].markers[1]))
    remarks = list[str]()
    for i, uncertain in _uncertain_steps(steps, useful, apart, [frame.name for frame in frames]):
        frames[i] = replace(frames[i], warnings=(*frames[i].warnings, uncertain))
        remarks.append(f"{quoted(frames[i].name)} and the images after it: {uncertain}")
    for i, unlike in zip(useful, _unlike(sights), strict=True):
        frames[i] = replace(frames[i], warnings=frames[i].warnings + unlike)
    angle -= angle[zero]
    sigma = np.array([sight.sigma for sight in sights])
    shape, shape_sigma = _squeezed(sights)
    return Angles(
        tuple(frames), angle, sigma, frames[useful[zero]].name, float(np.hypot(abs(shape) / 2.0**0.5, shape_sigma)),
        _centre(sights, angle), (*_askew(sights), *remarks),
    )  # fmt: skip


@dataclass(frozen=True, eq=False)
class _Sight:
    """Both markers of an image, their centres in the plane of the target, shape (2, 2), and those's covariances, (2, 2, 2)."""

    markers: tuple[Marker, Marker]
    centres: Array
    covariances: Array

    @classmethod
    def of(cls, frame: Frame, camera: Camera) -> _Sight:
        assert frame.markers is not None
        points = np.array([[each.x, each.y] for each in frame.markers])
        shape = (frame.size[1], frame.size[0])
        covariances = np.array([[each.covariance[:2], each.covariance[1:]] for each in frame.markers])
        if changes_nothing(camera):
            return cls(frame.markers, points, covariances)
        slopes = np.array([slopes_at(point, camera, shape) for point in points])
        return cls(frame.markers, flat(points, camera, shape), slopes @ covariances @ slopes.transpose(0, 2, 1))

    def swapped(self) -> _Sight:
        return _Sight((self.markers[1], self.markers[0]), self.centres[::-1], self.covariances[::-1])

    @property
    def vector(self) -> Array:
        """Return the vector from the first marker to the second, right and up."""
        right, down = self.centres[1] - self.centres[0]
        return np.array([right, -down])

    @property
    def distance(self) -> float:
        return float(np.hypot(*self.vector))

    @property
    def sigma(self) -> float:
        """Return the standard deviation of the direction [rad]."""
        along = (self.centres[1] - self.centres[0]) / self.distance
        across = np.array([-along[1], along[0]])
        return float(np.sqrt(across @ self.covariances.sum(axis=0) @ across)) / self.distance

    @property
    def difference(self) -> float:
        """Return the difference of the radii, relative to their mean."""
        one, other = (marker.radius for marker in self.markers)
        return 2.0 * (one - other) / (one + other)


def _step(before: _Sight | None, now: _Sight, apart: bool) -> tuple[bool, float]:
    """Return True if the markers change places, and the turn since the image before."""
    swapped = apart and now.difference < 0.0
    if before is None:
        return swapped, 0.0
    a, b = before.vector, now.vector * (-1.0 if swapped else 1.0)
    if not apart and a @ b < 0.0:
        swapped, b = True, -b
    return swapped, float(np.arctan2(a[0] * b[1] - a[1] * b[0], a @ b))


def _uncertain_steps(steps: Array, useful: Sequence[int], apart: bool, names: Sequence[str]) -> Iterator[tuple[int, str]]:
    """Yield images, by their places, whose turn since the one before with an angle is ambiguous, and why.

    Over images without an angle the turn may be the largest one between neighbours for each of them.
    """
    limit, why = (180.0, "the direction") if apart else (90.0, "which of two like markers is which")
    turns, gaps = np.abs(np.degrees(steps[1:])), np.diff(useful)
    usual = turns[gaps == 1].max(initial=0.0) if np.any(gaps == 1) else limit
    for k, (turn, gap) in enumerate(zip(turns, gaps, strict=True)):
        if max(turn, gap * usual if gap > 1 else 0.0) >= limit - _HALF_TURN_MARGIN:
            over = f" over {counted(int(gap) - 1, 'image')} without an angle" if gap > 1 else ""
            yield (
                useful[k + 1],
                f"turned by {turn:.1f} degrees since {quoted(names[useful[k]])}{over}, or more: beyond {limit:g} degrees {why} "
                "cannot be determined",
            )


def _of_one_target(frames: list[Frame], camera: Camera) -> list[Frame]:
    """Images of another size than most, or whose markers are not those of most, have a fault."""
    frames = _of_one_size(frames)
    sights = {i: _Sight.of(frame, camera) for i, frame in enumerate(frames) if frame.markers is not None}
    if len(sights) < 3:
        return frames
    distances = {i: sight.distance for i, sight in sights.items()}
    radii = {i: 0.5 * (sight.markers[0].radius + sight.markers[1].radius) for i, sight in sights.items()}
    for what, sizes in (("apart", distances), ("in radius", radii)):
        usual = float(np.median(list(sizes.values())))
        for i, size in sizes.items():
            if abs(size / usual - 1.0) > _MAX_RELATIVE_DIFFERENCE and not frames[i].fault:
                text = f"not the markers of the other images: {size:.1f} px {what}, {usual:.1f} px in most of them"
                frames[i] = replace(frames[i], markers=None, fault=text)
    return frames


def _of_one_size(frames: list[Frame]) -> list[Frame]:
    """A camera that was turned on its side, or set to other pixels, makes pictures of another size: its angles are others."""
    sizes = [frame.size for frame in frames if frame.markers is not None]
    if len(sizes) < 3:
        return frames
    (usual, _), *_ = Counter(sizes).most_common(1)
    right = "{} x {} px".format(*usual)
    return [
        frame
        if frame.markers is None or frame.size == usual
        else replace(frame, markers=None, fault="is {} x {} px".format(*frame.size) + f", and most of the images are {right}")
        for frame in frames
    ]


def _out_of_order(frames: list[Frame]) -> list[Frame]:
    """Add a warning to images whose name or time contradicts the given order, and to those that are there twice."""
    known: dict[str, str] = {}
    for i, frame in enumerate(frames):
        warnings, name, before = [], frame.name, frames[i - 1].name if i else ""
        alike = len({re.sub(r"\d+", "0", each.casefold()) for each in (name, before)}) == 1  # but for their numbers
        if i and alike and by_number(name) < by_number(before):
            warnings.append(f"stands after {quoted(before)}, before it by its name")
        earlier = next((each for each in reversed(frames[:i]) if each.taken is not None), None)
        if earlier is not None and frame.taken is not None and earlier.taken is not None and frame.taken < earlier.taken:
            warnings.append(f"stands after {quoted(earlier.name)}, but was taken before it, at {frame.taken}")
        if frame.sha256 and frame.sha256 in known:
            warnings.append(f"is the same picture as {quoted(known[frame.sha256])}")
        known.setdefault(frame.sha256, frame.name)
        if warnings:
            frames[i] = replace(frame, warnings=(*frame.warnings, *warnings))
    return frames


def _unlike(sights: Sequence[_Sight]) -> list[tuple[str, ...]]:
    """Return for each image the properties in which it is worse than the others."""
    warnings: list[list[str]] = [[] for _ in sights]
    if len(sights) >= 3:
        for place in range(2):
            for what, factor, values in (
                ("blur", _MAX_BLUR_RATIO, [sight.markers[place].blur for sight in sights]),
                ("residual", _MAX_RESIDUAL_RATIO, [sight.markers[place].residual for sight in sights]),
            ):
                usual = float(np.median(values))
                for texts, value in zip(warnings, values, strict=True):
                    if value > factor * usual:
                        texts.append(f"marker {place + 1}: {what} {value:.2g} px, {usual:.2g} px in most images")
    return [tuple(each) for each in warnings]


def _centre(sights: Sequence[_Sight], angle: Array) -> tuple[float, float, float] | None:
    """The point of the plane about which the markers turned: least squares of p = centre + R(angle) a, of both."""
    if np.ptp(angle) < _LEAST_TURN:
        return None
    cosine, sine = np.cos(angle), np.sin(angle)
    one, none = np.ones_like(angle), np.zeros_like(angle)
    right = np.column_stack((one, none, cosine, sine))  # of a turn against the clock, y pointing down
    down = np.column_stack((none, one, -sine, cosine))
    empty = np.zeros((len(angle), 2))
    rows, values = [], []
    for marker in range(2):
        for axis, block in ((0, right), (1, down)):
            parts = (block[:, :2], block[:, 2:], empty) if marker == 0 else (block[:, :2], empty, block[:, 2:])
            rows.append(np.column_stack(parts))
            values.append([sight.centres[marker, axis] for sight in sights])
    matrix, target = np.concatenate(rows), np.concatenate(values)
    found = solved(matrix, target)
    rest = target - matrix @ found
    rms = float(np.sqrt(np.sum(rest**2) / (2 * len(sights))))
    return float(found[0]), float(found[1]), rms


def camera_seen(frames: Iterable[Frame]) -> Camera:
    """Return the tilt of the camera by the shape of the markers, if nothing else is known of the camera.

    A circle that is seen askew is an ellipse: its shorter axis lies in the direction of the tilt, whose cosine is its ratio.
    An oval marker or the distortion of a lens turns with the target; it is separated if the images turn by more than
    half a radian. The markers determine neither which of both ends recedes, nor whether the pixels cause the shape.

    Args:
        frames: of images in which both markers are found

    Returns:
        A camera with that tilt and its direction [rad], otherwise undistorted.

    Raises:
        ValueError: there is none

    >>> import numpy as np
    >>> import strainwave as sw
    >>> askew = sw.rig.Scene(size=(320, 240), radius=20.0, distance=150.0, camera=sw.rig.Camera(tilt=0.2, tilt_direction=0.5))
    >>> random = np.random.default_rng(1)
    >>> pictures = [sw.rig.as_image(f"{n}.png", sw.rig.render(askew, 0.3 * n, random)) for n in range(3)]
    >>> camera = sw.rig.camera_seen(sw.rig.measure_angles(pictures).frames)
    >>> round(camera.tilt, 2), round(camera.tilt_direction, 2)
    (0.2, 0.5)
    """
    sights = [_Sight.of(frame, PERFECT) for frame in frames if frame.markers is not None]
    if not sights:
        raise ValueError("no image shows both markers, which would determine the tilt of the camera")
    return _tilted(sights)


def _tilted(sights: Sequence[_Sight]) -> Camera:
    shape, _ = _squeezed(sights)
    tilt, direction = float(np.arccos(max(1.0 - abs(shape), 0.0))), float(0.5 * np.angle(shape))
    source = f"from the shape of the markers in {len(sights)} images"
    return Camera(tilt=tilt, tilt_direction=direction, sources={"tilt": source, "tilt_direction": source})


def _squeezed(sights: Sequence[_Sight]) -> tuple[complex, float]:
    r"""Return the flattening of the picture, as `oblong` defines it, and the standard deviation of either part.

    A picture squeezed by e turns the directions of its vectors by e/2 sin(2 (direction - shorter axis)): angles are in error by
    e cos(2 ...) of themselves, in the mean of all directions by e/sqrt(2).
    """
    seen = [(marker, sight.vector) for sight in sights for marker in sight.markers if np.isfinite(marker.ratio_sigma)]
    if not seen:  # of no marker enough to determine it
        return 0j, 0.0
    shape = np.array([(1.0 - marker.ratio) * np.exp(2j * marker.short_direction) for marker, _ in seen])
    turned = np.array([np.exp(2j * np.arctan2(up, right)) for _, (right, up) in seen])
    wide = len(sights) > 2 and np.ptp(np.unwrap(np.angle(turned))) > 2.0 * _WIDE_TURN
    columns = np.column_stack((np.ones(len(seen)), turned))[:, : 2 if wide else 1]
    mean = np.linalg.lstsq(columns, shape)[0][0]
    spread = float(np.linalg.inv(columns.conj().T @ columns)[0, 0].real)
    return complex(mean), float(np.sqrt(spread * np.mean([marker.ratio_sigma**2 for marker, _ in seen])))


def _askew(sights: Sequence[_Sight]) -> tuple[str, ...]:
    """Return a remark if the camera looks at the target at an angle that its description omits."""
    seen = _tilted(sights)
    error = 0.5 * (1.0 - np.cos(seen.tilt))
    if error < _MAX_TILT_ERROR_SIGMA * float(np.median([sight.sigma for sight in sights])):
        return ()
    arguments = f"tilt={seen.tilt:.4f}, tilt_direction={seen.tilt_direction:.3f}"
    return (
        f"the markers are ellipses, as if seen {np.degrees(seen.tilt):.1f} degrees askew: angles are in error by up to "
        f"{error:.2g} rad unless the camera is known, as Camera({arguments})",
    )


def _chosen(frames: Sequence[Frame], useful: Sequence[int], reference: str | None) -> int:
    if reference is None:
        return 0
    places = [i for i, frame in enumerate(frames) if frame.name == reference]
    if not places:
        raise ValueError(f"reference = {quoted(reference)} is none of the {len(frames)} images")
    if places[0] not in useful:
        raise ValueError(f"reference = {quoted(reference)} gives no angle: {frames[places[0]].fault}")
    return useful.index(places[0])
