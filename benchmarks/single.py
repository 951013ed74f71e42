"""One trajectory of the reference drive: accuracy and time of everything installed, side by side.

Each solver goes through a ladder of settings. Errors are the largest over 5 s at 1 kHz; compiling is timed apart. The
ratio compares at equal error: time over that of strainwave's cheapest setting, by whichever method, that is no less accurate.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import numpy as np
from measure import WANTED_OUTPUT_ANGLE, WANTED_TORQUE, Effort, Failure, Result, measure_all
from peers import (
    Peer,
    casadi_cvodes,
    cvode,
    diffrax_tsit5,
    jax_exponential,
    numba_exponential,
    numba_rk4,
    scipy_expert,
    scipy_lsoda,
    strainwave_drive,
)
from reference import reference_solution
from reference_drive import DURATION
from report import Column, figure, print_table, save, save_figure, three_digits
from rich.console import Console

if TYPE_CHECKING:
    from matplotlib.figure import Figure

MODULES = (
    strainwave_drive,
    numba_exponential,
    jax_exponential,
    numba_rk4,
    casadi_cvodes,
    cvode,
    diffrax_tsit5,
    scipy_expert,
    scipy_lsoda,
)
PEERS: tuple[Peer, ...] = tuple(peer for module in MODULES for peer in module.PEERS)
BASELINE = "strainwave"

THOROUGH = Effort(limit=120.0, runs=20, enough=5.0)
QUICK = Effort(limit=20.0, runs=1, enough=0.0)

COLUMNS = (
    Column("solver", words=True),
    Column("setting", words=True),
    *(
        Column(heading)
        for heading in ("angle error [rad]", "torque error [N.m]", "wall [ms]", "ratio", "CPU ratio", "build [s]")
    ),
)
CAPTION = (
    "ratio: time, and that of all cores, over that of strainwave's cheapest setting with errors no larger; "
    f"* misses {WANTED_OUTPUT_ANGLE} rad or {WANTED_TORQUE} N.m"
)


def run(console: Console, peers: Sequence[str], quick: bool) -> None:
    """Measures those peers whose name contains one of the words; prints, and writes table and figure."""
    chosen = [peer for peer in PEERS if any(word in peer.name.lower() for word in peers)]
    effort = QUICK if quick else THOROUGH
    reference = reference_solution()[:, [2, 4]]
    outcomes = [outcome for _, outcome in measure_all(console, chosen, effort, reference)]
    results = [outcome for outcome in outcomes if isinstance(outcome, Result)]
    print_table(console, f"Reference drive, {DURATION:.0f} s", COLUMNS, [row(result, results) for result in results], CAPTION)
    for outcome in outcomes:
        if isinstance(outcome, Failure):
            console.print(f"{outcome.solver}, {outcome.setting}: {outcome.reason}", markup=False)
    wanted = {"output_angle_error": WANTED_OUTPUT_ANGLE, "torque_error": WANTED_TORQUE}
    save("single", outcomes, quick=quick, wanted=wanted, peak_torque=float(np.abs(reference[:, 1]).max()))
    save_figure("single", drawn(results))


def ratio(result: Result, results: Sequence[Result], time: Callable[[Result], float]) -> float | None:
    """Time over that of the baseline at equal error, where that reaches it."""
    equal = [other for other in results if other.solver.startswith(BASELINE) and other.no_less_accurate_than(result)]
    return time(result) / min(map(time, equal)) if equal else None


def shown(value: float | None) -> str:
    return "-" if value is None else three_digits(value)


def row(result: Result, results: Sequence[Result]) -> list[str]:
    return [
        result.solver + ("" if result.accurate else " *"),
        result.setting,
        f"{result.output_angle_error:.1e}",
        f"{result.torque_error:.1e}",
        three_digits(1e3 * result.wall_time),
        shown(ratio(result, results, lambda each: each.wall_time)),
        shown(ratio(result, results, lambda each: each.cpu_time)),
        f"{result.compile_time:.1f}",
    ]


def drawn(results: Sequence[Result]) -> Figure:
    """Time over error, a line a solver; strainwave's own methods thick."""
    picture = figure(width=8.0, height=5.6)
    axes = picture.add_subplot()
    solvers = list(dict.fromkeys(result.solver for result in results))
    own = sum(solver.startswith(BASELINE) for solver in solvers)
    for number, solver in enumerate(solvers):
        mine = [result for result in results if result.solver == solver]
        errors, times = [result.torque_error for result in mine], [result.wall_time for result in mine]
        ours = number < own
        style = "-" if ours else ("--", "-.", ":")[(number - own) % 3]
        colour = f"C{number}" if ours else f"C{4 + (number - own) % 6}"
        width, marker = (2.5, "o") if ours else (1.0, "osD^v"[(number - own) % 5])
        axes.loglog(errors, times, style, marker=marker, markersize=4, color=colour, linewidth=width, label=solver)
    axes.axvline(WANTED_TORQUE, color="0.6", linewidth=0.8, label=f"wanted: at most {WANTED_TORQUE:g} N.m")
    axes.set(title=f"Reference drive, {DURATION:.0f} s", xlabel="largest error of the torque [N.m]", ylabel="time of a run [s]")
    axes.grid(alpha=0.3)
    picture.legend(loc="outside right upper", fontsize=7, frameon=False)
    return picture
