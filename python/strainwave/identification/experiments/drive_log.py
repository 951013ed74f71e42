"""A run of a drive under a known command, as an experiment."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive, arguments, loads
from strainwave.equality import ComparedByFields
from strainwave.files.recording import Recording
from strainwave.identification.experiments.experiment import Nuisance, check_columns, sensible
from strainwave.messages import quoted
from strainwave.simulation import scenario
from strainwave.simulation.excitation import Excitation
from strainwave.simulation.resolution import fine_enough
from strainwave.simulation.run import differentiate
from strainwave.simulation.scenario import Scenario
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
            tuple(known[name] for name in chosen),
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
        end = float(self.time[within][-1])
        early = self.command.start < end
        pieces = {name: getattr(self.command, name)[early] for name in ("start", "level", "slope")}
        command = replace(self.command, duration=end, **pieces)
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
