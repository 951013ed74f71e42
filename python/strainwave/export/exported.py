"""Result of an export: files, the numbers in them, and what they lose against the gear."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Loss:
    """Difference between an exported model and the gear.

    Attributes:
        quantity: what differs
        rms, largest: of the difference, in `unit`
        unit: of both
        size: of the quantity itself in the same unit, to compare with
        over: the loop, the speeds or the motion over which they are taken
    """

    quantity: str
    rms: float
    largest: float
    unit: str
    size: float
    over: str

    @classmethod
    def between(cls, quantity: str, difference: Array, unit: str, size: float, over: str) -> Loss:
        """Return the loss with root mean square and largest size of differences."""
        return cls(quantity, float(np.sqrt(np.mean(difference**2))), float(np.abs(difference).max()), unit, size, over)

    @property
    def share(self) -> float:
        """Root mean square over the size; not a number if that is zero."""
        return self.rms / self.size if self.size else np.nan


@dataclass(frozen=True)
class Exported:
    """A gear in the form of another program.

    Attributes:
        kind: of the export, as the command names it
        gear: name of the gear
        files: their texts or bytes, by the path in the folder
        numbers: that were written, with their units
        losses: against the gear, computed
        left_out: laws of the gear that the form has no place for, in words
        remarks: what to do with the files, and what was assumed
    """

    kind: str
    gear: str
    files: Mapping[str, str | bytes]
    numbers: Mapping[str, tuple[float, str]] = field(default_factory=dict)
    losses: tuple[Loss, ...] = ()
    left_out: tuple[str, ...] = ()
    remarks: tuple[str, ...] = ()
