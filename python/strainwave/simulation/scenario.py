r"""Scenarios: what a drive is commanded to do over a stretch of time.

Every command signal has one form, a line in pieces, which may jump, and waves:

.. math:: c(t) = v_k + s_k (t - t_k) + \sum_j A_j \sin(2 \pi (f_j t + \tfrac{1}{2} g_j t^2) + \varphi_j),
          \quad t_k \le t < t_{k+1}

Sums and multiples keep this form, and rates of change are exact. The unit of a command is that of whatever is
commanded, rad for a position-controlled drive, V for an open-loop motor. A text with a unit, as
``sine("5 deg", "2 Hz", duration="500 ms")``, is converted to SI units; a run refuses it if the drive is commanded in another
unit. A scenario of plain numbers has no unit.

>>> command = ramp(rate=0.3, duration=5.0) + 0.5 * sine(amplitude=0.2, frequency=2.0, duration=5.0)
>>> float(command.value(1.125))
0.4375
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from numbers import Real
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from strainwave import _core, arguments, typeset
from strainwave.files.recording import Recording
from strainwave.files.units import base_exponents, check
from strainwave.messages import shortened
from strainwave.presentation import PLAIN_DIGITS, Pictured, Row, counted
from strainwave.simulation.time_grid import check_instants, room_for

__all__ = [
    "Scenario",
    "Wave",
    "chirp",
    "constant",
    "pulse_train",
    "ramp",
    "sine",
    "step",
    "table",
]
if TYPE_CHECKING:
    from matplotlib.figure import Figure

Array = NDArray[np.float64]

DRAWN_POINTS = 2000  # of a command
MAX_PULSES = 1e6  # of a pulse train
MIN_DURATION = 1e-30  # s: so short that its reciprocal and its square are still finite


@dataclass(frozen=True)
class Wave:
    """A sine whose frequency may rise linearly: A sin(2 pi (f t + g t^2 / 2) + phi).

    Args:
        amplitude: A [unit of the command]
        frequency: f, at t = 0 [Hz]
        sweep: g, the rise of the frequency [Hz/s]
        phase: phi [rad]

    >>> import strainwave as sw
    >>> (wave,) = sw.scenario.chirp(1.0, start_frequency=2.0, stop_frequency=10.0, duration=4.0).waves
    >>> wave.frequency, wave.sweep  # Hz at the start, Hz per second
    (2.0, 2.0)
    """

    amplitude: float
    frequency: float
    sweep: float
    phase: float


@dataclass(frozen=True, eq=False)
class Scenario(Pictured):
    """A command over [0, duration]: a line in pieces plus waves. Made by `step`, `sine`, `table`, …; see the module.

    Piece k is `level[k] + slope[k] * (t - start[k])` and holds from start[k] until start[k + 1].

    Args:
        duration: length [s]
        start: where the pieces begin [s], shape (n,), increasing from 0
        level: value of the line there [unit of the command], shape (n,)
        slope: rate of the line from there on [unit of the command per s], shape (n,)
        waves: what is added to the line
        unit: a unit of what is commanded, if it was given as a text; the numbers are in SI units. "" if not known

    Raises:
        ValueError: the duration is shorter than 1e-30 s, the unit is not known, a number is not finite, the pieces are out of
            order, or the command or its rate grows beyond all numbers within the duration.

    >>> import strainwave as sw
    >>> command = sw.scenario.ramp(2.0, duration=1.0) + sw.scenario.sine(0.1, frequency=5.0, duration=1.0)
    >>> command.value([0.05, 1.0]).round(3), round(float(command.rate(0.0)), 3)
    (array([0.2, 2. ]), 5.142)
    """

    duration: float
    start: Array
    level: Array
    slope: Array
    waves: tuple[Wave, ...] = ()
    unit: str = ""

    __array_ufunc__ = None  # numpy scalars leave `factor * scenario` to __rmul__

    def __post_init__(self) -> None:
        object.__setattr__(self, "duration", _duration("scenario.duration", self.duration))
        for name in ("start", "level", "slope"):
            values = np.array(arguments.numbers(f"scenario.{name}", getattr(self, name)))
            values.setflags(write=False)
            object.__setattr__(self, name, values)
            if values.ndim != 1 or values.shape != self.start.shape:
                raise ValueError(f"scenario.{name} must hold one number for each piece")
            if not np.isfinite(values).all():
                raise ValueError(f"scenario.{name} = {values[~np.isfinite(values)][0]} must be finite")
        if not (self.start.size and self.start[0] == 0.0 and (np.diff(self.start, append=self.duration) > 0.0).all()):
            raise ValueError(f"scenario.start must increase from 0 s and stay below {self.duration} s")
        if not (isinstance(self.waves, tuple) and all(isinstance(wave, Wave) for wave in self.waves)):
            raise TypeError(f"scenario.waves must be a tuple of waves, not {shortened(self.waves)}")
        for wave in self.waves:
            for name, value in vars(wave).items():
                arguments.number(f"wave.{name}", value)
        if arguments.text("scenario.unit", self.unit):
            check(self.unit)
        if not np.isfinite(self._largest()):
            raise ValueError(
                f"scenario: the command, its rate or the angle of a wave grows beyond {np.finfo(float).max:.2g} within "
                f"{self.duration:g} s; take smaller numbers, or a shorter duration"
            )

    @np.errstate(over="ignore", invalid="ignore")
    def _largest(self) -> float:
        """A bound of the command, its rate and the angles of its waves; not finite where that is none."""
        lengths = np.diff(self.start, append=self.duration)
        level, slope = np.abs(self.level), np.abs(self.slope)
        waves = np.abs([tuple(vars(wave).values()) for wave in self.waves]).reshape(-1, 4)
        amplitude, frequency, sweep, phase = waves.T
        fastest = 2.0 * np.pi * (frequency + sweep * self.duration)
        line, rate = (level + slope * lengths).max(), slope.max()
        return float(line + amplitude.sum() + rate + (amplitude * fastest).sum() + (fastest * self.duration + phase).sum())

    def value(self, time: ArrayLike) -> Array:
        """Return the command at `time` [s], in its shape; at a jump the value after it.

        Raises:
            ValueError: a time is not in [0, duration]

        >>> step(2.0, duration=1.0, start=0.5).value([0.25, 0.5])
        array([0., 2.])
        """
        return self._at(time, before=False)[0]

    def rate(self, time: ArrayLike) -> Array:
        """Return the derivative of the command at `time` [s], in its shape; at a jump the one after it.

        Raises:
            ValueError: a time is not in [0, duration]

        >>> float(ramp(3.0, duration=1.0).rate(0.5))
        3.0
        """
        return self._at(time, before=False)[1]

    def value_before(self, time: ArrayLike) -> Array:
        """Left limit of the command at `time` [s]; at 0 the value there.

        Raises:
            ValueError: a time is not in [0, duration]
        """
        return self._at(time, before=True)[0]

    @cached_property
    def breaks(self) -> Array:
        """The times [s] in (0, duration) at which the command or its rate jumps, increasing."""
        inner = self.start[1:]
        differs = self._line.at(inner, before=True) != self._line.at(inner, before=False)
        breaks: Array = inner[differs.any(axis=0)]
        breaks.setflags(write=False)
        return breaks

    def check_unit(self, name: str, unit: str) -> None:
        """Refuse a unit that does not measure what the scenario does; one of plain numbers passes.

        Raises:
            ValueError: the units measure different things

        >>> step("5 N.m", duration=1.0).check_unit("command", "rad")
        Traceback (most recent call last):
        ValueError: command: the scenario is in N.m, and rad is expected; give its numbers in rad
        """
        if not self.unit or _dimension(self.unit) == _dimension(unit):
            return
        per_second = _dimension(self.unit) == _dimension(f"({unit}).s")
        advice = f"the rate of a ramp in {check(f'({unit})/s')}" if per_second else f"its numbers in {unit}"
        raise ValueError(f"{name}: the scenario is in {self.unit}, and {unit} is expected; give {advice}")

    def recording(self, dt: float, unit: str) -> Recording:
        """The command at 0, dt, 2 dt, … up to the duration, as columns `time` and `command`.

        Args:
            dt: distance of the samples [s], in (0, duration]
            unit: unit of the command

        Raises:
            ValueError: `dt` is out of its range, or would make more than 1e8 samples; the unit is not known, or measures
                something else than the scenario
            MemoryError: the samples are too many; the message gives their size

        >>> ramp(rate=2.0, duration=1.0).recording(dt=0.25, unit="rad")["command"]
        array([0. , 0.5, 1. , 1.5, 2. ])
        """
        self.check_unit("recording.unit", unit)
        dt = arguments.number("recording.dt", dt, "s", "(]", 0.0, self.duration)
        check_instants(self.duration, dt, "take longer ones")
        intervals = int(self.duration / dt * (1.0 + 4.0 * np.finfo(float).eps))  # 0.3 / 0.1 falls just short of 3
        with room_for("samples", intervals, 40.0, "take longer steps"):
            time = np.minimum(dt * np.arange(intervals + 1), self.duration)
            return Recording({"time": time, "command": self.value(time)}, {"time": "s", "command": unit})

    def __reduce__(self) -> tuple[type[Scenario], tuple[object, ...]]:
        return Scenario, (self.duration, self.start, self.level, self.slope, self.waves, self.unit)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Scenario):
            return NotImplemented
        if (self.duration, self.waves) != (other.duration, other.waves):
            return False
        return all(np.array_equal(getattr(self, name), getattr(other, name)) for name in ("start", "level", "slope"))

    def __add__(self, other: Scenario) -> Scenario:
        """The sum of two commands of the same duration."""
        if not isinstance(other, Scenario):
            return NotImplemented
        if self.duration != other.duration:
            raise ValueError(f"durations differ, {self.duration} s and {other.duration} s; a sum needs one duration")
        unit = _common("a sum", self.unit, other.unit)
        start = np.append(0.0, np.union1d(self.breaks, other.breaks))
        with np.errstate(over="ignore"):  # what is not finite is refused by the sum
            level, slope = self._line.at(start, before=False) + other._line.at(start, before=False)
        return Scenario(self.duration, start, level, slope, self.waves + other.waves, unit)

    def __mul__(self, factor: float) -> Scenario:
        """The command times a number."""
        if not isinstance(factor, Real):
            return NotImplemented
        factor = arguments.number("factor", factor)
        waves = tuple(replace(wave, amplitude=factor * wave.amplitude) for wave in self.waves)
        with np.errstate(over="ignore"):  # what is not finite is refused by the product
            return replace(self, level=factor * self.level, slope=factor * self.slope, waves=waves)

    __rmul__ = __mul__

    def __neg__(self) -> Scenario:
        return -1.0 * self

    def __sub__(self, other: Scenario) -> Scenario:
        """The difference of two commands of the same duration."""
        if not isinstance(other, Scenario):
            return NotImplemented
        return self + -other

    @cached_property
    def signal(self) -> _core.Signal:
        """The same for the compiled loops."""
        waves = [(wave.amplitude, wave.frequency, wave.sweep, wave.phase) for wave in self.waves]
        return _core.Signal(self.start, self.level, self.slope, np.array(waves, dtype=np.float64))

    @cached_property
    def _line(self) -> _core.Signal:
        return _core.Signal(self.start, self.level, self.slope, np.empty(0))

    def _at(self, time: ArrayLike, before: bool) -> tuple[Array, Array]:
        """Values and rates at `time` [s], or just before it."""
        times = arguments.numbers("time", time)
        if times.size and not (times.min() >= 0.0 and times.max() <= self.duration):
            outside = times[~((times >= 0.0) & (times <= self.duration))]
            raise ValueError(f"time = {outside[0]} s lies outside the scenario, [0, {self.duration}] s")
        values, rates = self.signal.at(times, before)
        return values, rates

    def _headline(self) -> str:
        waves = f", {counted(len(self.waves), 'wave')}" if self.waves else ""
        low, high = (typeset.number(end, PLAIN_DIGITS) for end in self._range)
        return f"{self.duration:g} s, {counted(len(self.start), 'piece')}{waves}, {low} to {high}"

    @property
    def _range(self) -> tuple[float, float]:
        _, values = self._drawn
        return float(values.min()), float(values.max())

    @property
    def _drawn(self) -> tuple[Array, Array]:
        times = np.linspace(0.0, self.duration, DRAWN_POINTS)
        return times, np.asarray(self.value(times))

    def _rows(self) -> Iterator[Row]:
        yield Row("duration", self.duration, "s")
        yield Row("command", self._range, note="in the unit of what it commands")
        yield Row("pieces", len(self.start))
        for number, wave in enumerate(self.waves, start=1):
            yield Row(f"amplitude of wave {number}", wave.amplitude)
            yield Row(f"frequency of wave {number}", wave.frequency, "Hz")

    def plot(self, name: str = "command", unit: str = "1") -> Figure:
        """Return a figure of the command over time.

        Args:
            name: of what it commands
            unit: of that

        Raises:
            TypeError: one of them is no text
        """
        from strainwave.drawing.simple import Series, curve_figure

        (times, values), title = self._drawn, f"{arguments.text('name', name).capitalize()} over time"
        return curve_figure(title, Series("time", "s", times), Series(name, arguments.text("unit", unit), values))


def constant(value: float | str, duration: float | str) -> Scenario:
    """The same command all the time: c(t) = value.

    Args:
        value: the command [unit of the command]
        duration: length [s]

    Raises:
        ValueError: a number is not finite, or the duration not positive.

    >>> constant(1.5, duration=2.0).value([0.0, 2.0])
    array([1.5, 1.5])
    """
    value, unit = _command("constant.value", value)
    duration = _duration("constant.duration", duration)
    return _from(0.0, duration, level=value, slope=0.0, unit=unit)


def step(amplitude: float | str, duration: float | str, start: float | str = 0.0) -> Scenario:
    """A jump: c(t) = amplitude from t = start on, 0 before.

    Args:
        amplitude: height of the jump [unit of the command]
        duration: length [s]
        start: when it jumps [s], in [0, duration)

    Raises:
        ValueError: a number is not finite or out of its range.

    >>> step(2.0, duration=1.0, start=0.5).value([0.0, 0.5, 1.0])
    array([0., 2., 2.])
    """
    amplitude, unit = _difference("step.amplitude", amplitude)
    duration = _duration("step.duration", duration)
    start = arguments.number("step.start", start, "s", "[)", 0.0, duration)
    return _from(start, duration, level=amplitude, slope=0.0, unit=unit)


def ramp(rate: float | str, duration: float | str, start: float | str = 0.0) -> Scenario:
    """A steady rise: c(t) = rate * (t - start) from t = start on, 0 before.

    Args:
        rate: the rise [unit of the command per s]
        duration: length [s]
        start: when it begins [s], in [0, duration)

    Raises:
        ValueError: a number is not finite or out of its range.

    >>> ramp(4.0, duration=1.0, start=0.5).value([0.0, 0.5, 1.0])
    array([0., 0., 2.])
    """
    rate, unit = _difference("ramp.rate", rate)
    duration = _duration("ramp.duration", duration)
    start = arguments.number("ramp.start", start, "s", "[)", 0.0, duration)
    return _from(start, duration, level=0.0, slope=rate, unit=unit and check(f"({unit}).s"))


def sine(
    amplitude: float | str, frequency: float | str, duration: float | str, phase: float | str = 0.0, offset: float | str = 0.0
) -> Scenario:
    """A sine: c(t) = offset + amplitude * sin(2 pi * frequency * t + phase).

    Args:
        amplitude: half the distance between its extremes [unit of the command]
        frequency: cycles per second [Hz], >= 0
        duration: length [s]
        phase: angle at t = 0 [rad]
        offset: its mean [unit of the command]

    Raises:
        ValueError: a number is not finite or out of its range.

    >>> sine(2.0, frequency=0.25, duration=4.0, offset=1.0).value([0.0, 1.0, 3.0])
    array([ 1.,  3., -1.])
    """
    amplitude, unit = _difference("sine.amplitude", amplitude)
    frequency = arguments.number("sine.frequency", frequency, "Hz", "[)", 0.0)
    duration = _duration("sine.duration", duration)
    phase = arguments.number("sine.phase", phase, "rad")
    offset, unit_of_offset = _command("sine.offset", offset)
    unit = _common("sine.amplitude and sine.offset", unit, unit_of_offset)
    wave = Wave(amplitude, frequency, sweep=0.0, phase=phase)
    return replace(constant(offset, duration), waves=(wave,), unit=unit)


def chirp(amplitude: float | str, start_frequency: float | str, stop_frequency: float | str, duration: float | str) -> Scenario:
    """A sine whose frequency moves linearly from one value to another.

    c(t) = amplitude * sin(2 pi * (f0 * t + (f1 - f0) * t**2 / (2 * duration))), so that its instantaneous frequency,
    the derivative of the angle over 2 pi, is f0 = start_frequency at 0 and f1 = stop_frequency at the end.

    Args:
        amplitude: half the distance between its extremes [unit of the command]
        start_frequency: frequency at t = 0 [Hz], >= 0
        stop_frequency: frequency at t = duration [Hz], >= 0
        duration: length [s]

    Raises:
        ValueError: a number is not finite or out of its range.

    >>> float(chirp(1.0, start_frequency=0.0, stop_frequency=1.0, duration=8.0).value(1.0).round(12))  # sin(pi / 8)
    0.382683432365
    """
    amplitude, unit = _difference("chirp.amplitude", amplitude)
    start_frequency = arguments.number("chirp.start_frequency", start_frequency, "Hz", "[)", 0.0)
    stop_frequency = arguments.number("chirp.stop_frequency", stop_frequency, "Hz", "[)", 0.0)
    duration = _duration("chirp.duration", duration)
    wave = Wave(amplitude, start_frequency, sweep=(stop_frequency - start_frequency) / duration, phase=0.0)
    return replace(constant(0.0, duration), waves=(wave,), unit=unit)


def pulse_train(
    amplitude: float | str, period: float | str, width: float | str, duration: float | str, start: float | str = 0.0
) -> Scenario:
    """Rectangular pulses: c(t) = amplitude while 0 <= t - start - k * period < width for a k = 0, 1, 2, …, else 0.

    Args:
        amplitude: height of the pulses [unit of the command]
        period: from the begin of one pulse to that of the next [s]
        width: length of a pulse [s], in (0, period)
        duration: length of the whole [s]
        start: when the first pulse begins [s], in [0, duration)

    Raises:
        ValueError: a number is not finite or out of its range.

    >>> pulse_train(3.0, period=1.0, width=0.25, duration=2.0, start=0.5).breaks
    array([0.5 , 0.75, 1.5 , 1.75])
    """
    amplitude, unit = _difference("pulse_train.amplitude", amplitude)
    period = arguments.number("pulse_train.period", period, "s", low=0.0)
    width = arguments.number("pulse_train.width", width, "s", low=0.0, high=period)
    duration = _duration("pulse_train.duration", duration)
    start = arguments.number("pulse_train.start", start, "s", "[)", 0.0, duration)
    check_instants(duration - start, period, "take fewer pulses", MAX_PULSES)
    pulses = np.ceil((duration - start) / period)
    with room_for("pulses", pulses, 200.0, "take fewer"):
        rise = start + period * np.arange(pulses)
        edges = np.column_stack((rise, rise + width)).ravel()
        levels = np.resize([amplitude, 0.0], edges.size)
        if start > 0.0:
            edges, levels = np.append(0.0, edges), np.append(0.0, levels)
        inside = edges < duration
        return Scenario(duration, edges[inside], levels[inside], np.zeros(np.count_nonzero(inside)), unit=unit)


def table(time: ArrayLike, value: ArrayLike) -> Scenario:
    """Straight lines between points: c(t) = v_k + (v_{k+1} - v_k) (t - t_k) / (t_{k+1} - t_k), t_k <= t <= t_{k+1}.

    Args:
        time: times of the points [s], shape (n,), n >= 2, increasing from 0; the last is the duration
        value: the command there [unit of the command], shape (n,)

    Raises:
        ValueError: lengths differ, a number is not finite, or the times do not increase from 0.

    >>> table([0.0, 1.0, 3.0], [0.0, 2.0, 0.0]).value([0.5, 1.0, 2.0])
    array([1., 2., 1.])
    """
    points = Recording({"time": time, "value": value}, {"time": "s", "value": "1"})
    if len(points) < 2:
        raise ValueError("table.time holds 1 time; at least 2 are needed")
    if points.time[0] != 0.0:
        raise ValueError(f"table.time begins at {points.time[0]} s; it must begin at 0 s")
    with np.errstate(over="ignore"):
        slope = np.diff(points["value"]) / np.diff(points.time)
    if not np.isfinite(slope).all():
        row = int(np.argmin(np.isfinite(slope)))
        raise ValueError(f"table.value changes so much from row {row} to row {row + 1} that its rate is not finite; take less")
    return Scenario(float(points.time[-1]), points.time[:-1], points["value"][:-1], slope)


def _command(name: str, value: object) -> tuple[float, str]:
    """Return a number of a command in SI units, and the unit of its text; "" if it is no text."""
    from strainwave.files.figures import written_figure

    if not isinstance(value, str):
        return arguments.number(name, value), ""
    number, unit = written_figure(name, value)
    return arguments.number(name, number), unit


def _difference(name: str, value: object) -> tuple[float, str]:
    """Return a difference as `_command` does; refuse degC, whose zero is not that of K."""
    number, unit = _command(name, value)
    if unit == "degC":
        raise ValueError(f"{name} = {shortened(value)} is a difference of temperatures: write 5 degC as 5 K")
    return number, unit


def _dimension(unit: str) -> dict[str, int]:
    return base_exponents(unit)[1]


def _common(name: str, unit: str, other: str) -> str:
    """Return the unit of both; refuse units that measure different things."""
    if unit and other and _dimension(unit) != _dimension(other):
        raise ValueError(f"{name}: the units differ, {unit} and {other}; both must measure the same")
    return unit or other


def _duration(name: str, value: object) -> float:
    return arguments.number(name, value, "s", "[)", low=MIN_DURATION)


def _from(start: float, duration: float, level: float, slope: float, unit: str) -> Scenario:
    """Return a scenario that is zero until `start`, then one piece of a line."""
    before = [0.0] if start > 0.0 else []
    starts, levels, slopes = (np.array([*before, last]) for last in (start, level, slope))
    return Scenario(duration, starts, levels, slopes, unit=unit)


def __dir__() -> list[str]:
    return __all__
