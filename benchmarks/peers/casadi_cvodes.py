"""CVODES through CasADi: a symbolic graph with exact derivatives, interpreted, and compiled to C by gcc."""

from __future__ import annotations

import contextlib
import tempfile
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from reference_drive import (
    OUTPUT_INERTIA,
    Array,
    Maths,
    initial_state,
    output_and_torque,
    output_inertias,
    right_hand_side,
    sample_times,
)

from peers import Crowd, Peer

COMPILED = {
    "jit": True,
    "jit_cleanup": False,
    "compiler": "shell",
    "jit_options": {"compiler": "gcc", "flags": ["-O3", "-march=native"], "cleanup": False},
}
INTERPRETED: dict[str, Any] = {}


def integrator(execution: dict[str, Any], tolerance: float) -> Any:
    """(start, output inertia) -> the states at all sample times but the first, by CVODES to this relative tolerance."""
    import casadi

    maths = Maths(
        casadi.sin,
        casadi.cos,
        casadi.exp,
        casadi.fabs,
        casadi.fmin,
        casadi.fmax,
        casadi.if_else,
        lambda function: function,
    )
    start, times = initial_state(), sample_times()
    time, state, inertia = casadi.SX.sym("time"), casadi.SX.sym("state", start.size), casadi.SX.sym("output_inertia")
    rates = casadi.SX.zeros(start.size)
    right_hand_side(maths)(time, state, rates, inertia)
    equations = {"t": time, "x": state, "p": inertia, "ode": rates}
    options = {"reltol": tolerance, "abstol": 1e-2 * tolerance, "max_num_steps": 5_000_000, **execution}
    # CasADi compiles in the working directory; the library stays loaded when its file is gone.
    with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
        return casadi.integrator("drive", "cvodes", equations, 0.0, list(times[1:]), options)


def prepare(execution: dict[str, Any], tolerance: float) -> Callable[[], Array]:
    """A run by CVODES to this relative tolerance."""
    integrate, start = integrator(execution, tolerance), initial_state()

    def solve() -> Array:
        return output_and_torque(np.column_stack([start, np.array(integrate(x0=start, p=OUTPUT_INERTIA)["xf"])]))

    return solve


def prepare_crowd(members: int, threads: int, tolerance: float) -> Callable[[], Array]:
    """A run of many members by CasADi's map over threads."""
    integrate, start = integrator(COMPILED, tolerance), initial_state()
    mapped = integrate.map(members, "thread", threads)
    starts, inertias = np.tile(start[:, None], members), output_inertias(members)[None, :]

    def solve() -> Array:
        states = np.array(mapped(x0=starts, p=inertias)["xf"])  # the samples of one member after those of the other
        return output_and_torque(np.column_stack([start, states[:, : len(sample_times()) - 1]]))

    return solve


PEERS = (
    Peer(
        name="CasADi CVODES",
        distributions=("casadi",),
        setting="rtol",
        ladder=(1e-4, 1e-5, 1e-6),
        prepare=partial(prepare, INTERPRETED),
    ),
    Peer(
        name="CasADi CVODES, gcc",
        distributions=("casadi",),
        setting="rtol",
        ladder=(1e-4, 1e-5, 1e-6),
        prepare=partial(prepare, COMPILED),
    ),
)
MEMBERS, THREADS = 8, 2
CROWDS = (
    Crowd(
        Peer(
            name="CasADi map, CVODES, gcc",
            distributions=("casadi",),
            setting="rtol",
            ladder=(1e-4,),
            prepare=partial(prepare_crowd, MEMBERS, THREADS),
        ),
        MEMBERS,
        THREADS,
    ),
)
