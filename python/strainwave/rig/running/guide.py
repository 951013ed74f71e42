"""Guide for whoever makes a torsion test: pictures of a camera or a folder, step by step, each recorded at once."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from strainwave.files.budget import RefusedFile, read_regular
from strainwave.files.writing import DRAFT_PREFIX
from strainwave.messages import one_line
from strainwave.rig.bench.steps import FILE, Step, append_step, read_steps
from strainwave.rig.vision.decoding import MAX_PICTURE_BYTES
from strainwave.rig.vision.image import as_image, pictures_in

AT_REST_PROBABILITY = 0.99  # share of readings at rest that count as at rest [1]
ZERO_CELSIUS = 273.15  # K
Array = NDArray[np.float64]


class Look(NamedTuple):
    """Angle of a picture.

    Attributes:
        angle: from the reference [rad]; not-a-number if the picture gives none
        sigma: its standard deviation [rad]
        fault: the reason if it gives none, else empty
    """

    angle: float
    sigma: float
    fault: str = ""


class Point(NamedTuple):
    """A photograph of a test that is being run.

    Attributes:
        name: of the photograph, or of the step
        torque: on the shaft [N.m]; None if neither the record nor a plan contains it
        look: its angle from the first photograph of its position and unit
        warnings: what makes it doubtful
    """

    name: str
    torque: float | None
    look: Look
    warnings: tuple[str, ...] = ()


@dataclass(frozen=True)
class Settling:
    """Condition for the shaft to count as at rest.

    Attributes:
        pictures: so many in a row must agree within what their own uncertainty explains; 1 takes the first as it is
        interval: from one to the next [s]
        patience: after which the shaft is reported as not settling [s]
    """

    pictures: int = 5
    interval: float = 0.5
    patience: float = 60.0

    def range(self) -> float:
        """Return the largest range of the readings at rest, in standard deviations: the studentized range."""
        from scipy.stats import studentized_range

        return float(studentized_range.ppf(AT_REST_PROBABILITY, self.pictures, np.inf)) if self.pictures > 1 else 0.0


class Rest(NamedTuple):
    """The last picture before the shaft counted as at rest, or patience ended.

    Attributes:
        picture: its file; None if no useful one came
        look: its angle
        settled: whether the last pictures agree
        spread: how far the last pictures differ [rad]
    """

    picture: Path | None
    look: Look
    settled: bool
    spread: float


@dataclass(frozen=True)
class Reply:
    """Answer of the operator at the rig.

    Attributes:
        temperature: of the gear [K], or None
        masses: on the positive and on the negative pans, as they lie [kg], or None if as asked
        stop: whether to stop here
        record: whether to record though the shaft does not settle
    """

    temperature: float | None = None
    masses: tuple[float, float] | None = None
    stop: bool = False
    record: bool = False


HELP = (
    "Enter: done. t 23.5: done, and the gear has 23.5 °C. m 350 0: done, but 350 g lie on the positive pans and 0 g on the "
    "negative ones. r: record though it moves. q: stop; the test can be resumed."
)


def reply(text: str) -> Reply:
    """An answer, as it was typed.

    Raises:
        ValueError: it cannot be understood

    >>> reply("t 23.5").temperature, reply("m 350 0").masses, reply("").stop
    (296.65, (0.35, 0.0), False)
    """
    word, *rest = text.replace(",", ".").split() or [""]
    try:
        numbers = [float(each) for each in rest]
    except ValueError:
        numbers = [np.nan]
    if word in ("", "q", "r") and not numbers:
        return Reply(stop=word == "q", record=word == "r")
    if word == "t" and len(numbers) == 1 and -ZERO_CELSIUS < numbers[0] < 1e3:
        return Reply(temperature=numbers[0] + ZERO_CELSIUS)
    if word == "m" and len(numbers) == 2 and min(numbers) >= 0.0 and np.all(np.isfinite(numbers)):
        return Reply(masses=(numbers[0] / 1e3, numbers[1] / 1e3))
    raise ValueError(HELP)


def settle(
    source: PictureSource,
    folder: Path,
    look: Callable[[Path], Look],
    settling: Settling,
    seen: Callable[[Look], None] = lambda look: None,
    now: Callable[[], float] = time.monotonic,
    pause: Callable[[float], None] = time.sleep,
) -> Rest:
    """Take pictures until the angle no longer changes beyond its own uncertainty, or patience ends.

    Args:
        source: of the pictures
        folder: where they are put
        look: reads the angle of a picture
        settling: when the shaft counts as at rest
        seen: is called with the angle of each picture
        now, pause: the clock [s]
    """
    last: list[Look] = []
    rest = Rest(None, Look(np.nan, np.nan, "no picture came"), False, np.nan)
    end, apart = now() + settling.patience, settling.range()
    while True:
        if (picture := source.take(folder)) is not None:
            found = look(picture)
            seen(found)
            last = [] if found.fault else [*last, found][-settling.pictures :]
            spread = float(np.ptp([each.angle for each in last])) if last else np.nan
            settled = len(last) == settling.pictures and spread <= apart * max(each.sigma for each in last)
            rest = Rest(None if found.fault else picture, found, settled, spread)
            if settled:
                return rest
        if now() >= end:
            return rest
        pause(settling.interval)


class Talk(Protocol):
    """Speaks with whoever stands at the rig."""

    def ask(self, step: Step, before: Step | None) -> str:
        """Show which masses to add and remove for a step, and return the operator's answer once that is done."""

    def hint(self, words: str) -> str:
        """Show what went wrong, and return the operator's answer."""

    def seen(self, look: Look) -> None:
        """Show the angle of a picture."""

    def done(self, steps: Sequence[Step], looks: Mapping[int, Look]) -> None:
        """Show the test so far: the steps, and the angles of this session's photographs by the number of the step."""


