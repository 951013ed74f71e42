"""Compile the kernels of a drive ahead of its runs, and compare them with the general drive."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive, _core, arguments
from strainwave.files.gear_set import GearSet
from strainwave.files.ratings import drive_of
from strainwave.native import kernels
from strainwave.native.kernels import JOBS, PUBLIC_JOBS, Job
from strainwave.native.static_type import in_words
from strainwave.presentation import Presented, Row, counted

Array = NDArray[np.float64]
ROOM_TEMPERATURE = 293.15  # K
TRIAL_STEPS = 1000  # of the run that both are timed by
TRIAL_MEMBERS = 16  # of the ensemble
MAX_TRIAL_STEP = 2e-4  # s
MAX_ADAPTIVE_STEPS = 10_000  # of a trial, after which it ends
MAX_PHASE_PER_STEP = 0.5  # rad of the fastest vibration for each step of the trial
TRIAL_REPEATS = 3  # of which the fastest counts


@dataclass(frozen=True)
class CompiledJob:
    """A job of a kernel.

    Args:
        job: what it does: one of simulate, simulate_adaptively, simulate_many, differentiate, inverse_dynamics
        seconds: time to compile and load it [s]; some milliseconds if it was in the cache
        times_faster: time of the general drive over that of the kernel, of the same short run
    """

    job: Job
    seconds: float
    times_faster: float


@dataclass(frozen=True)
class Compilation(Presented):
    """Kernels that were compiled for a drive. As a text, a table of them.

    Args:
        drive: the laws of the drive, without those that every drive has by default
        jobs: the jobs, in the order of `JOBS`

    >>> import strainwave as sw
    >>> print(sw.compile(sw.load("position-drive"), jobs=["simulate"]))  # doctest: +SKIP
    control PID, kinematics PlainRatio, friction_input Coulomb, friction_output Coulomb
    job                  compiled    faster
    simulate               1.75 s     6.4 x
    """

    drive: str
    jobs: tuple[CompiledJob, ...]

    def _headline(self) -> str:
        return f"{counted(len(self.jobs), 'job')} of {self.drive}"

    def _rows(self) -> Iterator[Row]:
        for each in self.jobs:
            yield Row(each.job, each.seconds, "s", note=f"{each.times_faster:.1f} times faster")


def compile(drive: Drive | GearSet, jobs: Sequence[str] = PUBLIC_JOBS) -> Compilation:
    """Compile the kernels of a drive, wait for them, and compare each with the general drive.

    A kernel is the same physics compiled for the laws of one drive. All later runs of drives with these laws use it, in this
    process and, from the cache, in others; results are the same to the last bit. Long work compiles its kernel by itself: this
    is for who will do short runs many times, or wants to know the times. The numbers of a drive may change, its laws may not.

    Args:
        drive: a drive, or a gear set with one
        jobs: which of simulate, simulate_adaptively, simulate_many, differentiate and inverse_dynamics to compile

    Returns:
        Compilation: time to compile and ratio to the general drive, for each job

    Raises:
        TypeError, ValueError: an argument is not of its kind
        OSError: there is no compiler, it reports an error, or the cache cannot be written

    >>> import strainwave as sw
    >>> print(sw.compile(sw.load("two-inertia-gear"), jobs=[]).drive)
    motor TorqueSource, stiffness Cubic, meter EnergyMeter
    """
    drive = drive_of(drive)
    names = arguments.names("jobs", jobs)
    for name in names:
        arguments.one_of("jobs", name, JOBS)
    wanted = [job for job in JOBS if job in names]
    with _general_drive(drive):
        general = {job: _trial_seconds(drive, job) for job in wanted}
    found = []
    for job in wanted:
        began = time.perf_counter()
        kernels.load_or_raise(drive, job)
        seconds = time.perf_counter() - began
        found.append(CompiledJob(job, seconds, general[job] / _trial_seconds(drive, job)))
    return Compilation(in_words(drive), tuple(found))


@contextmanager
def _general_drive(drive: Drive) -> Iterator[None]:
    """Use no kernel for drives with the laws of one; then those that were in use before."""
    jobs = [job for job in JOBS if job in _core.loaded_jobs(drive)]
    _core.forget_kernels(drive)
    try:
        yield
    finally:
        for job in jobs:
            kernels.load(drive, job, compile_it=False)


def _trial_seconds(drive: Drive, job: Job) -> float:
    """Return the least time [s] of some short runs of a job."""
    trial = _trial(drive, job)
    times = []
    for _ in range(TRIAL_REPEATS):
        began = time.perf_counter()
        # A run that leaves where the laws are valid, or that takes too many steps, ends at the same step by a kernel.
        with suppress(ValueError, FloatingPointError):
            trial()
        times.append(time.perf_counter() - began)
    return min(times)


def _trial(drive: Drive, job: Job) -> Callable[[], Any]:
    """Return a short run of a job, under no command and no load."""
    dt = min(MAX_TRIAL_STEP, MAX_PHASE_PER_STEP / max(_core.max_rate(drive, 0.0), 1.0))
    instants: Array = dt * np.arange(TRIAL_STEPS + 1, dtype=np.float64)
    inputs: Array = np.zeros((TRIAL_STEPS, 3, 6))
    inputs[..., 4] = ROOM_TEMPERATURE
    keep = np.zeros(TRIAL_STEPS, dtype=np.uint8)
    keep[-1] = 1
    state, ends, out, numbers = drive.rest().numbers, instants[[0, -1]], np.empty((1, 2)), _core.parts(drive)[2]
    twist = [channel for name, *_, channel in _core.outputs(drive) if name == "twist"]
    if job == "simulate":
        return partial(_core.simulate, drive, state, instants, inputs, keep, _core.Method.exponential, twist, out, 1)
    if job == "simulate_adaptively":
        acting = (_constant(0.0), _constant(0.0), _constant(ROOM_TEMPERATURE))
        return partial(
            _core.simulate_adaptively, drive, state, *acting, ends, 1e-6, 1e-12, MAX_ADAPTIVE_STEPS, ends[1:], twist, out, 1
        )
    if job == "simulate_many":
        values, many = np.full((1, TRIAL_MEMBERS), numbers[0]), np.empty((1, TRIAL_MEMBERS, 2))
        return partial(_core.simulate_many, drive, [0], values, None, instants, inputs, keep, twist, np.inf, 1, many)
    free = list(range(min(_core.slopes, len(numbers))))
    if job == "inverse_dynamics":
        return partial(_core.inverse_dynamics, drive, np.ones((TRIAL_STEPS, 4)), np.ascontiguousarray(inputs[:, 0]), free)
    return partial(_core.differentiate, drive, None, instants, inputs, keep, free)


def _constant(level: float) -> _core.Signal:
    return _core.Signal(np.zeros(1), np.full(1, level), np.zeros(1), np.empty((0, 4)))
