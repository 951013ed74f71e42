"""Least squares on free parameters of a model and unknowns of measurements."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive, Gear, _core
from strainwave.identification.experiments.experiment import Experiment
from strainwave.identification.fitting.descent import Descent
from strainwave.identification.fitting.loss_functions import LOSSES, LossName, curvature, slope
from strainwave.identification.fitting.unknowns import OF_RECORD, Estimate, FitParameters, ParameterLink
from strainwave.statistics.covariance import posterior_of
from strainwave.statistics.residuals import correlation_length

Array = NDArray[np.float64]
FIRST_NOISE = 0.01  # of the size of a channel, in the first pass (assumed)
MIN_NOISE = 1e-12  # of the size of a channel: no measurement has less noise
MIN_DISTANCE_SIGMA = 0.1  # standard deviations from a limit, the other unknowns held: a fit that ends nearer ended there
MAX_TRIALS = 60  # steps that a fit may try; those that explain their data end after ten to forty
MAX_RETURNS = 3  # of unknowns without influence to their initial values, each with further steps


@dataclass(frozen=True)
class Weights:
    """Weights of the channels of a record.

    Attributes:
        own: reciprocal standard deviation of the noise of each channel, shape (channels, 1)
        correlation_length: of its noise in samples, shape (channels, 1)
    """

    own: Array
    correlation_length: Array

    @property
    def rows(self) -> Array:
        """Factors of residuals in a sum of squares, shape (channels, 1)."""
        return self.own / np.sqrt(self.correlation_length)


def scale(measured: Array) -> Array:
    """Return the size of each channel, shape (channels, 1)."""
    spread = np.std(measured, axis=1, keepdims=True)
    size = np.max(np.abs(measured), axis=1, keepdims=True)
    return np.where(spread > 0.0, spread, np.where(size > 0.0, size, 1.0))


class FitRecord:
    """One measurement in a fit, and its prediction by the unknowns.

    Args:
        experiment: what was measured
        training: which samples take part, shape (n,); all if None
        model: the model before the fit
        links: numbers of it that are multiples of an unknown
        of_gear: True if the experiment is one of the gear in the drive alone
        first: place of its first nuisance among the unknowns

    Attributes:
        measured: what the fit compares with, shape (channels, n); that of the experiment
        of_measurement: unknowns of the measurement
        nuisances: their places among the unknowns
    """

    def __init__(
        self,
        experiment: Experiment,
        training: NDArray[np.bool_] | None,
        model: Gear | Drive,
        links: Sequence[ParameterLink],
        of_gear: bool,
        first: int,
    ) -> None:
        self.experiment, self.links, self.of_gear = experiment, links, of_gear
        self.measured = experiment.measured
        n = self.measured.shape[1]
        self.training = np.ones(n, bool) if training is None else np.asarray(training)
        if self.training.dtype != bool:
            raise TypeError(f"training must have True or False for each sample, not {self.training.dtype}")
        if self.training.shape != (n,):
            raise ValueError(
                f"training has shape {self.training.shape}; the measurement has {n} samples, give one value for each"
            )
        self.of_measurement = experiment.nuisances
        self.nuisances = slice(first, first + len(self.of_measurement))
        self._before = model
        self._numbers = [value for _, value, *_ in _core.parameters(model)]
        numbers = {path: place for place, (path, *_) in enumerate(_core.parameters(self.part_of(model)))}
        paths = [link.path.removeprefix("gear.") if of_gear else link.path for link in links]
        self._acting = [(numbers[path], link) for path, link in zip(paths, links, strict=True) if path in numbers]

    @property
    def samples(self) -> int:
        """Count of the measured values that take part."""
        return int(self.training.sum()) * len(self.measured)

    def part_of(self, model: Any) -> Any:
        """Return the part of the model that the experiment is of."""
        return model.gear if self.of_gear else model

    def model(self, x: Array) -> Any:
        """Return the model of this record by the unknowns."""
        numbers = self._numbers.copy()
        for link in self.links:
            numbers[link.number] = link.factor * float(x[link.unknown])
        return _core.with_numbers(self._before, numbers)

    def predict(self, x: Array) -> tuple[Array, Array]:
        """Return the prediction, shape (channels, n), and its derivatives by all unknowns, shape (unknowns, channels, n)."""
        model = self.part_of(self.model(x))
        predicted, by_numbers = self.experiment.predict(model, [number for number, _ in self._acting], x[self.nuisances])
        slopes = np.zeros((len(x), *predicted.shape))
        for (_, link), by_number in zip(self._acting, by_numbers, strict=False):
            slopes[link.unknown] += link.factor * by_number
        slopes[self.nuisances] = by_numbers[len(self._acting) :]
        if not (np.isfinite(predicted).all() and np.isfinite(slopes).all()):
            raise FloatingPointError(
                "what the model predicts, or its derivatives, grow beyond all numbers: look whether units and sides of the "
                "measurement are right, and the numbers of the gear to start from"
            )
        return predicted, slopes


class Problem:
    """Least squares of all records: the unknowns, their prediction, and its weighted difference to the measurement."""

    def __init__(self, plan: FitParameters, records: Sequence[FitRecord], loss: LossName) -> None:
        self.plan, self.records, self.loss_name, self.loss = plan, records, loss, LOSSES[loss]
        known = len(plan.unknowns)
        self.size = known + sum(len(record.of_measurement) for record in records)
        if self.size == 0:
            raise ValueError("free must name at least one parameter: nothing else of this measurement is unknown")
        samples = sum(record.samples for record in records)
        if samples + len(plan.priors) <= self.size:
            count = sum(int(record.training.sum()) for record in records)
            raise ValueError(
                f"{f'{count} samples are' if count else 'no sample is'} left to fit, too few for {self.size} unknowns: record "
                "longer, or more rows"
            )
        for name, record in zip(plan.records, records, strict=True):
            if record.samples == 0:
                raise ValueError(f"training leaves no sample of {name}; leave the record out")
        self.evaluations = 0
        self.watch: Callable[[str], None] | None = None  # called before each evaluation
        self._drawn = np.zeros(len(plan.priors))
        self._last: tuple[bytes, list[tuple[Array, Array]]] | None = None

    def start(self) -> Array:
        """Return the unknowns from which a fit starts, within their limits, shape (unknowns,)."""
        nuisances = [each.start for record in self.records for each in record.of_measurement]
        return np.array([each.start for each in self.plan.unknowns] + nuisances)

    def limits(self) -> Array:
        """Return the lowest and highest value of each unknown, shape (unknowns, 2)."""
        nuisances = [(each.low, each.high) for record in self.records for each in record.of_measurement]
        return np.array([(each.low, each.high) for each in self.plan.unknowns] + nuisances).reshape(-1, 2)

    def predict(self, x: Array) -> list[tuple[Array, Array]]:
        """Return predictions and derivatives of each record; the last are kept, as solvers ask for one after the other."""
        key = x.tobytes()
        if self._last is None or self._last[0] != key:
            self.evaluations += 1
            if self.watch is not None:
                self.watch(f"fitting, evaluation {self.evaluations}")
            self._last = key, [record.predict(x) for record in self.records]
        return self._last[1]

    def residuals(self, x: Array) -> list[Array]:
        """Return measured less predicted of the samples that take part, of each record, shape (channels, samples)."""
        return [
            (record.measured - predicted)[:, record.training]
            for record, (predicted, _) in zip(self.records, self.predict(x), strict=True)
        ]

    def jacobian(self, x: Array, weights: Sequence[Weights]) -> Array:
        """Return derivatives of the prediction, times the weights, shape (values that take part, unknowns)."""
        return np.concatenate(
            [
                (slopes * each.rows)[:, :, record.training].reshape(self.size, -1).T
                for record, each, (_, slopes) in zip(self.records, weights, self.predict(x), strict=True)
            ]
        )

    def prior_rows(self) -> tuple[Array, Array]:
        """Return the priors as linear equations of unit uncertainty: matrix, shape (priors, unknowns), and right side."""
        matrix, right = np.zeros((len(self.plan.priors), self.size)), np.zeros(len(self.plan.priors))
        for row, prior in enumerate(self.plan.priors):
            matrix[row, prior.unknown] = prior.factor / prior.sigma
            right[row] = prior.value / prior.sigma + self._drawn[row]
        return matrix, right

    def draw_priors(self, random: np.random.Generator) -> None:
        """Move the priors at random, by as much as they are uncertain."""
        self._drawn = random.normal(size=len(self.plan.priors))

    def first_weights(self) -> list[Weights]:
        """Return the weights of the first pass: noise is a share of the measurement, and all records count as the shortest.

        If each sample of a long record counted, the first pass would follow its drift and hide it.
        """
        lengths = [int(record.training.sum()) for record in self.records]
        return [
            Weights(1.0 / (FIRST_NOISE * size), np.full_like(size, n / min(lengths)))
            for n, record in zip(lengths, self.records, strict=True)
            for size in [scale(record.measured[:, record.training])]
        ]

    def weights(self, x: Array, before: Sequence[Weights] | None = None) -> list[Weights]:
        """Return weights of the channels of each record by the residuals of a fit with the weights before, else the first.

        Each sample counts by its standard deviation; only as many count as are independent. Residuals are smaller than the
        noise by the leverage, the part of it that the fit took. Channels of a record have one correlation length: a channel
        that is fitted worse than the others correlates longer, and would lose weight in every pass.
        """
        columns = np.concatenate((self.jacobian(x, before or self.first_weights()), self.prior_rows()[0]))
        size = np.linalg.norm(columns, axis=0)
        leverage = np.sum(np.linalg.qr(columns / np.where(size > 0.0, size, 1.0))[0] ** 2, axis=1)
        weights, first = [], 0
        for record, residual in zip(self.records, self.residuals(x), strict=True):
            channels, n = residual.shape
            used = leverage[first : first + channels * n].reshape(channels, n).sum(axis=1, keepdims=True)
            first += channels * n
            sigma = self.loss.sigma(residual) * np.sqrt(n / np.maximum(n - used, 1.0))
            sigma = np.maximum(sigma, MIN_NOISE * scale(record.measured))
            lengths = [correlation_length(slope(self.loss, row)) for row in residual / sigma]
            weights.append(Weights(1.0 / sigma, np.full((channels, 1), float(np.exp(np.mean(np.log(lengths)))))))
        return weights

    def solve(
        self, start: Array, weights: Sequence[Weights], tolerance: float, held: Sequence[int] = (), trials: int = MAX_TRIALS
    ) -> Array:
        """Return the unknowns of least cost, or those of the last step allowed; those held stay where they start.

        An unknown that lost its influence on the way, as a knee beyond the largest torque, returns to its start. If it has an
        influence there, once the others fit, the steps go on from there.
        """
        whole = np.clip(start, *self.limits().T)
        whole[list(held)] = start[list(held)]
        free = np.setdiff1d(np.arange(self.size), held)
        if len(free) == 0:
            return whole
        for _ in range(1 + MAX_RETURNS):
            x, returned = self._ended(Descent(self, whole, free, weights, tolerance, trials).ended(), whole, held, weights)
            if not np.any(self._influence(x, weights)[returned]):
                break
            whole = x.copy()
        return x

    def _influence(self, x: Array, weights: Sequence[Weights]) -> Array:
        """Return the norm of the weighted derivatives by each unknown, shape (unknowns,)."""
        return np.asarray(np.linalg.norm(np.concatenate((self.jacobian(x, weights), self.prior_rows()[0])), axis=0))

    def _ended(self, x: Array, start: Array, held: Sequence[int], weights: Sequence[Weights]) -> tuple[Array, list[int]]:
        """Return unknowns without rounding errors, and the places of those that went back to the start, without influence.

        An unknown whose distance to a bound the data do not show is at that bound.
        """
        returned = []
        for place, (unknown, shown) in enumerate(zip(self.plan.unknowns, self._influence(x, weights), strict=False)):
            resolution = MIN_DISTANCE_SIGMA / shown if shown > 0.0 else 0.0
            value = unknown.ended(float(x[place]), resolution) if shown > 0.0 else start[place]
            if place not in held and value != x[place]:
                before, x[place] = x[place], value
                if not self._is_valid(x):  # a law may exclude the limit of its number, for the sake of another one
                    x[place] = unknown.beside_limit(resolution) if value == unknown.low == 0.0 else before
                elif shown == 0.0:
                    returned.append(place)
        return x, returned

    def _is_valid(self, x: Array) -> bool:
        """True if the laws of all records allow unknowns."""
        try:
            for record in self.records:
                record.model(x)
        except ValueError:
            return False
        return True

    def cost(self, x: Array, weights: Sequence[Weights]) -> float:
        """Return twice the objective of a fit: costs of the samples, of which the independent ones count, and of priors."""
        of_data = [
            np.sum(self.loss.cost((each.own * residual).ravel() ** 2)[0].reshape(residual.shape) / each.correlation_length)
            for each, residual in zip(weights, self.residuals(x), strict=True)
        ]
        of_priors, right = self.prior_rows()
        return float(sum(of_data) + np.sum((of_priors @ x - right) ** 2))

    def information(self, x: Array, weights: Sequence[Weights]) -> Array:
        """Return rows whose products are half the second derivatives of `cost`, by Gauss and Newton, shape (rows, unknowns)."""
        curvatures = np.concatenate(
            [curvature(self.loss, each.own * left).ravel() for each, left in zip(weights, self.residuals(x), strict=True)]
        )
        return np.concatenate((self.jacobian(x, weights) * np.sqrt(curvatures)[:, np.newaxis], self.prior_rows()[0]))

    def naive_sigma(self, x: Array, weights: Sequence[Weights]) -> Array:
        """Return standard deviations by the second derivatives of the cost, shape (unknowns,); infinite where it is flat."""
        rows = self.information(x, weights)
        size = np.linalg.norm(rows, axis=0)
        size = np.where(size > 0.0, size, 1.0)
        _, singular, directions = np.linalg.svd(rows / size, full_matrices=False)
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            variance = np.sum(np.where(directions == 0.0, 0.0, (directions / singular[:, np.newaxis]) ** 2), axis=0)
        return np.asarray(np.sqrt(variance) / size)

    def leads(self) -> tuple[list[int], Array]:
        """Return the unknown of each estimate, and the estimate over it: parameters, those tied to them, nuisances."""
        known, tied = len(self.plan.unknowns), self.plan.tied
        factors = [*np.ones(known), *(each.factor for each in tied), *np.ones(self.size - known)]
        return [*range(known), *(each.unknown for each in tied), *range(known, self.size)], np.array(factors)

    def estimates(self, x: Array, weights: Sequence[Weights]) -> tuple[tuple[Estimate, ...], Array]:
        """Return the estimates of parameters, those tied to them, and nuisances, and the covariance of all."""
        units = [each.own * residual for each, residual in zip(weights, self.residuals(x), strict=True)]
        scores = [slope(self.loss, unit) / np.sqrt(each.correlation_length) for each, unit in zip(weights, units, strict=True)]
        curvatures = np.concatenate([curvature(self.loss, unit).ravel() for unit in units])
        covariance, freedom = posterior_of(self.jacobian(x, weights), scores, self.prior_rows()[0], curvatures)
        (order, factors), known, tied = self.leads(), self.plan.unknowns, self.plan.tied
        covariance = covariance[np.ix_(order, order)] * np.outer(factors, factors)
        sigma, values = np.sqrt(np.diag(covariance)), factors * x[order]
        at_limit = [each.at_limit(value) for each, value in zip(known, x.tolist(), strict=False)]
        described = [(each.path, each.unit, each.before, end) for each, end in zip(known, at_limit, strict=True)]
        described += [(each.path, each.unit, each.before, at_limit[each.unknown]) for each in tied]
        for name, record in zip(self.plan.records, self.records, strict=True):
            own = f"{OF_RECORD}{name}" if len(self.records) > 1 else ""
            described += [(f"{each.name}{own}", each.unit, each.start, False) for each in record.of_measurement]
        estimates = tuple(
            Estimate(path, unit, before, float(value), float(s), bool(end), float(f))
            for (path, unit, before, end), value, s, f in zip(described, values, sigma, freedom[order], strict=True)
        )
        return estimates, covariance