def conduct(
    plan: Sequence[Step],
    folder: Path,
    source: PictureSource,
    look: Callable[[Path, Step], Look],
    talk: Talk,
    settling: Settling = Settling(),
    load: Callable[[int], None] = lambda number: None,
) -> list[Step]:
    """Guide through the steps of a plan that are still to be made, and write each down as soon as it is done.

    The photograph is put in place first and the row of `steps.csv` after it, each whole or not at all: a test that is
    broken off at any moment goes on with the step that has no row.

    Args:
        plan: the steps
        folder: of the test; `steps.csv` in it holds what was done before
        source: of the pictures
        look: reads the angle of a picture that belongs to a step
        talk: speaks with whoever stands at the rig
        settling: when the shaft counts as at rest
        load: is called with the number of each step before its pictures; a virtual rig then lays on its masses

    Returns:
        The steps done by now, those before a break too; fewer than planned if it was stopped.

    Raises:
        ValueError: what was done before does not belong to this plan
    """
    steps = done_before(plan, folder)
    looks = dict[int, Look]()
    timed = [step for step in steps if step.image is not None and step.time is not None and (folder / step.image).exists()]
    # On the clock of the photographs.
    start = (folder / str(timed[0].image)).stat().st_mtime - (timed[0].time or 0.0) if timed else time.time()
    for planned in plan[len(steps) :]:
        load(planned.number)
        answered = _answer(talk, talk.ask(planned, steps[-1] if steps else None))
        with TemporaryDirectory(prefix=DRAFT_PREFIX, dir=folder) as drafts:
            rest, answered = _at_rest(planned, Path(drafts), source, look, talk, settling, answered)
            if answered.stop or rest.picture is None:
                return steps
            image = f"{planned.number:04}{rest.picture.suffix}"
            os.replace(rest.picture, folder / image)
        step = replace(planned, image=image, time=round(time.time() - start, 1), temperature=answered.temperature)
        if answered.masses is not None:
            step = replace(step, mass_positive=answered.masses[0], mass_negative=answered.masses[1])
        steps.append(step)
        append_step(steps[-1], folder)
        looks[planned.number] = rest.look
        talk.done(steps, looks)
    return steps


def done_before(plan: Sequence[Step], folder: Path) -> list[Step]:
    """The steps of a plan that have been made already.

    Raises:
        ValueError: they do not belong to the plan
    """
    if not (folder / FILE).exists():
        return []
    steps = read_steps(folder)
    for step, planned in zip(steps, plan, strict=False):
        if (step.number, step.place) != (planned.number, planned.place):
            raise ValueError(f"{folder / FILE}: step {step.number} does not belong to the plan; give another folder as --out")
    if len(steps) > len(plan):
        raise ValueError(f"{folder / FILE} holds {len(steps)} steps, the plan {len(plan)}; give another folder as --out")
    return steps


def _answer(talk: Talk, text: str) -> Reply:
    while True:
        try:
            return reply(text)
        except ValueError as error:
            text = talk.hint(str(error))


