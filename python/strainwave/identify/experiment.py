"""Measurements as experiments: each knows what a model predicts for it, with exact derivatives by the model's parameters."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, ClassVar, Literal, Protocol

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive, _core, arguments, loads
from strainwave._core import Gear
from strainwave.equality import ComparedByFields
from strainwave.files.recording import Recording, check_recording
from strainwave.identify.branches import monotone, slid, thinned, turning_points
from strainwave.messages import listed, quoted
from strainwave.simulation import scenario
from strainwave.simulation.excitation import Excitation
from strainwave.simulation.resolution import fine_enough
from strainwave.simulation.run import differentiate
from strainwave.simulation.scenario import Scenario
from strainwave.simulation.signals import command_unit, controls_position, outputs

Array = NDArray[np.float64]
ENCODERS = ("input_angle", "output_angle")
HANGING = 0.02  # rad: where gravity is nothing beside friction
RESTING = 0.02  # of the largest speed: a log that starts faster does not start at rest
STILL = 1e-3  # of the range measured: what moves less stands still
TABLE = 1_000  # speeds of either sign in a table, at most
SENSIBLE = (1e-9, 1e9)  # the largest of a quantity that was measured on a gear, in SI units, lies between
COMPARED = 20_000  # samples of a log, at most: of a longer one every so many, the command in full
STEP = 2e-4  # s, of the simulation; what was recorded more often is compared every so many rows
SHORTEST = 1e-5  # s, of a step that a fit takes without being asked to
SHORTER = 0.25  # of the step that a drive needs at the start of a fit: one on the way that needs less is not taken
STRAIGHT = 1e-6  # of the range of a command, a resolution of 20 bits: what deviates less from a line is one
STEPS = 100_000  # of a log, at most: of a longer one the beginning is taken


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
        speed, torque = _sensible(recording, "speed", "rad/s"), _sensible(recording, "torque", "N.m")
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


@dataclass(frozen=True, eq=False)
class TorsionLoop(ComparedByFields):
    """Torque over twist along a path, slow enough that only spring, hysteresis and friction at rest speak.

    Where the zeros of both axes lie is not known from a loop, so both are unknowns of the measurement. A linear spring cannot
    tell them apart; for it the zero of the twist is taken as known. A path that never turns back, a single branch, tells
    neither: it is taken to begin with an unloaded gear at the zeros of both axes.

    At the input, with the output locked, the friction of the wave generator is inside the loop: the model's `friction_input` at
    rest, times the ratio.

    Args:
        twist: twist at the output [rad], shape (n,), monotone between its points
        torque: torque referred to the output [N.m], shape (n,)
        history: cyclic, if the same path had been run before; virgin, if the gear had not been loaded before
        torque_zero: where a fit starts to look for the zero of the torque [N.m]
        twist_zero: zero of the twist, if it is known [rad]
        input_ratio: ratio of the gear if it was measured at the input, None if at the output
        samples: how many were measured; more than are left in `twist` where each is the mean of several
    """

    twist: Array
    torque: Array
    history: Literal["cyclic", "virgin"] = "cyclic"
    torque_zero: float = 0.0
    twist_zero: float | None = None
    input_ratio: float | None = None
    samples: int = 0
    channels = ("torque",)
    units = ("N.m",)

    @classmethod
    def of(cls, recording: Recording, gear: Gear) -> TorsionLoop:
        """From columns twist and torque at the output, or input_angle and input_torque with the output locked.

        What was measured at the input is referred to the output: twist = input_angle / i, torque = i input_torque. A long
        recording is thinned to the means of equal stretches. Of a loop at the input, what was measured just behind a reversal
        is left out: there friction turns over while its bristles bend, over a distance that no loop tells.
        """
        check_recording("recording", recording)
        ratio = arguments.gear(gear).kinematics.ratio if at_input(recording) else None
        if ratio is not None:
            angle, input_torque = _sensible(recording, "input_angle", "rad"), _sensible(recording, "input_torque", "N.m")
            twist, torque = angle / ratio, ratio * input_torque
        else:
            twist, torque = _sensible(recording, "twist", "rad"), _sensible(recording, "torque", "N.m")
        twist, torque = thinned(twist, torque)
        if ratio is not None:
            twist, torque = twist[settled := slid(twist)], torque[settled]
        loop = cls(twist, torque, input_ratio=ratio, samples=len(recording))
        return replace(loop, history="virgin", twist_zero=0.0) if loop.single_branch else loop

    def __post_init__(self) -> None:
        if np.ptp(self.twist) == 0.0:
            raise ValueError("the twist never changes: a torsion loop must load and unload the gear")
        span = float(np.ptp(self.twist) * np.ptp(self.torque))
        if np.cov(self.twist, self.torque)[0, 1] < 0.0:
            raise ValueError(
                "the torque falls as the twist grows; give both the same sense, as an elastic gear has them: "
                "reverse the sign of one of the two columns"
            )
        closed = abs(self.twist[-1] - self.twist[0]) < 0.05 * np.ptp(self.twist)
        if closed and np.trapezoid(self.torque, self.twist) < -0.01 * span:
            raise ValueError("the loop gives energy instead of losing it; its samples must follow each other as measured")

    @property
    def measured(self) -> Array:
        return self.torque[np.newaxis]

    @property
    def nuisances(self) -> tuple[Nuisance, ...]:
        if self.single_branch:
            return ()
        torque = Nuisance("torque_zero", "N.m", self.torque_zero)
        return (torque,) if self.twist_zero is not None else (torque, Nuisance("twist_zero", "rad", self.middle))

    @cached_property
    def single_branch(self) -> bool:
        """Whether the twist never turns back, so that stiffness and hysteresis cannot be told apart."""
        return not turning_points(self.twist)

    @cached_property
    def middle(self) -> float:
        """Twist half way between the ends of the loop [rad]."""
        return 0.5 * float(self.twist.min() + self.twist.max())

    def path(self, twist_zero: float) -> Array:
        """The twist from its zero, where the gear is virgin, with the run before that a cyclic history needs."""
        path = self.twist - twist_zero
        return np.concatenate(([0.0], path, path)) if self.history == "cyclic" else np.concatenate(([0.0], path))

    def predict(self, model: Gear, numbers: Sequence[int], nuisances: Array) -> tuple[Array, Array]:
        torque_zero, twist_zero = (0.0, 0.0) if self.single_branch else (*nuisances, self.twist_zero)[:2]
        n = len(self.twist)
        torque, slopes = _core.differentiate_loop(model, self.path(twist_zero), list(numbers))
        *by_numbers, by_shift = slopes[:, -n:]
        by_zeros = (np.ones(n), -by_shift)[: len(nuisances)]
        predicted = torque[-n:] + torque_zero + self.friction(model)
        by_numbers = [slope + self._friction_slope(model, number) for slope, number in zip(by_numbers, numbers, strict=True)]
        return predicted[np.newaxis], np.stack((*by_numbers, *by_zeros))[:, np.newaxis]

    def friction(self, model: Gear) -> Array:
        """What friction at rest adds to the torque [N.m], shape (n,): the input's if measured there, none at a held output."""
        if self.input_ratio is None:
            return np.zeros_like(self.twist)
        torque = self.input_ratio * model.friction_input.quasistatic(self.input_ratio * self._displacement)
        return np.asarray(torque[-len(self.twist) :])

    def _friction_slope(self, model: Gear, number: int) -> Array:
        """Derivative of `friction` by a number of the gear, by differences: torque at rest is all but linear in most of them.

        Towards where a breakaway counts beside an equal Coulomb torque: upwards, and downwards for the others.
        """
        path, value, *_, low, high = _core.parameters(model)[number]
        if self.input_ratio is None or not path.startswith("friction_input."):
            return np.zeros_like(self.twist)
        step = 1e-6 * max(abs(value), 1e-6)
        end = min(value + step, high) if path.endswith("breakaway") or value - step < low else value - step
        numbers = [each[1] for each in _core.parameters(model)]
        other = _core.with_numbers(model, [*numbers[:number], end, *numbers[number + 1 :]])
        return (self.friction(other) - self.friction(model)) / (end - value)

    @cached_property
    def _displacement(self) -> Array:
        """The path that friction sees [rad]: it must not turn at each wiggle of the noise, as a spring may."""
        twist = monotone(self.twist)
        return np.concatenate(([self.middle], twist, twist) if self.history == "cyclic" else ([0.0], twist))

    def virgin(self) -> TorsionLoop:
        """The same measurement, taken to be the first loading."""
        return replace(self, history="virgin")


