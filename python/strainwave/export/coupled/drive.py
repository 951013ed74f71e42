"""A drive whose output shaft another program moves: its sources, how stiffly it holds that shaft, its library, its losses."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from importlib import resources
from math import sqrt
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive, _core, loads, structure
from strainwave.export.fmu.build import moving_run
from strainwave.export.fmu.source import drive_sources, variables
from strainwave.native.compilers import FLAGS, Compiler, find_compiler
from strainwave.simulation.excitation import ROOM_TEMPERATURE
from strainwave.simulation.signals import command_unit, outputs
from strainwave.tuning.loss import ExportLoss

Array = NDArray[np.float64]
TORQUE_LEVELS = (-1.0, -0.5, 0.0, 0.5, 1.0)  # of the largest torque, at which the stiffness is evaluated
SMALL_ANGLE = 1e-8  # rad, of the output, over which it is a difference
SMALL_SPEED = 1.0  # rad/s, likewise of the damping
MAX_STABLE_SHARE = 0.25  # of the longest stable timestep: a default is not longer
TORQUE = [name for name, _, _ in _core.quantities].index("torque")
SUFFIXES = {"linux": ".so", "darwin": ".dylib"}
LIBRARIES = "-Wl,--as-needed", "-Wl,-z,defs", "-lm", "-ldl"
COMPARED_DURATION = 1.0  # s, of the run
COMPARED_SAMPLES = 100  # of the run
REFERENCE_STEP_SHARE = 0.25  # of the internal step: step of the simulation


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


def shared_library(sources: Mapping[str, str], main: str, flags: Sequence[str] = ()) -> bytes:
    """Return the shared library of C++ sources.

    Args:
        sources: texts by their names
        main: name of the one that is compiled; it includes the others
        flags: of the compiler, besides its own

    Raises:
        NoCompilerError: there is no compiler
        CompileError: the compiler reports an error
    """
    compiler = find_compiler()
    with TemporaryDirectory() as folder:
        for path, text in sources.items():
            target = Path(folder, path)
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_text(text, "utf-8")
        return compiler.build(Path(folder, main), (*FLAGS, f"-I{folder}", *flags), _libraries(compiler)).read_bytes()


def _libraries(compiler: Compiler) -> tuple[str, ...]:
    """Return the libraries to link; those of zig and of macOS find functions in what the process has loaded."""
    if sys.platform == "darwin":
        return ("-undefined", "dynamic_lookup")
    return () if compiler.name == "zig c++" else LIBRARIES


def losses(
    drive: Drive, inertia: float, step: float, exchange: float, words: str, moved: Callable[[float, float, float, int], Array]
) -> Iterator[ExportLoss]:
    """Yield the loss of the output angle over a step of the command, at an interval of exchange and at half of it.

    Args:
        drive: whose load the inertia replaces
        inertia: at the output [kg.m²]
        step: internal step of the drive [s]
        exchange: interval at which angle and torque are exchanged [s]
        words: name of that interval in the other program
        moved: function that returns the angles at the samples of the run [rad], of the command, the angle at the begin, the
            interval of exchange, and the number of intervals from sample to sample
    """
    drive = drive.replace(load=loads.Inertia(inertia=inertia))
    interval = max(1, round(COMPARED_DURATION / COMPARED_SAMPLES / exchange)) * exchange
    duration = COMPARED_SAMPLES * interval
    size, run = moving_run(drive, duration, REFERENCE_STEP_SHARE * min(step, exchange), interval)
    angle = run["output_angle"]
    for halvings in (0, 1):
        every = round(interval / exchange) * 2**halvings
        apart = interval / every
        error = moved(size, float(angle[0]), apart, every) - angle
        over = f"a step of the command by {size:g} {command_unit(drive)}, {duration:.3g} s, {words} {1e3 * apart:.3g} ms"
        yield ExportLoss.between("output_angle", error, "rad", float(np.ptp(angle)), over)
