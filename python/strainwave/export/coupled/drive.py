"""A drive whose output shaft another program moves: its sources, and how stiffly it holds that shaft."""

from __future__ import annotations

from dataclasses import dataclass
from importlib import resources
from math import sqrt

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive, _core, loads, structure
from strainwave.export.fmu.source import drive_sources
from strainwave.export.fmu.variables import variables
from strainwave.simulation.excitation import ROOM_TEMPERATURE
from strainwave.simulation.signals import outputs

Array = NDArray[np.float64]
TORQUE_LEVELS = (-1.0, -0.5, 0.0, 0.5, 1.0)  # of the largest torque, at which the stiffness is evaluated
SMALL_ANGLE = 1e-8  # rad, of the output, over which it is a difference
SMALL_SPEED = 1.0  # rad/s, likewise of the damping
MAX_STABLE_SHARE = 0.25  # of the longest stable timestep: a default is not longer
TORQUE = [name for name, _, _ in _core.quantities].index("torque")


@dataclass(frozen=True)
class CoupledDrive:
    """A drive whose output shaft another program moves.

    Attributes:
        drive: with a load that prescribes the motion
        hold: largest torque by which friction holds the output at rest [N.m]; the other program has dry friction of this size
        stiffness: largest torque per angle of the output while all else stands still [N.m/rad]
        damping: likewise per speed [N.m.s/rad]
    """

    drive: Drive
    hold: float
    stiffness: float
    damping: float

    @classmethod
    def of(cls, drive: Drive, max_torque: float) -> CoupledDrive:
        """Return a drive with its load replaced by a motion from outside.

        Args:
            drive: whose load is left out
            max_torque: at the output, up to which the stiffness is evaluated [N.m]
        """
        prescribed = drive.replace(load=loads.Prescribed())
        friction = drive.gear.friction_output
        levels = [max_torque * level for level in TORQUE_LEVELS]
        # Bodies within the gear are in series with its spring: without them the shaft is held at least as stiffly.
        lumped = prescribed.replace(gear=drive.gear.replace(structure=structure.Lumped()))
        slopes = [_slope(lumped, level, sense * SMALL_ANGLE, 0.0) for level in levels for sense in (-1.0, 1.0)]
        damping = _slope(lumped, 0.0, 0.0, SMALL_SPEED)
        return cls(prescribed, float(friction.hold()) if friction.set_valued else 0.0, max(slopes), max(damping, 0.0))

    def max_timestep(self, inertia: float) -> float:
        """Return the longest stable timestep [s] before an inertia [kg.m²], as the C++ function of this name."""
        return (sqrt(self.damping**2 + 4.0 * self.stiffness * inertia) - self.damping) / self.stiffness

    def sources(self, name: str, step: float, source: str, prefix: str = "drive", follows: bool = False) -> dict[str, str]:
        """Return C++ sources by their names.

        Args:
            name: of the drive in its program
            step: largest internal step [s]
            source: name of the file that makes the drive a part of that program, in the folder of this module
            prefix: of functions in C
            follows: whether a command without a rate goes on at that since the last call
        """
        folder = resources.files("strainwave.export.coupled")
        others = {each: folder.joinpath(each).read_text("utf-8") for each in ("coupled.hpp", source)}
        others["coupling.hpp"] = f"""#pragma once
#define SW_NAME(function) {prefix}_##function

namespace coupled {{

inline constexpr char plugin_name[] = "{name}";
inline constexpr double hold = {self.hold!r};            // N.m
inline constexpr double stiffness = {self.stiffness!r};  // N.m/rad
inline constexpr double damping = {self.damping!r};      // N.m.s/rad

}}  // namespace coupled
"""
        return drive_sources(self.drive, variables(self.drive, step), others, follows=follows)[0]


def _slope(drive: Drive, torque: float, angle: float, speed: float) -> float:
    """Return how much the torque at the output falls per angle or speed of the shaft, all else as at rest under a torque.

    Args:
        drive: whose output is moved from outside
        torque: that it transmits [N.m]
        angle, speed: by which the output is moved [rad, rad/s]; one of them is 0
    """
    still = np.array([0.0, 0.0, 0.0, 0.0, ROOM_TEMPERATURE, 0.0])
    moved = still + np.array([0.0, 0.0, angle, speed, 0.0, 0.0])
    further = moved + np.array([0.0, 0.0, 0.0, speed, 0.0, 0.0])  # at a speed friction slips, at rest it may stick
    numbers = _core.started(drive, [TORQUE], np.array([torque]), still)
    channel = outputs(drive)["load_torque"].channel
    before, after = (moved, further) if speed else (still, moved)
    first, second = (float(_core.now(drive, numbers, each)[channel, 0]) for each in (before, after))
    return (first - second) / (angle or speed)
