"""Torsion loops: spring and Maxwell-slip hysteresis from torque over twist.

With slip twists chosen beforehand the loop is linear in the stiffnesses, all of which are positive: a convex problem with one
answer (non-negative least squares), which needs no starting values. It finds how many elements the loop can tell apart;
exact derivatives then refine stiffness, breakaway and the spring together.
"""

from __future__ import annotations

import warnings
from abc import ABC, abstractmethod
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from strainwave import friction, hysteresis, stiffness
from strainwave._core import Gear, PassivityWarning
from strainwave.equality import ComparedByFields
from strainwave.identification.candidates.friction import dissipating
from strainwave.identification.experiments.branches import PRESLIDING
from strainwave.identification.experiments.torsion_loop import TorsionLoop
from strainwave.identification.fitting.fit import Fit, fit

Array = NDArray[np.float64]

SLIPS = np.geomspace(5e-3, 0.85, 14)  # of half the span: twists tried for an element's slip; no loop tried tells more apart
SLIPPING = 0.9  # of half the span: an element that slips later is a spring for all that the loop tells
ALIKE = 1.1  # ratio of two slip twists; elements that are closer are one
KNEES = np.array([*np.arange(0.1, 1.0, 0.1), 0.95, 0.988])  # of half the span: tried for the knees of a three-segment spring
MOST_ELEMENTS = 6  # kept after the convex step
NEGLIGIBLE = 1e-3  # of the span of the torque: smaller differences in error do not justify another parameter
SPRINGS = ("linear", "cubic", "three_segment")
Dry = friction.Coulomb | friction.Stribeck | friction.LuGre  # friction whose breakaway a loop can tell


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

    spring: str
    beside: Beside
    name: str
    fit: Fit
    error: float


def held_out_blocks(n: int, blocks: int = 20, every: int = 4) -> NDArray[np.bool_]:
    """Samples that train: all but every fourth of twenty blocks, which are held out to validate.

    Whole blocks, because neighbours on a loop resemble each other too much to test one by the other.
    """
    block = np.arange(n) * blocks // n
    training: NDArray[np.bool_] = block % every != every - 1
    return training


def fit_loop(
    loop: TorsionLoop, gear: Gear, training: NDArray[np.bool_] | None = None, *, friction_measured: bool = False
) -> list[TorsionCandidate]:
    """Fits each kind of spring to a loop, and beside it what the loop can tell.

    That is Maxwell-slip hysteresis, in parallel with the spring. Of a single branch it is nothing: the hysteresis of the gear
    is kept. A loop from the input holds the friction of the wave generator too. Where this was measured, it is taken out.
    Where it was not, the loop tells the sum of friction and hysteresis only; one of them is fitted, friction rather than
    hysteresis, and the other is kept.

    Args:
        loop: measured torque over twist
        gear: the gear to start from; what is fitted is replaced, the rest is kept
        training: samples that take part, shape (n,); the rest validates
        friction_measured: whether `gear.friction_input` was measured on this gear

    Returns:
        candidates, best first by the error on data held out; of those within 5 % of it, and a thousandth of the span of the
        torque, the one with the fewest parameters

    Raises:
        ValueError: too few samples for any candidate
    """
    chosen = np.ones(len(loop.twist), bool) if training is None else training
    asked = _asked(loop, gear, friction_measured)
    candidates = [_candidate(loop, gear, chosen, spring, beside) for beside in asked for spring in SPRINGS]
    best = min(candidates, key=lambda c: c.error)
    good = float(np.hypot(1.05 * best.error, NEGLIGIBLE * np.ptp(loop.torque)))
    candidates += _simpler(best, good, chosen)
    return sorted(candidates, key=lambda c: (c.error > good, len(c.fit.estimates) if c.error <= good else c.error))


