"""How much of what the processor can do at most the steps of the reference drive make use of.

Sums, products and quotients of a step are counted by running it with numbers that count; the most that one core does is
measured in multiply-adds of its widest registers. Both by a program that is compiled here, so a compiler must be there.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import reference_drive
import strainwave as sw
from measure import shortest
from peers import strainwave_drive
from reference_drive import DURATION, OUTPUT_INERTIA
from report import Column, print_table, save, three_digits
from rich.console import Console
from strainwave import _core

COMMAND = ("COMMAND_SLOPE", "COMMAND_AMPLITUDE", "COMMAND_FREQUENCY")
HERE = Path(__file__).resolve().parent
STEP = 2e-4  # s
LANES = {"avx512": 8, "avx2": 4}  # of a pack, whose size is that of a register
PACKS = 8
ROUNDS = 15

COLUMNS = (
    Column("run", words=True),
    *(Column(heading) for heading in ("operations a step", "step [µs]", "1e9 operations/s", "share of the most")),
)


@dataclass(frozen=True)
class Use:
    """Operations of a step, its time [s], and the most that one core does in a second."""

    run: str
    operations: float
    step: float
    most: float

    @property
    def rate(self) -> float:
        """Operations a second."""
        return self.operations / self.step


def counted(compiler: str) -> tuple[float, float]:
    """Operations of a step, and the most that one core does in a second."""
    with tempfile.TemporaryDirectory() as folder:
        program, numbers = Path(folder, "peak"), Path(folder, "reference_drive.inc")
        numbers.write_text("".join(f"{line};\n" for line in assignments()))
        options = ["-std=c++20", "-O3", "-march=native", "-ffp-contract=fast", "-Wno-psabi"]
        places = [f"-I{HERE.parent / 'include'}", f"-I{folder}"]
        command = [f"-D{name}={getattr(reference_drive, name)!r}" for name in COMMAND]
        subprocess.run([compiler, *options, *places, *command, str(HERE / "peak.cpp"), "-o", str(program)], check=True)
        operations, most = subprocess.run([program], check=True, capture_output=True, text=True).stdout.split()
    return float(operations), 1e9 * float(most)


def assignments() -> Iterator[str]:
    """The numbers of the reference drive, as C++ takes them."""
    for path, value, *_ in _core.parameters(strainwave_drive.drive()):
        name, _, place = path.partition("[")
        if place:
            yield f"drive.{name}.count = {int(place[:-1]) + 1}"
        yield f"drive.{path} = {value!r}"


def run(console: Console) -> None:
    """Prints, and writes the table."""
    compiler = shutil.which(os.environ.get("CXX", "c++"))
    if compiler is None:
        console.print("peak: there is no C++ compiler")
        return
    lanes = LANES.get(_core.instruction_set(), 2)
    with console.status("peak"):
        operations, most = counted(compiler)
        drive, command = strainwave_drive.drive(), strainwave_drive.command()
        inertias = {"load.inertia": OUTPUT_INERTIA * np.linspace(0.8, 1.2, PACKS * lanes)}
        runs = {
            "one trajectory": lambda: sw.simulate(drive, command, STEP, sample=DURATION),
            f"packs of {lanes}": lambda: sw.simulate_many(drive, command, inertias, STEP, sample=DURATION, threads=1),
        }
        alone, packed = (time * STEP / DURATION for time in shortest(runs, ROUNDS).values())
        uses = [
            Use("one trajectory", operations, alone, most),
            Use(f"packs of {lanes}", lanes * operations, packed / PACKS, most),
        ]
    print_table(console, f"Of at most {three_digits(1e-9 * most)}e9 operations a second", COLUMNS, [row(use) for use in uses])
    save("peak", uses)


def row(use: Use) -> list[str]:
    numbers = (use.operations, 1e6 * use.step, 1e-9 * use.rate, use.rate / use.most)
    return [use.run, *map(three_digits, numbers)]
