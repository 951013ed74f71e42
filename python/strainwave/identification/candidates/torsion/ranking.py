"""All kinds of spring and hysteresis on one loop, ranked by their predictions of samples held out."""

from __future__ import annotations

import time
import warnings
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from strainwave._core import Gear, PassivityWarning
from strainwave.equality import ComparedByFields
from strainwave.identification.candidates.torsion.candidate import (
    TorsionCandidate,
    asked,
    candidate,
    drifts,
    resumed,
    simpler,
    with_drift,
)
from strainwave.identification.candidates.torsion.dissipation import WHOLE, WITH_A_SPRING, Dissipation
from strainwave.identification.candidates.torsion.springs import CUBIC, LINEAR, PLAIN_SPRINGS, Backlash, Negligible, SpringKind
from strainwave.identification.experiments.torsion_loop import TorsionLoop
from strainwave.identification.fitting.fit import Fit, fit
from strainwave.statistics.linear_fit import rms_left_out
from strainwave.statistics.residuals import correlation_length

LOOP_BLOCKS = 20  # of the samples of a loop
LOOP_FOLDS = 4  # each of every fourth block
Array = NDArray[np.float64]
MIN_EXCESS = 0.01  # of the error of the best: a smaller difference is none
MAX_RANKED_MINIMA = 2  # of one kind that are fitted: there are many kinds
MAX_RESIDUAL_FACTOR = 1.25  # over the residuals of the best: models that leave more are judged by one fold
TIMED_RUNS = 5  # of a law, of which the shortest counts


def held_out_blocks(n: int, fold: int = LOOP_FOLDS - 1) -> NDArray[np.bool_]:
    """Return True for samples that train: all but every fourth of twenty blocks, which are held out to validate.

    Whole blocks, because neighbours on a loop resemble each other too much to test one by the other. The four folds hold out
    each block once.

    >>> [int((~held_out_blocks(40, fold)).sum()) for fold in range(4)]
    [10, 10, 10, 10]
    """
    training: NDArray[np.bool_] = block_of(n) % LOOP_FOLDS != fold
    return training


def plain_error(deflection: Array, torque: Array, parts: Iterable[NDArray[np.bool_]]) -> float:
    """Return the error of a linear spring with dry friction by least squares, each part predicted from the others [N.m].

    Args:
        deflection: angle in the order measured [rad], shape (n,)
        torque: shape (n,)
        parts: True for the samples of a part, shape (n,)
    """
    columns = np.stack([np.ones(len(deflection)), deflection, np.sign(np.gradient(deflection))], axis=1)
    return rms_left_out(columns, torque, parts)


def block_of(n: int) -> NDArray[np.intp]:
    """Return the block of each sample, shape (n,)."""
    return np.arange(n) * LOOP_BLOCKS // n


