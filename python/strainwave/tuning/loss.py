"""Loss of a form of a gear that another program takes: how far it is from the full model."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from strainwave.presentation import Presented

Array = NDArray[np.float64]


@dataclass(frozen=True)
class ExportLoss(Presented):
    """Difference between the numbers that another program takes and the full model of the gear.

    Attributes:
        quantity: what differs
        rms, largest: of the difference, in `unit`
        unit: of both
        size: of the quantity itself, or of `relative_to`, in the same unit
        over: the loop, the speeds or the motion over which they are taken
        relative_to: the quantity of which `size` is, if not of the one that differs

    >>> import strainwave as sw
    >>> friction = sw.friction.Stribeck(coulomb=0.05, breakaway=0.08, stribeck_speed=50.0, viscous=1e-4)
    >>> joint = sw.GearSet.of(sw.Gear(friction_input=friction), name="joint", source="measured")
    >>> (loss,) = sw.export.joint(joint, max_torque=50.0).losses
    >>> loss.quantity, round(loss.rms, 4), loss.unit, round(loss.rms_share, 2)
    ('friction at the input', 0.0058, 'N.m', 0.09)
    """

    quantity: str
    rms: float
    largest: float
    unit: str
    size: float
    over: str
    relative_to: str = ""

    @classmethod
    def between(cls, quantity: str, difference: Array, unit: str, size: float, over: str, relative_to: str = "") -> ExportLoss:
        """Return the loss with root mean square and largest size of differences."""
        rms, largest = float(np.sqrt(np.mean(difference**2))), float(np.abs(difference).max())
        return cls(quantity, rms, largest, unit, size, over, relative_to)

    @property
    def rms_share(self) -> float:
        """Root mean square over the size; not a number if that is zero."""
        return self.rms / self.size if self.size else np.nan

    @property
    def largest_share(self) -> float:
        """Largest difference over the size; not a number if that is zero."""
        return self.largest / self.size if self.size else np.nan
