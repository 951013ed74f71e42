"""SciPy's `solve_ivp`: LSODA and Radau with a compiled right-hand side, and what a user writes first, in plain Python.

The ladder of LSODA ends at 3e-5: at 1e-5 it takes minutes and 7e7 evaluations.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any, Literal

import numpy as np
from reference_drive import (
    DURATION,
    PYTHON,
    Array,
    initial_state,
    numba_maths,
    output_and_torque,
    right_hand_side,
    sample_times,
    state_scale,
)

from peers import Peer

Rates = Callable[[Any, Any], Any]


def compiled_rates() -> Rates:
    """(time, state) -> rates, compiled by Numba."""
    maths = numba_maths(error_model="numpy")
    fill = right_hand_side(maths)

    @maths.compile
    def rates(time: float, state: Any) -> Any:
        out = np.empty(state.size)
        fill(time, state, out)
        return out

    rates(0.0, initial_state())
    return rates


def plain_rates() -> Rates:
    """(time, state) -> rates, in plain Python: floats of a list are several times faster than those of an array."""
    fill = right_hand_side(PYTHON)

    def rates(time: float, state: Array) -> list[float]:
        out = [0.0] * state.size
        fill(time, state.tolist(), out)
        return out

    return rates


def prepare(method: Literal["LSODA", "Radau", "RK45"], rates: Callable[[], Rates], tolerance: float) -> Callable[[], Array]:
    """A run by a method of `scipy.integrate.solve_ivp` to this relative tolerance."""
    from scipy.integrate import solve_ivp

    function = rates()

    def solve() -> Array:
        solution = solve_ivp(
            function,
            (0.0, DURATION),
            initial_state(),
            method=method,
            t_eval=sample_times(),
            rtol=tolerance,
            atol=tolerance * state_scale(),
        )
        if not solution.success:
            raise RuntimeError(f"{method}: {solution.message}")
        return output_and_torque(solution.y)

    return solve


PEERS = (
    Peer(
        name="SciPy LSODA, Numba",
        distributions=("scipy", "numba"),
        setting="rtol",
        ladder=(1e-3, 1e-4, 3e-5),
        prepare=partial(prepare, "LSODA", compiled_rates),
    ),
    Peer(
        name="SciPy Radau, Numba",
        distributions=("scipy", "numba"),
        setting="rtol",
        ladder=(1e-3, 1e-4),
        prepare=partial(prepare, "Radau", compiled_rates),
    ),
    Peer(
        name="SciPy LSODA, Python",
        distributions=("scipy",),
        setting="rtol",
        ladder=(1e-3, 1e-4),
        prepare=partial(prepare, "LSODA", plain_rates),
    ),
    Peer(
        name="SciPy RK45, Python",
        distributions=("scipy",),
        setting="rtol",
        ladder=(1e-3,),
        prepare=partial(prepare, "RK45", plain_rates),
    ),
)
