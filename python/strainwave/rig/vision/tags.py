"""Tags of a picture by TIFF 6.0 and EXIF 2.3: its orientation, and when it was taken."""

from __future__ import annotations

from collections.abc import Iterator
from datetime import datetime
from struct import unpack, unpack_from
from typing import NamedTuple

from strainwave.files.budget import RefusedFile

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
