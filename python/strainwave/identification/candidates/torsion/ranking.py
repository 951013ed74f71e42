"""All kinds of spring and hysteresis on one loop, by what they predict where they were not fitted."""

from __future__ import annotations

import time
import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from strainwave._core import Gear, PassivityWarning
from strainwave.equality import ComparedByFields
from strainwave.identification.candidates.torsion.beside import Beside
from strainwave.identification.candidates.torsion.candidate import (
    TorsionCandidate,
    candidate,
    drifts,
    resumed,
    with_drift,
    with_fewer,
)
from strainwave.identification.candidates.torsion.folds import BLOCKS, FOLDS, block_of, held_out_blocks
from strainwave.identification.candidates.torsion.memories import BESIDE_A_SPRING, WHOLE
from strainwave.identification.candidates.torsion.selection import asked
from strainwave.identification.candidates.torsion.springs import CUBIC, LINEAR, PLAIN, Backlash, Kind, Negligible
from strainwave.identification.experiments.torsion_loop import TorsionLoop
from strainwave.identification.fitting.covariance import correlation_length
from strainwave.identification.fitting.fit import Fit, fit

Array = NDArray[np.float64]
UNNOTICED = 0.01  # of the error of the best
MINIMA = 2  # of one kind that are looked at: there are many kinds
BEHIND = 1.25  # times the residuals of the best: models that leave more are judged by one fold
TIMES = 5  # a law is timed; the least counts


@dataclass(frozen=True, eq=False)
class Candidate(ComparedByFields):
    """One model of a loop, and how well it predicts.

    Attributes:
        name: spring and hysteresis, in words
        fit: to all samples
        parameters: numbers of the gear that were fitted
        error: rms error on samples held out [N.m]: blocks of neighbours, each predicted by a fit to other blocks
        standard_error: of that error, by how the blocks differ [N.m]
        predicted: blocks that were held out in turn; five of twenty, where the residuals alone show the model to be far behind
        worse: by how much its error exceeds that of the best on the same blocks [N.m], and the standard error of that
        correlation: samples of its residuals that hang together: 1 of white noise, which leaves nothing to explain
        cost: time that its torque takes [s per sample]
    """

    name: str
    fit: Fit
    parameters: int
    error: float
    standard_error: float
    predicted: int
    worse: tuple[float, float]
    correlation: float
    cost: float

    @property
    def good(self) -> bool:
        """Whether it is as good as the best: worse by no more than one standard error, or by less than anyone would notice."""
        return self.predicted == BLOCKS and self.worse[0] <= max(self.worse[1], UNNOTICED * (self.error - self.worse[0]))


def rank_loop(loop: TorsionLoop, gear: Gear, *, friction_measured: bool = False) -> tuple[Candidate, ...]:
    """Fits all kinds of spring and hysteresis to a loop, and ranks them by what they predict.

    In stages, not all with all: springs with Maxwell elements, then the other laws of hysteresis beside the best of these
    springs and the simplest ones, then the springs beside the best law. Each fit starts from a convex problem, without a guess.

    What is held out are blocks of neighbours, each predicted by a fit to three quarters of the blocks. By how much a model is
    worse than the best is judged on the same blocks, so that what is hard to predict for both does not count. The simplest that
    is worse by no more than one standard error comes first (Breiman et al. 1984, section 3.4.3), then all by how much worse
    they are.

    Args:
        loop: measured torque over twist
        gear: the gear to start from; spring and hysteresis are replaced, the rest is kept
        friction_measured: whether `gear.friction_input` was measured on this gear, as for `fit_loop`

    Returns:
        all candidates, the one to take first

    Raises:
        ValueError: too few samples for any candidate
    """
    if len(loop.twist) < 2 * BLOCKS:
        raise ValueError(
            f"a ranking holds out {BLOCKS} blocks of a loop, so it needs {2 * BLOCKS} samples; there are {len(loop.twist)}"
        )
    every = np.ones(len(loop.twist), bool)
    tried = _Tried(loop, gear, every)
    beside = asked(loop, gear, friction_measured)
    for each in beside:
        tried.add(PLAIN, [each])
    tried.drift()
    tried.add([Backlash(LINEAR), behind_play(tried.best.spring)], [tried.best.beside])
    if not loop.single_branch:
        tried.add([tried.best.spring], BESIDE_A_SPRING)
        tried.add([Negligible()], WHOLE)
        if not tried.best.beside.whole_spring:
            tried.add([*PLAIN, behind_play(tried.best.spring)], [tried.best.beside])
        tried.add([LINEAR, CUBIC], BESIDE_A_SPRING)
    candidates = [*tried.candidates, *tried.simpler()]
    near = BEHIND * min(_left(each) for each in candidates)
    found = [_judged(each, FOLDS if _left(each) < near else 1) for each in candidates]
    return _ordered([each for each in found if each is not None])


