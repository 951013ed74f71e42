"""The reference drive with friction that really sticks: accuracy and time side by side, and what stepping to events costs.

Stribeck friction at the motor instead of LuGre, no gravity, and a weak controller that tracks a slow wave of small amplitude:
the motor stops and breaks away again and again. Errors are the largest over 5 s at 1 kHz, against a run of SciPy's DOP853 from
event to event to a relative tolerance of 1e-13, which knows nothing of strainwave. The ensembles compare the same drive with
three frictions, in packs on one thread: one that sticks, none that could (Runge-Kutta), and LuGre's (exponential Runge-Kutta).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, partial
from typing import Any

import numpy as np
import reference_drive as reference
import strainwave as sw
from measure import Effort, Failure, Result, measure_all, shortest
from peers import Peer, strainwave_drive
from reference_drive import Array, Tracking, numba_maths
from report import Column, figure, print_table, save, save_figure, three_digits
from rich.console import Console
from single import ratio, shown
from stretches import solver, sticking_stretches

STEP, MEMBERS, ALONE = 5e-4, 256, 8  # s, of the ensembles; how many members in packs, and one after the other
ROUNDS = 7
TRACKING = Tracking(proportional=1.0, derivative=0.005, slope=0.0, amplitude=0.005, frequency=1.0)
COMMAND = sw.scenario.sine(TRACKING.amplitude, TRACKING.frequency, reference.DURATION)  # rad
THOROUGH = Effort(limit=60.0, runs=20, enough=3.0)
QUICK = Effort(limit=20.0, runs=1, enough=0.0)

SETS = (
    Column("solver", words=True),
    Column("setting", words=True),
    *(Column(heading) for heading in ("angle error [rad]", "torque error [N.m]", "order", "wall [ms]", "ratio")),
)
COSTS = (
    Column("friction", words=True),
    *(Column(heading) for heading in ("pack [1/s]", "scalar [1/s]", "pack / scalar", "time / smooth, pack", "scalar")),
)


@dataclass(frozen=True)
class Cost:
    """Of an ensemble with one friction: trajectories a second on one thread."""

    friction: str
    pack: float
    scalar: float


def drives() -> dict[str, sw.Drive]:
    """The same with three frictions."""
    smooth = strainwave_drive.drive().replace(
        control=sw.control.PID(
            proportional=TRACKING.proportional, derivative=TRACKING.derivative, limit=reference.VOLTAGE_LIMIT
        ),
        load=sw.loads.Inertia(inertia=reference.OUTPUT_INERTIA),
    )
    frictions: dict[str, Any] = {
        "Stribeck, sticks": sw.friction.Stribeck(
            coulomb=reference.COULOMB,
            breakaway=reference.BREAKAWAY,
            stribeck_speed=reference.STRIBECK_SPEED,
            viscous=reference.VISCOUS_INPUT,
        ),
        "viscous, smooth": sw.friction.Viscous(viscous=reference.VISCOUS_INPUT),
        "LuGre": smooth.gear.friction_input,
    }
    return {name: smooth.replace(gear=smooth.gear.replace(friction_input=law)) for name, law in frictions.items()}


def simulated(drive: sw.Drive, step: float) -> sw.Recording:
    return sw.simulate(drive, COMMAND, dt=step, sample=reference.SAMPLE)


def sticking() -> tuple[sw.Drive, sw.scenario.Scenario]:
    return drives()["Stribeck, sticks"], COMMAND


@cache
def compiled(method: str) -> Callable[[float], Array]:
    maths = numba_maths(error_model="numpy")
    return solver(sticking_stretches(maths, TRACKING), maths, method)


def by_scipy(method: str, tolerance: float) -> Callable[[], Array]:
    """A run by a method of SciPy from event to event, to this relative tolerance."""
    return partial(compiled(method), tolerance)


PEERS = (
    *strainwave_drive.peers(
        sticking,
        {"exponential": (1e-3, 5e-4, 2e-4, 1e-4, 5e-5), "moreau_jean": (1e-3, 5e-4, 2e-4, 1e-4, 5e-5)},
        (1e-3, 1e-4, 1e-6, 1e-8),
    ),
    *(
        Peer(f"SciPy {method}, events", ("scipy", "numba"), "rtol", ladder, partial(by_scipy, method))
        for method, ladder in {"LSODA": (1e-4, 1e-6, 1e-8), "RK45": (1e-4, 1e-6, 1e-8), "DOP853": (1e-6, 1e-8, 1e-10)}.items()
    ),
)


def side_by_side(drive: sw.Drive) -> sw.Ensemble:
    inertias = reference.OUTPUT_INERTIA * np.linspace(0.8, 1.2, MEMBERS)
    return sw.simulate_many(drive, COMMAND, {"load.inertia": inertias}, STEP, sample=reference.SAMPLE, threads=1)


def one_by_one(drive: sw.Drive) -> list[sw.Recording]:
    inertias = reference.OUTPUT_INERTIA * np.linspace(0.8, 1.2, ALONE)
    return [simulated(drive.replace(load=sw.loads.Inertia(inertia=inertia)), STEP) for inertia in inertias.tolist()]


def costs(drives: Mapping[str, sw.Drive]) -> list[Cost]:
    runs: dict[str, Callable[[], object]] = {}
    for name, drive in drives.items():
        runs |= {f"{name}, pack": partial(side_by_side, drive), f"{name}, scalar": partial(one_by_one, drive)}
    times = shortest(runs, ROUNDS)
    return [Cost(name, MEMBERS / times[f"{name}, pack"], ALONE / times[f"{name}, scalar"]) for name in drives]


def run(console: Console, quick: bool) -> None:
    """Prints, and writes table and figure."""
    kinds = drives()
    with console.status("stick and slip: reference"):
        exact = by_scipy("DOP853", 1e-13)()
    outcomes = [outcome for _, outcome in measure_all(console, PEERS, QUICK if quick else THOROUGH, exact)]
    results = [outcome for outcome in outcomes if isinstance(outcome, Result)]
    with console.status("stick and slip: packs"):
        priced = costs(kinds)
    speed = simulated(kinds["Stribeck, sticks"], 1e-4)["input_speed"]
    stops = int(np.count_nonzero(np.diff(speed == 0.0)))
    caption = f"{stops} stops and breakaways at 1 kHz; ratio: time over that of strainwave's cheapest with errors no larger"
    print_table(console, "Stick and slip, 5 s", SETS, [result_row(each, results) for each in results], caption)
    for outcome in outcomes:
        if isinstance(outcome, Failure):
            console.print(f"{outcome.solver}, {outcome.setting}: {outcome.reason}", markup=False)
    caption = f"trajectories a second at {STEP:g} s on one thread; time / smooth: over that of viscous friction"
    print_table(console, "Stick and slip in packs", COSTS, [cost_row(each, priced) for each in priced], caption)
    save("stick_slip", outcomes, quick=quick, costs=[vars(cost) for cost in priced], stops_and_breakaways=stops)
    draw(results)


def steps_of(name: str, results: Sequence[Result]) -> tuple[list[float], list[float]]:
    """Steps [s] and angle errors of a solver that takes them, in the order of its ladder."""
    mine = [result for result in results if result.solver == name and result.setting.startswith("step")]
    return [float(result.setting.split()[1]) for result in mine], [result.output_angle_error for result in mine]


def order(result: Result, results: Sequence[Result]) -> float | None:
    """Of the angle's error, since the step before."""
    steps, errors = steps_of(result.solver, results)
    place = errors.index(result.output_angle_error) if steps else 0
    if place == 0 or errors[place] == 0.0:
        return None
    return math.log(errors[place - 1] / errors[place]) / math.log(steps[place - 1] / steps[place])


