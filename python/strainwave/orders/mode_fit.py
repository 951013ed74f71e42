r"""Fit of resonances to complex amplitudes of orders over the speed of a shaft, by variable projection.

The wave generator of a strain wave gear presses on the ring at its lobes, at the angle θ. A mode of the ring with n waves,
driven by a force F that goes round with the lobes, is a vector z in the plane of its two shapes; u is its displacement at the
lobes,

.. math:: \ddot z + 2 \zeta \omega_0 \dot z + \omega_0^2 z = \omega_0^2 F e^{j n \theta}, \qquad
          u = \mathrm{Re} (z e^{-j n \theta}).

Of a force of order q, F = Re(f exp(j q θ)), the answer has order q as well, and it is resonant at two speeds,

.. math:: u = \mathrm{Re} \Bigl(\tfrac{f}{2} \bigl[H((q + n) \Omega) + H((q - n) \Omega)\bigr] e^{j q \theta}\Bigr), \qquad
          H(\omega) = \frac{1}{1 - (\omega / \omega_0)^2 + 2 j \zeta \omega / \omega_0}.

In the frame of the lobes such a mode has two lines, ω0 + n Ω and ω0 - n Ω: order q is resonant where q Ω meets a line. A mode
that does not travel (torsion, a housing, or a ring that the lobes hold firmly) has n = 0; a ring that they hold softly has
slopes between. So the fit is of lines, whose slopes s are whole if free ones are not more probable:

.. math:: X_q(\Omega) = b_q + c_q \Omega^2 + \sum_k g_{qk} H_k((q - s_k) \Omega).

Of one order the peak at Ωp determines (q - s) Ωp = ω0 alone, of two orders s and ω0. Of a sensor that stands on the ring s = 0,
and forces may grow with the speed squared: the mobility is a second column. Elsewhere it is a small one, for dampers.

Coefficients are linear; of each line only the orders count that it makes more probable. Lines are compared by the evidence with
normal priors of the coefficients, whose scale is that of the amplitudes (Bishop, "Pattern recognition and machine learning"
(2006), section 3.5). In a run-up each answer is integrated in time, as a resonance comes later than its force.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from math import log, tau
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from strainwave.orders.orders_over_speed import OrdersOverSpeed
from strainwave.statistics.residuals import correlation_length

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

MAX_SLOPE = 8.0  # of a line over the speed: of rings that are pressed at two lobes
SEARCH_SLOPES = tuple(range(-6, 7))
SLOPE_PRIOR = 4.0  # standard deviation of the slope, where orders do not determine it
DAMPING_BOUNDS = (5e-4, 0.4)  # of critical damping
SEARCH_DAMPINGS = (0.006, 0.02, 0.06)  # of critical damping, in the search of first values
SEARCH_STEP_SHARE = 0.7  # of the damping, from one frequency of the search to the next
SAME_START = 0.03  # of the frequency, between first values of the same slope
MAX_SEARCH_SPEEDS = 120  # stretches, that first values are searched in
LEAKING_SHARE = 1e-3  # of the change of an amplitude between stretches, that other orders get
MIN_NOISE_SHARE = 0.02  # of the changes of an order along the speed: forces and what passes by are no better known (assumed)
MOBILITY_SHARE = 0.2  # of the receptance, that a force through a damper, or one that grows with the speed, adds
MIN_OUTPUT_TURN = 0.5  # rad of the output, from which the orders of both splines differ
BASE_PRIOR = 30.0  # of what passes by the lines, over the root mean square of an order
MAX_EVALUATIONS = 120  # of a fit
BOUND_COST = 100.0  # standard deviations of the residual, by a value one beyond its bounds
MAX_PROPOSED = 200  # first values of the search
MAX_STARTS = 5  # first values that are fitted for a further line
MAX_EVIDENCE_LAG = 40.0  # of the natural logarithm of the odds, by which the search may be worse than its best to be fitted
MIN_ORDER_EVIDENCE = 4.0  # natural logarithm of the odds, from which an order counts for a line
MIN_EVIDENCE_OF_MODE = 10.0  # natural logarithm of the odds of one line more
MAX_MODES = 8
MAX_REPEATS = 4  # of a fit with another noise
MIN_DECREASE = 0.02  # of the logarithm of the noise of all orders
PEAK_WIDTHS = 4.0  # half widths from a peak, within which another one only corrects its shape
MAX_ROUNDS = 4  # of adding and exchanging modes
MIN_LEAD_OF_RIVAL = 2.0  # natural logarithm of the odds, from which a mode is exchanged
WHOLE_SLOPE_SIGMA = 0.01  # of a whole slope: rings are pressed a little out of round (assumed)
WHOLE_SLOPE_ODDS = 20.0  # of a slope of a whole number of waves to another one that fits as well (assumed)
MIN_SLOPE_GAP = 0.5  # between the slopes of rivals
MIN_SLOPE_OF_BOTH = 0.3  # from which both lines of a mode are separate
MIN_SIGNIFICANCE = 5.0  # standard deviations of the coefficient of an order that a line acts on
MIN_PASSES = 0.05  # of a force in a revolution, as the ring meets it
SLOW_SWEEP_SHARE = 0.1  # phase [rad] by which a force may turn within a step of time by its change of speed
MIN_CHANGE = 0.02  # of a receptance over its static one, along the speeds: less is that of what passes by
MAX_KEPT_ANSWERS = 64  # of lines: a derivative changes one of several
MAX_STEPS = 6000  # of time, in a run-up
CONSTANT_SPEED_SPREAD = 0.01  # of the speed in a recording, up to which a resonance answers at once
STEPS_PER_STRETCH = 8.0  # of time, in the shortest stretch


class Line(NamedTuple):
    """A mode as lines of resonance over the speed.

    Attributes:
        frequency: of the shaft at rest [rad/s]
        damping: as a share of the critical one [1]
        slope: of its first line over the speed [1]; the second one has the opposite slope
        acts_on: orders whose coefficient is not zero, of the first line and then of the second one
        whole: True if the slope is taken for that of a whole number of waves
    """

    frequency: float
    damping: float
    slope: float
    acts_on: tuple[bool, ...]
    whole: bool = False

    @property
    def acts(self) -> NDArray[np.bool_]:
        """Orders that each of both lines acts on, shape (orders, 2)."""
        return np.array(self.acts_on).reshape(2, -1).T


@dataclass(frozen=True)
class Fitted:
    """A fit of some lines.

    Attributes:
        lines: of it
        evidence: natural logarithm of the probability of the amplitudes, up to a constant of the spectrum
        covariance: of the logarithms of frequency and damping and of the slope, one line after the other, (3 lines, 3 lines)
        parts: coefficients of each order, of both lines of each mode, shape (orders, lines, 2)
        parts_sigma: their standard deviations, shape (orders, lines, 2)
        amplitude: of the model, shape (orders, stretches)
        noise: standard deviation of an amplitude of a stretch of mean length, shape (orders,)
        correlated: stretches over which the residual is correlated, shape (orders,)
    """

    lines: tuple[Line, ...]
    evidence: float
    covariance: Array
    parts: Complex
    parts_sigma: Array
    amplitude: Complex
    noise: Array
    correlated: Array


@dataclass(frozen=True)
class _Times:
    """Even times of recordings whose speed changes, one recording after the other.

    Attributes:
        step: between two times of a recording [s]
        angle: of the shaft [rad], shape (n,)
        since: steps since the beginning of the recording, shape (n,)
        first, last: place of the beginning and the end of each stretch in these times, shape (k,)
        rows: stretches that these are
    """

    step: float
    angle: Array
    since: Array
    first: Array
    last: Array
    rows: NDArray[np.int_]


@dataclass(frozen=True)
class ModeProblem:
    """Amplitudes of orders over speed, and how they are compared with modes.

    Attributes:
        spectrum: amplitudes
        stands: True for a sensor that does not go round with the lobes
    """

    spectrum: OrdersOverSpeed
    stands: bool

    @cached_property
    def measured(self) -> Complex:
        return np.where(self.weight > 0.0, np.nan_to_num(self.spectrum.amplitude), 0.0)

    @cached_property
    def weight(self) -> Array:
        """Usual over expected standard deviation of an amplitude, 0 if a stretch does not show it, shape (orders, k)."""
        amplitude = self.spectrum.amplitude
        shown = np.isfinite(amplitude)
        changes = np.abs(np.diff(np.nan_to_num(amplitude), axis=1)).max(axis=0, initial=0.0)
        near = np.maximum(np.append(changes, 0.0), np.append(0.0, changes))
        sigma = np.hypot(self.spectrum.sigma, LEAKING_SHARE * near) * np.ones((len(amplitude), 1))
        middle = np.median(sigma, axis=1)[:, None]
        return np.where(shown, middle / np.maximum(sigma, 1e-3 * middle + 1e-300), 0.0)

    @cached_property
    def count(self) -> Array:
        """Number of stretches of each order."""
        return np.asarray(np.maximum((self.weight > 0.0).sum(axis=1), 1), float)

    @cached_property
    def scale(self) -> Array:
        """Root mean square of each order without its mean."""
        mean = (self.measured * self.weight).sum(axis=1) / np.maximum(self.weight.sum(axis=1), 1e-300)
        square = (np.abs(self.weight * (self.measured - mean[:, None])) ** 2).sum(axis=1) / self.count
        return np.asarray(np.sqrt(np.maximum(square, 1e-300)))

    @cached_property
    def base(self) -> Complex:
        """What passes by the modes, weighted, shape (orders, k, c).

        A constant, a share that grows with the speed squared, and the order against the spline that turns with the output.
        """
        square = (self.spectrum.speed / np.abs(self.spectrum.speed).max()) ** 2
        columns = [np.ones((len(self.scale), len(square)), complex), np.broadcast_to(square, (len(self.scale), len(square)))]
        if np.ptp(self.spectrum.output) > MIN_OUTPUT_TURN:
            against = np.outer(self.spectrum.orders, self.spectrum.output)
            columns += [np.exp(1j * against), np.exp(-1j * against)]
        return np.asarray(np.stack(columns, axis=2) * self.weight[..., None], complex)

    # ---- Columns ---------------------------------------------------------------------------------------------------

    @cached_property
    def _varying(self) -> list[int]:
        """Places of the recordings in which the speed changes."""
        recordings = enumerate(self.spectrum.recordings)
        return [place for place, of in recordings if np.ptp(of.speed) > CONSTANT_SPEED_SPREAD * of.speed.max()]

    @property
    def varying(self) -> int:
        """Number of recordings in which the speed changes."""
        return len(self._varying)

    @cached_property
    def _times(self) -> _Times | None:
        """Times of the recordings whose speed changes; None if none does."""
        spectrum, varying = self.spectrum, self._varying
        rows = np.flatnonzero(np.isin(spectrum.stretches[:, 2], varying))
        if not len(rows):
            return None
        kept = [spectrum.recordings[place] for place in varying]
        duration = [float(each.time[-1] - each.time[0]) for each in kept]
        rate = max(float(np.ptp(each.speed)) / span for each, span in zip(kept, duration, strict=True))
        turned = SLOW_SWEEP_SHARE / (rate * (float(spectrum.orders.max()) + MAX_SLOPE))
        begins, ends = (
            np.array([spectrum.recordings[place].time[at] for at, place in spectrum.stretches[rows][:, [column, 2]]])
            for column in (0, 1)
        )
        step = min(float(np.sqrt(2.0 * turned)), float((ends - begins).min()) / STEPS_PER_STRETCH)
        step = max(step, sum(duration) / MAX_STEPS)
        grids = [each.time[0] + step * np.arange(int(span / step) + 2) for each, span in zip(kept, duration, strict=True)]
        angle = [_extended(grid, each.time, each.angle) for grid, each in zip(grids, kept, strict=True)]
        starts = dict(zip(varying, np.cumsum([0, *map(len, grids[:-1])]).tolist(), strict=True))
        offset = np.array([starts[place] for place in spectrum.stretches[rows, 2]])
        origin = np.array([spectrum.recordings[place].time[0] for place in spectrum.stretches[rows, 2]])
        first, last = (offset + (at - origin) / step for at in (begins, ends))
        since = np.concatenate([np.arange(len(grid), dtype=float) for grid in grids])
        return _Times(step, np.concatenate(angle), since, first, last, rows)

    @cached_property
    def _waves(self) -> Complex:
        """Waves of the orders at the times, shape (orders, steps)."""
        angle = np.zeros(0) if self._times is None else self._times.angle
        return np.asarray(np.exp(1j * np.outer(self.spectrum.orders, angle)))

    def _answers(self, slope: float, frequency: float, damping: float) -> Complex:
        """Return the mean receptance in each stretch of forces of the orders, seen from a line, shape (orders, k)."""
        orders, times = self.spectrum.orders - slope, self._times
        answer = _receptance(np.outer(orders, self.spectrum.speed), frequency, damping)
        if times is not None:
            force = self._waves * np.exp(-1j * slope * times.angle)
            answer[:, times.rows] = _later(times, orders, force, self.spectrum.speed[times.rows], frequency, damping)
        return answer

    @cached_property
    def _kept(self) -> dict[tuple[float, float, float], tuple[Complex, Array]]:
        return {}

    def _answer(self, line: Line, part: int) -> tuple[Complex, Array]:
        """Return receptance and mobility of a line of a mode, weighted, and their sizes, shapes (orders, k, 2), (orders, 2)."""
        slope = line.slope * (1.0 - 2.0 * part)
        key = line.frequency, line.damping, slope
        if key not in self._kept:
            if len(self._kept) >= MAX_KEPT_ANSWERS:
                self._kept.clear()
            receptance = self._answers(slope, line.frequency, line.damping)
            ratio = np.outer(self.spectrum.orders - slope, self.spectrum.speed) / line.frequency
            size = self._size(receptance)
            both = np.stack([receptance, 1j * ratio * receptance], axis=2) * self.weight[..., None]
            self._kept[key] = both, np.stack([size, size / (1.0 if self.stands else MOBILITY_SHARE)], axis=1)
        return self._kept[key]

    def _columns(self, lines: Sequence[Line]) -> tuple[Complex, Array]:
        """Return all weighted columns with their prior standard deviations, shapes (orders, k, c) and (orders, c).

        A mode has four columns, receptance and mobility of both lines; those that act on no order are zero.
        """
        own = self.base.shape[2]
        columns = np.zeros((*self.weight.shape, own + 4 * len(lines)), complex)
        priors = np.zeros((len(self.scale), own + 4 * len(lines)))
        columns[..., :own] = self.base
        priors[:, :own] = BASE_PRIOR * self._mean_size[:, None]
        for k, line in enumerate(lines):
            for part, acts in enumerate(line.acts.T):
                if acts.any():
                    place = slice(own + 4 * k + 2 * part, own + 4 * k + 2 * part + 2)
                    columns[..., place], size = self._answer(line, part)
                    live = acts & (size[:, 0] > MIN_CHANGE)
                    priors[:, place] = np.where(live[:, None], self.scale[:, None] / size, 0.0)
        return columns, priors

    @cached_property
    def _mean_size(self) -> Array:
        return np.asarray(np.sqrt((np.abs(self.weight * self.measured) ** 2).sum(axis=1) / self.count) + 1e-300)

    def _size(self, column: Complex) -> Array:
        """Return the root mean square of a column of each order, without its mean."""
        mean = (column * self.weight).sum(axis=1) / np.maximum(self.weight.sum(axis=1), 1e-300)
        square = (np.abs(self.weight * (column - mean[:, None])) ** 2).sum(axis=1) / self.count
        return np.asarray(np.sqrt(np.maximum(square, 1e-300)))

    # ---- Fit -------------------------------------------------------------------------------------------------------

    def _projected(self, modes: Sequence[Line], noise: Array) -> tuple[Complex, Array, Complex, Complex, Complex]:
        """Return columns, priors, coefficients, covariance for noise 1 and weighted residual, of least squares with priors."""
        columns, prior = self._columns(modes)
        used = (prior > 0.0).any(axis=0)
        scaled = columns[..., used] * prior[:, None, used]
        adjoint = scaled.conj().transpose(0, 2, 1)
        normal = adjoint @ scaled
        ridge = noise**2 + 1e-13 * np.trace(normal, axis1=1, axis2=2).real
        normal += ridge[:, None, None] * np.eye(normal.shape[1])
        target = self.weight * self.measured
        inverse = np.linalg.inv(normal)
        coefficients = (inverse @ (adjoint @ target[..., None]))[..., 0]
        left = target - (scaled @ coefficients[..., None])[..., 0]
        values = np.zeros(prior.shape, complex)
        values[:, used] = coefficients * prior[:, used]
        covariance = np.zeros((*prior.shape, prior.shape[1]), complex)
        covariance[np.ix_(np.arange(len(prior)), used, used)] = inverse * prior[:, used, None] * prior[:, None, used]
        return columns, prior, values, covariance, left

    def fit(self, lines: Sequence[Line], noise: Array, correlated: Array, free: Sequence[int] | None = None) -> Fitted:
        """Return the fit of lines from first values, for a noise of the amplitudes; only some lines are searched if `free`."""
        lines = self._searched(tuple(lines), noise, correlated, range(len(lines)) if free is None else free) if lines else ()
        _, prior, values, covariance, left = self._projected(lines, noise)
        spread: Array = np.zeros((0, 0))
        if lines and free is None:
            jacobian = self._jacobian(lines, noise, correlated)
            spread = np.asarray(np.linalg.pinv(jacobian.T @ jacobian), float)
        parts, sigma = self._parts(lines, values, covariance)
        sigma *= (noise * np.sqrt(correlated))[:, None, None]
        with np.errstate(divide="ignore", invalid="ignore"):
            amplitude = np.where(self.weight > 0.0, self.measured - left / self.weight, complex("nan"))
        freedom = np.maximum(self.count - (prior > 0.0).sum(axis=1), 1.0)
        own = np.sqrt((np.abs(left) ** 2).sum(axis=1) / freedom)
        length = np.array([_correlation(each[used > 0.0]) for each, used in zip(left, self.weight, strict=True)])
        evidence = self._evidence(lines, noise, correlated, spread)
        return Fitted(lines, evidence, self._of_frequency(lines, spread), parts, sigma, amplitude, own, length)

    def _parts(self, lines: Sequence[Line], values: Complex, covariance: Complex) -> tuple[Complex, Array]:
        """Return the coefficients at resonance, of receptance and mobility together, and their deviations for noise 1.

        In a narrow peak the mobility is j times the receptance, so that only both together are determined.
        """
        own = self.base.shape[2]
        parts = np.zeros((len(self.scale), len(lines), 2), complex)
        sigma = np.zeros(parts.shape)
        for k, line in enumerate(lines):
            for part, slope in enumerate((line.slope, -line.slope)):
                place = slice(own + 4 * k + 2 * part, own + 4 * k + 2 * part + 2)
                both = np.stack([np.ones(len(self.scale)), 1j * np.sign(self.spectrum.orders - slope)], axis=1)
                parts[:, k, part] = (both * values[:, place]).sum(axis=1)
                variance = np.einsum("qc,qcd,qd->q", both, covariance[:, place, place], both.conj()).real
                sigma[:, k, part] = np.sqrt(np.maximum(variance, 0.0))
        return parts, sigma

    def _evidence(self, lines: Sequence[Line], noise: Array, correlated: Array, spread: Array) -> float:
        """Return the logarithm of the evidence, its noise integrated over, with Laplace's method for the searched values."""
        columns, prior, values, _, left = self._projected(lines, noise)
        independent = self.count / correlated
        with np.errstate(divide="ignore", invalid="ignore"):
            costs = np.where(prior > 0.0, np.abs(values / prior) ** 2, 0.0)
        square = (np.abs(left) ** 2).sum(axis=1) + noise**2 * costs.sum(axis=1)
        floor = self.count * noise**2
        fitted = -independent * np.log(np.maximum(square, 1e-300) / np.maximum(floor, 1e-300))
        scaled = columns * prior[:, None, :]
        normal = scaled.conj().transpose(0, 2, 1) @ scaled / (noise**2 * correlated)[:, None, None]
        _, size = np.linalg.slogdet(np.eye(normal.shape[1]) + normal)
        occam = 0.0
        if len(spread):
            usual = [log(self.speeds[1] / self.speeds[0]), log(DAMPING_BOUNDS[1] / DAMPING_BOUNDS[0])]
            slopes = [WHOLE_SLOPE_SIGMA if line.whole else SLOPE_PRIOR for line in lines]
            ranges = [[*usual, *([] if self.stands else [slope * np.sqrt(tau)])] for slope in slopes]
            share = np.sqrt(tau * np.maximum(np.diag(spread), 1e-300)) / np.concatenate(ranges)
            occam = float(np.sum(np.log(np.minimum(share, 1.0))))
        return float(np.sum(fitted - size)) + occam

    @cached_property
    def speeds(self) -> tuple[float, float]:
        """Lowest and highest speed at which a peak is looked for [rad/s]."""
        return 0.9 * float(self.spectrum.speed.min()), 1.15 * float(self.spectrum.speed.max())

    def _searched(self, lines: tuple[Line, ...], noise: Array, correlated: Array, free: Sequence[int]) -> tuple[Line, ...]:
        from scipy.optimize import least_squares

        searched = [lines[k] for k in free]
        reference = [self._reference(line) for line in searched]
        low, high = np.log(self.speeds), np.log(DAMPING_BOUNDS)
        ends = [[low[0] - 0.2, high[0], -MAX_SLOPE], [low[1] + 0.2, high[1], MAX_SLOPE]]
        if self.stands:
            ends = [[*each[:2]] for each in ends]
        bounds = np.tile(ends, len(searched))
        start = np.clip(self._values(searched, reference), *bounds)

        def moved(values: Array) -> tuple[Line, ...]:
            own = dict(zip(free, self._lines(np.clip(values, *bounds), searched, reference), strict=True))
            return tuple(own.get(k, line) for k, line in enumerate(lines))

        def left(values: Array) -> Array:
            beyond = BOUND_COST * (values - np.clip(values, *bounds))
            return np.append(self._whitened(moved(values), noise, correlated), beyond)

        if not searched:
            return lines
        best = least_squares(left, start, method="lm", max_nfev=MAX_EVALUATIONS, xtol=1e-5, ftol=1e-5)
        return moved(best.x)

    def _reference(self, line: Line) -> tuple[float, float]:
        """Return order and sign of the slope of the peak that stands for the frequency of a mode: one that it has inside."""
        orders = self.spectrum.orders
        live = line.acts if line.acts.any() else np.ones((len(orders), 2), bool)
        gaps = np.maximum(np.abs(orders[:, None] - line.slope * np.array([1.0, -1.0])), MIN_PASSES)
        low, high = self.speeds
        lag = np.where(live, np.abs(np.log(line.frequency / gaps / (0.3 * low + 0.7 * high))), np.inf)
        order, part = np.unravel_index(int(np.argmin(lag)), lag.shape)
        return float(orders[order]), 1.0 - 2.0 * float(part)

    def _values(self, lines: Sequence[Line], reference: Sequence[tuple[float, float]]) -> Array:
        """Return what is searched of lines: the logarithm of the speed of a peak, of the damping, and the slope."""
        rows = []
        for line, (order, sign) in zip(lines, reference, strict=True):
            row = [log(line.frequency / max(abs(order - sign * line.slope), MIN_PASSES)), log(line.damping)]
            rows.append(row if self.stands else [*row, line.slope])
        return np.array(rows).ravel()

    def _lines(self, values: Array, lines: Sequence[Line], reference: Sequence[tuple[float, float]]) -> tuple[Line, ...]:
        made = []
        for line, (order, sign), row in zip(lines, reference, values.reshape(len(lines), -1).tolist(), strict=True):
            slope = 0.0 if self.stands else row[2]
            frequency = float(np.exp(row[0])) * max(abs(order - sign * slope), MIN_PASSES)
            made.append(line._replace(frequency=frequency, damping=float(np.exp(row[1])), slope=slope))
        return tuple(made)

    def _of_frequency(self, lines: Sequence[Line], spread: Array) -> Array:
        """Return the covariance of the logarithms of frequency and damping and of the slope, from that of what is searched."""
        if not len(spread):
            return spread
        width = 2 if self.stands else 3
        turned = np.zeros((3 * len(lines), width * len(lines)))
        for k, line in enumerate(lines):
            order, sign = self._reference(line)
            gap = order - sign * line.slope
            turned[3 * k : 3 * k + width, width * k : width * (k + 1)] = np.eye(width)
            if not self.stands and abs(gap) > MIN_PASSES:
                turned[3 * k, width * k + 2] = -sign / gap
        return np.asarray(turned @ spread @ turned.T)

    def _whitened(self, lines: Sequence[Line], noise: Array, correlated: Array) -> Array:
        """Return what the best coefficients leave, over the noise, with what priors cost; real, shape (n,)."""
        _, prior, values, _, left = self._projected(lines, noise)
        scale = np.sqrt(2.0) / (noise * np.sqrt(correlated))
        with np.errstate(divide="ignore", invalid="ignore"):
            costs = np.where(prior > 0.0, values / prior, 0.0) * noise[:, None]
        both = np.concatenate([left, costs], axis=1) * scale[:, None]
        return np.concatenate([both.real.ravel(), both.imag.ravel(), [_slope_cost(line) for line in lines]])

    def _jacobian(self, lines: Sequence[Line], noise: Array, correlated: Array) -> Array:
        reference = [self._reference(line) for line in lines]
        middle = self._values(lines, reference)
        steps = np.tile([1e-4, 1e-3, 1e-3][: len(middle) // len(lines)], len(lines))
        columns = []
        for place, step in enumerate(steps):
            ends = []
            for sign in (1.0, -1.0):
                moved = middle.copy()
                moved[place] += sign * step
                ends.append(self._whitened(self._lines(moved, lines, reference), noise, correlated))
            columns.append((ends[0] - ends[1]) / (2.0 * step))
        return np.stack(columns, axis=1)

    # ---- First values ----------------------------------------------------------------------------------------------

    def starts(self, beside: Sequence[Line], noise: Array, correlated: Array) -> list[tuple[float, Line]]:
        """Return first values of one more line beside others, with the evidence that each adds, the best first."""
        every = max(len(self.spectrum.speed) // MAX_SEARCH_SPEEDS, 1)
        columns, prior = self._columns(beside)
        speed, orders = self.spectrum.speed[::every], self.spectrum.orders
        bases, targets = [], []
        for q in range(len(orders)):
            basis = np.linalg.qr((columns[q] * prior[q])[::every][:, prior[q] > 0.0])[0]
            own = (self.weight * self.measured)[q, ::every]
            bases.append(basis)
            targets.append(own - basis @ (basis.conj().T @ own))
        low, high = self.speeds
        slopes = (0,) if self.stands else SEARCH_SLOPES
        gaps = [abs(order - slope) for order in orders.tolist() for slope in slopes]
        least, most = log(max(min(gap for gap in gaps if gap > 0.0), MIN_PASSES) * low), log(max(gaps) * high)
        found = []
        for damping in SEARCH_DAMPINGS:
            step = SEARCH_STEP_SHARE * damping
            frequency = np.exp(np.arange(least, most, step))
            receptances: dict[float, tuple[slice, Complex]] = {}
            by_slope: dict[int, Array] = {}
            for slope in slopes:
                gains = np.zeros((len(orders), len(frequency)))
                for q, order in enumerate(orders.tolist()):
                    gap = abs(order - slope)
                    if gap < MIN_PASSES:
                        continue
                    if gap not in receptances:
                        first, last = (max(int((log(gap * end) - least) / step), 0) for end in (low, high))
                        met = slice(first, last + 1)
                        receptances[gap] = met, _receptance(gap * speed[None, :], frequency[met, None], damping)
                    met, part = receptances[gap]
                    part = part if order > slope else part.conj()
                    weight, independent = self.weight[q, ::every], self.count[q] / correlated[q]
                    gains[q, met] = _gain(part * weight, bases[q], targets[q], float(noise[q]), independent)
                by_slope[slope] = np.where(gains > MIN_ORDER_EVIDENCE, gains, 0.0)
            for slope, gains in by_slope.items():
                opposite = by_slope[-slope] if slope else np.zeros(gains.shape)
                for second in (np.zeros(gains.shape), opposite) if slope > 0 else (np.zeros(gains.shape),):
                    total = gains.sum(axis=0) + second.sum(axis=0)
                    peaks = np.flatnonzero((total[1:-1] >= total[:-2]) & (total[1:-1] > total[2:])) + 1
                    for k in peaks[total[peaks] > 0.0].tolist():
                        acts = (*(gains[:, k] > 0.0).tolist(), *(second[:, k] > 0.0).tolist())
                        found.append((float(total[k]), Line(float(frequency[k]), damping, float(slope), acts, whole=True)))
        found.sort(key=lambda each: (-each[0], abs(each[1].slope)))
        kept: list[tuple[float, Line]] = []
        for gain, line in found[:MAX_PROPOSED]:
            steep = abs(line.slope)
            if not any(abs(m.slope) == steep and abs(log(m.frequency / line.frequency)) < SAME_START for _, m in kept):
                kept.append((gain, line))
        return kept


def _gain(part: Complex, basis: Complex, target: Complex, noise: float, independent: float) -> Array:
    """Return what a column, of many frequencies, adds to the evidence of an order."""
    left = part - (part @ basis.conj()) @ basis.T
    whole = float(np.sum(np.abs(target) ** 2)) + 1e-300
    size = np.maximum(np.sum(np.abs(part) ** 2, axis=1), 1e-300)
    own = np.sum(np.abs(left) ** 2, axis=1) + 1e-6 * size
    share = np.clip(np.abs(left.conj() @ target) ** 2 / own / whole, 0.0, 1.0 - 1e-12)
    floor = min(0.5 * len(target) * noise**2 / whole, 1.0)
    gain = -independent * np.log(np.maximum(1.0 - share, floor))
    return np.asarray(gain - np.log(np.maximum(gain, 1.0) * 2.0))


def _correlation(left: Complex) -> float:
    """Return over how many stretches a residual is correlated."""
    if len(left) < 8:
        return 1.0
    return max(correlation_length(left.real), correlation_length(left.imag), 1.0)


def _receptance(frequency: Array, natural: float | Array, damping: float) -> Complex:
    """Return the receptance over the static one at frequencies [rad/s] with their sign."""
    ratio = frequency / natural
    return np.asarray(1.0 / (1.0 - ratio**2 + 2j * damping * ratio))


def _later(times: _Times, orders: Array, force: Complex, speed: Array, natural: float, damping: float) -> Complex:
    """Return mean answers in stretches to forces of orders, in the frame of their phase, integrated in time.

    H has two poles. That on the side of the frequency of the force is integrated exactly over steps in which the frequency is
    constant; the other one is far from it and answers at once.
    """
    from scipy.signal import lfilter

    pole = natural * (-damping + 1j * np.sqrt(1.0 - damping**2))
    residue = natural**2 / (2j * natural * np.sqrt(1.0 - damping**2))
    rate = 1j * np.diff(times.angle, append=2.0 * times.angle[-1] - times.angle[-2]) / times.step
    begins = np.flatnonzero(times.since == 0.0)
    rate[begins[1:] - 1] = rate[begins[1:] - 2]
    framed = np.empty(force.shape, complex)
    at_once = np.empty((len(orders), len(speed)), complex)
    signs = orders >= 0.0
    for own, own_residue, rows in ((pole, residue, signs), (pole.conjugate(), residue.conjugate(), ~signs)):
        if rows.any():
            decay = np.exp(own * times.step)
            steady = own_residue / (orders[rows, None] * rate - own)
            driven = np.zeros(steady.shape, complex)
            driven[:, 1:] = steady[:, :-1] * (force[rows, 1:] - decay * force[rows, :-1])
            driven[:, begins] = 0.0
            answer = lfilter([1.0], [1.0, -decay], driven, axis=1)
            # each recording begins as if its speed had been constant before, not with what the recording before it left
            before = np.concatenate([np.zeros((len(answer), 1)), answer[:, begins[1:] - 1]], axis=1)
            first = steady[:, begins] * force[np.ix_(rows, begins)] - decay * before
            lengths = np.diff(np.append(begins, len(times.since)))
            answer += np.repeat(first, lengths, axis=1) * np.exp(own * times.step * times.since)
            framed[rows] = answer * force[rows].conj()
            at_once[rows] = own_residue.conjugate() / (1j * np.outer(orders[rows], speed) - own.conjugate())
    sums = np.zeros(framed.shape, complex)
    np.cumsum(0.5 * (framed[:, 1:] + framed[:, :-1]), axis=1, out=sums[:, 1:])
    ends = []
    for at in (times.first, times.last):
        below = np.minimum(at.astype(int), len(times.angle) - 2)
        share = at - below
        change = framed[:, below + 1] - framed[:, below]
        ends.append(sums[:, below] + share * (framed[:, below] + 0.5 * share * change))
    return np.asarray((ends[1] - ends[0]) / (times.last - times.first) + at_once)


def _extended(at: Array, time: Array, angle: Array) -> Array:
    """Return the angle at times, past its end with its last speed."""
    speed = (angle[-1] - angle[-2]) / (time[-1] - time[-2])
    return np.asarray(np.interp(at, time, angle) + speed * np.maximum(at - time[-1], 0.0))


# ---- Number of modes and waves ---------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Selected:
    """Lines that amplitudes have.

    Attributes:
        best: the fit
        others: for each line others with another slope, and by how much the logarithm of the evidence is less with each
    """

    best: Fitted
    others: tuple[tuple[tuple[float, Line], ...], ...]


def selected(problem: ModeProblem) -> Selected:
    """Return the modes whose evidence is sufficient: added one after the other, then each exchanged for a better one."""
    best = problem.fit((), problem.scale, np.ones(len(problem.scale)))
    others: tuple[tuple[tuple[float, Line], ...], ...] = ()
    for _ in range(MAX_ROUNDS):
        best = _added(problem, best)
        exchanged = False
        rivals = []
        for place in range(len(best.lines)):
            others_of = _others(problem, best, place)
            lag, line = min(others_of, default=(0.0, None), key=lambda each: each[0])
            if line is not None and lag < -MIN_LEAD_OF_RIVAL:
                lines = (*best.lines[:place], line, *best.lines[place + 1 :])
                best = _pruned(problem, problem.fit(lines, _noise(best, problem), best.correlated))
                exchanged = True
                break
            rivals.append(others_of)
        others = tuple(rivals)
        if not exchanged:
            break
    if len(others) < len(best.lines):
        others = tuple(_others(problem, best, place) for place in range(len(best.lines)))
    freed = _freed(problem, best)
    if len(freed.lines) > len(others):
        others = tuple(_others(problem, freed, place) for place in range(len(freed.lines)))
    return Selected(freed, others)


def _added(problem: ModeProblem, best: Fitted) -> Fitted:
    """Return a fit with further modes, as long as each makes the amplitudes sufficiently more probable."""
    white = np.ones(len(problem.scale))
    while len(best.lines) < MAX_MODES:
        noise = _noise(best, problem)
        proposed = problem.starts(best.lines, noise, white)
        own, tried = [len(best.lines)], []
        for gain, line in proposed[:MAX_STARTS]:
            if gain < proposed[0][0] - MAX_EVIDENCE_LAG:
                break
            trial = problem.fit((*best.lines, line), noise, white, own)
            trial = problem.fit(trial.lines, _noise(trial, problem), trial.correlated, own)
            if not _corrects(problem, trial.lines[-1], best.lines):
                tried.append(trial)
        if not tried:
            break
        least = min(tried, key=lambda each: float(np.sum(np.log(each.noise) * problem.count)))
        noise = _noise(least, problem)
        same = [problem.fit(each.lines, noise, least.correlated, own) for each in tried]
        winner = _pruned(problem, max(same, key=lambda each: each.evidence))
        winner = _settled(problem, winner)
        if len(winner.lines) <= len(best.lines) or any(_corrects(problem, *each) for each in _each_beside(winner.lines)):
            break
        noise = _noise(winner, problem)
        before = problem.fit(best.lines, noise, winner.correlated)
        winner = problem.fit(winner.lines, noise, winner.correlated)
        if winner.evidence - before.evidence < MIN_EVIDENCE_OF_MODE:
            break
        best = winner
    return best


def _settled(problem: ModeProblem, fit: Fitted) -> Fitted:
    """Return a fit repeated with the noise that it leaves, until that no longer decreases."""
    for _ in range(MAX_REPEATS):
        again = problem.fit(fit.lines, _noise(fit, problem), fit.correlated)
        before, after = (float(np.sum(np.log(_noise(each, problem)))) for each in (fit, again))
        fit = again
        if after > before - MIN_DECREASE:
            break
    return fit


def _each_beside(lines: Sequence[Line]) -> Iterator[tuple[Line, Sequence[Line]]]:
    """Yield each mode with those that act on more orders."""
    for line in lines:
        yield line, [other for other in lines if sum(other.acts_on) > sum(line.acts_on)]


def _corrects(problem: ModeProblem, line: Line, others: Sequence[Line]) -> bool:
    """Return True if all peaks of a line lie in peaks of others, whose shape it only corrects."""
    orders = problem.spectrum.orders

    def peaks(of: Line) -> list[tuple[int, float]]:
        gaps = np.abs(orders[:, None] - np.array([of.slope, -of.slope]))
        return [(q, of.frequency / gaps[q, part]) for q, part in np.argwhere(of.acts & (gaps > MIN_PASSES)).tolist()]

    near = [(q, peak, PEAK_WIDTHS * max(other.damping, line.damping)) for other in others for q, peak in peaks(other)]
    low, high = problem.speeds
    inside = [(q, peak) for q, peak in peaks(line) if low < peak < high]
    return bool(inside) and all(
        any(order == q and abs(peak / at - 1.0) < reach for order, at, reach in near) for q, peak in inside
    )


def _slope_cost(line: Line) -> float:
    """Return by how many standard deviations a slope lies off what is expected."""
    return (line.slope - round(line.slope)) / WHOLE_SLOPE_SIGMA if line.whole else line.slope / SLOPE_PRIOR


def _freed(problem: ModeProblem, best: Fitted) -> Fitted:
    """Return the fit in which slopes that are not whole, and pairs of lines that do not begin at one frequency, are free."""
    for place, line in enumerate(best.lines):
        if problem.stands:
            continue
        before, after = best.lines[:place], best.lines[place + 1 :]
        rivals = [(*before, line._replace(whole=False), *after)]
        first, second = line.acts.T
        if first.any() and second.any():
            none = (False,) * len(first)
            pair = (
                line._replace(acts_on=(*first.tolist(), *none)),
                line._replace(slope=-line.slope, acts_on=(*second.tolist(), *none)),
            )
            rivals.append((*before, pair[0], *after, pair[1]))
        for lines in rivals:
            noise = _noise(best, problem)
            own, other = (problem.fit(each, noise, best.correlated) for each in (best.lines, lines))
            if other.evidence > own.evidence + log(WHOLE_SLOPE_ODDS):
                best = other
                break
    return best


def _noise(fit: Fitted, problem: ModeProblem) -> Array:
    return np.maximum(fit.noise, MIN_NOISE_SHARE * problem.scale)


def _acting(fit: Fitted) -> tuple[Line, ...]:
    """Return the modes, each with the orders whose coefficients are significant, the line with more of them first."""
    acting = []
    for k, line in enumerate(fit.lines):
        acts = (np.abs(fit.parts[:, k]) > MIN_SIGNIFICANCE * fit.parts_sigma[:, k]) & line.acts
        if acts[:, 1].sum() > acts[:, 0].sum():
            acts, line = acts[:, ::-1], line._replace(slope=-line.slope)
        acting.append(line._replace(acts_on=tuple(acts.T.ravel().tolist())))
    return tuple(acting)


def _pruned(problem: ModeProblem, fit: Fitted) -> Fitted:
    """Return the fit in which each mode acts on the orders whose coefficients are significant, of all of them.

    Two lines that begin near one frequency, with opposite slopes, are tried as one mode and as two.
    """
    single = list[Line]()
    for line in fit.lines:
        if not any(_same_mode(line, other) for other in single):
            single.append(line)
    pruned = [_acting_anywhere(problem, fit, lines) for lines in {tuple(single): None, fit.lines: None}]
    last = pruned[-1]
    return max(pruned, key=lambda each: problem.fit(each.lines, _noise(last, problem), last.correlated, ()).evidence)


def _acting_anywhere(problem: ModeProblem, fit: Fitted, lines: Sequence[Line]) -> Fitted:
    count, everywhere = len(problem.scale), []
    for line in lines:
        alone = not any(_same_mode(line, other) for other in lines if other is not line)
        both = not problem.stands and (alone and abs(line.slope) > MIN_SLOPE_OF_BOTH)
        everywhere.append(line._replace(acts_on=(True,) * count + (both,) * count))
    trial = problem.fit(everywhere, _noise(fit, problem), np.ones(count), ())
    trial = problem.fit(everywhere, _noise(trial, problem), trial.correlated, ())
    acting = tuple(line for line in _acting(trial) if any(line.acts_on))
    return problem.fit(acting, _noise(trial, problem), trial.correlated)


def _same_mode(one: Line, other: Line) -> bool:
    """Return True if two lines begin at one frequency and have the same or opposite slopes."""
    tilt = abs(abs(one.slope) - abs(other.slope))
    return abs(log(one.frequency / other.frequency)) < SAME_START and tilt < MIN_SLOPE_OF_BOTH


def _others(problem: ModeProblem, best: Fitted, place: int) -> tuple[tuple[float, Line], ...]:
    """Return what a line may be with another slope, and by how much the logarithm of the evidence is less."""
    noise, own = _noise(best, problem), best.lines[place]
    beside = [line for k, line in enumerate(best.lines) if k != place]
    proposed = problem.starts(beside, noise, np.ones(len(noise)))
    lead = max((gain for gain, _ in proposed), default=0.0)
    fits = list[Fitted]()
    for gain, line in proposed[: 3 * MAX_STARTS]:
        if gain < lead - MAX_EVIDENCE_LAG or len(fits) >= MAX_STARTS:
            break
        slopes = [own.slope, *(fit.lines[place].slope for fit in fits)]
        if min(abs(abs(line.slope) - abs(slope)) for slope in slopes) > MIN_SLOPE_GAP:
            lines = [*best.lines[:place], line, *best.lines[place + 1 :]]
            fits.append(problem.fit(lines, noise, best.correlated, [place]))
    least = problem.fit(best.lines, noise, best.correlated, ()).evidence
    rivals = [(least - fit.evidence, fit.lines[place]) for fit in fits]
    return tuple(rival for rival in rivals if abs(abs(rival[1].slope) - abs(own.slope)) > MIN_SLOPE_GAP)
