"""Bootstrap: scatter of the estimates of fits to resampled residuals."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from strainwave import arguments, typeset
from strainwave.equality import ComparedByFields
from strainwave.identification.fitting.fit import REFIT_TOLERANCE, Fit, solved_problem
from strainwave.messages import listed, quoted
from strainwave.presentation import PLAIN_DIGITS, Pictured, Row
from strainwave.progress import Progress, by_count
from strainwave.statistics.residuals import correlation_length

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Array = NDArray[np.float64]
LENGTHS_PER_BLOCK = 4.0  # correlation lengths (assumed; bias of the variance falls with it, its scatter grows)
MAX_DRAWS = 100_000
MIN_DRAWS = 20  # that determine an interval


@dataclass(frozen=True, eq=False)
class Bootstrap(ComparedByFields, Pictured):
    """Estimates of many resampled measurements.

    Attributes:
        paths: of the estimates
        units: unit of each
        values: estimates of each draw, shape (draws, p)
        failed: draws for which no fit was found; they are not among the values

    >>> drawn = Bootstrap(("friction_input.coulomb",), ("N.m",), np.array([[0.019], [0.020], [0.021]]), 0)
    >>> drawn.sigma.round(4).tolist(), [round(end, 4) for end in drawn.interval("friction_input.coulomb", 0.5)]
    ([0.001], [0.0195, 0.0205])
    """

    paths: tuple[str, ...]
    units: tuple[str, ...]
    values: Array
    failed: int

    @property
    def sigma(self) -> Array:
        """Standard deviation of each estimate, shape (p,)."""
        return np.asarray(np.std(self.values, axis=0, ddof=1))

    def interval(self, path: str, confidence: float = 0.95) -> tuple[float, float]:
        """Return the interval that contains this share of the draws, with as many on either side of it (percentiles).

        Raises:
            ValueError: there is no such estimate, or `confidence` lies outside of (0, 1)
            TypeError: `path` is no text, or `confidence` no number
        """
        path, confidence = arguments.text("path", path), arguments.number("confidence", confidence, low=0.0, high=1.0)
        if path not in self.paths:
            raise ValueError(f"there is no estimate of {quoted(path)}; there are {listed(self.paths)}")
        ends = np.quantile(self.values[:, self.paths.index(path)], [0.5 - 0.5 * confidence, 0.5 + 0.5 * confidence])
        return float(ends[0]), float(ends[1])

    def _headline(self) -> str:
        failed = f", {self.failed} without a fit" if self.failed else ""
        return f"{len(self.values)} draws of {listed(self.paths)}{failed}"

    def _rows(self) -> Iterator[Row]:
        for path, unit, values, sigma in zip(self.paths, self.units, self.values.T, self.sigma.tolist(), strict=True):
            low, high = (typeset.number(end, PLAIN_DIGITS) for end in self.interval(path))
            yield Row(path, float(values.mean()), unit, sigma, f"95 %: {low} to {high}")

    def plot(self) -> Figure:
        """Return a figure of the histogram of the draws of each estimate."""
        from strainwave.drawing.simple import Series, histograms_figure

        drawn = [Series(*each) for each in zip(self.paths, self.units, self.values.T, strict=True)]
        return histograms_figure(f"Estimates of {len(self.values)} draws", drawn)


def bootstrap(found: Fit, draws: int = 200, *, seed: int = 0, progress: Progress = None) -> Bootstrap:
    """Return fits to resampled measurements: the prediction of the model, and blocks of its residuals in another order.

    Blocks are several correlation lengths long, and channels of a record keep their instants, so that noise correlates as
    before. Priors are drawn anew, too. Nothing is taken to be linear. A noise whose size changes along a record becomes one of
    constant size; `Estimate.sigma` is better then.

    Args:
        found: result of `fit`
        draws: count of fits, 20 or more; each starts where `found` ended
        seed: of the random numbers
        progress: as of `sw.simulate`

    Returns:
        The estimates of each draw that could be fitted, shape (draws, p), in the order and units of `found.estimates`.

    Raises:
        TypeError: `found` is no fit
        ValueError: too few draws
        FloatingPointError: no draw could be fitted

    Source: Künsch, Annals of Statistics 17 (1989) 1217-1241; Politis & Romano (1992) for blocks that go round the end.

    >>> import strainwave as sw
    >>> law = sw.friction.Coulomb(coulomb=0.02, breakaway=0.02, viscous=3e-4)
    >>> speed = np.linspace(1.0, 50.0, 60)
    >>> torque = law.steady(speed) + 1e-4 * np.random.default_rng(0).normal(size=60)
    >>> table = sw.Recording({"speed": speed, "torque": torque}, {"speed": "rad/s", "torque": "N.m"})
    >>> found = sw.fit(sw.Gear(friction_input=law), table, ["friction_input.coulomb"])
    >>> drawn = bootstrap(found, 100)
    >>> bool(abs(drawn.sigma[0] / found.estimates[0].sigma - 1.0) < 0.3)
    True
    """
    draws = arguments.whole("draws", draws, MIN_DRAWS, MAX_DRAWS)
    random = np.random.default_rng(arguments.whole("seed", seed, 0))
    problem, best = solved_problem(found)
    weights = problem.weights(best)
    left = problem.residuals(best)
    samples = sum(each.size for each in left)
    grown = float(np.sqrt(samples / max(samples - len(best), 1)))  # residuals are smaller than their noise
    lengths = [
        max(1, min(round(LENGTHS_PER_BLOCK * max(map(correlation_length, each))), max(1, each.shape[1] // 4))) for each in left
    ]
    predicted = [each for each, _ in problem.predict(best)]
    values = []
    with by_count(progress, "drawing measurements anew", draws) as done:
        for draw in range(1, draws + 1):
            for record, model, each, length in zip(problem.records, predicted, left, lengths, strict=True):
                record.measured = model.copy()
                record.measured[:, record.training] += grown * _resampled(each, length, random)
            problem.draw_priors(random)
            with suppress(ValueError, FloatingPointError):
                values.append(problem.solve(best, weights, REFIT_TOLERANCE))
            if done is not None:
                done(draw)
    if not values:
        raise FloatingPointError(
            "no resampled measurement could be fitted: the model diverges near its estimates; bound the parameters, or fix some"
        )
    order, factors = problem.leads()
    paths, units = zip(*((each.path, each.unit) for each in found.estimates), strict=True)
    return Bootstrap(paths, units, np.stack(values)[:, order] * factors, draws - len(values))


def _resampled(left: Array, length: int, random: np.random.Generator) -> Array:
    """Return blocks of residuals in another order, less their mean, shape (channels, n)."""
    n = left.shape[1]
    starts = random.integers(0, n, -(-n // length))
    rows = (starts[:, np.newaxis] + np.arange(length)).ravel()[:n] % n
    return np.asarray((left - left.mean(axis=1, keepdims=True))[:, rows])
