"""Photographs that are none, damaged, or larger than they look."""

from __future__ import annotations

import io
import struct
import zlib
from functools import cache
from pathlib import Path

import numpy as np
from numpy.random import Generator
from strainwave.rig.vision.image import PICTURES, Image, read_image

from tests.fuzz.laws import Case, described, within_memory
from tests.fuzz.mutation import mutated_bytes, picked

PROMISED = ("PNG", "JPEG", "TIFF", "BMP", "PPM")
OTHERS = ("GIF", "WEBP", "EPS", "PDF", "ICO", "TGA", "PCX", "SGI", "JPEG2000")
SIDES = (1, 15, 16, 300, 10_000, 20_000, 65_535, 10**6, 2**31 - 1)  # px


def images_case(random: Generator, folder: Path) -> Case:
    """A picture under the name of a picture; only what is promised is read, and only as large as is allowed."""
    path = folder / f"image{picked(random, PICTURES)}"
    if random.random() < 0.3:
        width, height = picked(random, SIDES), picked(random, SIDES)
        what, data, allowed = f"{width} x {height}", _claimed(width, height, random), True
    else:
        kind = picked(random, (*PROMISED, *OTHERS))
        what, data, allowed = kind, mutated_bytes(_whole(kind), random), kind in PROMISED
    path.write_bytes(data)

    def check(image: Image) -> None:
        assert allowed, "reads a format that is not promised"
        assert np.isfinite(image.grey).all(), "a brightness that is not finite"

    return Case(f"{path.suffix} {what} {described(data)}", within_memory(lambda: read_image(path)), check)


@cache
def _whole(kind: str) -> bytes:
    """A picture of two markers, as bytes."""
    from PIL import Image as Pillow

    grey = np.zeros((64, 64), np.uint8)
    grey[10:20, 10:20] = grey[40:50, 40:50] = 200
    buffer = io.BytesIO()
    Pillow.fromarray(grey).save(buffer, kind)
    return buffer.getvalue()


def _claimed(width: int, height: int, random: Generator) -> bytes:
    """A black PNG whose header states this size, with the rows that a few megabytes of zeros make."""

    def chunk(name: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))

    colour = picked(random, (0, 2, 6))
    row = 1 + width * {0: 1, 2: 3, 6: 4}[colour]
    rows = zlib.compress(bytes(min(row * height, 4 * 10**6)), 1)
    head = struct.pack(">IIBBBBB", width, height, 8, colour, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", rows) + chunk(b"IEND", b"")
