"""CVODE (BDF) of SUNDIALS through scikit-sundae, with a right-hand side compiled by Numba."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from reference_drive import (
    Array,
    initial_state,
    numba_maths,
    output_and_torque,
    right_hand_side,
    sample_times,
    state_scale,
)

from peers import Peer


def prepare(tolerance: float) -> Callable[[], Array]:
    """A run by CVODE to this relative tolerance."""
    from sksundae.cvode import CVODE

    fill = right_hand_side(numba_maths(error_model="numpy"))
    fill(0.0, initial_state(), np.empty_like(initial_state()))

    def rates(time: float, state: Array, out: Array) -> None:
        fill(time, state, out)

    solver = CVODE(rates, rtol=tolerance, atol=tolerance * state_scale(), max_num_steps=2_000_000)

    def solve() -> Array:
        solution = solver.solve(sample_times(), initial_state())
        if not solution.success:
            raise RuntimeError(f"CVODE: {solution.message}")
        return output_and_torque(np.asarray(solution.y).T)

    return solve


PEERS = (
    Peer(
        name="CVODE, Numba",
        distributions=("scikit-sundae", "numba"),
        setting="rtol",
        ladder=(1e-3, 1e-4, 1e-5, 1e-6),
        prepare=prepare,
    ),
)
