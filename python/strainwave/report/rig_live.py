"""Display for the operator during a test: what to do next, and the loop as it grows."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import nullcontext, suppress
from dataclasses import dataclass, field
from math import degrees
from typing import TYPE_CHECKING

import numpy as np

from strainwave.report.terminal_plot import loop_lines
from strainwave.rig.bench.steps import Step
from strainwave.rig.running.guide import HELP, Look
from strainwave.typeset import ARCSEC_PER_DEGREE, number

if TYPE_CHECKING:
    from rich.console import Console
    from rich.text import Text


@dataclass(frozen=True)
class Point:
    """A photograph of a test as it is shown.

    Attributes:
        name: of the photograph, or of the step
        torque: on the shaft [N.m], or None if it is not known
        look: angle of the photograph
        warnings: what makes it doubtful
    """

    name: str
    torque: float | None
    look: Look
    warnings: tuple[str, ...] = ()


def point_line(point: Point) -> str:
    """A photograph as one line of text.

    >>> point_line(Point("0007.png", 0.147, Look(-0.05, 2e-5)))
    '0007.png  +0.147 N·m  −2.8648° ± 4.1″'
    """
    torque = "torque not known" if point.torque is None else f"{_signed(point.torque, 3)} N·m"
    if point.look.fault:
        return f"{point.name}  {torque}  NO ANGLE: {point.look.fault}"
    angle = f"{_signed(degrees(point.look.angle), 4)}° ± {number(ARCSEC_PER_DEGREE * degrees(point.look.sigma), 2)}″"
    doubtful = f"  DOUBTFUL: {'; '.join(point.warnings)}" if point.warnings else ""
    return f"{point.name}  {torque}  {angle}{doubtful}"


def _signed(value: float, places: int) -> str:
    return f"{value:+.{places}f}".replace("-", "−")


def plot_lines(points: Sequence[Point], width: int, letters: str) -> list[str]:
    """The loop so far; the angle over the number of the photograph where the torque is not known."""
    known = [point for point in points if not point.look.fault and point.torque is not None]
    if len(known) < 2:
        return []
    angle = np.array([point.look.angle for point in known])
    return loop_lines(angle, np.array([point.torque for point in known], float), width, letters)


def _typed() -> str:
    """A line of the standard input."""
    return input()


@dataclass
class Terminal:
    """Dialogue with the operator of the rig, over a terminal or a pipe.

    Attributes:
        console: where to
        steps: how many steps the test has
        change: returns which masses to add and remove for a step, given the one before it
        torque: on the shaft in a step [N.m]
        read: waits for an answer
    """

    console: Console
    steps: int
    change: Callable[[Step, Step | None], str]
    torque: Callable[[Step], float]
    read: Callable[[], str] = _typed
    before: dict[int, Look] = field(default_factory=dict)

    def ask(self, step: Step, before: Step | None) -> str:
        """Show which masses to add and remove, and wait."""
        if before is None or (step.position, step.unit) != (before.position, before.unit):
            self._tell(f"\n{_place(step)}", "bold")
            if before is None:
                self._tell(HELP, "dim")
        self._tell(f"\nStep {step.number} of {self.steps}: {self.change(step, before)}", "bold cyan")
        return self._read("Enter when it hangs still > ")

    def hint(self, words: str) -> str:
        """Show what went wrong, and wait."""
        self._tell(words, "yellow")
        return self._read("> ")

    def seen(self, look: Look) -> None:
        """One line that is written over, of a terminal; nothing in a pipe."""
        if self.console.is_terminal:
            words = look.fault or f"{_signed(degrees(look.angle), 4)}°"
            self.console.print(
                f"  settling: {words}", end="\r", markup=False, highlight=False, overflow="ellipsis", no_wrap=True
            )

    def done(self, steps: Sequence[Step], looks: Mapping[int, Look]) -> None:
        """The step that was made, and the loop so far."""
        looks = {**self.before, **looks}
        here = [step for step in steps if (step.position, step.unit) == (steps[-1].position, steps[-1].unit)]
        points = [Point(str(step.image), self.torque(step), looks[step.number]) for step in here if step.number in looks]
        self._tell(f"  {point_line(points[-1])}", "green")
        if self.console.is_terminal:
            for line in plot_lines(points, self.console.width, self.console.encoding):
                self._tell(line, "")

    def _tell(self, words: str, style: str) -> None:
        self.console.print(words, style=style or None, markup=False, highlight=False)

    def _read(self, prompt: str) -> str:
        self.console.print(prompt, end="", markup=False, highlight=False)
        try:
            return self.read()
        except EOFError:  # nobody is there any more
            return "q"


def _place(step: Step) -> str:
    at = f"lexspline at {degrees(step.position):.6g}°"
    return f"Unit {step.unit}, f{at}" if step.unit else f"F{at}"


def live(
    console: Console,
    look: Callable[[], Sequence[Point]],
    idle: float,
    interval: float = 0.5,
    now: Callable[[], float] = time.monotonic,
    pause: Callable[[float], None] = time.sleep,
) -> list[Point]:
    """Show photographs as they come, until none came for a while or whoever looks presses Ctrl-C.

    A terminal shows the loop, drawn anew with each photograph; a pipe gets a line for each.

    Args:
        console: where to
        look: returns what is new
        idle: ends when nothing new came for so long [s]
        interval: from one look to the next [s]
        now, pause: the clock [s]
    """
    from rich.live import Live

    points: list[Point] = []
    with (
        Live(_picture(console, points), console=console, auto_refresh=False, transient=False)
        if console.is_terminal
        else nullcontext() as view
    ):
        last = now()
        with suppress(KeyboardInterrupt):
            while now() - last < idle:
                if new := look():
                    points += new
                    last = now()
                    if view is not None:
                        view.update(_picture(console, points), refresh=True)
                    else:
                        for point in new:
                            console.print(point_line(point), markup=False, highlight=False, soft_wrap=True)
                pause(interval)
    return points


def _picture(console: Console, points: Sequence[Point]) -> Text:
    from rich.text import Text

    last = [point_line(point) for point in points[-3:]] or ["waiting for photographs; Ctrl-C ends"]
    return Text("\n".join([*plot_lines(points, console.width, console.encoding), *last]), no_wrap=True, overflow="ellipsis")