def result_row(each: Result, results: Sequence[Result]) -> list[str]:
    found = order(each, results)
    errors = [f"{each.output_angle_error:.1e}", f"{each.torque_error:.1e}"]
    times = [three_digits(1e3 * each.wall_time), shown(ratio(each, results, lambda other: other.wall_time))]
    return [each.solver, each.setting, *errors, "-" if found is None else f"{found:.1f}", *times]


def cost_row(each: Cost, priced: Sequence[Cost]) -> list[str]:
    smooth = next(cost for cost in priced if cost.friction == "viscous, smooth")
    rates = [each.pack, each.scalar, each.pack / each.scalar, smooth.pack / each.pack, smooth.scalar / each.scalar]
    return [each.friction, *map(three_digits, rates)]


def draw(results: Sequence[Result]) -> None:
    """The angle's error over the step of each method that takes steps, and over the time of all."""
    drawn = figure(width=9.0, height=4.5)
    over_step, over_time = drawn.subplots(1, 2)
    for name in dict.fromkeys(result.solver for result in results):
        mine = [result for result in results if result.solver == name]
        times = [result.wall_time for result in mine]
        over_time.loglog(times, [result.output_angle_error for result in mine], marker="o", markersize=4, label=name)
        steps, errors = steps_of(name, results)
        if steps:
            over_step.loglog(steps, errors, marker="o", markersize=4, label=name)
            theirs = 2 if "moreau" in name else 4
            over_step.loglog(steps, errors[0] * (np.array(steps) / steps[0]) ** theirs, "k:", linewidth=1.0)
    over_step.set(xlabel="step [s]", ylabel="largest error of the output angle [rad]", title="dotted: orders 4 and 2")
    over_time.set(xlabel="time of a run [s]", title="Stick and slip, 5 s")
    for axes in (over_step, over_time):
        axes.grid(alpha=0.3)
        axes.legend(fontsize=7)
    save_figure("stick_slip", drawn)
