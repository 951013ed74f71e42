"""From the bytes of a picture to its grey values, at a cost that is bounded before anything is decoded.

A file of a megabyte may claim pixels for gigabytes, repeat its strips or scans without end, or be of another format than its
name. The first letters determine the format, and only the formats of `SIGNATURES` are decoded.
"""

from __future__ import annotations

import io
import math
import re
import struct
import warnings
from collections.abc import Callable, Iterator
from datetime import datetime
from struct import unpack, unpack_from
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from strainwave.files.budget import RefusedFile

if TYPE_CHECKING:
    from PIL.Image import Image as Picture
    from PIL.ImageFile import ImageFile

Grey = NDArray[np.float32]
SIGNATURES = {
    b"\x89PNG\r\n\x1a\n": "PNG", b"\xff\xd8\xff": "JPEG", b"II*\0": "TIFF", b"MM\0*": "TIFF", b"BM": "BMP",
    b"P2": "PPM", b"P3": "PPM", b"P5": "PPM", b"P6": "PPM",
}  # fmt: skip
MIN_SIDE = 16  # px: less shows no two markers
MAX_PIXELS = 2**26  # of one picture: the memory for reading stays below 1 GB; cameras in full format have 61 million
MAX_PICTURE_BYTES = 2**28  # of one file: 16 bits and two colours for each pixel, uncompressed
BLOCK_PIXELS = 2**20  # converted to grey at a time
MAX_PARTS = 20_000  # chunks of a PNG, segments before the pixels of a JPEG: pillow reads them one by one in Python
MAX_HEAD_BYTES = 2**24  # before the pixels of a JPEG
MAX_FILLING = 64  # bytes between two segments there
MAX_EXIF_BYTES = 2**16  # one segment of a JPEG
SERIES_SIGNATURES = {b"GIF87a": "GIF", b"GIF89a": "GIF", b"II*\0": "TIFF", b"MM\0*": "TIFF"}  # files of several pictures
MAX_SERIES_PICTURES = 10_000  # of one file
MAX_SERIES_PIXELS = 2**33  # of all pictures of one file: 4000 of two million; a GIF of kilobytes may claim more
MAX_SCANS = 50  # of a progressive JPEG, each of which passes over all pixels; encoders write ten
MAX_SAMPLES = 6  # of a pixel, that a TIFF may have in planes of their own
MAX_NETPBM_HEAD = 4096  # bytes
DECODERS = {"zip", "jpeg", "raw", "libtiff"}  # of pillow, all of them compiled
COMPRESSIONS = {"raw", "tiff_lzw", "tiff_adobe_deflate", "tiff_deflate", "packbits", "tiff_raw_16"}  # of TIFF files
TILE_WIDTH, TILE_LENGTH = 322, 323  # tags of a TIFF
WEIGHTS = np.array([0.299, 0.587, 0.114], np.float32)  # of red, green and blue: ITU-R BT.601
SCAN, END = 0xDA, 0xD9  # markers of a JPEG
_MARKER = re.compile(rb"\xff[^\x00\x01\xd0-\xd8\xff]")  # of a segment: what stands alone or is filling left out
_NETPBM = re.compile(rb"P([2356])" + 3 * rb"(?:\s|#[^\n]*\n)+(\d{1,9})" + rb"\s")
ORDERS = {b"II*\0": "<", b"MM\0*": ">"}  # byte orders by the first letters; BigTIFF begins otherwise
SIZES = {1: 1, 2: 1, 3: 2, 4: 4, 5: 8, 6: 1, 7: 1, 8: 2, 9: 4, 10: 8, 11: 4, 12: 8}  # bytes of one value of each type
MAX_TAG_BYTES = 2**25  # of all tags of one directory: pillow copies them several times
MAX_TAG_NUMBERS = 100_000  # of one tag: pillow makes an object of each; a strip for each row needs fewer
ORIENTATION, CHANGED, ORIGINAL = 274, 306, 36867  # DateTime and DateTimeOriginal
DIRECTORIES = (34665, 34853, 40965)  # tags that point to further ones: EXIF, GPS, interoperability


