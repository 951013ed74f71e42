"""CVODES through CasADi: a symbolic graph with exact derivatives, interpreted, and compiled to C by gcc."""

from __future__ import annotations

import contextlib
import tempfile
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from reference_drive import Array, Maths, initial_state, output_and_torque, right_hand_side, sample_times

from peers import Peer

COMPILED = {
    "jit": True,
    "jit_cleanup": False,
    "compiler": "shell",
    "jit_options": {"compiler": "gcc", "flags": ["-O3", "-march=native"], "cleanup": False},
}
INTERPRETED: dict[str, Any] = {}


def prepare(execution: dict[str, Any], tolerance: float) -> Callable[[], Array]:
    """A run by CVODES to this relative tolerance."""
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
    time, state = casadi.SX.sym("time"), casadi.SX.sym("state", start.size)
    rates = casadi.SX.zeros(start.size)
    right_hand_side(maths)(time, state, rates)
    equations = {"t": time, "x": state, "ode": rates}
    options = {"reltol": tolerance, "abstol": 1e-2 * tolerance, "max_num_steps": 5_000_000, **execution}
    # CasADi compiles in the working directory; the library stays loaded when its file is gone.
    with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
        integrate = casadi.integrator("drive", "cvodes", equations, 0.0, list(times[1:]), options)

    def solve() -> Array:
        return output_and_torque(np.column_stack([start, np.array(integrate(x0=start)["xf"])]))

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
