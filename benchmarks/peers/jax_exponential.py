"""The same exponential Runge-Kutta method by JAX: many members in one program by `vmap`, compiled in double precision."""

from __future__ import annotations

import os
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from fixed_step import Function, slope_and_torque, trial
from reference_drive import DURATION, ELEMENTS, OUTPUT_INERTIA, SAMPLE, Array, Maths, initial_state, output_inertias

from peers import Crowd, Peer
from peers.numba_exponential import SERIES, exponential


def jax_maths() -> Maths:
    import jax.numpy as jnp

    return Maths(jnp.sin, jnp.cos, jnp.exp, jnp.abs, jnp.minimum, jnp.maximum, jnp.where, lambda function: function)


def phi(maths: Maths) -> Function:
    """As Numba's, without a branch: both forms, each where it keeps its digits."""
    where, minimum = maths.where, maths.minimum

    def phi(x: Any, zeroth: Any) -> Any:
        near, far, third = where(x > -0.5, x, 0.0), minimum(x, -0.5), 0.0
        for coefficient in SERIES:
            third = third * near + coefficient
        second = 0.5 + near * third
        first = (zeroth - 1.0) / far
        middle = (first - 1.0) / far
        small = x > -0.5
        return (
            where(small, 1.0 + near * second, first),
            where(small, second, middle),
            where(small, third, (middle - 0.5) / far),
        )

    return phi


def trajectory(step: float) -> Callable[[Any], Any]:
    """(output_inertia) -> output angle and torque at the sample times, shape (2, n); to be compiled."""
    import jax
    import jax.numpy as jnp

    jax.config.update("jax_enable_x64", True)
    maths, steps, count = jax_maths(), round(SAMPLE / step), round(DURATION / SAMPLE) + 1
    one_step, evaluate = exponential(maths, phi), slope_and_torque(maths, trial(maths))

    def run(output_inertia: Any) -> Any:
        def forward(carry: Any, number: Any) -> Any:
            state, memory = carry[0], [*carry[1], output_inertia]  # a list, which the method writes to
            state = one_step(step * number, step, state, memory)
            return (tuple(state), tuple(memory[:-1])), None

        def sampled(carry: Any, sample: Any) -> Any:
            _, torque = evaluate(carry[0], [*carry[1], output_inertia])
            carry_on, _ = jax.lax.scan(forward, carry, sample * steps + jnp.arange(steps))
            return carry_on, (carry[0][3], torque)

        start = tuple(jnp.asarray(x) for x in initial_state()[:6]), (jnp.zeros(()),) * (ELEMENTS + 1)
        _, (angle, torque) = jax.lax.scan(sampled, start, jnp.arange(count))
        return jnp.stack([angle, torque])

    return run


def prepare(step: float) -> Callable[[], Array]:
    import jax

    compiled = jax.jit(trajectory(step)).lower(OUTPUT_INERTIA).compile()
    return lambda: np.asarray(compiled(OUTPUT_INERTIA)).T


def prepare_crowd(members: int, threads: int, step: float) -> Callable[[], Array]:
    """A run of many members by vmap; XLA takes the threads that this process may use."""
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, sorted(os.sched_getaffinity(0))[:threads])
    import jax

    inertias = output_inertias(members)
    compiled = jax.jit(jax.vmap(trajectory(step))).lower(inertias).compile()
    return lambda: np.asarray(compiled(inertias))[0].T


PEERS = (Peer("JAX exponential", ("jax",), "step", (5e-4, 2e-4), prepare),)
CROWDS = tuple(
    Crowd(Peer("JAX vmap, exponential", ("jax",), "step", (5e-4, 2e-4), partial(prepare_crowd, 64, threads)), 64, threads)
    for threads in (1, 2)
)
