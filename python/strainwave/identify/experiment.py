"""Measurements as experiments: each knows what a model predicts for it, with exact derivatives by the model's parameters."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, ClassVar, Literal, Protocol

import numpy as np
from numpy.typing import NDArray

from strainwave import _core, arguments, loads, scenario
from strainwave._core import Gear
from strainwave.drives import PositionDrive
from strainwave.recording import Recording
from strainwave.simulation import differentiate

Array = NDArray[np.float64]
ENCODERS = ("input_angle", "output_angle")
HANGING = 0.02  # rad: where gravity is nothing beside friction


@dataclass(frozen=True)
class Nuisance:
    """An unknown of the measurement itself, such as the zero of an angle: fitted along, of no interest.

    Attributes:
        name: what it is
        unit: its unit
        start: where a fit starts
    """

    name: str
    unit: str
    start: float


class Experiment(Protocol):
    """What was measured, and what a model says to it.

    Attributes:
        channels: names of the quantities compared
        units: unit of each channel
        measured: measured values, shape (channels, n)
        nuisances: unknowns of the measurement
    """

    @property
    def channels(self) -> tuple[str, ...]: ...
    @property
    def units(self) -> tuple[str, ...]: ...
    @property
    def measured(self) -> Array: ...
    @property
    def nuisances(self) -> tuple[Nuisance, ...]: ...

    def predict(self, model: Any, numbers: Sequence[int], nuisances: Array) -> tuple[Array, Array]:
        """Predicted values, shape (channels, n), and derivatives, shape (numbers + nuisances, channels, n)."""
        ...


@dataclass(frozen=True)
class FrictionTable:
    """Steady friction torque at the input, measured at constant speeds.

    Args:
        speed: input speed [rad/s], shape (n,)
        torque: friction torque [N.m], of the sign of the speed, shape (n,)
    """

    speed: Array
    torque: Array
    channels = ("torque",)
    units = ("N.m",)
    nuisances: ClassVar[tuple[Nuisance, ...]] = ()

    @classmethod
    def of(cls, recording: Recording) -> FrictionTable:
        """From columns speed and torque; a torque given as a magnitude takes the sign of its speed."""
        speed, torque = recording.values("speed", "rad/s"), recording.values("torque", "N.m")
        if np.any(speed == 0.0):
            row = int(np.argmin(np.abs(speed)))
            raise ValueError(f"sample {row} has speed 0: a table of steady sliding cannot say what holds at rest; leave it out")
        if np.any(speed < 0.0) and np.all(torque >= 0.0):
            torque = np.sign(speed) * torque
        if np.sum(speed * torque) <= 0.0:
            raise ValueError("the torque drives the motion instead of opposing it; give it the sign of the speed")
        return cls(speed, torque)

    @property
    def measured(self) -> Array:
        return self.torque[np.newaxis]

    def predict(self, model: Gear, numbers: Sequence[int], nuisances: Array) -> tuple[Array, Array]:
        torque, slopes = _core.differentiate_steady(model, self.speed, list(numbers))
        return torque[np.newaxis], slopes[:, np.newaxis]


@dataclass(frozen=True)
class TorsionLoop:
    """Torque over twist along a path, slow enough that only spring and hysteresis speak.

    Where the zeros of both axes lie is not known from a loop, so both are unknowns of the measurement. A linear spring cannot
    tell them apart; for it the zero of the twist is taken as known.

    Args:
        twist: twist at the output [rad], shape (n,), monotone between its points
        torque: torque at the output [N.m], shape (n,)
        history: cyclic, if the same path had been run before; virgin, if the gear had not been loaded before
        torque_zero: where a fit starts to look for the zero of the torque [N.m]
        twist_zero: zero of the twist, if it is known [rad]
    """

    twist: Array
    torque: Array
    history: Literal["cyclic", "virgin"] = "cyclic"
    torque_zero: float = 0.0
    twist_zero: float | None = None
    channels = ("torque",)
    units = ("N.m",)

    @classmethod
    def of(cls, recording: Recording, gear: Gear) -> TorsionLoop:
        """From columns twist and torque at the output, or input_angle and input_torque with the output locked.

        What was measured at the input is referred to the output: twist = input_angle / i, torque = i input_torque.
        """
        if at_input(recording):
            ratio = gear.kinematics.ratio
            return cls(recording.values("input_angle", "rad") / ratio, ratio * recording.values("input_torque", "N.m"))
        return cls(recording.values("twist", "rad").copy(), recording.values("torque", "N.m").copy())

    def __post_init__(self) -> None:
        turns = np.diff(np.sign(np.diff(self.twist[np.flatnonzero(np.diff(self.twist, prepend=np.nan))])))
        if np.ptp(self.twist) == 0.0 or not np.any(turns):
            raise ValueError(
                "the torsion loop has one branch only: its twist never turns back, so stiffness and hysteresis cannot be "
                "told apart; a loop must load and unload"
            )

        span = float(np.ptp(self.twist) * np.ptp(self.torque))
        if np.cov(self.twist, self.torque)[0, 1] < 0.0:
            raise ValueError("the torque falls as the twist grows; give both the same sense, as an elastic gear has them")
        closed = abs(self.twist[-1] - self.twist[0]) < 0.05 * np.ptp(self.twist)
        if closed and np.trapezoid(self.torque, self.twist) < -0.01 * span:
            raise ValueError("the loop gives energy instead of losing it; its samples must follow each other as measured")

    @property
    def measured(self) -> Array:
        return self.torque[np.newaxis]

    @property
    def nuisances(self) -> tuple[Nuisance, ...]:
        torque = Nuisance("torque_zero", "N.m", self.torque_zero)
        return (torque,) if self.twist_zero is not None else (torque, Nuisance("twist_zero", "rad", self.middle))

    @cached_property
    def middle(self) -> float:
        """Twist half way between the ends of the loop [rad]."""
        return 0.5 * float(self.twist.min() + self.twist.max())

    def path(self, twist_zero: float) -> Array:
        """The twist from its zero, where the gear is virgin, with the run before that a cyclic history needs."""
        path = self.twist - twist_zero
        return np.concatenate(([0.0], path, path)) if self.history == "cyclic" else np.concatenate(([0.0], path))

    def predict(self, model: Gear, numbers: Sequence[int], nuisances: Array) -> tuple[Array, Array]:
        torque_zero, twist_zero = (*nuisances, self.twist_zero)[:2]
        n = len(self.twist)
        torque, slopes = _core.differentiate_loop(model, self.path(twist_zero), list(numbers))
        *by_numbers, by_shift = slopes[:, -n:]
        by_zeros = (np.ones(n), -by_shift)[: len(nuisances)]
        return torque[np.newaxis, -n:] + torque_zero, np.stack((*by_numbers, *by_zeros))[:, np.newaxis]

    def virgin(self) -> TorsionLoop:
        """The same measurement, taken to be the first loading."""
        return replace(self, history="virgin")


def at_input(recording: Recording) -> bool:
    """Whether a torsion loop was measured at the input, with the output locked."""
    return not {"twist", "torque"} <= set(recording.names)


@dataclass(frozen=True)
class DriveLog:
    """What a drive did under a known command, starting at rest.

    Where the encoders have their zeros is not known, so these are unknowns of the measurement; a commanded angle counts from
    where it starts.

    Args:
        time: instants [s], beginning with 0, shape (n,)
        command: in the unit that the drive's control takes, shape (n,)
        channels: names of the columns to compare, as `simulate` names them
        measured: their values in the units of a simulation, shape (channels, n)
        dt: step of the simulation [s]
    """

    time: Array
    command: Array
    channels: tuple[str, ...]
    measured: Array
    dt: float

    @classmethod
    def of(
        cls, recording: Recording, drive: PositionDrive, channels: Sequence[str] | None = None, dt: float | None = None
    ) -> DriveLog:
        """From columns time, command and outputs; all that a simulation has too, unless `channels` names some.

        Steps of 0.2 ms, or the sample interval if that is shorter.
        """
        for name in ("time", "command"):
            if name not in recording:
                raise ValueError(f'a drive log needs a column "{name}"; this one has {", ".join(recording.names)}')
        known = {name: unit for name, unit, _ in _core.outputs if name != "command"}
        wanted = [name for name in recording.names if name in known] if channels is None else channels
        chosen = tuple(arguments.names("channels", wanted))
        for name in chosen:
            if name not in known or name not in recording:
                raise ValueError(f'a drive log cannot be compared by "{name}"; it can by {", ".join(known)}')
        if not chosen:
            raise ValueError(f"a drive log needs a measured column to compare; one of {', '.join(known)}")
        _check_hanging(recording, drive, chosen)
        command = recording.values("command", drive.control.command_unit)
        time = recording.time - recording.time[0]
        interval = float(np.min(np.diff(time)))
        return cls(
            time,
            command - command[0] if drive.control.command_unit == "rad" else command.copy(),
            chosen,
            np.stack([recording.values(name, known[name]) for name in chosen]),
            min(2e-4, interval) if dt is None else arguments.seconds("dt", dt),
        )

    @property
    def units(self) -> tuple[str, ...]:
        known = {name: unit for name, unit, _ in _core.outputs}
        return tuple(known[name] for name in self.channels)

    @property
    def nuisances(self) -> tuple[Nuisance, ...]:
        return tuple(
            Nuisance(f"{name}_zero", "rad", float(self.measured[row, 0]))
            for row, name in enumerate(self.channels)
            if name in ENCODERS
        )

    def predict(self, model: PositionDrive, numbers: Sequence[int], nuisances: Array) -> tuple[Array, Array]:
        command = scenario.table(self.time, self.command)
        names = [name for name, _, _ in _core.outputs]
        run, slopes = differentiate(model, command, numbers, self.dt, self.time)
        predicted = np.stack([run[name] for name in self.channels])
        by_zero = np.zeros((len(nuisances), *predicted.shape))
        encoders = [row for row, name in enumerate(self.channels) if name in ENCODERS]
        for unknown, (row, zero) in enumerate(zip(encoders, nuisances, strict=True)):
            predicted[row] += zero
            by_zero[unknown, row] = 1.0
        return predicted, np.concatenate((slopes[:, [names.index(name) for name in self.channels]], by_zero))


def _check_hanging(recording: Recording, drive: PositionDrive, channels: Sequence[str]) -> None:
    """A run starts at output angle 0; under gravity, so must the log."""
    if not isinstance(drive.load, loads.Pendulum) or drive.load.gravity_torque == 0.0:
        return
    starts = {
        name: float(recording.values(name, "rad")[0]) / (drive.gear.kinematics.ratio if name == "input_angle" else 1.0)
        for name in channels
        if name in ENCODERS
    }
    for name, start in starts.items():
        if abs(start) > HANGING:
            raise ValueError(
                f"a log under gravity must start with the arm hanging, at output angle 0; "
                f"by {name} it starts at {start:.3g} rad"
            )