def _simpler(best: TorsionCandidate, good: float, training: NDArray[np.bool_]) -> Iterator[TorsionCandidate]:
    """The best candidate with fewer and fewer Maxwell elements, as long as it stays good."""
    candidate = best
    while len(candidate.beside.elements(candidate.fit.gear)) > 1 and candidate.error <= good:
        experiment = candidate.fit.experiment
        assert isinstance(experiment, TorsionLoop)
        candidate = _finished(_merged(candidate.fit.gear), experiment, training, best.spring, best.beside, best.fit.gear)
        yield candidate


def _alike(elements: Sequence[tuple[float, float]]) -> bool:
    """Whether two Maxwell elements slip at all but the same twist."""
    slips = np.sort([f / k for k, f in elements])
    return bool(np.any(slips[1:] < ALIKE * slips[:-1]))


def _merged(gear: Gear) -> Gear:
    """The gear with those two Maxwell elements as one that slip at the most similar twists."""
    elements = sorted(_pairs(gear), key=lambda e: e[1] / e[0])
    slips = np.log([f / k for k, f in elements])
    first = int(np.argmin(np.diff(slips)))
    (k, f), (other_k, other_f) = elements[first : first + 2]
    elements[first : first + 2] = [(k + other_k, f + other_f)]
    return gear.replace(hysteresis=_maxwell(elements))


def _asked(loop: TorsionLoop, gear: Gear, friction_measured: bool) -> list[Beside]:
    """What the loop is asked for beside the spring."""
    if loop.single_branch:
        return [Nothing()]
    friction_inside = bool(np.any(loop.friction(gear))) and isinstance(gear.friction_input, Dry)
    return [Elements()] if friction_measured or not friction_inside else [Friction(), Elements()]


def _candidate(loop: TorsionLoop, gear: Gear, training: NDArray[np.bool_], spring: str, beside: Beside) -> TorsionCandidate:
    histories = [loop] if loop.single_branch else [loop, loop.virgin()]
    start = min((_start(gear, each, training, spring, beside) for each in histories), key=lambda start: start.error)
    twist_zero = loop.middle if spring == "linear" else loop.twist_zero
    experiment = replace(start.loop, torque_zero=start.torque_zero, twist_zero=twist_zero)
    return _finished(start.gear, experiment, training, spring, beside, gear)


def _finished(
    start: Gear, loop: TorsionLoop, training: NDArray[np.bool_], spring: str, beside: Beside, known: Gear
) -> TorsionCandidate:
    found = beside.finished(_refined(start, loop, training, beside), known)
    held_out = found.rms(held_out=True)[0]
    name = f"{spring.replace('_', '-')} spring{beside.words(found.gear)}"
    return TorsionCandidate(spring, beside, name, found, float(found.rms()[0] if np.isnan(held_out) else held_out))


def _refined(gear: Gear, loop: TorsionLoop, training: NDArray[np.bool_], beside: Beside) -> Fit:
    """The fit, without elements that the loop cannot tell from the spring or from nothing.

    An element that never slips within the loop is a linear spring, one that holds no torque is none, and two that slip at the
    same twist are one. One that slips before the loop can tell is given the least twist to slip at that it can.
    """
    half, span = half_span(loop), float(np.ptp(loop.torque))
    least = half * (SLIPS[0] if loop.input_ratio is None else 2.0 * PRESLIDING)
    stiff: set[int] = set()
    while True:
        free = [f"stiffness.{field['name']}" for field in gear.stiffness.fields] + beside.free(gear, stiff)
        found = _in_order(fit(gear, loop, free, training=training))
        fitted = beside.elements(found.gear)
        slipping = [(k, f) for k, f in fitted if NEGLIGIBLE * span < f < SLIPPING * half * k]
        if len(slipping) < len(fitted):
            spring = found.gear.stiffness
            assert isinstance(spring, Spring)
            spring = _stiffened(spring, sum(k for k, f in fitted if f >= SLIPPING * half * k))
            gear, stiff = gear.replace(stiffness=spring, hysteresis=_maxwell(slipping)), set()
        elif _alike(slipping):
            gear, stiff = _merged(found.gear), set()
        elif stiffer := {i for i, (k, f) in enumerate(fitted) if f < 0.999 * least * k}:
            stiff |= stiffer
            slower = [(f / least if i in stiff else k, f) for i, (k, f) in enumerate(fitted)]
            gear = found.gear.replace(hysteresis=_maxwell(slower))
        else:
            return found


