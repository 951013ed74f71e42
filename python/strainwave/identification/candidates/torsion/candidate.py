"""One kind of spring with what stands beside it, fitted to a loop: the convex problem's answer, refined.

With knees and slip twists chosen beforehand a loop is linear in stiffnesses, all of which are positive: a convex problem with
one answer (non-negative least squares), which needs no starting values. It finds how many Maxwell elements the loop can tell
apart; exact derivatives then refine all numbers of spring and hysteresis together.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from strainwave._core import Gear
from strainwave.analysis.branches import PRESLIDING
from strainwave.equality import ComparedByFields
from strainwave.identification.candidates.torsion.beside import SLIPS, Beside, half_span, maxwell, pairs
from strainwave.identification.candidates.torsion.library import Answer, solve
from strainwave.identification.candidates.torsion.springs import Kind
from strainwave.identification.experiments.torsion_loop import TorsionLoop
from strainwave.identification.fitting.fit import Fit, fit

Array = NDArray[np.float64]
SLIPPING = 0.9  # of half the span: an element that slips later is a spring for all that the loop tells
ALIKE = 1.1  # ratio of two slip twists; elements that are closer are one
ROUNDS = 8  # of leaving out elements; an element at the edge of what a loop tells may come and go for ever
MINIMA = 6  # of one kind that are looked at
OFF_CENTRE = 0.02  # of half the span: guesses of the zero of the twist that are closer are one
DRIFTS = ("torque_drift", "twist_drift")
DRIFTING = 3.0  # standard deviations that a drift must exceed
STARTS = 500  # samples from which the start of a law is sought whose torques take long
NEGLIGIBLE = 1e-3  # of the span of the torque: smaller differences in error do not justify another parameter


@dataclass(frozen=True, eq=False)
class TorsionCandidate(ComparedByFields):
    """One kind of gear fitted to a loop.

    Attributes:
        spring: its kind of spring
        beside: what was fitted beside the spring
        name: both, in words
        fit: the fit, of a gear with that spring and hysteresis
        error: rms of the residuals on the samples held out [N.m]; on all, where none were
    """

    spring: Kind
    beside: Beside
    name: str
    fit: Fit
    error: float

    @property
    def loop(self) -> TorsionLoop:
        """What it was fitted to, with the history found."""
        experiment = self.fit.experiment
        assert isinstance(experiment, TorsionLoop)
        return experiment


@dataclass(frozen=True, eq=False)
class Start(ComparedByFields):
    """The convex problem's answer.

    Attributes:
        gear: with spring and hysteresis
        loop: the measurement, with its history and where the zero of the torque is
        error: root of the sum of the squared residuals of the samples that train [N.m]
    """

    gear: Gear
    loop: TorsionLoop
    error: float


def starts(
    loop: TorsionLoop, gear: Gear, training: NDArray[np.bool_], spring: Kind, beside: Beside, most: int = 1
) -> list[Start]:
    """The best springs of a kind with what stands beside them, without starting values.

    Args:
        loop: measured torque over twist
        gear: what is not sought is taken from it
        training: samples that take part, shape (n,)
        spring: kind of spring sought
        beside: what is sought beside it
        most: how many are wanted; they differ in knees and other numbers that the torque is not linear in

    Returns:
        starts, best first

    Raises:
        ValueError: nothing of these kinds fits the loop
    """
    seen = loop.without_drift()
    if beside.dear:
        seen, training = _sparse(seen, training)
    middle = 0.0 if loop.single_branch else loop.centre
    half = float(np.abs(seen.twist - middle).max())
    sought = seen.torque - beside.known(seen, gear)
    zeros = _zero_columns(seen)
    libraries = [spring.library(seen.twist - middle, half, gear), beside.library(seen, gear)]
    rows = [replace(library, torques=library.torques[training]) for library in libraries]
    answers = solve(sought[training], rows, zeros[training], most)
    level = float(np.abs(seen.torque).max())

    def begun(answer: Answer) -> Start:
        torque_zero = level * float(answer.weights[-1][0] - answer.weights[-1][1]) if zeros.size else 0.0
        return Start(answer.put(gear), replace(loop, torque_zero=torque_zero), answer.error)

    return [begun(answer) for answer in answers]


def candidate(
    loop: TorsionLoop, gear: Gear, training: NDArray[np.bool_], spring: Kind, beside: Beside, most: int = MINIMA
) -> TorsionCandidate:
    """A kind of spring and what stands beside it, fitted from the convex problem's answers: at most from so many."""
    readings = _readings(loop, spring)
    most = min(most, max(spring.minima, beside.minima))
    begun = min((starts(each, gear, training, spring, beside, most) for each in readings), key=lambda found: found[0].error)
    if not (spring.knows_zero or beside.whole_spring):
        begun = [replace(each, loop=replace(each.loop, twist_zero=loop.centre)) for each in begun]
    found = [finished(each.gear, each.loop, training, spring, beside, gear) for each in begun]
    return min(found, key=lambda each: float(each.fit.rms()[0]))


def _readings(loop: TorsionLoop, spring: Kind) -> list[TorsionLoop]:
    """Choices that a loop does not determine: if its path had been run before, and which guess is nearer to the zero."""
    if loop.single_branch:
        return [loop]
    away = np.inf if loop.unloaded is None else abs(loop.unloaded - loop.centre)
    apart = spring.knows_zero and OFF_CENTRE * half_span(loop) < away < half_span(loop)
    zeros = [loop.near_zero, loop.unloaded] if apart else [loop.near_zero]
    return [replace(each, near_zero=zero) for each in (loop, loop.virgin()) for zero in zeros]


