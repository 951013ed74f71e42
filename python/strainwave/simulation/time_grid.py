"""A stretch of time cut into steps."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from strainwave import _core
from strainwave.equality import ComparedByFields
from strainwave.simulation.memory import check_instants, room_for

Array = NDArray[np.float64]
NEVER = np.empty(0)
# What a run keeps in memory [bytes]: of each step its end, found in a few goes, and of each that is laid out its inputs.
BYTES_PER_STEP, BYTES_PER_INPUTS = 33.0, 144.0
LONG_RUN = "take longer steps, sample less often, or make several runs, each from the end of the one before"
LONGER_STEPS = "take longer steps or slower inputs"
STEPS_PER_CHUNK = 200_000  # steps whose inputs are laid out at once: bounds the memory of long runs


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
