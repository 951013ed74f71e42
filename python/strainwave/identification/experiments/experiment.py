"""Measurements as experiments: each has a prediction by a model, with derivatives by its parameters."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from strainwave import _core
from strainwave.files.recording import Recording, check_recording
from strainwave.messages import listed, quoted

Array = NDArray[np.float64]
MEASURABLE_RANGE = (1e-9, 1e9)  # lowest and highest value that the largest of a quantity has on a gear, in SI units
RELATIVE_STEP = 1e-6  # of a number, or of its size, for a difference of torques that are smooth in it


@dataclass(frozen=True)
class Nuisance:
    """An unknown of the measurement itself, such as the zero of an angle: fitted along, of no interest.

    Attributes:
        name: what it is
        unit: its unit
        start: where a fit starts
        low, high: its limits
    """

    name: str
    unit: str
    start: float
    low: float = -np.inf
    high: float = np.inf


class Experiment(Protocol):
    """A measurement, and its prediction by a model.

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
        """Return predicted values, shape (channels, n), and derivatives, shape (numbers + nuisances, channels, n)."""
        ...


def check_columns(recording: Recording, names: Sequence[str], what: str) -> None:
    """Raise ValueError for a recording without one of the columns that an experiment needs."""
    check_recording("recording", recording)
    for name in names:
        if name not in recording:
            raise ValueError(f"{what} needs a column {quoted(name)}; it has {listed(recording.names)}")


def sensible(recording: Recording, name: str, unit: str) -> Array:
    """Return a column in another unit; ValueError for a size that no instrument reads on a gear."""
    values = recording.values(name, unit)
    largest, (low, high) = float(np.abs(values).max()), MEASURABLE_RANGE
    if largest > high or 0.0 < largest < low:
        raise ValueError(
            f'column "{name}" goes up to {largest:.3g} {unit}; what is measured on a gear lies between {low:g} and {high:g} '
            f"{unit}. Is its unit right? It is taken to be {recording.unit(name)}"
        )
    return values


def changing(recording: Recording, name: str, unit: str) -> Array:
    """Return a column in another unit, as `sensible`; ValueError if it never changes."""
    values = sensible(recording, name, unit)
    if np.ptp(values) == 0.0:
        raise ValueError(
            f"{name} never changes: a set value, a limit, or a channel that was not recorded; give the column that was measured"
        )
    return values


def with_step(model: Any, number: int, step: float) -> tuple[Any, float]:
    """Return a model with one number changed by a step, or by its opposite if the limits ask for it, and the change."""
    described = _core.parameters(model)
    _, value, *_, low, high = described[number]
    end = value + step if low <= value + step <= high else value - step
    numbers = [each[1] for each in described]
    return _core.with_numbers(model, [*numbers[:number], end, *numbers[number + 1 :]]), end - value
