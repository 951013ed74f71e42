"""Photographs of a test, read as grey values."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Iterator
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from strainwave.equality import ComparedByFields
from strainwave.messages import one_line, quoted

if TYPE_CHECKING:
    from PIL.Image import Image as Picture

Grey = NDArray[np.float32]
PICTURES = (".png", ".jpg", ".jpeg", ".tif", ".tiff", ".bmp", ".pgm")
VIDEOS = (".mp4", ".avi", ".mov", ".mkv", ".m4v")
SMALLEST = 16  # px: less shows no two markers
_TAKEN = (36867, 306)  # EXIF: DateTimeOriginal, DateTime
_EXIF = 34665


@dataclass(frozen=True, eq=False)
class Image(ComparedByFields):
    """A picture as grey values.

    Attributes:
        name: of the file, and of the frame in it
        grey: brightness, of the full scale, shape (height, width); the first row is the upper one
        sha256: of the bytes of the file, or of the frame
        taken: when, as the file tells it, or None
    """

    name: str
    grey: Grey
    sha256: str
    taken: datetime | None = None


def read_image(path: str | Path) -> Image:
    """Reads a photograph: PNG, JPEG, TIFF, BMP or PGM; 8 or 16 bit; grey or colour; turned upright as its EXIF entry asks.

    Colours become grey as ITU-R BT.601 weighs them; what is transparent is taken as if it were not.

    Raises:
        OSError: there is no such file, or it cannot be read
        ValueError: it holds no picture, a damaged one, or one of less than 16 pixels
    """
    path = Path(path)
    data = path.read_bytes()
    if not data:
        raise ValueError(f"{_shown(path)} is empty")
    picture, taken = _decoded(path, data)
    return Image(path.name, _grey(path, picture), hashlib.sha256(data).hexdigest(), taken)


def picture_files(folder: str | Path) -> list[Path]:
    """The photographs of a folder, ordered by name, numbers in it by their value: IMG_9 stands before IMG_10.

    Raises:
        OSError: there is no such folder
        ValueError: it holds no photograph
    """
    folder = Path(folder)
    found = [each for each in folder.iterdir() if each.suffix.lower() in PICTURES and not each.name.startswith(".")]
    if not found:
        raise ValueError(f"{_shown(folder)} holds no photograph; looked for files named *{', *'.join(PICTURES)}")
    return sorted(found, key=lambda each: by_number(each.name))


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
        ValueError: it holds no video
    """
    path = Path(path)
    if not path.is_file():
        raise FileNotFoundError(f"{_shown(path)} is not a file")
    try:
        import cv2
    except ImportError:
        raise ImportError(f"{path.name}: videos are read by opencv: pip install strainwave[video]") from None
    capture, count = cv2.VideoCapture(str(path)), 0
    try:
        while (read := capture.read())[0]:
            count += 1
            grey = cv2.cvtColor(read[1], cv2.COLOR_BGR2GRAY)
            yield Image(f"{path.name}#{count}", _scaled(grey), hashlib.sha256(grey.tobytes()).hexdigest())
    finally:
        capture.release()
    if count == 0:
        raise ValueError(f"{_shown(path)} is not a video that opencv can read")


def as_image(name: str, pixels: NDArray[Any]) -> Image:
    """An array of pixels as an image: uint8 or uint16, shape (height, width), or (height, width, 3) in colour.

    Raises:
        TypeError, ValueError: of another type or shape
    """
    array = np.asarray(pixels)
    if array.dtype not in (np.uint8, np.uint16):
        raise TypeError(f"{name}: pixels must be uint8 or uint16, not {array.dtype}")
    if array.ndim not in (2, 3) or (array.ndim == 3 and array.shape[2] != 3):
        raise ValueError(f"{name}: pixels have shape {array.shape}; must be (height, width) or (height, width, 3)")
    _refuse_small(name, array.shape[1], array.shape[0])
    return Image(name, _scaled(_without_colour(array)), hashlib.sha256(np.ascontiguousarray(array).tobytes()).hexdigest())


def _decoded(path: Path, data: bytes) -> tuple[Picture, datetime | None]:
    """The picture, upright and wholly read, and when it was taken."""
    import io
    import warnings

    from PIL import Image as Pillow
    from PIL import ImageOps, UnidentifiedImageError

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of odd entries beside the picture
        try:
            picture = Pillow.open(io.BytesIO(data))
            _refuse_small(_shown(path), *picture.size)
            picture.load()
            taken = _taken(picture)
            return ImageOps.exif_transpose(picture), taken
        except UnidentifiedImageError:
            raise ValueError(f"{_shown(path)} is not a picture that can be read; PNG, JPEG, TIFF, BMP or PGM can") from None
        except Pillow.DecompressionBombError as error:
            raise ValueError(one_line(f"{_shown(path)} is too large: {error}")) from None
        except (OSError, SyntaxError, EOFError, IndexError, KeyError, TypeError, OverflowError) as error:
            raise ValueError(one_line(f"{_shown(path)} is damaged: {error}")) from None


def _grey(path: Path, picture: Picture) -> Grey:
    mode = picture.mode
    if mode in ("I;16", "I;16B", "I;16L", "I;16N"):
        return _scaled(np.asarray(picture).astype(np.uint16))
    if mode == "I":  # what pillow makes of some 16-bit pictures
        return _scaled(_sixteen_bit(path, np.asarray(picture)))
    if mode == "F":
        return _unit(path, np.asarray(picture))
    if mode == "1":
        picture = picture.convert("L")
    elif mode not in ("L", "RGB"):
        picture = picture.convert("RGB")
    return _scaled(_without_colour(np.asarray(picture)))


def _sixteen_bit(path: Path, values: NDArray[np.int32]) -> NDArray[np.uint16]:
    if values.min() < 0 or values.max() > 65535:
        raise ValueError(f"{_shown(path)} has values from {values.min()} to {values.max()}; 0 to 65535 can be read")
    return values.astype(np.uint16)


def _unit(path: Path, values: NDArray[np.float32]) -> Grey:
    if not (np.all(np.isfinite(values)) and values.min() >= 0.0 and values.max() <= 1.0):
        raise ValueError(f"{_shown(path)} is of floating-point numbers outside of 0 to 1; save it with 8 or 16 bits")
    return values


def _without_colour(pixels: NDArray[Any]) -> NDArray[Any]:
    if pixels.ndim == 2:
        return pixels
    weights = np.array([0.299, 0.587, 0.114], np.float32)
    grey: NDArray[Any] = (pixels.astype(np.float32) @ weights) / np.float32(np.iinfo(pixels.dtype).max)
    return grey


def _scaled(values: NDArray[Any]) -> Grey:
    if values.dtype == np.float32:
        return values
    grey: Grey = values.astype(np.float32)
    grey *= np.float32(1.0 / np.iinfo(values.dtype).max)
    return grey


def _taken(picture: Picture) -> datetime | None:
    entries = picture.getexif()
    within = entries.get_ifd(_EXIF)
    for tag in _TAKEN:
        text = within.get(tag) or entries.get(tag)
        try:
            return datetime.strptime(str(text).strip("\0 "), "%Y:%m:%d %H:%M:%S")
        except ValueError:
            continue
    return None


def _refuse_small(name: str, width: int, height: int) -> None:
    if min(width, height) < SMALLEST:
        raise ValueError(f"{name} has {width} x {height} pixels; two markers need {SMALLEST} x {SMALLEST} or more")


def _shown(path: Path) -> str:
    return quoted(path.name)
