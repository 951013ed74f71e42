"""Photographs as files: what can be read, and what is said of the rest."""

from __future__ import annotations

import hashlib
import os
import struct
import sys
from collections.abc import Sequence
from datetime import datetime
from pathlib import Path

import numpy as np
import pytest
from PIL import Image as Pillow
from strainwave.rig.virtual.render import Scene, render
from strainwave.rig.vision import decoding
from strainwave.rig.vision.angle import measure_angles
from strainwave.rig.vision.image import (
    CAPTURE_OPTIONS,
    as_image,
    by_number,
    imageio_arrays,
    picture_files,
    read_image,
    series_images,
    video_images,
)
from strainwave.rig.vision.marker import look

RAMP = np.arange(24 * 32, dtype=np.uint8).reshape(24, 32)


@pytest.mark.parametrize("suffix", ["png", "tif", "bmp", "pgm"])
def test_eight_bits_are_read_as_shares_of_255(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"a.{suffix}"
    Pillow.fromarray(RAMP).save(path)
    image = read_image(path)
    np.testing.assert_allclose(image.grey, RAMP / 255.0, rtol=1e-6)
    assert image.grey.dtype == np.float32
    assert image.name == path.name
    assert image.sha256 == hashlib.sha256(path.read_bytes()).hexdigest()
    assert image.taken is None


@pytest.mark.parametrize("suffix", ["png", "tif"])
def test_sixteen_bits_are_read_as_shares_of_65535(tmp_path: Path, suffix: str) -> None:
    values = (np.arange(24 * 32, dtype=np.uint32) * 85).astype(np.uint16).reshape(24, 32)
    Pillow.fromarray(values).save(tmp_path / f"a.{suffix}")
    np.testing.assert_allclose(read_image(tmp_path / f"a.{suffix}").grey, values / 65535.0, rtol=1e-6)


def test_a_jpeg_is_read_nearly_as_it_was(tmp_path: Path) -> None:
    smooth = np.add.outer(4 * np.arange(24), 2 * np.arange(32)).astype(np.uint8)
    Pillow.fromarray(smooth).save(tmp_path / "a.jpg", quality=95)
    np.testing.assert_allclose(read_image(tmp_path / "a.jpg").grey, smooth / 255.0, atol=0.02)


@pytest.mark.parametrize("mode", ["RGB", "RGBA", "CMYK", "P"])
def test_a_grey_picture_in_colour_is_the_same_grey(tmp_path: Path, mode: str) -> None:
    Pillow.fromarray(RAMP).convert(mode).save(tmp_path / "a.tif")
    np.testing.assert_allclose(read_image(tmp_path / "a.tif").grey, RAMP / 255.0, atol=1.5 / 255.0)


def test_colours_are_weighed_as_bt_601_says(tmp_path: Path) -> None:
    for colour, weight in (((255, 0, 0), 0.299), ((0, 255, 0), 0.587), ((0, 0, 255), 0.114)):
        Pillow.new("RGB", (20, 20), colour).save(tmp_path / "a.png")
        np.testing.assert_allclose(read_image(tmp_path / "a.png").grey, weight, atol=1e-6)


@pytest.mark.parametrize(
    ("orientation", "upright"),
    [(1, RAMP), (3, RAMP[::-1, ::-1]), (6, np.rot90(RAMP, -1)), (8, np.rot90(RAMP)), (2, RAMP[:, ::-1]), (5, RAMP.T)],
)
def test_a_picture_stands_as_its_exif_entry_asks(tmp_path: Path, orientation: int, upright: np.ndarray) -> None:
    """EXIF 2.3, tag 274: 6 is a camera turned against the clock, whose picture is turned with the clock to be seen upright."""
    entries = Pillow.Exif()
    entries[274] = orientation
    Pillow.fromarray(RAMP).save(tmp_path / "a.tif", exif=entries)
    np.testing.assert_allclose(read_image(tmp_path / "a.tif").grey, upright / 255.0, rtol=1e-6)


def test_the_time_is_that_of_the_exif_entry(tmp_path: Path) -> None:
    entries = Pillow.Exif()
    entries[306] = "2024:10:01 08:29:39"
    Pillow.fromarray(RAMP).save(tmp_path / "a.png", exif=entries)
    assert read_image(tmp_path / "a.png").taken == datetime(2024, 10, 1, 8, 29, 39)
    entries[306] = "0000:00:00 00:00:00"  # a camera whose clock was never set
    Pillow.fromarray(RAMP).save(tmp_path / "b.png", exif=entries)
    assert read_image(tmp_path / "b.png").taken is None


def damaged(data: bytes) -> dict[str, bytes]:
    return {
        "empty": b"",
        "text": b"this is no picture\n",
        "half": data[: len(data) // 2],
        "only a head": data[:33],
        "flipped": data[:60] + bytes(255 - each for each in data[60:70]) + data[70:],
        "zeros": data[:40] + bytes(len(data) - 40),
    }


@pytest.mark.parametrize("suffix", ["png", "jpg", "tif"])
def test_no_damaged_file_ends_in_anything_but_one_line(tmp_path: Path, suffix: str) -> None:
    whole = tmp_path / f"whole.{suffix}"
    Pillow.fromarray(np.random.default_rng(1).integers(0, 255, (64, 64)).astype(np.uint8)).save(whole)
    for name, data in damaged(whole.read_bytes()).items():
        path = tmp_path / f"{name}.{suffix}"
        path.write_bytes(data)
        message = refusal(path)
        assert "\n" not in message
        assert message == "" or path.name in message
        assert message or name in ("flipped", "zeros", "half")  # some of which are pictures, still
        assert message or (suffix, name) != ("png", "half")


def refusal(path: Path) -> str:
    try:
        read_image(path)
    except ValueError as error:
        return str(error)
    return ""


@pytest.mark.parametrize(
    ("data", "message"),
    [(b"", "is empty"), (b"no picture", "is not a picture that can be read; PNG, JPEG, TIFF, BMP or PGM can")],
)
def test_what_is_no_picture_is_said_to_be_none(tmp_path: Path, data: bytes, message: str) -> None:
    (tmp_path / "a.png").write_bytes(data)
    with pytest.raises(ValueError, match=message):
        read_image(tmp_path / "a.png")


def test_a_picture_that_breaks_off_is_said_to_be_damaged(tmp_path: Path) -> None:
    Pillow.fromarray(np.random.default_rng(1).integers(0, 255, (64, 64)).astype(np.uint8)).save(tmp_path / "a.png")
    (tmp_path / "a.png").write_bytes((tmp_path / "a.png").read_bytes()[:2000])
    with pytest.raises(ValueError, match=r"a\.png\" is damaged: "):
        read_image(tmp_path / "a.png")


def test_a_picture_that_claims_to_be_huge_is_refused_before_it_fills_memory(tmp_path: Path) -> None:
    head = b"P5 200000 200000 255\n"
    (tmp_path / "a.pgm").write_bytes(head)
    with pytest.raises(ValueError, match=r"a\.pgm\" is too large"):
        read_image(tmp_path / "a.pgm")


def test_a_tiny_picture_is_refused(tmp_path: Path) -> None:
    Pillow.fromarray(RAMP[:8, :9]).save(tmp_path / "a.png")
    with pytest.raises(ValueError, match="has 9 x 8 pixels; two markers need 16 x 16 or more"):
        read_image(tmp_path / "a.png")


def test_floating_point_pictures_have_a_scale_of_one_or_are_refused(tmp_path: Path) -> None:
    Pillow.fromarray((RAMP / 255.0).astype(np.float32)).save(tmp_path / "a.tif")
    np.testing.assert_allclose(read_image(tmp_path / "a.tif").grey, RAMP / 255.0, rtol=1e-6)
    Pillow.fromarray(RAMP.astype(np.float32)).save(tmp_path / "a.tif")
    with pytest.raises(ValueError, match="as floating-point numbers 0 to 1 can be read"):
        read_image(tmp_path / "a.tif")


def test_a_missing_file_is_an_error_of_the_system(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError):
        read_image(tmp_path / "a.png")


def test_a_folder_is_read_in_the_order_of_its_numbers(tmp_path: Path) -> None:
    for name in ("IMG_10.png", "img_9.JPG", "IMG_2.tiff", "notes.txt", ".hidden.png"):
        (tmp_path / name).touch()
    assert [path.name for path in picture_files(tmp_path)] == ["IMG_2.tiff", "img_9.JPG", "IMG_10.png"]
    assert by_number("a2b10") < by_number("a10b2")


def test_a_folder_without_photographs_is_refused(tmp_path: Path) -> None:
    (tmp_path / "notes.txt").touch()
    with pytest.raises(ValueError, match="holds no photograph"):
        picture_files(tmp_path)


def test_an_array_is_an_image_if_it_is_of_whole_numbers() -> None:
    np.testing.assert_allclose(as_image("a", RAMP).grey, RAMP / 255.0, rtol=1e-6)
    np.testing.assert_allclose(as_image("a", np.dstack([RAMP] * 3)).grey, RAMP / 255.0, rtol=1e-5)
    assert as_image("a", RAMP) == as_image("a", RAMP)
    with pytest.raises(TypeError, match="pixels must be uint8 or uint16, not float64"):
        as_image("a", RAMP / 255.0)
    with pytest.raises(TypeError, match=r"give \(255 \* pixels\).astype\(np.uint8\)"):
        as_image("a", RAMP / 255.0)
    with pytest.raises(ValueError, match="leave out the opacity"):
        as_image("a", np.dstack([RAMP] * 4))
    with pytest.raises(ValueError, match=r"pixels have shape \(24, 32, 2\)"):
        as_image("a", np.dstack([RAMP] * 2))
    with pytest.raises(ValueError, match="has 4 x 24 pixels"):
        as_image("a", RAMP[:, :4])


MP4 = b"\0\0\0\x1cftypisom" + bytes(20)


def test_a_video_without_opencv_says_how_to_get_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "cv2", None)
    (tmp_path / "a.mp4").write_bytes(MP4)
    with pytest.raises(ImportError, match=r"a\.mp4: videos are read by opencv: pip install 'strainwave\[video\]'"):
        next(video_images(tmp_path / "a.mp4"))


class Capture:
    """What cv2.VideoCapture is to the reader: frames in colour, blue first."""

    def __init__(self, path: str, reader: int) -> None:
        assert Path(path).is_absolute()
        assert reader == OpenCV.CAP_FFMPEG
        assert os.environ["OPENCV_FFMPEG_CAPTURE_OPTIONS"] == CAPTURE_OPTIONS
        self.left = 0 if "bad" in path else 2
        self.width = 10**6 if "large" in path else RAMP.shape[1]

    def isOpened(self) -> bool:  # noqa: N802
        return True

    def get(self, what: int) -> float:
        return self.width if what == OpenCV.CAP_PROP_FRAME_WIDTH else 10 * RAMP.shape[0]

    def read(self) -> tuple[bool, np.ndarray | None]:
        self.left -= 1
        return (True, np.dstack([RAMP] * 3)) if self.left >= 0 else (False, None)

    def release(self) -> None:
        pass


class OpenCV:
    """As much of cv2 as the reader uses."""

    VideoCapture = Capture
    COLOR_BGR2GRAY = 6
    CAP_FFMPEG = 1900
    CAP_PROP_FRAME_WIDTH, CAP_PROP_FRAME_HEIGHT = 3, 4

    @staticmethod
    def cvtColor(frame: np.ndarray, code: int) -> np.ndarray:  # noqa: N802
        assert code == OpenCV.COLOR_BGR2GRAY
        return frame[:, :, 0]


def test_a_video_gives_its_frames(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "cv2", OpenCV)
    monkeypatch.setenv("OPENCV_FFMPEG_CAPTURE_OPTIONS", "mine")
    for name in ("a.mp4", "bad.mp4", "large.mp4"):
        (tmp_path / name).write_bytes(MP4)
    images = list(video_images(tmp_path / "a.mp4"))
    assert [image.name for image in images] == ["a.mp4#1", "a.mp4#2"]
    np.testing.assert_allclose(images[1].grey, RAMP / 255.0, rtol=1e-6)
    assert os.environ["OPENCV_FFMPEG_CAPTURE_OPTIONS"] == "mine"
    with pytest.raises(ValueError, match="has no frame that opencv can read"):
        list(video_images(tmp_path / "bad.mp4"))
    with pytest.raises(ValueError, match=r'^"large\.mp4" is too large: 1000000 x 240 pixels'):
        list(video_images(tmp_path / "large.mp4"))
    with pytest.raises(FileNotFoundError, match="is not a file"):
        list(video_images(tmp_path / "missing.mp4"))


@pytest.mark.parametrize(
    "data",
    [
        b"",
        b"#EXTM3U\n#EXTINF:1,\nother.mp4\n",
        b"ffconcat version 1.0\nfile other.mp4\n",
        b"<MPD>other.mp4</MPD>",
        b"v=0\no=- ftyp",
    ],
)
def test_what_names_other_files_is_no_video(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, data: bytes) -> None:
    """Playlists, by which FFmpeg opens further files and addresses."""
    monkeypatch.setitem(sys.modules, "cv2", OpenCV)
    (tmp_path / "a.mp4").write_bytes(data)
    with pytest.raises(ValueError, match=r'^"a\.mp4" is not a video that can be read; MP4, MOV, AVI and Matroska can'):
        list(video_images(tmp_path / "a.mp4"))


def test_what_is_no_regular_file_is_no_picture(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "fifo.png")
    (tmp_path / "zero.png").symlink_to("/dev/zero")
    for name in ("fifo.png", "zero.png"):
        with pytest.raises(ValueError, match=f'^"{name}" is not a regular file'):
            read_image(tmp_path / name)
        assert look(tmp_path / name).sha256 == ""


def test_a_folder_is_read_without_what_lies_elsewhere(tmp_path: Path) -> None:
    (tmp_path / "outside.png").touch()
    (tmp_path / "folder").mkdir()
    (tmp_path / "folder" / "link.png").symlink_to("../outside.png")
    os.mkfifo(tmp_path / "folder" / "fifo.png")
    with pytest.raises(ValueError, match=r"holds no photograph; .*; links are not followed"):
        picture_files(tmp_path / "folder")
    (tmp_path / "folder" / "own.png").touch()
    assert [path.name for path in picture_files(tmp_path / "folder")] == ["own.png"]


# ---- Several pictures ------------------------------------------------------------------------------------------------


def turned(degrees: Sequence[float], size: tuple[int, int] = (320, 240)) -> list[np.ndarray]:
    scene = Scene(size=size, radius=20.0, distance=100.0, noise=0.002)
    random = np.random.default_rng(0)
    return [np.asarray(render(scene, np.radians(each), random)) for each in degrees]


def series(path: Path, pictures: Sequence[np.ndarray]) -> Path:
    first, *others = [Pillow.fromarray(each) for each in pictures]
    first.save(path, save_all=True, append_images=others)
    return path


@pytest.mark.parametrize("suffix", ["gif", "tif"])
def test_pictures_of_one_file_give_the_angles_of_a_folder(suffix: str, tmp_path: Path) -> None:
    degrees = (0.0, 5.0, 12.0, 3.0)
    path = series(tmp_path / f"run.{suffix}", turned(degrees))
    angles = measure_angles(path)
    assert [frame.name for frame in angles.useful] == [f"run.{suffix}#{number}" for number in range(1, 5)]
    assert np.degrees(angles.angle) == pytest.approx(degrees, abs=0.1)


def test_arrays_of_any_camera_give_angles() -> None:
    """As imageio.v3.imiter, or the library of a camera, gives them: one after the other."""
    angles = measure_angles(each for each in turned((0.0, 7.0)))
    assert [frame.name for frame in angles.useful] == ["picture 1", "picture 2"]
    assert np.degrees(angles.angle) == pytest.approx([0.0, 7.0], abs=0.1)


def test_of_pictures_of_mixed_sizes_those_of_another_size_have_a_fault() -> None:
    pictures = [*turned((0.0, 5.0, 10.0)), *turned((15.0,), size=(400, 240))]
    angles = measure_angles(pictures)
    assert len(angles.useful) == 3
    assert "most of the images are 320 x 240 px" in angles.frames[3].fault


def test_a_gif_that_claims_to_be_huge_is_refused_before_it_is_decoded(tmp_path: Path) -> None:
    path = series(tmp_path / "run.gif", [RAMP, RAMP[::-1]])
    data = bytearray(path.read_bytes())
    data[6:10] = b"\xff\xff\xff\xff"  # 65535 x 65535 pixels
    path.write_bytes(data)
    with pytest.raises(ValueError, match="is too large"):
        next(series_images(path))


def test_small_pictures_without_end_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A file of kilobytes may contain pictures for hours: their pixels are bounded in all."""
    path = series(tmp_path / "run.gif", [RAMP, RAMP[::-1]] * 20)
    assert len(list(series_images(path))) == 40
    monkeypatch.setattr(decoding, "MAX_SERIES_PIXELS", 10 * RAMP.size)
    pictures = series_images(path)
    assert [next(pictures).name for _ in range(10)][-1] == "run.gif#10"
    with pytest.raises(ValueError, match="has more than can be read: 10000 pictures"):
        next(pictures)


@pytest.mark.parametrize("suffix", ["gif", "tif"])
def test_no_damaged_series_ends_in_anything_but_one_line(suffix: str, tmp_path: Path) -> None:
    random = np.random.default_rng(1)
    whole = series(tmp_path / f"run.{suffix}", [RAMP, RAMP[::-1], RAMP]).read_bytes()
    path = tmp_path / f"damaged.{suffix}"
    refused = list[str]()
    for cut in random.integers(8, len(whole), 20).tolist():
        damaged = bytearray(whole[:cut])
        damaged[int(random.integers(6, cut))] ^= int(random.integers(1, 256))
        path.write_bytes(damaged)
        try:
            list(series_images(path))
        except ValueError as error:
            refused.append(str(error))
    assert len(refused) > 10
    assert not any("\n" in each for each in refused)


def test_pages_that_follow_each_other_in_a_circle_are_refused(tmp_path: Path) -> None:
    path = series(tmp_path / "run.tif", [RAMP, RAMP[::-1]])
    data = bytearray(path.read_bytes())
    (first,) = struct.unpack_from("<L", data, 4)
    (count,) = struct.unpack_from("<H", data, first)
    (second,) = struct.unpack_from("<L", data, first + 2 + 12 * count)
    (count,) = struct.unpack_from("<H", data, second)
    struct.pack_into("<L", data, second + 2 + 12 * count, first)
    path.write_bytes(data)
    with pytest.raises(ValueError, match="has more than 10000 pages, or the same one again"):
        list(series_images(path))


@pytest.mark.parametrize("source", ["https://example.org/a.gif", "imageio:chelsea.png", "/etc/hostname", "<video0>/x", ""])
def test_what_is_no_camera_of_imageio_is_refused(source: str) -> None:
    with pytest.raises(ValueError, match="is no camera of imageio; write it as <video0>"):
        imageio_arrays(source)


def test_a_camera_of_imageio_needs_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "imageio.v3", None)
    with pytest.raises(ImportError, match="pip install 'imageio"):
        imageio_arrays("<video0>")
