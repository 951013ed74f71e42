"""Loops whose numbers are known without the package: from tables, closed forms and equations integrated finely."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray
from strainwave.rig import Loop

Array = NDArray[np.float64]

# Document T, Table 2: stiffness of the four regimes [N.m/rad] and hysteresis [deg], and the peak of the torque [N.m].
TABLE = {
    0.0: (4.51, 0.31, 4.85, 0.30, 50.5),
    60.0: (4.36, 0.29, 3.59, 0.33, 51.9),
    120.0: (4.19, 0.32, 5.08, 0.33, 49.4),
}
PEAK = 0.36
ONSET = 0.03


def vertices(row: tuple[float, ...], peak: float = PEAK, onset: float = ONSET) -> tuple[Array, Array]:
    """Corners of the closed loop with these slopes and this width at zero torque, angle [rad] and torque [N.m] (erratum E-T4).

    A loading branch is as soft as stated from the onset on, over as much torque as the width takes, and else as stiff as both
    unloading branches in the mean.
    """
    down, soft_down, up, soft_up, width = *row[:4], float(np.radians(row[4]))
    stiff = 0.5 * (down + up)
    soft = [
        (width - peak / stiff + peak / back) / (1.0 / slope - 1.0 / stiff) for slope, back in ((soft_down, up), (soft_up, down))
    ]
    angle, torque = [0.0], [peak]
    for to, slope in (
        (0.0, down), (-onset, stiff), (-onset - soft[0], soft_down), (-peak, stiff),
        (0.0, up), (onset, stiff), (onset + soft[1], soft_up), (peak, stiff),
    ):  # fmt: skip
        angle.append(angle[-1] + (to - torque[-1]) / slope)
        torque.append(to)
    return np.array(angle), np.array(torque)


def refined(angle: Array, torque: Array, step: float) -> tuple[Array, Array]:
    """Points along a polygon at steps of torque, its corners among them."""
    angles, torques = [angle[:1]], [torque[:1]]
    for (a, b), (t, u) in zip(pairwise(angle.tolist()), pairwise(torque.tolist()), strict=True):
        count = max(1, round(abs(u - t) / step))
        angles.append(np.linspace(a, b, count + 1)[1:])
        torques.append(np.linspace(t, u, count + 1)[1:])
    return np.concatenate(angles), np.concatenate(torques)


def loop_of_table(position: float = 0.0, step: float = 0.02, **more: Any) -> Loop:
    """The loop of a row of document T's table."""
    angle, torque = refined(*vertices(TABLE[position]), step)
    return Loop(angle, torque, side="input", name=f"{position:g} degrees", position=float(np.radians(position)), **more)


def shoelace(angle: Array, torque: Array) -> float:
    """Area of a polygon, point by point."""
    n = len(angle)
    return 0.5 * abs(sum(float(angle[i] * torque[(i + 1) % n] - angle[(i + 1) % n] * torque[i]) for i in range(n)))


def parallelogram(k: float, spring: float, slip: float, amplitude: float, points: int = 20) -> tuple[Array, Array]:
    """An element of stiffness k that slips at a torque, beside a spring, turned to and fro: Jenkin's element, from +A to +A."""
    turn = 2.0 * slip / k
    corners = np.array([amplitude, amplitude - turn, -amplitude, turn - amplitude, amplitude])
    held = np.array([slip, -slip, -slip, slip, slip])
    legs = [np.linspace(0.0, 1.0, points, endpoint=False)] * 4
    angle = np.concatenate([a + share * (b - a) for (a, b), share in zip(pairwise(corners.tolist()), legs, strict=True)])
    torque = np.concatenate([a + share * (b - a) for (a, b), share in zip(pairwise(held.tolist()), legs, strict=True)])
    angle, torque = np.append(angle, corners[-1]), np.append(torque, held[-1])
    return angle, torque + spring * angle


def straight(stiffness: float, width: float, peak: float, points: int) -> tuple[Array, Array]:
    """Two parallel straight branches, `width` apart in angle, between which the angle creeps at the peaks."""
    torque = np.linspace(peak, -peak, 2 * points + 1)
    down, up = torque / stiffness + 0.5 * width, torque[::-1] / stiffness - 0.5 * width
    return np.concatenate((down, up, down[:1])), np.concatenate((torque, torque[::-1], torque[:1]))


def quarters(unloading: float, loading: float, peak: float, points: int) -> tuple[Array, Array]:
    """A loop whose four regimes are straight: w = P (1/loading - 1/unloading) wide at zero torque, with the area P w."""
    angle = np.cumsum([0.0, -peak / unloading, -peak / loading, peak / unloading, peak / loading])
    return refined(angle, np.array([peak, 0.0, -peak, 0.0, peak]), peak / points)
