"""Torque over twist along a slow path, as an experiment."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from strainwave import _core, arguments
from strainwave._core import Gear
from strainwave.analysis.branches import PRESLIDING_SHARE, monotone, slid, still_slides, thinned, turning_points
from strainwave.analysis.torsion_loop import series_compliance
from strainwave.equality import ComparedByFields
from strainwave.files.recording import Recording, check_recording
from strainwave.identification.experiments.experiment import RELATIVE_STEP, Nuisance, changing, with_step

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class TorsionLoop(ComparedByFields):
    """Torque over twist along a path that is slow: spring, hysteresis and friction at rest alone determine it.

    A loop does not determine the zeros of both axes, so both are unknowns of the measurement. A linear spring does not separate
    them; for it the zero of the twist is taken as known. A path that never turns back, a single branch, determines neither: it
    is taken to begin with an unloaded gear at the zeros of both axes.

    A drift is the change of the zero of a sensor from begin to end, in proportion to time; without a clock, to the samples.

    At the input, with the output locked, the friction of the wave generator is inside the loop: the model's `friction_input` at
    rest, times the ratio.

    Args:
        twist: twist at the output [rad], shape (n,), monotone between its points
        torque: torque referred to the output [N.m], shape (n,)
        history: cyclic, if the same path had been run before; virgin, if the gear had not been loaded before
        torque_zero: initial value of the zero of the torque [N.m]
        twist_zero: zero of the twist, if it is known [rad]
        near_zero: initial value of the zero of the twist [rad]; half way between the ends if not given
        torque_drift: initial value of the drift of the torque from begin to end [N.m]; no drift if None
        twist_drift: the same of the twist [rad]
        moments: time of each sample as a share of the duration, shape (n,); in equal steps if not given
        input_ratio: ratio of the gear if it was measured at the input, None if at the output
        samples: count of those measured; more than are left in `twist` if each is the mean of several
        corners: twists [rad] of a beginning and of reversals that are not compared, each with the number of the sample that
            comes after it
    """

    twist: Array
    torque: Array
    history: Literal["cyclic", "virgin"] = "cyclic"
    torque_zero: float = 0.0
    twist_zero: float | None = None
    near_zero: float | None = None
    torque_drift: float | None = None
    twist_drift: float | None = None
    moments: Array | None = None
    input_ratio: float | None = None
    samples: int = 0
    corners: tuple[tuple[int, float], ...] = ()
    channels = ("torque",)
    units = ("N.m",)

    @classmethod
    def of(cls, recording: Recording, gear: Gear) -> TorsionLoop:
        """Return the loop of columns twist and torque at the output, or input_angle and input_torque with the output locked.

        A loop at the input is referred to the output: twist = input_angle / i, torque = i input_torque. Its samples just behind
        a beginning or a reversal are left out: there friction turns over while its bristles bend, over a distance that no loop
        determines. A long recording is thinned to the means of equal stretches. The compliance of the stages of a gear is taken
        out of the twist: the rest is that of the spring.

        Raises:
            ValueError: a loop at the input of a gear with stages
        """
        check_recording("recording", recording)
        ratio = arguments.gear(gear).kinematics.ratio if at_input(recording) else None
        if ratio is not None:
            angle, input_torque = changing(recording, "input_angle", "rad"), changing(recording, "input_torque", "N.m")
            twist, torque = angle / ratio, ratio * input_torque
        else:
            twist, torque = changing(recording, "twist", "rad"), changing(recording, "torque", "N.m")
        give = series_compliance(gear)
        if give > 0.0 and ratio is not None:
            raise ValueError(
                "a torsion loop at the input does not determine which torque the stages of the gear transmit, as the friction "
                "of the input is inside; measure it at the output, or fit a gear without stages: gear.replace(structure="
                "structure.Lumped())"
            )
        twist = twist - give * torque
        clock = recording.time if "time" in recording.names else np.arange(float(len(recording)))
        duration = float(np.ptp(clock))
        moments = (clock - clock[0]) / duration if duration > 0.0 else np.linspace(0.0, 1.0, len(clock))
        twist, torque, moments = thinned(twist, torque, moments)
        corners: list[tuple[int, float]] = []
        if ratio is not None:
            settled = slid(twist)
            turns = turning_points(twist)
            settled[turns] = [still_slides(twist, torque, turn) for turn in turns]
            left_out = [turn for turn in (0, *turns) if not settled[turn]]
            corners = [(int(np.sum(settled[:turn])), float(twist[turn])) for turn in left_out]
            twist, torque, moments = twist[settled], torque[settled], moments[settled]
        loop = cls(twist, torque, moments=moments, input_ratio=ratio, samples=len(recording), corners=tuple(corners))
        return replace(loop, history="virgin", twist_zero=0.0) if loop.single_branch else loop

    def __post_init__(self) -> None:
        if np.ptp(self.twist) == 0.0:
            raise ValueError("the twist never changes: give the column of the twist, of a loop that loads and unloads the gear")
        span = float(np.ptp(self.twist) * np.ptp(self.torque))
        if np.cov(self.twist, self.torque)[0, 1] < 0.0:
            raise ValueError(
                "the torque falls as the twist grows; give both the same sense, as an elastic gear has them: "
                "reverse the sign of one of the two columns"
            )
        closed = abs(self.twist[-1] - self.twist[0]) < 0.05 * np.ptp(self.twist)
        if closed and np.trapezoid(self.torque, self.twist) < -0.01 * span:
            raise ValueError(
                "the loop gives energy instead of losing it; give its samples in the order in which they were measured"
            )

    @property
    def measured(self) -> Array:
        return self.torque[np.newaxis]

    @property
    def nuisances(self) -> tuple[Nuisance, ...]:
        if self.single_branch:
            return ()
        unknowns = [Nuisance("torque_zero", "N.m", self.torque_zero)]
        if self.twist_zero is None:
            unknowns.append(Nuisance("twist_zero", "rad", self.centre))
        if self.torque_drift is not None:
            unknowns.append(Nuisance("torque_drift", "N.m", self.torque_drift))
        if self.twist_drift is not None:
            unknowns.append(Nuisance("twist_drift", "rad", self.twist_drift))
        return tuple(unknowns)

    @cached_property
    def single_branch(self) -> bool:
        """True if the twist never turns back, so that stiffness and hysteresis are not separated."""
        return not turning_points(self.twist)

    @cached_property
    def middle(self) -> float:
        """Twist half way between the ends of the loop [rad]."""
        return 0.5 * float(self.twist.min() + self.twist.max())

    @property
    def centre(self) -> float:
        """Zero of the twist before a fit [rad]."""
        return self.middle if self.near_zero is None else self.near_zero

    @cached_property
    def unloaded(self) -> float | None:
        """Twist half way between the branches where the torque passes its zero [rad]; none if it does not, up and down.

        Unlike the middle, it does not move where the gear is twisted farther to one side.
        """
        up, down = (_crossings(self.twist, sense * self.torque) for sense in (1.0, -1.0))
        return 0.5 * float(up.mean() + down.mean()) if len(up) and len(down) else None

    @cached_property
    def _behind_middle(self) -> Array:
        """Time of each sample from the middle of the record, as a share of the record: the share of a drift there."""
        return (np.linspace(0.0, 1.0, len(self.twist)) if self.moments is None else self.moments) - 0.5

    def without_drift(self) -> TorsionLoop:
        """Return the loop less the initial value of its drift."""
        if self.torque_drift is None and self.twist_drift is None:
            return self
        twist = self.twist - (self.twist_drift or 0.0) * self._behind_middle
        torque = self.torque - (self.torque_drift or 0.0) * self._behind_middle
        return replace(self, twist=twist, torque=torque, torque_drift=None, twist_drift=None)

    def path(self, twist_zero: float, twist_drift: float = 0.0) -> Array:
        """Return the twist from its zero, where the gear is virgin, with the run before that a cyclic history needs."""
        places, twists = [place for place, _ in self.corners], [twist for _, twist in self.corners]
        path = np.insert(self.twist - twist_drift * self._behind_middle, places, twists) - twist_zero
        return np.concatenate(([0.0], path, path)) if self.history == "cyclic" else np.concatenate(([0.0], path))

    @cached_property
    def compared(self) -> NDArray[np.intp] | slice:
        """Places of the samples in the path, counted from its end."""
        if not self.corners:
            return slice(-len(self.twist), None)
        places = np.arange(-len(self.twist) - len(self.corners), 0)
        return np.delete(places, [place + before for before, (place, _) in enumerate(self.corners)])

    def predict(self, model: Gear, numbers: Sequence[int], nuisances: Array) -> tuple[Array, Array]:
        unknown: dict[str, float] = dict(zip([each.name for each in self.nuisances], nuisances.tolist(), strict=True))
        twist_zero = 0.0 if self.single_branch else unknown.get("twist_zero", self.twist_zero or 0.0)
        torque_drift, twist_drift = unknown.get("torque_drift", 0.0), unknown.get("twist_drift", 0.0)
        n = len(self.twist)
        torque, slopes = _core.differentiate_loop(model, self.path(twist_zero, twist_drift), list(numbers))
        *by_numbers, by_shift = slopes[:, self.compared]
        if self.input_ratio is not None:
            by_numbers = [
                slope + self._friction_slope(model, number) for slope, number in zip(by_numbers, numbers, strict=True)
            ]
        by_unknowns = {"torque_zero": np.ones(n), "twist_zero": -by_shift, "torque_drift": self._behind_middle}
        if "twist_drift" in unknown:
            step = RELATIVE_STEP * float(np.ptp(self.twist))  # by differences: dual numbers shift all samples
            moved = (model.trace(self.path(twist_zero, twist_drift + sense * step)) for sense in (1.0, -1.0))
            ahead, back = (there[self.compared] for there in moved)
            by_unknowns["twist_drift"] = np.asarray((ahead - back) / (2.0 * step))
        predicted = (
            torque[self.compared] + unknown.get("torque_zero", 0.0) + torque_drift * self._behind_middle + self.friction(model)
        )
        return predicted[np.newaxis], np.stack([*by_numbers, *(by_unknowns[name] for name in unknown)])[:, np.newaxis]

    def friction(self, model: Gear) -> Array:
        """Return the torque of friction at rest [N.m], shape (n,): that of the input if measured there, else none."""
        if self.input_ratio is None:
            return np.zeros_like(self.twist)
        torque = self.input_ratio * model.friction_input.quasistatic(self.input_ratio * self._displacement)
        return np.asarray(torque[-len(self.twist) :])

    def _friction_slope(self, model: Gear, number: int) -> Array:
        """Return the derivative of `friction` by a number of the gear, by differences: it is all but linear in most of them.

        Upwards for a breakaway, which counts above an equal Coulomb torque alone, and downwards for the others.
        """
        path, value, *_ = _core.parameters(model)[number]
        if self.input_ratio is None or not path.startswith("friction_input."):
            return np.zeros_like(self.twist)
        step = RELATIVE_STEP * max(abs(value), 1e-6)
        other, change = with_step(model, number, step if path.endswith("breakaway") else -step)
        return (self.friction(other) - self.friction(model)) / change

    @cached_property
    def _displacement(self) -> Array:
        """Path of the friction [rad]: it must not turn at each wiggle of the noise, as that of a spring may.

        It begins so far before the first sample that friction slides there, as it does in all that is left of a loop.
        """
        twist = monotone(self.twist)
        if self.history == "cyclic":
            return np.concatenate(([self.middle], twist, twist))
        sense = np.sign(twist[np.argmax(twist != twist[0])] - twist[0])
        return np.concatenate(([twist[0] - sense * PRESLIDING_SHARE * np.ptp(twist)], twist))


def _crossings(twist: Array, torque: Array) -> Array:
    """Return the twists at which the torque passes zero upwards [rad]."""
    at = np.flatnonzero((torque[:-1] < 0.0) & (torque[1:] >= 0.0))
    share = torque[at] / (torque[at] - torque[at + 1])
    return np.asarray(twist[at] + share * (twist[at + 1] - twist[at]))


def at_input(recording: Recording) -> bool:
    """True if a torsion loop was measured at the input, with the output locked."""
    return not {"twist", "torque"} <= set(recording.names)