def _pairs(gear: Gear) -> list[tuple[float, float]]:
    """Stiffness and breakaway of each Maxwell element of a gear."""
    elements = gear.hysteresis
    assert isinstance(elements, hysteresis.MaxwellSlip)
    return list(zip(elements.stiffness, elements.breakaway, strict=True))


def _maxwell(elements: Sequence[tuple[float, float]]) -> hysteresis.MaxwellSlip:
    """Maxwell elements of these stiffnesses and breakaways."""
    return hysteresis.MaxwellSlip(stiffness=[k for k, _ in elements], breakaway=[f for _, f in elements])


def _stiffened(spring: Spring, k: float) -> Spring:
    """A spring in parallel with a linear one of stiffness k."""
    if isinstance(spring, stiffness.Linear):
        return spring.replace(k=spring.k + k)
    if isinstance(spring, stiffness.Cubic):
        return spring.replace(a1=spring.a1 + k)
    knees = spring.twist(np.array([spring.t1, spring.t2]))
    t1, t2 = spring.t1 + k * float(knees[0]), spring.t2 + k * float(knees[1])
    return stiffness.ThreeSegment(k1=spring.k1 + k, k2=spring.k2 + k, k3=spring.k3 + k, t1=t1, t2=t2)


def _in_order(found: Fit) -> Fit:
    """The same curve with its knees in order: a second knee below the first is none."""
    spring = found.gear.stiffness
    if not isinstance(spring, stiffness.ThreeSegment) or spring.t2 >= spring.t1:
        return found
    ordered = stiffness.ThreeSegment(k1=spring.k1, k2=spring.k2, k3=spring.k3, t1=spring.t1, t2=spring.t1)
    return replace(found, model=found.gear.replace(stiffness=ordered))


Spring = stiffness.Linear | stiffness.Cubic | stiffness.ThreeSegment


# ---- What a loop is asked for beside the spring -----------------------------------------------------------------------


class Beside(ABC):
    """A part of the gear that is fitted beside the spring, or none."""

    @abstractmethod
    def words(self, gear: Gear) -> str:
        """For the name of the candidate."""

    @abstractmethod
    def known(self, loop: TorsionLoop, gear: Gear) -> Array:
        """Torque of the loop that is neither the spring's nor asked for [N.m], shape (n,)."""

    @abstractmethod
    def columns(self, loop: TorsionLoop, gear: Gear) -> Array:
        """What each positive parameter asked for contributes, shape (n, m)."""

    @abstractmethod
    def start(self, loop: TorsionLoop, gear: Gear, weights: Array) -> Gear:
        """The gear with these parameters."""

    @abstractmethod
    def free(self, gear: Gear, stiff: Collection[int]) -> list[str]:
        """Paths of the parameters asked for; of `stiff` Maxwell elements the breakaway alone."""

    def elements(self, gear: Gear) -> list[tuple[float, float]]:
        """Stiffness and breakaway of each Maxwell element asked for."""
        return []

    def finished(self, found: Fit, start: Gear) -> Fit:
        """The fit with what follows from the parameters asked for."""
        return found


