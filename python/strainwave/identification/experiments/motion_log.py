"""A log of a moving drive whose motion is taken as measured, and whose torque is compared, as an experiment."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive, _core, arguments, loads
from strainwave.equality import ComparedByFields
from strainwave.files.recording import Recording, check_recording
from strainwave.identification.experiments.experiment import Nuisance, sensible
from strainwave.identification.experiments.motion import Motion, motion_of
from strainwave.messages import listed, quoted

Array = NDArray[np.float64]
Side = Literal["input", "output"]
EFFORTS = {"current": "A", "input_torque": "N.m", "joint_torque": "N.m", "voltage": "V"}  # what tells the torque, best first
SLID = 0.1  # rad of the input: bristles have bent by then (assumed), and friction is that of sliding
OUTLYING = 6.0  # standard deviations
CLIPPED = 20  # samples of one level at the end of the range
FEWEST = 10  # samples of each direction, in the pass band (assumed)
STEP = 1e-6  # of a number, or of its size, for a difference of torques that are smooth in it


@dataclass(frozen=True, eq=False)
class MotionLog(ComparedByFields):
    """What a drive needed to move as it did: its torque, current or voltage, along the motion that was measured.

    Nothing is simulated: command, controller and beginning need not be known, and an error of one moment is forgotten at the
    next. The drive is taken as rigid: gear and shafts turn together, so that the pass band must lie well below its first
    elastic mode. Friction is that of steady sliding; moments near rest take no part.

    Args:
        motion: of the input
        effort: what was compared: `current`, `input_torque`, `joint_torque` (the motor's, counted at the output) or `voltage`
        measured: in the pass band, shape (1, n)
        extra: torque of other bodies that hold the output back, on the grid of the motion [N.m]; zero if nothing is known
        regressors: series on the grid whose share in the torque of the output is an unknown, by name
        delayed: whether a delay of the effort is an unknown
        samples: how many were measured
    """

    motion: Motion
    effort: str
    measured: Array
    extra: Array
    regressors: Mapping[str, Array] = field(default_factory=dict)
    delayed: bool = False
    samples: int = 0

    @classmethod
    def of(
        cls,
        recording: Recording,
        drive: Drive,
        *,
        effort: str | None = None,
        cutoff: float | None = None,
        regressors: Sequence[str] = (),
    ) -> MotionLog:
        """From columns time, an angle (input_angle, else output_angle), and what tells the torque.

        A column `rigid_torque` [N.m at the output] is known torque of other bodies; `regressors` names columns whose share in
        the torque is unknown, as those of an arm that moves together with others.

        Raises:
            ValueError: a column is missing, or the motion cannot be told from the angle
        """
        check_recording("recording", recording)
        arguments.drive(drive)
        effort = _effort(recording, effort)
        time, angle = recording.time, _input_angle(recording, drive)
        if np.ptp(angle) == 0.0:
            raise ValueError("the angle never changes: a log tells inertia and friction of a shaft that moves")
        motion = motion_of(time, angle, cutoff, SLID)
        _check_both_ways(motion)

        def on_grid(values: Array) -> Array:
            return np.interp(motion.time, time, values)

        values = sensible(recording, effort, EFFORTS[effort])
        sound = ~spoilt(values)
        force = np.interp(motion.time, time[sound], values[sound])
        motion = replace(motion, known=motion.known & (on_grid(sound.astype(float)) == 1.0))
        known = on_grid(recording.values("rigid_torque", "N.m")) if "rigid_torque" in recording else np.zeros_like(motion.time)
        return cls(
            motion, effort, motion.filtered(force)[np.newaxis], known,
            {name: on_grid(recording[name]) for name in regressors}, samples=len(recording),
        )  # fmt: skip

    @property
    def channels(self) -> tuple[str, ...]:
        return (self.effort,)

    @property
    def units(self) -> tuple[str, ...]:
        return (EFFORTS[self.effort],)

    @property
    def time(self) -> Array:
        """Of what is compared [s], shape (n,)."""
        return self.motion.time[self.motion.rows]

    @property
    def nuisances(self) -> tuple[Nuisance, ...]:
        """The zero of the effort, its delay, and the shares of other bodies."""
        offset = Nuisance(f"{self.effort}_zero", EFFORTS[self.effort], 0.0)
        delay = (Nuisance("delay", "s", 0.0),) if self.delayed else ()
        return (offset, *delay, *(Nuisance(f"share of {name}", "1", 0.0) for name in self.regressors))

    def with_delay(self) -> MotionLog:
        """The same, with a delay of the effort behind the motion as an unknown."""
        return replace(self, delayed=True)

    def predict(self, model: Drive, numbers: Sequence[int], nuisances: Array) -> tuple[Array, Array]:
        others = self._others(nuisances)
        now = Needed.of(model, self.motion, others)
        scale = per_torque(model, self.effort, self.motion)
        effort = scale * now.torque + self._induced(model)
        slopes = [self._slope(model, number, others, now, effort) for number in numbers]
        slopes += [scale * series / model.gear.kinematics.ratio for series in self.regressors.values()]
        series = self._late(np.stack([effort, *slopes]), nuisances)
        by_delay = [-np.gradient(series[0], self.motion.time)] if self.delayed else []
        in_band = self.motion.filtered(np.stack([*series, np.ones_like(effort), *by_delay]))
        predicted, by_numbers, by_zeros = in_band[:1], in_band[1 : 1 + len(numbers)], in_band[1 + len(slopes) :]
        slopes_of_all = np.concatenate([by_numbers, by_zeros, in_band[1 + len(numbers) : 1 + len(slopes)]])
        return predicted + nuisances[0] * by_zeros[:1], slopes_of_all[:, np.newaxis]

    def _others(self, nuisances: Array) -> Array:
        """Torque of other bodies at the output [N.m]."""
        shares = nuisances[1 + self.delayed :]
        found: Array = sum((share * each for share, each in zip(shares, self.regressors.values(), strict=True)), self.extra)
        return found

    def _induced(self, model: Drive) -> Array | float:
        """Voltage that a motor induces as it turns."""
        return float(getattr(model.motor, "back_emf", 0.0)) * self.motion.speed if self.effort == "voltage" else 0.0

    def _late(self, series: Array, nuisances: Array) -> Array:
        time = self.motion.time
        return np.stack([np.interp(time - nuisances[1], time, each) for each in series]) if self.delayed else series

    def _slope(self, model: Drive, number: int, others: Array, now: Needed, effort: Array) -> Array:
        """By a number of the drive. Torque is smooth in each of them, so that a difference tells it to eight digits."""
        described = _core.parameters(model)
        path, value, *_, high = described[number]
        scale = per_torque(model, self.effort, self.motion)
        if path in ("motor.inertia", "gear.input_inertia"):
            inertial: Array = scale * self.motion.acceleration
            return inertial
        step = STEP * max(abs(value), 1e-3)
        end = value + step if value + step <= high else value - step
        values = [each[1] for each in described]
        other = _core.with_numbers(model, [*values[:number], end, *values[number + 1 :]])
        if path.startswith("gear.friction_"):
            slope: Array = scale * (now.with_friction_of(other).torque - now.torque) / (end - value)
            return slope
        there = per_torque(other, self.effort, self.motion) * Needed.of(other, self.motion, others).torque + self._induced(
            other
        )
        return np.asarray((there - effort) / (end - value))


@dataclass(frozen=True, eq=False)
class Needed(ComparedByFields):
    """Torque that a motor must give so that its rigid drive moves so, and of what it consists.

    .. math:: \\tau = (J_m + J_g) \\dot\\omega + F_{in}(\\omega) + [F_{mesh}(\\omega / i, T) + T] / i, \\qquad
              T = J_l \\dot\\omega / i + T_{load}(\\theta / i) + F_{out}(\\omega / i)

    Attributes:
        drive: the drive
        motion: of its input
        others: torque of other bodies that hold the output back [N.m], shape (n,)
        transmitted: torque at the output T [N.m], shape (n,)
        at_input, at_mesh: friction, of the mesh at the output's scale [N.m], shape (n,)
    """

    drive: Drive
    motion: Motion
    others: Array
    transmitted: Array
    at_input: Array
    at_mesh: Array

    @classmethod
    def of(cls, drive: Drive, motion: Motion, others: Array) -> Needed:
        """Of a drive whose output other bodies hold back, too.

        Raises:
            ValueError: the load is none that a rigid drive is known with
        """
        gear, ratio = drive.gear, drive.gear.kinematics.ratio
        angle, speed = motion.angle / ratio, motion.speed / ratio
        held = load_torque(drive, angle) + others + gear.friction_output.steady(speed, angle=angle)
        transmitted = inertia_of(drive) * motion.acceleration / ratio + held
        at_input = gear.friction_input.steady(motion.speed, angle=motion.angle, load=transmitted / ratio)
        at_mesh = gear.friction_mesh.steady(speed, angle=angle, load=transmitted)
        return cls(drive, motion, others, transmitted, at_input, at_mesh)

    def with_friction_of(self, other: Drive) -> Needed:
        """The same with the friction of another drive, of which only what differs is worked out anew."""
        before, gear, motion, ratio = self.drive.gear, other.gear, self.motion, other.gear.kinematics.ratio
        if gear.friction_output != before.friction_output:
            return Needed.of(other, motion, self.others)
        at_input, at_mesh = self.at_input, self.at_mesh
        if gear.friction_input != before.friction_input:
            load = self.transmitted / ratio
            at_input = gear.friction_input.steady(motion.speed, angle=motion.angle, load=load)
        if gear.friction_mesh != before.friction_mesh:
            angle, speed = motion.angle / ratio, motion.speed / ratio
            at_mesh = gear.friction_mesh.steady(speed, angle=angle, load=self.transmitted)
        return replace(self, drive=other, at_input=at_input, at_mesh=at_mesh)

    @property
    def torque(self) -> Array:
        """At the input [N.m], shape (n,)."""
        inertia = self.drive.motor.inertia + self.drive.gear.input_inertia
        torque: Array = inertia * self.motion.acceleration + self.at_input
        return torque + (self.at_mesh + self.transmitted) / self.drive.gear.kinematics.ratio


def inertia_of(drive: Drive) -> float:
    """Of the load [kg.m2]; none of one that is moved from outside."""
    return float(getattr(drive.load, "inertia", 0.0))


def load_torque(drive: Drive, angle: Array) -> Array:
    """Torque with which the load holds the output back at an angle [N.m].

    Raises:
        ValueError: it depends on more than the angle
    """
    if isinstance(drive.load, loads.Pendulum):
        torque: Array = drive.load.gravity_torque * np.sin(angle + drive.load.gravity_phase)
        return torque
    if isinstance(drive.load, loads.Inertia):
        return np.zeros_like(angle)
    raise ValueError(
        f"a log cannot be compared along its motion with a load of kind {drive.load.name}; it can with inertia or pendulum, "
        "and other torque as a column rigid_torque"
    )


def per_torque(drive: Drive, effort: str, motion: Motion) -> float:
    """Effort per torque at the input: of a motor whose torque constant is not known, a torque in A."""
    constant = float(getattr(drive.motor, "torque_constant", 1.0))
    per = {"current": 1.0 / constant, "input_torque": 1.0, "joint_torque": drive.gear.kinematics.ratio}
    return per[effort] if effort in per else float(getattr(drive.motor, "resistance", 0.0)) / constant


def _check_both_ways(motion: Motion) -> None:
    forward, backward = (int(np.sum(way * motion.speed[motion.rows] > 0.0)) for way in (1.0, -1.0))
    if forward + backward == 0:
        raise ValueError("the shaft hardly moves: all of the log is rest, reversals or gaps; record a larger motion")
    if min(forward, backward) < FEWEST:
        raise ValueError(
            f"the shaft moves forward in {forward} and backward in {backward} of the samples compared; {FEWEST} of each are "
            "needed to tell Coulomb's friction from a constant torque: record motion both ways"
        )


def spoilt(values: Array) -> NDArray[np.bool_]:
    """Samples that are outliers among their neighbours, or clipped at the end of the range.

    Outliers by the median of seven and the median deviation from it (Hampel 1974, 6 standard deviations). Clipped: the largest
    or smallest level that comes again and again, though an outlier may lie beyond.
    """
    from scipy import ndimage

    off = np.abs(values - ndimage.median_filter(values, 7, mode="nearest"))
    scale = float(np.median(off)) / 0.6745
    outliers = off > OUTLYING * scale if scale > 0.0 else np.zeros(len(values), bool)
    clipped = _clipped(values) | _clipped(-values)
    spoilt_ones: NDArray[np.bool_] = outliers | clipped
    return spoilt_ones


def _clipped(values: Array) -> NDArray[np.bool_]:
    """Samples at the upper end of a range that was too small."""
    levels, counts = np.unique(values, return_counts=True)
    upper = levels >= np.quantile(values, 0.9)
    if not upper.any():
        return np.zeros(len(values), bool)
    usual = float(np.median(counts))
    level = levels[upper][np.argmax(counts[upper])]
    often = counts[upper].max() >= max(CLIPPED, 10.0 * usual)
    end = often and np.mean(values > level) < 0.03
    return (values >= level) if end else np.zeros(len(values), bool)


def _effort(recording: Recording, wanted: str | None) -> str:
    if wanted is not None:
        arguments.one_of("effort", wanted, tuple(EFFORTS))
    present = [name for name in EFFORTS if name in recording and wanted in (None, name)]
    if not present:
        raise ValueError(f"the log has none of {listed(EFFORTS)}, which tell the torque; it has {listed(recording.names)}")
    return present[0]


def _input_angle(recording: Recording, drive: Drive) -> Array:
    """The angle of the input [rad]: measured there, or as a rigid gear has it."""
    if "time" not in recording:
        raise ValueError(f"the log needs a column {quoted('time')}; it has {listed(recording.names)}")
    if "input_angle" in recording:
        return sensible(recording, "input_angle", "rad")
    if "output_angle" in recording:
        return drive.gear.kinematics.ratio * sensible(recording, "output_angle", "rad")
    raise ValueError(f"the log needs an angle, input_angle or output_angle; it has {listed(recording.names)}")
