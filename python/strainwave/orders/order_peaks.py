r"""Peaks of an order over the speed: the speed of each, its damping, and what of the order passes by it.

Where an order meets a mode, its complex amplitude follows the receptance of one degree of freedom over the speed,

.. math:: X(\Omega) = b_0 + b_1 \Omega + b_2 \Omega^2 + \sum_k g_k\, H(\Omega / \Omega_k), \qquad
          H(r) = \frac{1}{1 - r^2 \pm 2 j \zeta_k r}

with the peak at the speed :math:`\Omega_k`. The frequency in the mode's own frame is proportional to the speed, whatever the
waves of the mode, so that r and the damping ratio ζ do not depend on them. The sign is that of this frequency: it is negative
where a wave goes round faster than the order. In a run-up the answer is late; the first term of this,
:math:`\tfrac{j}{2} \dot\omega H''`, is part of the model.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

from strainwave.orders.orders_over_speed import OrdersOverSpeed
from strainwave.statistics.residuals import correlation_length
from strainwave.typeset import number

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

MAX_PEAKS = 3  # of an order
TRIED_SPEEDS = 80  # at which a peak may begin
TRIED_DAMPINGS = (0.004, 0.01, 0.025, 0.06)
DAMPING_BOUNDS = (5e-4, 0.2)
BASE_POWERS = (2, 3, 4)  # terms of what passes by; the middle one is fitted, the others widen the standard deviations
PASSED_WIDTHS = 4.0  # half-power half widths on each side, that the speeds must pass
MIN_IN_PEAK = 4  # speeds within these
MIN_APART = 2.0  # half widths between two peaks of an order
MIN_GAIN = 30.0  # of the log-likelihood by a peak: with all places tried, noise has it once in 10^8
MAX_LATE = 0.3  # of the half width, by which a peak may be late and blurred
MAX_LEFT = 0.02  # of the height of a peak, that a fit may leave there (assumed): two modes side by side leave more
MAX_DAMPING_SIGMA = 0.2  # of the damping: a peak that is less exact may be another one's
MIN_OUTPUT_TURN = 0.5  # rad of the output, from which the orders of both splines differ
MIN_TO_SEPARATE = 40  # amplitudes, from which they are separated
MIN_SPEED_SIGMA = 1e-3  # of the speed of a peak: the stiffness of a gear varies along a turn (assumed)
MIN_DAMPING_SIGMA = 0.02  # of the damping, likewise
LATE_SHARE = 0.5  # of the lateness of a peak, that the first term leaves (assumed)


@dataclass(frozen=True)
class OrderPeak:
    """A peak that an order has over the speed.

    Attributes:
        order: of the shaft [1]
        order_sigma: standard deviation of it; 0 of a whole number
        speed: of the shaft at the peak [rad/s]
        speed_sigma: its standard deviation [rad/s]
        damping: ratio of the mode that the order meets [1]
        damping_sigma: its standard deviation [1]
        height: of the peak over what passes by, in the unit of the column
    """

    order: float
    order_sigma: float
    speed: float
    speed_sigma: float
    damping: float
    damping_sigma: float
    height: float


@dataclass(frozen=True)
class _Fit:
    """Peaks of an order, each as speed, damping and sign."""

    values: Array
    signs: tuple[float, ...]
    curve: Complex
    cost: float
    sigma: Array
    heights: Array


def peaks_of(spectrum: OrdersOverSpeed, place: int) -> tuple[list[OrderPeak], Complex, list[str]]:
    """Return the peaks that the amplitudes of an order show, the curve of the fit, shape (k,), and remarks on other peaks."""
    order = _Order.of(spectrum, place)
    curve = np.full(len(spectrum.speed), complex("nan"))
    if order is None:
        return [], curve, []
    fit = order.fitted(np.zeros(0), (), BASE_POWERS[1])
    while len(fit.signs) < MAX_PEAKS:
        more = order.with_another(fit)
        if more is None:
            break
        fit = more
    curve[order.shown] = fit.curve
    if not fit.signs:
        return [], curve, []
    others = [order.fitted(fit.values, fit.signs, powers) for powers in (BASE_POWERS[0], BASE_POWERS[2])]
    spread = np.max([np.abs(other.values - fit.values) for other in others], axis=0)
    found, remarks = list[OrderPeak](), list[str]()
    for k in range(len(fit.signs)):
        part = slice(2 * k, 2 * k + 2)
        peak = order.peak(fit, k, np.hypot(fit.sigma[part], spread[part]))
        if isinstance(peak, OrderPeak):
            found.append(peak)
        elif peak:
            remarks.append(f"order {number(order.order, 5)} {peak}")
    return found, curve, remarks


@dataclass(frozen=True)
class _Order:
    """Amplitudes of an order, the rate at which the speed rises, and waves of the output by which the amplitudes may turn.

    The spline that turns has orders close to those of the one that does not, as 2 z_c / z_f: stretches do not separate them.
    """

    order: float
    shown: NDArray[np.bool_]
    speed: Array
    amplitude: Complex
    weight: Array
    rate: Array
    change: Array
    turning: Complex

    @classmethod
    def of(cls, spectrum: OrdersOverSpeed, place: int) -> _Order | None:
        """Return the amplitudes of an order that its stretches determine; None if they are too few."""
        amplitude = spectrum.amplitude[place]
        shown = np.isfinite(amplitude)
        if shown.sum() < 2 * max(BASE_POWERS) + 4:
            return None
        change, time = [], []
        for start, stop, recording in spectrum.stretches[shown].tolist():
            of = spectrum.recordings[recording]
            change.append(of.speed[stop - 1] - of.speed[start])
            time.append(of.time[stop - 1] - of.time[start])
        sigma = np.maximum(spectrum.sigma[shown], 1e-6 * np.abs(amplitude[shown]).max())
        sigma = np.maximum(sigma, 0.3 * np.median(sigma))  # a short stretch may fit its samples by chance
        order, output = float(spectrum.orders[place]), spectrum.output[shown]
        turning = [np.ones(len(output), complex)]
        if np.ptp(output) > MIN_OUTPUT_TURN and shown.sum() > MIN_TO_SEPARATE:
            turning += [np.exp(1j * order * output), np.exp(-1j * order * output)]
        return cls(
            order,
            shown,
            spectrum.speed[shown],
            amplitude[shown],
            1.0 / sigma,
            np.array(change) / time,
            np.array(change),
            np.array(turning),
        )

    def late(self, speed: float, damping: float) -> float:
        """Return by how much of its half width a peak is late, and blurred by the speeds of a stretch."""
        near = np.abs(self.speed / speed - 1.0) < PASSED_WIDTHS * damping
        if not near.any():
            return 0.0
        rate, change = float(np.abs(self.rate[near]).mean()), float(np.abs(self.change[near]).mean())
        return rate / (self.order * (damping * speed) ** 2) + 0.5 * change / (damping * speed)

    def peak(self, fit: _Fit, k: int, sigma: Array) -> OrderPeak | str:
        """Return a peak of a fit; why it is not stated, in words, empty if the speeds do not pass it."""
        speed, damping = fit.values[2 * k : 2 * k + 2].tolist()
        late = self.late(speed, damping)
        if late > MAX_LATE:
            return f"may pass a peak too fast to determine it: run up {number(np.ceil(late / MAX_LATE), 2)} times as slowly"
        if not self.left_near(fit, speed, damping) < (MAX_LEFT + LATE_SHARE * late) * fit.heights[k]:
            return f"has a peak near {number(speed * 30.0 / np.pi, 3)} 1/min that is not that of a single mode"
        damping_sigma = float(np.linalg.norm([sigma[1], damping * MIN_DAMPING_SIGMA, LATE_SHARE * late * damping]))
        if not self.passes(speed, damping) or damping_sigma > MAX_DAMPING_SIGMA * damping or sigma[0] > 0.5 * damping * speed:
            return ""
        speed_sigma = float(np.linalg.norm([sigma[0], speed * MIN_SPEED_SIGMA, LATE_SHARE * late * damping * speed]))
        return OrderPeak(self.order, 0.0, speed, speed_sigma, damping, damping_sigma, float(fit.heights[k]))

    def left_near(self, fit: _Fit, speed: float, damping: float) -> float:
        """Return the root mean square of what a fit leaves near a peak."""
        near = np.abs(self.speed / speed - 1.0) < PASSED_WIDTHS * damping
        return float(np.sqrt(np.mean(np.abs((self.amplitude - fit.curve)[near]) ** 2))) if near.any() else 0.0

    def passes(self, speed: float, damping: float) -> bool:
        """Return True if the speeds pass a peak from below to above."""
        reach = PASSED_WIDTHS * damping
        below, above = self.speed < speed * (1.0 - reach), self.speed > speed * (1.0 + reach)
        within = np.unique(np.round(self.speed[~below & ~above], 6))
        return bool(below.sum() > 1 and above.sum() > 1 and len(within) >= MIN_IN_PEAK)

    def with_another(self, fit: _Fit) -> _Fit | None:
        """Return the fit with one more peak; None if the amplitudes do not show one."""
        width = 2.0 * len(self.turning)
        free = 2.0 * len(self.speed) - width * BASE_POWERS[1] - (width + 2.0) * (len(fit.signs) + 1)
        if free < 8.0:
            return None
        starts = sorted(self._starts(fit), key=lambda start: start[0])[:3]
        tried = [
            self.fitted(np.append(fit.values, [speed, damping]), (*fit.signs, sign), BASE_POWERS[1])
            for _, speed, damping, sign in starts
        ]
        best = min(tried, key=lambda each: each.cost, default=None)
        if best is None:
            return None
        left = self.weight * (self.amplitude - best.curve)
        gain = 0.5 * free * np.log(fit.cost / max(best.cost, 1e-300)) / _correlated(np.stack([left.real, left.imag], axis=1))
        return best if gain > MIN_GAIN and self._apart(best) else None

    def _apart(self, fit: _Fit) -> bool:
        """Return True if the last peak of a fit is one by itself."""
        (*others, (speed, damping)) = fit.values.reshape(-1, 2)
        return all(abs(speed / of - 1.0) > MIN_APART * max(damping, its) for of, its in others)

    def _starts(self, fit: _Fit) -> Iterator[tuple[float, float, float, float]]:
        """Yield the cost, speed, damping and sign of each first value of a peak."""
        low, high = float(self.speed.min()), float(self.speed.max())
        for speed, damping, sign in product(np.linspace(low, high, TRIED_SPEEDS), TRIED_DAMPINGS, (1.0, -1.0)):
            columns = self._columns(np.append(fit.values, [speed, damping]), (*fit.signs, sign), BASE_POWERS[1])
            yield self._cost(columns), float(speed), damping, sign

    def _cost(self, columns: Complex) -> float:
        weighted, wanted = self.weight[:, None] * columns, self.weight * self.amplitude
        left = wanted - weighted @ np.linalg.lstsq(weighted, wanted, rcond=1e-10)[0]
        return float(np.vdot(left, left).real)

    def fitted(self, start: Array, signs: tuple[float, ...], powers: int) -> _Fit:
        """Return the fit of peaks with so many terms of what passes by."""
        from scipy.optimize import least_squares

        weighted = self.weight * self.amplitude

        def amplitudes(values: Array) -> tuple[Complex, Complex]:
            columns = self._columns(values, signs, powers)
            factors: Complex = np.linalg.lstsq(self.weight[:, None] * columns, weighted, rcond=1e-10)[0].astype(complex)
            return columns, factors

        def left(logs: Array) -> Array:
            columns, factors = amplitudes(np.exp(logs))
            return (weighted - self.weight * (columns @ factors)).view(float)

        values, sigma = np.zeros(0), np.zeros(0)
        if len(start):
            low = np.tile(np.log([self.speed.min(), DAMPING_BOUNDS[0]]), len(signs))
            high = np.tile(np.log([self.speed.max(), DAMPING_BOUNDS[1]]), len(signs))
            logs = np.clip(np.log(start), low + 1e-9, high - 1e-9)
            scale = np.tile([0.01, 0.3], len(signs))
            best = least_squares(left, logs, bounds=(low, high), x_scale=scale, max_nfev=60)
            values = np.exp(best.x)
            jacobian = np.asarray(best.jac, float)
            free = max(len(best.fun) - 2 * len(self.turning) * (powers + len(signs)) - len(values), 1)
            variance = float(best.fun @ best.fun) / free * _correlated(best.fun.reshape(-1, 2))
            sigma = values * np.sqrt(variance * np.diag(np.linalg.pinv(jacobian.T @ jacobian)))
        columns, factors = amplitudes(values)
        residual = self.weight * (self.amplitude - columns @ factors)
        cost = float(np.vdot(residual, residual).real)
        gains = np.abs(factors.reshape(-1, len(self.turning))[powers:]).max(axis=1)
        heights = gains / (2.0 * values[1::2]) if len(values) else np.zeros(0)
        return _Fit(values, signs, columns @ factors, cost, sigma, heights)

    def _columns(self, values: Array, signs: Sequence[float], powers: int) -> Complex:
        share = self.speed / self.speed.max()
        columns: list[Complex] = [share**power + 0j for power in range(powers)]
        for (speed, damping), sign in zip(values.reshape(-1, 2), signs, strict=True):
            ratio = self.speed / speed
            answer = 1.0 / (1.0 - ratio**2 + 2j * sign * damping * ratio)
            slope = (2.0 * ratio - 2j * sign * damping) * answer**2
            bend = 2.0 * answer**2 + 2.0 * (2.0 * ratio - 2j * sign * damping) * answer * slope
            late = 0.5j * sign * self.rate / (self.order * speed**2)
            columns.append(answer - late * bend)
        return np.stack([column * wave for column in columns for wave in self.turning], axis=1)


def _correlated(parts: Array) -> float:
    """Return the correlation length of the real and the imaginary parts of residuals, shape (n, 2)."""
    return max(1.0, *(correlation_length(part) for part in parts.T))
