"""Accuracy and time of strainwave, beside everything installed that solves the same.

    python benchmarks/run.py                              all parts
    python benchmarks/run.py --only single,stick_slip     these parts
    python benchmarks/run.py --peers casadi,numba         of single, ensemble, actuator: solvers named like a word
    python benchmarks/run.py --quick                      of those and stick_slip: one run each, 20 s at most

single       one trajectory of the reference drive: error and time of all solvers
ensemble     many reference drives at once: trajectories a second
actuator     one trajectory and many of the tilt actuator, its gear in stages: error and time, and what it costs as it comes
stick_slip   the same drive with friction that really sticks: error and time of what leads from event to event, and their cost
scaling      time over steps, members and Maxwell elements
files        ever more members run to files: time, memory and files
overhead     what a call, storing, derivatives and sampling cost, and a process that imports the package or shows its help
loop_fit     a torsion loop fitted, beside SciPy with finite differences; and the convex fit
drive_fit    a whole drive fitted to a log, beside SciPy with finite differences around strainwave's simulation and solve_ivp
mujoco_fit   a drive with two inertias fitted, beside MuJoCo's own identification
marker_angle the angle of a target from pictures of its markers: error, bias, stated uncertainty, time of a picture
gpu          ensembles on a GPU, beside all cores of the processor
instructions a step of exported controllers on microcontrollers: instructions, code and stack
peak         operations a second, beside the most that the processor does

At the end stands what is to be reached and what of it was, by the tables there are (targets.json).

The peers come with `pip install strainwave[bench]`. Figures and tables of each part go to build/benchmarks/, as SVG and JSON.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Sequence

import actuator
import drive_fit
import ensemble
import files
import gpu
import instructions
import loop_fit
import marker_angle
import mujoco_fit
import overhead
import peak
import scaling
import single
import stick_slip
import targets
from rich.console import Console

NAMES = [peer.name for peer in single.PEERS] + [crowd.peer.name for crowd in ensemble.CROWDS]
PARTS: dict[str, Callable[[Console, Sequence[str], bool], None]] = {
    "single": single.run,
    "ensemble": ensemble.run,
    "actuator": actuator.run,
    "stick_slip": lambda console, peers, quick: stick_slip.run(console, quick),
    "scaling": lambda console, peers, quick: scaling.run(console),
    "files": lambda console, peers, quick: files.run(console),
    "gpu": lambda console, peers, quick: gpu.run(console),
    "overhead": lambda console, peers, quick: overhead.run(console),
    "loop_fit": lambda console, peers, quick: loop_fit.run(console),
    "drive_fit": lambda console, peers, quick: drive_fit.run(console),
    "mujoco_fit": lambda console, peers, quick: mujoco_fit.run(console),
    "marker_angle": lambda console, peers, quick: marker_angle.run(console, quick),
    "instructions": lambda console, peers, quick: instructions.run(console),
    "peak": lambda console, peers, quick: peak.run(console),
}


def words(text: str, known: Sequence[str], option: str) -> list[str]:
    """The comma-separated words; raises ValueError for one that no known name contains."""
    wanted = [word.strip().lower() for word in text.split(",")]
    for word in wanted:
        if not any(word in name.lower() for name in known):
            raise ValueError(f"{option}: none is named like '{word}' of {'; '.join(known)}")
    return wanted


def main() -> None:
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", default="", metavar="PARTS", help="comma-separated; default: all")
    parser.add_argument("--peers", default="", metavar="WORDS", help="comma-separated words of the names; default: all")
    parser.add_argument("--quick", action="store_true", help="one run each, 20 s at most")
    options = parser.parse_args()
    try:
        wanted = words(options.only, list(PARTS), "--only")
        peers = words(options.peers, NAMES, "--peers")
    except ValueError as error:
        parser.error(str(error))
    console = Console(width=None if sys.stdout.isatty() else 128)
    for part, measure in PARTS.items():
        if any(word in part for word in wanted):
            measure(console, peers, options.quick)
    targets.run(console)


if __name__ == "__main__":
    main()
