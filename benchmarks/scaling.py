"""Time over steps, over members and over Maxwell elements: a line each, and the exponent of its power law.

Steps: one reference drive, ever longer. Members: many of them for 0.25 s on one thread, ever more. Elements: one reference
drive with ever more of them, the rest of which costs the same.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
import strainwave as sw
from measure import shortest
from peers import strainwave_drive
from reference_drive import OUTPUT_INERTIA
from report import Column, figure, print_table, save, save_figure, three_digits
from rich.console import Console

if TYPE_CHECKING:
    from matplotlib.figure import Figure

STEP = 2e-4  # s
DURATIONS = (0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0)  # s
MEMBERS = (64, 128, 256, 512, 1024, 2048, 4096)
ELEMENTS = (1, 2, 4, 8, 16)
ROUNDS = 7

COLUMNS = (
    Column("over", words=True),
    Column("from"),
    Column("to"),
    Column("exponent"),
    Column("time of the most / of the least"),
)


@dataclass(frozen=True)
class Line:
    """Times [s] over numbers of something, and the exponent of the power law through them."""

    over: str
    numbers: tuple[int, ...]
    times: tuple[float, ...]
    exponent: float

    @classmethod
    def through(cls, over: str, numbers: Sequence[int], times: Sequence[float]) -> Line:
        exponent = float(np.polyfit(np.log(numbers), np.log(times), 1)[0])
        return cls(over, tuple(numbers), tuple(times), exponent)


def over_steps() -> Line:
    drive = strainwave_drive.drive()
    commands = {round(duration / STEP): strainwave_drive.command(duration) for duration in DURATIONS}
    return measured("steps", {n: partial(sw.simulate, drive, c, STEP, sample=0.1) for n, c in commands.items()})


def over_members() -> Line:
    drive, command = strainwave_drive.drive(), strainwave_drive.command(0.25)
    inertias = {n: {"load.inertia": OUTPUT_INERTIA * np.linspace(0.8, 1.2, n)} for n in MEMBERS}
    run = partial(sw.simulate_many, drive, command, dt=STEP, sample=1e-2, threads=1)
    return measured("members", {n: partial(run, parameters=inertias[n]) for n in MEMBERS})


def over_elements() -> Line:
    drive, command = strainwave_drive.drive(), strainwave_drive.command()

    def runs(n: int) -> Callable[[], object]:
        elements = sw.hysteresis.MaxwellSlip(
            stiffness=n * [3e3 / n], breakaway=(3e3 / n * np.geomspace(5e-5, 2e-3, n)).tolist()
        )
        changed = drive.replace(gear=drive.gear.replace(hysteresis=elements))
        return lambda: sw.simulate(changed, command, STEP, sample=0.1)

    return measured("Maxwell elements", {n: runs(n) for n in ELEMENTS})


def measured(over: str, runs: Mapping[int, Callable[[], object]]) -> Line:
    times = shortest({str(n): run for n, run in runs.items()}, ROUNDS)
    return Line.through(over, list(runs), list(times.values()))


def run(console: Console) -> None:
    """Prints, and writes table and figure."""
    with console.status("scaling"):
        lines = [over_steps(), over_members(), over_elements()]
    caption = "exponent: of the power law through the times, 1 if they are proportional"
    print_table(console, "Time over what there is more of", COLUMNS, [row(line) for line in lines], caption)
    save("scaling", lines)
    save_figure("scaling", drawn(lines))


def row(line: Line) -> list[str]:
    return [
        line.over,
        str(line.numbers[0]),
        str(line.numbers[-1]),
        f"{line.exponent:.2f}",
        three_digits(line.times[-1] / line.times[0]),
    ]


def drawn(lines: Sequence[Line]) -> Figure:
    """A plot a line, with a slope of one beside."""
    picture = figure(width=9.0, height=3.5)
    for axes, line in zip(np.ravel(picture.subplots(1, len(lines))), lines, strict=True):
        numbers = np.array(line.numbers)
        axes.loglog(numbers, line.times, marker="o", label=f"exponent {line.exponent:.2f}")
        axes.loglog(numbers, line.times[-1] / numbers[-1] * numbers, "k:", linewidth=1.0, label="proportional")
        axes.set(xlabel=line.over, ylabel="time [s]")
        axes.grid(alpha=0.3)
        axes.legend()
    return picture
