"""Many reference drives at once, each with another inertia at the output: trajectories a second.

Each solver runs as many members as it takes to keep it busy, and is judged by the first, which is the reference drive itself.
Of strainwave every instruction set that the machine has is measured, and `simulate` in a loop. All keep output angle and
torque at 1 kHz. The ratio compares at equal error and on equally many threads: trajectories a second of strainwave's fastest
setting that is no less accurate, over those of the row. Beside them the same by the time of all cores together, which a busy
machine spoils less.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from measure import Effort, Failure, Result, measure_all
from peers import Crowd, casadi_cvodes, diffrax_tsit5, jax_exponential, numba_exponential, strainwave_drive
from reference import reference_solution
from reference_drive import DURATION
from report import Column, figure, print_table, save, save_figure, three_digits
from rich.console import Console
from single import shown

MODULES = (strainwave_drive, numba_exponential, jax_exponential, casadi_cvodes, diffrax_tsit5)
CROWDS: tuple[Crowd, ...] = tuple(crowd for module in MODULES for crowd in module.CROWDS)
BASELINE = "strainwave"

THOROUGH = Effort(limit=120.0, runs=20, enough=3.0)
QUICK = Effort(limit=20.0, runs=1, enough=0.0)

COLUMNS = (
    Column("solver", words=True),
    Column("setting", words=True),
    *(
        Column(heading)
        for heading in ("threads", "members", "angle error [rad]", "torque error [N.m]", "1/s", "ratio", "1/CPU s", "ratio")
    ),
)
CAPTION = (
    "1/s: trajectories a second, and of time of all cores; "
    "ratios: of strainwave's most with errors no larger, on as many threads, over these"
)
TITLE = f"Many reference drives, {DURATION:.0f} s each"


@dataclass(frozen=True)
class Rate:
    """A solver of many drives at one setting."""

    first: Result
    members: int
    threads: int

    @property
    def trajectories(self) -> float:
        """A second."""
        return self.members / self.first.wall_time

    @property
    def per_core(self) -> float:
        """Trajectories a second of time of all cores together."""
        return self.members / self.first.cpu_time


def run(console: Console, peers: Sequence[str], quick: bool) -> None:
    """Measures those solvers whose name contains one of the words; prints, and writes table and figure."""
    crowds = {crowd.peer: crowd for crowd in CROWDS if any(word in crowd.peer.name.lower() for word in peers)}
    rates = []
    for peer, outcome in measure_all(console, list(crowds), QUICK if quick else THOROUGH, reference_solution()[:, [2, 4]]):
        if isinstance(outcome, Failure):
            console.print(f"{outcome.solver}, {outcome.setting}: {outcome.reason}", markup=False)
        else:
            rates.append(Rate(outcome, crowds[peer].members, crowds[peer].threads))
    print_table(console, TITLE, COLUMNS, [row(rate, rates) for rate in rates], CAPTION)
    save("ensemble", rates, quick=quick)
    draw(rates)


def ratio(rate: Rate, rates: Sequence[Rate], speed: Callable[[Rate], float]) -> float | None:
    """Speed of the baseline's fastest over this, at equal error and threads, where it reaches that."""
    equal = [
        speed(other)
        for other in rates
        if other.first.solver.startswith(BASELINE)
        and other.threads == rate.threads
        and other.first.no_less_accurate_than(rate.first)
    ]
    return max(equal) / speed(rate) if equal else None


def row(rate: Rate, rates: Sequence[Rate]) -> list[str]:
    return [
        rate.first.solver,
        rate.first.setting,
        str(rate.threads),
        str(rate.members),
        f"{rate.first.output_angle_error:.1e}",
        f"{rate.first.torque_error:.1e}",
        three_digits(rate.trajectories),
        shown(ratio(rate, rates, lambda each: each.trajectories)),
        three_digits(rate.per_core),
        shown(ratio(rate, rates, lambda each: each.per_core)),
    ]


def draw(rates: Sequence[Rate]) -> None:
    """A bar for each row of the table."""
    drawn = figure(height=1.0 + 0.25 * len(rates))
    axes = drawn.add_subplot()
    labels = [f"{rate.first.solver}, {rate.first.setting}, {rate.threads} thread{'s' * (rate.threads > 1)}" for rate in rates]
    bars = axes.barh(range(len(rates)), [rate.trajectories for rate in rates])
    axes.bar_label(bars, [three_digits(rate.trajectories) for rate in rates], fontsize=7, padding=2)
    axes.set_yticks(range(len(rates)), labels, fontsize=7)
    axes.invert_yaxis()
    axes.set(xscale="log", xlabel="trajectories a second", title=TITLE)
    axes.margins(x=0.1)
    save_figure("ensemble", drawn)
