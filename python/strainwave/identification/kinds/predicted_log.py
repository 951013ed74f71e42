"""A log of a drive compared with what a saved drive predicts."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive, loads
from strainwave.equality import ComparedByFields
from strainwave.files.gear_set import GearSet
from strainwave.files.recording import Recording
from strainwave.identification.candidates.motion import bands
from strainwave.identification.candidates.plain import MAX_DELAY_SAMPLES, fit_plain, from_motion_to_motion, held_out_rms
from strainwave.identification.experiments.motion import Motion
from strainwave.identification.experiments.motion_log import SHARE_OF, MotionLog, per_torque
from strainwave.identification.kinds.prepared_log import PreparedLog, log_of
from strainwave.identification.reading.recognise import Recognised
from strainwave.identification.results.gear_so_far import GearSoFar
from strainwave.identification.results.prediction import (
    DELAY,
    DRY,
    FRICTION,
    GRAVITY,
    INERTIA,
    MIN_CHANGE,
    MIN_CHANGE_TEXT,
    MIN_SLIDING_SAMPLES,
    TEMPERATURE,
    VISCOUS,
    ZERO,
    ZERO_OF_ANGLE,
    Direction,
    PartChange,
    Prediction,
    changes_of,
    friction_directions,
    judged,
    slopes_by_numbers,
    validations,
)
from strainwave.messages import listed, one_line
from strainwave.orders.lines import SpectrumLine
from strainwave.orders.torque_ripple import ripple
from strainwave.questions import TORQUE_CONSTANT, QuestionError
from strainwave.statistics.residuals import rms

Array = NDArray[np.float64]
Rows = NDArray[np.bool_]

MIN_TEMPERATURE_RANGE = 2.0  # K: over a smaller one friction does not change measurably
MIN_DELAY_SAMPLES = 0.5  # of the log: smaller changes of the delay are none, as instants are labelled no better
MAX_DELAY_SIGMA_SAMPLES = 1.0  # standard deviation of a delay, in samples of the log, with which it counts as determined
MAX_ANGLE_SIGMA = 0.1  # rad: standard deviation of the zero of the angle, with which it counts as determined
MAX_STEPS = 8  # of Gauss and Newton for delay and zero of the angle
STEP_TOLERANCE = 1e-2  # of the smallest change that matters: smaller steps end the search
ANGLE_STEP = 1e-3  # rad, either way: its square is negligible in the derivative of a sine
MIN_GRAVITY_SCALE = 1e-3  # of the saved gravity: with less, no motion shows the zero of the angle
MAX_LINES = 8  # of the residual that are listed
SPEED_BINS = 20  # of equally many samples, over which the error of a law of friction is averaged
OF_RIGID_DRIVE = ("gear.friction_", "load.", "motor.")  # beginnings of paths of numbers that a rigid drive has
OF_MOTION = {"input_angle", "output_angle", "input_speed", "output_speed"}
MAX_ERROR_OF_TURNED = 0.5  # of the error: what the angle with its sign turned must leave less, to be taken


def predict_log(file: Recognised, gear_set: GearSet) -> Prediction:
    """Return a log compared with what a saved drive predicts.

    Raises:
        ValueError: the saved set has no load, or the log cannot be compared with it
    """
    if gear_set.load is None:
        raise ValueError(
            f"{gear_set.name} has no [load], without which no torque along a motion is predicted; identify it from a log, with "
            "--constant torque_constant=NUMBER if the log contains a current: a rough one will do to predict currents"
        )
    prediction = _predicted(file, gear_set)
    if not prediction.contradicts:
        return prediction
    turned = _predicted(_turned(file), gear_set)
    if turned.error > MAX_ERROR_OF_TURNED * prediction.error:
        return prediction
    remark = f"the angle is counted in the other sense than {gear_set.name} has it: its sign is turned round"
    return replace(turned, remarks=(remark, *turned.remarks))


def _predicted(file: Recognised, gear_set: GearSet) -> Prediction:
    prepared = log_of(file, GearSoFar(gear_set))
    if prepared.in_current:
        raise QuestionError(f"{gear_set.name} has no torque constant", [TORQUE_CONSTANT])
    return judged(*_PredictedLog.of(file, prepared, gear_set).prediction(file, gear_set))


def _turned(file: Recognised) -> Recognised:
    """Return a log with the motion of its joint counted in the other sense; `log_of` turns its effort accordingly."""
    recording = file.recording
    for name in OF_MOTION & set(recording.names):
        recording = recording.with_column(name, -recording[name], recording.unit(name))
    return replace(file, recording=recording)


@dataclass(frozen=True, eq=False)
class _PredictedLog(ComparedByFields):
    """A log and its prediction by a saved drive.

    Attributes:
        taken: the log as `identify` prepares it
        log: the same with a delay of the effort, less the zero
        drive: the saved one, with the motor of the log
        zero: of the effort, as saved
        delay: of the effort, as saved [s]
        shares: of terms of other joints, as saved; empty if they are fitted to the log
        later: change of the delay, with which the effort is predicted [s]
        turned: change of the zero of the angle at the output, with which it is predicted; `drive` has it [rad]
        values: of the other parts that may have changed, by name, as last estimated; as saved if not given
    """

    taken: PreparedLog
    log: MotionLog
    drive: Drive
    zero: float
    delay: float
    shares: Mapping[str, float]
    later: float = 0.0
    turned: float = 0.0
    values: Mapping[str, float] = field(default_factory=dict)

    @classmethod
    def of(cls, file: Recognised, taken: PreparedLog, gear_set: GearSet) -> _PredictedLog:
        """Return a log compared with a saved drive."""
        drive = taken.drive.replace(load=gear_set.load)
        every, logs = validations(gear_set, file.kind, taken.log.effort), (taken.log, *taken.with_others)
        own = [each for each in every if each.file == one_line(file.path.name)]
        saved = next(iter((*own, *every)), None)
        zero, delay, shares = (saved.zero, saved.delay, saved.shares) if saved else (0.0, 0.0, {})
        alike = [each for each in logs if list(each.regressors) == list(shares) and (own or shares)]
        log = alike[0] if alike else min(logs, key=lambda each: held_out_rms(each, taken.drive))
        log = replace(log, recorded=log.recorded - zero, force=log.force - zero)
        return cls(taken, log.with_delay(), drive, zero, delay, shares if alike else {})

    @property
    def nuisances(self) -> Array:
        """Delay of the measurement, and terms of other joints as saved, shape (k,); the zero is no part of the drive."""
        saved = {f"{SHARE_OF}{name}": share for name, share in self.shares.items()} | {"delay": self.delay + self.later}
        return np.array([saved.get(each.name, 0.0) for each in self.log.nuisances])

    @cached_property
    def rows(self) -> Rows:
        """Samples from the first motion to the last, shape (m,)."""
        return from_motion_to_motion(self.log)

    @cached_property
    def band(self) -> Motion:
        """Motion in which changes are estimated: sliding in the narrowest pass band; all if there is little."""
        narrowest = bands(self.log, self.drive)[-1].motion
        return narrowest if len(narrowest.rows) >= MIN_SLIDING_SAMPLES else self.log.motion.in_full_band()

    def at(self, drive: Drive) -> Array:
        """Return the effort that a drive predicts, shape (m,)."""
        return self.log.whole(drive, self.nuisances)

    def prediction(self, file: Recognised, gear_set: GearSet) -> tuple[Prediction, GearSet, float]:
        """Return the comparison, the saved set, and the mean variance of what it predicts."""
        log, rows = self.log, self.rows
        slopes, covariance = slopes_by_numbers(gear_set, self.drive, self.at, OF_RIGID_DRIVE)
        there, directions, changes = self._estimated(gear_set)
        values = {each.name: each.value for each in changes}
        fitted = {} if self.shares else {name: value for name, value in values.items() if name.startswith(SHARE_OF)}
        residual = log.residual(self.drive, self.nuisances) - _explained(fitted, directions)
        changed = there.log.residual(there.drive, there.nuisances) - _explained(values, directions)
        channel, unit, measured = log.effort, log.units[0], log.recorded + self.zero
        lines, about_lines = self._lines(residual, file)
        comparison = Prediction(
            file.path.name, gear_set.name, file.kind, channel, unit, rms(residual[rows]), float(np.std(measured[rows])),
            self._plain_error(), samples=int(rows.sum()),
            changes=tuple(each for each in changes if not each.name.startswith(SHARE_OF)),
            error_with_changes=rms(changed[rows]),
            lines=lines,
            curves=Recording(
                {"time": log.motion.time, channel: measured, "predicted": measured - residual, "residual": residual},
                {"time": "s", channel: unit, "predicted": unit, "residual": unit},
            ),
            remarks=(*file.remarks, *self.taken.remarks, *self._remarks(), *about_lines),
        )  # fmt: skip
        return comparison, gear_set, float(np.mean(np.einsum("np,pq,nq->n", slopes[rows], covariance, slopes[rows])))

    def _estimated(self, gear_set: GearSet) -> tuple[_PredictedLog, list[Direction], tuple[PartChange, ...]]:
        """Return the log with its delay and zero of the angle, how the effort changes with each part there, and the changes.

        All other parts are linear, and need one step of Gauss and Newton.
        """
        there = self
        for steps_left in reversed(range(MAX_STEPS)):
            directions = list(there._directions())
            changes = there._changes(directions, gear_set)
            next_one = there._moved(changes)
            later = abs(next_one.later - there.later) / (MIN_DELAY_SAMPLES * self.log.motion.step)
            turned = abs(next_one.turned - there.turned) / MIN_CHANGE
            if not steps_left or max(later, turned) < STEP_TOLERANCE:
                break
            there = next_one
        return there, directions, changes

    def _moved(self, changes: Sequence[PartChange]) -> _PredictedLog:
        """Return the same with the delay and the zero of the angle of changes; those that are not determined are as saved."""
        values = {each.name: each.value for each in changes}
        longest = MAX_DELAY_SAMPLES * self.log.motion.step
        later = min(max(values.pop(DELAY, self.delay) - self.delay, -longest), longest)
        if ZERO_OF_ANGLE not in values:
            return self._turned_by(-self.turned, later, values)
        scale, across = values.get(GRAVITY, 1.0), self.values.get(GRAVITY, 1.0) * (values.pop(ZERO_OF_ANGLE) - self.turned)
        return self._turned_by(float(np.arctan2(across, scale)), later, values | {GRAVITY: float(np.hypot(scale, across))})

    def _turned_by(self, more: float, later: float, values: Mapping[str, float]) -> _PredictedLog:
        turned = float(np.angle(np.exp(1j * (self.turned + more))))
        return replace(self, drive=_turned_drive(self.drive, more), later=later, turned=turned, values=values)

    def _changes(self, directions: Sequence[Direction], gear_set: GearSet) -> tuple[PartChange, ...]:
        """Return what the log shows of each part, in its pass band."""
        slopes, covariance = slopes_by_numbers(gear_set, self.drive, self.at, OF_RIGID_DRIVE)
        band, speed = self.band, self.log.motion.speed[self.band.rows]
        asked = [replace(each, effect=band.filtered(each.effect)) for each in directions]
        left, by_numbers = band.filtered(self.log.force - self.at(self.drive)), band.filtered(slopes.T).T
        _, explained = changes_of(left, asked, by_numbers, covariance)
        parts = np.array_split((left - explained)[np.argsort(speed, kind="stable")], SPEED_BINS)
        by_speed = rms(np.array([float(np.mean(part)) for part in parts if len(part)]))  # another motion weighs it otherwise
        changes, _ = changes_of(left, asked, by_numbers, covariance, by_speed)
        return changes

    def _directions(self) -> Iterator[Direction]:
        """Yield how the effort changes with each part that may have changed."""
        drive, step, linear = self.drive, self.log.motion.step, list(self._linear_directions())
        yield from linear
        changed = self.at(drive) + _explained(self.values, linear)
        yield Direction(
            DELAY, "s", self.delay, -np.gradient(changed, step), MIN_DELAY_SAMPLES * step,
            f"{MIN_DELAY_SAMPLES:g} samples", MAX_DELAY_SIGMA_SAMPLES * step, self.delay + self.later,
        )  # fmt: skip
        if any(each.name == GRAVITY for each in linear):
            scale = max(self.values.get(GRAVITY, 1.0), MIN_GRAVITY_SCALE)
            less, greater = (self.at(_turned_drive(drive, angle)) for angle in (-ANGLE_STEP, ANGLE_STEP))
            yield Direction(
                ZERO_OF_ANGLE, "rad", 0.0, scale * (greater - less) / (2.0 * ANGLE_STEP), MIN_CHANGE,
                f"{np.degrees(MIN_CHANGE):.2g}°", MAX_ANGLE_SIGMA, self.turned,
            )  # fmt: skip

    def _linear_directions(self) -> Iterator[Direction]:
        """Yield how the effort changes with each part that it is linear in."""
        log, drive = self.log, self.drive
        friction = list(friction_directions(drive.gear, lambda gear: self.at(drive.replace(gear=gear))))
        yield from friction
        if log.both_ways:
            varies = float(np.std(log.recorded[self.rows]))
            limit = f"{MIN_CHANGE_TEXT} of what the {log.effort.replace('_', ' ')} varies"
            effect = np.ones_like(log.recorded)
            yield Direction(ZERO, log.units[0], self.zero, effect, MIN_CHANGE * varies, limit, np.inf)
        for name, number in ((INERTIA, "inertia"), (GRAVITY, "gravity_torque")):
            value = float(getattr(drive.load, number, 0.0))
            if value != 0.0:
                less = drive.replace({f"load.{number}": 0.5 * value})
                yield Direction(name, "1", 1.0, 2.0 * (self.at(drive) - self.at(less)))
        if (warmer := self._temperature()) is not None:
            total = friction[0].effect + friction[1].effect
            smallest, limit = MIN_CHANGE / float(np.ptp(warmer)), f"{MIN_CHANGE_TEXT} over its range"
            yield Direction(TEMPERATURE, "1/K", 0.0, total * warmer, smallest, limit, np.inf)
        for name in log.regressors:
            shares = np.array([float(each.name == f"{SHARE_OF}{name}") for each in log.nuisances])
            effect = log.whole(drive, self.nuisances + shares) - self.at(drive)
            yield Direction(f"{SHARE_OF}{name}", "N.m", self.shares.get(name, 0.0), effect, max_sigma=np.inf)

    def _temperature(self) -> Array | None:
        """Return the temperature about its mean at every sample [K]; None if it was not recorded, or hardly changes."""
        recording = self.taken.recording
        if "temperature" not in recording or np.ptp(recording.values("temperature", "K")) < MIN_TEMPERATURE_RANGE:
            return None
        temperature = np.interp(self.log.motion.time, recording.time, recording.values("temperature", "K"))
        return np.asarray(temperature - np.mean(temperature))

    def _plain_error(self) -> float:
        """Return the error of plain least squares fitted to this log itself, root mean square."""
        log, drive = self.log, self.drive
        scale = abs(per_torque(drive, log.effort))
        torque = log.recorded - log.induced(drive) - scale * log.extra / drive.gear.kinematics.ratio
        return float(np.std(torque[self.rows])) * float(np.sqrt(max(1.0 - fit_plain(log, drive).explained, 0.0)))

    def _lines(self, residual: Array, file: Recognised) -> tuple[tuple[SpectrumLine, ...], tuple[str, ...]]:
        """Return the lines of the spectrum of a residual, or why there is none."""
        motion = self.log.motion
        columns = {"time": motion.time, "input_angle": motion.angle, "residual": residual}
        units = {"time": "s", "input_angle": "rad", "residual": self.log.units[0]}
        others = {name: f"angle of joint {name}" for name in file.neighbours}
        for name, column in others.items():
            columns[column] = np.interp(motion.time, file.recording.time, file.recording[file.neighbours[name]])
            units[column] = "rad"
        try:
            orders = ripple(Recording(columns, units), "residual", angle="input_angle", side="input", other_angles=others)
        except ValueError as error:
            return (), (f"no orders are looked for in the residual: {error}",)
        return orders.lines[:MAX_LINES], ()

    def _remarks(self) -> Iterator[str]:
        if self.log.regressors:
            source = "as saved" if self.shares else "fitted to this recording"
            yield f"terms of other joints are {source}: {listed(self.log.regressors)}"
        if self.drive.load.name != "inertia" and self.drive.load.name != "pendulum":
            yield f"the load is as saved: {self.drive.load.name}"


def _turned_drive(drive: Drive, angle: float) -> Drive:
    """Return a drive whose output angle in each position of the load is larger [rad]."""
    load = drive.load
    if not isinstance(load, loads.Pendulum):
        return drive
    return drive.replace(load=load.replace(gravity_phase=load.gravity_phase - angle))


def _explained(values: Mapping[str, float], directions: Sequence[Direction]) -> Array:
    """Return the part of the effort that values of parts make, shape (m,); dry and viscous friction may be one."""
    parts, total = {each.name: each for each in directions}, np.zeros_like(directions[0].effect)
    for whole, value in values.items():
        for name in (DRY, VISCOUS) if whole == FRICTION else (whole,):
            total += (value - parts[name].start) * parts[name].effect
    return total
