"""Display for the operator during a test: what to do next, and the loop as it grows, in the letters of a terminal."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import nullcontext, suppress
from dataclasses import dataclass, field
from math import ceil, degrees, floor, log10
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from strainwave.rig.bench.steps import Step
from strainwave.rig.running.guide import HELP, Look, Point
from strainwave.typeset import ARCSEC_PER_DEGREE, number

if TYPE_CHECKING:
    from rich.console import Console
    from rich.text import Text

Array = NDArray[np.float64]

PLOT_ROWS = 16  # of the plot, its axis not counted
MIN_COLUMNS = 36  # columns of a terminal that a plot needs
BRAILLE_BLANK = 0x2800  # code point of the empty sign; its dots are bits, two columns of four
DOTS = ((0x01, 0x02, 0x04, 0x40), (0x08, 0x10, 0x20, 0x80))
SIGNS = "⣿·┤└─●°−"  # what a terminal must be able to show; plain letters take their place otherwise
ROUND = (1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0)  # ends of axes, times a power of ten


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


@dataclass
class Terminal:
    """Dialogue with the operator of the rig, over a terminal or a pipe.

    Attributes:
        console: where to
        steps: how many steps the test has
        tasks: which masses to add and remove for a step, by its number
        torque: on the shaft in a step [N.m]
        read: waits for an answer
    """

    console: Console
    steps: int
    tasks: Mapping[int, str]
    torque: Callable[[Step], float]
    read: Callable[[], str] = lambda: input()
    before: dict[int, Look] = field(default_factory=dict)

    def ask(self, step: Step, before: Step | None) -> str:
        """Show which masses to add and remove, and wait."""
        if before is None or step.place != before.place:
            at = f"lexspline at {degrees(step.position):.6g}°"
            self._tell(f"\nUnit {step.unit}, f{at}" if step.unit else f"\nF{at}", "bold")
            if before is None:
                self._tell(HELP, "dim")
        self._tell(f"\nStep {step.number} of {self.steps}: {self.tasks[step.number]}", "bold cyan")
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
        here = [step for step in steps if step.place == steps[-1].place]
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


def loop_lines(angle: Array, torque: Array, width: int, letters: str = "utf-8", rows: int = PLOT_ROWS) -> list[str]:
    """Return a loop as lines of text: torque upwards in N.m, angle to the right in degrees, the last point marked.

    Args:
        angle: how far the shaft has turned [rad], shape (n,), n >= 1
        torque: on the shaft [N.m], shape (n,)
        width: columns of the terminal; one that is too narrow gets no plot
        letters: encoding of the terminal; dots of braille where it has them
        rows: of the plot

    >>> for line in loop_lines(np.radians([0.0, -10.0, -50.0]), np.array([0.36, 0.0, -0.36]), 44, "ascii", rows=5):
    ...     print(line)
    torque [N.m]
       0.4 |                                 ..
           |                             ....
         0 |                    .........
           |     ...............
      -0.4 |*....
           +-----------------------------------
            -50                               0
                                    angle [deg]
    """
    if width < MIN_COLUMNS:
        return []
    plain = not _shows(SIGNS, letters)
    degrees = np.degrees(angle)
    across, up = _ends(degrees), _ends(torque)
    names = {rows - 1: _written(up[0], plain), 0: _written(up[1], plain)}
    if up[0] < 0.0 < up[1]:
        names[round((rows - 1) * up[1] / (up[1] - up[0]))] = "0"
    margin = max(map(len, names.values())) + 2
    columns = width - margin - 3
    canvas = _Canvas(columns, rows, plain)
    canvas.join((degrees - across[0]) / (across[1] - across[0]), (up[1] - torque) / (up[1] - up[0]))
    edge, corner, rule = (" |", " +", "-") if plain else (" ┤", " └", "─")
    low, high = (_written(value, plain) for value in across)
    return [
        "torque [N.m]" if plain else "torque [N·m]",
        *(f"{names.get(row, ''):>{margin}}{edge}{text}".rstrip() for row, text in enumerate(canvas.lines())),
        " " * margin + corner + rule * columns,
        " " * (margin + 2) + low + f"{high:>{columns - len(low)}}",
        f"{'angle [deg]' if plain else 'angle [°]':>{margin + 2 + columns}}",
    ]


def _shows(signs: str, letters: str) -> bool:
    try:
        signs.encode(letters)
    except (UnicodeEncodeError, LookupError):
        return False
    return True


def _written(value: float, plain: bool) -> str:
    text = f"{value:.6g}"
    return text if plain else text.replace("-", "−")


def _ends(values: Array) -> tuple[float, float]:
    """Round numbers around the values and zero, so that the axis stays while few points come in."""
    low, high = min(float(values.min()), 0.0), max(float(values.max()), 0.0)
    if low == high:
        return -1.0, 1.0
    return -_rounded_up(-low), _rounded_up(high)


def _rounded_up(value: float) -> float:
    if value <= 0.0:
        return 0.0
    decade = 10.0 ** floor(log10(value))
    return decade * next(each for each in ROUND if value <= each * decade * (1.0 + 1e-9))


@dataclass
class _Canvas:
    """Dots on a grid of letters: 2 by 4 to a letter of braille, one to a plain letter."""

    columns: int
    rows: int
    plain: bool
    dots: set[tuple[int, int]] = field(default_factory=set)
    last: tuple[int, int] = (0, 0)

    @property
    def size(self) -> tuple[int, int]:
        return (self.columns, self.rows) if self.plain else (2 * self.columns, 4 * self.rows)

    def join(self, x: Array, y: Array) -> None:
        """Straight lines between points, whose coordinates go from 0 to 1, rightwards and down."""
        wide, high = self.size
        place = np.column_stack([x * (wide - 1), y * (high - 1)])
        for start, stop in zip(place, place[1:] if len(place) > 1 else place, strict=False):
            count = ceil(float(np.abs(stop - start).max())) + 1
            line = np.rint(np.linspace(start, stop, count)).astype(int)
            self.dots |= {(int(column), int(row)) for column, row in line}
        self.last = (int(np.rint(place[-1, 0])), int(np.rint(place[-1, 1])))

    def lines(self) -> list[str]:
        if self.plain:
            grid = [["." if (column, row) in self.dots else " " for column in range(self.columns)] for row in range(self.rows)]
            grid[self.last[1]][self.last[0]] = "*"
        else:
            bits = np.zeros((self.rows, self.columns), int)
            for column, row in self.dots:
                bits[row // 4, column // 2] |= DOTS[column % 2][row % 4]
            grid = [[chr(BRAILLE_BLANK + bit) if bit else " " for bit in each] for each in bits.tolist()]
            grid[self.last[1] // 4][self.last[0] // 2] = "●"
        return ["".join(row) for row in grid]
