"""Bootstrap: how estimates scatter, when what a fit left is dealt out anew."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from strainwave import arguments
from strainwave.equality import ComparedByFields
from strainwave.identification.fitting.fit import ROUGH, Fit, solved_problem
from strainwave.identification.fitting.loss import LOSSES
from strainwave.identification.fitting.noise import correlation_length
from strainwave.messages import listed, quoted

Array = NDArray[np.float64]
BLOCK = 4.0  # correlation lengths that a block is long (assumed; bias of the variance falls with it, its scatter grows)
MAX_DRAWS = 100_000
LEAST = 20  # draws of which an interval can be told


@dataclass(frozen=True, eq=False)
class Bootstrap(ComparedByFields):
    """Estimates of many measurements as they might have been.

    Attributes:
        paths: what was estimated
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
        """The interval that holds this share of the draws, as much beyond it on either side (percentiles)."""
        path, confidence = arguments.text("path", path), arguments.number("confidence", confidence, low=0.0, high=1.0)
        if path not in self.paths:
            raise ValueError(f"there is no estimate of {quoted(path)}; there are {listed(self.paths)}")
        ends = np.quantile(self.values[:, self.paths.index(path)], [0.5 - 0.5 * confidence, 0.5 + 0.5 * confidence])
        return float(ends[0]), float(ends[1])


def bootstrap(
    found: Fit, draws: int = 200, *, seed: int = 0, progress: Callable[[int, int], None] = lambda done, draws: None
) -> Bootstrap:
    """Fits again to measurements as they might have been: what the model predicts, and blocks of what it left in another order.

    Blocks are several times as long as residuals hang together, and channels of a record keep their instants, so that noise
    hangs together as before. What was known before is drawn anew too. Nothing is taken to be linear; but where the size of the
    noise changes along a record, that is lost, and `Estimate.sigma` is better.

    Args:
        found: what `fit` found
        draws: how many, 20 or more; each is a fit that starts at its end
        seed: of the random numbers
        progress: is called with how many draws are done, and how many there are

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
    draws = arguments.whole("draws", draws, LEAST, MAX_DRAWS)
    random = np.random.default_rng(arguments.whole("seed", seed, 0))
    problem, best = solved_problem(found)
    loss = LOSSES[found.loss]
    weights = problem.weights(best, problem.first_weights(), loss)
    left = problem.residuals(best)
    samples = sum(each.size for each in left)
    grown = float(np.sqrt(samples / max(samples - len(best), 1)))  # residuals are smaller than the noise that left them
    lengths = [max(1, min(round(BLOCK * max(map(correlation_length, each))), max(1, each.shape[1] // 4))) for each in left]
    predicted = [each for each, _ in problem.predict(best)]
    values = []
    for draw in range(draws):
        for record, model, each, length in zip(problem.records, predicted, left, lengths, strict=True):
            record.measured = model.copy()
            record.measured[:, record.training] += grown * _dealt(each, length, random)
        problem.draw_priors(random)
        with suppress(ValueError, FloatingPointError):
            values.append(problem.solve(best, weights, loss, ROUGH**2))
        progress(draw + 1, draws)
    if not values:
        raise FloatingPointError(
            "no measurement as it might have been could be fitted: the model diverges beside its estimates"
        )
    known = len(found.plan.unknowns)
    order = [*range(known), *(each.unknown for each in found.plan.tied), *range(known, len(best))]
    factors = np.ones(len(order))
    factors[known : known + len(found.plan.tied)] = [each.factor for each in found.plan.tied]
    paths, units = zip(*((each.path, each.unit) for each in found.estimates), strict=True)
    return Bootstrap(paths, units, np.stack(values)[:, order] * factors, draws - len(values))


def _dealt(left: Array, length: int, random: np.random.Generator) -> Array:
    """Blocks of what was left in another order, less its mean, shape (channels, n)."""
    n = left.shape[1]
    starts = random.integers(0, n, -(-n // length))
    rows = (starts[:, np.newaxis] + np.arange(length)).ravel()[:n] % n
    return np.asarray((left - left.mean(axis=1, keepdims=True))[:, rows])
