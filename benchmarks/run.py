"""Accuracy and time of everything installed on the reference drive, side by side.

    python benchmarks/run.py                          all solvers, minimum of several runs
    python benchmarks/run.py --peers casadi,numba     those whose name contains one of the words
    python benchmarks/run.py --quick                  one run each, 20 s at most

Each solver runs alone, in a process of its own, through a ladder of settings. The table shows the cheapest setting that
reaches the wanted accuracy, and the tightest. Errors are the largest over 5 s at 1 kHz; compiling is timed apart.
The peers come with `pip install strainwave[bench]`. All figures go to build/benchmarks/table.json.
"""

from __future__ import annotations

import argparse
import json
import math
import multiprocessing
import os
import platform
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass
from importlib import metadata
from multiprocessing.connection import Connection

import numpy as np
from peers import Peer, casadi_cvodes, cvode, diffrax_tsit5, numba_exponential, numba_rk4, scipy_lsoda, strainwave_drive
from reference import FOLDER, reference_solution
from reference_drive import Array
from rich.console import Console
from rich.table import Table

MODULES = (strainwave_drive, numba_exponential, numba_rk4, casadi_cvodes, cvode, diffrax_tsit5, scipy_lsoda)
PEERS: tuple[Peer, ...] = tuple(peer for module in MODULES for peer in module.PEERS)
BASELINE = "strainwave"

WANTED_OUTPUT_ANGLE = 3e-6  # rad
WANTED_TORQUE = 5e-2  # N.m


@dataclass(frozen=True)
class Effort:
    """How long a run may take [s], and how often it is repeated: `runs` times, or until `enough` seconds are spent."""

    limit: float
    runs: int
    enough: float


THOROUGH = Effort(limit=120.0, runs=20, enough=5.0)
QUICK = Effort(limit=20.0, runs=1, enough=0.0)


@dataclass(frozen=True)
class Result:
    """One solver at one setting. Where it failed, `remark` says how, and the figures are infinite."""

    solver: str
    setting: str
    value: float
    output_angle_error: float = math.inf  # rad
    torque_error: float = math.inf  # N.m
    wall_time: float = math.inf  # s
    compile_time: float = math.inf  # s
    remark: str = ""

    @property
    def accurate(self) -> bool:
        """Reaches the wanted accuracy."""
        return self.output_angle_error <= WANTED_OUTPUT_ANGLE and self.torque_error <= WANTED_TORQUE


def missing(peer: Peer) -> list[str]:
    """Distributions that the solver needs and that are not installed."""
    return [name for name in peer.distributions if not _installed(name)]


def _installed(distribution: str) -> bool:
    try:
        metadata.version(distribution)
    except metadata.PackageNotFoundError:
        return False
    return True


def best_of(solve: Callable[[], Array], effort: Effort) -> tuple[float, Array]:
    """Shortest time of several runs [s], and the samples of the last."""
    times: list[float] = []
    while len(times) < effort.runs and sum(times) <= effort.enough:
        start = time.perf_counter()
        samples = solve()
        times.append(time.perf_counter() - start)
    return min(times), samples


def serve(peer: Peer, effort: Effort, pipe: Connection) -> None:
    """Runs the ladder in the solver's own process; sends the compile time, then time and samples, or what failed."""
    for value in peer.ladder:
        try:
            start = time.perf_counter()
            solve = peer.prepare(value)
            pipe.send(time.perf_counter() - start)
            pipe.send(best_of(solve, effort))
        except Exception as error:  # a failing solver is a result, whatever it raises
            pipe.send(f"{type(error).__name__}: {error}")


def measure(peer: Peer, effort: Effort, reference: Array) -> Iterator[Result]:
    """A result for each setting, up to the first that exceeds the time limit."""
    context = multiprocessing.get_context("spawn")
    pipe, other_end = context.Pipe()
    process = context.Process(target=serve, args=(peer, effort, other_end), daemon=True)
    process.start()
    other_end.close()
    try:
        for value in peer.ladder:
            result = receive(peer, value, pipe, effort, reference)
            yield result
            if result.remark.startswith("more than"):
                return
    finally:
        process.kill()  # also a solver that is deep in compiled code and hears nothing
        process.join()


