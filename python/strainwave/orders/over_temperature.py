"""Kinematic error over the temperature: orders of records of two encoders at several temperatures, as a law of the gear."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import isclose, tau

import numpy as np
from numpy.typing import ArrayLike, NDArray

from strainwave import _core, arguments, typeset
from strainwave.orders.two_encoders import MAX_HARMONICS, ErrorOrder, TransmissionError
from strainwave.presentation import Presented, Row
from strainwave.statistics.linear_fit import solved

Array = NDArray[np.float64]

SAME_ORDER = 1e-3  # relative difference of one order in two records, whose measured ratios differ a little
UNKNOWNS = 4  # of an order: sine and cosine part, and their changes
MEASURED_TWICE = "two records do not test the line: whatever else differs between them counts as temperature; add a third"
SAME_ZERO = "phases are comparable if the zero of the input encoder was the same in all records"


@dataclass(frozen=True)
class OrderOverTemperature(Presented):
    """Order of the kinematic error over the temperature, at the mean temperature of the records.

    Attributes:
        order: periods per revolution of the input [1]
        amplitude, amplitude_sigma: of it at the output [rad], and its standard deviation
        phase, phase_sigma: of it [rad], as of a sine
        amplitude_rate, amplitude_rate_sigma: change of the amplitude [rad/K]
        phase_rate, phase_rate_sigma: change of the phase [rad/K]
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
        return max(self.amplitude_rate_sigma, self.amplitude * self.phase_rate_sigma)


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
    ratio (Birge1932), and the changes are judged by this scatter.

    Args:
        errors: results of `sw.transmission_error` of one gear, each at one temperature, whose encoders kept their zero
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
    orders = tuple(_line(lines, degrees - reference, len(common), allowed) for lines in common)
    remarks = [SAME_ZERO, *([MEASURED_TWICE] if len(set(degrees.tolist())) == 2 else [])]
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


def _line(lines: Sequence[ErrorOrder], warmer: Array, count: int, allowed: float) -> OrderOverTemperature:
    """Return one order over the temperature, one of `count` that are judged together."""
    rows = np.concatenate([_parts(line, step) for line, step in zip(lines, warmer, strict=True)])
    goal = np.concatenate([[line.amplitude / line.amplitude_sigma, 0.0] for line in lines])
    values = solved(rows, goal)
    freedom, left = len(goal) - UNKNOWNS, goal - rows @ values
    birge = max(1.0, float(left @ left) / freedom) if freedom else 1.0
    covariance = birge * np.linalg.inv(rows.T @ rows)
    amplitude, phase = float(np.hypot(*values[:2])), float(np.arctan2(values[1], values[0]))
    along = np.array([np.cos(phase), np.sin(phase)])
    across = np.array([-along[1], along[0]])
    blocks = covariance[:2, :2], covariance[2:, 2:]
    sigmas = [float(np.sqrt(way @ block @ way)) for block in blocks for way in (along, across)]
    square = float(values[2:] @ np.linalg.solve(covariance[2:, 2:], values[2:]))
    alarm = (1.0 + square / freedom) ** (-0.5 * freedom) if birge > 1.0 else float(np.exp(-0.5 * square))
    alarm = min(1.0, count * alarm)
    return OrderOverTemperature(
        order=lines[0].order,
        amplitude=amplitude,
        amplitude_sigma=sigmas[0],
        phase=phase,
        phase_sigma=min(sigmas[1] / amplitude, tau),
        amplitude_rate=float(along @ values[2:]),
        amplitude_rate_sigma=sigmas[2],
        phase_rate=float(across @ values[2:]) / amplitude,
        phase_rate_sigma=sigmas[3] / amplitude,
        false_alarm=alarm,
        significant=alarm < allowed,
    )


def _parts(line: ErrorOrder, warmer: float) -> Array:
    """Return two rows, along and across the measured wave, over their standard deviations, shape (2, 4)."""
    along = np.array([np.cos(line.phase), np.sin(line.phase)])
    across = np.array([-along[1], along[0]])
    # The phase of a wave within the noise has a bounded deviation: across it, the noise is that along it.
    sigmas = line.amplitude_sigma, max(line.amplitude * line.phase_sigma, line.amplitude_sigma)
    return np.stack([np.concatenate([way, warmer * way]) / sigma for way, sigma in zip((along, across), sigmas, strict=True)])
