"""The classical Runge-Kutta method in Numba, with the return map: the best that explicit stepping can do.

Its step is bounded by the fastest bristle, not by accuracy: 7.14 us works, 8.33 us diverges.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from fixed_step import Function, runge_kutta, simulation
from reference_drive import DURATION, SAMPLE, Array, Maths, numba_maths

from peers import Peer


def prepare_fixed_step(method: Callable[[Maths], Function], step: float) -> Callable[[], Array]:
    """A run by a fixed-step method of `fixed_step`, compiled by Numba as fast as it can."""
    simulate = simulation(numba_maths(fastmath=True, error_model="numpy"), method)
    simulate(SAMPLE, 1, 2)
    steps, count = round(SAMPLE / step), round(DURATION / SAMPLE) + 1
    return lambda: simulate(SAMPLE, steps, count)[:, [2, 4]]


PEERS = (
    Peer(
        name="Numba RK4",
        distributions=("numba",),
        setting="step",
        ladder=(6.25e-6, 5e-6),
        prepare=partial(prepare_fixed_step, runge_kutta),
    ),
)
