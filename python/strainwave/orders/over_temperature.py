"""Kinematic error over the temperature: orders of records of two encoders at several temperatures, as a law of the gear."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from math import inf, isclose, isfinite, tau

import numpy as np
from numpy.typing import ArrayLike, NDArray

from strainwave import _core, arguments, typeset
from strainwave.orders.two_encoders import MAX_HARMONICS, ErrorOrder, TransmissionError
from strainwave.presentation import Presented, Row
from strainwave.statistics.linear_fit import solved

Array = NDArray[np.float64]

SAME_ORDER = 1e-3  # relative difference of one order in two records, whose measured ratios differ a little
UNKNOWNS_PER_ORDER = 4  # sine and cosine part, and their changes
MIN_PROBABILITY = 1e-3  # of the scatter about straight lines: a smaller one means that they do not explain the phases
SAME_ZERO = "straight lines explain the phases, as of an input encoder that kept its zero"
MEASURED_TWICE = (
    "two records do not separate a change of phase from another zero of the input encoder, and do not test the line of the "
    "amplitudes: add a third"
)
OTHER_ZERO = (
    "straight lines do not explain the records: phases are not compared, as if the input encoder had changed its zero; the "
    "change of amplitudes counts with its scatter"
)


@dataclass(frozen=True)
class OrderOverTemperature(Presented):
    """Order of the kinematic error over the temperature, at the mean temperature of the records.

    Attributes:
        order: periods per revolution of the input [1]
        amplitude, amplitude_sigma: of it at the output [rad], and its standard deviation
        phase, phase_sigma: of it [rad], as of a sine
        amplitude_rate, amplitude_rate_sigma: change of the amplitude [rad/K]
        phase_rate, phase_rate_sigma: change of the phase [rad/K]; 0 with an infinite deviation if phases are not comparable
        false_alarm: probability that noise alone gives as much change in any of the orders
        significant: True if that is less than allowed
    """

    order: float
    amplitude: float
    amplitude_sigma: float
    phase: float
    phase_sigma: float
    amplitude_rate: float
    amplitude_rate_sigma: float
    phase_rate: float
    phase_rate_sigma: float
    false_alarm: float
    significant: bool

    @property
    def change(self) -> float:
        """Amplitude of the change per kelvin, of amplitude and phase together [rad/K]."""
        return float(np.hypot(self.amplitude_rate, self.amplitude * self.phase_rate))

    @property
    def change_sigma(self) -> float:
        """Standard deviation of `change`, the larger one of both directions [rad/K]."""
        across = self.amplitude * self.phase_rate_sigma
        return max(self.amplitude_rate_sigma, across) if isfinite(across) else self.amplitude_rate_sigma


@dataclass(frozen=True)
class ErrorOverTemperature(Presented):
    """Kinematic error of a gear over its temperature.

    Attributes:
        orders: that are significant in at least one record
        reference_temperature: mean of the temperatures of the records [K]
        temperatures: of each record [K]
        remarks: what to know of these numbers, in words
    """

    orders: tuple[OrderOverTemperature, ...]
    reference_temperature: float
    temperatures: tuple[float, ...]
    remarks: tuple[str, ...]

    @property
    def law(self) -> _core.kinematic_error.TemperatureDependent:
        """The error at the mean temperature, and the significant changes with it."""
        kept = sorted(sorted(self.orders, key=lambda each: -each.amplitude)[:MAX_HARMONICS], key=lambda each: each.order)
        changed = [each for each in kept if each.significant]
        waves = [complex(each.amplitude_rate, each.amplitude * each.phase_rate) for each in changed]
        return _core.kinematic_error.TemperatureDependent(
            law=_core.kinematic_error.Fourier(
                order=[each.order for each in kept],
                amplitude=[each.amplitude for each in kept],
                phase=[each.phase for each in kept],
            ),
            order=[each.order for each in changed],
            change=[each.change for each in changed],
            phase=[each.phase + float(np.angle(wave)) for each, wave in zip(changed, waves, strict=True)],
            temperature=self.reference_temperature,
            reference_temperature=self.reference_temperature,
        )

    def _headline(self) -> str:
        changing = sum(each.significant for each in self.orders)
        span = typeset.quantity(float(np.ptp(self.temperatures)), "K")
        return f"{changing} of {len(self.orders)} orders change over {span} of temperature"

    def _rows(self) -> Iterator[Row]:
        for each in self.orders:
            note = "" if each.significant else "not significant"
            yield Row(f"order {each.order:.5g}", each.amplitude, "rad", each.amplitude_sigma)
            yield Row(f"rate of order {each.order:.5g}", each.amplitude_rate, "rad/K", each.amplitude_rate_sigma, note)
            yield Row(f"phase rate of order {each.order:.5g}", each.phase_rate, "rad/K", each.phase_rate_sigma, note)


def error_over_temperature(
    errors: Sequence[TransmissionError], temperatures: ArrayLike, *, false_alarm: float = 0.01
) -> ErrorOverTemperature:
    """Return the kinematic error of a gear over its temperature, by records of two encoders.

    The sine and the cosine part of each order are straight lines over the temperature, fitted by least squares with the
    standard deviations of the records. If the records scatter by more than those, the standard deviations are larger by their
    ratio (Birge1932), and the changes are judged by this scatter. Another zero of the input encoder turns all phases, as a
    change with the temperature does: of two records, or if straight lines do not explain the phases, amplitudes alone are
    compared, and the phase is that of the first record.

    Args:
        errors: results of `sw.transmission_error` of one gear, each at one temperature
        temperatures: of the gear in each record [K], shape (n,)
        false_alarm: largest probability that noise makes the change of any order significant

    Raises:
        ValueError: temperatures and records differ in number, or all temperatures are one

    >>> import strainwave as sw
    >>> def record(temperature):
    ...     warmer, theta = temperature - 293.15, 30.0 * np.sin(np.linspace(0.0, 6.0, 1000))
    ...     noise = np.random.default_rng(int(temperature)).normal(0.0, 1e-5, len(theta))
    ...     output = -theta / 100.0 - (3e-4 + 2e-6 * warmer) * np.sin(2 * theta) + noise
    ...     columns = {"input_angle": theta, "output_angle": output}
    ...     return sw.transmission_error(sw.Recording(columns, {"input_angle": "rad", "output_angle": "rad"}))
    >>> degrees = [283.15, 303.15, 323.15]
    >>> found = error_over_temperature([record(each) for each in degrees], degrees)
    >>> found.law.order, round(1e6 * found.orders[0].amplitude_rate, 1)  # µrad/K
    ((2.0,), 2.0)
    """
    degrees = arguments.positive_series("temperatures", temperatures)
    if len(degrees) != len(errors):
        raise ValueError(f"{len(degrees)} temperatures are given for {len(errors)} records; give one for each")
    if len(degrees) == 0 or float(np.ptp(degrees)) == 0.0:
        raise ValueError(
            "at one temperature the error and its change with the temperature are not separable; add a record at another one"
        )
    allowed = arguments.probability("false_alarm", false_alarm)
    reference = float(np.mean(degrees))
    common = list(_common(errors))
    fitted = [_fitted(lines, degrees - reference) for lines in common]
    comparable = _explains_phases(fitted)
    if not comparable:
        fitted = [_fitted(_of_one_phase(lines), degrees - reference) for lines in common]
    orders = tuple(line.result(len(common), allowed, comparable) for line in fitted)
    remarks = [SAME_ZERO if comparable else MEASURED_TWICE if len(errors) == 2 else OTHER_ZERO]
    remarks += [f"record {place}: {each.speeds}" for place, each in enumerate(errors, 1) if each.vibrates]
    return ErrorOverTemperature(orders, reference, tuple(degrees.tolist()), tuple(remarks))


def _common(errors: Sequence[TransmissionError]) -> Iterator[list[ErrorOrder]]:
    """Yield the lines of each order that all records determine, and one or more show."""
    for line in errors[0].orders:
        if line.shaft == "output":
            continue
        lines = [
            other
            for error in errors
            for other in error.orders
            if other.shaft == line.shaft and isclose(other.order, line.order, rel_tol=SAME_ORDER)
        ]
        if len(lines) == len(errors) and any(each.significant for each in lines):
            yield lines


@dataclass(frozen=True)
class _Line:
    """Sine and cosine part of one order, and their changes per kelvin: fitted values, covariance and squares left."""

    lines: Sequence[ErrorOrder]
    values: Array
    covariance: Array
    squares: float

    @property
    def freedom(self) -> int:
        return 2 * len(self.lines) - UNKNOWNS_PER_ORDER

    def result(self, count: int, allowed: float, comparable: bool) -> OrderOverTemperature:
        """Return the order, one of `count` that are judged together, with its phase only if phases are comparable."""
        birge = max(1.0, self.squares / self.freedom) if self.freedom else 1.0
        covariance = birge * self.covariance
        amplitude, phase = float(np.hypot(*self.values[:2])), float(np.arctan2(self.values[1], self.values[0]))
        along = np.array([np.cos(phase), np.sin(phase)])
        across = np.array([-along[1], along[0]])
        blocks = covariance[:2, :2], covariance[2:, 2:]
        sigmas = [float(np.sqrt(way @ block @ way)) for block in blocks for way in (along, across)]
        rate, turn = float(along @ self.values[2:]), float(across @ self.values[2:])
        square = (rate / sigmas[2]) ** 2
        if comparable:
            square = float(self.values[2:] @ np.linalg.solve(covariance[2:, 2:], self.values[2:]))
        alarm = (1.0 + square / self.freedom) ** (-0.5 * self.freedom) if birge > 1.0 else float(np.exp(-0.5 * square))
        alarm = min(1.0, count * alarm)
        return OrderOverTemperature(
            order=self.lines[0].order,
            amplitude=amplitude,
            amplitude_sigma=sigmas[0],
            phase=phase,
            phase_sigma=min(sigmas[1] / amplitude, tau),
            amplitude_rate=rate,
            amplitude_rate_sigma=sigmas[2],
            phase_rate=turn / amplitude if comparable else 0.0,
            phase_rate_sigma=sigmas[3] / amplitude if comparable else inf,
            false_alarm=alarm,
            significant=alarm < allowed,
        )


def _fitted(lines: Sequence[ErrorOrder], warmer: Array) -> _Line:
    """Return the straight lines of one order by least squares."""
    rows = np.concatenate([_parts(line, step) for line, step in zip(lines, warmer, strict=True)])
    goal = np.concatenate([[line.amplitude / line.amplitude_sigma, 0.0] for line in lines])
    values = solved(rows, goal)
    return _Line(lines, values, np.linalg.inv(rows.T @ rows), float(np.sum((goal - rows @ values) ** 2)))


def _explains_phases(fitted: Sequence[_Line]) -> bool:
    """True if straight lines explain three records or more within their standard deviations."""
    from scipy.special import chdtrc

    freedom = sum(line.freedom for line in fitted)
    return freedom > 0 and bool(chdtrc(freedom, sum(line.squares for line in fitted)) > MIN_PROBABILITY)


def _of_one_phase(lines: Sequence[ErrorOrder]) -> list[ErrorOrder]:
    """Return the lines with the phase of the first record: only their amplitudes are compared."""
    return [replace(line, phase=lines[0].phase) for line in lines]


def _parts(line: ErrorOrder, warmer: float) -> Array:
    """Return two rows, along and across the measured wave, over their standard deviations, shape (2, 4)."""
    along = np.array([np.cos(line.phase), np.sin(line.phase)])
    across = np.array([-along[1], along[0]])
    # The phase of a wave within the noise has a bounded deviation: across it, the noise is that along it.
    sigmas = line.amplitude_sigma, max(line.amplitude * line.phase_sigma, line.amplitude_sigma)
    return np.stack([np.concatenate([way, warmer * way]) / sigma for way, sigma in zip((along, across), sigmas, strict=True)])