def receive(peer: Peer, value: float, pipe: Connection, effort: Effort, reference: Array) -> Result:
    """The result that the solver's process sends for one setting."""
    message: object = 0.0
    compiling = math.inf
    for _ in ("compiled", "solved"):
        if not pipe.poll(effort.limit + effort.enough):
            return Result(peer.name, peer.setting, value, remark=f"more than {effort.limit:.0f} s")
        try:
            message = pipe.recv()
        except EOFError:
            return Result(peer.name, peer.setting, value, remark="its process died")
        if isinstance(message, str):
            return Result(peer.name, peer.setting, value, remark=message)
        if isinstance(message, float):
            compiling = message
    assert isinstance(message, tuple)
    wall, samples = message
    errors = np.abs(samples - reference).max(axis=0)
    return Result(peer.name, peer.setting, value, float(errors[0]), float(errors[1]), wall, compiling)


def chosen(results: Sequence[Result]) -> list[Result]:
    """What the table shows of a ladder: the cheapest accurate setting and the tightest that gave a solution."""
    solved = [result for result in results if not result.remark]
    if not solved:
        return list(results[-1:])
    accurate = [result for result in solved if result.accurate]
    cheapest = min(accurate, key=lambda result: result.wall_time, default=solved[-1])
    return [cheapest] if cheapest is solved[-1] else [cheapest, solved[-1]]


def table(results: dict[str, list[Result]]) -> Table:
    """The table of all solvers; times also as multiples of the baseline's, each at its cheapest accurate setting."""
    baseline = next((r.wall_time for r in chosen(results.get(BASELINE, [])) if r.accurate), math.nan)
    title = "Reference drive, 5 s: largest error of output angle and torque, time, and time over strainwave's"
    view = Table(title=title, caption="* misses the wanted accuracy")
    view.add_column("solver", no_wrap=True)
    for heading in ("setting", "angle [rad]", "torque [N.m]", "wall [ms]", "ratio", "compile [s]"):
        view.add_column(heading, justify="right", no_wrap=heading == "setting")
    for result in (result for ladder in results.values() for result in chosen(ladder)):
        setting = f"{result.setting} {result.value:.3g}"
        if result.remark:
            view.add_row(result.solver, setting, result.remark)
            continue
        ratio = result.wall_time / baseline
        view.add_row(
            result.solver + ("" if result.accurate else " *"),
            setting,
            f"{result.output_angle_error:.1e}",
            f"{result.torque_error:.1e}",
            f"{1e3 * result.wall_time:.1f}",
            "-" if math.isnan(ratio) else f"{ratio:.3g}",
            f"{result.compile_time:.1f}",
        )
    return view


def save(results: dict[str, list[Result]]) -> None:
    """Writes every setting tried, with the versions of what was measured, to table.json."""
    needed = {name for peer in PEERS for name in peer.distributions if _installed(name)}
    content = {
        "machine": {"processor": platform.processor() or platform.machine(), "cores": os.cpu_count()},
        "python": platform.python_version(),
        "versions": {name: metadata.version(name) for name in sorted(needed)},
        "wanted": {"output_angle": WANTED_OUTPUT_ANGLE, "torque": WANTED_TORQUE},
        "results": [asdict(result) for ladder in results.values() for result in ladder],
    }
    partial = FOLDER / "table.json.partial"
    partial.write_text(json.dumps(content, indent=1))
    os.replace(partial, FOLDER / "table.json")


def select(words: str) -> list[Peer]:
    """Solvers whose name contains one of the comma-separated words; raises ValueError for a word that none contains."""
    wanted = [word.strip().lower() for word in words.split(",")]
    for word in wanted:
        if not any(word in peer.name.lower() for peer in PEERS):
            raise ValueError(f"--peers: no solver is named like '{word}'; there are {', '.join(p.name for p in PEERS)}")
    return [peer for peer in PEERS if any(word in peer.name.lower() for word in wanted)]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--peers", default="", metavar="WORDS", help="comma-separated words of the names; default: all")
    parser.add_argument("--quick", action="store_true", help="one run each, 20 s at most")
    options = parser.parse_args()
    try:
        peers = select(options.peers)
    except ValueError as error:
        parser.error(str(error))

    console = Console()
    reference = reference_solution()[:, [2, 4]]
    results: dict[str, list[Result]] = {}
    for peer in peers:
        if absent := missing(peer):
            console.print(f"{peer.name}: not installed: pip install {' '.join(absent)}")
            continue
        with console.status(peer.name):
            results[peer.name] = list(measure(peer, QUICK if options.quick else THOROUGH, reference))
    console.print(table(results))
    save(results)


if __name__ == "__main__":
    main()
