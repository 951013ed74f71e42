r"""Regression of the transmission error through the output stage, without simulation.

With theta the input angle, q the output angle, e the kinematic error and i the ratio, a linear output stage is

.. math:: J \ddot q = K \delta + D \dot\delta - T_\text{load}, \qquad \delta = \theta / i - q - e(\theta)

so that the transmission error, which two encoders measure, is

.. math:: \frac{\theta}{i} - q = (1 - F) \frac{\theta}{i} + F e(\theta) + H \frac{T_\text{load}}{K}, \qquad
          F = \frac{1 + 2 \zeta s / \omega_0}{1 + 2 \zeta s / \omega_0 + s^2 / \omega_0^2}, \quad
          H = \frac{1}{1 + 2 \zeta s / \omega_0 + s^2 / \omega_0^2}

with omega_0 the natural frequency of the output with the input held. Slow against it, F = H = 1. An order that passes it is
amplified, and above it the output stands still and the transmission error shows no kinematic error at all. Everything but
omega_0 and zeta is linear, so that only these two are searched (GolubPereyra1973). Both sides are compared in the frequency
domain, each line weighed by the noise around it, estimated from the residual; the ends of the record add a
transient of the stage (PintelonSchoukens2012).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import pi

import numpy as np
from numpy.typing import NDArray

from strainwave.statistics.linear_fit import normal_inverse, own_share, solved
from strainwave.statistics.spectrum import floor_of

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

MAX_FREQUENCY = 0.4  # cycles per sample, up to which lines are compared
FIT_ROUNDS = 4  # of weights and fit
SCORE_BLOCKS = 200  # of the record, over which scores are summed for the covariance
MIN_STAGE_GAIN = 30.0  # of the logarithm of the likelihood, from which the output stage is worth its two parameters
STIFFNESS_SPREAD = 0.10  # by which the stiffness that ripple meets may differ from that of the whole motion (assumed)
DAMPING_SPREAD = 0.30  # the same of the damping (assumed)
MIN_OWN_SHARE = 0.1  # of what the natural frequency changes [1], that no other amplitudes of orders and loads make up
MAX_RELATIVE_SHIFT = 0.01  # of an order by an output stage that the record does not determine: a smaller one is no vibration
SIGNIFICANCE_SIGMA = 3.0  # standard deviations of an order that stands out
MIN_SIGNAL_POWER = 30.0  # of a line over its noise [1], from which it counts for the output stage
START_FREQUENCIES = 2.0 * pi * MAX_FREQUENCY * np.geomspace(0.004, 1.0, 12)  # initial natural frequencies [rad per sample]
START_DAMPINGS = (0.1, 0.5)  # initial damping ratios [1]: a narrow resonance is met by few starts


@dataclass(frozen=True)
class Stage:
    """The output stage: natural frequency with the input held [rad per sample], damping ratio."""

    frequency: float
    damping: float

    @property
    def logarithms(self) -> Array:
        return np.asarray(np.log([self.frequency, self.damping]))

    def gains(self, s: Complex) -> tuple[Complex, Complex]:
        """Return F and H at s = j omega [rad per sample]."""
        x = s / self.frequency
        below = 1.0 + 2.0 * self.damping * x + x**2
        return (1.0 + 2.0 * self.damping * x) / below, 1.0 / below


@dataclass(frozen=True)
class Regressed:
    """Result of a regression.

    Attributes:
        values: coefficients, first of the orders, then of the loads, shape (n,)
        covariance: of them, shape (n, n)
        freedom: degrees of freedom that the covariance rests on
        stage: the output stage, None if the record does not determine it
        vibrates: True if amplitudes change with the speed as by an output stage that the record does not determine
        spread: standard deviations of the logarithms of its frequency and damping
        residual: below the highest line that is compared, shape (samples,)
    """

    values: Array
    covariance: Array
    freedom: int
    stage: Stage | None
    spread: tuple[float, float]
    residual: Array
    vibrates: bool = False


@dataclass(frozen=True)
class StageProblem:
    """Series of a record to be compared, all evenly in time.

    Args:
        angle: theta / i [rad], shape (n,)
        error: theta / i - q [rad], shape (n,)
        orders: series that pass F, as sin(2 theta), shape (n, k)
        loads: series that pass H, shape (n, l)
    """

    angle: Array
    error: Array
    orders: Array
    loads: Array

    def regress(self, *, dynamic: bool) -> Regressed:
        """Fit the coefficients, and the output stage if the record determines it."""
        lines = _Lines.of(self)
        still = lines.fitted(None)
        measured = lines.result(still)
        if not dynamic:
            return measured
        shown = lines.with_signal(still)
        moved = shown.fitted(shown.nearest(still.floor), still.floor)
        gain = lines.misfit(still, shown.counts) - lines.misfit(moved, shown.counts)
        if gain <= MIN_STAGE_GAIN:
            return measured
        measured = replace(measured, vibrates=self._moves_an_order(measured, moved.values))
        if shown.own_share_of_frequency(moved) <= MIN_OWN_SHARE:
            return measured
        if lines.is_within_bounds(moved):
            return shown.result(moved)
        apart = moved.values[: len(measured.values)] - measured.values  # what the choice of the model leaves open
        return replace(measured, covariance=measured.covariance + np.outer(apart, apart))

    def _moves_an_order(self, measured: Regressed, values: Array) -> bool:
        """True if other values of the coefficients differ in an order that stands out."""
        count = self.orders.shape[1]
        before, after = (each[:count:2] + 1j * each[1:count:2] for each in (measured.values, values))
        stands_out = np.abs(before) > SIGNIFICANCE_SIGMA * np.sqrt(np.diag(measured.covariance)[:count:2])
        return bool(np.any(stands_out & (np.abs(after - before) > MAX_RELATIVE_SHIFT * np.abs(before))))


@dataclass(frozen=True)
class _Fitted:
    stage: Stage | None
    values: Array  # in units in which each series has length 1
    floor: Array  # at each line


@dataclass(frozen=True)
class _Lines:
    """The problem in the frequency domain, from the first line to the highest that is compared."""

    count: int
    s: Complex
    angle: Complex
    error: Complex
    orders: Complex
    loads: Complex
    counts: NDArray[np.bool_]  # lines that count
    angle_noise: float  # power of a line

    @classmethod
    def of(cls, problem: StageProblem) -> _Lines:
        count = len(problem.error)
        frequency = np.fft.rfftfreq(count)
        kept = (frequency > 0.0) & (frequency < MAX_FREQUENCY)

        def lines(series: Array) -> Complex:
            return np.asarray(np.fft.rfft(series, axis=0)[kept] / np.sqrt(count))

        straight = np.linspace(problem.angle[0], problem.angle[-1], count)
        s = (2j * pi * frequency[kept]).astype(np.complex128)
        error = problem.error - problem.error.mean()
        noise = float(np.mean(np.diff(problem.angle, 4) ** 2)) / 70.0  # of white noise in fourth differences
        series = (lines(problem.angle - straight), lines(error), lines(problem.orders), lines(problem.loads))
        return cls(count, s, *series, np.ones(len(s), dtype=bool), noise)

    def with_signal(self, still: _Fitted) -> _Lines:
        """Return the problem with the lines alone in which the motion or an order stands out of its noise.

        In the others the angle is the noise of its encoder. The error contains this noise too, and the output does not follow
        it, as above a natural frequency: it would be taken for one.
        """
        moved = np.abs(self.angle) ** 2 > MIN_SIGNAL_POWER * self.angle_noise
        waves = np.abs(self.orders @ still.values[: self.orders.shape[1]]) ** 2 > MIN_SIGNAL_POWER * still.floor
        return replace(self, counts=moved | waves)

    def misfit(self, fitted: _Fitted, counts: NDArray[np.bool_]) -> float:
        """Return minus the logarithm of the likelihood of some lines."""
        power = np.abs(self.left(fitted.stage, fitted.values)) ** 2
        return float(np.sum((np.log(fitted.floor) + power / fitted.floor)[counts]))

    def nearest(self, floor: Array) -> Stage:
        """Return the best initial stage."""
        tried = [Stage(float(frequency), damping) for frequency in START_FREQUENCIES for damping in START_DAMPINGS]
        return min(tried, key=lambda each: float(np.sum(self.misses(each, floor)[1] ** 2)))

    def fitted(self, stage: Stage | None, floor: Array | None = None) -> _Fitted:
        """Fit in turns with the weights, which follow from the residual."""
        from scipy.optimize import least_squares

        def missed(logarithms: Array, floor: Array) -> Array:
            return self.misses(_stage(logarithms), floor)[1]

        floor = np.ones(len(self.s)) if floor is None else floor
        values = np.zeros(0)
        for _ in range(FIT_ROUNDS):
            if stage is not None:
                low, high = self.bounds
                start = np.clip(stage.logarithms, low + 1e-6, high - 1e-6)
                best = least_squares(missed, start, args=(floor,), bounds=(low, high), x_scale=[0.1, 0.3], xtol=1e-5, ftol=1e-7)
                stage = _stage(best.x)
            values, _ = self.misses(stage, floor)
            left = self.left(stage, values)
            floor = floor_of(np.abs(left) ** 2, self.count).at(np.abs(self.s.imag) / (2.0 * pi))
        return _Fitted(stage, values, floor)

    @property
    def bounds(self) -> tuple[Array, Array]:
        """Bounds of the logarithms of the natural frequency [rad per sample], within the lines compared, and of the damping."""
        return np.log([4.0 * pi / self.count, 1e-3]), np.log([2.0 * pi * MAX_FREQUENCY, 3.0])

    def is_within_bounds(self, fitted: _Fitted) -> bool:
        """True if the stage lies within its bounds: one on a bound is no vibration, but stands for something else."""
        assert fitted.stage is not None
        at, (low, high) = fitted.stage.logarithms, self.bounds
        return bool(np.all((at > low + 1e-3) & (at < high - 1e-3)))

    def design(self, stage: Stage | None) -> tuple[Complex, Complex]:
        """Return the series of the error, shape (lines, n), and the error compared with them, shape (lines,)."""
        if stage is None:
            return np.concatenate([self.orders, self.loads], axis=1), self.error
        f, h = stage.gains(self.s)
        x = self.s / stage.frequency
        ends = np.stack([h, h * x, np.ones_like(x), self.s / np.abs(self.s[-1])], axis=1) / np.sqrt(self.count)
        series = np.concatenate([self.orders * f[:, None], self.loads * h[:, None], ends], axis=1)
        return series, self.error - h * x**2 * self.angle

    def misses(self, stage: Stage | None, floor: Array) -> tuple[Array, Array]:
        """Return the best coefficients and the residual of the lines that count.

        Real parts stand over imaginary ones, each of variance 1 if it is noise.
        """
        from scipy.linalg import lstsq

        series, compared = self.design(stage)
        weight = np.sqrt(2.0 / floor[self.counts])
        matrix, target = _stacked(series[self.counts] * weight[:, None]), _stacked(compared[self.counts] * weight)
        size = np.linalg.norm(matrix, axis=0)
        size[size == 0.0] = 1.0
        values = lstsq(matrix / size, target, cond=1e-9, lapack_driver="gelsy", check_finite=False)[0] / size
        return values, target - matrix @ values

    def left(self, stage: Stage | None, values: Array) -> Complex:
        series, compared = self.design(stage)
        return compared - series @ values

    def result(self, fitted: _Fitted) -> Regressed:
        weight: Array = np.where(self.counts, np.sqrt(2.0 / fitted.floor), 0.0)
        series, _ = self.design(fitted.stage)
        columns = [_stacked(series * weight[:, None])]
        if fitted.stage is not None:
            columns.append(np.stack([self._slope(fitted, k, weight) for k in (0, 1)], axis=1))
        jacobian = np.concatenate(columns, axis=1)
        inverse = normal_inverse(jacobian)
        left = self.left(fitted.stage, fitted.values)
        scores = self._scores(jacobian, _stacked(left * weight))
        freedom = max(len(scores) - jacobian.shape[1], 1)
        covariance = inverse @ (scores.T @ scores) @ inverse * len(scores) / freedom
        spread = (float("nan"), float("nan"))
        if fitted.stage is not None:
            spread = (float(np.sqrt(covariance[-2, -2])), float(np.sqrt(covariance[-1, -1])))
            # a gear is no linear spring: stiffness and damping differ for ripple and motion. They are not estimated but
            # considered, each with its spread (Schmidt's consider covariance: Jazwinski1970)
            shifted = solved(jacobian[:, :-2], jacobian[:, -2:]) * np.array([0.5 * STIFFNESS_SPREAD, DAMPING_SPREAD])
            covariance[:-2, :-2] += np.asarray(shifted @ shifted.T)
        kept = self.orders.shape[1] + self.loads.shape[1]
        whole = np.zeros(self.count // 2 + 1, complex)
        whole[1 : len(left) + 1] = left * np.sqrt(self.count)
        residual = np.fft.irfft(whole, self.count)
        return Regressed(fitted.values[:kept], covariance[:kept, :kept], freedom, fitted.stage, spread, residual)

    def own_share_of_frequency(self, fitted: _Fitted) -> float:
        """Return the share of what the natural frequency changes [1] that no other amplitudes of orders and loads make up.

        It is zero at one speed, one way: there another amplitude and phase of each order predict the same.
        """
        weight: Array = np.where(self.counts, np.sqrt(2.0 / fitted.floor), 0.0)
        linear = _stacked(self.design(fitted.stage)[0] * weight[:, None])
        return float(own_share(self._slope(fitted, 0, weight)[:, None], linear)[0])

    def _slope(self, fitted: _Fitted, which: int, weight: Array) -> Array:
        """Return the slope of the model over the logarithm of the stage's frequency or damping."""
        assert fitted.stage is not None
        at, step = fitted.stage.logarithms, np.eye(2)[which] * 1e-4
        below, above = (self.left(_stage(at + sign * step), fitted.values) for sign in (-1.0, 1.0))
        return _stacked((below - above) / 2e-4 * weight)

    def _scores(self, jacobian: Array, left: Array) -> Array:
        """Return sums of series times residual over blocks of time, shape (blocks, n), so that noise may vary in time."""
        edges = np.linspace(0, self.count, min(SCORE_BLOCKS, self.count // 25) + 1).astype(int)[:-1]
        rest = self._over_time(left)
        products = [np.add.reduceat(self._over_time(column) * rest, edges) for column in jacobian.T]
        return 0.5 * np.stack(products, axis=1)

    def _over_time(self, stacked: Array) -> Array:
        half = len(self.s)
        whole = np.zeros(self.count // 2 + 1, complex)
        whole[1 : half + 1] = stacked[:half] + 1j * stacked[half:]
        return np.asarray(np.fft.irfft(whole, self.count) * np.sqrt(self.count))


def _stage(logarithms: Array) -> Stage:
    return Stage(float(np.exp(logarithms[0])), float(np.exp(logarithms[1])))


def _stacked(values: Complex) -> Array:
    return np.concatenate([values.real, values.imag])