class _Tried:
    """Candidates fitted to all samples."""

    def __init__(self, loop: TorsionLoop, gear: Gear, training: NDArray[np.bool_]) -> None:
        self.loop, self.gear, self.training = loop, gear, training
        self._found: dict[tuple[Kind, Beside], TorsionCandidate] = {}

    def add(self, springs: Sequence[Kind], besides: Sequence[Beside]) -> None:
        """Fits each of the springs with each of what stands beside it, if not yet done."""
        for spring in springs:
            for beside in besides:
                if (spring, beside) in self._found:
                    continue
                try:
                    with _trying():
                        found = candidate(self.loop, self.gear, self.training, spring, beside, MINIMA)
                except (ValueError, FloatingPointError):  # of this kind nothing fits
                    continue
                self._found[spring, beside] = found

    def drift(self) -> None:
        """Starts again with a drift, if the best shows one."""
        drifting = with_drift(self.best, self.gear)
        if drifting is not self.best:
            self.loop, before = replace(self.loop, **drifts(drifting)), [*self._found]
            self._found.clear()
            for spring, beside in before:
                self.add([spring], [beside])

    @property
    def candidates(self) -> list[TorsionCandidate]:
        return [*self._found.values()]

    @property
    def best(self) -> TorsionCandidate:
        if not self._found:
            raise ValueError("no spring and hysteresis fits this loop; it may have too few samples")
        return min(self._found.values(), key=lambda each: each.error)

    def simpler(self) -> Iterator[TorsionCandidate]:
        """The best with Maxwell elements, with fewer and fewer of them."""
        elastic = [each for each in self.candidates if each.beside.elements(each.fit.gear)]
        if not elastic:
            return
        found = min(elastic, key=lambda each: each.error)
        while len(found.beside.elements(found.fit.gear)) > 1:
            with _trying():
                found = with_fewer(found, self.gear)
            yield found


def behind_play(spring: Kind) -> Kind:
    """The kind of spring with play before it."""
    return spring if isinstance(spring, Backlash) else Backlash(spring)


@contextmanager
def _trying() -> Iterator[None]:
    """A fit tries what it likes, and SciPy divides by a singular value of 0 where a number has no effect."""
    with warnings.catch_warnings(action="ignore", category=PassivityWarning), np.errstate(divide="ignore", invalid="ignore"):
        yield


def _left(found: TorsionCandidate) -> float:
    """What a fit to all samples leaves of the torque, rms [N.m]."""
    return float(found.fit.rms()[0])


@dataclass(frozen=True, eq=False)
class _Judged(ComparedByFields):
    """A candidate with the mean squared error of each block, by fits that did not see it; not-a-number of blocks not tried."""

    candidate: TorsionCandidate
    blocks: Array


def _judged(found: TorsionCandidate, folds: int) -> _Judged | None:
    """Each fold is fitted from where the fit to all ended; none where one of them has no fit."""
    free = [estimate.path for estimate in found.fit.estimates if "." in estimate.path]
    loop = resumed(found)
    n = len(loop.twist)
    squares = np.full(n, np.nan)
    for fold in range(folds):
        training = held_out_blocks(n, fold)
        try:
            with _trying():
                part = fit(found.fit.gear, loop, free, training=training)
        except (ValueError, FloatingPointError):
            return None
        squares[~training] = part.residuals[0, ~training] ** 2
    block = block_of(n)
    return _Judged(found, np.array([squares[block == each].mean() for each in range(BLOCKS)]))


def _ordered(judged: Sequence[_Judged]) -> tuple[Candidate, ...]:
    best = min((each for each in judged if np.isfinite(each.blocks).all()), key=lambda each: each.blocks.mean())
    found = [_measured(each, best) for each in judged]
    return tuple(sorted(found, key=lambda c: (not c.good, (c.parameters, c.error) if c.good else c.worse)))


def _measured(judged: _Judged, best: _Judged) -> Candidate:
    """Errors are roots of mean squares, so that their standard errors are those of the squares over twice the root."""
    made, seen = judged.candidate.fit, np.isfinite(judged.blocks)
    blocks, of_best = judged.blocks[seen], best.blocks[seen]
    error = float(np.sqrt(blocks.mean()))
    twice = 2.0 * max(error, np.finfo(float).tiny) * np.sqrt(len(blocks))
    return Candidate(
        judged.candidate.name,
        made,
        sum("." in estimate.path for estimate in made.estimates),
        error,
        float(blocks.std(ddof=1) / twice),
        len(blocks),
        (error - float(np.sqrt(of_best.mean())), float((blocks - of_best).std(ddof=1) / twice)),
        correlation_length(made.residuals[0]),
        _cost(judged.candidate),
    )


def _cost(found: TorsionCandidate) -> float:
    """Time of the torque [s per sample], the least of several runs."""
    path = found.loop.path(found.loop.centre)
    gear = found.fit.gear
    least = np.inf
    for _ in range(TIMES):
        begun = time.perf_counter()
        try:
            gear.trace(path)
        except ValueError:  # out of the domain of its spring at the zero tried here
            return float("nan")
        least = min(least, time.perf_counter() - begun)
    return float(least / len(path))
