"""A guided test: readings at rest, replies, resuming; pictures of a camera, a folder and a virtual rig."""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from PIL import Image
from strainwave.rig.bench.steps import Step, read_steps
from strainwave.rig.running import guide
from strainwave.rig.running.guide import Device, Filled, Frames, Look, Reply, Settling, conduct, reply, settle
from strainwave.rig.virtual.render import Scene, render
from strainwave.rig.virtual.test import Virtual

PLAN = [Step(1, 0.35), Step(2, 0.2), Step(3, 0.0), Step(4, 0.0, 0.35)]
QUICK = Settling(pictures=3, interval=0.0, patience=30.0)
SIGMA = 1e-4
SMALL = Scene(size=(160, 120), radius=10.0, distance=80.0)


class Numbers:
    """Pictures that are numbers written in a file: angles that come to rest, or whatever is given."""

    def __init__(self, *readings: str) -> None:
        self.readings, self.taken = list(readings), 0

    def take(self, folder: Path) -> Path | None:
        path = folder / "picture.txt"
        text = self.readings[min(self.taken, len(self.readings) - 1)]
        self.taken += 1
        if text == "none":
            return None
        path.write_text(text)
        return path


class Script:
    """Answers as written beforehand; Enter once these are used up."""

    def __init__(self, *answers: str | type[BaseException]) -> None:
        self.answers, self.hints, self.asked = list(answers), list[str](), list[int]()
        self.seen_looks: list[Look] = []
        self.so_far: list[int] = []

    def _next(self) -> str:
        answer = self.answers.pop(0) if self.answers else ""
        if not isinstance(answer, str):
            raise answer
        return answer

    def ask(self, step: Step, before: Step | None) -> str:
        assert (before is None) == (step.number == 1)
        self.asked.append(step.number)
        return self._next()

    def hint(self, words: str) -> str:
        self.hints.append(words)
        return self._next()

    def seen(self, look: Look) -> None:
        self.seen_looks.append(look)

    def done(self, steps: Sequence[Step], looks: Mapping[int, Look]) -> None:
        self.so_far.append(len(steps))


def read(picture: Path, step: Step | None = None) -> Look:
    text = picture.read_text()
    return Look(np.nan, np.nan, text) if text.isalpha() else Look(float(text), SIGMA)


class Clock:
    def __init__(self) -> None:
        self.time = 0.0

    def now(self) -> float:
        return self.time

    def pause(self, seconds: float) -> None:
        self.time += seconds


def test_the_shaft_rests_once_the_last_pictures_agree_within_their_uncertainty(tmp_path: Path) -> None:
    angles = [0.1 * 0.5**n for n in range(30)]
    rest = settle(Numbers(*map(str, angles)), tmp_path, read, QUICK)
    assert rest.settled
    # Three angles of a halving series differ by three times the last one; the range of three is 4.12 sigma in 99 of 100 cases.
    assert 3.0 * rest.look.angle <= 4.12 * SIGMA < 6.0 * rest.look.angle


def test_noise_of_its_own_size_is_rest_and_a_creep_is_not(tmp_path: Path) -> None:
    noise = np.random.default_rng(7).normal(0.0, SIGMA, 50)
    assert settle(Numbers(*map(str, noise)), tmp_path, read, QUICK).settled
    clock = Clock()
    creep = Numbers(*(str(3.0 * SIGMA * n) for n in range(1000)))
    rest = settle(creep, tmp_path, read, Settling(3, 0.5, 10.0), now=clock.now, pause=clock.pause)
    assert not rest.settled
    assert rest.spread == pytest.approx(6.0 * SIGMA)
    assert clock.time == 10.0


def test_a_picture_that_tells_nothing_begins_the_count_anew(tmp_path: Path) -> None:
    source = Numbers("1.0", "1.0", "blurred", "1.0", "1.0", "1.0", "1.0")
    assert settle(source, tmp_path, read, QUICK).settled
    assert source.taken == 6


def test_where_no_picture_comes_patience_ends(tmp_path: Path) -> None:
    clock = Clock()
    rest = settle(Numbers("none"), tmp_path, read, Settling(patience=5.0), now=clock.now, pause=clock.pause)
    assert rest.picture is None
    assert rest.look.fault == "no picture came"


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("", Reply()),
        ("t 23,5", Reply(temperature=23.5 + 273.15)),
        ("m 350 0", Reply(masses=(0.35, 0.0))),
        ("q", Reply(stop=True)),
        ("r", Reply(record=True)),
    ],
)
def test_answers_are_understood(text: str, expected: Reply) -> None:
    assert reply(text) == expected


@pytest.mark.parametrize("text", ["x", "t", "t warm", "m 350", "m -1 0", "q 1", "t -300", "m nan 0", "t nan"])
def test_other_answers_are_refused_with_what_may_be_answered(text: str) -> None:
    with pytest.raises(ValueError, match="Enter: done"):
        reply(text)


