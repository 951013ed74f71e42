"""A log of a drive whose input is moved as it was measured, and whose other channels are predicted, as an experiment."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive, _core, arguments, control, motor
from strainwave.equality import ComparedByFields
from strainwave.files.recording import Recording, check_recording
from strainwave.identification.experiments.experiment import Nuisance, sensible
from strainwave.identification.experiments.motion import motion_of
from strainwave.identification.experiments.motion_log import DIFFERENCE, EFFORTS, per_torque
from strainwave.messages import listed, quoted
from strainwave.simulation.excitation import Excitation
from strainwave.simulation.motion import Motion
from strainwave.simulation.resolution import fine_enough
from strainwave.simulation.run import differentiate
from strainwave.simulation.scenario import Scenario, table
from strainwave.simulation.signals import outputs

Array = NDArray[np.float64]
OF_GEAR = {
    "output_angle": "rad",
    "output_speed": "rad/s",
    "transmission_error": "rad",
    "torque": "N.m",
}  # as `simulate` names it
CHANNELS = OF_GEAR | EFFORTS
DT = 5e-4  # s, of the simulation: a vibration of the output is slower than those of a whole drive
SHORTEST = 1e-5  # s, of a step that a fit takes without being asked to
STEPS = 100_000  # of a log, at most: of a longer one the beginning is taken
COMPARED = 20_000  # samples, at most: of more every so many
RESTING = 0.02  # of the largest speed: what starts slower starts at rest
FADED = 0.5  # s, after which the vibration with which a run in motion begins has decayed (assumed)
HIGHEST_CUTOFF = 0.24  # of the sampling rate: bristles and the order of teeth are fast, and above a quarter noise is measured
SPOILT = 2.0  # periods of the cut-off, over which the end of the record spoils the smoothed motion (assumed)


@dataclass(frozen=True, eq=False)
class DrivenLog(ComparedByFields):
    """What a drive did while its input moved as it was measured: gear, load and friction are simulated, the motor is not.

    Neither command nor controller need be known, and an error does not grow: whatever the gear does, the input is where it was
    measured. So a long log is one run. What the output does tells stiffness, damping, hysteresis and kinematic error; what
    torque the motor needs tells inertia and friction besides. The motor's torque is told by `current`, `input_torque`,
    `joint_torque` (the motor's, counted at the output) or `voltage`, that of the gear by `torque` (a sensor at the output).

    Gravity acts by the input angle over the ratio. Where the arm does not hang at its zero, `load.gravity_phase` is an unknown.

    Channels that pass other electronics than the input angle may be late. Their delay is an unknown with `with_delays`. What it
    looks like: of `output_angle`, viscous friction at the output, for both add to the transmission error in proportion to the
    speed; of torque and current, softer bristles, for both let friction turn over later behind a reversal. A fit tells which by
    the motion being fast and slow, and says how sure it is.

    Args:
        motion: of the input, smoothed
        angle, speed: of the input at the instants compared [rad, rad/s], shape (n,)
        time: instants to compare at [s], shape (n,)
        channels: names of the columns to compare
        zeros: about where those of them have their zero whose zero is not known, by name
        measured: their values, shape (channels, n)
        dt: largest step of the simulation [s]
        samples: how many were measured
        held_back: torque of other bodies that holds the output back [N.m]
        delayed: names of the channels whose delay behind the input angle is an unknown
    """

    motion: Motion
    angle: Array
    speed: Array
    time: Array
    channels: tuple[str, ...]
    zeros: Mapping[str, float]
    measured: Array
    dt: float
    samples: int
    held_back: Scenario | float = 0.0
    delayed: tuple[str, ...] = ()

    @classmethod
    def of(
        cls,
        recording: Recording,
        drive: Drive,
        channels: Sequence[str] | None = None,
        dt: float | None = None,
        initial: Mapping[str, float] | None = None,
        *,
        cutoff: float | None = None,
    ) -> DrivenLog:
        """From columns time, input_angle and what is to be compared; all that can be, unless `channels` names some.

        A column `rigid_torque` [N.m at the output] is known torque of other bodies that holds the output back.

        Args:
            recording: what was measured
            drive: what is to be identified
            channels: columns to compare
            dt: largest step of the simulation [s]; 0.5 ms, or as short as the drive needs, if not given
            initial: what else is known of its beginning than the motion of the input, as for `simulate`
            cutoff: up to which the motion of the input is followed [Hz]; as `motion_of` if not given

        Raises:
            ValueError: a column is missing, nothing can be compared, or the motion cannot be told from the angle
        """
        check_recording("recording", recording)
        arguments.drive(drive)
        for name in ("time", "input_angle"):
            if name not in recording:
                raise ValueError(
                    f"a log along the motion of its input needs a column {quoted(name)}; it has {listed(recording.names)}"
                )
        present = [name for name in recording.names if name in CHANNELS]
        chosen = tuple(present if channels is None else arguments.names("channels", channels))
        if unknown := [name for name in chosen if name not in present]:
            raise ValueError(f"the log cannot be compared by {quoted(unknown[0])}; it can by {listed(present) or 'nothing'}")
        if not chosen:
            raise ValueError(
                f"the log contains how the input moved, and nothing to compare: record one of {listed(CHANNELS)} besides; "
                f"it has {listed(recording.names)}"
            )
        smoothed = motion_of(recording.time, sensible(recording, "input_angle", "rad"), cutoff, highest=HIGHEST_CUTOFF)
        time = recording.time - recording.time[0]
        grid = smoothed.time - smoothed.time[0]
        step = fine_enough(driven(drive), DT, SHORTEST) if dt is None else arguments.seconds("dt", dt)
        steps = np.searchsorted(grid, min(STEPS * step, float(time[-1])), "right")
        moving = abs(float(smoothed.speed[0])) > RESTING * float(np.abs(smoothed.speed).max())
        moved = Motion.through(grid[:steps], smoothed.angle[:steps], from_rest=not moving)
        moved = replace(moved, initial={**moved.initial, **(initial or {})})
        begin, end = FADED if moving and initial is None else 0.0, moved.command.duration - SPOILT / smoothed.cutoff
        rows = np.flatnonzero((time >= begin) & (time <= end))
        rows = rows[:: max(1, -(-len(rows) // COMPARED))]
        measured = np.stack([sensible(recording, name, CHANNELS[name])[rows] for name in chosen])
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
            len(recording),
            held_back,
        )

    @property
    def units(self) -> tuple[str, ...]:
        return tuple(CHANNELS[name] for name in self.channels)

    @property
    def nuisances(self) -> tuple[Nuisance, ...]:
        """Zeros of encoders at the output, as the rigid drive has them, and of the motor's effort; then delays."""
        zeros = (Nuisance(f"{name}_zero", CHANNELS[name], zero) for name, zero in self.zeros.items())
        return (*zeros, *(Nuisance(f"{name}_delay", "s", 0.0) for name in self.delayed))

    def with_delays(self, *channels: str) -> DrivenLog:
        """The same, with the delay of these channels behind the input angle as unknowns.

        Raises:
            ValueError: a channel is not compared
        """
        for name in channels:
            arguments.one_of("the name of a delayed channel", name, self.channels)
        return replace(self, delayed=channels)

    def step(self, model: Drive) -> float:
        """The largest step of a simulation of a model [s]."""
        return fine_enough(driven(model), self.dt, 0.25 * self.dt)

    def predict(self, model: Drive, numbers: Sequence[int], nuisances: Array) -> tuple[Array, Array]:
        moved = driven(model)
        places = {each[0]: place for place, each in enumerate(_core.parameters(moved))}
        described = _core.parameters(model)
        known = [number for number in numbers if described[number][0] in places]
        names = list(outputs(moved))
        run, slopes, first = self._run(moved, [places[described[number][0]] for number in known])
        predicted = np.stack([self._shown(model, name, run[_told_by(name)][first:]) for name in self.channels])
        found = np.zeros((len(numbers) + len(nuisances), *predicted.shape))
        of_known = dict(zip(known, slopes, strict=True))
        torque = run["motor_torque"][first:]
        for row, name in enumerate(self.channels):
            for unknown, number in enumerate(numbers):
                if number in of_known:
                    rate = of_known[number][names.index(_told_by(name)), first:]
                    found[unknown, row] = rate * self._scale(model, name)
                elif name in EFFORTS:
                    found[unknown, row] = self._by_motor(model, number, name, torque)
        zeros, delays = np.split(nuisances, [len(self.zeros)])
        for unknown, (name, delay) in enumerate(zip(self.delayed, delays, strict=True), len(numbers) + len(zeros)):
            row = self.channels.index(name)
            series = self._late(np.concatenate([predicted[np.newaxis, row], found[: len(numbers), row]]), float(delay))
            predicted[row], found[: len(numbers), row], found[unknown, row] = series[0], series[1:-1], -series[-1]
        for unknown, (name, zero) in enumerate(zip(self.zeros, zeros, strict=True), len(numbers)):
            predicted[self.channels.index(name)] += zero
            found[unknown, self.channels.index(name)] = 1.0
        return predicted, found

    def gear_torque(self, model: Drive) -> Array:
        """Torque that the gear transmits at the instants compared [N.m], shape (n,)."""
        run, _, first = self._run(driven(model), [])
        torque: Array = run["torque"][first:]
        return torque

    def _run(self, moved: Drive, numbers: Sequence[int]) -> tuple[Recording, Array, int]:
        """A run along the motion, its derivatives by numbers of the drive, and the place of the first instant compared."""
        samples = self.time if self.time[0] == 0.0 else np.append(0.0, self.time)
        acting = Excitation(self.motion.command, self.held_back)
        run, slopes = differentiate(moved, acting, numbers, self.step(moved), samples, self.motion.initial)
        return run, slopes, len(samples) - len(self.time)

    def _late(self, series: Array, delay: float) -> Array:
        """Series as they come after a delay [s], shape (k, n), and the rate of the first of them, shape (1, n)."""
        from scipy.interpolate import CubicSpline

        then = np.clip(self.time - delay, self.time[0], self.time[-1])
        rate = CubicSpline(self.time, series[0])(then, 1)
        late = CubicSpline(self.time, series, axis=1)(then) if delay else series
        return np.concatenate([late, rate[np.newaxis]])

    def _scale(self, model: Drive, name: str) -> float:
        """Return what a channel shows of the output that it measures."""
        return per_torque(model, name) if name in EFFORTS else 1.0

    def _shown(self, model: Drive, name: str, values: Array) -> Array:
        induced = float(getattr(model.motor, "back_emf", 0.0)) * self.speed if name == "voltage" else 0.0
        shown: Array = self._scale(model, name) * values + induced
        return shown

    def _by_motor(self, model: Drive, number: int, name: str, torque: Array) -> Array:
        """By a number of the motor that was measured: no motion changes with it, and torque is smooth in it."""
        described = _core.parameters(model)
        values = [each[1] for each in described]
        step = DIFFERENCE * max(abs(values[number]), 1e-3)
        other = _core.with_numbers(model, [*values[:number], values[number] + step, *values[number + 1 :]])
        return (self._shown(other, name, torque) - self._shown(model, name, torque)) / step


def driven(drive: Drive) -> Drive:
    """The drive with its input moved from outside in place of motor and controller."""
    return drive.replace(
        motor=motor.AccelerationSource(inertia=drive.motor.inertia), control=control.OpenLoop(), sensors=type(drive.sensors)()
    )


def _zeros(channels: Sequence[str], measured: Array, rigid: float) -> dict[str, float]:
    """About where channels have their zero, where a rigid output stands at an angle [rad] when the comparison begins."""
    begins = {"output_angle": rigid, "transmission_error": 0.0}
    first = dict(zip(channels, measured[:, 0], strict=True))
    angles = {name: float(first[name]) - begins[name] for name in channels if name in begins}
    return angles | {name: 0.0 for name in channels if name in EFFORTS}


def _told_by(name: str) -> str:
    """Return the output of a simulation that a channel measures."""
    return "motor_torque" if name in EFFORTS else name
