"""A log of a moving drive along its measured motion, whose torque is compared, as an experiment."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive, _core, arguments, loads
from strainwave._core import Gear
from strainwave.equality import ComparedByFields
from strainwave.files.recording import Recording
from strainwave.identification.experiments.experiment import (
    RELATIVE_STEP,
    Nuisance,
    changing,
    check_columns,
    sensible,
    with_step,
)
from strainwave.identification.experiments.friction_table import FRICTIONLESS, ROOM_TEMPERATURE
from strainwave.identification.experiments.motion import MAX_GAP_STEPS, Motion, in_gap, motion_of
from strainwave.messages import listed
from strainwave.native import kernels
from strainwave.statistics.scale import NORMAL_MAD, noise_sigma

Array = NDArray[np.float64]
Side = Literal["input", "output"]
EFFORTS = {"current": "A", "input_torque": "N.m", "joint_torque": "N.m", "voltage": "V"}  # best first
REVERSAL_ANGLE = 0.1  # rad of the input: bristles have bent by then (assumed), and friction is that of sliding
MAX_OUTLIER_SIGMA = 6.0  # standard deviations of the noise
CATMULL_ROM = np.array([[0, -1, 2, -1], [2, 0, -5, 3], [0, 1, 4, -3], [0, 0, -1, 1]]) / 2  # of 1, u, u2, u3: of four samples
OUTLIER_WINDOW = 101  # samples, over which ripple and noise may grow
MAX_SHARE_OF_GAPS = 0.2  # of the time of a log: with more of it, gaps are why nothing is left to compare
MIN_SOUND = 0.999  # share of sound samples around an instant: rounding of times decides nothing
HELD_QUANTILE = 0.98  # of the steps of a channel without noise, whose size stands for it
MIN_CLIPPED = 20  # samples of one level at the end of the range
MIN_SHARE_OF_A_DIRECTION = 0.02  # of the samples compared
OF_MOTOR = ("motor.torque_constant", "motor.resistance", "motor.back_emf")  # numbers that scale the effort
TURNS_OVER = 0.005  # of a fast speed: about there the sign of friction turns over, so that it is smooth at rest (assumed)
SHARE_OF = "share of "  # in front of the name of a term of other joints: the path of its share
FAST_QUANTILE = 0.99  # of the size of the speed
MAX_OFF_RATIO = 0.01  # relative difference of the ratio of two encoders from that of the drive, which then turns the load
MIN_INERTIA = 1e-12  # kg.m2: a load and a motor must have some
MIN_INERTIA_SHARE = 0.02  # of all that turns: from where the fit of an inertia starts
INPUT_COUNT, LOAD_PLACE, TEMPERATURE_PLACE = 6, 2, 4  # inputs of the inverse dynamics, and places of two of them


@dataclass(frozen=True, eq=False)
class MotionLog(ComparedByFields):
    """A log of the torque, current or voltage that a drive needed, compared along the motion that was measured.

    Nothing is simulated: command, controller and beginning need not be known, and an error of one moment is forgotten at the
    next. The drive is taken as rigid: gear and shafts turn together, so that the pass band must lie well below its first
    elastic mode. A fit compares moments of sliding in the pass band; `residual` compares every sample, at rest, too.

    Args:
        motion: of the input
        effort: channel compared: `current`, `input_torque`, `joint_torque` (the motor's, counted at the output) or `voltage`
        force: the effort on the grid of the motion, without outliers, shape (m,)
        recorded: the same as it was recorded, shape (m,)
        sound: False at outliers and clipped samples of the effort, and in gaps, shape (m,)
        extra: torque of other bodies that hold the output back, on the grid of the motion [N.m]; zero if nothing is known
        regressors: series on the grid whose share in the torque of the output is an unknown, by name
        delayed: True if a delay of the effort behind the motion is an unknown
        starts: initial value of each nuisance; zero if not given
    """

    motion: Motion
    effort: str
    force: Array
    recorded: Array
    sound: NDArray[np.bool_]
    extra: Array
    regressors: Mapping[str, Array] = field(default_factory=dict)
    delayed: bool = False
    starts: tuple[float, ...] = ()

    @classmethod
    def of(
        cls, recording: Recording, drive: Drive, *, cutoff: float | None = None, regressors: Sequence[str] = ()
    ) -> MotionLog:
        """Return the experiment of a recording with columns time, an angle (input_angle, else output_angle), and an effort.

        A column `rigid_torque` [N.m at the output] is known torque of other bodies; `regressors` names columns whose share in
        the torque is unknown, as those of an arm that moves together with others.

        Raises:
            ValueError: a column is missing, or the angle does not determine the motion
        """
        check_columns(recording, ("time",), "the log")
        arguments.drive(drive)
        from scipy.interpolate import Akima1DInterpolator

        effort = next((name for name in EFFORTS if name in recording), None)
        if effort is None:
            raise ValueError(f"the log needs an effort, one of {listed(EFFORTS)}; it has {listed(recording.names)}")
        time, angle = recording.time, _input_angle(recording, drive)
        if np.ptp(angle) == 0.0:
            raise ValueError(
                "the angle never changes: only a shaft that moves shows inertia and friction; "
                "record a motion, or give the column of the angle that moves"
            )
        motion = motion_of(time, angle, cutoff, REVERSAL_ANGLE)

        def on_grid(values: Array) -> Array:
            return np.interp(motion.time, time, values)

        values = changing(recording, effort, EFFORTS[effort])
        sound = ~spoilt(values)
        force = np.asarray(Akima1DInterpolator(time[sound], values[sound], extrapolate=True)(motion.time))  # as the angle is
        sound_there = (on_grid(sound.astype(float)) > MIN_SOUND) & ~in_gap(time, motion.time, motion.step)
        motion = replace(motion, known=motion.known & sound_there, wind_up=_wind_up(recording, motion, drive))
        _check_moves(motion, time)
        extra = on_grid(recording.values("rigid_torque", "N.m")) if "rigid_torque" in recording else np.zeros_like(motion.time)
        return cls(
            motion, effort, force, on_grid(values), sound_there, extra,
            {name: on_grid(recording[name]) for name in regressors},
        )  # fmt: skip

    @cached_property
    def measured(self) -> Array:
        """Effort in the pass band, shape (1, n)."""
        return self.motion.filtered(self.force)[np.newaxis]

    @property
    def channels(self) -> tuple[str, ...]:
        return (self.effort,)

    @property
    def units(self) -> tuple[str, ...]:
        return (EFFORTS[self.effort],)

    @property
    def time(self) -> Array:
        """Instants that are compared in the pass band [s], shape (n,)."""
        return self.motion.time[self.motion.rows]

    @property
    def nuisances(self) -> tuple[Nuisance, ...]:
        """Zero of the effort, if the shaft moves both ways; its delay; and the shares of other bodies."""
        described = [(f"{self.effort}_zero", EFFORTS[self.effort])] if self.both_ways else []
        described += [("delay", "s")] if self.delayed else []
        described += [(f"{SHARE_OF}{name}", "1") for name in self.regressors]
        starts = self.starts or (0.0,) * len(described)
        return tuple(Nuisance(name, unit, start) for (name, unit), start in zip(described, starts, strict=True))

    def with_measured_speed(self, recording: Recording, ratio: float) -> MotionLog | None:
        """Return the same along the recorded speed; None if there is none.

        Args:
            recording: of the log
            ratio: speed of the input over that of the output
        """
        for name, factor in (("input_speed", 1.0), ("output_speed", ratio)):
            if name in recording:
                speed = np.interp(self.motion.time, recording.time, factor * recording.values(name, "rad/s"))
                return replace(self, motion=self.motion.at_speed(speed))
        return None

    @cached_property
    def share_of_rarer_way(self) -> float:
        """Share of the samples in the direction of motion that has fewer [1]."""
        speed = self.motion.speed[self.motion.known]
        return min(float(np.mean(way * speed > 0.0)) for way in (1.0, -1.0))

    @property
    def both_ways(self) -> bool:
        """True if the shaft moves both ways: only then Coulomb's friction differs from a constant torque."""
        return self.share_of_rarer_way >= MIN_SHARE_OF_A_DIRECTION

    def below(self, frequency: float) -> MotionLog:
        """Return the same, compared far below a vibration of this frequency [Hz]: above, the drive is not rigid.

        Raises:
            ValueError: too little of the motion is left
        """
        motion = self.motion.below(frequency)
        _check_moves(motion)
        return replace(self, motion=motion)

    def in_full_band(self) -> MotionLog:
        """Return the same, compared in the full band, near reversals, too."""
        return replace(self, motion=self.motion.in_full_band())

    def sliding_in_full_band(self) -> MotionLog:
        """Return the same, compared in the full band where the drive slides."""
        return replace(self, motion=self.motion.unfiltered())

    @property
    def delay(self) -> float:
        """Initial value of the delay of the effort behind the motion [s]."""
        return next((each.start for each in self.nuisances if each.name == "delay"), 0.0)

    def with_delay(self) -> MotionLog:
        """Return the same, with a delay of the effort behind the motion as an unknown."""
        return replace(self, delayed=True, starts=())

    def starting(self, nuisances: Sequence[float]) -> MotionLog:
        """Return the same, with initial values of the nuisances."""
        return replace(self, starts=tuple(nuisances))

    def predict(self, model: Drive, numbers: Sequence[int], nuisances: Array) -> tuple[Array, Array]:
        effort, slopes = self._on_grid(model, numbers, nuisances)
        in_band = self.motion.filtered(np.stack([effort, *slopes]))
        return in_band[:1], in_band[1:, np.newaxis]

    def whole(self, model: Drive, nuisances: Array) -> Array:
        """Return the effort that a model predicts at every instant of the grid, shape (m,).

        Friction without bristles turns over with the sign of the speed, of which noise and the instant of a sample decide near
        zero: there the effort is the mean over both senses by their chance, as plain least squares has it.
        """
        motion, others = self.motion, self._others(nuisances)
        if model.gear.friction_input.set_valued:
            motion = replace(motion, resting=np.zeros_like(motion.resting))
            chance = 0.5 + 0.5 * np.tanh(np.abs(motion.speed) / turnover_speed(motion.speed))
            along, against = (needed_torque(model, each, others)[0] for each in (motion, replace(motion, speed=-motion.speed)))
            torque = chance * along + (1.0 - chance) * against
        else:
            torque, _ = needed_torque(model, motion, others)
        unknown = self._unknown(nuisances)
        effort = per_torque(model, self.effort) * torque + self.induced(model)
        if self.delayed:
            effort = late(effort[np.newaxis], unknown["delay"], self.motion.step)[0][0]
        return np.asarray(effort + unknown.get(f"{self.effort}_zero", 0.0))

    def residual(self, model: Drive, nuisances: Array) -> Array:
        """Return measured less predicted effort at every instant of the grid, at rest, too, shape (m,).

        Outliers and clipped samples have none.
        """
        return np.where(self.sound, self.recorded - self.whole(model, nuisances), 0.0)

    def _on_grid(self, model: Drive, numbers: Sequence[int], nuisances: Array) -> tuple[Array, Array]:
        """Return the effort at every instant of the grid, and its derivatives by numbers of the drive and by the nuisances."""
        unknown, others = self._unknown(nuisances), self._others(nuisances)
        described = _core.parameters(model)
        paths = [described[number][0] for number in numbers]
        scale = per_torque(model, self.effort)
        torque, by_numbers = needed_torque(model, self.motion, others, paths)
        effort = scale * torque + self.induced(model)
        slopes = [
            self._by_motor(model, number, others, effort) if path in OF_MOTOR else scale * by
            for number, path, by in zip(numbers, paths, by_numbers, strict=True)
        ]
        by_load = scale * self._by_load(model, others, torque) if self.regressors else torque
        of_shares = [by_load * each for each in self.regressors.values()]
        series = np.stack([effort, *slopes, *of_shares])
        of_measurement = [np.ones_like(effort)] if f"{self.effort}_zero" in unknown else []
        if self.delayed:
            series, by_delay = late(series, unknown["delay"], self.motion.step)
            of_measurement.append(by_delay)
        by_numbers, by_shares = np.split(series[1:], [len(slopes)])
        every = np.array([*by_numbers, *of_measurement, *by_shares]).reshape(-1, len(effort))
        return series[0] + unknown.get(f"{self.effort}_zero", 0.0), every

    def _unknown(self, nuisances: Array) -> dict[str, float]:
        """Return the value of each nuisance by its name."""
        return dict(zip([each.name for each in self.nuisances], nuisances.tolist(), strict=True))

    def _others(self, nuisances: Array) -> Array:
        """Return the torque of other bodies that hold the output back [N.m], by the shares among the nuisances, shape (m,)."""
        shares = nuisances[len(nuisances) - len(self.regressors) :]
        return sum((share * each for share, each in zip(shares, self.regressors.values(), strict=True)), self.extra)

    def induced(self, model: Drive) -> Array:
        """Return the part of the effort that makes no torque: the voltage that a motor induces as it turns [V]; else 0."""
        constant = float(getattr(model.motor, "back_emf", 0.0)) if self.effort == "voltage" else 0.0
        return constant * self.motion.speed

    def _by_motor(self, model: Drive, number: int, others: Array, effort: Array) -> Array:
        """Return the derivative by a number of the motor: a difference good to eight digits, as the effort is smooth in it."""
        other, change = with_step(model, number, RELATIVE_STEP * max(abs(_core.parameters(model)[number][1]), 1e-3))
        torque, _ = needed_torque(other, self.motion, others)
        return np.asarray((per_torque(other, self.effort) * torque + self.induced(other) - effort) / change)

    def _by_load(self, model: Drive, others: Array, torque: Array) -> Array:
        """Return the derivative of the torque at the input by one at the output, of which friction takes its share [1]."""
        step = RELATIVE_STEP * max(
            float(np.abs(others).max()), abs(model.gear.kinematics.ratio) * float(np.abs(torque).max()), 1e-6
        )
        there, _ = needed_torque(model, self.motion, others + step)
        return np.asarray((there - torque) / step)


def late(series: Array, delay: float, step: float) -> tuple[Array, Array]:
    """Return series after a delay, and the derivative of the first by the delay, shapes (k, n), (n,).

    Interpolated by the cubic of Catmull and Rom (1974), whose slope has no steps: a fit of the delay then ends.

    Args:
        series: shape (k, n)
        delay: [s]
        step: between samples [s]
    """
    n = series.shape[1]
    shift = min(max(delay / step, -n), n)
    whole = int(np.floor(shift))
    u = 1.0 - (shift - whole)
    weights = CATMULL_ROM @ np.array([1.0, u, u**2, u**3])
    change = CATMULL_ROM @ np.array([0.0, 1.0, 2.0 * u, 3.0 * u**2]) / -step
    near = series[:, np.clip(np.arange(-2, n + 1) - whole, 0, n - 1)]
    after, by_delay = np.zeros_like(series), np.zeros(n)
    for tap, (weight, rate) in enumerate(zip(weights, change, strict=True)):
        after = after + weight * near[:, tap : tap + n]
        by_delay = by_delay + rate * near[0, tap : tap + n]
    return after, by_delay


def turnover_speed(speed: Array) -> float:
    """Return the speed of the input about which the sign of friction turns over [rad/s], by the speeds of a log."""
    return max(TURNS_OVER * float(np.quantile(np.abs(speed), FAST_QUANTILE)), 1e-300)


def inertia_of(drive: Drive) -> float:
    """Return the inertia of the load [kg.m2]; 0 for one that is moved from outside."""
    return float(getattr(drive.load, "inertia", 0.0))


def needed_torque(drive: Drive, motion: Motion, others: Array, paths: Sequence[str] = ()) -> tuple[Array, Array]:
    """Return the torque at the input [N.m] that a rigid drive needs along a motion, and its derivatives.

    .. math:: \\tau = (J_m + J_g) \\dot\\omega + F_{in}(\\omega, T / i) + [F_{mesh}(\\omega / i, T) + T] / i, \\qquad
              T = J_l \\dot\\omega / i + T_{load}(\\theta / i) + F_{out}(\\omega / i)

    Args:
        drive: with any load and friction; a bristle bends along the motion
        motion: of the input
        others: torque of other bodies that hold the output back [N.m], shape (n,)
        paths: numbers of the drive that the torque is differentiated by

    Returns:
        torque, shape (n,); derivatives, shape (paths, n), 0 by numbers that a rigid drive lacks
    """
    gear = drive.gear  # without stiffness, hysteresis and kinematic error: a measured motion contains what they do
    friction = {place: getattr(gear, place) for place in ("friction_input", "friction_mesh", "friction_output")}
    rigid = drive.replace(gear=Gear(kinematics=gear.kinematics, input_inertia=gear.input_inertia, **friction))
    numbers = {path: number for number, (path, *_) in enumerate(_core.parameters(rigid))}
    inputs = np.zeros((len(motion.time), INPUT_COUNT))
    by_wind_up = _gravity_by_wind_up(drive, motion)
    inputs[:, LOAD_PLACE], inputs[:, TEMPERATURE_PLACE] = others + by_wind_up.get("", 0.0), ROOM_TEMPERATURE
    places = [place for place, path in enumerate(paths) if path in numbers]
    speed, steps = np.where(motion.resting, 0.0, motion.speed), np.diff(motion.time, prepend=motion.time[0])
    states = np.column_stack([motion.angle, speed, motion.acceleration, steps])
    asked = [numbers[paths[place]] for place in places]
    with kernels.prepared(rigid, "inverse_dynamics", len(inputs)):
        torque, by_numbers = _core.inverse_dynamics(rigid, states, inputs, asked)
        slopes = np.zeros((len(paths), len(torque)))
        slopes[places] = by_numbers
        if by_wind_up.keys() & set(paths):
            step = RELATIVE_STEP * max(
                float(np.abs(inputs[:, LOAD_PLACE]).max()), abs(gear.kinematics.ratio) * float(np.abs(torque).max())
            )
            inputs[:, LOAD_PLACE] += step
            by_load = (_core.inverse_dynamics(rigid, states, inputs, [])[0] - torque) / step
            slopes += [by_load * by_wind_up.get(path, 0.0) for path in paths]
    return torque, slopes


def _gravity_by_wind_up(drive: Drive, motion: Motion) -> dict[str, Array]:
    """Return the torque that a wound-up gear adds to the gravity of a rigid one, by the name "", and its derivatives by path.

    The load hangs at the angle of the output. Empty if it was not measured beside the input, or if the load has no gravity.
    """
    load, ratio = drive.load, drive.gear.kinematics.ratio
    if motion.wind_up is None or not motion.wind_up.any() or not isinstance(load, loads.Pendulum):
        return {}
    there, rigid = motion.output_angle(ratio) + load.gravity_phase, motion.angle / ratio + load.gravity_phase
    by_gravity, by_phase = np.sin(there) - np.sin(rigid), np.cos(there) - np.cos(rigid)
    torque = load.gravity_torque
    return {"": torque * by_gravity, "load.gravity_torque": by_gravity, "load.gravity_phase": torque * by_phase}


def transmitted_torque(log: MotionLog, drive: Drive) -> Array:
    """Return the torque that a rigid gear transmits to the output, on the grid of the motion [N.m]."""
    gear = drive.gear.replace(friction_input=FRICTIONLESS, friction_mesh=FRICTIONLESS, input_inertia=0.0)
    still = drive.replace(gear=gear, motor=drive.motor.replace(inertia=MIN_INERTIA))
    return np.asarray(gear.kinematics.ratio * needed_torque(still, log.motion, log.extra)[0])


def per_torque(drive: Drive, effort: str) -> float:
    """Return the effort per torque at the input: of a motor whose torque constant is not known, a torque in A."""
    constant = float(getattr(drive.motor, "torque_constant", 1.0))
    per = {"current": 1.0 / constant, "input_torque": 1.0, "joint_torque": drive.gear.kinematics.ratio}
    return per[effort] if effort in per else float(getattr(drive.motor, "resistance", 0.0)) / constant


def _check_moves(motion: Motion, time: Sequence[float] | Array = ()) -> None:
    """Raise ValueError if nothing is left to compare; `time` of the rows shows if gaps between them are the cause."""
    if np.any(motion.speed[motion.rows] != 0.0):
        return
    steps = np.diff(time)
    gaps = steps[steps > MAX_GAP_STEPS * np.median(steps)] if len(steps) else steps
    if gaps.sum() > MAX_SHARE_OF_GAPS * steps.sum():
        raise ValueError(
            f"{len(gaps)} gaps fill {gaps.sum():.3g} s of its {steps.sum():.3g} s, and what lies between them is too short to "
            "determine a motion: record without gaps"
        )
    raise ValueError(
        "the shaft hardly moves: all of the log is rest or reversals; record a larger motion, or, if it went to and fro before "
        "it slid, add --kind presliding"
    )


def spoilt(values: Array) -> NDArray[np.bool_]:
    """Return True for samples that are outliers among their neighbours, or clipped at the end of the range, shape (n,).

    Outliers: farther off the median of seven than six standard deviations of the noise (Hampel 1974). The noise is that of
    second differences: the median follows noise and motion, so that residuals from it are too small. Ripple that grows, as with
    the speed, is in the samples around. Clipped: the largest or smallest level that comes again and again; an outlier may lie
    beyond.
    """
    from scipy import ndimage

    clipped = _clipped(values) | _clipped(-values)
    if clipped.all():  # a square wave, no range that is too small
        clipped = np.zeros(len(values), bool)
    off = np.abs(values - ndimage.median_filter(values, 7, mode="nearest"))
    scale = noise_sigma(values[~clipped])
    if np.median(off) == 0.0:  # values that are held or smooth, of which extremes would look like outliers
        scale = float(np.quantile(np.abs(np.diff(values)), HELD_QUANTILE)) or np.inf
    around = ndimage.median_filter(off, OUTLIER_WINDOW, mode="nearest") / NORMAL_MAD
    outliers = off > MAX_OUTLIER_SIGMA * np.maximum(scale, around)
    return np.asarray(outliers | clipped, bool)


def _clipped(values: Array) -> NDArray[np.bool_]:
    """Return True for samples at the upper end of a range that was too small, shape (n,)."""
    levels, counts = np.unique(values, return_counts=True)
    upper = levels >= np.quantile(values, 0.9)
    if not upper.any():
        return np.zeros(len(values), bool)
    usual = float(np.median(counts))
    level = levels[upper][np.argmax(counts[upper])]
    often = counts[upper].max() >= max(MIN_CLIPPED, 10.0 * usual)
    end = often and np.mean(values > level) < 0.03
    return (values >= level) if end else np.zeros(len(values), bool)


def _wind_up(recording: Recording, motion: Motion, drive: Drive) -> Array | None:
    """Return the angle of the output less that of the input over the ratio, about its mean [rad], shape (m,).

    0 if the output alone was measured. None if the input alone was, or if both do not turn in the ratio of the drive.
    """
    if "output_angle" not in recording:
        return None
    if "input_angle" not in recording:
        return np.zeros_like(motion.time)
    output = np.interp(motion.time, recording.time, sensible(recording, "output_angle", "rad"))
    rigid = motion.angle / drive.gear.kinematics.ratio
    share = float(np.polyfit(rigid - rigid.mean(), output - output.mean(), 1)[0])
    if abs(abs(share) - 1.0) > MAX_OFF_RATIO:
        return None
    wind_up = np.sign(share) * output - rigid
    return np.asarray(wind_up - wind_up.mean())


def _input_angle(recording: Recording, drive: Drive) -> Array:
    """Return the angle of the input [rad]: measured there, or that of a rigid gear."""
    if "input_angle" in recording:
        return sensible(recording, "input_angle", "rad")
    if "output_angle" in recording:
        return drive.gear.kinematics.ratio * sensible(recording, "output_angle", "rad")
    raise ValueError(f"the log needs an angle, input_angle or output_angle; it has {listed(recording.names)}")
