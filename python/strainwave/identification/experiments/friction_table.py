"""Steady friction torque over speed, as an experiment."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from strainwave import _core, arguments
from strainwave._core import Gear
from strainwave.analysis.branches import thinned
from strainwave.equality import ComparedByFields
from strainwave.files.recording import Recording, check_recording
from strainwave.identification.experiments.experiment import Nuisance, sensible

Array = NDArray[np.float64]
TABLE = 1_000  # speeds of either sign in a table, at most
ROOM_TEMPERATURE = 293.15  # K: where no temperature was measured
BESIDE = {"angle": "rad", "load": "N.m", "temperature": "K"}  # what else may tell friction, and its unit


@dataclass(frozen=True, eq=False)
class FrictionTable(ComparedByFields):
    """Steady friction torque at the input, measured at constant speeds.

    Args:
        speed: input speed [rad/s], shape (n,)
        torque: friction torque [N.m], of the sign of the speed, shape (n,)
        samples: how many were measured; more than are left in `speed` where each is the mean of several neighbours
        angle: input angle [rad], shape (n,), if it was measured
        load: torque that the input transmits [N.m], shape (n,), if it was measured: the output's over the ratio; load times
            speed is the power that flows to the output
        temperature: temperature of the gear [K], shape (n,), if it was measured
    """

    speed: Array
    torque: Array
    samples: int = 0
    angle: Array | None = None
    load: Array | None = None
    temperature: Array | None = None
    channels = ("torque",)
    units = ("N.m",)
    nuisances: ClassVar[tuple[Nuisance, ...]] = ()

    @classmethod
    def of(cls, recording: Recording) -> FrictionTable:
        """From columns speed and torque of the input, and angle, load and temperature where there are such.

        A torque given as a magnitude takes the sign of its speed. Of a long table, means over neighbouring speeds are taken;
        where an angle is beside it, every so many rows.
        """
        check_recording("recording", recording)
        speed, torque = sensible(recording, "speed", "rad/s"), sensible(recording, "torque", "N.m")
        if np.any(speed == 0.0):
            row = int(np.argmin(np.abs(speed)))
            raise ValueError(f"sample {row} has speed 0: a table of steady sliding cannot say what holds at rest; leave it out")
        if np.any(speed < 0.0) and np.all(torque >= 0.0):
            torque = np.sign(speed) * torque
        if np.sum(speed * torque) <= 0.0:
            raise ValueError("the torque drives the motion instead of opposing it; give it the sign of the speed")
        beside = {name: recording.values(name, unit) for name, unit in BESIDE.items() if name in recording.names}
        whole = cls(speed, torque, len(recording), **beside)
        return whole if len(speed) <= TABLE else whole._thinned()

    def _thinned(self) -> FrictionTable:
        columns = {name: values for name in ("speed", "torque", *BESIDE) if (values := getattr(self, name)) is not None}
        if "angle" in columns:  # the mean of two angles is none
            rows = np.arange(0, len(self.speed), -(-len(self.speed) // (2 * TABLE)))
            taken: dict[str, Any] = {name: values[rows] for name, values in columns.items()}
            return replace(self, **taken)
        sides = [np.flatnonzero(side) for side in (self.speed < 0.0, self.speed > 0.0)]
        ordered = [side[np.argsort(self.speed[side], kind="stable")] for side in sides if len(side)]
        means = [thinned(*(values[side] for values in columns.values()), samples=TABLE) for side in ordered]
        joined = [np.concatenate(each) for each in zip(*means, strict=True)]
        thin: dict[str, Any] = dict(zip(columns, joined, strict=True))
        return replace(self, **thin)

    @classmethod
    def of_output(cls, recording: Recording, gear: Gear) -> FrictionTable:
        """From columns of the output, as a joint measures its friction, referred to the input by the ratio."""
        check_recording("recording", recording)
        ratio = abs(arguments.gear(gear).kinematics.ratio)
        units = {"speed": "rad/s", "torque": "N.m"} | {name: unit for name, unit in BESIDE.items() if name in recording.names}
        factor = {"speed": ratio, "angle": ratio, "torque": 1.0 / ratio, "load": 1.0 / ratio, "temperature": 1.0}
        return cls.of(Recording({name: factor[name] * recording.values(name, unit) for name, unit in units.items()}, units))

    @property
    def measured(self) -> Array:
        return self.torque[np.newaxis]

    def predict(self, model: Gear, numbers: Sequence[int], nuisances: Array) -> tuple[Array, Array]:
        none = np.zeros_like(self.speed)
        angle, load = (none if values is None else values for values in (self.angle, self.load))
        temperature = none + ROOM_TEMPERATURE if self.temperature is None else self.temperature
        torque, slopes = _core.differentiate_steady(model, self.speed, angle, load, temperature, list(numbers))
        return torque[np.newaxis], slopes[:, np.newaxis]
