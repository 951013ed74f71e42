"""Torsion loops whose width is that of dry friction and of a share of the load."""

from __future__ import annotations

import numpy as np
import strainwave as sw

UNITS = {"twist": "rad", "torque": "N.m", "input_angle": "rad", "input_torque": "N.m", "time": "s"}
RATIO, STIFFNESS = -100.0, 2e4
GEAR = sw.load("hfuc-25-100")


def loss_loop(reach: float, *, at_input: bool, dry: float = 0.4, mesh: float = 0.03, bearing: float = 6e-3) -> sw.Recording:
    """Return two cycles whose width is that of dry friction and of a share of the load."""
    way = np.sin(np.linspace(0.5, 4.5, 801) * np.pi)
    half = dry + mesh * np.abs(reach * way) + at_input * bearing * abs(RATIO)
    twist, torque = reach / STIFFNESS * way, reach * way + half * np.sign(np.gradient(way))
    series = {"input_angle": RATIO * twist, "input_torque": torque / RATIO} if at_input else {"twist": twist, "torque": torque}
    return sw.Recording(series, {name: UNITS[name] for name in series})