def with_drift(found: TorsionCandidate, known: Gear) -> TorsionCandidate:
    """The candidate with a drift of torque or twist, if the loop shows one; else itself.

    A drift counts if it exceeds three standard deviations, and if what is held out is predicted better with it.
    """
    if found.loop.single_branch:
        return found
    begun = resumed(found)
    loops = [replace(begun, torque_drift=0.0), replace(begun, twist_drift=0.0)]
    tried = [finished(found.fit.gear, loop, found.fit.training, found.spring, found.beside, known) for loop in loops]
    shown = [each for each in tried if each.error < found.error and _drift_shown(each)]
    return min([found, *shown], key=lambda each: each.error)


def drifts(found: TorsionCandidate) -> dict[str, Any]:
    """What drift was found."""
    return {e.path: e.value for e in found.fit.estimates if e.path in DRIFTS}


def _drift_shown(found: TorsionCandidate) -> bool:
    sigma = {e.path: e.sigma for e in found.fit.estimates}
    return all(abs(value) > DRIFTING * sigma[name] for name, value in drifts(found).items())


def resumed(found: TorsionCandidate) -> TorsionLoop:
    """The loop as a fit that goes on from there sees it."""
    at = {estimate.path: estimate.value for estimate in found.fit.estimates}
    starts: dict[str, Any] = {name: at[name] for name in ("torque_zero", *DRIFTS) if name in at}
    return replace(found.loop, near_zero=at.get("twist_zero", found.loop.near_zero), **starts)


def finished(
    begin: Gear, loop: TorsionLoop, training: NDArray[np.bool_], spring: Kind, beside: Beside, known: Gear
) -> TorsionCandidate:
    """The candidate whose refinement begins there."""
    found = beside.finished(_refined(begin, loop, training, spring, beside), known)
    held_out = found.rms(held_out=True)[0]
    words = beside.words(found.gear)
    name = words if beside.whole_spring else f"{spring.words}{words}"
    return TorsionCandidate(spring, beside, name, found, float(found.rms()[0] if np.isnan(held_out) else held_out))


def with_fewer(found: TorsionCandidate, known: Gear) -> TorsionCandidate:
    """The candidate with those two Maxwell elements as one that slip at the most similar twists."""
    return finished(merged(found.fit.gear), found.loop, found.fit.training, found.spring, found.beside, known)


def _refined(gear: Gear, loop: TorsionLoop, training: NDArray[np.bool_], spring: Kind, beside: Beside) -> Fit:
    """The fit, without elements that the loop cannot tell from the spring or from nothing.

    An element that never slips within the loop is a linear spring, one that holds no torque is none, and two that slip at the
    same twist are one. One that slips before the loop can tell is given the least twist to slip at that it can.
    """
    half, span = half_span(loop), float(np.ptp(loop.torque))
    least = half * (SLIPS[0] if loop.input_ratio is None else 2.0 * PRESLIDING)
    stiff: set[int] = set()
    for last in [*(ROUNDS - 1) * [False], True]:
        free = spring.free(gear) + beside.free(gear, stiff)
        found = _in_order(fit(gear, loop, free, training=training), spring)
        fitted = beside.elements(found.gear)
        if last:
            break
        slipping = [(k, f) for k, f in fitted if NEGLIGIBLE * span < f < SLIPPING * half * k]
        if len(slipping) < len(fitted):
            stuck = sum(k for k, f in fitted if f >= SLIPPING * half * k)
            stiffened = spring.stiffened(found.gear.stiffness, stuck)
            gear, stiff = gear.replace(stiffness=stiffened, hysteresis=maxwell(slipping)), set()
        elif _alike(slipping):
            gear, stiff = merged(found.gear), set()
        elif stiffer := {i for i, (k, f) in enumerate(fitted) if f < 0.999 * least * k}:
            stiff |= stiffer
            slower = [(f / least if i in stiff else k, f) for i, (k, f) in enumerate(fitted)]
            gear = found.gear.replace(hysteresis=maxwell(slower))
        else:
            break
    return found


def merged(gear: Gear) -> Gear:
    """The gear with those two Maxwell elements as one that slip at the most similar twists."""
    elements = sorted(pairs(gear), key=lambda e: e[1] / e[0])
    slips = np.log([f / k for k, f in elements])
    first = int(np.argmin(np.diff(slips)))
    (k, f), (other_k, other_f) = elements[first : first + 2]
    elements[first : first + 2] = [(k + other_k, f + other_f)]
    return gear.replace(hysteresis=maxwell(elements))


def _alike(elements: Sequence[tuple[float, float]]) -> bool:
    """Whether two Maxwell elements slip at all but the same twist."""
    slips = np.sort([f / k for k, f in elements])
    return bool(np.any(slips[1:] < ALIKE * slips[:-1]))


def _in_order(found: Fit, spring: Kind) -> Fit:
    """The same fit, the knees of its spring in order."""
    ordered = spring.in_order(found.gear.stiffness)
    return found if ordered is found.gear.stiffness else replace(found, model=found.gear.replace(stiffness=ordered))


def _sparse(loop: TorsionLoop, training: NDArray[np.bool_]) -> tuple[TorsionLoop, NDArray[np.bool_]]:
    """A loop of few samples, of which a start needs no more."""
    step = -(-len(loop.twist) // STARTS)
    few = slice(None, None, step)
    moments = None if loop.moments is None else loop.moments[few]
    return replace(loop, twist=loop.twist[few], torque=loop.torque[few], moments=moments, corners=()), training[few]


def _zero_columns(loop: TorsionLoop) -> Array:
    """What a zero of the torque contributes, either way; nothing where it is known."""
    if loop.single_branch:
        return np.empty((len(loop.twist), 0))
    level = np.full(len(loop.twist), np.abs(loop.torque).max())
    return np.column_stack((level, -level))