class Elements(Beside):
    """Maxwell elements in place of the gear's hysteresis."""

    def words(self, gear: Gear) -> str:
        count = len(_pairs(gear))
        return f" with {count} Maxwell element{'s' if count != 1 else ''}"

    def known(self, loop: TorsionLoop, gear: Gear) -> Array:
        return loop.friction(gear)

    def columns(self, loop: TorsionLoop, gear: Gear) -> Array:
        return np.column_stack([_play(loop, slip) for slip in half_span(loop) * SLIPS])

    def start(self, loop: TorsionLoop, gear: Gear, weights: Array) -> Gear:
        return gear.replace(hysteresis=_elements(weights, half_span(loop) * SLIPS))

    def free(self, gear: Gear, stiff: Collection[int]) -> list[str]:
        count = range(len(_pairs(gear)))
        stiffnesses = [f"hysteresis.stiffness[{i}]" for i in count if i not in stiff]
        return stiffnesses + [f"hysteresis.breakaway[{i}]" for i in count]

    def elements(self, gear: Gear) -> list[tuple[float, float]]:
        return _pairs(gear)


class Nothing(Beside):
    """The spring alone; hysteresis and friction are as in the gear."""

    def words(self, gear: Gear) -> str:
        return ", hysteresis kept"

    def known(self, loop: TorsionLoop, gear: Gear) -> Array:
        return loop.friction(gear) + _kept_hysteresis(loop, gear)

    def columns(self, loop: TorsionLoop, gear: Gear) -> Array:
        return np.empty((len(loop.twist), 0))

    def start(self, loop: TorsionLoop, gear: Gear, weights: Array) -> Gear:
        return gear

    def free(self, gear: Gear, stiff: Collection[int]) -> list[str]:
        return []


class Friction(Beside):
    """Breakaway of the friction at the input, with the hysteresis of the gear; Coulomb's torque keeps its ratio to it."""

    def words(self, gear: Gear) -> str:
        return " with friction at the input, hysteresis kept"

    def known(self, loop: TorsionLoop, gear: Gear) -> Array:
        return _kept_hysteresis(loop, gear)

    def columns(self, loop: TorsionLoop, gear: Gear) -> Array:
        return (loop.friction(gear) / _dry(gear).breakaway)[:, np.newaxis]

    def start(self, loop: TorsionLoop, gear: Gear, weights: Array) -> Gear:
        # while it is fitted, breakaway must not meet Coulomb's torque, below which it does not count
        law = _dry(gear)
        breakaway = max(float(weights[0]), 1e-3 * law.breakaway)
        with warnings.catch_warnings(action="ignore", category=PassivityWarning):
            return gear.replace(friction_input=law.replace(coulomb=0.0, breakaway=breakaway))

    def free(self, gear: Gear, stiff: Collection[int]) -> list[str]:
        return ["friction_input.breakaway"]

    def finished(self, found: Fit, start: Gear) -> Fit:
        known, breakaway = _dry(start), _dry(found.gear).breakaway
        law = dissipating(known.replace(coulomb=known.coulomb / known.breakaway * breakaway, breakaway=breakaway))
        return replace(found, model=found.gear.replace(friction_input=law))


def _dry(gear: Gear) -> friction.Coulomb | friction.Stribeck | friction.LuGre:
    """The friction at the input, whose breakaway a loop can tell."""
    law = gear.friction_input
    assert isinstance(law, Dry)
    return law


def _kept_hysteresis(loop: TorsionLoop, gear: Gear) -> Array:
    return np.asarray(gear.hysteresis.trace(loop.path(0.0 if loop.single_branch else loop.middle))[-len(loop.twist) :])


# ---- Where the refinement starts --------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class _Start(ComparedByFields):
    """The convex problem's answer."""

    gear: Gear
    loop: TorsionLoop
    torque_zero: float
    error: float


