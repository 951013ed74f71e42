"""Photographs of a test, read as grey values."""

from __future__ import annotations

import hashlib
import os
import re
from collections.abc import Iterator
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from strainwave.equality import ComparedByFields
from strainwave.files.budget import RefusedFile, open_regular, read_regular
from strainwave.messages import one_line, quoted
from strainwave.presentation import Presented
from strainwave.rig.vision.decoding import MAX_PICTURE_BYTES, Grey, check_size, decoded, decoded_series, grey_of

PICTURES = (".png", ".jpg", ".jpeg", ".tif", ".tiff", ".bmp", ".pgm")
SERIES = (".gif", ".tif", ".tiff")
VIDEOS = (".mp4", ".avi", ".mov", ".mkv", ".m4v")
# What a container begins with; playlists and other texts, which name further files to be opened, begin otherwise.
CONTAINERS = re.compile(rb"\0...(ftyp|moov|mdat|wide|free|skip)|RIFF....AVI LIST|\x1a\x45\xdf\xa3", re.DOTALL)
# What FFmpeg may open: these containers, and files alone.
CAPTURE_OPTIONS = "format_whitelist;mov,avi,matroska|protocol_whitelist;file"
MAX_FRAMES = 100_000  # of a video: an hour at 25 a second


@dataclass(frozen=True, eq=False)
class Image(ComparedByFields, Presented):
    """A picture as grey values.

    Attributes:
        name: of the file, and of the frame in it
        grey: brightness, of the full scale, shape (height, width); the first row is the upper one
        sha256: of the bytes of the file, or of the frame
        taken: time by the file, or None

    >>> import numpy as np
    >>> import strainwave as sw
    >>> image = sw.rig.as_image("001.png", np.full((480, 640), 51, np.uint8))  # 51 of 255
    >>> image.grey.shape, round(float(image.grey.max()), 3)
    ((480, 640), 0.2)
    """

    name: str
    grey: Grey
    sha256: str
    taken: datetime | None = None


def read_image(path: str | Path) -> Image:
    """Read a photograph: PNG, JPEG, TIFF, BMP or PGM; 8 or 16 bit; grey or colour; turned upright as its EXIF entry asks.

    Colours become grey as ITU-R BT.601 weighs them; what is transparent is taken as if it were not.

    The bytes determine the format, not the name. The memory it takes stays below 1 GB.

    Returns:
        Grey values of the full scale [1], shape (height, width), with the SHA-256 of the file and its time.

    Raises:
        OSError: there is no such file, or it cannot be read
        ValueError: it is no regular file, contains no picture, a damaged one, one of less than 16 pixels a side or of more
            than 67 million in all

    >>> import pathlib, tempfile
    >>> import strainwave as sw
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = pathlib.Path(folder, "001.pgm")
    ...     _ = path.write_bytes(b"P5 32 16 255 " + bytes([51] * 512))  # 51 of 255
    ...     image = sw.rig.read_image(path)
    >>> image.name, image.grey.shape, round(float(image.grey.max()), 3)
    ('001.pgm', (16, 32), 0.2)
    """
    path = Path(path)
    try:
        data = read_regular(path, MAX_PICTURE_BYTES)
        if not data:
            raise RefusedFile("is empty")
        grey, taken = decoded(data)
    except RefusedFile as error:
        raise ValueError(one_line(f"{_shown(path)} {error}")) from None
    return Image(path.name, grey, hashlib.sha256(data).hexdigest(), taken)


def picture_files(folder: str | Path) -> list[Path]:
    """The photographs of a folder, ordered by name, numbers in it by their value: IMG_9 stands before IMG_10.

    Raises:
        OSError: there is no such folder
        ValueError: it holds no photograph
    """
    folder = Path(folder)
    found = sorted(pictures_in(folder), key=lambda each: by_number(each.name))
    if not found:
        raise ValueError(
            f"{_shown(folder)} holds no photograph; looked for files named *{', *'.join(PICTURES)}; links are not followed"
        )
    return found


def pictures_in(folder: Path) -> list[Path]:
    """The files of a folder whose name is that of a picture, without hidden ones and symbolic links."""
    with os.scandir(folder) as entries:
        return [
            Path(entry)
            for entry in entries
            if Path(entry).suffix.lower() in PICTURES
            and not entry.name.startswith(".")
            and entry.is_file(follow_symlinks=False)
        ]


def by_number(name: str) -> tuple[tuple[int, int, str], ...]:
    """A key that sorts names with the numbers in them by value.

    >>> sorted(["b10", "b9", "a"], key=by_number)
    ['a', 'b9', 'b10']
    """
    parts = re.findall(r"\d+|\D+", name.casefold())
    return tuple((0, int(part), "") if part.isdecimal() else (1, 0, part) for part in parts)


