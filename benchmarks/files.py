"""Ever more members run to files: time, memory and files.

Each number of members in a process of its own, whose largest memory is told by the system: the reference drive for 0.02 s, each
member with another inertia and another friction, three outputs at 1 kHz.
"""

from __future__ import annotations

import json
import re
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import strainwave as sw
from peers import strainwave_drive
from reference_drive import COULOMB, OUTPUT_INERTIA
from report import Column, print_table, save, three_digits
from rich.console import Console

STEP = 2e-4  # s
DURATION = 0.02  # s
SAMPLE = 1e-3  # s
MEMBERS = (10_000, 100_000, 300_000, 1_000_000)

COLUMNS = (
    Column("members"),
    Column("time [s]"),
    Column("CPU time [s]"),
    Column("of which runs [s]"),
    Column("largest memory [MB]"),
    Column("files [MB]"),
)


@dataclass(frozen=True)
class Crowd:
    """Runs to files: how many, how long, how much; `runs_time` is the CPU time of as many runs that only keep their ends."""

    members: int
    wall_time: float  # s
    cpu_time: float  # s
    runs_time: float  # s
    memory: float  # MB
    files: float  # MB


def written(members: int, folder: str) -> Crowd:
    """Runs them here."""
    drive, command = strainwave_drive.drive(), strainwave_drive.command(DURATION)
    random = np.random.default_rng(members)
    parameters = {
        "load.inertia": OUTPUT_INERTIA * random.uniform(0.8, 1.2, members),
        "gear.friction_input.coulomb": COULOMB * random.uniform(0.8, 1.2, members),
    }
    few = {path: values[:8000] for path, values in parameters.items()}
    cpu = time.process_time()
    sw.simulate_many(drive, command, few, STEP, sample=DURATION)
    runs_time = (time.process_time() - cpu) * members / 8000
    wall, cpu = time.perf_counter(), time.process_time()
    sw.simulation.simulate_to(folder, drive, command, parameters, STEP, sample=SAMPLE)
    wall, cpu = time.perf_counter() - wall, time.process_time() - cpu
    files = sum(path.stat().st_size for path in Path(folder).rglob("*.parquet"))
    memory = most_memory()
    return Crowd(members, wall, cpu, runs_time, 1e-6 * memory, 1e-6 * files)


def most_memory() -> int:
    """The most that this process has held at once [B]. Linux counts in rusage what its parent held, too."""
    status = Path("/proc/self/status")
    if status.exists():
        (held,) = re.findall(r"^VmHWM:\s*(\d+) kB$", status.read_text(), re.MULTILINE)
        return 1024 * int(held)
    return 1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss


def measured(members: int) -> Crowd:
    """In a process of its own."""
    with tempfile.TemporaryDirectory() as folder:
        command = (sys.executable, __file__, str(members), folder)
        told = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    return Crowd(**json.loads(told))


def run(console: Console) -> None:
    """Prints, and writes the table."""
    with console.status("files"):
        crowds = [measured(members) for members in MEMBERS]
    caption = f"{round(DURATION / STEP)} steps each; the runs alone: of 8000 members in memory, the end only, multiplied"
    print_table(console, "Members run to files", COLUMNS, [row(crowd) for crowd in crowds], caption)
    save("files", crowds)


def row(crowd: Crowd) -> list[str]:
    numbers = (crowd.wall_time, crowd.cpu_time, crowd.runs_time, crowd.memory, crowd.files)
    return [str(crowd.members), *map(three_digits, numbers)]


def main(arguments: Sequence[str]) -> None:
    members, folder = arguments
    print(json.dumps(vars(written(int(members), folder))))


if __name__ == "__main__":
    main(sys.argv[1:])
