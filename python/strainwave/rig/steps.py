"""The steps of a torsion test, as they were made: what lay on the pans, and the photograph of it."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Step:
    """One state of rest of a test.

    Attributes:
        number: in the order made, from 1
        mass_positive: total on the pair of pans that turns the shaft positively [kg]
        mass_negative: total on the other pair [kg]
        image: file name of the photograph, relative to the folder of the test; None if the angle was read otherwise
        angle: read otherwise [rad], or None
        torque: measured otherwise, instead of masses [N.m], or None
        time: since the test began [s], or None
        temperature: of the gear [K], or None
        position: how far the flexspline was turned in its mount [rad]
        unit: which specimen
    """

    number: int
    mass_positive: float = 0.0
    mass_negative: float = 0.0
    image: str | None = None
    angle: float | None = None
    torque: float | None = None
    time: float | None = None
    temperature: float | None = None
    position: float = 0.0
    unit: str = ""