def video_images(path: str | Path) -> Iterator[Image]:
    """The frames of a video, one after the other, named as the file with # and their number from 1.

    Raises:
        ImportError: opencv is not installed
        OSError: there is no such file
        ValueError: it contains no video, or one whose frames are too small, too large or too many
    """
    path = Path(path)
    if not path.is_file():
        raise FileNotFoundError(f"{_shown(path)} is not a file")
    with open_regular(path) as file:
        if CONTAINERS.match(file.read(16)) is None:
            raise ValueError(f"{_shown(path)} is not a video that can be read; MP4, MOV, AVI and Matroska can")
    try:
        import cv2
    except ImportError:
        raise ImportError(f"{path.name}: videos are read by opencv: pip install 'strainwave[video]'") from None
    capture, count = _opened(cv2, path), 0
    try:
        if not capture.isOpened():
            raise RefusedFile("is not a video that opencv can read")
        check_size(int(capture.get(cv2.CAP_PROP_FRAME_WIDTH)), int(capture.get(cv2.CAP_PROP_FRAME_HEIGHT)))
        while (read := capture.read())[0]:
            if (count := count + 1) > MAX_FRAMES:
                raise RefusedFile(f"has more than {MAX_FRAMES} frames; cut out what shows the test")
            grey = cv2.cvtColor(read[1], cv2.COLOR_BGR2GRAY)
            yield as_image(f"{path.name}#{count}", grey)
    except RefusedFile as error:
        raise ValueError(f"{_shown(path)} {error}") from None
    finally:
        capture.release()
    if count == 0:
        raise ValueError(f"{_shown(path)} has no frame that opencv can read")


def series_images(path: str | Path) -> Iterator[Image]:
    """The pictures of an animated GIF, or the pages of a TIFF, named as the file with # and their number from 1.

    Raises:
        OSError: there is no such file
        ValueError: it contains no such pictures, damaged ones, or ones that are too small, too large or too many
    """
    path = Path(path)
    try:
        data = read_regular(path, MAX_PICTURE_BYTES)
        for number, grey in enumerate(decoded_series(data), 1):
            yield Image(f"{path.name}#{number}", grey, hashlib.sha256(grey.data).hexdigest())
    except RefusedFile as error:
        raise ValueError(one_line(f"{_shown(path)} {error}")) from None


def imageio_arrays(source: str) -> Iterator[NDArray[Any]]:
    """The pictures of a camera that imageio opens by a name as <video0>; imageio also opens addresses: they are refused.

    Raises:
        ImportError: imageio is not installed
        ValueError: the source is no name of a camera
    """
    if re.fullmatch(r"<video[0-9]{1,3}>", source) is None:
        raise ValueError(
            f"{quoted(source)} is no camera of imageio; write it as <video0>; for a file, give a folder of pictures"
        )
    try:
        from imageio.v3 import imiter
    except ImportError:
        raise ImportError("a camera of imageio needs it: pip install 'imageio[ffmpeg]'") from None
    return iter(imiter(source))


def _opened(cv2: Any, path: Path) -> Any:
    """A video opened by FFmpeg alone, by its whole path: other readers take a name with digits for a series of files."""
    name, before = "OPENCV_FFMPEG_CAPTURE_OPTIONS", os.environ.get("OPENCV_FFMPEG_CAPTURE_OPTIONS")
    os.environ[name] = CAPTURE_OPTIONS
    try:
        return cv2.VideoCapture(str(path.resolve()), cv2.CAP_FFMPEG)
    finally:
        del os.environ[name]
        if before is not None:
            os.environ[name] = before


def as_image(name: str, pixels: NDArray[Any]) -> Image:
    """Return an array of pixels as an image: uint8 or uint16, shape (height, width), or (height, width, 3) in colour.

    Raises:
        TypeError: the pixels are of another type
        ValueError: they are of another shape, less than 16 a side, or more than 67 million in all

    >>> import numpy as np
    >>> import strainwave as sw
    >>> sw.rig.as_image("001.png", np.full((480, 640, 3), 255, np.uint8)).grey.shape  # a white picture in colour
    (480, 640)
    """
    array = np.asarray(pixels)
    if array.dtype not in (np.uint8, np.uint16):
        remedy = "; of pixels from 0 to 1 give (255 * pixels).astype(np.uint8)" if array.dtype.kind == "f" else ""
        raise TypeError(f"{name}: pixels must be uint8 or uint16, not {array.dtype}{remedy}")
    if array.ndim not in (2, 3) or (array.ndim == 3 and array.shape[2] != 3):
        remedy = "; leave out the opacity, as pixels[..., :3]" if array.ndim == 3 and array.shape[2] == 4 else ""
        raise ValueError(f"{name}: pixels have shape {array.shape}; must be (height, width) or (height, width, 3){remedy}")
    try:
        check_size(array.shape[1], array.shape[0])
    except RefusedFile as error:
        raise ValueError(f"{name} {error}") from None
    return Image(name, grey_of(array, np.iinfo(array.dtype).max), hashlib.sha256(np.ascontiguousarray(array).data).hexdigest())


def _shown(path: Path) -> str:
    return quoted(path.name)
