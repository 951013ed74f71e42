"""Steady friction torque over speed, as an experiment."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from strainwave import _core, arguments
from strainwave._core import Gear
from strainwave.equality import ComparedByFields
from strainwave.files.recording import Recording, check_recording
from strainwave.identification.experiments.branches import thinned
from strainwave.identification.experiments.experiment import Nuisance, sensible

Array = NDArray[np.float64]
TABLE = 1_000  # speeds of either sign in a table, at most


@dataclass(frozen=True, eq=False)
class FrictionTable(ComparedByFields):
    """Steady friction torque at the input, measured at constant speeds.

    Args:
        speed: input speed [rad/s], shape (n,)
        torque: friction torque [N.m], of the sign of the speed, shape (n,)
        samples: how many were measured; more than are left in `speed` where each is the mean of several neighbours
    """

    speed: Array
    torque: Array
    samples: int = 0
    channels = ("torque",)
    units = ("N.m",)
    nuisances: ClassVar[tuple[Nuisance, ...]] = ()

    @classmethod
    def of(cls, recording: Recording) -> FrictionTable:
        """From columns speed and torque of the input; a torque given as a magnitude takes the sign of its speed.

        Of a long table, means over neighbouring speeds are taken.
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
        sides = [np.flatnonzero(side)[np.argsort(speed[side], kind="stable")] for side in (speed < 0.0, speed > 0.0)]
        neighbours = [thinned(speed[side], torque[side], samples=TABLE) for side in sides if len(side)]
        if len(speed) > TABLE:
            speed, torque = (np.concatenate(each) for each in zip(*neighbours, strict=True))
        return cls(speed, torque, len(recording))

    @classmethod
    def of_output(cls, recording: Recording, gear: Gear) -> FrictionTable:
        """From columns speed and torque of the output, as a joint measures its friction, referred to the input by the ratio."""
        check_recording("recording", recording)
        ratio = abs(arguments.gear(gear).kinematics.ratio)
        speed, torque = ratio * recording.values("speed", "rad/s"), recording.values("torque", "N.m") / ratio
        return cls.of(Recording({"speed": speed, "torque": torque}, {"speed": "rad/s", "torque": "N.m"}))

    @property
    def measured(self) -> Array:
        return self.torque[np.newaxis]

    def predict(self, model: Gear, numbers: Sequence[int], nuisances: Array) -> tuple[Array, Array]:
        torque, slopes = _core.differentiate_steady(model, self.speed, list(numbers))
        return torque[np.newaxis], slopes[:, np.newaxis]
