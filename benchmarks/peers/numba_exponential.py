"""Exponential Runge-Kutta of order 4 in Numba: what of strainwave's lead is the algorithm, and what is the program.

ETD4RK of Cox and Matthews, Exponential time differencing for stiff systems, J. Comput. Phys. 176 (2002) 430-455, for
the bristle of the input friction, whose rate is linear in it: z' = speed - decay z. The decay is held over a step; what
it changes within is treated as the non-linear rest. The other states advance by the classical Runge-Kutta method.
No stage leaves |z| <= breakaway / bristle stiffness, which the true bristle never does.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from fixed_step import Function, advance, ahead, simulation, stage, trial
from reference_drive import (
    BREAKAWAY,
    BRISTLE_STIFFNESS,
    DURATION,
    SAMPLE,
    Array,
    Maths,
    bristle_decay,
    clip,
    numba_maths,
    output_inertias,
)

from peers import Crowd, Peer
from peers.numba_rk4 import prepare_fixed_step

BRISTLE_LIMIT = BREAKAWAY / BRISTLE_STIFFNESS  # rad
SERIES = tuple(1.0 / math.factorial(n) for n in range(15, 2, -1))  # of phi_3, highest power first


def phi(maths: Maths) -> Function:
    """(x, exp x) -> phi_1, phi_2, phi_3 of x <= 0: phi_0 = exp x, phi_(n+1) = (phi_n - 1/n!) / x.

    Near zero the differences cancel; there phi_3 is its series, and the others follow from it.
    """

    @maths.compile
    def phi(x: float, zeroth: float) -> Any:
        if x > -0.5:
            third = 0.0
            for coefficient in SERIES:
                third = third * x + coefficient
            second = 0.5 + x * third
            return 1.0 + x * second, second, third
        first = (zeroth - 1.0) / x
        second = (first - 1.0) / x
        return first, second, (second - 0.5) / x

    return phi


def weights(maths: Maths, phi_functions: Function) -> Function:
    """(x) -> exp(x/2), half-step weight, and the weights of the first, middle and last stage, for x = -decay step."""
    exp = maths.exp

    @maths.compile
    def weights(x: float) -> Any:
        decayed = exp(0.5 * x)
        half, _, _ = phi_functions(0.5 * x, decayed)
        first, second, third = phi_functions(x, decayed * decayed)
        return (
            decayed,
            0.5 * half,
            first - 3.0 * second + 4.0 * third,
            second - 2.0 * third,
            4.0 * third - second,
        )

    return weights


def exponential(maths: Maths, phi: Callable[[Maths], Function] = phi) -> Function:
    """(time, step, state, memory) -> state one step later."""
    first, later, plus = stage(maths, advance(maths)), stage(maths, trial(maths)), ahead(maths)
    decay_at, weights_at, limit = bristle_decay(maths), weights(maths, phi(maths)), clip(maths)

    @maths.compile
    def with_bristle(state: Any, bristle: float) -> Any:
        return state[0], state[1], state[2], state[3], state[4], limit(bristle, BRISTLE_LIMIT)

    @maths.compile
    def exponential(time: float, step: float, state: Any, memory: Any) -> Any:
        half, bristle, decay = 0.5 * step, state[5], decay_at(state[2])
        decayed, w_half, w_first, w_middle, w_last = weights_at(-decay * step)

        k1 = first(time, state, memory)
        rest_1 = k1[5] + decay * bristle
        a = with_bristle(plus(state, half, k1), decayed * bristle + step * w_half * rest_1)
        k2 = later(time + half, a, memory)
        rest_2 = k2[5] + decay * a[5]
        b = with_bristle(plus(state, half, k2), decayed * bristle + step * w_half * rest_2)
        k3 = later(time + half, b, memory)
        rest_3 = k3[5] + decay * b[5]
        c = with_bristle(plus(state, step, k3), decayed * a[5] + step * w_half * (2.0 * rest_3 - rest_1))
        k4 = later(time + step, c, memory)
        rest_4 = k4[5] + decay * c[5]

        weighted = w_first * rest_1 + 2.0 * w_middle * (rest_2 + rest_3) + w_last * rest_4
        moved = plus(state, step / 6.0, plus(plus(plus(k1, 2.0, k2), 2.0, k3), 1.0, k4))
        return with_bristle(moved, decayed * decayed * bristle + step * weighted)

    return exponential


def prepare_crowd(members: int, threads: int, step: float) -> Callable[[], Array]:
    """A run of many members, each compiled as the single one is, by Numba's prange."""
    import numba

    numba.set_num_threads(threads)
    options: dict[str, Any] = {"fastmath": True, "error_model": "numpy"}
    simulate = simulation(numba_maths(**options), exponential)

    def run(sample: float, steps: int, count: int, inertias: Array) -> Array:
        samples = np.empty((inertias.size, count, 2))
        for member in numba.prange(inertias.size):
            one = simulate(sample, steps, count, inertias[member])
            samples[member, :, 0], samples[member, :, 1] = one[:, 2], one[:, 4]
        return samples

    compiled = numba.njit(parallel=True, **options)(run)
    compiled(SAMPLE, 1, 2, output_inertias(2))
    steps, count, inertias = round(SAMPLE / step), round(DURATION / SAMPLE) + 1, output_inertias(members)
    return lambda: np.asarray(compiled(SAMPLE, steps, count, inertias)[0])


PEERS = (
    Peer(
        name="Numba exponential",
        distributions=("numba",),
        setting="step",
        ladder=(5e-4, 2e-4, 1e-4),
        prepare=partial(prepare_fixed_step, exponential),
    ),
)
CROWDS = tuple(
    Crowd(Peer("Numba prange, exponential", ("numba",), "step", (5e-4, 2e-4), partial(prepare_crowd, 64, threads)), 64, threads)
    for threads in (1, 2)
)
