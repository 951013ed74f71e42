"""A run of a drive under a known command, as an experiment."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive, arguments, loads
from strainwave.equality import ComparedByFields
from strainwave.files.recording import Recording, check_recording
from strainwave.identification.experiments.experiment import Nuisance, sensible
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
COMPARED = 20_000  # samples of a log, at most: of a longer one every so many, the command in full
STEP = 2e-4  # s, of the simulation; what was recorded more often is compared every so many rows
SHORTEST = 1e-5  # s, of a step that a fit takes without being asked to
SHORTER = 0.25  # of the step that a drive needs at the start of a fit: one on the way that needs less is not taken
STRAIGHT = 1e-6  # of the range of a command, a resolution of 20 bits: what deviates less from a line is one
STEPS = 100_000  # of a log, at most: of a longer one the beginning is taken


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
        measured = np.stack([sensible(recording, name, known[name]) for name in chosen])
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
        """The zeros of encoders, unless the beginning determines where they count from."""
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
        arguments.drive(model)
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