def _at_rest(
    planned: Step,
    drafts: Path,
    source: PictureSource,
    look: Callable[[Path, Step], Look],
    talk: Talk,
    settling: Settling,
    answered: Reply,
) -> tuple[Rest, Reply]:
    """Wait until the shaft rests, or until the operator answers."""
    while not answered.stop:
        source.take(drafts)  # what was taken before the masses lay there
        rest = settle(source, drafts, lambda picture: look(picture, planned), settling, talk.seen)
        if rest.settled:
            return rest, answered
        words = rest.look.fault or f"the shaft still moves: the last pictures differ by {np.degrees(rest.spread):.3g}°"
        again = _answer(talk, talk.hint(f"{words}. Enter: wait again; r: record as it is; q: stop"))
        if again.record and rest.picture is not None:
            return rest, answered
        answered = replace(answered, stop=again.stop)
    return Rest(None, Look(np.nan, np.nan), False, np.nan), answered


class PictureSource(Protocol):
    """Source of pictures of the target, one after the other."""

    def take(self, folder: Path) -> Path | None:
        """Put a new picture into a folder and return its path; None if there is none yet."""


class Device:
    """A camera that opencv can open, by its number.

    Raises:
        ImportError: opencv is not installed
        OSError: the camera cannot be opened
    """

    def __init__(self, number: int) -> None:
        try:
            import cv2
        except ImportError:
            raise ImportError(
                "a camera needs opencv, which is not installed; install strainwave[video], "
                "or let another program fill a folder and give that folder as --camera"
            ) from None
        self.number = number
        self.capture: Any = cv2.VideoCapture(number)
        if not self.capture.isOpened():
            raise OSError(f"camera {number} cannot be opened; is it plugged in, and in use by no other program?")

    def take(self, folder: Path) -> Path:
        """A picture of now, as PNG; `OSError` if the camera gives none."""
        from PIL import Image

        came, picture = self.capture.read()
        if not came:
            raise OSError(f"camera {self.number} gives no picture; is it still plugged in?")
        path = folder / "picture.png"
        Image.fromarray(np.ascontiguousarray(picture[..., ::-1] if picture.ndim == 3 else picture)).save(path)
        return path


class Frames:
    """Pictures of any camera: arrays one after the other, as imageio.v3.imiter, or the library of a camera, gives them.

    Args:
        name: of the camera
        arrays: of pixels, as `as_image` takes them; the next one is a picture of now
    """

    def __init__(self, name: str, arrays: Iterable[NDArray[Any]]) -> None:
        self.name, self.arrays = name, iter(arrays)

    def take(self, folder: Path) -> Path:
        """A picture of now, as PNG.

        Raises:
            OSError: the camera gives none
            ValueError: it is no picture that can be read
        """
        from PIL import Image

        pixels = next(self.arrays, None)
        if pixels is None:
            raise OSError(f"{self.name} gives no picture; is it still plugged in?")
        as_image(self.name, pixels)
        path = folder / "picture.png"
        Image.fromarray(np.ascontiguousarray(pixels)).save(path)
        return path


@dataclass
class Filled:
    """A folder that another program fills; pictures that lie there already are left aside, and symbolic links.

    Raises:
        FileNotFoundError: there is no such folder
    """

    folder: Path
    seen: set[tuple[str, int, int]] = field(default_factory=set)
    sizes: dict[str, int] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if not self.folder.is_dir():
            raise FileNotFoundError(f"--camera {self.folder}: there is no such folder")
        self.seen |= {self._mark(path) for path in self._pictures()}

    def take(self, folder: Path) -> Path | None:
        """A copy of the newest picture that is new, once it has not grown since the last look."""
        new = [path for path in self._pictures() if self._mark(path) not in self.seen and self._complete(path)]
        self.seen |= {self._mark(path) for path in new}
        if not new:
            return None
        copy = folder / f"picture{new[-1].suffix.lower()}"
        try:
            copy.write_bytes(read_regular(new[-1], MAX_PICTURE_BYTES))
        except RefusedFile as error:
            raise ValueError(one_line(f"--camera {new[-1]} {error}")) from None
        return copy

    def _pictures(self) -> list[Path]:
        return sorted(pictures_in(self.folder), key=lambda path: (path.stat().st_mtime_ns, path.name))

    def _complete(self, path: Path) -> bool:
        size, before = path.stat().st_size, self.sizes.get(path.name)
        self.sizes[path.name] = size
        return size > 0 and size == before

    @staticmethod
    def _mark(path: Path) -> tuple[str, int, int]:
        found = path.stat()
        return path.name, found.st_mtime_ns, found.st_size
