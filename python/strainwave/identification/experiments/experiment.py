"""Measurements as experiments: each knows what a model predicts for it, with exact derivatives by its parameters."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from strainwave.files.recording import Recording

Array = NDArray[np.float64]
SENSIBLE = (1e-9, 1e9)  # the largest of a quantity that was measured on a gear, in SI units, lies between


@dataclass(frozen=True)
class Nuisance:
    """An unknown of the measurement itself, such as the zero of an angle: fitted along, of no interest.

    Attributes:
        name: what it is
        unit: its unit
        start: where a fit starts
    """

    name: str
    unit: str
    start: float


class Experiment(Protocol):
    """What was measured, and what a model says to it.

    Attributes:
        channels: names of the quantities compared
        units: unit of each channel
        measured: measured values, shape (channels, n)
        nuisances: unknowns of the measurement
    """

    @property
    def channels(self) -> tuple[str, ...]: ...
    @property
    def units(self) -> tuple[str, ...]: ...
    @property
    def measured(self) -> Array: ...
    @property
    def nuisances(self) -> tuple[Nuisance, ...]: ...

    def predict(self, model: Any, numbers: Sequence[int], nuisances: Array) -> tuple[Array, Array]:
        """Predicted values, shape (channels, n), and derivatives, shape (numbers + nuisances, channels, n)."""
        ...


def sensible(recording: Recording, name: str, unit: str) -> Array:
    """A column in another unit, of a size that an instrument could have read."""
    values = recording.values(name, unit)
    largest, (low, high) = float(np.abs(values).max()), SENSIBLE
    if largest > high or 0.0 < largest < low:
        raise ValueError(
            f'column "{name}" goes up to {largest:.3g} {unit}; what is measured on a gear lies between {low:g} and {high:g} '
            f"{unit}. Is its unit right? It is taken to be {recording.unit(name)}"
        )
    return values


def changing(recording: Recording, name: str, unit: str) -> Array:
    """A column in another unit, of a size that an instrument could have read, that changes.

    Raises:
        ValueError: it never changes, or its size is none of a gear
    """
    values = sensible(recording, name, unit)
    if np.ptp(values) == 0.0:
        raise ValueError(f"{name} never changes: a set value, a limit, or a channel that was not recorded")
    return values
