"""Loss of a material that relaxes, one Maxwell branch, over the rate of torsion loops."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from strainwave.identification.experiments.loss_loop import LossLoop

MIN_RATES, MIN_RATIO_OF_RATES = 4, 1.3  # that determine a relaxation, too; of a rate to the next slower one (assumed)


@dataclass(frozen=True)
class Relaxation:
    """Loss modulus of a Maxwell branch over the angular frequency, in units of that of the largest loop.

    Attributes:
        reference: angular frequency of the largest loop [rad/s]
        middle, spread: geometric mean of those of all loops [rad/s], and half of the logarithm of their range: what is assumed
            of the inverse of the relaxation time, and of the logarithm of that
    """

    reference: float
    middle: float
    spread: float

    @classmethod
    def of(cls, loops: Sequence[LossLoop], largest: int) -> Relaxation | None:
        """Return the relaxation that loops at enough rates may show; None if they have fewer, or no clock."""
        if rate_count(loops) < MIN_RATES:
            return None
        frequencies = [loop.frequency for loop in loops]
        slowest, fastest = min(frequencies), max(frequencies)
        return cls(frequencies[largest], float(np.sqrt(slowest * fastest)), 0.5 * float(np.log(fastest / slowest)))

    def factor(self, frequency: float, logarithm: Any) -> Any:
        """Return it at a frequency [rad/s] by the logarithm of the relaxation time over 1 / middle, which may be complex."""
        time = np.exp(logarithm) / self.middle
        return frequency / self.reference * (1.0 + (self.reference * time) ** 2) / (1.0 + (frequency * time) ** 2)


def rate_count(loops: Sequence[LossLoop]) -> int:
    """Return at how many rates loops were measured; 0 if not all have a clock."""
    rates = np.sort([loop.frequency for loop in loops])
    return int(np.isfinite(rates).all()) * (1 + int(np.count_nonzero(rates[1:] > MIN_RATIO_OF_RATES * rates[:-1])))
