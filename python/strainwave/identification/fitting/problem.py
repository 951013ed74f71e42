"""Least squares on free parameters of a model and unknowns of measurements, in numbers scaled to their size."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive, Gear, _core
from strainwave.identification.experiments.experiment import Experiment
from strainwave.identification.fitting.covariance import posterior_of
from strainwave.identification.fitting.estimate import Estimate
from strainwave.identification.fitting.unknowns import AT, Move, Plan

Array = NDArray[np.float64]
TRIALS = 60  # steps that a fit may try; those that explain their data end after ten to forty


class Record:
    """One measurement in a fit: what the unknowns predict for it.

    Args:
        experiment: what was measured
        training: which samples take part, shape (n,); all if None
        model: the model before the fit
        moves: which numbers of it move with which unknown
        of_gear: whether the experiment is one of the gear in the drive alone
        first: place of its first nuisance among the unknowns
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
        n = experiment.measured.shape[1]
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
        for (_, move), slope in zip(self._seen_moves, by_numbers, strict=False):
            slopes[move.unknown] += move.factor * slope
        slopes[self.nuisances] = by_numbers[len(self._seen_moves) :]
        if not (np.isfinite(predicted).all() and np.isfinite(slopes).all()):
            raise FloatingPointError(
                "what the model predicts, or its derivatives, grow beyond all numbers: look whether units and sides of the "
                "measurement are right, and the numbers of the gear to start from"
            )
        return predicted, slopes


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
            raise ValueError(
                f"{sum(int(record.training.sum()) for record in records)} samples cannot determine {self.size} unknowns"
            )
        for name, record in zip(names, records, strict=True):
            if record.samples == 0:
                raise ValueError(f"training leaves no sample of {name}; leave the record out")
        self.evaluations = 0
        self._last: tuple[bytes, list[tuple[Array, Array]]] | None = None

    def start(self) -> Array:
        """Where the fit starts, within the limits of its parameters."""
        nuisances = [each.start for record in self.records for each in record.experiment.nuisances]
        return np.array([each.start for each in self.plan.unknowns] + nuisances)

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
            (record.experiment.measured - predicted)[:, record.training]
            for record, (predicted, _) in zip(self.records, self.predict(x), strict=True)
        ]

    def jacobian(self, x: Array, weights: Sequence[Array]) -> Array:
        """Derivatives of what is predicted, times the weights, shape (numbers that take part, unknowns)."""
        return np.concatenate(
            [
                (slopes * weight)[:, :, record.training].reshape(self.size, -1).T
                for record, weight, (_, slopes) in zip(self.records, weights, self.predict(x), strict=True)
            ]
        )

    def prior_rows(self) -> tuple[Array, Array]:
        """What is known before as linear equations of unit uncertainty: matrix, shape (priors, unknowns), and right side."""
        matrix, right = np.zeros((len(self.plan.priors), self.size)), np.zeros(len(self.plan.priors))
        for row, prior in enumerate(self.plan.priors):
            matrix[row, prior.unknown] = prior.factor / prior.sigma
            right[row] = prior.value / prior.sigma
        return matrix, right

    def solve(self, start: Array, weights: Sequence[Array], loss: Literal["linear", "soft_l1"], tolerance: float) -> Array:
        from scipy.optimize import least_squares

        free_ends = [(-np.inf, np.inf)] * (self.size - len(self.plan.unknowns))
        low, high = np.array([(each.low, each.high) for each in self.plan.unknowns] + free_ends).reshape(-1, 2).T
        inside = np.clip(start, low, high)
        of_priors, right = self.prior_rows()

        def residuals(x: Array) -> Array:
            try:
                of_data = [-weight * residual for weight, residual in zip(weights, self.residuals(x), strict=True)]
            except (ValueError, FloatingPointError):  # out of the domain, or diverged: SciPy takes a quarter of such a step
                of_data = [np.full(record.samples, np.inf) for record in self.records]
            return np.concatenate([*map(np.ravel, of_data), of_priors @ x - right])

        def jacobian(x: Array) -> Array:
            return np.concatenate((self.jacobian(x, weights), of_priors))

        with np.errstate(over="ignore"):  # SciPy takes a smaller step where its model of the residuals is infinite
            solution = least_squares(
                residuals,
                inside,
                jac=jacobian,
                bounds=(low, high),
                x_scale="jac",
                loss=loss,
                xtol=tolerance,
                ftol=tolerance,
                gtol=tolerance,
                max_nfev=TRIALS,
            )
        return np.asarray(solution.x)

    def estimates(self, x: Array, weights: Sequence[Array]) -> tuple[tuple[Estimate, ...], Array]:
        """The unknowns, behind those of the model what follows them, with what is known of each, and their covariance."""
        residual = [row for weight, each in zip(weights, self.residuals(x), strict=True) for row in weight * each]
        covariance, freedom = posterior_of(self.jacobian(x, weights), residual, self.prior_rows()[0])
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
