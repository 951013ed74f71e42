"""A log of a moving drive whose motion is taken as measured, and whose torque is compared, as an experiment."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive, _core, arguments, friction, loads
from strainwave.analysis.branches import noise
from strainwave.equality import ComparedByFields
from strainwave.files.recording import Recording, check_recording
from strainwave.identification.experiments.experiment import Nuisance, sensible
from strainwave.identification.experiments.friction_table import ROOM_TEMPERATURE
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
FRICTIONLESS = friction.Viscous(viscous=0.0)
AT_INPUT = ("motor.inertia", "gear.input_inertia")


@dataclass(frozen=True, eq=False)
class MotionLog(ComparedByFields):
    """What a drive needed to move as it did: its torque, current or voltage, along the motion that was measured.

    Nothing is simulated: command, controller and beginning need not be known, and an error of one moment is forgotten at the
    next. The drive is taken as rigid: gear and shafts turn together, so that the pass band must lie well below its first
    elastic mode. Friction is that of steady sliding; moments near rest take no part.

    Args:
        motion: of the input
        effort: what was compared: `current`, `input_torque`, `joint_torque` (the motor's, counted at the output) or `voltage`
        force: the effort on the grid of the motion, shape (m,)
        extra: torque of other bodies that hold the output back, on the grid of the motion [N.m]; zero if nothing is known
        regressors: series on the grid whose share in the torque of the output is an unknown, by name
        delayed: whether a delay of the effort is an unknown
        samples: how many were measured
        starts: where a fit starts with each of the nuisances; with zero if not given
    """

    motion: Motion
    effort: str
    force: Array
    extra: Array
    regressors: Mapping[str, Array] = field(default_factory=dict)
    delayed: bool = False
    samples: int = 0
    starts: tuple[float, ...] = ()

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
        from scipy.interpolate import Akima1DInterpolator

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
        force = np.asarray(Akima1DInterpolator(time[sound], values[sound], extrapolate=True)(motion.time))  # as the angle is
        motion = replace(motion, known=motion.known & (on_grid(sound.astype(float)) == 1.0))
        known = on_grid(recording.values("rigid_torque", "N.m")) if "rigid_torque" in recording else np.zeros_like(motion.time)
        return cls(
            motion, effort, force, known,
            {name: on_grid(recording[name]) for name in regressors}, samples=len(recording),
        )  # fmt: skip

    @cached_property
    def measured(self) -> Array:
        """The effort in the pass band, shape (1, n)."""
        return self.motion.filtered(self.force)[np.newaxis]

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
        described = [(f"{self.effort}_zero", EFFORTS[self.effort]), *([("delay", "s")] if self.delayed else [])]
        described += [(f"share of {name}", "1") for name in self.regressors]
        starts = self.starts or (0.0,) * len(described)
        return tuple(Nuisance(name, unit, start) for (name, unit), start in zip(described, starts, strict=True))

    def below(self, frequency: float) -> MotionLog:
        """The same, compared far below a vibration of load and gear of this frequency [Hz]: above, the drive is not rigid.

        Raises:
            ValueError: too little of the motion is left
        """
        motion = self.motion.below(frequency)
        _check_both_ways(motion)
        return replace(self, motion=motion)

    def with_delay(self) -> MotionLog:
        """The same, with a delay of the effort behind the motion as an unknown."""
        return replace(self, delayed=True, starts=())

    def without_delay(self) -> MotionLog:
        """The same, with an effort that belongs to its moment."""
        return replace(self, delayed=False, starts=())

    def starting(self, nuisances: Sequence[float]) -> MotionLog:
        """The same, from where a fit starts with the nuisances."""
        return replace(self, starts=tuple(nuisances))

    def predict(self, model: Drive, numbers: Sequence[int], nuisances: Array) -> tuple[Array, Array]:
        others = self._others(nuisances)
        described = _core.parameters(model)
        now = InverseDynamics.of(model, self.motion, others, [described[number][0] for number in numbers])
        scale = per_torque(model, self.effort)
        effort = scale * now.torque + self.induced(model)
        slopes = [self._slope(model, number, described, now, effort) for number in numbers]
        slopes += [scale * now.by_transmitted * series for series in self.regressors.values()]
        series = np.stack([effort, *slopes])
        by_delay = []
        if self.delayed:
            series, change = self.motion.late(series, float(nuisances[1]))
            by_delay = [change]
        in_band = self.motion.filtered(np.stack([*series, np.ones_like(effort), *by_delay]))
        predicted, by_numbers, by_zeros = in_band[:1], in_band[1 : 1 + len(numbers)], in_band[1 + len(slopes) :]
        slopes_of_all = np.concatenate([by_numbers, by_zeros, in_band[1 + len(numbers) : 1 + len(slopes)]])
        return predicted + nuisances[0] * by_zeros[:1], slopes_of_all[:, np.newaxis]

    def _others(self, nuisances: Array) -> Array:
        """Torque of other bodies at the output [N.m]."""
        shares = nuisances[1 + self.delayed :]
        found: Array = sum((share * each for share, each in zip(shares, self.regressors.values(), strict=True)), self.extra)
        return found

    def induced(self, model: Drive) -> Array:
        """The part of the effort that makes no torque: the voltage that a motor induces as it turns [V]; 0 of all others."""
        constant = float(getattr(model.motor, "back_emf", 0.0)) if self.effort == "voltage" else 0.0
        return constant * self.motion.speed

    def _slope(self, model: Drive, number: int, described: Sequence[Any], now: InverseDynamics, effort: Array) -> Array:
        """By a number of the drive: of few by a difference, which is good to eight digits where torque is smooth in them."""
        path, value, *_, high = described[number]
        if path in now.slopes:
            return per_torque(model, self.effort) * now.slopes[path]
        step = STEP * max(abs(value), 1e-3)
        end = value + step if value + step <= high else value - step
        values = [each[1] for each in described]
        other = _core.with_numbers(model, [*values[:number], end, *values[number + 1 :]])
        there = InverseDynamics.of(other, self.motion, now.others)
        moved = per_torque(other, self.effort) * there.torque + self.induced(other)
        return np.asarray((moved - effort) / (end - value))


@dataclass(frozen=True, eq=False)
class InverseDynamics(ComparedByFields):
    """Torque that a motor must give so that its rigid drive moves so, and of what it consists.

    .. math:: \\tau = (J_m + J_g) \\dot\\omega + F_{in}(\\omega, T / i) + [F_{mesh}(\\omega / i, T) + T] / i, \\qquad
              T = J_l \\dot\\omega / i + T_{load}(\\theta / i) + F_{out}(\\omega / i)

    Attributes:
        others: torque of other bodies that hold the output back [N.m], shape (n,)
        torque: at the input [N.m], shape (n,)
        by_transmitted: derivative of the torque by that at the output, T [1], shape (n,)
        slopes: derivatives of the torque by numbers of inertia, load and friction, by path, each of shape (n,)
    """

    others: Array
    torque: Array
    by_transmitted: Array
    slopes: Mapping[str, Array]

    @classmethod
    def of(cls, drive: Drive, motion: Motion, others: Array, paths: Sequence[str] = ()) -> InverseDynamics:
        """Of a drive whose output other bodies hold back, too, with derivatives by numbers of these paths.

        Raises:
            ValueError: the load is none that a rigid drive is known with
        """
        ratio = drive.gear.kinematics.ratio
        angle, speed, acceleration = motion.angle / ratio, motion.speed / ratio, motion.acceleration / ratio
        at_output, by_output = _friction(drive, "friction_output", paths, speed, angle, np.zeros_like(speed))
        transmitted = inertia_of(drive) * acceleration + load_torque(drive, angle) + others + at_output
        step = STEP * float(np.abs(transmitted).max())
        at_mesh, by_mesh = _friction(drive, "friction_mesh", paths, speed, angle, transmitted)
        at_input, by_input = _friction(drive, "friction_input", paths, motion.speed, motion.angle, transmitted / ratio)
        inertia = drive.motor.inertia + drive.gear.input_inertia
        torque = inertia * motion.acceleration + at_input + (at_mesh + transmitted) / ratio
        if step == 0.0:
            return cls(others, torque, np.full_like(torque, 1.0 / ratio), {})
        mesh_there, _ = _friction(drive, "friction_mesh", (), speed, angle, transmitted + step)
        input_there, _ = _friction(drive, "friction_input", (), motion.speed, motion.angle, (transmitted + step) / ratio)
        by_transmitted = (1.0 + (mesh_there - at_mesh) / step) / ratio + (input_there - at_input) / step
        slopes = {path: motion.acceleration for path in paths if path in AT_INPUT}
        slopes |= by_input | {path: slope / ratio for path, slope in by_mesh.items()}
        of_output = by_output | {path: slope for path, slope in _by_load(drive, angle, acceleration).items() if path in paths}
        slopes |= {path: by_transmitted * slope for path, slope in of_output.items()}
        return cls(others, torque, by_transmitted, slopes)


def _friction(
    drive: Drive, place: str, paths: Sequence[str], speed: Array, angle: Array, load: Array
) -> tuple[Array, dict[str, Array]]:
    """Steady friction at a place of the gear [N.m], and its derivatives by those numbers of it that are among the paths."""
    if getattr(drive.gear, place) == FRICTIONLESS and not any(path.startswith(f"gear.{place}.") for path in paths):
        return np.zeros_like(speed), {}
    alone = drive.gear.replace(friction_input=getattr(drive.gear, place))  # where `differentiate_steady` looks
    numbers = {path: number for number, (path, *_) in enumerate(_core.parameters(alone))}
    asked = [path for path in paths if path.startswith(f"gear.{place}.")]
    here = [numbers[path.replace(f"gear.{place}", "friction_input")] for path in asked]
    room = np.full_like(speed, ROOM_TEMPERATURE)
    torque, slopes = _core.differentiate_steady(alone, speed, angle, load, room, here)
    return torque, dict(zip(asked, slopes, strict=True))


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


def _by_load(drive: Drive, angle: Array, acceleration: Array) -> dict[str, Array]:
    """Derivatives of the torque at the output by numbers of the load, by path, over its angle and acceleration."""
    slopes = {"load.inertia": acceleration}
    if isinstance(drive.load, loads.Pendulum):
        turned = angle + drive.load.gravity_phase
        slopes |= {"load.gravity_torque": np.sin(turned), "load.gravity_phase": drive.load.gravity_torque * np.cos(turned)}
    return slopes


def per_torque(drive: Drive, effort: str) -> float:
    """Effort per torque at the input: of a motor whose torque constant is not known, a torque in A."""
    constant = float(getattr(drive.motor, "torque_constant", 1.0))
    per = {"current": 1.0 / constant, "input_torque": 1.0, "joint_torque": drive.gear.kinematics.ratio}
    return per[effort] if effort in per else float(getattr(drive.motor, "resistance", 0.0)) / constant


def _check_both_ways(motion: Motion) -> None:
    forward, backward = (int(np.sum(way * motion.speed[motion.rows] > 0.0)) for way in (1.0, -1.0))
    if forward + backward == 0:
        raise ValueError(
            "the shaft hardly moves: all of the log is rest, reversals or gaps; record a larger motion, or, if it went to and "
            "fro before it slid, say so with --kind presliding"
        )
    if min(forward, backward) < FEWEST:
        raise ValueError(
            f"the shaft moves forward in {forward} and backward in {backward} of the samples compared; {FEWEST} of each are "
            "needed to tell Coulomb's friction from a constant torque: record motion both ways"
        )


def spoilt(values: Array) -> NDArray[np.bool_]:
    """Samples that are outliers among their neighbours, or clipped at the end of the range.

    Outliers: farther off the median of seven than six standard deviations of the noise (Hampel 1974). The noise is that of
    second differences: the median follows both noise and motion, so that what is off it would tell too little. Clipped: the
    largest or smallest level that comes again and again, though an outlier may lie beyond.
    """
    from scipy import ndimage

    clipped = _clipped(values) | _clipped(-values)
    off = np.abs(values - ndimage.median_filter(values, 7, mode="nearest"))
    scale = noise(values[~clipped]) if np.median(off) > 0.0 else np.inf  # without noise extremes look like outliers
    outliers = off > OUTLYING * scale
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
