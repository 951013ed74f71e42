"""Least squares on free parameters of a model and unknowns of measurements, in numbers scaled to their size."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive, Gear, _core
from strainwave.identification.experiments.experiment import Experiment
from strainwave.identification.fitting.covariance import posterior_of
from strainwave.identification.fitting.estimate import Estimate
from strainwave.identification.fitting.loss import Loss, Squared, bend, slope
from strainwave.identification.fitting.noise import correlation_length
from strainwave.identification.fitting.unknowns import AT, Move, Plan

Array = NDArray[np.float64]
NOISE = 0.01  # of the size of a channel, before a first pass has told it (assumed)
SMALLEST = 1e-12  # of the size of a channel: less noise has no measurement
LAST = 1e-3  # of the tolerance: a step that promises less is the last
WEAK = 1e-8  # singular values below this share of the largest: derivatives by differences are no better
TRIALS = 60  # steps that a fit may try; those that explain their data end after ten to forty


@dataclass(frozen=True)
class Weights:
    """How much the channels of a record weigh.

    Attributes:
        own: reciprocal standard deviation of the noise of each channel, shape (channels, 1)
        together: how many samples of it hang together, shape (channels, 1)
    """

    own: Array
    together: Array

    @property
    def rows(self) -> Array:
        """What residuals are multiplied by in a sum of squares, shape (channels, 1)."""
        return self.own / np.sqrt(self.together)


def scale(measured: Array) -> Array:
    """How large each channel is, shape (channels, 1)."""
    spread = np.std(measured, axis=1, keepdims=True)
    size = np.max(np.abs(measured), axis=1, keepdims=True)
    return np.where(spread > 0.0, spread, np.where(size > 0.0, size, 1.0))


class Record:
    """One measurement in a fit: what the unknowns predict for it.

    Args:
        experiment: what was measured
        training: which samples take part, shape (n,); all if None
        model: the model before the fit
        moves: which numbers of it move with which unknown
        of_gear: whether the experiment is one of the gear in the drive alone
        first: place of its first nuisance among the unknowns

    Attributes:
        measured: what the fit compares with, shape (channels, n); that of the experiment
    """

    def __init__(
        self,
        experiment: Experiment,
        training: NDArray[np.bool_] | None,
        model: Gear | Drive,
        moves: Sequence[Move],
        of_gear: bool,
        first: int,
    ) -> None:
        self.experiment, self.moves, self.of_gear = experiment, moves, of_gear
        self.measured = experiment.measured
        n = self.measured.shape[1]
        self.training = np.ones(n, bool) if training is None else np.asarray(training)
        if self.training.dtype != bool:
            raise TypeError(f"training must hold True or False for each sample, not {self.training.dtype}")
        if self.training.shape != (n,):
            raise ValueError(f"training has shape {self.training.shape}, the measurement has {n} samples")
        self.nuisances = slice(first, first + len(experiment.nuisances))
        self._before = model
        numbers = {path: place for place, (path, *_) in enumerate(_core.parameters(self.seen(model)))}
        paths = [move.path.removeprefix("gear.") if of_gear else move.path for move in moves]
        self._seen_moves = [(numbers[path], move) for path, move in zip(paths, moves, strict=True) if path in numbers]

    @property
    def samples(self) -> int:
        """How many numbers of it take part."""
        return int(self.training.sum()) * len(self.experiment.channels)

    def seen(self, model: Any) -> Any:
        """What of the model the experiment is of."""
        return model.gear if self.of_gear else model

    def model(self, x: Array) -> Any:
        """The model with what the unknowns say of this record."""
        numbers = [value for _, value, *_ in _core.parameters(self._before)]
        for move in self.moves:
            numbers[move.number] = move.factor * float(x[move.unknown])
        return _core.with_numbers(self._before, numbers)

    def predict(self, x: Array) -> tuple[Array, Array]:
        """What is predicted, shape (channels, n), and its derivatives by all unknowns, shape (unknowns, channels, n)."""
        model = self.seen(self.model(x))
        predicted, by_numbers = self.experiment.predict(model, [number for number, _ in self._seen_moves], x[self.nuisances])
        slopes = np.zeros((len(x), *predicted.shape))
        for (_, move), by_number in zip(self._seen_moves, by_numbers, strict=False):
            slopes[move.unknown] += move.factor * by_number
        slopes[self.nuisances] = by_numbers[len(self._seen_moves) :]
        if not (np.isfinite(predicted).all() and np.isfinite(slopes).all()):
            raise FloatingPointError(
                "what the model predicts, or its derivatives, grow beyond all numbers: look whether units and sides of the "
                "measurement are right, and the numbers of the gear to start from"
            )
        return predicted, slopes


class _SettledError(Exception):
    """A fit has come to its end, at these unknowns."""

    def __init__(self, part: Array) -> None:
        super().__init__("the fit has come to its end")
        self.part = part


def _step(rows: Array, left: Array) -> tuple[Array, float]:
    """The step of Gauss and Newton, and by how much it would make the sum of squares smaller, were residuals linear."""
    size = np.linalg.norm(rows, axis=0)
    size = np.where(size > 0.0, size, 1.0)
    step = np.linalg.lstsq(rows / size, -left, rcond=WEAK)[0]
    return step / size, float(np.sum((rows / size @ step) ** 2))


class Problem:
    """The unknowns, what is predicted from them, and the weighted difference to what was measured."""

    def __init__(self, plan: Plan, records: Sequence[Record], names: Sequence[str]) -> None:
        self.plan, self.records, self.names = plan, records, names
        known = len(plan.unknowns)
        self.size = known + sum(len(record.experiment.nuisances) for record in records)
        if self.size == 0:
            raise ValueError("free must name at least one parameter: nothing else of this measurement is unknown")
        samples = sum(record.samples for record in records)
        if samples + len(plan.priors) <= self.size:
            count = sum(int(record.training.sum()) for record in records)
            raise ValueError(
                f"{f'{count} samples are' if count else 'no sample is'} left to fit, too few for {self.size} unknowns: record "
                "longer, or more rows"
            )
        for name, record in zip(names, records, strict=True):
            if record.samples == 0:
                raise ValueError(f"training leaves no sample of {name}; leave the record out")
        self.evaluations = 0
        self._drawn = np.zeros(len(plan.priors))
        self._last: tuple[bytes, list[tuple[Array, Array]]] | None = None

    def start(self) -> Array:
        """Where the fit starts, within the limits of its parameters."""
        nuisances = [each.start for record in self.records for each in record.experiment.nuisances]
        return np.array([each.start for each in self.plan.unknowns] + nuisances)

    def limits(self) -> Array:
        """What each unknown may be, shape (unknowns, 2)."""
        endless = [(-np.inf, np.inf)] * (self.size - len(self.plan.unknowns))
        return np.array([(each.low, each.high) for each in self.plan.unknowns] + endless).reshape(-1, 2)

    def predict(self, x: Array) -> list[tuple[Array, Array]]:
        """Predictions and derivatives of each record; the last are remembered, as solvers ask for one after the other."""
        key = x.tobytes()
        if self._last is None or self._last[0] != key:
            self.evaluations += 1
            self._last = key, [record.predict(x) for record in self.records]
        return self._last[1]

    def residuals(self, x: Array) -> list[Array]:
        """Measured less predicted of the samples that take part, of each record, shape (channels, samples)."""
        return [
            (record.measured - predicted)[:, record.training]
            for record, (predicted, _) in zip(self.records, self.predict(x), strict=True)
        ]

    def jacobian(self, x: Array, weights: Sequence[Weights]) -> Array:
        """Derivatives of what is predicted, times the weights, shape (numbers that take part, unknowns)."""
        return np.concatenate(
            [
                (slopes * each.rows)[:, :, record.training].reshape(self.size, -1).T
                for record, each, (_, slopes) in zip(self.records, weights, self.predict(x), strict=True)
            ]
        )

    def prior_rows(self) -> tuple[Array, Array]:
        """What is known before as linear equations of unit uncertainty: matrix, shape (priors, unknowns), and right side."""
        matrix, right = np.zeros((len(self.plan.priors), self.size)), np.zeros(len(self.plan.priors))
        for row, prior in enumerate(self.plan.priors):
            matrix[row, prior.unknown] = prior.factor / prior.sigma
            right[row] = prior.value / prior.sigma + self._drawn[row]
        return matrix, right

    def draw_priors(self, random: np.random.Generator) -> None:
        """Moves what is known before by as much as it is uncertain, at random."""
        self._drawn = random.normal(size=len(self.plan.priors))

    def first_weights(self) -> list[Weights]:
        """Weights before residuals tell them: noise is a share of what was measured, and all records count as the shortest.

        Were each sample of a long record counted, the first pass would follow its drift, and it would not show that it drifts.
        """
        lengths = [int(record.training.sum()) for record in self.records]
        return [
            Weights(1.0 / (NOISE * size), np.full_like(size, n / min(lengths)))
            for n, record in zip(lengths, self.records, strict=True)
            for size in [scale(record.measured[:, record.training])]
        ]

    def weights(self, x: Array, before: Sequence[Weights], loss: Loss) -> list[Weights]:
        """Weights of the channels of each record, by the residuals that a fit left.

        Each sample counts by its standard deviation, and all together as though only as many were there as are independent. The
        residuals are smaller than the noise by what the fit took of it, the leverage. Channels of a record are taken to hang
        together alike: one that is fitted worse than the others hangs together longer, and would lose weight in every pass.
        """
        columns = np.concatenate((self.jacobian(x, before), self.prior_rows()[0]))
        size = np.linalg.norm(columns, axis=0)
        leverage = np.sum(np.linalg.qr(columns / np.where(size > 0.0, size, 1.0))[0] ** 2, axis=1)
        found, first = [], 0
        for record, residual in zip(self.records, self.residuals(x), strict=True):
            channels, n = residual.shape
            taken = leverage[first : first + channels * n].reshape(channels, n).sum(axis=1, keepdims=True)
            first += channels * n
            sigma = loss.sigma(residual) * np.sqrt(n / np.maximum(n - taken, 1.0))
            sigma = np.maximum(sigma, SMALLEST * scale(record.measured))
            together = float(np.exp(np.mean([np.log(correlation_length(slope(loss, row))) for row in residual / sigma])))
            found.append(Weights(1.0 / sigma, np.full((channels, 1), together)))
        return found

    def solve(
        self,
        start: Array,
        weights: Sequence[Weights],
        loss: Loss,
        tolerance: float,
        held: Sequence[int] = (),
        trials: int = TRIALS,
    ) -> Array:
        """The unknowns of least cost, or those of the last step that may be tried; those held stay where they start."""
        from scipy.optimize import least_squares

        low, high = self.limits().T
        whole = np.clip(start, low, high)
        whole[list(held)] = start[list(held)]
        free = np.setdiff1d(np.arange(self.size), held)
        if len(free) == 0:
            return whole
        of_priors, right = self.prior_rows()
        together = self._together(weights)

        def with_free(part: Array) -> Array:
            x = whole.copy()
            x[free] = part
            return x

        def residuals(part: Array) -> Array:
            x = with_free(part)
            try:
                of_data = [-each.rows * residual for each, residual in zip(weights, self.residuals(x), strict=True)]
            except (ValueError, FloatingPointError):  # out of the domain, or diverged: SciPy takes a quarter of such a step
                of_data = [np.full(record.samples, np.inf) for record in self.records]
            return np.concatenate([*map(np.ravel, of_data), of_priors @ x - right])

        def jacobian(part: Array) -> Array:
            """Called where a step was taken; SciPy would go on until rounding, or a kink, made its steps fail."""
            rows = np.concatenate((self.jacobian(with_free(part), weights), of_priors))[:, free]
            if isinstance(loss, Squared):
                left = residuals(part)
                step, gain = _step(rows, left)
                if gain <= LAST * tolerance * float(left @ left):
                    raise _SettledError(np.clip(part + step, low[free], high[free]))
            return rows

        def cost(squares: Array) -> Array:
            """Of samples in units of their own noise, times the share of them that is independent; of priors the square."""
            of_data, of_prior = squares[: len(together)], squares[len(together) :]
            value, first, second = loss.cost(of_data * together)
            return np.concatenate((np.stack((value / together, first, second * together)), Squared().cost(of_prior)), axis=1)

        with np.errstate(over="ignore"):  # SciPy takes a smaller step where its model of the residuals is infinite
            try:
                solution = least_squares(
                    residuals,
                    whole[free],
                    jac=jacobian,
                    bounds=(low[free], high[free]),
                    x_scale="jac",
                    loss="linear" if isinstance(loss, Squared) else cost,  # type: ignore[arg-type]  # stubs ask for more
                    xtol=tolerance,
                    ftol=tolerance,
                    gtol=tolerance,
                    max_nfev=trials,
                )
            except _SettledError as settled:
                return with_free(settled.part)
        return with_free(np.asarray(solution.x))

    def cost(self, x: Array, weights: Sequence[Weights], loss: Loss) -> float:
        """Twice what a fit makes small: costs of samples, as though only the independent ones were there, and of priors."""
        of_data = [
            np.sum(loss.cost((each.own * residual).ravel() ** 2)[0].reshape(residual.shape) / each.together)
            for each, residual in zip(weights, self.residuals(x), strict=True)
        ]
        of_priors, right = self.prior_rows()
        return float(sum(of_data) + np.sum((of_priors @ x - right) ** 2))

    def information(self, x: Array, weights: Sequence[Weights], loss: Loss) -> Array:
        """Rows whose products are half the second derivatives of `cost`, by Gauss and Newton, shape (rows, unknowns)."""
        bends = np.concatenate(
            [bend(loss, each.own * residual).ravel() for each, residual in zip(weights, self.residuals(x), strict=True)]
        )
        return np.concatenate((self.jacobian(x, weights) * np.sqrt(bends)[:, np.newaxis], self.prior_rows()[0]))

    def naive_sigma(self, x: Array, weights: Sequence[Weights], loss: Loss) -> Array:
        """Standard deviations that the second derivatives of the cost state; infinite where it does not change."""
        rows = self.information(x, weights, loss)
        size = np.linalg.norm(rows, axis=0)
        size = np.where(size > 0.0, size, 1.0)
        _, singular, directions = np.linalg.svd(rows / size, full_matrices=False)
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            variance = np.sum(np.where(directions == 0.0, 0.0, (directions / singular[:, np.newaxis]) ** 2), axis=0)
        return np.asarray(np.sqrt(variance) / size)

    def _together(self, weights: Sequence[Weights]) -> Array:
        """How many samples hang together, for each that takes part."""
        return np.concatenate(
            [np.repeat(each.together, record.training.sum()) for each, record in zip(weights, self.records, strict=True)]
        )

    def estimates(self, x: Array, weights: Sequence[Weights], loss: Loss) -> tuple[tuple[Estimate, ...], Array]:
        """The unknowns, behind those of the model what follows them, with what is known of each, and their covariance."""
        units = [each.own * residual for each, residual in zip(weights, self.residuals(x), strict=True)]
        scores = [slope(loss, unit) / np.sqrt(each.together) for each, unit in zip(weights, units, strict=True)]
        bends = np.concatenate([bend(loss, unit).ravel() for unit in units])
        covariance, freedom = posterior_of(self.jacobian(x, weights), scores, self.prior_rows()[0], bends)
        known, tied = self.plan.unknowns, self.plan.tied
        order = [*range(len(known)), *(each.unknown for each in tied), *range(len(known), self.size)]
        factors = np.ones(len(order))
        factors[len(known) : len(known) + len(tied)] = [each.factor for each in tied]
        covariance = covariance[np.ix_(order, order)] * np.outer(factors, factors)
        sigma, values = np.sqrt(np.diag(covariance)), factors * x[order]
        at_limit = [each.at_limit(value) for each, value in zip(known, x.tolist(), strict=False)]
        described = [(each.path, each.unit, each.before, end) for each, end in zip(known, at_limit, strict=True)]
        described += [(each.path, each.unit, each.before, at_limit[each.unknown]) for each in tied]
        for name, record in zip(self.names, self.records, strict=True):
            own = f"{AT}{name}" if len(self.records) > 1 else ""
            described += [(f"{each.name}{own}", each.unit, each.start, False) for each in record.experiment.nuisances]
        estimates = tuple(
            Estimate(path, unit, before, float(value), float(s), bool(end), float(f))
            for (path, unit, before, end), value, s, f in zip(described, values, sigma, freedom[order], strict=True)
        )
        return estimates, covariance