class Tags(NamedTuple):
    """Orientation and time of a picture, by its tags.

    Attributes:
        orientation: 1 to 8 as EXIF has it; 1 is upright
        taken: when; None if no tag contains it
    """

    orientation: int = 1
    taken: datetime | None = None


def tags_of(data: bytes) -> Tags:
    """Read the tags of a TIFF file, or of the EXIF part of another one.

    Raises:
        RefusedFile: it has no directory of tags, or its tags claim too much
        struct.error: a directory lies beyond the end

    >>> tags_of(b"II*\\0" + b"\\x08\\0\\0\\0" + b"\\x01\\0" + b"\\x12\\x01\\x03\\0\\x01\\0\\0\\0\\x06\\0\\0\\0" + bytes(4))
    Tags(orientation=6, taken=None)
    """
    order = ORDERS.get(data[:4])
    if order is None:
        raise RefusedFile("has no tags as TIFF 6.0 has them")
    (first,) = unpack_from(f"{order}L", data, 4)
    found = dict(_directory(data, order, first))
    for pointer in DIRECTORIES:  # the third is in the directory of the first
        if len(place := found.get(pointer, b"")) == 4:
            found |= dict(_directory(data, order, *unpack(f"{order}L", place)))
    stands = found.get(ORIENTATION, b"")
    orientation = unpack(f"{order}H", stands)[0] if len(stands) == 2 else 1
    dates = [date for tag in (ORIGINAL, CHANGED) if (date := _date(found.get(tag, b""))) is not None]
    return Tags(orientation if 1 <= orientation <= 8 else 1, dates[0] if dates else None)


def _directory(data: bytes, order: str, place: int) -> Iterator[tuple[int, bytes]]:
    """The tags of a directory with their bytes, of those that are short."""
    total = 0
    for entry in range(unpack_from(f"{order}H", data, place)[0]):
        tag, kind, count, within = unpack_from(f"{order}HHL4s", data, place + 2 + 12 * entry)
        size = SIZES.get(kind, 0) * count
        total += size
        if total > MAX_TAG_BYTES or (SIZES.get(kind, 0) > 1 and count > MAX_TAG_NUMBERS):
            raise RefusedFile(f"has tags of more than {MAX_TAG_BYTES} bytes or {MAX_TAG_NUMBERS} numbers; save it without them")
        start = place + 10 + 12 * entry if size <= 4 else unpack(f"{order}L", within)[0]
        if size < 64:
            yield tag, data[start : start + size]


def _date(value: bytes) -> datetime | None:
    try:
        return datetime.strptime(value.decode("latin-1").strip("\0 "), "%Y:%m:%d %H:%M:%S")
    except ValueError:
        return None


def decoded(data: bytes) -> tuple[Grey, datetime | None]:
    """Grey values of a picture, upright, of the full scale, and when it was taken.

    Raises:
        RefusedFile: it is none of the known formats, damaged, too small or too large
    """
    kind = next((kind for begin, kind in SIGNATURES.items() if data.startswith(begin)), None)
    if kind is None:
        raise RefusedFile("is not a picture that can be read; PNG, JPEG, TIFF, BMP or PGM can")
    with warnings.catch_warnings(action="ignore"):  # of odd entries next to the picture
        try:
            if kind == "PPM":
                return _netpbm(data), None
            tags = CHECKS[kind](data) if kind in CHECKS else Tags()
            return _by_pillow(data, kind, tags)
        except RefusedFile:
            raise
        except Exception as error:  # of a damaged file pillow raises any
            raise RefusedFile(f"is damaged: {error}") from None


