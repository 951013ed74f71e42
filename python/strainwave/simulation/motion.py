"""A motion of the input shaft that was measured, as what a drive is run along."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from numpy.typing import ArrayLike

from strainwave import arguments
from strainwave.equality import ComparedByFields
from strainwave.simulation.scenario import Scenario, table

MIN_INSTANTS = 4  # of a cubic spline


@dataclass(frozen=True, eq=False)
class InputMotion(ComparedByFields):
    """Motion of the input shaft of a drive with an `AccelerationSource`, as arguments of a run.

    Args:
        command: acceleration [rad/s2]
        initial: input angle [rad] and input speed [rad/s] at the begin

    >>> import numpy as np, strainwave as sw
    >>> from strainwave.simulation.motion import InputMotion
    >>> time = np.linspace(0.0, 1.0, 201)
    >>> turned = InputMotion.through(time, 50.0 * time**3)
    >>> drive = sw.Drive(motor=sw.motor.AccelerationSource(inertia=1e-4), load=sw.loads.Inertia(inertia=0.1))
    >>> run = sw.simulate(drive, turned.command, initial=turned.initial)
    >>> float(run["input_angle"][-1].round(9)), float(run["input_speed"][-1].round(6))
    (50.0, 150.0)
    """

    command: Scenario
    initial: Mapping[str, float]

    @classmethod
    def through(cls, time: ArrayLike, angle: ArrayLike, *, from_rest: bool = False) -> InputMotion:
        """Return the motion through angles by the cubic spline, whose acceleration is linear from one instant to the next.

        The angle passes through all of them, so that their noise should be gone before: it is differentiated twice.

        Args:
            time: instants [s], shape (n,), n >= 4, increasing from 0
            angle: of the input [rad], shape (n,)
            from_rest: whether it begins with a speed of 0: bristles then are not bent; else with the speed of the angles

        Raises:
            ValueError: lengths differ, a number is not finite, the times do not increase from 0, or they are too few
        """
        from scipy.interpolate import CubicSpline

        instants, angles = arguments.numbers("motion.time", time), arguments.numbers("motion.angle", angle)
        if len(instants) < MIN_INSTANTS or instants.shape != angles.shape:
            raise ValueError(
                f"motion.time and motion.angle must hold the same number of values, at least {MIN_INSTANTS}; they hold "
                f"{instants.size} and {angles.size}"
            )
        table(instants, angles)  # refuses what is no series from 0 on
        spline = CubicSpline(instants, angles, bc_type=("clamped" if from_rest else "not-a-knot", "not-a-knot"))
        return cls(
            table(instants, spline(instants, 2)),
            {"input_angle": float(angles[0]), "input_speed": 0.0 if from_rest else float(spline(0.0, 1))},
        )
