"""SciPy as an expert uses it: a compiled right-hand side, the return map, a restart at each of the 447 turns of the twist."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, partial

from reference_drive import Array, numba_maths
from stretches import reference_stretches, solver

from peers import Peer


@cache
def compiled(method: str) -> Callable[[float], Array]:
    maths = numba_maths(error_model="numpy")
    return solver(reference_stretches(maths), maths, method)


def prepare(method: str, tolerance: float) -> Callable[[], Array]:
    """A run by a method of SciPy to this relative tolerance."""
    return partial(compiled(method), tolerance)


PEERS = (
    Peer("SciPy LSODA, expert", ("scipy", "numba"), "rtol", (1e-4, 3e-5, 1e-5, 1e-6, 1e-7), partial(prepare, "LSODA")),
    Peer("SciPy Radau, expert", ("scipy", "numba"), "rtol", (1e-4, 1e-5), partial(prepare, "Radau")),
)
