"""Pictures that cost more than they show: of other formats, too large, with too many parts; each is refused in one line."""

from __future__ import annotations

import io
import struct
import zlib
from typing import Any

import numpy as np
import pytest
from PIL import Image as Pillow
from strainwave.files.budget import RefusedFile
from strainwave.rig.vision.decoding import MAX_PARTS, decoded, grey_of

RAMP = np.arange(24 * 32, dtype=np.uint8).reshape(24, 32)
SIGNATURE = b"\x89PNG\r\n\x1a\n"


def saved(kind: str, picture: Any = RAMP, **options: Any) -> bytes:
    buffer = io.BytesIO()
    Pillow.fromarray(picture).save(buffer, kind, **options)
    return buffer.getvalue()


def chunk(name: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))


def png(width: int, height: int, *chunks: bytes) -> bytes:
    """A PNG of 1 bit a pixel that claims this size, with a few of its rows."""
    head = chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 1, 0, 0, 0, 0))
    return SIGNATURE + head + b"".join(chunks) + chunk(b"IDAT", zlib.compress(bytes(1000))) + chunk(b"IEND", b"")


def tiff(*entries: tuple[int, int, int, int], pixels: bytes = b"") -> bytes:
    """A grey TIFF of 32 x 24 pixels with its directory at the end; entries replace those of the same tag."""
    usual = {256: (4, 1, 32), 257: (4, 1, 24), 258: (3, 1, 8), 259: (3, 1, 1), 262: (3, 1, 1), 273: (4, 1, 8), 279: (4, 1, 768)}
    tags = usual | {tag: rest for tag, *rest in entries}  # type: ignore[dict-item]
    rows = b"".join(struct.pack("<HHLL", tag, *rest) for tag, rest in sorted(tags.items()))
    content = pixels or RAMP.tobytes()
    return b"II*\0" + struct.pack("<L", 8 + len(content)) + content + struct.pack("<H", len(tags)) + rows + bytes(4)


def with_head(picture: bytes, *segments: bytes) -> bytes:
    """A JPEG with more segments before its own."""
    return picture[:2] + b"".join(segments) + picture[2:]


def segment(marker: int, data: bytes) -> bytes:
    return bytes((0xFF, marker)) + struct.pack(">H", len(data) + 2) + data


def with_scans(count: int, comment: bytes = b"") -> bytes:
    """A progressive JPEG whose last scan comes again and again."""
    whole = saved("JPEG", progressive=True)
    last = whole[whole.rfind(b"\xff\xc4") : -2]
    return whole[:-2] + (segment(0xFE, comment) if comment else b"") + count * last + whole[-2:]


@pytest.mark.parametrize("kind", ["GIF", "WEBP", "EPS", "PDF", "ICO", "TGA", "PCX", "SGI", "JPEG2000", "DIB"])
def test_other_formats_are_refused_whatever_the_name(kind: str) -> None:
    with pytest.raises(RefusedFile, match="is not a picture that can be read; PNG, JPEG, TIFF, BMP or PGM can"):
        decoded(saved(kind))


