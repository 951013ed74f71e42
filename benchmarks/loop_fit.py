"""A torsion loop fitted: four numbers of a gear to 4000 samples, beside SciPy with finite differences; and the convex fit.

All start from the same numbers and fit the same six unknowns: cubic spring, one Maxwell element, and the zeros of both axes.
SciPy's `least_squares` takes its own finite differences around the same loop, in a plain Python recurrence, or compiled by
Numba. The convex fit needs no start: fourteen Maxwell elements beside a spring of three segments, 10 000 samples.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import strainwave as sw
from measure import shortest
from numpy.typing import NDArray
from report import Column, installed, print_table, save, three_digits
from rich.console import Console
from strainwave.identification.candidates.torsion.candidate import starts
from strainwave.identification.candidates.torsion.dissipation import Elements
from strainwave.identification.candidates.torsion.springs import THREE_SEGMENT
from strainwave.identification.experiments.torsion_loop import TorsionLoop

Array = NDArray[np.float64]
Model = Callable[[Array, float, float, float, float], Array]  # torque of a path by a1, a3, k and F

SAMPLES, CONVEX_SAMPLES = 4000, 10_000
HALF, NOISE = 1.5e-3, 0.2  # rad, N.m
TRUTH = np.array([1.5e4, 6e9, 1.2e4, 2.0])
START = np.array([2.5e4, 1e9, 4e3, 0.8])
FREE = ("stiffness.a1", "stiffness.a3", "hysteresis.stiffness[0]", "hysteresis.breakaway[0]")
ROUNDS = 5
COLUMNS = (
    Column("loop fit", words=True),
    Column("samples"),
    Column("runs of the model"),
    Column("off the truth [σ]"),
    Column("time [ms]"),
    Column("ratio"),
)


@dataclass(frozen=True)
class LoopFit:
    """A fit: samples, runs of the model, largest distance from the truth in standard deviations of strainwave's, time [s]."""

    name: str
    samples: int
    runs: int | None
    off: float | None
    wall_time: float


def gear(numbers: Array) -> sw.Gear:
    a1, a3, k, breakaway = numbers.tolist()
    elements = sw.hysteresis.MaxwellSlip(stiffness=[k], breakaway=[breakaway])
    return sw.Gear(stiffness=sw.stiffness.Cubic(a1=a1, a3=a3), hysteresis=elements)


def measured(n: int) -> TorsionLoop:
    twist = HALF * np.sin(np.linspace(0.0, 4.0 * np.pi, n))
    torque = gear(TRUTH).trace(np.concatenate((twist, twist)))[-n:]
    return TorsionLoop(twist, torque + NOISE * np.random.default_rng(5).normal(size=n))


def plain(path: Array, a1: float, a3: float, k: float, breakaway: float) -> Array:
    torque = np.empty(len(path))
    held = last = 0.0
    for i in range(len(path)):
        held = min(max(held + k * (path[i] - last), -breakaway), breakaway)
        last = path[i]
        torque[i] = a1 * last + a3 * last**3 + held
    return torque


def by_scipy(loop: TorsionLoop, model: Model) -> tuple[Array, int]:
    """Numbers of the gear, and runs of the model."""
    from scipy.optimize import least_squares

    runs = 0
    n = len(loop.twist)

    def residuals(x: Array) -> Array:
        nonlocal runs
        runs += 1
        path = loop.twist - x[5]
        return np.asarray(model(np.concatenate((path, path)), *x[:4])[-n:] + x[4] - loop.torque)

    low = np.array([0.0, 0.0, 1e-9, 0.0, -np.inf, -np.inf])
    found = least_squares(
        residuals,
        np.concatenate((START, [0.0, 0.0])),
        bounds=(low, np.inf),
        x_scale=np.concatenate((START, [1.0, 1e-4])),
        xtol=1e-10,
        ftol=1e-10,
        gtol=1e-10,
    )
    return np.asarray(found.x[:4]), runs


def run(console: Console) -> None:
    """Prints, and writes the table."""
    loop, long = measured(SAMPLES), measured(CONVEX_SAMPLES)
    own = sw.fit(gear(START), loop, FREE)
    sigma = np.array([estimate.sigma for estimate in own.estimates[:4]])

    def off(numbers: Array) -> float:
        return float(np.max(np.abs(numbers - TRUTH) / sigma))

    models: dict[str, Model] = {"SciPy least_squares, Python": plain}
    if installed("numba"):
        from numba import njit

        models["SciPy least_squares, Numba"] = njit(plain)
        models["SciPy least_squares, Numba"](np.zeros(2), 1.0, 1.0, 1.0, 1.0)  # compiled now
    else:
        console.print("Numba: not installed: pip install numba")
    every = np.ones(len(long.twist), bool)
    quick: dict[str, Callable[[], object]] = {
        "strainwave": lambda: sw.fit(gear(START), loop, FREE),
        "strainwave, convex": lambda: starts(long, sw.Gear(), every, THREE_SEGMENT, Elements()),
    }
    if "SciPy least_squares, Numba" in models:
        quick["SciPy least_squares, Numba"] = lambda: by_scipy(loop, models["SciPy least_squares, Numba"])
    times = shortest(quick, ROUNDS)
    begun = time.perf_counter()
    by_scipy(loop, plain)
    times["SciPy least_squares, Python"] = time.perf_counter() - begun  # once: it takes long
    fitted = np.array([estimate.value for estimate in own.estimates[:4]])
    rows = [LoopFit("strainwave", SAMPLES, own.evaluations, off(fitted), times["strainwave"])]
    for name, model in models.items():
        numbers, runs = by_scipy(loop, model)
        rows.append(LoopFit(name, SAMPLES, runs, off(numbers), times[name]))
    rows.append(LoopFit("strainwave, convex", CONVEX_SAMPLES, None, None, times["strainwave, convex"]))
    cells = [
        (
            row.name,
            str(row.samples),
            "–" if row.runs is None else str(row.runs),
            "–" if row.off is None else f"{row.off:.2f}",
            three_digits(1e3 * row.wall_time),
            three_digits(row.wall_time / rows[0].wall_time) if row.samples == SAMPLES else "–",
        )
        for row in rows
    ]
    print_table(console, "Torsion loops fitted", COLUMNS, cells)
    save("loop_fit", rows)


if __name__ == "__main__":
    run(Console())