@dataclass(frozen=True, eq=False)
class RankedCandidate(ComparedByFields):
    """One model of a loop, and the error of its predictions.

    Attributes:
        name: spring and hysteresis, in words
        fit: to all samples
        parameters: count of the fitted numbers of the gear
        error: rms error on samples held out [N.m]: blocks of neighbours, each predicted by a fit to other blocks
        standard_error: of that error, by how the blocks differ [N.m]
        predicted: blocks that were held out in turn; five of twenty if the residuals alone show the model to be far behind
        worse: its error less that of the best on the same blocks [N.m], and the standard error of the difference
        correlation: correlation length of its residuals [samples]: 1 of white noise, which leaves nothing to explain
        cost: time of its torque [s per sample]
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
        """True if it is as good as the best: worse by no more than one standard error, or by less than 1 %."""
        return self.predicted == LOOP_BLOCKS and self.worse[0] <= max(self.worse[1], MIN_EXCESS * (self.error - self.worse[0]))


def rank_loop(loop: TorsionLoop, gear: Gear, *, friction_measured: bool = False) -> tuple[RankedCandidate, ...]:
    """Fit all kinds of spring and hysteresis to a loop, and return them ranked by their predictions.

    They are fitted in stages: springs with Maxwell elements, then the other laws of hysteresis with the best of these springs
    and the simplest ones, then the springs with the best law. Each fit starts from a convex problem, without a guess.

    Blocks of neighbours are held out, each predicted by a fit to three quarters of the blocks. Models are compared with the
    best on the same blocks, so that samples that are hard to predict for both do not count. The simplest that is worse by no
    more than one standard error comes first (Breiman et al. 1984, section 3.4.3), then all by their difference to the best.

    Args:
        loop: measured torque over twist
        gear: the gear to start from; spring and hysteresis are replaced, the rest is kept
        friction_measured: True if `gear.friction_input` was measured on this gear, as for `fit_loop`

    Returns:
        all candidates, the best first

    Raises:
        ValueError: too few samples for any candidate
    """
    if len(loop.twist) < 2 * LOOP_BLOCKS:
        raise ValueError(
            f"a ranking holds out {LOOP_BLOCKS} blocks of a loop, so it needs {2 * LOOP_BLOCKS} samples; there are "
            f"{len(loop.twist)}: record more"
        )
    tried = _TriedCandidates(loop, gear)
    dissipation = asked(loop, gear, friction_measured)
    for each in dissipation:
        tried.add(PLAIN_SPRINGS, [each])
    tried.drift()
    tried.add([Backlash(LINEAR), behind_play(tried.best.spring)], [tried.best.dissipation])
    if not loop.single_branch:
        tried.add([tried.best.spring], WITH_A_SPRING)
        tried.add([Negligible()], WHOLE)
        if not tried.best.dissipation.whole_spring:
            tried.add([*PLAIN_SPRINGS, behind_play(tried.best.spring)], [tried.best.dissipation])
        tried.add([LINEAR, CUBIC], WITH_A_SPRING)
    candidates = [*tried.candidates, *tried.simpler()]
    near = MAX_RESIDUAL_FACTOR * min(_left(each) for each in candidates)
    judged = [_judged(each, LOOP_FOLDS if _left(each) < near else 1) for each in candidates]
    return _ordered([each for each in judged if each is not None])


class _TriedCandidates:
    """Candidates fitted to all samples."""

    def __init__(self, loop: TorsionLoop, gear: Gear) -> None:
        self.loop, self.gear, self.training = loop, gear, np.ones(len(loop.twist), bool)
        self._found: dict[tuple[SpringKind, Dissipation], TorsionCandidate] = {}

    def add(self, springs: Sequence[SpringKind], dissipations: Sequence[Dissipation]) -> None:
        """Fit each of the springs with each dissipation, if not yet done."""
        for spring in springs:
            for dissipation in dissipations:
                if (spring, dissipation) in self._found:
                    continue
                try:
                    with _trying():
                        fitted = candidate(self.loop, self.gear, self.training, spring, dissipation, MAX_RANKED_MINIMA)
                except (ValueError, FloatingPointError):  # of this kind nothing fits
                    continue
                self._found[spring, dissipation] = fitted

    def drift(self) -> None:
        """Fit all again with a drift, if the best shows one."""
        drifting = with_drift(self.best, self.gear)
        if drifting is not self.best:
            self.loop, before = replace(self.loop, **drifts(drifting)), [*self._found]
            self._found.clear()
            for spring, dissipation in before:
                self.add([spring], [dissipation])

    @property
    def candidates(self) -> list[TorsionCandidate]:
        return [*self._found.values()]

    @property
    def best(self) -> TorsionCandidate:
        if not self._found:
            raise ValueError("no spring and hysteresis fits this loop; it may have too few samples: record more")
        return min(self._found.values(), key=lambda each: each.error)

    def simpler(self) -> Iterator[TorsionCandidate]:
        """Yield the best candidate with Maxwell elements, with fewer and fewer of them."""
        elastic = [each for each in self.candidates if each.dissipation.elements(each.fit.gear)]
        with _trying():
            for best in sorted(elastic, key=lambda each: each.error)[:1]:
                yield from simpler(best, np.inf, self.gear)


def behind_play(spring: SpringKind) -> SpringKind:
    """Return the kind of spring with play before it."""
    return spring if isinstance(spring, Backlash) else Backlash(spring)


@contextmanager
def _trying() -> Iterator[None]:
    """Ignore warnings of a trial: SciPy divides by a singular value of 0 if a number has no effect."""
    with warnings.catch_warnings(action="ignore", category=PassivityWarning), np.errstate(divide="ignore", invalid="ignore"):
        yield


def _left(found: TorsionCandidate) -> float:
    """Return the rms residual of a fit to all samples [N.m]."""
    return float(found.fit.rms()[0])


@dataclass(frozen=True, eq=False)
class _Judged(ComparedByFields):
    """A candidate with the mean squared error of each block, by fits without it; not a number for blocks not tried."""

    candidate: TorsionCandidate
    blocks: Array


def _judged(found: TorsionCandidate, folds: int) -> _Judged | None:
    """Return a candidate judged by some folds, each fitted from the end of the fit to all; None if one of them has no fit."""
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
    return _Judged(found, np.array([squares[block == each].mean() for each in range(LOOP_BLOCKS)]))


def _ordered(judged: Sequence[_Judged]) -> tuple[RankedCandidate, ...]:
    best = min((each for each in judged if np.isfinite(each.blocks).all()), key=lambda each: each.blocks.mean())
    measured = [_measured(each, best) for each in judged]
    return tuple(sorted(measured, key=lambda c: (not c.good, (c.parameters, c.error) if c.good else c.worse)))


def _measured(judged: _Judged, best: _Judged) -> RankedCandidate:
    """Return the candidate with its errors: roots of mean squares, with the standard errors of these."""
    made, tried = judged.candidate.fit, np.isfinite(judged.blocks)
    blocks, of_best = judged.blocks[tried], best.blocks[tried]
    error = float(np.sqrt(blocks.mean()))
    twice = 2.0 * max(error, np.finfo(float).tiny) * np.sqrt(len(blocks))
    return RankedCandidate(
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
    """Return the time of the torque [s per sample], the shortest of several runs."""
    path = found.loop.path(found.loop.centre)
    gear = found.fit.gear
    least = np.inf
    for _ in range(TIMED_RUNS):
        begun = time.perf_counter()
        try:
            gear.trace(path)
        except ValueError:  # out of the domain of its spring at the zero tried here
            return float("nan")
        least = min(least, time.perf_counter() - begun)
    return float(least / len(path))
