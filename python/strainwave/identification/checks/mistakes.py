"""Likely mistakes in the unit of a column, and the one that explains a factor."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from strainwave.files.units import convert

MAX_FACTOR_LEFT = 4.0  # a mistake explains a factor if it leaves a smaller one
# What the header of a column may name wrongly, and what it may be.
MISTAKEN = {
    "rad": ("deg", "rev", "arcmin"), "deg": ("rad", "rev", "arcmin"), "rad/s": ("rpm", "deg/s"), "rpm": ("rad/s",),
    "deg/s": ("rad/s",), "N.m": ("mN.m", "N.cm"), "mN.m": ("N.m",), "A": ("mA",), "V": ("mV",),
}  # fmt: skip


def wrong_units(quantity: str, unit: str) -> dict[str, float]:
    """Return mistakes in the unit of a quantity, and the factor by which each makes it too large."""
    return {f"the {quantity} is in {other}, not in {unit}": convert(1.0, unit, other) for other in MISTAKEN.get(unit, ())}


def nearest(factor: float, mistakes: Mapping[str, float]) -> tuple[str, float]:
    """Return the mistake that explains a factor best, in words, and the logarithm that it leaves; no words if none does.

    >>> nearest(900.0, {"the torque is in mN.m, not in N.m": 1000.0})[0]
    'perhaps the torque is in mN.m, not in N.m; '
    """
    distances = {name: abs(float(np.log(factor / size))) for name, size in mistakes.items()}
    name, least = min(distances.items(), key=lambda item: item[1], default=("", np.inf))
    return f"perhaps {name}; " if least < np.log(MAX_FACTOR_LEFT) else "", least


def times(factor: float) -> str:
    """Return a factor in words.

    >>> times(1234.0)
    '1 234 times'
    """
    return f"{factor:.3g} times" if factor < 100.0 else f"{factor:,.0f} times".replace(",", " ")
