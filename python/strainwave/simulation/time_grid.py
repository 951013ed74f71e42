"""A stretch of time cut into steps, and limits on memory and on the length of runs.

A message names what is too large, its count and size, and the remedy.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from strainwave import _core
from strainwave.equality import ComparedByFields

Array = NDArray[np.float64]

NO_INSTANTS = np.empty(0)
# What a run keeps in memory [bytes]: of each step its end, found in a few goes, and of each that is laid out its inputs.
BYTES_PER_STEP, BYTES_PER_INPUTS = 33.0, 144.0
LONG_RUN = "take longer steps, sample less often, or make several runs, each from the end of the one before"
LONGER_STEPS = "take longer steps or slower inputs"
STEPS_PER_CHUNK = 200_000  # steps whose inputs are laid out at once: bounds the memory of long runs
MAX_INSTANTS = 1e8  # steps or samples of one run or signal: 5.5 hours in steps of 0.2 ms
MAX_ACTIONS = 1e7  # of a controller in one run: 10 000 s at 1 kHz
MAX_BYTES = 8e9  # that steps or samples of one run may take
BYTES_PER_ACTION = 120.0  # memory for a sample of a controller with the instant at which its output arrives (measured)


@contextmanager
def room_for(what: str, count: float, each: float, remedy: str) -> Iterator[None]:
    """Refuse what takes more than `MAX_BYTES`; a MemoryError within names it, its size, and the remedy.

    Args:
        each: size of one [bytes]

    >>> with room_for("samples", 5e8, 8.0, "take fewer"):
    ...     raise MemoryError
    Traceback (most recent call last):
    MemoryError: 5e+08 samples take 4 GB, more memory than there is; take fewer
    """
    if count * each > MAX_BYTES:
        raise MemoryError(
            f"{count:.3g} {what} take {1e-9 * count * each:.3g} GB; at most {1e-9 * MAX_BYTES:g} GB are allowed; {remedy}"
        )
    try:
        yield
    except MemoryError:
        size = f"{1e-9 * count * each:.3g} GB"
        raise MemoryError(f"{count:.3g} {what} take {size}, more memory than there is; {remedy}") from None


def check_room(what: str, count: float, each: float, remedy: str) -> None:
    """Refuse what is too large for the memory, as `room_for` does, before time is spent on a part of it.

    >>> check_room("samples", 1e15, 8.0, "take fewer")
    Traceback (most recent call last):
    MemoryError: 1e+15 samples take 8e+06 GB; at most 8 GB are allowed; take fewer
    """
    with room_for(what, count, each, remedy):
        np.empty(int(count * each), np.uint8)


def check_instants(duration: float, step: float, remedy: str, most: float = MAX_INSTANTS) -> None:
    """Refuse to cut a duration [s] into more than `most` steps [s].

    >>> check_instants(1.0, 1e-12, "take longer ones")
    Traceback (most recent call last):
    ValueError: 1 s are more than 1e+08 steps of 1e-12 s; take longer ones
    """
    if duration > most * step:
        raise ValueError(f"{duration:g} s are more than {most:g} steps of {step:g} s; {remedy}")


def check_acting(duration: float, period: float) -> None:
    """Refuse more than `MAX_ACTIONS` of a controller, one a period [s] over a duration [s].

    >>> check_acting(0.1, 1e-9)
    Traceback (most recent call last):
    ValueError: a controller with period = 1e-09 s acts 1e+08 times in 0.1 s; at most 1e+07 times are allowed; take a longer \
period, or make several runs
    """
    if duration > MAX_ACTIONS * period:
        raise ValueError(
            f"a controller with period = {period:g} s acts {duration / period:.3g} times in {duration:g} s; at most "
            f"{MAX_ACTIONS:g} times are allowed; take a longer period, or make several runs"
        )
    check_room("samples of the controller", duration / period, BYTES_PER_ACTION, "take a longer period, or make several runs")


@dataclass(frozen=True, eq=False)
class TimeGrid(ComparedByFields):
    """A stretch of time cut into steps.

    Attributes:
        instants: at which steps begin and end [s]
        samples: 1 if an instant is a sample of the recording
        times: of the samples [s]
        longest: step [s]
    """

    instants: Array
    samples: NDArray[np.uint8]
    times: Array
    longest: float

    @classmethod
    def through(cls, duration: float, dt: float, samples: float | Array, breaks: Array) -> TimeGrid:
        """Steps of at most `dt` that end at every sample, given by their interval or one by one, and at every break.

        Where neither asks for more, steps are exactly `dt`; the last may be shorter.
        """
        apart = float(np.min(np.diff(samples))) if isinstance(samples, np.ndarray) else samples
        nearest = max(1e-9 * min(dt, apart, duration), 4.0 * float(np.spacing(duration)))
        if not isinstance(samples, np.ndarray):
            samples = grid(samples, duration, nearest)
        steps = grid(dt, duration, nearest)
        with room_for("steps", len(steps) + len(samples), BYTES_PER_STEP, LONG_RUN):
            instants, sampled, times, longest = _core.time_grid(steps, samples, np.sort(breaks), nearest)
        return cls(instants, sampled, times, min(longest, dt))  # longer by rounding

    def chunks(self) -> Iterator[tuple[Array, NDArray[np.uint8]]]:
        """Yield instants of pieces that follow each other, and 1 for each step of a piece that ends at a sample."""
        for start in range(0, len(self.instants) - 1, STEPS_PER_CHUNK):
            end = start + STEPS_PER_CHUNK + 1
            yield self.instants[start:end], self.samples[start + 1 : end]


def grid(step: float, duration: float, tolerance: float) -> Array:
    """0, step, 2 step … up to duration, which is always the last."""
    check_instants(duration, step, LONGER_STEPS)
    with room_for("steps", duration / step, BYTES_PER_STEP, LONG_RUN):
        return _core.grid(step, duration, tolerance)
