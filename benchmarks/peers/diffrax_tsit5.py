"""Tsit5, an explicit method, by diffrax, compiled by XLA in double precision.

Its steps are bounded by stability, so that a tighter tolerance costs little.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from reference_drive import (
    DURATION,
    ELEMENT_LIMIT,
    ELEMENT_STIFFNESS,
    OUTPUT_INERTIA,
    Array,
    Maths,
    deflection,
    initial_state,
    motion,
    output_and_torque,
    output_inertias,
    sample_times,
    state_scale,
    transmitted_torque,
)

from peers import Crowd, Peer


def vector_field() -> Callable[[Any, Any, Any], Any]:
    """(time, state, output_inertia) -> rates. The Maxwell elements as one vector: XLA runs it 3 x faster than 8 scalars."""
    import jax.numpy as jnp

    maths = Maths(jnp.sin, jnp.cos, jnp.exp, jnp.abs, jnp.minimum, jnp.maximum, jnp.where, lambda function: function)
    twist_and_slope, gear_torque, move = deflection(maths), transmitted_torque(maths), motion(maths)
    limit = jnp.array(ELEMENT_LIMIT)

    def rates(time: Any, state: Any, output_inertia: Any) -> Any:
        elements = state[6:]
        twist, slope = twist_and_slope(state[1], state[3])
        twist_rate = slope * state[2] - state[4]
        torque = gear_torque(twist, twist_rate, ELEMENT_STIFFNESS * elements.sum())
        slips = (jnp.abs(elements) >= limit) & (elements * twist_rate > 0.0)
        return jnp.concatenate([jnp.stack(move(time, state, slope, torque, output_inertia)), jnp.where(slips, 0.0, twist_rate)])

    return rates


def integration(tolerance: float) -> Callable[[Any], Any]:
    """(output_inertia) -> the states at the sample times, by Tsit5 to this relative tolerance; to be compiled."""
    import diffrax
    import jax
    import jax.numpy as jnp

    jax.config.update("jax_enable_x64", True)
    term, times = diffrax.ODETerm(vector_field()), jnp.asarray(sample_times())
    controller = diffrax.PIDController(rtol=tolerance, atol=tolerance * jnp.asarray(state_scale()))
    start = jnp.asarray(initial_state())

    def integrate(output_inertia: Any) -> Any:
        return diffrax.diffeqsolve(
            term,
            diffrax.Tsit5(),
            t0=0.0,
            t1=DURATION,
            dt0=1e-6,
            y0=start,
            args=output_inertia,
            saveat=diffrax.SaveAt(ts=times),
            stepsize_controller=controller,
            max_steps=20_000_000,
        ).ys

    return integrate


def prepare(tolerance: float) -> Callable[[], Array]:
    """A run by Tsit5 to this relative tolerance."""
    import jax

    compiled = jax.jit(integration(tolerance)).lower(OUTPUT_INERTIA).compile()
    return lambda: output_and_torque(np.asarray(compiled(OUTPUT_INERTIA)).T)


def prepare_crowd(members: int, threads: int, tolerance: float) -> Callable[[], Array]:
    """A run of many members by vmap; XLA takes the threads that this process may use."""
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, sorted(os.sched_getaffinity(0))[:threads])
    import jax

    inertias = output_inertias(members)
    compiled = jax.jit(jax.vmap(integration(tolerance))).lower(inertias).compile()
    return lambda: output_and_torque(np.asarray(compiled(inertias))[0].T)


PEERS = (
    Peer(
        name="diffrax Tsit5",
        distributions=("diffrax",),
        setting="rtol",
        ladder=(1e-3, 1e-4, 1e-5, 1e-6),
        prepare=prepare,
    ),
)
MEMBERS, THREADS = 4, 2
CROWDS = (
    Crowd(
        Peer(
            name="diffrax vmap, Tsit5",
            distributions=("diffrax",),
            setting="rtol",
            ladder=(1e-3,),
            prepare=partial(prepare_crowd, MEMBERS, THREADS),
        ),
        MEMBERS,
        THREADS,
    ),
)
