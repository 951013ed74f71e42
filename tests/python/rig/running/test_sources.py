"""Pictures from a camera, from a folder that another program fills, and from a virtual rig."""

from __future__ import annotations

import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from PIL import Image
from strainwave.rig.running.sources import Device, Filled, Virtual
from strainwave.rig.virtual.render import Scene, render

SMALL = Scene(size=(160, 120), radius=10.0, distance=80.0)


def camera(monkeypatch: pytest.MonkeyPatch, *pictures: Any, opens: bool = True) -> None:
    """Puts in place of opencv what gives these pictures, one after the other."""
    taken = iter(pictures)

    def read() -> tuple[bool, Any]:
        picture = next(taken, None)
        return picture is not None, picture

    capture = SimpleNamespace(isOpened=lambda: opens, read=read)
    monkeypatch.setitem(sys.modules, "cv2", SimpleNamespace(VideoCapture=lambda number: capture))


def test_a_camera_gives_its_picture_with_the_colours_in_order(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    blue_first = np.zeros((4, 6, 3), np.uint8)
    blue_first[..., 0] = 200
    camera(monkeypatch, blue_first, np.full((4, 6), 77, np.uint8))
    device = Device(0)
    assert Image.open(device.take(tmp_path)).getpixel((0, 0)) == (0, 0, 200)
    assert Image.open(device.take(tmp_path)).getpixel((0, 0)) == 77
    with pytest.raises(OSError, match="camera 0 gives no picture"):
        device.take(tmp_path)


def test_a_camera_that_cannot_be_used_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    camera(monkeypatch, opens=False)
    with pytest.raises(OSError, match="camera 3 cannot be opened"):
        Device(3)
    monkeypatch.setitem(sys.modules, "cv2", None)
    with pytest.raises(ImportError, match=r"install strainwave\[video\]"):
        Device(0)


def test_of_a_folder_the_newest_complete_picture_is_taken(tmp_path: Path) -> None:
    filled, drafts = tmp_path / "camera", tmp_path / "drafts"
    filled.mkdir()
    drafts.mkdir()
    (filled / "old.png").write_bytes(b"old")
    source = Filled(filled)
    assert source.take(drafts) is None  # it lay there before
    (filled / "note.txt").write_bytes(b"no picture")
    (filled / "one.JPG").write_bytes(b"half")
    assert source.take(drafts) is None  # it may still be growing
    (filled / "one.JPG").write_bytes(b"whole of it")
    assert source.take(drafts) is None
    taken = source.take(drafts)
    assert taken == drafts / "picture.jpg"
    assert taken.read_bytes() == b"whole of it"
    assert source.take(drafts) is None  # once
    assert (filled / "one.JPG").exists()


def test_links_in_a_folder_are_no_pictures(tmp_path: Path) -> None:
    filled = tmp_path / "camera"
    filled.mkdir()
    source = Filled(filled)
    (tmp_path / "elsewhere.png").write_bytes(b"not of this camera")
    (filled / "link.png").symlink_to("../elsewhere.png")
    (filled / "zero.png").symlink_to("/dev/zero")
    assert [source.take(tmp_path) for _ in range(3)] == [None] * 3


def test_a_folder_that_is_not_there_is_refused(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError, match="there is no such folder"):
        Filled(tmp_path / "nowhere")


def test_a_virtual_shaft_comes_to_rest_at_the_angle_of_its_step(tmp_path: Path) -> None:
    virtual = Virtual(SMALL, np.array([0.0, -0.3, -0.5]), np.random.default_rng(1), settling=0.5)
    virtual.load(2)
    turned = []
    for _ in range(40):
        turned.append(virtual.angle)
        virtual.take(tmp_path)
    assert turned[0] == 0.0
    assert np.all(np.diff(turned) <= 0.0)
    assert virtual.angle == pytest.approx(-0.3, abs=1e-9)
    picture = np.asarray(Image.open(virtual.take(tmp_path)))
    assert np.array_equal(picture, render(SMALL, virtual.angle, np.random.default_rng(1)))  # without noise
    virtual.load(3)
    assert virtual.angle == -0.3
