"""Steps of a fit down to its least cost."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from strainwave.identification.fitting.loss_functions import Squared
from strainwave.identification.fitting.unknowns import Unknown
from strainwave.statistics.linear_fit import solved

if TYPE_CHECKING:
    from strainwave.identification.fitting.problem import Problem, Weights

Array = NDArray[np.float64]

MIN_RELATIVE_GAIN = 1e-3  # of the tolerance, by which a step must make the cost smaller; one with less is the last
MIN_SHIFT_SIGMA = 0.01  # standard deviations that the cost must gain in a step; one with less is the last
AMPLITUDE_NAMES = ("amplitude", "torque")  # in a name in place of "phase"


class _SettledError(Exception):
    """A fit has come to its end, at these unknowns."""

    def __init__(self, part: Array) -> None:
        super().__init__("the fit has come to its end")
        self.part = part


class Descent:
    """Steps of a fit from `whole`, which move the unknowns in the places `free`.

    A step from far off is too long, and may take an unknown to where it has no influence and no step moves it again. Such
    steps are shortened at first, and allowed in the end: the least cost may be there. Waves are moved by their real and
    imaginary parts.
    """

    def __init__(
        self,
        problem: Problem,
        whole: Array,
        free: NDArray[np.intp],
        weights: Sequence[Weights],
        tolerance: float,
        trials: int,
    ) -> None:
        self.problem, self.free, self.weights, self.tolerance, self.trials = problem, free, weights, tolerance, trials
        self.priors, self.prior_values = problem.prior_rows()
        pairs = zip(weights, problem.records, strict=True)
        self.lengths = np.concatenate([np.repeat(of.correlation_length, record.training.sum()) for of, record in pairs])
        self.waves = Waves.of(problem.plan.unknowns, whole, free)
        self.start = self.waves.parts(whole)
        self.lowest, self.highest = self.waves.limits(problem.limits())[free].T
        self.is_squared = isinstance(problem.loss, Squared)
        self.influential = np.zeros(len(free), bool)  # where the last step ended
        self.keeps_influence, self.shortened = True, False
        self._last: tuple[bytes, Array] | None = None

    def ended(self) -> Array:
        """Return the unknowns after the steps, shape (unknowns,)."""
        with np.errstate(over="ignore"):  # SciPy takes a smaller step where its model of the residuals is infinite
            part = self._stepped(self.start[self.free])
            if self.shortened:
                self.keeps_influence = False
                part = self._stepped(part)
        return self._unknowns(part)

    def _unknowns(self, part: Array) -> Array:
        parts = self.start.copy()
        parts[self.free] = part
        return self.waves.unknowns(parts)

    def _linearised(self, part: Array) -> Array:
        """Return derivatives and residuals as columns; the last are kept, as solvers ask for one after the other."""
        key = part.tobytes()
        if self._last is None or self._last[0] != key:
            x = self._unknowns(part)
            of_data = [-of.rows * left for of, left in zip(self.weights, self.problem.residuals(x), strict=True)]
            left = np.concatenate([*map(np.ravel, of_data), self.priors @ x - self.prior_values])
            rows = np.concatenate((self.problem.jacobian(x, self.weights), self.priors))
            self._last = key, np.column_stack((self.waves.slopes(rows, x)[:, self.free], left))
        return self._last[1]

    def _residuals(self, part: Array) -> Array:
        """Return the weighted residuals; infinite ones out of the domain, so that SciPy takes a quarter of such a step."""
        out_of_domain = np.full(len(self.lengths) + len(self.prior_values), np.inf)
        try:
            columns = self._linearised(part)
        except (ValueError, FloatingPointError):  # out of the domain, or diverged
            return out_of_domain
        if self.keeps_influence and np.any(self.influential & ~np.any(columns[:, :-1], axis=0)):
            self.shortened = True
            return out_of_domain
        return columns[:, -1]

    def _jacobian(self, part: Array) -> Array:
        """Return the derivatives where a step ended; SciPy would go on until rounding, or a kink, made its steps fail."""
        columns = self._linearised(part)
        rows, left = columns[:, :-1], columns[:, -1]
        self.influential = np.any(rows, axis=0)
        if self.is_squared:
            step = solved(rows, -left)  # of Gauss and Newton
            gain = float(np.sum((rows @ step) ** 2))  # decrease of the sum of squares if residuals were linear
            if gain <= MIN_RELATIVE_GAIN * self.tolerance * float(left @ left):
                raise _SettledError(np.clip(part + step, self.lowest, self.highest))
        return rows

    def _cost(self, squares: Array) -> Array:
        """Return the cost of samples in units of their noise, times their independent share, and of priors the square."""
        lengths = self.lengths
        of_data, of_prior = squares[: len(lengths)], squares[len(lengths) :]
        value, first, second = self.problem.loss.cost(of_data * lengths)
        return np.concatenate((np.stack((value / lengths, first, second * lengths)), Squared().cost(of_prior)), axis=1)

    def _stepped(self, part: Array) -> Array:
        from scipy.optimize import least_squares

        try:
            solution = least_squares(
                self._residuals,
                part,
                jac=self._jacobian,
                bounds=(self.lowest, self.highest),
                x_scale="jac",
                loss="linear" if self.is_squared else self._cost,  # type: ignore[arg-type]  # stubs ask for more
                xtol=self.tolerance,
                ftol=max(self.tolerance, MIN_SHIFT_SIGMA**2 / len(self.lengths)),
                gtol=self.tolerance,
                max_nfev=self.trials,
            )
        except _SettledError as settled:
            return settled.part
        return np.asarray(solution.x)


# ---- Waves, as a solver moves them -----------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Waves:
    """The waves among the unknowns of a fit.

    Attributes:
        amplitude, phase: places of the unknowns of each wave, shape (waves,)
        turned: phase at the start of the fit, from which the imaginary part counts [rad], shape (waves,)
    """

    amplitude: NDArray[np.intp]
    phase: NDArray[np.intp]
    turned: Array

    @classmethod
    def of(cls, unknowns: Sequence[Unknown], start: Array, free: NDArray[np.intp]) -> Waves:
        """Return the waves whose amplitude and phase are both free and not limited but for the sign of the amplitude."""
        places = {unknowns[place].path: place for place in free.tolist() if place < len(unknowns)}
        pairs = [
            (places[path], phase)
            for name, phase in places.items() if "phase" in name
            for path in (name.replace("phase", amplitude) for amplitude in AMPLITUDE_NAMES) if path in places
        ]  # fmt: skip
        pairs = [
            (own, phase) for own, phase in pairs
            if start[own] > 0.0 and np.isinf([unknowns[phase].low, unknowns[phase].high, unknowns[own].high]).all()
        ]  # fmt: skip
        amplitude, phase = np.array(pairs, np.intp).reshape(-1, 2).T
        return cls(amplitude, phase, start[phase])

    def parts(self, x: Array) -> Array:
        """Return unknowns with real and imaginary part in the places of amplitude and phase."""
        parts, wave = x.copy(), x[self.amplitude] * np.exp(1j * (x[self.phase] - self.turned))
        parts[self.amplitude], parts[self.phase] = wave.real, wave.imag
        return parts

    def unknowns(self, parts: Array) -> Array:
        """Return the unknowns of parts; a phase is within half a turn of that at the start."""
        unknowns, wave = parts.copy(), parts[self.amplitude] + 1j * parts[self.phase]
        unknowns[self.amplitude], unknowns[self.phase] = np.abs(wave), self.turned + np.angle(wave)
        return unknowns

    def slopes(self, rows: Array, x: Array) -> Array:
        """Return derivatives by the parts, of those by the unknowns at x, shape (samples, unknowns)."""
        slopes, angle = rows.copy(), x[self.phase] - self.turned
        along, across = rows[:, self.amplitude], rows[:, self.phase] / np.maximum(x[self.amplitude], 1e-300)
        slopes[:, self.amplitude] = along * np.cos(angle) - across * np.sin(angle)
        slopes[:, self.phase] = along * np.sin(angle) + across * np.cos(angle)
        return slopes

    def limits(self, ends: Array) -> Array:
        """Return lowest and highest values of the parts, of those of the unknowns, shape (unknowns, 2)."""
        limits = ends.copy()
        limits[self.amplitude], limits[self.phase] = (-np.inf, np.inf), (-np.inf, np.inf)
        return limits
