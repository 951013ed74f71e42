"""Guides whoever makes a torsion test, step by step, and writes each down as soon as it is done."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple, Protocol

import numpy as np

from strainwave.files.writing import DRAFT_PREFIX
from strainwave.rig.bench.steps import Step
from strainwave.rig.bench.steps_file import FILE, append_step, read_steps
from strainwave.rig.running.sources import PictureSource

AT_REST_PROBABILITY = 0.99  # share of readings at rest that count as at rest [1]
ZERO_CELSIUS = 273.15  # K


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


def began(steps: Sequence[Step], folder: Path) -> float:
    """Return the time at which a test began [s], on the clock of its photographs; now if it has not begun."""
    for step in steps:
        if step.image is not None and step.time is not None and (folder / step.image).exists():
            return (folder / step.image).stat().st_mtime - step.time
    return time.time()


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
    start, looks = began(steps, folder), dict[int, Look]()
    for planned in plan[len(steps) :]:
        load(planned.number)
        answered = _answer(talk, talk.ask(planned, steps[-1] if steps else None))
        with TemporaryDirectory(prefix=DRAFT_PREFIX, dir=folder) as drafts:
            rest, answered = _at_rest(planned, Path(drafts), source, look, talk, settling, answered)
            if answered.stop or rest.picture is None:
                return steps
            image = f"{planned.number:04}{rest.picture.suffix}"
            os.replace(rest.picture, folder / image)
        steps.append(_made(planned, answered, image, time.time() - start))
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
        if (step.number, step.position, step.unit) != (planned.number, planned.position, planned.unit):
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


def _made(planned: Step, answered: Reply, image: str, since: float) -> Step:
    step = replace(planned, image=image, time=round(since, 1), temperature=answered.temperature)
    if answered.masses is not None:
        step = replace(step, mass_positive=answered.masses[0], mass_negative=answered.masses[1])
    return step
