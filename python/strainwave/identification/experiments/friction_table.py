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
from strainwave.friction import Viscous
from strainwave.identification.experiments.experiment import Nuisance, sensible
from strainwave.statistics.linear_fit import solved

Array = NDArray[np.float64]
MAX_SPEEDS = 1_000  # of either sign in a table; a longer table is thinned
ROOM_TEMPERATURE = 293.15  # K, if no temperature was measured
CONDITIONS = {"angle": "rad", "load": "N.m", "temperature": "K"}  # that friction may depend on in addition to the speed
FRICTIONLESS = Viscous()
MAX_LOSS = 1.0  # of the torque transmitted: a gear that loses more cannot be turned from its output
EQUAL_LOADS = 1e-3  # relative: loads of one size
MIN_LOSS = 0.005  # of the torque transmitted: no gear is better; a smaller loss belongs to a load of the other shaft


@dataclass(frozen=True, eq=False)
class FrictionTable(ComparedByFields):
    """Steady friction torque at the input, measured at constant speeds.

    Args:
        speed: input speed [rad/s], shape (n,)
        torque: friction torque [N.m], of the sign of the speed, shape (n,)
        samples: count of those measured; more than are left in `speed` if each is the mean of several neighbours
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
        """Return a table of columns speed and torque of the input, and angle, load and temperature if present.

        A torque given as a magnitude takes the sign of its speed. Of a long table, means over neighbouring speeds are taken;
        of one with an angle, every so many rows.
        """
        check_recording("recording", recording)
        speed, torque = sensible(recording, "speed", "rad/s"), sensible(recording, "torque", "N.m")
        if np.any(speed == 0.0):
            row = int(np.argmin(np.abs(speed)))
            raise ValueError(f"sample {row} has speed 0: a table of steady sliding shows no friction at rest; leave it out")
        if np.any(speed < 0.0) and np.all(torque >= 0.0):
            torque = np.sign(speed) * torque
        if np.sum(speed * torque) <= 0.0:
            raise ValueError("the torque drives the motion instead of opposing it; give it the sign of the speed")
        conditions = {name: recording.values(name, unit) for name, unit in CONDITIONS.items() if name in recording.names}
        whole = cls(speed, torque, len(recording), **conditions)
        return whole if len(speed) <= MAX_SPEEDS else whole._thinned()

    def _thinned(self) -> FrictionTable:
        columns = {name: values for name in ("speed", "torque", *CONDITIONS) if (values := getattr(self, name)) is not None}
        if "angle" in columns:  # the mean of two angles is none
            rows = np.arange(0, len(self.speed), -(-len(self.speed) // (2 * MAX_SPEEDS)))
            chosen: dict[str, Any] = {name: values[rows] for name, values in columns.items()}
            return replace(self, **chosen)
        sides = [np.flatnonzero(side) for side in (self.speed < 0.0, self.speed > 0.0)]
        ordered = [side[np.argsort(self.speed[side], kind="stable")] for side in sides if len(side)]
        means = [thinned(*(values[side] for values in columns.values()), samples=MAX_SPEEDS) for side in ordered]
        joined = [np.concatenate(each) for each in zip(*means, strict=True)]
        thin: dict[str, Any] = dict(zip(columns, joined, strict=True))
        return replace(self, **thin)

    @classmethod
    def of_output(cls, recording: Recording, gear: Gear) -> FrictionTable:
        """Return a table of columns of the output, referred to the input by the ratio."""
        check_recording("recording", recording)
        ratio = abs(arguments.gear(gear).kinematics.ratio)
        units = {"speed": "rad/s", "torque": "N.m"} | {
            name: unit for name, unit in CONDITIONS.items() if name in recording.names
        }
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
        if model.friction_mesh == FRICTIONLESS:
            return torque[np.newaxis], slopes[:, np.newaxis]
        ratio, alone = model.kinematics.ratio, model.replace(friction_input=model.friction_mesh)
        paths = [path for path, *_ in _core.parameters(model)]
        there = {path: number for number, (path, *_) in enumerate(_core.parameters(alone))}
        of_mesh = [place for place, number in enumerate(numbers) if paths[number].startswith("friction_mesh.")]
        asked = [there[paths[numbers[place]].replace("friction_mesh", "friction_input")] for place in of_mesh]
        at_mesh, by_number = _core.differentiate_steady(
            alone, self.speed / ratio, angle / ratio, load * ratio, temperature, asked
        )
        slopes[of_mesh] += by_number / ratio
        return (torque + at_mesh / ratio)[np.newaxis], slopes[:, np.newaxis]


def with_load(recording: Recording, ratio: float, side: str | None = "input") -> tuple[Recording, tuple[str, ...]]:
    """Return a table with the column `load`, the torque transmitted at the side of the table, and what was assumed for it.

    A dynamometer measures the whole torque of the motor and that of the output, `output_torque`: friction is what the motor
    gives more than the output takes over the ratio. The output torque may be measured as the action or as the reaction: the
    sign is taken that leaves less unexplained with a loss from 0 to 1. A column `load_torque` of a table of friction is counted
    at the shaft where the loss that it causes is possible.

    Args:
        recording: speed and torque, and one of the two columns; without them it is returned as it is
        ratio: of the gear, its size
        side: at which speed and torque were measured
    """
    if side == "output":
        loads = [sensible(recording, name, "N.m") for name in ("load_torque", "output_torque") if name in recording]
        return (_loaded(recording, recording["torque"], loads[0]) if loads else recording), ()
    speed, torque = recording.values("speed", "rad/s"), recording.values("torque", "N.m")
    if "output_torque" in recording:
        at_output = sensible(recording, "output_torque", "N.m")
        tried = {sign: _plain(speed, torque - sign * at_output / ratio, at_output / ratio) for sign in (1.0, -1.0)}
        possible = [sign for sign, (loss, _) in tried.items() if -MIN_LOSS <= loss < MAX_LOSS]
        sign = min(possible or tried, key=lambda sign: tried[sign][1])
        load = sign * at_output / ratio
        remark = f"friction is the torque of the motor less that of the output over the ratio of {ratio:g}"
        turned = ", which is measured as the reaction: its sign is turned" if sign < 0.0 else ""
        return _loaded(recording, torque - load, load), (f"{remark}{turned}", *_of_driving(speed, load))
    if "load_torque" not in recording:
        return recording, ()
    load = sensible(recording, "load_torque", "N.m")
    if not varies(load):
        held = f"{np.abs(load).max():.4g} N·m"
        loss = "is part of the Coulomb torque" if load.any() else "is not determined"
        remark = f"all its rows are at one load of {held}: the loss under load {loss}; record two loads or more"
        return _loaded(recording, torque, load / ratio), (remark,)
    loss_per_load, _ = _plain(speed, np.sign(speed) * np.abs(torque), load)
    at_input = MIN_LOSS <= loss_per_load < MAX_LOSS or not MIN_LOSS <= ratio * loss_per_load < MAX_LOSS
    side, other = ("input", "output") if at_input else ("output", "input")
    losses = (loss_per_load, loss_per_load * ratio) if at_input else (loss_per_load * ratio, loss_per_load)
    remark = f"the load is counted at the {side}: the loss is {losses[0]:.3g} of it; it would be {losses[1]:.3g} at the {other}"
    return _loaded(recording, torque, load if at_input else load / ratio), (remark,)


def varies(load: Array) -> bool:
    """True if a table has loads of different size, which alone determine a loss."""
    size = np.abs(load)
    return bool(np.ptp(size) > EQUAL_LOADS * size.max())


def _loaded(recording: Recording, torque: Array, load: Array) -> Recording:
    columns = {name: recording[name] for name in recording.names if name not in ("output_torque", "load_torque")}
    units = {name: recording.unit(name) for name in columns} | {"torque": "N.m", "load": "N.m"}
    return Recording(columns | {"torque": torque, "load": load}, units, recording.title)


def _plain(speed: Array, torque: Array, load: Array) -> tuple[float, float]:
    """Return the loss per load [1] by plain least squares, and the sum of squares left [N2.m2]."""
    way = np.sign(speed)
    columns = np.stack([way, speed, way * np.abs(load)], axis=1)
    coefficients = solved(columns, torque)
    return float(coefficients[2]), float(np.sum((torque - columns @ coefficients) ** 2))


def _of_driving(speed: Array, load: Array) -> tuple[str, ...]:
    """Return what a dynamometer leaves open if the power flows one way only."""
    power = speed * load
    if power.min() < -0.05 * np.abs(power).max() and power.max() > 0.05 * np.abs(power).max():
        return ()
    return (
        "the power flows one way only: the loss rests on the ratio and on the scales of both torques, of which an error of 1 % "
        "changes it by 0.01",
    )
