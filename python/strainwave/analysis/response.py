"""The response of a drive to sines of finite size, where friction, hysteresis and play show."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import islice
from math import ceil
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from strainwave import Drive, _core, arguments, typeset
from strainwave.analysis.steady import averaged, constant_inputs, equilibrium
from strainwave.equality import ComparedByFields
from strainwave.files.units import ratio_of_units
from strainwave.messages import listed, quoted
from strainwave.native import kernels
from strainwave.presentation import Pictured, Row
from strainwave.simulation.excitation import ROOM_TEMPERATURE, TEMPERATURE_PLACE, Excitation
from strainwave.simulation.resolution import check_resolution, warn_of_bristles
from strainwave.simulation.run import beginning, recording
from strainwave.simulation.scenario import MIN_DURATION, constant, sine
from strainwave.simulation.signals import check_continuous, command_unit, outputs as outputs_of, units as units_of
from strainwave.simulation.state import State, start_of
from strainwave.simulation.time_grid import check_instants

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

_MIN_STEPS_PER_PERIOD = 64  # harmonics up to the 31st
_MIN_FREQUENCY = 1e-300  # Hz: its period is still finite
_MIN_AMPLITUDE = 1e-100  # a quotient by it is still finite
_SINE_INPUTS = ("command", "load_torque")


@dataclass(frozen=True, eq=False)
class FrequencyResponse(ComparedByFields, Pictured):
    """Response of a drive to a sine of some amplitude, in periodic motion.

    ``answer["output_angle"]`` is the response of that output: amplitude and phase of its first harmonic over those of the
    input [unit of the output / unit of the input], shape (k,).

    Args:
        frequency: of the sine [Hz], shape (k,)
        amplitude: of the sine
        responses: of each output, shape (k,)
        distortions: of each output, the root sum of squares of its higher harmonics over its first, shape (k,)
        drifts: of each output, what a period adds to it [unit of the output], shape (k,); angles of a drive that runs, and
            what friction or hysteresis lets creep under a vibration
        periods: count until the motion was periodic, shape (k,)
        input: name of the input with the sine
        units: unit of the input and of each output

    >>> import numpy as np
    >>> import strainwave as sw
    >>> arm = sw.loads.Pendulum(inertia=0.1, gravity_torque=5.0)
    >>> drive = sw.Drive(load=arm, control=sw.control.PID(proportional=2.0, derivative=0.05))
    >>> answer = sw.analysis.frequency_response(drive, [1.0, 10.0], amplitude=0.01)
    >>> (20.0 * np.log10(abs(answer["output_angle"]))).round(1)  # dB
    array([-0.3, -4.2])
    >>> np.degrees(np.angle(answer["output_angle"])).round(1)
    array([ -8.6, -28.8])
    """

    frequency: Array
    amplitude: float
    responses: dict[str, Complex]
    distortions: dict[str, Array]
    drifts: dict[str, Array]
    periods: NDArray[np.intp]
    input: str
    units: dict[str, str]

    def plot(self, output: str = "output_angle") -> Figure:
        """Return the Bode diagram of an output: magnitude [unit of the output / unit of the input] and phase [deg]."""
        from strainwave.analysis.plots import Response, bode_figure
        from strainwave.typeset import quantity

        response = self[output]
        size = quantity(self.amplitude, self.units[self.input]).replace(" ", "\N{NO-BREAK SPACE}")
        title = f"Response of {output.replace('_', ' ')} to a {self.input.replace('_', ' ')} of {size}"
        unit = ratio_of_units(self.units[output], self.units[self.input])
        return bode_figure([Response("", self.frequency, response)], unit, title)

    def __getitem__(self, output: str) -> Complex:
        if arguments.text("the name of an output", output) not in self.responses:
            raise ValueError(f"no output {quoted(output)}; there are {listed(self.responses)}")
        return self.responses[output]

    def _headline(self) -> str:
        low, high = (typeset.quantity(float(end), "Hz") for end in (self.frequency.min(), self.frequency.max()))
        size = typeset.quantity(self.amplitude, self.units[self.input])
        return f"{len(self.responses)} outputs to a sine of {self.input} of {size}, {low} to {high}"

    def _rows(self) -> Iterator[Row]:
        for name, response in self.responses.items():
            size = np.abs(response)
            unit = ratio_of_units(self.units[name], self.units[self.input])
            worst = typeset.number(100.0 * float(self.distortions[name].max()), 3)
            yield Row(name, (float(size.min()), float(size.max())), unit, note=f"distortion up to {worst} %")


def frequency_response(
    drive: Drive,
    frequency: ArrayLike,
    amplitude: float,
    *,
    input: str = "command",
    command: float = 0.0,
    load_torque: float = 0.0,
    temperature: float = ROOM_TEMPERATURE,
    initial: State | None = None,
    dt: float = 2e-4,
    tolerance: float = 1e-6,
    max_periods: int = 1000,
) -> FrequencyResponse:
    """Run a drive under sines around an operating point until it moves periodically, and return the first harmonics.

    Each frequency begins at `initial`. What drifts at a steady rate counts as periodic: the drift is taken off, and reported;
    the answer of a drive that creeps under the vibration is that of the moment. Of an amplitude small enough, the response is
    that of `linearise`.

    Args:
        drive: the drive
        frequency: of the sines [Hz], shape (k,) or a number
        amplitude: of the sine [unit of the input]
        input: what the sine is added to: "command" or "load_torque"
        command: output angle [rad] or voltage [V] that the sine swings about
        load_torque: torque that holds the output back [N.m], besides the load's own
        temperature: of the gear [K]
        initial: where to begin; the `equilibrium` of the constant inputs if not given
        dt: largest step [s]; a period has 64 steps at least
        tolerance: periodic is what differs from the period before by less than this share of its swing, every output
        max_periods: after how many periods to give up

    Returns:
        Responses, distortions and the number of periods they took.

    Raises:
        TypeError: an argument is not of its kind
        ValueError: a frequency, `amplitude`, `dt` or `tolerance` is not positive, a period has more than 1e8 steps,
            `max_periods` is below 2, `input` is another, or there is no equilibrium
        FloatingPointError, MemoryError: as `simulate`
        RuntimeError: a motion is not periodic after `max_periods`; the message gives the remaining difference

    Warns:
        RuntimeWarning: the drive's bristles are too stiff for `dt`

    >>> import strainwave as sw
    >>> arm = sw.loads.Pendulum(inertia=0.1, gravity_torque=5.0)
    >>> drive = sw.Drive(load=arm, control=sw.control.PID(proportional=2.0, derivative=0.05))
    >>> answer = sw.analysis.frequency_response(drive, [1.0, 2.0], amplitude=0.01)
    >>> linear = sw.linearise(drive)
    >>> abs(answer["output_angle"] / linear.response([1.0, 2.0])).round(3)
    array([1., 1.])
    """
    check_continuous(arguments.drive(drive), "frequency_response")
    constant_inputs(command, load_torque, temperature)  # refuses what makes no sense
    frequencies = np.atleast_1d(arguments.numbers("frequency", frequency))
    amplitude = arguments.number("amplitude", amplitude, brackets="[)", low=_MIN_AMPLITUDE)
    dt = arguments.seconds("dt", dt)
    _check(frequencies, input, dt)
    tolerance = arguments.number("tolerance", tolerance, low=0.0)
    max_periods = arguments.whole("max_periods", max_periods, 2)
    if initial is None:
        initial = equilibrium(drive, command=command, load_torque=load_torque, temperature=temperature)
    initial = start_of(drive, initial)
    if initial.input_speed != 0.0:
        drive = averaged(drive)
    warn_of_bristles(drive, max(_step(1.0 / f, dt) for f in frequencies.tolist()))
    sines = _Sines(drive, initial.numbers, dt)
    answers = []
    for f in frequencies.tolist():
        levels = {"command": constant(command, 1.0 / f), "load_torque": constant(load_torque, 1.0 / f)}
        levels[input] = levels[input] + sine(amplitude, f, 1.0 / f)
        excitation = Excitation(levels["command"], levels["load_torque"], temperature)
        answers.append(sines.periodic(excitation, tolerance, max_periods))
    all_units = {"load_torque": "N.m"} | units_of(drive, outputs_of(drive).values()) | {"command": command_unit(drive)}
    return _response(
        frequencies, amplitude, [period for period, _ in answers], [count for _, count in answers], input, all_units
    )


def _response(
    frequencies: Array,
    amplitude: float,
    periods: list[dict[str, Array]],
    counts: list[int],
    input: str,
    all_units: dict[str, str],
) -> FrequencyResponse:
    """Return the response from the outputs over one period of each frequency, and its number."""
    responses, distortions, drifts = {}, {}, {}
    for name in periods[0]:
        first, higher = np.array([_harmonics(period[name]) for period in periods]).T
        responses[name] = first / amplitude
        distortions[name] = higher.real / np.maximum(np.abs(first), np.finfo(float).tiny)
        drifts[name] = np.array([period[name][-1] - period[name][0] for period in periods])
    units = {name: all_units[name] for name in dict.fromkeys((input, *responses))}
    return FrequencyResponse(frequencies, amplitude, responses, distortions, drifts, np.array(counts), input, units)


def _check(frequencies: Array, signal: str, dt: float) -> None:
    if frequencies.ndim != 1 or frequencies.size == 0:
        raise ValueError("frequency must have one positive number [Hz] or more")
    for frequency in frequencies.tolist():
        arguments.number("frequency", frequency, "Hz", "[]", _MIN_FREQUENCY, 1.0 / MIN_DURATION)
        check_instants(1.0 / frequency, dt, "take a higher frequency, or a longer dt")
    arguments.one_of("input", signal, _SINE_INPUTS)


@dataclass(frozen=True)
class _Sines:
    """Runs from one start, period by period."""

    drive: Drive
    start: Array
    dt: float

    def periodic(self, excitation: Excitation, tolerance: float, max_periods: int) -> tuple[dict[str, Array], int]:
        """The outputs over the first period that repeats the one before, and its number; the excitation lasts one period."""
        before, change = None, np.inf
        for count, period in enumerate(islice(self._periods(excitation), max_periods), 1):
            if before is not None:
                change = max(_change(values, before[name]) for name, values in period.items())
            if change <= tolerance:
                return period, count
            before = period
        raise RuntimeError(
            f"at {1.0 / excitation.command.duration:g} Hz the motion is not periodic after {max_periods} periods: the last "
            f"two differ by {change:.2g} of the swing, more than tolerance = {tolerance:g}; "
            "a motion that only creeps may need more periods"
        )

    def _periods(self, excitation: Excitation) -> Iterator[dict[str, Array]]:
        """The outputs over each period, both ends included."""
        period = excitation.command.duration
        step = _step(period, self.dt)
        temperature = excitation.first()[TEMPERATURE_PLACE]
        check_resolution(self.drive, step, 0.0, temperature)
        excitation.check_laid_out(step)
        time_grid = excitation.time_grid(step, None)
        recorded = outputs_of(self.drive)
        channels = [each.channel for each in recorded.values()]
        inputs, state = excitation.over(time_grid.instants), self.start
        while True:
            outputs = beginning(self.drive, state, excitation.first(), channels, len(time_grid.times))
            keep, method = time_grid.samples[1:], _core.Method.exponential
            with kernels.prepared(self.drive, "simulate", len(keep)):
                state = _core.simulate(self.drive, state, time_grid.instants, inputs, keep, method, channels, outputs, 1)
            run = recording(self.drive, time_grid, recorded, outputs, temperature)
            yield {name: run[name] for name in run.names if name != "time"}


def _step(period: float, dt: float) -> float:
    """The longest step that divides a period and keeps to `dt` [s]."""
    return period / max(ceil(period / dt), _MIN_STEPS_PER_PERIOD)


def _change(values: Array, before: Array) -> float:
    """The largest difference as a share of the swing; of what hardly swings, of a millionth of its size."""
    level = _levelled(values)
    size = np.float64(max(0.5 * np.ptp(level), 1e-6 * np.abs(values).max(), np.finfo(float).tiny))
    with np.errstate(over="ignore"):  # of a swing of nearly nothing the share is infinite
        return float(np.abs(level - _levelled(before)).max() / size)


def _levelled(values: Array) -> Array:
    """The values of a period from a line through both ends."""
    return values - np.linspace(values[0], values[-1], len(values))


def _harmonics(values: Array) -> tuple[complex, float]:
    """Amplitude and phase of the first harmonic over a period, relative to the sine, and the size of all higher ones."""
    spectrum = 2j * np.fft.rfft(_levelled(values)[:-1]) / (len(values) - 1)
    return complex(spectrum[1]), float(np.linalg.norm(spectrum[2:]))
