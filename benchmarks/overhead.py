"""What comes on top of the steps: a call, storing, derivatives, and a controller that samples; each against the run without it.

And what comes before: a process that imports the package or shows its help, against one that does nothing.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
import strainwave as sw
from measure import shortest
from peers import strainwave_drive
from reference_drive import DURATION, OUTPUT_INERTIA, SAMPLE, VOLTAGE_LIMIT
from report import Column, figure, print_table, save, save_figure, three_digits
from rich.console import Console
from strainwave import _core
from strainwave.simulation.excitation import Excitation
from strainwave.simulation.run import differentiate
from strainwave.simulation.signals import outputs

STEP = 2e-4  # s
FEW = 3  # steps
MEMBERS = 128
ROUNDS = 15
OUTPUTS = list(outputs(sw.Drive()))
FREE = (
    "gear.stiffness.a1",
    "gear.stiffness.a3",
    "gear.damping",
    "gear.friction_input.coulomb",
    "gear.friction_input.breakaway",
    "gear.friction_input.stribeck_speed",
    "gear.friction_input.viscous",
    "gear.friction_output.viscous",
    "gear.hysteresis.stiffness[0]",
    "gear.hysteresis.breakaway[0]",
    "motor.inertia",
    "load.inertia",
)

COLUMNS = (Column("what", words=True), Column("without [ms]"), Column("with [ms]"), Column("ratio"))


@dataclass(frozen=True)
class Extra:
    """Times of a run without and with something [s]."""

    what: str
    without: float
    including: float


def call() -> Extra:
    """A call of few steps against the time of its steps in a long one."""
    drive, short = strainwave_drive.drive(), strainwave_drive.command(FEW * STEP)
    whole = strainwave_drive.command()
    many = round(DURATION / STEP)
    runs = {"short": lambda: sw.simulate(drive, short, STEP), "long": lambda: sw.simulate(drive, whole, STEP, sample=DURATION)}
    times = shortest(runs, 10 * ROUNDS)
    return Extra(f"a call of simulate, {FEW} steps", FEW * times["long"] / many, times["short"])


def with_derivatives(count: int) -> Extra:
    """A run with its derivatives by some numbers against the run."""
    drive, command = strainwave_drive.drive(), strainwave_drive.command()
    places = [path for path, *_ in _core.parameters(drive)]
    numbers = [places.index(path) for path in FREE[:count]]
    runs = {
        "without": lambda: sw.simulate(drive, command, STEP, sample=SAMPLE),
        "with": lambda: differentiate(drive, Excitation(command), numbers, STEP, SAMPLE),
    }
    return Extra(f"{count} derivatives", *shortest(runs, ROUNDS).values())


def sampling(delay: float) -> Extra:
    """A cascade that a computer works out at 1 kHz, its result `delay` [s] later, against the same cascade all the time."""
    law = sw.control.Cascade(
        position_gain=20.0,
        speed_proportional=0.1,
        speed_integral=1.0,
        current_proportional=1.0,
        current_integral=300.0,
        speed_feedforward=1.0,
        voltage_limit=VOLTAGE_LIMIT,
    )
    laws: dict[str, sw.control.Cascade | sw.control.Sampled] = {
        "without": law,
        "with": sw.control.Sampled(law=law, period=SAMPLE, delay=delay),
    }
    drive, command = strainwave_drive.drive(), strainwave_drive.command()
    drives = {name: drive.replace(control=each) for name, each in laws.items()}
    runs = {name: partial(sw.simulate, each, command, STEP, sample=SAMPLE) for name, each in drives.items()}
    return Extra(f"cascade sampled at 1 kHz, delay of {1e3 * delay:g} ms", *shortest(runs, 3 * ROUNDS).values())


def storing_one() -> Extra:
    """All outputs of a run at 1 kHz against the two samples that every run has."""
    drive, command = strainwave_drive.drive(), strainwave_drive.command()
    runs = {
        "without": lambda: sw.simulate(drive, command, STEP, sample=DURATION),
        "with": lambda: sw.simulate(drive, command, STEP, sample=SAMPLE),
    }
    return Extra("storing all outputs at 1 kHz, simulate", *shortest(runs, 3 * ROUNDS).values())


def storing_many(recorded: Sequence[str], what: str) -> Extra:
    """The same of many runs on one thread."""
    drive, command = strainwave_drive.drive(), strainwave_drive.command()
    inertias = {"load.inertia": OUTPUT_INERTIA * np.linspace(0.8, 1.2, MEMBERS)}

    def runs(sample: float, record: Sequence[str]) -> object:
        return sw.simulate_many(drive, command, inertias, STEP, record=record, sample=sample, threads=1)

    times = shortest({"without": lambda: runs(DURATION, recorded), "with": lambda: runs(SAMPLE, recorded)}, ROUNDS)
    return Extra(f"storing {what} at 1 kHz, simulate_many", *times.values())


def processes() -> list[Extra]:
    """Whole processes: one that imports the package, and one that shows the help of its command."""
    words = {
        "nothing": "pass",
        "import strainwave": "import strainwave",
        "strainwave --help": "from strainwave.__main__ import main; main()",
    }
    with tempfile.TemporaryDirectory() as folder:
        environment = dict(os.environ, PYTHONPATH=os.pathsep.join([as_installed(folder), *sys.path]))
        runs = {
            name: partial(
                subprocess.run,
                [sys.executable, "-S", "-c", statement, "--help"],
                env=environment,
                check=True,
                stdout=subprocess.DEVNULL,
            )
            for name, statement in words.items()
        }
        nothing, *others = shortest(runs, ROUNDS).items()
    return [Extra(f"{name}, whole process", nothing[1], time) for name, time in others]


def as_installed(folder: str) -> str:
    """A folder with the package as pip installs it: a developer's asks on import whether all is compiled."""
    package = Path(folder, "strainwave")
    package.mkdir()
    files = {file.name: file for module in (sw, _core) for file in Path(str(module.__file__)).parent.iterdir()}
    for name, file in files.items():
        (package / name).symlink_to(file)
    return folder


def run(console: Console) -> None:
    """Prints, and writes table and figure."""
    with console.status("overhead"):
        extras = [
            call(),
            *(with_derivatives(count) for count in (4, 8, len(FREE))),
            *(sampling(delay) for delay in (0.0, 2e-4, 3e-4)),
            storing_one(),
            storing_many(OUTPUTS, f"all {len(OUTPUTS)} outputs"),
            storing_many(["input_angle", "output_angle", "torque", "current"], "4 outputs"),
            *processes(),
        ]
    print_table(console, "What comes on top", COLUMNS, [row(extra) for extra in extras])
    save("overhead", extras)
    draw(extras)


def row(extra: Extra) -> list[str]:
    times = [extra.without, extra.including]
    return [extra.what, *(three_digits(1e3 * time) for time in times), f"{extra.including / extra.without:.3g}"]


def draw(extras: Sequence[Extra]) -> None:
    """Both times of each."""
    drawn = figure(height=3.5)
    axes = drawn.add_subplot()
    places = np.arange(len(extras))
    axes.barh(places - 0.2, [1e3 * extra.without for extra in extras], 0.4, label="without")
    axes.barh(places + 0.2, [1e3 * extra.including for extra in extras], 0.4, label="with")
    axes.set_yticks(places, [extra.what for extra in extras], fontsize=7)
    axes.invert_yaxis()
    axes.set(xscale="log", xlabel="time [ms]", title="What comes on top")
    axes.legend()
    save_figure("overhead", drawn)
