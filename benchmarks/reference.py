"""The reference solution of the reference drive: what the errors of all solvers are measured against.

The classical Runge-Kutta method with the return map, at 0.5 us. Halving the step changes the output angle by at most
6e-13 rad and the torque by 5e-9 N.m; the most accurate peer errs a hundred times more. The solution is computed once
and kept in build/benchmarks/, under a name that changes with the drive and the method.

    python benchmarks/reference.py    computes it and compares it with the lines below
"""

from __future__ import annotations

import hashlib
import os
from pathlib import Path

import fixed_step
import numpy as np
import reference_drive
from fixed_step import runge_kutta, simulation
from reference_drive import DURATION, SAMPLE, Array, numba_maths

STEPS_PER_SAMPLE = 2000  # 0.5 us
FOLDER = Path(__file__).parent.parent / "build" / "benchmarks"

COLUMNS = ("input angle [rad]", "input speed [rad/s]", "output angle [rad]", "output speed [rad/s]", "torque [N.m]")

# Time [s]: the columns, by an independent C++ program, the same method at 25 ns.
KNOWN = {
    0.01: (0.6141273030231038, 85.54005991885637, 0.002497814213612874, 0.8855815019873978, 103.71346401041895),
    0.1: (14.392587761524922, 143.65033435759096, 0.1444046414000202, 1.4304542780659235, -9.508663912887966),
    1.0: (21.095375263666458, 205.2593723418557, 0.2102066314860274, 2.0259423270991017, 7.54384223777401),
    5.0: (140.7869469886738, 205.59575000746915, 1.4063923224425494, 2.0287055041106963, 20.62009884513958),
}
ALLOWED = (1e-10, 1e-8, 1e-12, 1e-10, 1e-7)  # largest difference from KNOWN, column by column


def reference_solution() -> Array:
    """The five columns at the sample times, shape (5001, 5).

    Raises ArithmeticError where it differs from the known lines.
    """
    source = b"".join(Path(module.__file__ or "").read_bytes() for module in (reference_drive, fixed_step))
    digest = hashlib.sha256(source + str(STEPS_PER_SAMPLE).encode()).hexdigest()[:16]
    kept = FOLDER / f"reference-{digest}.npz"
    if not kept.exists():
        _keep(kept, simulation(numba_maths(), runge_kutta)(SAMPLE, STEPS_PER_SAMPLE, round(DURATION / SAMPLE) + 1))
    with np.load(kept) as archive:
        solution: Array = archive["solution"]
    if (differences(solution) > ALLOWED).any():
        raise ArithmeticError(f"the reference solution differs from the known lines by {differences(solution)}")
    return solution


def differences(solution: Array) -> Array:
    """Difference from each known line, shape (4, 5)."""
    return np.array([abs(solution[round(time / SAMPLE)] - line) for time, line in KNOWN.items()])


def _keep(path: Path, solution: Array) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    partial = path.with_suffix(".partial.npz")
    np.savez_compressed(partial, solution=solution)
    os.replace(partial, path)


if __name__ == "__main__":
    for column, worst in zip(COLUMNS, differences(reference_solution()).max(axis=0), strict=True):
        print(f"{column:22} differs from the known lines by at most {worst:.0e}")