def at_input(recording: Recording) -> bool:
    """Whether a torsion loop was measured at the input, with the output locked."""
    return not {"twist", "torque"} <= set(recording.names)


@dataclass(frozen=True, eq=False)
class DriveLog(ComparedByFields):
    """What a drive did under a known command, starting at rest.

    Where the encoders have their zeros is not known, so these are unknowns of the measurement; a commanded angle counts from
    where it starts.

    Args:
        command: in the unit that the drive's control takes
        time: instants to compare at [s], beginning with 0, shape (n,)
        channels: names of the columns to compare, as `simulate` names them
        measured: their values in the units of a simulation, shape (channels, n)
        dt: largest step of the simulation [s]; down to a quarter of it for a model that needs that
        samples: how many were measured; of more than are compared, every so many is
        initial: what is known of its beginning; at rest if not given
    """

    command: Scenario
    time: Array
    channels: tuple[str, ...]
    units: tuple[str, ...]
    measured: Array
    dt: float
    samples: int
    initial: Mapping[str, float] | None = None

    @classmethod
    def of(
        cls,
        recording: Recording,
        drive: Drive,
        channels: Sequence[str] | None = None,
        dt: float | None = None,
        initial: Mapping[str, float] | None = None,
    ) -> DriveLog:
        """From columns time, command and outputs; all that a simulation has too, unless `channels` names some.

        Steps of 0.2 ms, or the sample interval if that is a little shorter, or as short as the drive needs, down to 0.01 ms. Of
        a long log the first 100 000 steps are taken, 20 s; of one that was recorded more often than every 0.2 ms, every so many
        rows are compared. The command is taken in full, but for rows on the line between their neighbours.
        """
        check_recording("recording", recording)
        arguments.drive(drive)
        for name in ("time", "command"):
            if name not in recording:
                raise ValueError(f"a drive log needs a column {quoted(name)}; this one has {listed(recording.names)}")
        known = {name: each.unit for name, each in outputs(drive).items() if name != "command"}
        wanted = [name for name in recording.names if name in known] if channels is None else channels
        chosen = tuple(arguments.names("channels", wanted))
        for name in chosen:
            if name not in known or name not in recording:
                raise ValueError(f"a drive log cannot be compared by {quoted(name)}; it can by {', '.join(known)}")
        if not chosen:
            raise ValueError(f"a drive log needs a measured column to compare; one of {', '.join(known)}")
        if initial is None:
            _check_hanging(recording, drive, chosen)
        command = recording.values("command", command_unit(drive))
        if controls_position(drive) and initial is None:
            command = command - command[0]
        time = recording.time - recording.time[0]
        measured = np.stack([_sensible(recording, name, known[name]) for name in chosen])
        if initial is None:
            _check_rest(time, dict(zip(chosen, measured, strict=True)))
        step = fine_enough(drive, STEP, SHORTEST) if dt is None else arguments.seconds("dt", dt)
        interval = float(np.min(np.diff(time)))
        end = int(np.searchsorted(time, STEPS * step, "right"))
        knots = _knots(time[:end], command[:end], max(1, int(min(step, STEP) / interval)))
        rows = slice(None, end, max(1, int(STEP / interval)))
        time_compared, measured = time[rows], measured[:, rows]
        every = -(-len(time_compared) // COMPARED)
        return cls(
            scenario.table(time[knots], command[knots]),
            time_compared[::every],
            chosen,
            tuple(known[name] for name in chosen),
            measured[:, ::every],
            min(step, interval) if dt is None and interval > step / 2.0 else step,
            len(recording),
            initial,
        )

    @property
    def nuisances(self) -> tuple[Nuisance, ...]:
        """The zeros of encoders, unless the beginning says where they count from."""
        if self.initial is not None:
            return ()
        return tuple(
            Nuisance(f"{name}_zero", "rad", float(self.measured[row, 0]))
            for row, name in enumerate(self.channels)
            if name in ENCODERS
        )

    def beginning(self, duration: float) -> DriveLog:
        """The log up to a time [s]."""
        taken = self.time <= duration
        end = float(self.time[taken][-1])
        early = self.command.start < end
        pieces = {name: getattr(self.command, name)[early] for name in ("start", "level", "slope")}
        command = replace(self.command, duration=end, **pieces)
        return replace(self, command=command, time=self.time[taken], measured=self.measured[:, taken])

    @property
    def interval(self) -> float:
        """The shortest time between two instants compared [s]."""
        return float(np.min(np.diff(self.time)))

    def step(self, model: Drive) -> float:
        """The largest step of a simulation of a model [s]."""
        return fine_enough(model, self.dt, SHORTER * self.dt)

    def stands_still(self, predicted: Array) -> bool:
        """Whether a prediction, shape (channels, n), has no motion where the measurement has some."""
        moving = [row for row, name in enumerate(self.channels) if name.endswith(("_angle", "_speed"))]
        spans = [(float(np.ptp(predicted[row])), float(np.ptp(self.measured[row]))) for row in moving]
        return bool(spans) and all(model < STILL * measured for model, measured in spans)

    def predict(self, model: Drive, numbers: Sequence[int], nuisances: Array) -> tuple[Array, Array]:
        names = list(outputs(model))
        run, slopes = differentiate(model, Excitation(self.command), numbers, self.step(model), self.time, self.initial)
        predicted = np.stack([run[name] for name in self.channels])
        by_zero = np.zeros((len(nuisances), *predicted.shape))
        encoders = [row for row, name in enumerate(self.channels) if name in ENCODERS and self.initial is None]
        for unknown, (row, zero) in enumerate(zip(encoders, nuisances, strict=True)):
            predicted[row] += zero
            by_zero[unknown, row] = 1.0
        return predicted, np.concatenate((slopes[:, [names.index(name) for name in self.channels]], by_zero))


def _knots(time: Array, command: Array, every: int) -> NDArray[np.intp]:
    """Rows between which a command runs straight: every so many, and where it bends between those half as many, down to all."""
    rows = np.arange(len(time))
    knots = np.union1d(rows[::every], rows[-1:])
    while (bent := np.abs(command - np.interp(time, time[knots], command[knots])) > STRAIGHT * np.ptp(command)).any():
        every = max(1, every // 2)
        stretch = np.searchsorted(knots, rows, "right")
        within = rows[::every][np.isin(stretch[::every], stretch[bent])]
        knots = np.union1d(knots, within)
    return knots


def _sensible(recording: Recording, name: str, unit: str) -> Array:
    """A column in another unit, of a size that an instrument could have read."""
    values = recording.values(name, unit)
    largest, (low, high) = float(np.abs(values).max()), SENSIBLE
    if largest > high or 0.0 < largest < low:
        raise ValueError(
            f'column "{name}" goes up to {largest:.3g} {unit}; what is measured on a gear lies between {low:g} and {high:g} '
            f"{unit}. Is its unit right? It is taken to be {recording.unit(name)}"
        )
    return values


def _check_hanging(recording: Recording, drive: Drive, channels: Sequence[str]) -> None:
    """A run starts at output angle 0; under gravity, so must the log."""
    if not isinstance(drive.load, loads.Pendulum) or drive.load.gravity_torque == 0.0:
        return
    for name in (name for name in channels if name in ENCODERS):
        per_output = drive.gear.kinematics.ratio if name == "input_angle" else 1.0
        reading = float(recording.values(name, "rad")[0])
        if abs(reading / per_output) > HANGING:
            raise ValueError(
                f"a log under gravity must start with the arm hanging, at output angle 0; by {name} it starts at "
                f"{reading / per_output:.3g} rad of the output. If it hangs there, and only the encoder counts from elsewhere, "
                f"subtract {reading:.6g} rad from the column {name}; else record from where the arm hangs"
            )


def _check_rest(time: Array, columns: Mapping[str, Array]) -> None:
    """A run starts at rest; so must the log."""
    for name, values in columns.items():
        if name.endswith("_angle"):
            speed = np.diff(values) / np.diff(time)
        elif name.endswith("_speed"):
            speed = values
        else:
            continue
        first, largest = abs(float(speed[0])), float(np.abs(speed).max())
        if first > RESTING * largest + float(np.abs(np.diff(speed)).max(initial=0.0)):  # more than it gains in a sample
            raise ValueError(
                f"the drive log must start at rest: {name} starts at {first:.3g} rad/s, {100 * first / largest:.0f} % of its "
                "largest speed; cut it to begin where the drive stands still, or record anew from rest"
            )
