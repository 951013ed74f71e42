"""Loops of a cascade in a computer, linearised: their margins, their poles and their frequency response."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from math import inf, isfinite, tau
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from strainwave import Compensation, Drive, arguments, compensation, control, typeset
from strainwave.analysis.plots import Response, bode_figure, phase_in_degrees, set_phase_ticks
from strainwave.drawing import marks
from strainwave.drawing.style import LIGHT
from strainwave.equality import ComparedByFields
from strainwave.files.gear_set import GearSet
from strainwave.presentation import Pictured, Presented, Row
from strainwave.tuning.cascade import Plant, Setting, observer_of, tuned_law
from strainwave.tuning.linear_plant import HeldPlant, LinearPlant
from strainwave.typeset import number

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

MIN_MODULUS = 0.5  # modulus margin of the sharpest cascade: no disturbance is more than doubled
MAX_SHARPNESS = 2.0  # of a cascade; at 1 the delay takes half a radian at the crossover of its speed loop
SHARPNESS_HALVINGS = 10  # of the sharpness that are tried, in steps of a root of 2
FREQUENCY_COUNT = 1000  # of a loop, up to half the sample rate
FREQUENCIES_OF_PEAK = 100  # likewise, around each vibration
LOWEST_SHARE = 1e-5  # lowest frequency over half the sample rate
MAX_JUMP = 0.5  # of half a turn of the loop, or of the logarithm of its size, from one frequency to the next
MAX_POLE_RADIUS = 1.0 + 1e-7  # of a loop that is stable: a free angle has 1
MAX_FREQUENCY_FACTOR = 30.0  # of the frequencies of the margins, down and up, that is drawn
MAX_MAGNITUDE = 1e3  # magnitude that is drawn, and its inverse
PHASE_MARGIN = 20.0  # degrees between the curves and the edge


@dataclass(frozen=True, eq=False)
class Margins(ComparedByFields, Presented):
    """Stability margins of a loop.

    Attributes:
        gain: factor by which the gain may rise; infinite if any
        phase: lag that may be added where the gain is 1 [rad]; infinite if the gain is below 1 everywhere
        modulus: least distance of the loop from -1, the inverse of the peak of its sensitivity; 0 if the loop is not stable
        crossover: highest frequency at which the gain is 1 [rad/s]; 0 if there is none
        gain_at: frequency at which the gain may rise by `gain` [rad/s]; not a number if it may rise by any factor
        phase_at: frequency at which `phase` may be added [rad/s]; not a number if any may
        frequency: of `loop` [rad/s], shape (k,)
        loop: frequency response of the open loop, shape (k,)

    >>> import strainwave as sw
    >>> law = sw.control.PositionSpeed(position_gain=50.0, speed_proportional=3.0, speed_integral=150.0)
    >>> margins = sw.tuning.loop_margins(sw.load("robot-joint").replace(control=sw.control.Sampled(law=law, period=1e-3)))
    >>> round(margins.position.gain, 1), round(margins.position.crossover)  # factor; rad/s
    (4.5, 60)
    """

    gain: float
    phase: float
    modulus: float
    crossover: float
    gain_at: float = field(repr=False)
    phase_at: float = field(repr=False)
    frequency: Array = field(repr=False)
    loop: Complex = field(repr=False)

    def _headline(self) -> str:
        return f"modulus {self.modulus:.2f}, crossover {typeset.quantity(self.crossover, 'rad/s')}"

    def _rows(self) -> Iterator[Row]:
        yield Row("crossover", self.crossover, "rad/s")
        yield Row("gain margin", self.gain, "1", note="factor")
        yield Row("phase margin", float(np.degrees(self.phase)), "deg")
        yield Row("modulus margin", self.modulus, "1")


@dataclass(frozen=True)
class LoopMargins(Pictured):
    """Margins of both loops of a cascade.

    Attributes:
        speed: of the speed loop, with the observer, while the position loop is open
        position: of the position loop around it

    >>> import numpy as np
    >>> import strainwave as sw
    >>> law = sw.control.PositionSpeed(position_gain=50.0, speed_proportional=3.0, speed_integral=150.0)
    >>> margins = sw.tuning.loop_margins(sw.load("robot-joint").replace(control=sw.control.Sampled(law=law, period=1e-3)))
    >>> round(float(np.degrees(margins.speed.phase))), round(margins.speed.crossover), round(margins.modulus, 2)
    (57, 1076, 0.51)
    """

    speed: Margins
    position: Margins

    @property
    def modulus(self) -> float:
        """Smaller modulus margin of both."""
        return min(self.speed.modulus, self.position.modulus)

    def plot(self) -> Figure:
        """Return the Bode diagram of both open loops, with their gain and phase margins marked.

        >>> import strainwave as sw
        >>> law = sw.cascade("robot-joint", period=1e-3)
        >>> drive = sw.load("robot-joint").replace(control=sw.control.Sampled(law=law, period=1e-3))
        >>> [axes.get_title(loc="left") for axes in sw.tuning.loop_margins(drive).plot().axes]
        ['magnitude', 'phase [°]']
        """
        return margins_figure({"speed loop": self.speed, "position loop": self.position})

    def _headline(self) -> str:
        return f"speed loop {self.speed._headline()}; position loop {self.position._headline()}"

    def _rows(self) -> Iterator[Row]:
        for name, loop in (("speed", self.speed), ("position", self.position)):
            yield from (row._replace(name=f"{row.name} of the {name} loop") for row in loop._rows())


def loop_margins(drive: Drive) -> LoopMargins:
    """Return the stability margins of a drive under `PositionSpeed` in a computer, linearised at rest.

    Delay, hold and the vibration of the gear count; of its friction the viscous part alone, of its hysteresis the slope after a
    reversal. The current loop of the motor is taken as ideal. Learning and observers of friction are left out; a
    `DisturbanceObserver` counts.

    Source: AstromWittenmark1997, section 3.3 (loops with delay and hold), AstromMurray2008, section 9.3 (margins).

    Args:
        drive: with motor, load and such a controller

    Returns:
        Of both loops gain margin [1], phase margin [rad], modulus margin [1] and crossover [rad/s].

    Raises:
        ValueError: the drive has no `control.Sampled` of a `PositionSpeed`, or its load or motor is refused by `compensate`
        TypeError: `drive` is no drive

    >>> import strainwave as sw
    >>> drive = sw.load("robot-joint")
    >>> law = sw.cascade("robot-joint", period=1e-3)
    >>> margins = loop_margins(drive.replace(control=sw.control.Sampled(law=law, period=1e-3)))
    >>> margins.modulus >= 0.5
    True
    """
    sampled = arguments.drive(drive).control
    if not (isinstance(sampled, control.Sampled) and isinstance(sampled.law, control.PositionSpeed)):
        law = f"(law={type(sampled.law).__name__})" if isinstance(sampled, control.Sampled) else ""
        raise ValueError(
            f"drive.control = {type(sampled).__name__}{law} must be control.Sampled(law=control.PositionSpeed(…)); sw.cascade "
            "returns such a law"
        )
    gear_set = GearSet.of(drive.replace(control=control.OpenLoop()), name="the drive", source="given")
    return Loops.of(Plant.of(gear_set, sampled.period, sampled.delay), sampled).margins()


def cascade(
    drive: GearSet | Drive | str | Path, *, period: float = 1e-3, delay: float = 0.0, encoder: str = "input"
) -> control.PositionSpeed:
    """Return position around speed, as sharp as the period, the delay and the vibration of the gear allow.

    Both loops keep a modulus margin of 0.5, so that no disturbance is more than doubled; `loop_margins` computes all margins.
    The law feeds the speed forward. Friction, weight and inertia are for the compensation to feed forward.

    Its actuation is a current, or a torque if the motor is a `TorqueSource`: the current loop of any other motor is taken as
    ideal. To simulate it, replace such a motor by `motor.CurrentSource`.

    Args:
        drive: with motor and load: a set, a drive, or the name or path of a file
        period, delay: of the controller [s]
        encoder: "input" or "output", on which the position loop closes

    Returns:
        The law, for a `control.Sampled` of the same period and delay.

    Raises:
        ValueError: as `compensate`; or no setting has that margin
        TypeError: `drive` is no drive

    >>> law = cascade("robot-joint", period=1e-3, delay=5e-4)
    >>> faster = cascade("robot-joint", period=2.5e-4)
    >>> faster.position_gain > law.position_gain
    True
    """
    arguments.one_of("encoder", encoder, ("input", "output"))
    plant = Plant.read(drive, period, delay)
    setting = sharpest(plant, encoder, 0.0)
    if margins_of(plant, setting).modulus < MIN_MODULUS:
        raise ValueError(
            f"no cascade with {encoder} encoder has a modulus margin of {MIN_MODULUS:g} with a period of {period:g} s and a "
            f"delay of {delay:g} s; add damping of the gear if it has none, or take the other encoder"
        )
    law: control.PositionSpeed = tuned_law(plant, setting)
    return law


def sharpest(plant: Plant, encoder: str, observer_share: float) -> Setting:
    """Return the setting of the largest sharpness that keeps `MIN_MODULUS`; the smallest of all if none does."""
    linear = LinearPlant.of(plant)

    def is_robust(setting: Setting) -> bool:
        return Loops.around(linear, plant, sampled_cascade(plant, setting)).margins().modulus >= MIN_MODULUS

    halvings = range(2 * SHARPNESS_HALVINGS + 1)
    settings = [Setting(MAX_SHARPNESS * 0.5 ** (0.5 * count), encoder, observer_share) for count in halvings]
    return next(filter(is_robust, settings), settings[-1])


def margins_of(plant: Plant, setting: Setting) -> LoopMargins:
    """Return the margins of the cascade of a setting."""
    return Loops.of(plant, sampled_cascade(plant, setting)).margins()


def sampled_cascade(plant: Plant, setting: Setting) -> Any:
    """Return the cascade of a setting in a computer, with its observer."""
    added = Compensation(observer=observer_of(plant, setting), actuation_per_torque=plant.actuation_per_torque)
    return plant.controlled(tuned_law(plant, setting), added).control


@dataclass(frozen=True)
class Loops:
    r"""A cascade and its plant from one sample to the next, x' = A x + B s + W w.

    s is the error of the speed, w the commanded speed as the observer has it. The states are those of the drive, the output
    that is held, the integral and the filter of the observer.
    """

    a: Array
    of_error: Array
    of_command: Array
    input_speed: Array
    feedback: Array
    output: Array
    position_gain: float
    period: float
    ratio: float
    vibrations: Array

    @classmethod
    def of(cls, plant: Plant, sampled: Any) -> Loops:
        """Return the loops of a sampled `PositionSpeed`, of whose compensation a `DisturbanceObserver` alone counts."""
        return cls.around(LinearPlant.of(plant), plant, sampled)

    @classmethod
    def around(cls, linear: LinearPlant, plant: Plant, sampled: Any) -> Loops:
        """Return the same around a plant that is linearised already."""
        law, states, count = sampled.law, linear.states, len(linear.states)
        held = linear.held(plant.period, plant.delay)
        unit = np.eye(count + 3)
        speed, angle = unit[states.index("input_speed")], unit[states.index("input_angle")]
        at_output = np.append(linear.output, np.zeros(3))
        output_held, integral, filtered = unit[count:]
        per_torque = sampled.compensation.actuation_per_torque
        momentum, passed, observer = 0.0, 0.0, sampled.compensation.observer
        if isinstance(observer, compensation.DisturbanceObserver):  # what its filter has per speed, and passes in a period
            momentum = observer.bandwidth * observer.inertia
            passed = float(-np.expm1(-observer.bandwidth * plant.period))
        actuated = np.append(held.now, np.zeros(3)) + output_held + passed / per_torque * filtered
        actuation = law.speed_integral * integral + (passed > 0.0) * per_torque * (filtered - momentum * speed)
        return cls(
            a=_free(held, speed, momentum, passed) + np.outer(actuated, actuation),
            of_error=law.speed_proportional * actuated + plant.period * integral,
            of_command=per_torque * momentum * actuated - passed * momentum * filtered,
            input_speed=speed,
            feedback=angle if law.feedback == "input" else plant.ratio * at_output,
            output=at_output,
            position_gain=law.position_gain,
            period=plant.period,
            ratio=plant.ratio,
            vibrations=np.abs(np.linalg.eigvals(linear.a)),
        )

    @property
    def under_speed(self) -> Array:
        """Transition while the speed loop is closed."""
        return self.a - np.outer(self.of_error, self.input_speed)

    @property
    def closed(self) -> Array:
        """Transition while both loops are closed."""
        return self.under_speed - self.position_gain * np.outer(self.of_error, self.feedback)

    def margins(self) -> LoopMargins:
        """Return the margins of both loops."""
        at = self._frequencies()
        speed = self._response(self.a, self.of_error, self.input_speed, at)
        position = self.position_gain * self._response(self.under_speed, self.of_error, self.feedback, at)
        return LoopMargins(_margins(at, speed, self.under_speed), _margins(at, position, self.closed))

    def following(self, frequency: ArrayLike) -> Complex:
        """Return how the output, times the ratio, follows a lead of the input that is a wave of these frequencies [rad/s]."""
        at = np.atleast_1d(np.asarray(frequency, float))
        of_lead = self.position_gain * self.of_error + 1j * at[:, np.newaxis] * (self.of_error + self.of_command)
        return self.ratio * self._response(self.closed, of_lead, self.output, at)

    def _frequencies(self) -> Array:
        highest = np.pi / self.period
        whole = np.geomspace(LOWEST_SHARE * highest, highest, FREQUENCY_COUNT, endpoint=False)
        peaks = [each * np.geomspace(0.8, 1.25, FREQUENCIES_OF_PEAK) for each in self.vibrations if each]
        frequencies = np.unique(np.concatenate([whole, *peaks]))
        return np.asarray(frequencies[frequencies < highest])

    def _response(self, transition: Array, driven: NDArray[Any], read: Array, at: Array) -> Complex:
        shift = np.exp(1j * at * self.period)[:, np.newaxis, np.newaxis] * np.eye(len(transition))
        driven = np.broadcast_to(driven, (len(at), len(transition)))
        return np.asarray(np.linalg.solve(shift - transition, driven[..., np.newaxis])[..., 0] @ read)


def _free(held: HeldPlant, speed: Array, momentum: float, passed: float) -> Array:
    """Return the transition without actuation; the last states are the output that is held, the integral and the filter."""
    count = len(held.step)
    transition = np.zeros((count + 3, count + 3))
    transition[:count, :count], transition[:count, count] = held.step, held.late
    transition[-2, -2], transition[-1, -1] = 1.0, 1.0 - passed
    transition[-1] += passed * momentum * speed
    return transition


def _margins(at: Array, loop: Complex, closed: Array) -> Margins:
    if not np.abs(np.linalg.eigvals(closed)).max() <= MAX_POLE_RADIUS:
        return Margins(1.0, 0.0, 0.0, 0.0, np.nan, np.nan, at, loop)
    size = np.log(np.abs(loop))
    angle = np.unwrap(np.angle(loop))
    half_turns = (angle / np.pi - 1.0) / 2.0  # whole where the loop is real and negative
    negative = half_turns - np.round(half_turns)
    behind, behind_at = np.exp(_at_crossings(negative, size)), np.exp(_at_crossings(negative, np.log(at)))
    behind_at, behind = behind_at[behind < 1.0], behind[behind < 1.0]
    lags = np.abs(np.angle(-np.exp(1j * _at_crossings(size, angle))))
    crossovers = np.exp(_at_crossings(size, np.log(at)))
    return Margins(
        gain=float(1.0 / behind.max()) if behind.size else np.inf,
        phase=float(lags.min(initial=np.inf)),
        modulus=float(np.abs(1.0 + loop).min()),
        crossover=float(crossovers.max(initial=0.0)),
        gain_at=float(behind_at[behind.argmax()]) if behind.size else np.nan,
        phase_at=float(crossovers[lags.argmin()]) if lags.size else np.nan,
        frequency=at,
        loop=loop,
    )


def _at_crossings(series: Array, values: Array) -> Array:
    """Return values where a series crosses 0, between two of its elements; a jump is no crossing."""
    before, after = series[:-1], series[1:]
    k = np.flatnonzero((np.sign(before) != np.sign(after)) & (np.abs(after - before) < MAX_JUMP))
    share = before[k] / (before[k] - after[k])
    return np.asarray(values[k] + share * (values[k + 1] - values[k]))


def margins_figure(margins: Mapping[str, Any]) -> Figure:
    """Return the Bode diagram of open loops: a triangle at each gain margin, a circle at each phase margin."""
    loops = [Response(_label(name, each), each.frequency / tau, each.loop) for name, each in margins.items()]
    figure = bode_figure(loops, "1", "Open loops: ▲ gain margin, ● phase margin")
    magnitude, phase = figure.axes
    magnitude.axhline(1.0, color=LIGHT["muted"], linewidth=0.8)
    phase.axhline(-180.0, color=LIGHT["muted"], linewidth=0.8)
    ends = [at / tau for each in margins.values() for at in (each.gain_at, each.phase_at) if isfinite(at)]
    low, high = loops[0].frequency[0], loops[0].frequency[-1]
    if ends:
        low, high = min(ends) / MAX_FREQUENCY_FACTOR, min(max(ends) * MAX_FREQUENCY_FACTOR, high)
    for place, each in enumerate(margins.values()):
        colour, log_frequency = marks.line_style(place)["color"], np.log(each.frequency)
        for mark, at in (("^", each.gain_at), ("o", each.phase_at)):
            if isfinite(at):
                size = np.exp(np.interp(np.log(at), log_frequency, np.log(np.abs(each.loop))))
                angle = np.interp(np.log(at), log_frequency, phase_in_degrees(each.loop))
                magnitude.plot([at / tau], [size], mark, color=colour, markersize=6.0)
                phase.plot([at / tau], [angle], mark, color=colour, markersize=6.0)
    shown = [(loop.frequency >= low) & (loop.frequency <= high) for loop in loops]
    angles = np.concatenate([phase_in_degrees(loop.response)[rows] for loop, rows in zip(loops, shown, strict=True)])
    sizes = np.abs(np.concatenate([loop.response[rows] for loop, rows in zip(loops, shown, strict=True)]))
    magnitude.set_xlim(low, high)
    magnitude.set_ylim(max(float(sizes.min()), 1.0 / MAX_MAGNITUDE), min(float(sizes.max()), MAX_MAGNITUDE))
    phase.set_ylim(float(angles.min()) - PHASE_MARGIN, float(angles.max()) + PHASE_MARGIN)
    set_phase_ticks(phase)
    for axis in (magnitude.xaxis, magnitude.yaxis):
        marks.set_log_ticks(axis)
    marks.label_abscissa(phase, "frequency", "Hz")
    return figure


def _label(name: str, margins: Any) -> str:
    phase = "∞" if margins.phase == inf else f"{number(np.degrees(margins.phase), 2)}°"
    return f"{name}: gain margin {number(margins.gain, 2)}, phase margin {phase}"