def decoded_series(data: bytes) -> Iterator[Grey]:
    """Yield the grey values of each picture of an animated GIF, or of each page of a TIFF, of the full scale.

    Raises:
        RefusedFile: it is neither, damaged, or its pictures are too small, too large or too many
    """
    from PIL import Image as Pillow

    kind = next((kind for begin, kind in SERIES_SIGNATURES.items() if data.startswith(begin)), None)
    if kind is None:
        raise RefusedFile("is no file of several pictures that can be read; GIF and TIFF can")
    pixels = 0
    with warnings.catch_warnings(action="ignore"):  # of odd entries next to the pictures
        try:
            if kind == "TIFF":
                _check_pages(data)
            picture = Pillow.open(io.BytesIO(data), formats=[kind])
            for number in range(MAX_SERIES_PICTURES + 1):
                try:
                    picture.seek(number)
                except EOFError:
                    return
                check_size(*picture.size)
                pixels += picture.width * picture.height
                if pixels > MAX_SERIES_PIXELS or number == MAX_SERIES_PICTURES:
                    limits = f"{MAX_SERIES_PICTURES} pictures, {MAX_SERIES_PIXELS} pixels in all"
                    raise RefusedFile(f"has more than can be read: {limits}; cut out what shows the test")
                if kind == "TIFF":
                    _check_tiles(picture)
                yield _grey(picture, 1)
        except RefusedFile:
            raise
        except Pillow.DecompressionBombError:
            raise RefusedFile(f"is too large: {MAX_PIXELS} pixels can be read; make it smaller") from None
        except Exception as error:  # of a damaged file pillow raises any
            raise RefusedFile(f"is damaged: {error}") from None


def _check_pages(data: bytes) -> None:
    """Refuse a TIFF of which a page has tags that claim too much, or that has too many pages, or one twice."""
    order, seen = ORDERS[data[:4]], set[int]()
    (place,) = unpack_from(f"{order}L", data, 4)
    while place:
        if place in seen or len(seen) >= MAX_SERIES_PICTURES:
            raise RefusedFile(f"has more than {MAX_SERIES_PICTURES} pages, or the same one again; cut out what shows the test")
        seen.add(place)
        for _ in _directory(data, order, place):  # refuses tags that claim too much
            pass
        (count,) = unpack_from(f"{order}H", data, place)
        (place,) = unpack_from(f"{order}L", data, place + 2 + 12 * count)


def check_size(width: int, height: int) -> None:
    """Refuse a picture in which no two markers can be seen, or that takes too much memory.

    Raises:
        RefusedFile: it has too few pixels, or too many
    """
    if min(width, height) < MIN_SIDE:
        raise RefusedFile(f"has {width} x {height} pixels; two markers need {MIN_SIDE} x {MIN_SIDE} or more")
    if width * height > MAX_PIXELS:
        raise RefusedFile(f"is too large: {width} x {height} pixels; {MAX_PIXELS} in all can be read; make it smaller")


def grey_of(pixels: NDArray[Any], full_scale: int) -> Grey:
    """Grey values of an array of pixels, shape (height, width) or (height, width, 3), of the full scale."""
    height, width = pixels.shape[:2]

    def brightness(top: int, bottom: int) -> Grey:
        return _shares(pixels[top:bottom], full_scale)

    return _in_blocks(width, height, brightness)


# ---- Before pillow sees it -------------------------------------------------------------------------------------------


def _check_png(data: bytes) -> Tags:
    """Refuse a PNG of more chunks than a picture needs."""
    place = 8
    for _ in range(MAX_PARTS):
        if place >= len(data) or data[place + 4 : place + 8] == b"IEND":
            return Tags()
        place += 12 + struct.unpack_from(">L", data, place)[0]
    raise RefusedFile(f"has more than {MAX_PARTS} chunks; save it anew")