def _start(gear: Gear, loop: TorsionLoop, training: NDArray[np.bool_], spring: str, beside: Beside) -> _Start:
    from scipy.optimize import nnls

    middle = 0.0 if loop.single_branch else loop.middle
    half = float(np.abs(loop.twist - middle).max())
    sought = loop.torque - beside.known(loop, gear)
    others = np.column_stack((beside.columns(loop, gear), _zero_columns(loop)))
    best: tuple[float, Array, tuple[float, ...]] | None = None
    for knees in _knees(spring, half):
        columns = np.column_stack((_spring_columns(spring, loop.twist - middle, half, knees), others))
        try:
            weights, residual = nnls(columns[training], sought[training])
        except RuntimeError:  # the active set cycles; other knees remain
            continue
        if best is None or residual < best[0]:
            best = float(residual), weights, knees
    if best is None:
        raise ValueError("no spring with Maxwell elements fits this loop")
    error, weights, knees = best
    of_spring = columns.shape[1] - others.shape[1]
    of_zeros = weights[len(weights) - _zero_columns(loop).shape[1] :]
    level = float(np.abs(loop.torque).max())
    started = beside.start(loop, gear, weights[of_spring : len(weights) - len(of_zeros)])
    return _Start(
        started.replace(stiffness=_spring(spring, weights[:of_spring], half, knees)),
        loop,
        level * float(of_zeros[0] - of_zeros[1]) if len(of_zeros) else 0.0,
        error,
    )


def half_span(loop: TorsionLoop) -> float:
    """Half of the twist that a loop goes through [rad]."""
    return 0.5 * float(np.ptp(loop.twist))


def _play(loop: TorsionLoop, slip: float) -> Array:
    """Torque of an element of unit stiffness that slips at `slip` [rad]."""
    element = hysteresis.MaxwellSlip(stiffness=[1.0], breakaway=[slip])
    return element.trace(loop.path(loop.middle))[-len(loop.twist) :]


def _zero_columns(loop: TorsionLoop) -> Array:
    """What a zero of the torque contributes, either way; nothing where it is known."""
    if loop.single_branch:
        return np.empty((len(loop.twist), 0))
    level = np.full(len(loop.twist), np.abs(loop.torque).max())
    return np.column_stack((level, -level))


def _knees(spring: str, half: float) -> Iterator[tuple[float, ...]]:
    if spring == "three_segment":
        yield from combinations(half * KNEES, 2)
    else:
        yield ()


def _spring_columns(spring: str, twist: Array, half: float, knees: tuple[float, ...]) -> Array:
    """What each positive parameter of a spring contributes; slopes may only grow from segment to segment."""
    if spring == "cubic":
        return np.column_stack((twist, half * (twist / half) ** 3))
    beyond = [np.sign(twist) * np.maximum(np.abs(twist) - knee, 0.0) for knee in knees]
    return np.column_stack((twist, *beyond))


def _spring(spring: str, weights: Array, half: float, knees: tuple[float, ...]) -> Spring:
    soft = max(float(weights[0]), 1e-6 * float(np.sum(weights)), 1e-9)
    if spring == "linear":
        return stiffness.Linear(k=soft)
    if spring == "cubic":
        return stiffness.Cubic(a1=soft, a3=float(weights[1]) / half**2)
    k2, k3 = soft + float(weights[1]), soft + float(weights[1] + weights[2])
    t1 = soft * knees[0]
    return stiffness.ThreeSegment(k1=soft, k2=k2, k3=k3, t1=t1, t2=t1 + k2 * (knees[1] - knees[0]))


def _elements(weights: Array, slips: Array) -> hysteresis.MaxwellSlip:
    """The elements that carry torque; neighbours on the grid are one element that slips between them."""
    elements: list[tuple[float, float]] = []
    last = -2
    for i in np.flatnonzero(weights * slips > 1e-3 * np.sum(weights * slips)).tolist():
        k, torque = float(weights[i]), float(weights[i] * slips[i])
        if i == last + 1:
            elements[-1] = elements[-1][0] + k, elements[-1][1] + torque
        else:
            elements.append((k, torque))
        last = i
    strongest = sorted(sorted(elements, key=lambda e: -e[1])[:MOST_ELEMENTS], key=lambda e: e[1] / e[0])
    return _maxwell(strongest)
