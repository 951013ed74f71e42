r"""Vibration in a run-up: orders of the shaft, the resonance that they pass, and lines of fixed frequency.

An order is a wave of the shaft's angle, which excites the structure at the frequency f of the moment,

.. math:: y = \mathrm{Re} \sum_n \bigl(a_n + (b_n + j r c_n) H(f_n)\bigr) e^{j n \theta}, \qquad
          H(f) = \frac{1}{1 - r^2 + 2 j \zeta r}, \quad r = f / f_0

(receptance of one degree of freedom). Receptance, mobility, transmissibility and the answer of an accelerometer to a force,
:math:`r^2 H = -1 + (1 + 2 j \zeta r) H`, are covered. :math:`a_n` is what passes by the resonance. Amplitudes are linear; f0
and ζ of all orders together are searched.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from math import tau

import numpy as np
from numpy.typing import NDArray

from strainwave.orders.lines import SpectrumLine
from strainwave.presentation import Presented
from strainwave.statistics.linear_fit import solved
from strainwave.statistics.residuals import correlation_length
from strainwave.typeset import number

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

MIN_SPEED_RATIO = 1.5  # of the fastest to the slowest speed, from which orders pass a range of frequencies
MAX_FROM_WHOLE = 0.01  # by which a line that passes a resonance lies beside its whole order: its phase turns there
MAX_ORDERS = 12  # of a shaft, each with six amplitudes
SAMPLES_OF_SEARCH = 2**15  # that first values are searched in, at most
SMOOTH_PERIODS = 8.0  # of an order, over which its amplitude is averaged for the first value of the resonance
START_DAMPING = 0.03  # of critical damping (assumed): of bolted structures of metal
DAMPING_BOUNDS = (1e-4, 0.5)  # of critical damping
MAX_FIXED = 6  # fixed frequencies
MIN_LINE_POWER = 50.0  # over the median beside it: noise has it once in 10^15
LINE_REACH = 12  # lines of the spectrum on each side, but for the next two, that it is compared with
MIN_SIGNIFICANCE = 5.0  # standard deviations of an amplitude, from which a line or a resonance is stated
PASSED_WIDTHS = 3.0  # half-power half widths on each side, that the orders must pass for a damping


@dataclass(frozen=True)
class OrderPassing:
    """An order of the shaft in a run-up.

    Attributes:
        order: of the shaft [1]
        amplitude: away from the resonance, the larger one of both ends of the run-up, in the unit of the vibration
        largest: amplitude where it is largest
        speed: of the shaft there [rad/s]
        sigma: standard deviation of the amplitudes
    """

    order: float
    amplitude: float
    largest: float
    speed: float
    sigma: float


@dataclass(frozen=True)
class RunUp(Presented):
    """Vibration of a shaft whose speed varies.

    Attributes:
        orders: of the shaft, those that stand out
        lines: fixed frequencies [Hz], and the amplitudes and standard deviations of their waves
        frequency, frequency_sigma: of the resonance [Hz]; nan if none is determined
        damping, damping_sigma: of it, as a share of the critical one [1]; nan if none is determined
        noise: standard deviation of what is left
        remarks: what is not determined, and why
    """

    orders: tuple[OrderPassing, ...]
    lines: tuple[tuple[float, float, float], ...]
    frequency: float
    frequency_sigma: float
    damping: float
    damping_sigma: float
    noise: float
    remarks: tuple[str, ...] = ()


def is_run_up(speed: Array) -> bool:
    """True if a speed varies enough for orders to pass a range of frequencies."""
    fast, slow = np.quantile(np.abs(speed), [0.95, 0.05])
    return bool(fast > MIN_SPEED_RATIO * max(float(slow), 1e-300))


def run_up(time: Array, angle: Array, speed: Array, series: Array, lines: Sequence[SpectrumLine]) -> RunUp:
    """Return orders, resonance and fixed frequencies of a run-up.

    Args:
        time: evenly [s], shape (n,)
        angle: of the shaft [rad], shape (n,)
        speed: of it [rad/s], shape (n,)
        series: vibration, shape (n,)
        lines: that stand out of its spectra over the angle and over the time
    """
    orders = _whole([line.order for line in lines if line.kind in ("order", "either")])[:MAX_ORDERS]
    fixed = [line.frequency for line in lines if line.kind == "time"]
    problem = _Problem(time, angle, np.abs(speed), series, orders, fixed)
    start, fit = problem.start(), None
    remarks = ["no order stands out, so no resonance is looked for"]
    if start is not None:
        fit, remarks = problem.passed(start)
        while len(problem.fixed) < MAX_FIXED and (hidden := problem.line_left(fit)):
            problem = replace(problem, fixed=[*problem.fixed, hidden])
            fit, remarks = problem.passed(fit.values)
        if why := problem.why_not(fit):
            fit, remarks = None, [f"no resonance is determined: {why}"]
    if fit is None:
        fit = problem.fitted_amplitudes(np.zeros(0), np.zeros(0), True, 1.0)
    values, sigmas = (each.tolist() or [np.nan, np.nan] for each in (fit.values, fit.sigmas))
    return RunUp(
        tuple(problem.passings(fit)),
        tuple(problem.fixed_lines(fit)),
        values[0],
        sigmas[0],
        values[1],
        sigmas[1],
        fit.noise,
        tuple(remarks),
    )


def _whole(orders: Sequence[float]) -> list[float]:
    """Return orders, those beside a whole one as this, each once: a line that passes a resonance is smeared.

    >>> _whole([1.9995, 0.9999, 1.997, 2.5])
    [2.0, 1.0, 2.5]
    """
    near = [float(round(each)) if round(each) and abs(each / round(each) - 1.0) < MAX_FROM_WHOLE else each for each in orders]
    return list(dict.fromkeys(near))


@dataclass(frozen=True)
class _Fit:
    """Amplitudes of all columns at some values of frequency and damping, or without a resonance."""

    values: Array
    sigmas: Array
    amplitudes: Array
    sigma_of_amplitudes: float
    noise: float
    steady: bool


@dataclass(frozen=True)
class _Problem:
    time: Array
    angle: Array
    speed: Array
    series: Array
    orders: Sequence[float]
    fixed: Sequence[float]

    def start(self) -> Array | None:
        """Return first values of frequency [Hz] and damping, of the order that is amplified most; None without one."""
        best, peak = None, 0.0
        for order in self.orders:
            frequency = order * self.speed / tau
            reach = max(int(SMOOTH_PERIODS / max(float(np.median(frequency)), 1e-300) / (self.time[1] - self.time[0])), 1)
            envelope = np.abs(np.convolve(self.series * np.exp(-1j * order * self.angle), np.ones(reach) / reach, "valid"))
            middle = frequency[reach // 2 : reach // 2 + len(envelope)]
            usual = float(np.median(envelope))
            if envelope.max() / max(usual, 1e-300) > peak:
                best, peak = float(middle[int(np.argmax(envelope))]), float(envelope.max() / max(usual, 1e-300))
        return None if best is None or best <= 0.0 else np.array([best, START_DAMPING])

    def passed(self, start: Array) -> tuple[_Fit, list[str]]:
        """Return the fit that leaves less, with half the difference of the other one in its deviations; and a remark."""
        fits = {"each frequency answers at once": self.fitted(start, steady=True)}
        fits["the structure answers with its own decay"] = self.fitted(start, steady=False)
        way, best = min(fits.items(), key=lambda each: each[1].noise)
        (other,) = (each for each in fits.values() if each is not best)
        remark = (
            f"of two models of a passing, the one in which {way} leaves less; the other one has the resonance at "
            f"{number(float(other.values[0]), 4)} Hz, and half the difference is in the standard deviations"
        )
        return replace(best, sigmas=np.hypot(best.sigmas, 0.5 * np.abs(best.values - other.values))), [remark]

    def line_left(self, fit: _Fit) -> float:
        """Return the frequency of a line that orders hid when they passed it [Hz]; 0 if there is none."""
        from strainwave.statistics.spectrum import hann

        columns = self._columns(fit.values, fit.steady)
        left = self.series - columns @ solved(columns, self.series)
        power = np.abs(np.fft.rfft(left * hann(len(left)))) ** 2
        at = int(np.argmax(power[1:-1])) + 1
        beside = np.concatenate([power[max(at - LINE_REACH, 0) : max(at - 2, 0)], power[at + 3 : at + 1 + LINE_REACH]])
        if power[at] < MIN_LINE_POWER * np.median(beside):  # an order that is left has as much beside
            return 0.0
        low, middle, high = np.log(power[at - 1 : at + 2])
        return float((at + 0.5 * (low - high) / (low - 2.0 * middle + high)) / (len(left) * (self.time[1] - self.time[0])))

    def fitted(self, start: Array, steady: bool) -> _Fit:
        """Return the fit of frequency and damping."""
        from scipy.optimize import least_squares

        def left(values: Array, step: int) -> Array:
            columns = self._columns(values, steady)[::step]
            return np.asarray(self.series[::step] - columns @ solved(columns, self.series[::step]))

        low, high = min(self.orders) * self.speed.min() / tau, max(self.orders) * self.speed.max() / tau
        bounds = ([low, DAMPING_BOUNDS[0]], [high, DAMPING_BOUNDS[1]])
        scale = [START_DAMPING * start[0], START_DAMPING]
        step = max(len(self.series) // SAMPLES_OF_SEARCH, 1)
        coarse = least_squares(left, start, x_scale=scale, bounds=bounds, args=(step,))
        best = least_squares(left, coarse.x, x_scale=scale, bounds=bounds, args=(1,))
        correlated, jacobian = max(correlation_length(best.fun), 1.0), np.asarray(best.jac, float)
        noise = float(np.std(best.fun))
        sigmas = noise * np.sqrt(correlated * np.diag(np.linalg.pinv(jacobian.T @ jacobian)))
        return self.fitted_amplitudes(best.x, sigmas, steady, correlated)

    def fitted_amplitudes(self, values: Array, sigmas: Array, steady: bool, correlated: float) -> _Fit:
        """Return the fit at values of frequency and damping; at none, without a resonance."""
        columns = self._columns(values, steady)
        amplitudes = solved(columns, self.series) if columns.shape[1] else np.zeros(0)
        noise = float(np.std(self.series - columns @ amplitudes))
        return _Fit(values, sigmas, amplitudes, noise * np.sqrt(2.0 * correlated / len(self.series)), noise, steady)

    def why_not(self, fit: _Fit) -> str:
        """Return why a fit determines no resonance; empty if it does."""
        frequency, damping = fit.values
        passed = [(float(order * self.speed.min() / tau), float(order * self.speed.max() / tau)) for order in self.orders]
        width = PASSED_WIDTHS * damping * frequency
        if not any(low < frequency - width and frequency + width < high for low, high in passed):
            return f"no order passes {number(float(frequency), 3)} Hz from well below to well above; run up further"
        if damping > 0.9 * DAMPING_BOUNDS[1] or not damping > MIN_SIGNIFICANCE * fit.sigmas[1]:
            return "what the orders have is no peak of one degree of freedom"
        gain = max(abs(part[1] + 1j * part[2]) for part in self._parts(fit))
        if gain < MIN_SIGNIFICANCE * fit.sigma_of_amplitudes:
            return "no order is larger there than elsewhere"
        return ""

    def passings(self, fit: _Fit) -> Iterator[OrderPassing]:
        """Yield the orders that stand out, the strongest first."""
        passings = []
        for order, part in zip(self.orders, self._parts(fit), strict=True):
            size = np.abs(part @ _answers(order * self.speed / tau, fit.values))
            at, ends = int(np.argmax(size)), size[[int(np.argmin(self.speed)), int(np.argmax(self.speed))]].max()
            passings.append(OrderPassing(order, float(ends), float(size[at]), float(self.speed[at]), fit.sigma_of_amplitudes))
        strong = (passing for passing in passings if passing.largest > MIN_SIGNIFICANCE * passing.sigma)
        yield from sorted(strong, key=lambda passing: -passing.largest)

    def fixed_lines(self, fit: _Fit) -> Iterator[tuple[float, float, float]]:
        """Yield the fixed frequencies that stand out, with amplitude and standard deviation."""
        pairs = fit.amplitudes[len(fit.amplitudes) - 2 * len(self.fixed) :].reshape(-1, 2)
        for frequency, pair in zip(self.fixed, pairs, strict=True):
            if (size := float(np.hypot(*pair))) > MIN_SIGNIFICANCE * fit.sigma_of_amplitudes:
                yield frequency, size, fit.sigma_of_amplitudes

    def _parts(self, fit: _Fit) -> Complex:
        """Return the amplitudes of each order: of what passes by the resonance and, with one, of the two that it amplifies."""
        width = 2 * (3 if len(fit.values) else 1)
        return fit.amplitudes[: width * len(self.orders)].reshape(len(self.orders), width).view(complex)

    def _columns(self, values: Array, steady: bool) -> Array:
        waves: list[Complex] = []
        for order in self.orders:
            wave = np.exp(1j * order * self.angle)
            waves += list(wave * _answers(order * self.speed / tau, values) if steady else self._decaying(wave, values))
        waves += [np.exp(1j * tau * frequency * self.time) for frequency in self.fixed]
        columns = [part for wave in waves for part in (wave.real, -wave.imag)]
        return np.stack(columns, axis=1) if columns else np.zeros((len(self.time), 0))

    def _decaying(self, wave: Complex, values: Array) -> Complex:
        """Return the answers to a wave that begins at the first sample."""
        from scipy.fft import fft, fftfreq, ifft, next_fast_len

        length = next_fast_len(2 * len(wave))
        frequency = fftfreq(length, self.time[1] - self.time[0])
        return np.asarray(ifft(fft(wave, length) * _answers(frequency, values))[:, : len(wave)])


def _answers(frequency: Array, values: Array) -> Complex:
    """Return 1 and, with a resonance, its receptance and mobility over the static receptance, shape (1 or 3, n)."""
    if not len(values):
        return np.ones((1, len(frequency)), complex)
    ratio = frequency / values[0]
    receptance = 1.0 / (1.0 - ratio**2 + 2j * values[1] * ratio)
    return np.stack([np.ones(len(frequency)), receptance, 1j * ratio * receptance])
