"""Runs of a drive as experiments: under a known command, and along the measured motion of its input."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive, _core, arguments, control, loads, motor
from strainwave.equality import ComparedByFields
from strainwave.files.recording import Recording
from strainwave.identification.experiments.experiment import RELATIVE_STEP, Nuisance, check_columns, sensible, with_step
from strainwave.identification.experiments.motion import motion_of
from strainwave.identification.experiments.motion_log import EFFORTS, per_torque
from strainwave.messages import listed, quoted
from strainwave.simulation import scenario
from strainwave.simulation.excitation import Excitation
from strainwave.simulation.motion import InputMotion
from strainwave.simulation.resolution import fine_enough
from strainwave.simulation.run import differentiate
from strainwave.simulation.scenario import Scenario, table
from strainwave.simulation.signals import command_unit, controls_position, outputs

Array = NDArray[np.float64]
ENCODERS = ("input_angle", "output_angle")
MAX_HANGING_ANGLE = 0.02  # rad: gravity is small there compared with friction
MAX_REST_SPEED = 0.02  # of the largest speed: a log that starts faster does not start at rest
MAX_STILL_SHARE = 1e-3  # of the range measured: a prediction that moves less stands still
MAX_COMPARED = 20_000  # samples of a log; of a longer one every so many, the command in full
MAX_STEP = 2e-4  # s, of the simulation; of a faster log every so many rows are compared
MIN_STEP = 1e-5  # s, of a simulation whose step is not given
MIN_STEP_SHARE = 0.25  # of the step at the start of a fit: a drive that needs a shorter one is refused
MAX_COMMAND_ERROR = 1e-6  # of the range of a command, a resolution of 20 bits: the command may deviate so far from its lines
MAX_STEPS = 100_000  # of a log; of a longer one the beginning is taken
CHANNEL_UNITS = {"output_angle": "rad", "output_speed": "rad/s", "transmission_error": "rad", "torque": "N.m"} | EFFORTS
MAX_DRIVEN_STEP = 5e-4  # s, of the simulation: a vibration of the output is slower than those of a whole drive
VIBRATION_TIME = 0.5  # s, after which the vibration with which a run in motion begins has decayed (assumed)
MAX_DRIVEN_CUTOFF_SHARE = 0.24  # of the sample rate: bristles and the order of teeth are fast, and a quarter is noise
UNKNOWN_BEGINS = {"torque": ("N.m", 1e-3), "output_speed": ("rad/s", 1e-4)}  # unit, and change for a derivative (assumed)
OUTPUT_PLACES = {"output_angle", "twist"}  # initial quantities by which the output begins where it was
END_PERIODS = 2.0  # periods of the cut-off, over which the end of the record spoils the smoothed motion (assumed)


@dataclass(frozen=True, eq=False)
class DriveLog(ComparedByFields):
    """Run of a drive under a known command, from rest.

    The zeros of the encoders are unknowns of the measurement; a commanded angle counts from its first value.

    Args:
        command: in the unit that the drive's control takes
        time: instants to compare at [s], beginning with 0, shape (n,)
        channels: names of the columns to compare, as `simulate` names them
        measured: their values in the units of a simulation, shape (channels, n)
        dt: largest step of the simulation [s]; down to a quarter of it for a model that needs that
        samples: count of those measured; if more than are compared, every so many is
        initial: initial values that are known; at rest if not given
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
        """Return the experiment of columns time, command and outputs: those of `channels`, or all that a simulation has.

        Steps of 0.2 ms, or the sample interval if that is a little shorter, or as short as the drive needs, down to 0.01 ms. Of
        a long log the first 100 000 steps are taken, 20 s; of one that was recorded more often than every 0.2 ms, every so many
        rows are compared. The command is taken in full, but for rows on the line between their neighbours.
        """
        check_columns(recording, ("time", "command"), "a drive log")
        arguments.drive(drive)
        comparable = {name: each.unit for name, each in outputs(drive).items() if name != "command"}
        wanted = [name for name in recording.names if name in comparable] if channels is None else channels
        chosen = tuple(arguments.names("channels", wanted))
        for name in chosen:
            if name not in comparable or name not in recording:
                raise ValueError(f"a drive log cannot be compared by {quoted(name)}; it can by {', '.join(comparable)}")
        if not chosen:
            raise ValueError(f"a drive log needs a measured column to compare; one of {', '.join(comparable)}")
        if initial is None:
            _check_hanging(recording, drive, chosen)
        command = recording.values("command", command_unit(drive))
        if controls_position(drive) and initial is None:
            command = command - command[0]
        time = recording.time - recording.time[0]
        measured = np.stack([sensible(recording, name, comparable[name]) for name in chosen])
        if initial is None:
            _check_rest(time, dict(zip(chosen, measured, strict=True)))
        step = fine_enough(drive, MAX_STEP, MIN_STEP) if dt is None else arguments.seconds("dt", dt)
        interval = float(np.min(np.diff(time)))
        end = int(np.searchsorted(time, MAX_STEPS * step, "right"))
        knots = _knots(time[:end], command[:end], max(1, int(min(step, MAX_STEP) / interval)))
        rows = slice(None, end, max(1, int(MAX_STEP / interval)))
        time_compared, measured = time[rows], measured[:, rows]
        every = -(-len(time_compared) // MAX_COMPARED)
        return cls(
            scenario.table(time[knots], command[knots]),
            time_compared[::every],
            chosen,
            tuple(comparable[name] for name in chosen),
            measured[:, ::every],
            min(step, interval) if dt is None and interval > step / 2.0 else step,
            len(recording),
            initial,
        )

    @property
    def nuisances(self) -> tuple[Nuisance, ...]:
        """Zeros of the encoders; none if `initial` determines them."""
        if self.initial is not None:
            return ()
        return tuple(
            Nuisance(f"{name}_zero", "rad", float(self.measured[row, 0]))
            for row, name in enumerate(self.channels)
            if name in ENCODERS
        )

    def beginning(self, duration: float) -> DriveLog:
        """Return the log up to a time [s]."""
        within = self.time <= duration
        command = _until(self.command, float(self.time[within][-1]))
        return replace(self, command=command, time=self.time[within], measured=self.measured[:, within])

    @property
    def interval(self) -> float:
        """Shortest time between two instants compared [s]."""
        return float(np.min(np.diff(self.time)))

    def step(self, model: Drive) -> float:
        """Return the largest step of a simulation of a model [s]."""
        arguments.drive(model)
        return fine_enough(model, self.dt, MIN_STEP_SHARE * self.dt)

    def stands_still(self, predicted: Array) -> bool:
        """True if a prediction, shape (channels, n), stands still while the measurement moves."""
        moving = [row for row, name in enumerate(self.channels) if name.endswith(("_angle", "_speed"))]
        spans = [(float(np.ptp(predicted[row])), float(np.ptp(self.measured[row]))) for row in moving]
        return bool(spans) and all(model < MAX_STILL_SHARE * measured for model, measured in spans)

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


def _until(course: Scenario, end: float) -> Scenario:
    """Return a command up to a time [s]."""
    early = course.start < end
    return replace(course, duration=end, **{name: getattr(course, name)[early] for name in ("start", "level", "slope")})


def _knots(time: Array, command: Array, every: int) -> NDArray[np.intp]:
    """Return rows between which a command is straight: every so many, and more of them where it bends."""
    rows = np.arange(len(time))
    knots = np.union1d(rows[::every], rows[-1:])
    while (bent := np.abs(command - np.interp(time, time[knots], command[knots])) > MAX_COMMAND_ERROR * np.ptp(command)).any():
        every = max(1, every // 2)
        stretch = np.searchsorted(knots, rows, "right")
        within = rows[::every][np.isin(stretch[::every], stretch[bent])]
        knots = np.union1d(knots, within)
    return knots


def _check_hanging(recording: Recording, drive: Drive, channels: Sequence[str]) -> None:
    """Raise ValueError for a log under gravity that does not start at output angle 0, as a simulation does."""
    if not isinstance(drive.load, loads.Pendulum) or drive.load.gravity_torque == 0.0:
        return
    for name in (name for name in channels if name in ENCODERS):
        per_output = drive.gear.kinematics.ratio if name == "input_angle" else 1.0
        reading = float(recording.values(name, "rad")[0])
        if abs(reading / per_output) > MAX_HANGING_ANGLE:
            raise ValueError(
                f"a log under gravity must start with the arm hanging, at output angle 0; by {name} it starts at "
                f"{reading / per_output:.3g} rad of the output. If it hangs there, and only the encoder counts from elsewhere, "
                f"subtract {reading:.6g} rad from the column {name}; else record from where the arm hangs"
            )


def _check_rest(time: Array, columns: Mapping[str, Array]) -> None:
    """Raise ValueError for a log that does not start at rest, as a simulation does."""
    for name, values in columns.items():
        if name.endswith("_angle"):
            speed = np.diff(values) / np.diff(time)
        elif name.endswith("_speed"):
            speed = values
        else:
            continue
        first, largest = abs(float(speed[0])), float(np.abs(speed).max())
        if first > MAX_REST_SPEED * largest + float(np.abs(np.diff(speed)).max(initial=0.0)):  # more than it gains in a sample
            raise ValueError(
                f"the drive log must start at rest: {name} starts at {first:.3g} rad/s, {100 * first / largest:.0f} % of its "
                "largest speed; cut it to begin where the drive stands still, or record anew from rest"
            )


# ---- A log along the measured motion of its input --------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class DrivenLog(ComparedByFields):
    """Log of a drive along the measured motion of its input: gear, load and friction are simulated, the motor is not.

    Neither command nor controller need be known, and an error does not grow, as the input is always where it was measured. So
    a long log is one run. The motion of the output determines stiffness, damping, hysteresis and kinematic error; the torque of
    the motor determines inertia and friction, too. The torque of the motor is in `current`, `input_torque`, `joint_torque` (the
    motor's, counted at the output) or `voltage`, that of the gear in `torque` (a sensor at the output).

    Gravity acts by the input angle over the ratio. If the arm does not hang at its zero, `load.gravity_phase` is an unknown.

    Channels that pass other electronics than the input angle may be late. Their delay is an unknown with `with_delays`. The
    delay of `output_angle` is like viscous friction at the output: both add to the transmission error in proportion to the
    speed. That of torque and current is like softer bristles: friction turns over later behind a reversal. A fast and slow
    motion separates them.

    Args:
        motion: of the input, smoothed
        angle, speed: of the input at the instants compared [rad, rad/s], shape (n,)
        time: instants to compare at [s], shape (n,)
        channels: names of the columns to compare
        zeros: initial values of the zeros that are not known, by name
        measured: their values, shape (channels, n)
        dt: largest step of the simulation [s]
        held_back: torque of other bodies that holds the output back [N.m]
        delayed: names of the channels whose delay behind the input angle is an unknown
        begins: initial values that are unknowns, by name the largest difference from those of the motion
    """

    motion: InputMotion
    angle: Array
    speed: Array
    time: Array
    channels: tuple[str, ...]
    zeros: Mapping[str, float]
    measured: Array
    dt: float
    held_back: Scenario | float = 0.0
    delayed: tuple[str, ...] = ()
    begins: Mapping[str, float] = field(default_factory=dict)

    @classmethod
    def of(
        cls,
        recording: Recording,
        drive: Drive,
        channels: Sequence[str] | None = None,
        dt: float | None = None,
        initial: Mapping[str, float] | None = None,
        cutoff: float | None = None,
    ) -> DrivenLog:
        """Return the experiment of columns time, input_angle and those to compare: `channels`, or all that can be.

        A column `rigid_torque` [N.m at the output] is known torque of other bodies that holds the output back.

        Args:
            recording: the measurement
            drive: to be identified
            channels: columns to compare
            dt: largest step of the simulation [s]; 0.5 ms, or as short as the drive needs, if not given
            initial: initial values other than the motion of the input, as for `simulate`
            cutoff: of the filter on the input angle [Hz]; by default up to a quarter of the sample rate

        Raises:
            ValueError: a column is missing, nothing can be compared, or the angle does not determine the motion
        """
        check_columns(recording, ("time", "input_angle"), "a log along the motion of its input")
        arguments.drive(drive)
        present = [name for name in recording.names if name in CHANNEL_UNITS]
        chosen = tuple(present if channels is None else arguments.names("channels", channels))
        if unknown := [name for name in chosen if name not in present]:
            raise ValueError(f"the log cannot be compared by {quoted(unknown[0])}; it can by {listed(present) or 'nothing'}")
        if not chosen:
            raise ValueError(
                f"the log contains how the input moved, and nothing to compare: record one of {listed(CHANNEL_UNITS)} besides; "
                f"it has {listed(recording.names)}"
            )
        smoothed = motion_of(recording.time, sensible(recording, "input_angle", "rad"), cutoff, highest=MAX_DRIVEN_CUTOFF_SHARE)
        time = recording.time - recording.time[0]
        grid = smoothed.time - smoothed.time[0]
        step = fine_enough(driven(drive), MAX_DRIVEN_STEP, MIN_STEP) if dt is None else arguments.seconds("dt", dt)
        steps = np.searchsorted(grid, min(MAX_STEPS * step, float(time[-1])), "right")
        moving = abs(float(smoothed.speed[0])) > MAX_REST_SPEED * float(np.abs(smoothed.speed).max())
        moved = InputMotion.through(grid[:steps], smoothed.angle[:steps], from_rest=not moving)
        moved = replace(moved, initial={**moved.initial, **(initial or {})})
        begin = VIBRATION_TIME if moving and OUTPUT_PLACES.isdisjoint(initial or {}) else 0.0
        end = moved.command.duration - END_PERIODS / smoothed.cutoff
        rows = np.flatnonzero((time >= begin) & (time <= end))
        if len(rows) == 0:
            raise ValueError(
                f"{MAX_STEPS} steps of {step:.2g} s end before {begin + END_PERIODS / smoothed.cutoff:.2g} s, from where the "
                "log can be compared: see whether inertia and stiffness of the drive are right"
            )
        rows = rows[:: max(1, -(-len(rows) // MAX_COMPARED))]
        measured = np.stack([sensible(recording, name, CHANNEL_UNITS[name])[rows] for name in chosen])
        held_back: Scenario | float = 0.0
        if "rigid_torque" in recording:
            held_back = table(grid[:steps], np.interp(grid[:steps], time, recording.values("rigid_torque", "N.m")))
        angle = np.interp(time[rows], grid, smoothed.angle)
        return cls(
            moved,
            angle,
            np.interp(time[rows], grid, smoothed.speed),
            time[rows],
            chosen,
            _zeros(chosen, measured, float(angle[0]) / drive.gear.kinematics.ratio),
            measured,
            step,
            held_back,
        )

    @property
    def units(self) -> tuple[str, ...]:
        return tuple(CHANNEL_UNITS[name] for name in self.channels)

    @property
    def nuisances(self) -> tuple[Nuisance, ...]:
        """Zeros of encoders at the output and of the motor's effort; then delays, and initial values."""
        zeros = (Nuisance(f"{name}_zero", CHANNEL_UNITS[name], zero) for name, zero in self.zeros.items())
        delays = (Nuisance(f"{name}_delay", "s", 0.0) for name in self.delayed)
        begins = (
            Nuisance(f"initial_{name}", UNKNOWN_BEGINS[name][0], start, start - difference, start + difference)
            for name, difference in self.begins.items()
            for start in [self.motion.initial[name]]
        )
        return (*zeros, *delays, *begins)

    def beginning(self, duration: float) -> DrivenLog:
        """Return the log up to a time [s]."""
        within = self.time <= duration
        end = float(self.time[within][-1])
        return replace(
            self,
            motion=replace(self.motion, command=_until(self.motion.command, end)),
            held_back=_until(self.held_back, end) if isinstance(self.held_back, Scenario) else self.held_back,
            measured=self.measured[:, within],
            **{name: getattr(self, name)[within] for name in ("angle", "speed", "time")},
        )

    def with_delays(self, *channels: str) -> DrivenLog:
        """Return the same, with the delay of these channels behind the input angle as unknowns.

        Raises:
            ValueError: a channel is not compared
        """
        for name in channels:
            arguments.one_of("the name of a delayed channel", name, self.channels)
        return replace(self, delayed=channels)

    def with_unknown_begin(self, torque: float, output_speed: float) -> DrivenLog:
        """Return the same, with the initial torque and speed of the output as unknowns, within these differences [N.m, rad/s].

        An output without damping vibrates for ever by what they are off. If damping ends the vibration before the comparison
        begins, no limit but this one keeps them from making up for errors of the damping.
        """
        return replace(self, begins={"torque": torque, "output_speed": output_speed})

    def step(self, model: Drive) -> float:
        """Return the largest step of a simulation of a model [s]."""
        return fine_enough(driven(model), self.dt, MIN_STEP_SHARE * self.dt)

    def predict(self, model: Drive, numbers: Sequence[int], nuisances: Array) -> tuple[Array, Array]:
        moved = driven(model)
        places = {each[0]: place for place, each in enumerate(_core.parameters(moved))}
        described = _core.parameters(model)
        of_drive = [number for number in numbers if described[number][0] in places]
        names = list(outputs(moved))
        zeros, delays, begins = np.split(nuisances, np.cumsum([len(self.zeros), len(self.delayed)]))
        run, slopes, first = self._run(moved, [places[described[number][0]] for number in of_drive], begins)
        predicted = self._channels(model, run, first)
        derivatives = np.zeros((len(numbers) + len(nuisances), *predicted.shape))
        of_known = dict(zip(of_drive, slopes, strict=True))
        torque = run["motor_torque"][first:]
        changes = np.diag([UNKNOWN_BEGINS[name][1] for name in self.begins])
        for unknown, change in enumerate(changes, len(derivatives) - len(begins)):
            other, *_ = self._run(moved, [], begins + change)
            derivatives[unknown] = (self._channels(model, other, first) - predicted) / change.sum()
        for row, name in enumerate(self.channels):
            for unknown, number in enumerate(numbers):
                if number in of_known:
                    rate = of_known[number][names.index(_measured_by(name)), first:]
                    derivatives[unknown, row] = rate * self._scale(model, name)
                elif name in EFFORTS:
                    derivatives[unknown, row] = self._by_motor(model, number, name, torque)
        moving = [*range(len(numbers)), *range(len(derivatives) - len(begins), len(derivatives))]
        for unknown, (name, delay) in enumerate(zip(self.delayed, delays, strict=True), len(numbers) + len(zeros)):
            row = self.channels.index(name)
            series = self._late(np.concatenate([predicted[np.newaxis, row], derivatives[moving, row]]), float(delay))
            predicted[row], derivatives[moving, row], derivatives[unknown, row] = series[0], series[1:-1], -series[-1]
        for unknown, (name, zero) in enumerate(zip(self.zeros, zeros, strict=True), len(numbers)):
            predicted[self.channels.index(name)] += zero
            derivatives[unknown, self.channels.index(name)] = 1.0
        return predicted, derivatives

    def gear_torque(self, model: Drive, nuisances: Array) -> Array:
        """Return the torque that the gear transmits at the instants compared [N.m], shape (n,)."""
        run, _, first = self._run(driven(model), [], nuisances[len(nuisances) - len(self.begins) :])
        torque: Array = run["torque"][first:]
        return torque

    def _run(self, moved: Drive, numbers: Sequence[int], begins: Array) -> tuple[Recording, Array, int]:
        """Return a run along the motion, its derivatives by numbers of the drive, and the first row compared."""
        samples = self.time if self.time[0] == 0.0 else np.append(0.0, self.time)
        acting = Excitation(self.motion.command, self.held_back)
        initial = {**self.motion.initial, **dict(zip(self.begins, begins.tolist(), strict=True))}
        run, slopes = differentiate(moved, acting, numbers, self.step(moved), samples, initial)
        return run, slopes, len(samples) - len(self.time)

    def _late(self, series: Array, delay: float) -> Array:
        """Return series after a delay [s], shape (k, n), and the rate of the first of them, shape (1, n)."""
        from scipy.interpolate import CubicSpline

        then = np.clip(self.time - delay, self.time[0], self.time[-1])
        rate = CubicSpline(self.time, series[0])(then, 1)
        late = CubicSpline(self.time, series, axis=1)(then) if delay else series
        return np.concatenate([late, rate[np.newaxis]])

    def _scale(self, model: Drive, name: str) -> float:
        """Return a channel over the output that it measures."""
        return per_torque(model, name) if name in EFFORTS else 1.0

    def _channels(self, model: Drive, run: Recording, first: int) -> Array:
        """Return the channels of a run from a row on, shape (channels, n)."""
        return np.stack([self._shown(model, name, run[_measured_by(name)][first:]) for name in self.channels])

    def _shown(self, model: Drive, name: str, values: Array) -> Array:
        induced = float(getattr(model.motor, "back_emf", 0.0)) * self.speed if name == "voltage" else 0.0
        shown: Array = self._scale(model, name) * values + induced
        return shown

    def _by_motor(self, model: Drive, number: int, name: str, torque: Array) -> Array:
        """Return the derivative of an effort by a number of the motor: motion does not depend on it, torque is smooth in it."""
        other, change = with_step(model, number, RELATIVE_STEP * max(abs(_core.parameters(model)[number][1]), 1e-3))
        return (self._shown(other, name, torque) - self._shown(model, name, torque)) / change


def driven(drive: Drive) -> Drive:
    """Return the drive with its input moved from outside in place of motor and controller."""
    return drive.replace(
        motor=motor.AccelerationSource(inertia=drive.motor.inertia), control=control.OpenLoop(), sensors=type(drive.sensors)()
    )


def _zeros(channels: Sequence[str], measured: Array, rigid: float) -> dict[str, float]:
    """Return initial values of the zeros of channels, of a rigid output at an angle [rad] when the comparison begins."""
    begins = {"output_angle": rigid, "transmission_error": 0.0}
    first = dict(zip(channels, measured[:, 0], strict=True))
    angles = {name: float(first[name]) - begins[name] for name in channels if name in begins}
    return angles | {name: 0.0 for name in channels if name in EFFORTS}


def _measured_by(name: str) -> str:
    """Return the output of a simulation that a channel measures."""
    return "motor_torque" if name in EFFORTS else name
