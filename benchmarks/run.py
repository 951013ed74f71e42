"""Accuracy and time of everything installed on the reference drive, side by side.

    python benchmarks/run.py                          all solvers, shortest time of several runs
    python benchmarks/run.py --peers casadi,numba     those whose name contains one of the words
    python benchmarks/run.py --quick                  one run each, 20 s at most

Each solver goes through a ladder of settings. Errors are the largest over 5 s at 1 kHz; compiling is timed apart. The
ratio compares at equal error: time over that of strainwave's cheapest setting that is no less accurate. The peers come with
`pip install strainwave[bench]`. The figures of all settings go to build/benchmarks/table.json.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
from collections.abc import Sequence
from dataclasses import asdict
from importlib import metadata

from measure import WANTED_OUTPUT_ANGLE, WANTED_TORQUE, Effort, Failure, Result, measure
from peers import Peer, casadi_cvodes, cvode, diffrax_tsit5, numba_exponential, numba_rk4, scipy_lsoda, strainwave_drive
from reference import FOLDER, reference_solution
from reference_drive import DURATION
from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.markup import escape
from rich.table import Table

MODULES = (strainwave_drive, numba_exponential, numba_rk4, casadi_cvodes, cvode, diffrax_tsit5, scipy_lsoda)
PEERS: tuple[Peer, ...] = tuple(peer for module in MODULES for peer in module.PEERS)
BASELINE = "strainwave"

THOROUGH = Effort(limit=120.0, runs=20, enough=5.0)
QUICK = Effort(limit=20.0, runs=1, enough=0.0)


def select(words: str) -> list[Peer]:
    """Solvers whose name contains one of the comma-separated words; raises ValueError for a word that none contains."""
    wanted = [word.strip().lower() for word in words.split(",")]
    for word in wanted:
        if not any(word in peer.name.lower() for peer in PEERS):
            raise ValueError(f"--peers: none is named like '{word}' of {'; '.join(peer.name for peer in PEERS)}")
    return [peer for peer in PEERS if any(word in peer.name.lower() for word in wanted)]


def installed(distribution: str) -> bool:
    """Whether pip knows it here."""
    try:
        metadata.version(distribution)
    except metadata.PackageNotFoundError:
        return False
    return True


def three_digits(value: float) -> str:
    """At least three significant digits, without exponent."""
    return f"{value:.3g}" if value < 1000.0 else f"{value:.0f}"


def ratio(result: Result, results: Sequence[Result]) -> str:
    """Time over that of the baseline at equal error."""
    equal = [
        other
        for other in results
        if other.solver == BASELINE
        and other.output_angle_error <= result.output_angle_error
        and other.torque_error <= result.torque_error
    ]
    return three_digits(result.wall_time / min(other.wall_time for other in equal)) if equal else "-"


def table(results: Sequence[Result]) -> Table:
    """Every setting of each solver, with its time over the baseline's at equal error."""
    caption = (
        "ratio: time over that of strainwave's cheapest setting with errors no larger; "
        f"* misses {WANTED_OUTPUT_ANGLE} rad or {WANTED_TORQUE} N.m"
    )
    title = f"Reference drive, {DURATION:.0f} s"
    view = Table(title=title, caption=caption, box=SIMPLE_HEAD, padding=(0, 1, 0, 0), show_edge=False)
    for heading in ("solver", "setting"):
        view.add_column(heading, no_wrap=True)
    for heading in ("angle error [rad]", "torque error [N.m]", "wall [ms]", "ratio", "build [s]"):
        view.add_column(escape(heading), justify="right")
    for result in results:
        view.add_row(
            result.solver + ("" if result.accurate else " *"),
            result.setting,
            f"{result.output_angle_error:.1e}",
            f"{result.torque_error:.1e}",
            three_digits(1e3 * result.wall_time),
            ratio(result, results),
            f"{result.compile_time:.1f}",
        )
    return view


def save(outcomes: Sequence[Result | Failure]) -> None:
    """Writes every setting tried, with the versions of what was measured, to table.json."""
    versions = {name: metadata.version(name) for peer in PEERS for name in peer.distributions if installed(name)}
    content = {
        "machine": {"architecture": platform.machine(), "cores": os.cpu_count()},
        "versions": {"python": platform.python_version(), **dict(sorted(versions.items()))},
        "wanted": {"output_angle_error": WANTED_OUTPUT_ANGLE, "torque_error": WANTED_TORQUE},
        "results": [asdict(outcome) for outcome in outcomes],
    }
    partial = FOLDER / "table.json.partial"
    partial.write_text(json.dumps(content, indent=1, allow_nan=False))
    os.replace(partial, FOLDER / "table.json")


def main() -> None:
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--peers", default="", metavar="WORDS", help="comma-separated words of the names; default: all")
    parser.add_argument("--quick", action="store_true", help="one run each, 20 s at most")
    options = parser.parse_args()
    try:
        peers = select(options.peers)
        reference = reference_solution()[:, [2, 4]]
    except ValueError as error:
        parser.error(str(error))
    except ModuleNotFoundError as error:
        parser.error(f"the reference solution needs {error.name}: pip install strainwave[bench]")

    console = Console()
    outcomes: list[Result | Failure] = []
    for peer in peers:
        if missing := [name for name in peer.distributions if not installed(name)]:
            console.print(f"{peer.name}: not installed: pip install {' '.join(missing)}")
            continue
        with console.status(peer.name):
            outcomes += measure(peer, QUICK if options.quick else THOROUGH, reference)
    console.print(table([outcome for outcome in outcomes if isinstance(outcome, Result)]))
    for outcome in outcomes:
        if isinstance(outcome, Failure):
            console.print(f"{outcome.solver}, {outcome.setting}: {outcome.reason}", markup=False)
    save(outcomes)


if __name__ == "__main__":
    main()
