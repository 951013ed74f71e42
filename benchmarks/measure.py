"""Measuring solvers of the reference drive, each in a process of its own that can be ended at any time; and runs in turn."""

from __future__ import annotations

import multiprocessing
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from multiprocessing.connection import Connection
from typing import TypeVar

import numpy as np
from peers import Peer
from reference_drive import Array
from report import installed
from rich.console import Console

T = TypeVar("T")
WANTED_OUTPUT_ANGLE = 3e-6  # rad
WANTED_TORQUE = 5e-2  # N.m


@dataclass(frozen=True)
class Effort:
    """How long a setting may take [s], and how often its run is repeated: `runs` times, or for `enough` seconds."""

    limit: float
    runs: int
    enough: float


@dataclass(frozen=True)
class Result:
    """A solver at one setting: largest errors over the samples, time on the wall and of all cores, time to compile."""

    solver: str
    setting: str
    output_angle_error: float  # rad
    torque_error: float  # N.m
    wall_time: float  # s
    cpu_time: float  # s
    compile_time: float  # s

    @property
    def accurate(self) -> bool:
        """Reaches the wanted accuracy."""
        return self.output_angle_error <= WANTED_OUTPUT_ANGLE and self.torque_error <= WANTED_TORQUE

    def no_less_accurate_than(self, other: Result) -> bool:
        """In output angle and torque."""
        return self.output_angle_error <= other.output_angle_error and self.torque_error <= other.torque_error


@dataclass(frozen=True)
class Failure:
    """A solver at a setting that gave no solution, and why."""

    solver: str
    setting: str
    reason: str


class TimeLimitError(Exception):
    """A solver exceeded its time limit."""


def shortest(runs: Mapping[str, Callable[[], object]], rounds: int) -> dict[str, float]:
    """The shortest time of each run [s], all in turn, so that a busy minute of the machine spoils none of their ratios."""
    times: dict[str, list[float]] = {name: [] for name in runs}
    for _ in range(rounds):
        for name, run in runs.items():
            start = time.perf_counter()
            run()
            times[name].append(time.perf_counter() - start)
    return {name: min(taken) for name, taken in times.items()}


def least(run: Callable[[], T], rounds: int) -> tuple[T, float, float]:
    """What it returns, and the least time of all cores and on the wall [s]."""
    taken = []
    for _ in range(rounds):
        begun, used = time.perf_counter(), time.process_time()
        found = run()
        taken.append((time.process_time() - used, time.perf_counter() - begun))
    return found, *(min(each) for each in zip(*taken, strict=True))


def measure_all(
    console: Console, peers: Sequence[Peer], effort: Effort, reference: Array
) -> Iterator[tuple[Peer, Result | Failure]]:
    """Each installed solver at each of its settings; says of the others that they are not installed."""
    for peer in peers:
        if missing := [name for name in peer.distributions if not installed(name)]:
            console.print(f"{peer.name}: not installed: pip install {' '.join(missing)}")
            continue
        with console.status(peer.name):
            for outcome in measure(peer, effort, reference):
                yield peer, outcome


def measure(peer: Peer, effort: Effort, reference: Array) -> Iterator[Result | Failure]:
    """One of both for each setting, up to the first that exceeds the time limit; reference: shape (5001, 2)."""
    pipe, remote = multiprocessing.Pipe()
    process = multiprocessing.get_context("spawn").Process(target=_serve, args=(peer, effort, remote), daemon=True)
    process.start()
    remote.close()
    try:
        for value in peer.ladder:
            setting = f"{peer.setting} {value:.3g}"
            try:
                samples, wall_time, cpu_time, compile_time = _receive(pipe, effort)
            except TimeLimitError as error:
                yield Failure(peer.name, setting, str(error))
                return
            except RuntimeError as error:
                yield Failure(peer.name, setting, str(error))
                continue
            angle, torque = np.abs(samples - reference).max(axis=0)
            yield Result(peer.name, setting, float(angle), float(torque), wall_time, cpu_time, compile_time)
    finally:
        process.kill()  # reaches also a solver that is deep in compiled code
        process.join()


def _serve(peer: Peer, effort: Effort, pipe: Connection) -> None:
    """Runs the ladder in the solver's process; sends samples and times of each setting, or what went wrong."""
    for value in peer.ladder:
        try:
            start = time.perf_counter()
            solve = peer.prepare(value)
            compile_time = time.perf_counter() - start
            pipe.send((*_best_of(solve, effort), compile_time))
        except Exception as error:  # whatever a solver raises is its result
            pipe.send(f"{type(error).__name__}: {error}")


def _best_of(solve: Callable[[], Array], effort: Effort) -> tuple[Array, float, float]:
    """Samples of the last run, and the shortest times of all [s]: on the wall, and of all cores together."""
    wall: list[float] = []
    cpu: list[float] = []
    while len(wall) < effort.runs and sum(wall) <= effort.enough:
        start, used = time.perf_counter(), time.process_time()
        samples = solve()
        wall.append(time.perf_counter() - start)
        cpu.append(time.process_time() - used)
    if not np.isfinite(samples).all():
        raise FloatingPointError("the solution is not finite")
    return samples, min(wall), min(cpu)


def _receive(pipe: Connection, effort: Effort) -> tuple[Array, float, float, float]:
    if not pipe.poll(effort.limit + effort.enough):
        raise TimeLimitError(f"more than {effort.limit:.0f} s")
    try:
        message: tuple[Array, float, float, float] | str = pipe.recv()
    except EOFError:
        raise RuntimeError("its process died") from None
    if isinstance(message, str):
        raise RuntimeError(message)
    return message
