"""Picture of a gear: twist over torque, and friction over speed."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from strainwave import Gear
from strainwave.drawing import marks
from strainwave.drawing.style import LIGHT

if TYPE_CHECKING:
    from matplotlib.figure import Figure

FASTEST_DRAWN_SPEED = 200.0  # rad/s of the input: 1900 rpm, where most gears are rated
FRICTION_SHARE = 5.0  # torque over that of friction at the input, times the ratio: about that of the rated torque
HYSTERESIS_SHARE = 10.0  # torque over half the width of the loop
KNEE_SHARE = 1.3  # torque over that of the last knee
USUAL_TWIST = 1e-3  # rad, of a gear without friction, hysteresis and knees
BRANCH_POINTS = 200  # of a branch


def gear_figure(gear: Gear, title: str) -> Figure:
    """Return the figure of a gear: the loop of twist over torque, and friction at the input over speed."""
    beginning = np.linspace(0.0, 1.0, BRANCH_POINTS)
    loop_of_torque = np.concatenate([np.linspace(1.0, -1.0, BRANCH_POINTS), np.linspace(-1.0, 1.0, BRANCH_POINTS)])
    largest = _largest_torque(gear)
    torque = largest * loop_of_torque
    twist = np.asarray(gear.twist(largest * np.concatenate([beginning, loop_of_torque])))[BRANCH_POINTS:]
    speed = np.linspace(0.005 * FASTEST_DRAWN_SPEED, FASTEST_DRAWN_SPEED, BRANCH_POINTS)
    with marks.new_figure(4.2, title) as figure:
        loop, friction = figure.subplots(2, 1)
        loop.plot(torque, twist, color=LIGHT["measured"])
        friction.plot(speed, np.asarray(gear.friction_input.steady(speed)), color=LIGHT["model"])
        friction.set_ylim(bottom=0.0)
        marks.label_axes(loop, "twist", "rad", "torque of the output", "N.m")
        marks.label_axes(friction, "friction at the input", "N.m", "speed of the input", "rad/s")
    return figure


def _largest_torque(gear: Gear) -> float:
    """Return a torque that shows the knees, the loop and about the rated load of a gear [N.m]."""
    ratio = abs(float(gear.kinematics.ratio))
    knee = float(getattr(gear.stiffness, "t2", 0.0))
    friction = ratio * float(gear.friction_input.steady(0.1 * FASTEST_DRAWN_SPEED))
    loop = 0.5 * float(np.ptp(gear.hysteresis.trace(np.array([0.0, 1e-2, 0.0]))))
    shown = max(KNEE_SHARE * knee, FRICTION_SHARE * friction, HYSTERESIS_SHARE * loop)
    return shown or float(gear.stiffness.torque(USUAL_TWIST))