def test_postscript_starts_no_other_program(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("subprocess.Popen", None)
    text = b"%!PS-Adobe-3.0 EPSF-3.0\n%%BoundingBox: 0 0 100 100\n%%EndComments\nshowpage\n%%EOF\n"
    with pytest.raises(RefusedFile, match="is not a picture"):
        decoded(text)


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (png(9000, 9000), "is too large: 9000 x 9000 pixels; 67108864 in all can be read"),
        (png(30000, 30000), "is too large: 67108864 pixels can be read"),
        (png(10**6, 8), "has 1000000 x 8 pixels; two markers need 16 x 16 or more"),
        (b"P5 9000 9000 255\n", "is too large: 9000 x 9000 pixels"),
        (b"P5 32 24 65536\n", "is damaged: its full scale is 65536"),
        (b"P5 32 24 0\n", "is damaged: its full scale is 0"),
        (b"P5 32 24 255\n" + bytes(700), "is damaged: it ends after 700 of 768 numbers"),
        (b"P5 32 24 99\n" + bytes([200]) * 768, "is damaged: a pixel is outside of 0 to 99, its full scale"),
        (b"P2 32 24 255\n" + b"1 " * 700, "is damaged: it ends after 700 of 768 numbers"),
        (b"\xff\xd8" + b"\xff" * 100, "is damaged: it is no JPEG picture, though it begins as one"),
        (b"P2 32 24 99\n" + b"-1 " * 768, "is damaged: a pixel is outside of 0 to 99, its full scale"),
        (b"P5 #" + bytes(5000) + b"\n32 24 255\n" + bytes(768), "is damaged: it does not begin with width, height"),
        (b"P2 32 24 255\n" + b"#\n" * 5000, "is damaged: "),
        (SIGNATURE + chunk(b"junk", b"") * (MAX_PARTS + 1), "has more than 20000 chunks"),
        (png(32, 24, chunk(b"iCCP", b"a\0\0" + zlib.compress(bytes(10**7)))), "is damaged: Decompressed data too large"),
        (png(32, 24, chunk(b"zTXt", b"a\0\0" + zlib.compress(bytes(10**6))) * 100), "is damaged: Too much memory used in text"),
        (with_head(saved("JPEG"), segment(0xFE, b"") * (MAX_PARTS + 1)), "has more parts than can be read: 20000 segments"),
        (with_head(saved("JPEG"), bytes(1000)), "is not a picture"),
        (with_head(saved("JPEG"), segment(0xFE, b"a"), bytes(1000)), "is damaged: its head is not made of segments"),
        (with_head(saved("JPEG"), segment(0xE1, b"Exif\0\0" + bytes(60_000)) * 2), "has more parts than can be read"),
        (with_scans(60), "has more parts than can be read: 20000 segments, 65536 bytes of EXIF entries, 50 scans"),
        (with_scans(60, comment=b"\xff\xd9"), "has more parts than can be read"),
        (tiff((259, 3, 1, 7)), "is compressed as jpeg; save it as PNG, or without compression"),
        (tiff((259, 3, 1, 34925)), "is compressed as lzma; save it as PNG"),
        (tiff((273, 4, 200_000, 8)), "has tags of more than 33554432 bytes or 100000 numbers"),
        (tiff(*[(40_000 + tag, 7, 10**6, 8) for tag in range(40)]), "has tags of more than 33554432 bytes"),
        (tiff((259, 3, 1, 8), (322, 4, 1, 10**5), (323, 4, 1, 10**5), (324, 4, 1, 8), (325, 4, 1, 768)), "has tiles of more"),
        (tiff((278, 4, 1, 23), (273, 4, 190, 8), (279, 4, 190, 8)), "is damaged: its parts have"),
        (tiff()[:4] + b"\xff\xff\xff\x7f" + tiff()[8:], "is damaged: "),
    ],
)  # fmt: skip
def test_what_costs_more_than_it_shows_is_refused(data: bytes, message: str) -> None:
    with pytest.raises(RefusedFile, match=message):
        decoded(data)


def test_a_bitmap_compressed_by_runs_is_refused() -> None:
    """A delta of 255 rows of 4 million pixels would take a gigabyte."""
    head = struct.pack("<LllHHLLllLL", 40, 2**22, 16, 1, 8, 1, 0, 0, 0, 256, 0)
    palette = bytes(range(256)) * 4
    data = b"BM" + struct.pack("<LHHL", 0, 0, 0, 54 + len(palette)) + head + palette + b"\0\2\xff\xff" * 1000
    with pytest.raises(RefusedFile, match="is compressed as bmp_rle"):
        decoded(data)


@pytest.mark.parametrize(
    "data",
    [
        saved("PNG", save_all=True, append_images=[Pillow.fromarray(RAMP[::-1])]),
        saved("TIFF", compression="tiff_lzw"),
        saved("TIFF", compression="tiff_adobe_deflate"),
        saved("TIFF", compression="packbits"),
        tiff(),
        b"P5\n# a camera\n32 24\n255\n" + RAMP.tobytes(),
        b"P2 32 24 255\n" + b" ".join(b"%d" % each for each in RAMP.ravel()),
        b"P5 32 24 65535\n" + (RAMP.astype(">u2") * 257).tobytes(),
        b"P6 32 24 255\n" + np.repeat(RAMP, 3).tobytes(),
    ],
)
def test_what_is_promised_is_read(data: bytes) -> None:
    grey, taken = decoded(data)
    np.testing.assert_allclose(grey, RAMP / 255.0, atol=1e-6)
    assert taken is None


def test_a_photograph_with_a_film_behind_it_is_read() -> None:
    """Telephones append one; the letters of a scan are in it by chance."""
    whole = saved("JPEG") + b"\xff\xda" * 1000
    np.testing.assert_array_equal(decoded(whole)[0], decoded(saved("JPEG"))[0])


def test_blocks_of_rows_are_the_whole(monkeypatch: pytest.MonkeyPatch) -> None:
    colours = np.random.default_rng(1).integers(0, 255, (40, 32, 3)).astype(np.uint8)
    exif = Pillow.Exif()
    exif[274] = 6
    at_once = decoded(saved("PNG", colours, exif=exif))[0]
    monkeypatch.setattr("strainwave.rig.vision.decoding.BLOCK_PIXELS", 100)
    by_rows = decoded(saved("PNG", colours, exif=exif))[0]
    np.testing.assert_allclose(by_rows, at_once, rtol=1e-6)
    np.testing.assert_allclose(np.rot90(grey_of(colours, 255), -1), at_once, rtol=1e-6)
