"""Least squares on free parameters of a model and unknowns of a measurement, in numbers scaled to their size."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive, _core
from strainwave._core import Gear
from strainwave.identification.experiments.experiment import Experiment
from strainwave.identification.fitting.covariance import covariance_of
from strainwave.identification.fitting.estimate import Estimate
from strainwave.parameters import Parameter

Array = NDArray[np.float64]
TRIALS = 60  # steps that a fit may try; those that explain their data end after ten to forty


class Problem:
    """The unknowns, what is predicted from them, and the weighted difference to what was measured."""

    def __init__(
        self,
        model: Gear | Drive,
        experiment: Experiment,
        places: list[Parameter],
        training: NDArray[np.bool_] | None,
    ) -> None:
        self.model, self.experiment, self.places = model, experiment, places
        n = experiment.measured.shape[1]
        self.training = np.ones(n, bool) if training is None else np.asarray(training)
        if self.training.dtype != bool:
            raise TypeError(f"training must hold True or False for each sample, not {self.training.dtype}")
        if self.training.shape != (n,):
            raise ValueError(f"training has shape {self.training.shape}, the measurement has {n} samples")
        unknowns = len(places) + len(experiment.nuisances)
        if unknowns == 0:
            raise ValueError("free must name at least one parameter: nothing else of this measurement is unknown")
        if self.training.sum() * len(experiment.channels) <= unknowns:
            raise ValueError(f"{self.training.sum()} samples cannot determine {unknowns} unknowns")
        self.evaluations = 0
        self._last: tuple[bytes, tuple[Array, Array]] | None = None

    def start(self) -> Array:
        """Where the fit starts, within the limits of its parameters."""
        inside = [min(max(p.value, p.low), p.high) for p in self.places]
        return np.array(inside + [nuisance.start for nuisance in self.experiment.nuisances])

    def model_with(self, x: Array) -> Any:
        numbers = [value for _, value, *_ in _core.parameters(self.model)]
        for place, value in zip(self.places, x, strict=False):
            numbers[place.number] = float(value)
        return _core.with_numbers(self.model, numbers)

    def predict(self, x: Array) -> tuple[Array, Array]:
        """Predictions and derivatives; the last ones are remembered, as solvers ask for them one after the other."""
        key = x.tobytes()
        if self._last is None or self._last[0] != key:
            self.evaluations += 1
            numbers = [place.number for place in self.places]
            nuisances = x[len(self.places) :]
            predicted, slopes = self.experiment.predict(self.model_with(x), numbers, nuisances)
            if not (np.isfinite(predicted).all() and np.isfinite(slopes).all()):
                raise FloatingPointError(
                    "what the model predicts, or its derivatives, grow beyond all numbers: look whether units and sides of the "
                    "measurement are right, and the numbers of the gear to start from"
                )
            self._last = key, (predicted, slopes)
        return self._last[1]

    def solve(self, start: Array, weights: Array, loss: Literal["linear", "soft_l1"], tolerance: float) -> Array:
        if len(start) == 0:
            return start
        from scipy.optimize import least_squares

        free_ends = [(-np.inf, np.inf)] * len(self.experiment.nuisances)
        low, high = np.array([(p.low, p.high) for p in self.places] + free_ends).reshape(-1, 2).T
        inside = np.clip(start, low, high)

        def residuals(x: Array) -> Array:
            try:
                predicted, _ = self.predict(x)
            except (ValueError, FloatingPointError):  # out of the domain, or diverged: SciPy takes a quarter of such a step
                predicted = np.full_like(self.experiment.measured, np.inf)
            return ((predicted - self.experiment.measured) * weights)[:, self.training].ravel()

        def jacobian(x: Array) -> Array:
            _, slopes = self.predict(x)
            return (slopes * weights)[:, :, self.training].reshape(len(x), -1).T

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

    def estimates(self, x: Array, weights: Array) -> tuple[tuple[Estimate, ...], Array]:
        """The unknowns with what the residuals tell of each, and their covariance."""
        predicted, slopes = self.predict(x)
        residual = (self.experiment.measured - predicted)[:, self.training] * weights
        jacobian = (slopes * weights)[:, :, self.training].reshape(len(x), -1).T
        covariance, freedom = covariance_of(jacobian, residual)
        sigma = np.sqrt(np.diag(covariance))
        estimates = [
            Estimate(p.path, p.unit, p.value, float(v), float(s), bool(v <= p.low or v >= p.high), freedom)
            for p, v, s in zip(self.places, x, sigma, strict=False)
        ]
        estimates += [
            Estimate(nuisance.name, nuisance.unit, nuisance.start, float(v), float(s), False, freedom)
            for nuisance, v, s in zip(self.experiment.nuisances, x[len(self.places) :], sigma[len(self.places) :], strict=True)
        ]
        return tuple(estimates), covariance