def _check_jpeg(data: bytes) -> Tags:
    """Refuse a JPEG with more segments, EXIF entries or scans than a camera writes."""
    exif = scans = 0
    for count, (marker, content) in enumerate(_segments(data)):
        scans += marker == SCAN
        exif += len(content) if content.startswith(b"Exif\0\0") else 0
        if count > MAX_PARTS or exif > MAX_EXIF_BYTES or scans > MAX_SCANS:
            limits = f"{MAX_PARTS} segments, {MAX_EXIF_BYTES} bytes of EXIF entries, {MAX_SCANS} scans"
            raise RefusedFile(f"has more parts than can be read: {limits}; save it anew")
    return Tags()


def _segments(data: bytes) -> Iterator[tuple[int, bytes]]:
    """The segments of a JPEG, by their markers, up to its end; pixels lie between them."""
    place, head = 2, True
    while (found := _MARKER.search(data, place)) is not None:
        marker = data[found.start() + 1]
        if head and (found.start() - place > MAX_FILLING or place > MAX_HEAD_BYTES):
            raise RefusedFile("is damaged: its head is not made of segments, or too long")
        if marker == END:
            return
        head = head and marker != SCAN
        (length,) = struct.unpack_from(">H", data, found.end())
        yield marker, data[found.end() + 2 : found.end() + length]
        place = found.end() + max(length, 2)


CHECKS: dict[str, Callable[[bytes], Tags]] = {"PNG": _check_png, "JPEG": _check_jpeg, "TIFF": tags_of}


def _check_tiles(picture: ImageFile) -> None:
    """Refuse what pillow would decode in Python, by a rare library, or more than once."""
    pixels = 0
    for decoder, extents, *_ in picture.tile:
        left, top, right, bottom = extents or (0, 0, *picture.size)
        pixels += (right - left) * (bottom - top)
        if decoder not in DECODERS:
            raise RefusedFile(f"is compressed as {decoder}; save it as PNG")
    width, height = picture.size
    if pixels > MAX_SAMPLES * width * height:
        raise RefusedFile(f"is damaged: its parts have {pixels} pixels, the picture {width} x {height}")
    if picture.format == "TIFF":
        compression = picture.info["compression"]
        if compression not in COMPRESSIONS:
            raise RefusedFile(f"is compressed as {compression}; save it as PNG, or without compression")
        tags = picture.tag_v2  # type: ignore[attr-defined]
        if tags.get(TILE_WIDTH, 1) * tags.get(TILE_LENGTH, 1) > MAX_PIXELS:
            raise RefusedFile(f"has tiles of more than {MAX_PIXELS} pixels; save it as PNG")


# ---- Decoding --------------------------------------------------------------------------------------------------------


def _by_pillow(data: bytes, kind: str, tags: Tags) -> tuple[Grey, datetime | None]:
    from PIL import Image as Pillow, UnidentifiedImageError

    try:
        picture = Pillow.open(io.BytesIO(data), formats=[kind])
    except Pillow.DecompressionBombError:
        raise RefusedFile(f"is too large: {MAX_PIXELS} pixels can be read; make it smaller") from None
    except UnidentifiedImageError:  # whose message is the address of a buffer
        raise RefusedFile(f"is damaged: it is no {kind} picture, though it begins as one") from None
    check_size(*picture.size)
    _check_tiles(picture)
    picture.load()
    if kind == "TIFF":  # which pillow turns upright itself
        return _grey(picture, 1), tags.taken
    tags = _tags_in(picture.info.get("exif", b""))
    return _grey(picture, tags.orientation), tags.taken


def _tags_in(exif: bytes) -> Tags:
    """Return the tags of a PNG or JPEG; none if they cannot be read, since the picture can be."""
    try:
        return tags_of(exif[:MAX_EXIF_BYTES].removeprefix(b"Exif\0\0"))
    except (RefusedFile, struct.error):
        return Tags()


