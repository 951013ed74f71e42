"""Solvers that the reference drive is measured with. One module a package, each with a tuple PEERS."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from reference_drive import Array


@dataclass(frozen=True)
class Peer:
    """A solver of the reference drive.

    name: as in the table; distributions: what must be installed, as pip names it; setting: what the ladder lists,
    "step" [s] or "rtol", the relative tolerance; ladder: settings to try, cheapest first; prepare: setting -> run,
    everything compiled. The run solves the drive and returns output angle [rad] and transmitted torque [N.m] at the
    sample times, shape (5001, 2).
    """

    name: str
    distributions: tuple[str, ...]
    setting: str
    ladder: tuple[float, ...]
    prepare: Callable[[float], Callable[[], Array]]


@dataclass(frozen=True)
class Crowd:
    """A solver of many reference drives that differ in their output's inertia, see `reference_drive.output_inertias`.

    peer: its run solves them all, and returns what the first of them does; members: how many; threads: on how many.
    """

    peer: Peer
    members: int
    threads: int
