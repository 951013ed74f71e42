"""Springs and their dissipation fitted to a loop: answers of convex problems, refined; the best of them as `identify` takes it.

For given knees and slip twists a loop is linear in stiffnesses, all of which are positive: a convex problem with one answer
(non-negative least squares), which needs no initial values. It gives the count of Maxwell elements that the loop separates;
exact derivatives then refine all numbers of spring and hysteresis together.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from strainwave._core import Gear
from strainwave.analysis.branches import PRESLIDING_SHARE
from strainwave.equality import ComparedByFields
from strainwave.identification.candidates.torsion.dissipation import (
    TRIED_SLIPS,
    Dissipation,
    Dry,
    Elements,
    InputFriction,
    Nothing,
    half_span,
    maxwell,
    pairs,
)
from strainwave.identification.candidates.torsion.springs import (
    CUBIC,
    LINEAR,
    THREE_SEGMENT,
    Answer,
    SpringKind,
    TwoSided,
    solve,
)
from strainwave.identification.experiments.torsion_loop import TorsionLoop
from strainwave.identification.fitting.fit import Fit, fit
from strainwave.identification.fitting.unknowns import Estimate

Array = NDArray[np.float64]
FITTED_SPRINGS = (LINEAR, CUBIC, THREE_SEGMENT)
MAX_SLIP = 0.9  # of half the span: a loop does not separate an element that slips later from a spring
MIN_SLIP_RATIO = 1.1  # of two slip twists; elements that are closer are one
MAX_ROUNDS_OF_LEAVING_OUT = 8  # of leaving out elements; one that the loop hardly determines may come and go for ever
MAX_MINIMA = 6  # of one kind that are fitted
MIN_ZERO_DISTANCE = 0.02  # of half the span: guesses of the zero of the twist that are closer are one
DRIFT_NAMES = ("torque_drift", "twist_drift")
MIN_DRIFT_SIGMA = 3.0  # standard deviations of a drift
MIN_ASYMMETRY_SIGMA = 3.0  # standard deviations of a factor from 1
FACTOR_PATH = "stiffness.negative_factor"
MAX_FACTOR_SIGMA = 0.05  # of the torque in one sense over that in the other: beyond, a loop does not determine it
MAX_START_SAMPLES = 500  # for initial values of a law whose torques take long
MIN_ERROR_SHARE = 1e-3  # of the span of the torque: a smaller decrease of the error does not justify another parameter


# ---- Choice ----------------------------------------------------------------------------------------------------------


def fit_loop(
    loop: TorsionLoop, gear: Gear, training: NDArray[np.bool_] | None = None, *, friction_measured: bool = False
) -> list[TorsionCandidate]:
    """Fit each kind of spring to a loop, with the dissipation that the loop determines.

    That is Maxwell-slip hysteresis, in parallel with the spring. A single branch determines none: the hysteresis of the gear is
    kept. A loop from the input contains the friction of the wave generator, too. If this was measured, it is taken out. If not,
    the loop determines the sum of friction and hysteresis alone; one of them is fitted, friction rather than hysteresis, and
    the other is kept. A drift of torque or twist is fitted if the loop shows one, and a spring that differs between the senses
    of twist.

    Args:
        loop: measured torque over twist
        gear: the gear to start from; fitted parts are replaced, the rest is kept
        training: samples that take part, shape (n,); the rest validates
        friction_measured: True if `gear.friction_input` was measured on this gear

    Returns:
        candidates, best first by the error on data held out; of those within 5 % of it, and a thousandth of the span of the
        torque, the one with the fewest parameters; last those with an asymmetry that the loop does not show

    Raises:
        ValueError: too few samples for any candidate
    """
    chosen = np.ones(len(loop.twist), bool) if training is None else training
    kinds = [(spring, dissipation) for dissipation in asked(loop, gear, friction_measured) for spring in FITTED_SPRINGS]
    candidates = _fitted(loop, gear, chosen, kinds)
    best = min(candidates, key=lambda c: c.error)
    if drift := drifts(with_drift(best, gear)):
        loop = replace(loop, **drift)
        candidates = _fitted(loop, gear, chosen, kinds)
        best = min(candidates, key=lambda c: c.error)
    asymmetric = one_sided(best, loop, gear)
    shown = [each for each in asymmetric if shows_asymmetry(each) and each.error < best.error]
    candidates += shown
    best = min(candidates, key=lambda c: c.error)
    good = float(np.hypot(1.05 * best.error, MIN_ERROR_SHARE * np.ptp(loop.torque)))
    candidates += simpler(best, good, gear)
    ranked = sorted(candidates, key=lambda c: (c.error > good, len(c.fit.estimates) if c.error <= good else c.error))
    return [*ranked, *(each for each in asymmetric if each not in shown)]


def _fitted(
    loop: TorsionLoop, gear: Gear, training: NDArray[np.bool_], kinds: Sequence[tuple[SpringKind, Dissipation]]
) -> list[TorsionCandidate]:
    """Return the candidates of springs and dissipations for which there are samples enough; raises if there are for none."""
    candidates, refused = list[TorsionCandidate](), list[ValueError]()
    for each in kinds:
        try:
            candidates.append(candidate(loop, gear, training, *each))
        except ValueError as error:
            refused.append(error)
    if not candidates:
        raise refused[0]
    return candidates


def simpler(best: TorsionCandidate, good: float, known: Gear) -> Iterator[TorsionCandidate]:
    """Yield the best candidate with fewer and fewer Maxwell elements, as long as its error is at most `good`."""
    fewer = best
    while len(fewer.dissipation.elements(fewer.fit.gear)) > 1 and fewer.error <= good:
        gear = merged(fewer.fit.gear)  # the two as one that slip at the most similar twists
        fewer = finished(gear, fewer.loop, fewer.fit.training, fewer.spring, fewer.dissipation, known)
        yield fewer


def asked(loop: TorsionLoop, gear: Gear, friction_measured: bool) -> list[Dissipation]:
    """Return the dissipations that are fitted to the loop: Maxwell elements, or those in their place."""
    if loop.single_branch:
        return [Nothing()]
    friction_inside = bool(np.any(loop.friction(gear))) and isinstance(gear.friction_input, Dry)
    return [Elements()] if friction_measured or not friction_inside else [InputFriction(), Elements()]


# ---- One kind of spring and its dissipation --------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class TorsionCandidate(ComparedByFields):
    """One kind of gear fitted to a loop.

    Attributes:
        spring: its kind of spring
        dissipation: the part fitted together with the spring
        name: both, in words
        fit: the fit, of a gear with that spring and hysteresis
        error: rms of the residuals on the samples held out [N.m]; on all if none were
    """

    spring: SpringKind
    dissipation: Dissipation
    name: str
    fit: Fit
    error: float

    @property
    def is_one_sided(self) -> bool:
        """True if its spring differs between the senses of twist."""
        return isinstance(self.spring, TwoSided)

    @property
    def loop(self) -> TorsionLoop:
        """Loop that it was fitted to, with the history found."""
        experiment = self.fit.experiment
        assert isinstance(experiment, TorsionLoop)
        return experiment


@dataclass(frozen=True, eq=False)
class Start(ComparedByFields):
    """Answer of the convex problem.

    Attributes:
        gear: with spring and hysteresis
        loop: the measurement, with its history and the zero of the torque
        error: root of the sum of the squared residuals of the samples that train [N.m]
    """

    gear: Gear
    loop: TorsionLoop
    error: float


def starts(
    loop: TorsionLoop, gear: Gear, training: NDArray[np.bool_], spring: SpringKind, dissipation: Dissipation, most: int = 1
) -> list[Start]:
    """Return the best springs of a kind with their dissipation, without initial values.

    Args:
        loop: measured torque over twist
        gear: the other parts are taken from it
        training: samples that take part, shape (n,)
        spring: kind of spring
        dissipation: the part fitted together with it
        most: largest count; they differ in knees and other numbers that the torque is not linear in

    Returns:
        starts, best first

    Raises:
        ValueError: nothing of these kinds fits the loop
    """
    steady = loop.without_drift()
    if dissipation.is_slow:
        few = slice(None, None, -(-len(steady.twist) // MAX_START_SAMPLES))  # which suffice for initial values
        moments = None if steady.moments is None else steady.moments[few]
        steady = replace(steady, twist=steady.twist[few], torque=steady.torque[few], moments=moments, corners=())
        training = training[few]
    middle = 0.0 if loop.single_branch else loop.centre
    half = float(np.abs(steady.twist - middle).max())
    torque = steady.torque - dissipation.known(steady, gear)
    level = float(np.abs(steady.torque).max())
    either_way = [] if steady.single_branch else [level, -level]  # of a zero of the torque that is not known
    zeros = np.full((len(steady.twist), len(either_way)), either_way)
    libraries = [spring.library(steady.twist - middle, half, gear), dissipation.library(steady, gear)]
    rows = [replace(library, torques=library.torques[training]) for library in libraries]
    answers = solve(torque[training], rows, zeros[training], most)

    def begun(answer: Answer) -> Start:
        torque_zero = level * float(answer.weights[-1][0] - answer.weights[-1][1]) if zeros.size else 0.0
        return Start(answer.put(gear), replace(loop, torque_zero=torque_zero), answer.error)

    return [begun(answer) for answer in answers]


def candidate(
    loop: TorsionLoop,
    gear: Gear,
    training: NDArray[np.bool_],
    spring: SpringKind,
    dissipation: Dissipation,
    most: int = MAX_MINIMA,
) -> TorsionCandidate:
    """Fit a kind of spring and its dissipation, from `most` answers of the convex problem at most."""
    readings = _readings(loop, spring)
    most = min(most, max(spring.minima, dissipation.minima))
    begun = min(
        (starts(each, gear, training, spring, dissipation, most) for each in readings), key=lambda found: found[0].error
    )
    if not (spring.knows_zero or dissipation.whole_spring):
        begun = [replace(each, loop=replace(each.loop, twist_zero=loop.centre)) for each in begun]
    found = [finished(each.gear, each.loop, training, spring, dissipation, gear) for each in begun]
    return min(found, key=lambda each: float(each.fit.rms()[0]))


def _readings(loop: TorsionLoop, spring: SpringKind) -> list[TorsionLoop]:
    """Return choices that a loop does not determine: if its path had been run before, and which guess is nearer to the zero."""
    if loop.single_branch:
        return [loop]
    away = np.inf if loop.unloaded is None else abs(loop.unloaded - loop.centre)
    apart = spring.knows_zero and MIN_ZERO_DISTANCE * half_span(loop) < away < half_span(loop)
    zeros = [loop.near_zero, loop.unloaded] if apart else [loop.near_zero]
    return [replace(each, near_zero=zero) for each in (loop, replace(loop, history="virgin")) for zero in zeros]


def with_drift(found: TorsionCandidate, known: Gear) -> TorsionCandidate:
    """Return the candidate with a drift of torque or twist, if the loop shows one; else itself.

    A drift counts if it exceeds three standard deviations, and if the samples held out are predicted better with it.
    """
    if found.loop.single_branch:
        return found

    def is_shown(estimate: Estimate) -> bool:
        return estimate.path not in DRIFT_NAMES or abs(estimate.value) > MIN_DRIFT_SIGMA * estimate.sigma

    begun = resumed(found)
    loops = [replace(begun, torque_drift=0.0), replace(begun, twist_drift=0.0)]
    tried = [finished(found.fit.gear, loop, found.fit.training, found.spring, found.dissipation, known) for loop in loops]
    shown = [each for each in tried if each.error < found.error and all(map(is_shown, each.fit.estimates))]
    return min([found, *shown], key=lambda each: each.error)


def one_sided(best: TorsionCandidate, loop: TorsionLoop, known: Gear) -> list[TorsionCandidate]:
    """Return candidates with a factor on the torque at negative twist and the dissipation of the best one, best first.

    A single branch shows none, because it does not determine its zeros. Nor does a loop at the input: its kinematic error bends
    the curve as an asymmetry does.
    """
    if loop.single_branch or loop.input_ratio is not None:
        return []
    spring, training = TwoSided(best.spring), best.fit.training
    even: Any = spring.wrapped(best.fit.gear.stiffness, 1.0)
    fits = [finished(best.fit.gear.replace(stiffness=even), resumed(best), training, spring, best.dissipation, known)]
    for law in FITTED_SPRINGS:
        with suppress(ValueError):  # too few samples, or nothing of this kind fits
            fits.append(candidate(loop, known, training, TwoSided(law), best.dissipation))
    return sorted(fits, key=lambda fit: fit.error)


def shows_asymmetry(found: TorsionCandidate) -> bool:
    """True if the torque at negative twist differs from that at the opposite twist by more than chance."""
    factor = _factor(found)
    return bool(abs(factor.value - 1.0) > MIN_ASYMMETRY_SIGMA * factor.sigma)


def _factor(found: TorsionCandidate) -> Estimate:
    return next(each for each in found.fit.estimates if each.path == FACTOR_PATH)


def asymmetry_in_words(fits: Sequence[TorsionCandidate]) -> Iterator[str]:
    """Yield whether a loop determines that its spring differs between the senses of twist; `fits` are those of `fit_loop`."""
    best, one_sided_fits = fits[0], [each for each in fits if each.is_one_sided]
    if not one_sided_fits:
        return
    fit = best if best in one_sided_fits else min(one_sided_fits, key=lambda each: each.error)
    factor = _factor(fit)
    stated = f"the torque at negative twist is {factor.value:.3f} ± {factor.sigma:.2g} times that at the opposite twist"
    if fit is best:
        yield f"{stated}; a wrong zero of the torque can look the same"
    elif shows_asymmetry(fit) and fit.error < best.error:
        yield f"{stated}, but that is not taken: it makes up for less than a thousandth of the range of the torque"
    elif factor.sigma < MAX_FACTOR_SIGMA and not shows_asymmetry(fit):
        yield f"the spring is the same in both senses of twist: {stated}"
    else:
        yield "the loop does not determine whether the spring differs between the senses of twist"


def drifts(found: TorsionCandidate) -> dict[str, Any]:
    """Return the fitted drifts by name."""
    return {e.path: e.value for e in found.fit.estimates if e.path in DRIFT_NAMES}


def resumed(found: TorsionCandidate) -> TorsionLoop:
    """Return the loop with the end of a fit as initial values."""
    at = {estimate.path: estimate.value for estimate in found.fit.estimates}
    starts: dict[str, Any] = {name: at[name] for name in ("torque_zero", *DRIFT_NAMES) if name in at}
    return replace(found.loop, near_zero=at.get("twist_zero", found.loop.near_zero), **starts)


def finished(
    begin: Gear, loop: TorsionLoop, training: NDArray[np.bool_], spring: SpringKind, dissipation: Dissipation, known: Gear
) -> TorsionCandidate:
    """Return the candidate whose refinement begins with a gear."""
    refined = dissipation.finished(_refined(begin, loop, training, spring, dissipation), known)
    held_out = refined.rms(held_out=True)[0]
    words = dissipation.words(refined.gear)
    name = words if dissipation.whole_spring else f"{spring.words}{words}"
    return TorsionCandidate(spring, dissipation, name, refined, float(refined.rms()[0] if np.isnan(held_out) else held_out))


def _refined(gear: Gear, loop: TorsionLoop, training: NDArray[np.bool_], spring: SpringKind, dissipation: Dissipation) -> Fit:
    """Return the fit, without elements that the loop does not separate from the spring or from nothing.

    An element that never slips within the loop is a linear spring, one without torque is none, and two that slip at the same
    twist are one. One that slips earlier than the loop determines slips at the smallest twist that it determines.
    """
    half, span = half_span(loop), float(np.ptp(loop.torque))
    least = half * (TRIED_SLIPS[0] if loop.input_ratio is None else 2.0 * PRESLIDING_SHARE)
    stiff: set[int] = set()
    for last in [*(MAX_ROUNDS_OF_LEAVING_OUT - 1) * [False], True]:
        free = spring.free(gear) + dissipation.free(gear, stiff)
        refined = fit(gear, loop, free, training=training)
        ordered = spring.in_order(refined.gear.stiffness)
        if ordered is not refined.gear.stiffness:
            refined = replace(refined, model=refined.gear.replace(stiffness=ordered))
        fitted = dissipation.elements(refined.gear)
        if last:
            break
        slipping = [(k, f) for k, f in fitted if MIN_ERROR_SHARE * span < f < MAX_SLIP * half * k]
        if len(slipping) < len(fitted):
            stuck = sum(k for k, f in fitted if f >= MAX_SLIP * half * k)
            stiffened = spring.stiffened(refined.gear.stiffness, stuck)
            gear, stiff = gear.replace(stiffness=stiffened, hysteresis=maxwell(slipping)), set()
        elif _alike(slipping):
            gear, stiff = merged(refined.gear), set()
        elif stiffer := {i for i, (k, f) in enumerate(fitted) if f < 0.999 * least * k}:
            stiff |= stiffer
            slower = [(f / least if i in stiff else k, f) for i, (k, f) in enumerate(fitted)]
            gear = refined.gear.replace(hysteresis=maxwell(slower))
        else:
            break
    return refined


def merged(gear: Gear) -> Gear:
    """Return the gear without a Maxwell element of no torque, or with the two that slip at the most similar twists as one."""
    elements = sorted(pairs(gear), key=lambda e: e[1] / e[0])
    if elements[0][1] == 0.0:
        return gear.replace(hysteresis=maxwell(elements[1:]))
    slips = np.log([f / k for k, f in elements])
    first = int(np.argmin(np.diff(slips)))
    (k, f), (other_k, other_f) = elements[first : first + 2]
    elements[first : first + 2] = [(k + other_k, f + other_f)]
    return gear.replace(hysteresis=maxwell(elements))


def _alike(elements: Sequence[tuple[float, float]]) -> bool:
    """True if two Maxwell elements slip at nearly the same twist."""
    slips = np.sort([f / k for k, f in elements])
    return bool(np.any(slips[1:] < MIN_SLIP_RATIO * slips[:-1]))