def _netpbm(data: bytes) -> Grey:
    """Grey values of a PGM or PPM file."""
    head = _NETPBM.match(data, 0, MAX_NETPBM_HEAD)
    if head is None:
        raise RefusedFile("is damaged: it does not begin with width, height and full scale")
    width, height, full_scale = map(int, head.groups()[1:])
    check_size(width, height)
    if not 0 < full_scale < 2**16:
        raise RefusedFile(f"is damaged: its full scale is {full_scale}; 1 to 65535 can be read")
    shape = (height, width) if head[1] in b"25" else (height, width, 3)
    kind = np.dtype(np.int32 if head[1] in b"23" else np.uint8 if full_scale < 2**8 else ">u2")
    pixels = _numbers(data, head.end(), kind, math.prod(shape), plain=head[1] in b"23").reshape(shape)
    if pixels.min() < 0 or pixels.max() > full_scale:
        raise RefusedFile(f"is damaged: a pixel is outside of 0 to {full_scale}, its full scale")
    return grey_of(pixels, full_scale)


def _numbers(data: bytes, start: int, kind: np.dtype[Any], count: int, *, plain: bool) -> NDArray[Any]:
    """The pixels of a PGM or PPM file, written in digits or as bytes."""
    if plain:
        found = np.fromstring(data[start:], kind, sep=" ")[:count]  # given the count, numpy adds what the memory contains
    else:
        found = np.frombuffer(data, kind, min(count, (len(data) - start) // kind.itemsize), start)
    if len(found) < count:
        raise RefusedFile(f"is damaged: it ends after {len(found)} of {count} numbers")
    return found


# ---- Grey ------------------------------------------------------------------------------------------------------------


def _grey(picture: Picture, orientation: int) -> Grey:
    width, height = picture.size

    def brightness(top: int, bottom: int) -> Grey:
        return _brightness(picture.crop((0, top, width, bottom)))

    return _in_blocks(width, height, brightness, orientation)


def _in_blocks(width: int, height: int, brightness: Callable[[int, int], Grey], orientation: int = 1) -> Grey:
    """Grey values, upright, from the brightness of rows as they are stored, a few rows at a time."""
    grey = np.empty((width, height) if orientation > 4 else (height, width), np.float32)
    stored = _as_stored(grey, orientation)
    rows = max(1, BLOCK_PIXELS // width)
    for top in range(0, height, rows):
        stored[top : top + rows] = brightness(top, min(top + rows, height))
    return grey


def _as_stored(upright: Grey, orientation: int) -> Grey:
    """A view of an upright picture, row by row as a file of this orientation stores it (EXIF 2.3, tag 274)."""
    turned = {3: 2, 6: 1, 8: -1, 7: 2}.get(orientation, 0)
    view = np.rot90(upright, turned)
    if orientation in (5, 7):
        return view.T
    return {2: view[:, ::-1], 4: view[::-1]}.get(orientation, view)


def _brightness(picture: Picture) -> Grey:
    """Grey values of a picture of pillow."""
    mode = picture.mode
    if mode in ("I;16", "I;16B", "I;16L", "I;16N"):
        return _shares(np.asarray(picture).astype(np.uint16), 65535)
    if mode == "I":  # what pillow makes of some 16-bit pictures
        return _shares(_within(np.asarray(picture), 65535), 65535)
    if mode == "F":
        return _within(np.asarray(picture), 1, "as floating-point numbers ")
    if mode == "1":
        picture = picture.convert("L")
    elif mode not in ("L", "RGB"):
        picture = picture.convert("RGB")
    return _shares(np.asarray(picture), 255)


def _within(values: NDArray[Any], most: int, kind: str = "") -> NDArray[Any]:
    low, high = values.min(), values.max()
    if not (low >= 0 and high <= most):  # also not a number
        raise RefusedFile(f"has values from {low} to {high}; {kind}0 to {most} can be read: save it with 8 or 16 bits")
    return values


def _shares(pixels: NDArray[Any], full_scale: int) -> Grey:
    """Brightness of pixels, of the full scale."""
    values = pixels.astype(np.float32)
    grey: Grey = values @ WEIGHTS if values.ndim == 3 else values
    grey *= np.float32(1.0 / full_scale)
    return grey