def test_each_step_is_written_with_its_photograph_masses_and_temperature(tmp_path: Path) -> None:
    talk = Script("t 23.5", "what", "m 150 50", "")
    steps = conduct(PLAN, tmp_path, Numbers("0.5"), read, talk, QUICK)
    assert steps == read_steps(tmp_path)
    assert [step.image for step in steps] == ["0001.txt", "0002.txt", "0003.txt", "0004.txt"]
    assert all((tmp_path / str(step.image)).read_text() == "0.5" for step in steps)
    assert [step.temperature for step in steps] == [pytest.approx(296.65), None, None, None]
    assert [(step.mass_positive, step.mass_negative) for step in steps] == [(0.35, 0.0), (0.15, 0.05), (0.0, 0.0), (0.0, 0.35)]
    assert talk.so_far == [1, 2, 3, 4]
    assert len(talk.hints) == 1
    assert sorted(path.name for path in tmp_path.iterdir()) == ["0001.txt", "0002.txt", "0003.txt", "0004.txt", "steps.csv"]


@pytest.mark.parametrize("end", ["q", KeyboardInterrupt])
def test_a_test_that_was_broken_off_goes_on_where_it_stopped(tmp_path: Path, end: str | type[BaseException]) -> None:
    first = Script("", "", end)
    if end == "q":
        assert len(conduct(PLAN, tmp_path, Numbers("0.5"), read, first, QUICK)) == 2
    else:
        with pytest.raises(KeyboardInterrupt):
            conduct(PLAN, tmp_path, Numbers("0.5"), read, first, QUICK)
    assert len(read_steps(tmp_path)) == 2
    second = Script()
    steps = conduct(PLAN, tmp_path, Numbers("0.5"), read, second, QUICK)
    assert second.asked == [3, 4]
    assert [step.number for step in steps] == [1, 2, 3, 4]
    times = [step.time for step in steps]
    assert times == sorted(times)


def test_a_break_between_photograph_and_row_loses_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    conduct(PLAN[:1], tmp_path, Numbers("0.5"), read, Script(), QUICK)

    def killed(*_: object) -> None:
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(guide, "append_step", killed)
        with pytest.raises(KeyboardInterrupt):
            conduct(PLAN, tmp_path, Numbers("0.6"), read, Script(), QUICK)
    assert (tmp_path / "0002.txt").exists()
    assert len(read_steps(tmp_path)) == 1
    assert len(conduct(PLAN, tmp_path, Numbers("0.7"), read, Script(), QUICK)) == 4
    assert (tmp_path / "0002.txt").read_text() == "0.7"


def test_a_shaft_that_still_moves_is_recorded_only_if_wanted(tmp_path: Path) -> None:
    moving = Numbers(*(str(0.1 * n) for n in range(100)))
    impatient = Settling(3, 0.0, 0.0)
    talk = Script("", "", "r")
    steps = conduct(PLAN[:1], tmp_path, moving, read, talk, impatient)
    assert len(steps) == 1
    assert len(talk.hints) == 2
    assert "still moves" in talk.hints[0]


def test_a_picture_that_tells_nothing_is_never_recorded(tmp_path: Path) -> None:
    talk = Script("", "r", "q")
    assert conduct(PLAN, tmp_path, Numbers("blurred"), read, talk, Settling(3, 0.0, 0.0)) == []
    assert all("blurred" in hint for hint in talk.hints)
    assert list(tmp_path.iterdir()) == []


def test_the_steps_of_another_plan_are_refused(tmp_path: Path) -> None:
    conduct(PLAN, tmp_path, Numbers("0.5"), read, Script(), QUICK)
    with pytest.raises(ValueError, match=r"holds 4 steps, the plan 3"):
        conduct(PLAN[:3], tmp_path, Numbers("0.5"), read, Script(), QUICK)
    other = [Step(number, 0.35, position=1.0) for number in range(1, 6)]
    with pytest.raises(ValueError, match=r"step 1 does not belong to the plan"):
        conduct(other, tmp_path, Numbers("0.5"), read, Script(), QUICK)


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


def test_any_camera_that_gives_arrays_is_a_source(tmp_path: Path) -> None:
    tiny, grey = np.zeros((4, 6), np.uint8), np.full((20, 30), 77, np.uint8)
    source = Frames("imageio:<video0>", iter([grey, np.dstack([grey, 0 * grey, 0 * grey]), tiny]))
    assert Image.open(source.take(tmp_path)).getpixel((0, 0)) == 77
    assert Image.open(source.take(tmp_path)).getpixel((0, 0)) == (77, 0, 0)
    with pytest.raises(ValueError, match="two markers need 16 x 16 or more"):
        source.take(tmp_path)
    with pytest.raises(OSError, match="imageio:<video0> gives no picture"):
        source.take(tmp_path)


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
