"""Tsit5, an explicit method, by diffrax, compiled by XLA in double precision.

Its steps are bounded by stability, so that a tighter tolerance costs little.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from reference_drive import (
    DURATION,
    ELEMENT_LIMIT,
    ELEMENT_STIFFNESS,
    Array,
    Maths,
    deflection,
    initial_state,
    motion,
    output_and_torque,
    sample_times,
    state_scale,
    transmitted_torque,
)

from peers import Peer


def vector_field() -> Callable[[Any, Any, Any], Any]:
    """(time, state, arguments) -> rates. The Maxwell elements as one vector: XLA runs it 3 x faster than 8 scalars."""
    import jax.numpy as jnp

    maths = Maths(jnp.sin, jnp.cos, jnp.exp, jnp.abs, jnp.minimum, jnp.maximum, jnp.where, lambda function: function)
    twist_and_slope, gear_torque, move = deflection(maths), transmitted_torque(maths), motion(maths)
    limit = jnp.array(ELEMENT_LIMIT)

    def rates(time: Any, state: Any, _: Any) -> Any:
        elements = state[6:]
        twist, slope = twist_and_slope(state[1], state[3])
        twist_rate = slope * state[2] - state[4]
        torque = gear_torque(twist, twist_rate, ELEMENT_STIFFNESS * elements.sum())
        slips = (jnp.abs(elements) >= limit) & (elements * twist_rate > 0.0)
        return jnp.concatenate([jnp.stack(move(time, state, slope, torque)), jnp.where(slips, 0.0, twist_rate)])

    return rates


def prepare(tolerance: float) -> Callable[[], Array]:
    """A run by Tsit5 to this relative tolerance."""
    import diffrax
    import jax
    import jax.numpy as jnp

    jax.config.update("jax_enable_x64", True)  # type: ignore[no-untyped-call]
    term, times = diffrax.ODETerm(vector_field()), jnp.asarray(sample_times())
    controller = diffrax.PIDController(rtol=tolerance, atol=tolerance * jnp.asarray(state_scale()))

    def integrate(start: Any) -> Any:
        return diffrax.diffeqsolve(
            term,
            diffrax.Tsit5(),
            t0=0.0,
            t1=DURATION,
            dt0=1e-6,
            y0=start,
            saveat=diffrax.SaveAt(ts=times),
            stepsize_controller=controller,
            max_steps=20_000_000,
        ).ys

    start = jnp.asarray(initial_state())
    compiled = jax.jit(integrate).lower(start).compile()
    return lambda: output_and_torque(np.asarray(compiled(start)).T)


PEERS = (
    Peer(
        name="diffrax Tsit5",
        distributions=("diffrax",),
        setting="rtol",
        ladder=(1e-3, 1e-4, 1e-5, 1e-6),
        prepare=prepare,
    ),
)
