"""Agreement of two recordings."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import isfinite

import numpy as np
from numpy.typing import NDArray

from strainwave import arguments
from strainwave.files.recording import Recording
from strainwave.messages import listed, quoted, shortened
from strainwave.presentation import Statement

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Agreement(Statement):
    """Agreement of a column of one recording with that of another.

    Attributes:
        name, unit: of the column, as the first recording has it
        rms: root mean square of the difference, each sample of the first counted once [unit]
        largest: largest size of the difference [unit]
        time: when it is that large [s]
        correlation: Pearson's coefficient; None where one of them does not change
        samples: how many were compared

    >>> import strainwave as sw
    >>> units = {"time": "s", "torque": "N.m"}
    >>> measured = sw.Recording({"time": [0.0, 1.0, 2.0], "torque": [0.0, 10.0, 20.0]}, units)
    >>> (agreement,) = sw.compare(measured, measured.with_column("torque", [0.0, 10.4, 20.3], "N.m"))
    >>> round(agreement.rms, 3), round(agreement.largest, 3), agreement.unit, agreement.time
    (0.289, 0.4, 'N.m', 1.0)
    """

    name: str
    unit: str
    rms: float
    largest: float
    time: float
    correlation: float | None
    samples: int

    def _headline(self) -> str:
        """The agreement in one line."""
        related = "one is constant" if self.correlation is None else f"correlation {self.correlation:.6g}"
        sizes = f"rms {self.rms:.4g} {self.unit}, largest {self.largest:.4g} {self.unit} at t = {self.time:.4g} s"
        return f"{self.name}: {sizes}, {related}"


def agreements(first: Recording, second: Recording, names: Sequence[str] | None) -> list[Agreement]:
    """Return the agreement of each column that both recordings have, or of the named ones; see `compare`."""
    time, other = first.time, second.time
    wanted = _columns(first, second, names)
    common = (time >= other[0]) & (time <= other[-1])
    if not common.any():
        raise ValueError(f"the recordings have no time in common: {_span(time)} and {_span(other)}; {_remedy(time, other)}")
    return [_agreement(name, first, second, common) for name in wanted]


def _columns(first: Recording, second: Recording, names: Sequence[str] | None) -> list[str]:
    if names is not None:
        if not (wanted := arguments.names("names", names)) or "time" in wanted:
            raise ValueError(f"names = {shortened(wanted)} must name columns besides the time; there are {listed(first.names)}")
        return wanted
    shared = [name for name in first.names if name in second and name != "time"]
    if not shared:
        raise ValueError(f"the recordings have no column in common: {listed(first.names)}; and {listed(second.names)}")
    return shared


def _span(time: Array) -> str:
    return f"{time[0]:g} s to {time[-1]:g} s"


def _remedy(time: Array, other: Array) -> str:
    """Return the remedy if no sample of the first lies within the second."""
    apart = time[-1] < other[0] or other[-1] < time[0]
    return "shift the time of one" if apart else "no sample of the first lies within the second, so exchange them"


def _agreement(name: str, first: Recording, second: Recording, common: NDArray[np.bool_]) -> Agreement:
    """All sums are of numbers up to 2, as squares of the largest and of the smallest numbers are none."""
    unit, at = first.unit(name), first.time[common]
    try:
        theirs = second.values(name, unit)
    except ValueError as error:
        others = "name the columns to compare"
        raise ValueError(f"{error}; {others}" if name in second else str(error)) from None
    ours = first[name][common]
    scale = max(np.abs(ours).max(), np.abs(theirs).max()) or 1.0
    ours, theirs = ours / scale, _read_off(second.time, theirs / scale, at)
    difference = theirs - ours
    worst = int(np.argmax(np.abs(difference)))
    with np.errstate(over="ignore"):
        rms, largest = (float(scale * part) for part in (np.sqrt(np.mean(difference**2)), abs(difference[worst])))
    if not isfinite(largest):
        raise ValueError(f"column {quoted(name)} differs by more than the largest number there is, at t = {at[worst]:g} s")
    return Agreement(name, unit, rms, largest, float(at[worst]), _correlation(ours, theirs), len(at))


def _read_off(time: Array, values: Array, at: Array) -> Array:
    """Values between samples on a straight line, those at samples as they are."""
    with np.errstate(over="ignore", invalid="ignore"):  # a jump within no time; what is not finite is refused by the caller
        return values if np.array_equal(time, at) else np.interp(at, time, values)


def _correlation(first: Array, second: Array) -> float | None:
    """Pearson's coefficient; None where one of them does not change."""
    deviations = [values - values.mean() for values in (first, second)]
    sizes = [np.abs(each).max() for each in deviations]
    if min(np.ptp(first), np.ptp(second)) == 0.0 or min(sizes) == 0.0:
        return None
    one, other = (each / size for each, size in zip(deviations, sizes, strict=True))
    return float(np.clip((one @ other) / np.sqrt((one @ one) * (other @ other)), -1.0, 1.0))
