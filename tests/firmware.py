"""Exported controllers as other programs meet them: compiled, loaded, and called from Python."""

from __future__ import annotations

import ctypes
import subprocess
from pathlib import Path
from typing import Any

import strainwave as sw
from strainwave.export.firmware import FLAGS, INPUTS, Scalar
from strainwave.simulation.controller import Seen

from tests.cplusplus import compiler

STRICT = ("-Wall", "-Wextra", "-Wpedantic", "-Werror")


class Loaded:
    """A controller that was written as firmware, compiled and loaded; called with what a controller sees, as firmware is."""

    def __init__(self, drive: sw.Drive, folder: Path, scalar: Scalar) -> None:
        written = sw.export.firmware(drive, folder, scalar=scalar)
        options = [*FLAGS.split(), *STRICT, "-fPIC", "-shared", "-o", "controller.so", "controller.cpp", "-lm"]
        subprocess.run([*compiler("g++"), *options], cwd=folder, check=True)
        self.number: Any = ctypes.c_double if scalar == "double" else ctypes.c_float
        self.library = ctypes.CDLL(str(folder / "controller.so"))
        self.library.controller_step.restype = self.number
        self.memory = (self.number * len(written.state))()
        self.names = written.state
        self.start()

    def start(self) -> None:
        self.library.controller_start(self.memory)

    def __call__(self, seen: Seen) -> float:
        return float(self.library.controller_step(self.memory, (self.number * len(INPUTS))(*seen[1:])))

    @property
    def state(self) -> dict[str, float]:
        return dict(zip(self.names, self.memory, strict=True))


def run_with(controller: Any, drive: sw.Drive, command: Any) -> sw.Run:
    """A run of a drive with its sampled controller replaced by a function."""
    sampled = drive.control
    plant = drive.replace(control=sw.control.OpenLoop())
    return sw.simulate_controlled(plant, controller, command, period=sampled.period, delay=sampled.delay, sample=sampled.period)
