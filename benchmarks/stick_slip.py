"""The reference drive with friction that really sticks: error over step, and what stepping to events costs.

Stribeck friction at the motor instead of LuGre, no gravity, and a weak controller that tracks a slow wave of small amplitude:
the motor stops and breaks away again and again. Errors are the largest over 5 s at 1 kHz, against the same method at a
hundredth of the finest step. The ensembles compare the same drive with three frictions, in packs on one thread: one that
sticks, none that could (Runge-Kutta), and LuGre's (exponential Runge-Kutta).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
import reference_drive as reference
import strainwave as sw
from measure import shortest
from peers import strainwave_drive
from report import Column, figure, save, save_figure, table, three_digits
from rich.console import Console

STEPS = (1e-3, 5e-4, 2e-4, 1e-4, 5e-5)  # s
REFERENCE_STEP = 5e-7  # s
STEP, MEMBERS, ALONE = 5e-4, 256, 8  # s, of the ensembles; how many members in packs, and one after the other
ROUNDS = 7
COMMAND = sw.scenario.sine(0.005, 1.0, reference.DURATION)  # rad

SETS = (Column("step [s]"), Column("angle error [rad]"), Column("torque error [N.m]"), Column("order"), Column("wall [ms]"))
COSTS = (
    Column("friction", words=True),
    *(Column(heading) for heading in ("pack [1/s]", "scalar [1/s]", "pack / scalar", "time / smooth, pack", "scalar")),
)


@dataclass(frozen=True)
class Accuracy:
    """Of a run at one step [s]: largest errors, order of the angle's since the step before, time [s]."""

    step: float
    output_angle_error: float
    torque_error: float
    order: float | None
    wall_time: float


@dataclass(frozen=True)
class Cost:
    """Of an ensemble with one friction: trajectories a second on one thread."""

    friction: str
    pack: float
    scalar: float


def drives() -> dict[str, sw.drives.PositionDrive]:
    """The same with three frictions."""
    smooth = strainwave_drive.drive().replace(
        control=sw.control.PID(proportional=1.0, derivative=0.005, limit=reference.VOLTAGE_LIMIT),
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


def simulated(drive: sw.drives.PositionDrive, step: float) -> sw.Recording:
    return sw.simulate(drive, COMMAND, dt=step, sample=reference.SAMPLE)


def accuracies(drive: sw.drives.PositionDrive, exact: sw.Recording) -> list[Accuracy]:
    times = shortest({f"{step:g}": partial(simulated, drive, step) for step in STEPS}, ROUNDS)
    found: list[Accuracy] = []
    for step in STEPS:
        run = simulated(drive, step)
        angle, torque = (float(np.abs(run[name] - exact[name]).max()) for name in ("output_angle", "torque"))
        order = None
        if found and angle > 0.0:
            order = math.log(found[-1].output_angle_error / angle) / math.log(found[-1].step / step)
        found.append(Accuracy(step, angle, torque, order, times[f"{step:g}"]))
    return found


def side_by_side(drive: sw.drives.PositionDrive) -> sw.Ensemble:
    inertias = reference.OUTPUT_INERTIA * np.linspace(0.8, 1.2, MEMBERS)
    return sw.simulate_many(drive, COMMAND, {"load.inertia": inertias}, STEP, sample=reference.SAMPLE, threads=1)


def one_by_one(drive: sw.drives.PositionDrive) -> list[sw.Recording]:
    inertias = reference.OUTPUT_INERTIA * np.linspace(0.8, 1.2, ALONE)
    return [simulated(drive.replace(load=sw.loads.Inertia(inertia=inertia)), STEP) for inertia in inertias.tolist()]


def costs(drives: Mapping[str, sw.drives.PositionDrive]) -> list[Cost]:
    runs: dict[str, Callable[[], object]] = {}
    for name, drive in drives.items():
        runs |= {f"{name}, pack": partial(side_by_side, drive), f"{name}, scalar": partial(one_by_one, drive)}
    times = shortest(runs, ROUNDS)
    return [Cost(name, MEMBERS / times[f"{name}, pack"], ALONE / times[f"{name}, scalar"]) for name in drives]


def run(console: Console) -> None:
    """Prints, and writes table and figure."""
    kinds = drives()
    sticking = kinds["Stribeck, sticks"]
    with console.status("stick and slip"):
        exact = sw.simulate(sticking, COMMAND, dt=REFERENCE_STEP, sample=reference.SAMPLE)
        found, priced = accuracies(sticking, exact), costs(kinds)
    stops = int(np.count_nonzero(np.diff(exact["input_speed"] == 0.0)))
    told = f"{stops} stops and breakaways seen at 1 kHz; reference: the same method at {REFERENCE_STEP:g} s"
    console.print(table("Stick and slip, 5 s", SETS, [accuracy_row(each) for each in found], told))
    caption = f"trajectories a second at {STEP:g} s on one thread; time / smooth: over that of viscous friction"
    console.print(table("Stick and slip in packs", COSTS, [cost_row(each, priced) for each in priced], caption))
    save("stick_slip", found, costs=[vars(cost) for cost in priced], stops_and_breakaways=stops)
    draw(found)


def accuracy_row(each: Accuracy) -> list[str]:
    order = "-" if each.order is None else f"{each.order:.1f}"
    errors = [f"{each.output_angle_error:.1e}", f"{each.torque_error:.1e}"]
    return [f"{each.step:g}", *errors, order, three_digits(1e3 * each.wall_time)]


def cost_row(each: Cost, priced: Sequence[Cost]) -> list[str]:
    smooth = next(cost for cost in priced if cost.friction == "viscous, smooth")
    rates = [each.pack, each.scalar, each.pack / each.scalar, smooth.pack / each.pack, smooth.scalar / each.scalar]
    return [each.friction, *map(three_digits, rates)]


def draw(found: Sequence[Accuracy]) -> None:
    """Both errors over the step."""
    drawn = figure()
    axes = drawn.add_subplot()
    steps = np.array([each.step for each in found])
    angles = np.array([each.output_angle_error for each in found])
    axes.loglog(steps, angles, marker="o", label="output angle [rad]")
    axes.loglog(steps, [each.torque_error for each in found], marker="o", label="torque [N.m]")
    axes.loglog(steps, angles[0] * (steps / steps[0]) ** 4, "k:", linewidth=1.0, label="order 4")
    axes.set(xlabel="step [s]", ylabel="largest error", title="Stick and slip: event-driven Runge-Kutta, 5 s")
    axes.grid(alpha=0.3)
    axes.legend()
    save_figure("stick_slip", drawn)
