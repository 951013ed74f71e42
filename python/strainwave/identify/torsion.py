"""Torsion loops: spring and Maxwell-slip hysteresis from torque over twist.

With slip twists chosen beforehand the loop is linear in the stiffnesses, all of which are positive: a convex problem with one
answer (non-negative least squares), which needs no starting values. It finds how many elements the loop can tell apart;
exact derivatives then refine stiffness, breakaway and the spring together.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from strainwave import hysteresis, stiffness
from strainwave._core import Gear
from strainwave.identify.experiment import TorsionLoop
from strainwave.identify.fit import Fit, fit

Array = NDArray[np.float64]

SLIP_TWISTS = 14  # on a logarithmic grid; more cannot be told apart in any loop tried
KNEES = 1.0 - np.geomspace(0.9, 0.012, 9)  # of half the span: places tried for the knees of a three-segment spring
MOST_ELEMENTS = 6  # kept after the convex step
NEGLIGIBLE = 1e-3  # of the span of the torque: smaller differences in error do not justify another parameter
SPRINGS = ("linear", "cubic", "three_segment")


@dataclass(frozen=True)
class Candidate:
    """One kind of gear fitted to a loop.

    Attributes:
        name: its spring and the number of Maxwell elements
        fit: the fit, of a gear with that spring and hysteresis
        error: rms of the residuals on the samples kept back [N.m]; on all, where none were
    """

    name: str
    fit: Fit
    error: float


def kept_back(n: int, blocks: int = 20, every: int = 4) -> NDArray[np.bool_]:
    """Samples that train: all but every fourth of twenty blocks, which are kept back to validate.

    Whole blocks, because neighbours on a loop resemble each other too much to test one by the other.
    """
    block = np.arange(n) * blocks // n
    training: NDArray[np.bool_] = block % every != every - 1
    return training


def fit_loop(loop: TorsionLoop, gear: Gear, training: NDArray[np.bool_] | None = None) -> list[Candidate]:
    """Fits each kind of spring, in parallel with Maxwell-slip hysteresis, to a loop.

    Args:
        loop: measured torque over twist
        gear: the gear to start from; its spring and hysteresis are replaced, the rest is kept
        training: samples that take part, shape (n,); the rest validates

    Returns:
        candidates, best first by the error on data kept back; of those within 5 % of it, or
        within a thousandth of the span of the torque, the one with the fewest parameters

    Raises:
        ValueError: too few samples for any candidate
    """
    chosen = np.ones(len(loop.twist), bool) if training is None else training
    candidates = [_candidate(loop, gear, chosen, spring) for spring in SPRINGS]
    good = 1.05 * min(candidate.error for candidate in candidates) + NEGLIGIBLE * float(np.ptp(loop.torque))
    return sorted(candidates, key=lambda c: (c.error > good, len(c.fit.estimates) if c.error <= good else c.error))


def _candidate(loop: TorsionLoop, gear: Gear, training: NDArray[np.bool_], spring: str) -> Candidate:
    starts = [_start(gear, each, training, spring) for each in (loop, loop.virgin())]
    start = min(starts, key=lambda s: s.error)
    twist_zero = loop.middle if spring == "linear" else None
    experiment = replace(start.loop, torque_zero=start.torque_zero, twist_zero=twist_zero)
    found = _refined(start, experiment, training)
    held_out = found.rms(held_out=True)[0]
    return Candidate(_name(spring, found.gear), found, float(found.rms()[0] if np.isnan(held_out) else held_out))


def _refined(start: _Start, loop: TorsionLoop, training: NDArray[np.bool_]) -> Fit:
    """The fit, without elements that the loop cannot tell from the spring or from nothing.

    An element that never slips within the loop is a linear spring, and one that holds no torque is none.
    """
    spring, elements = start.spring, start.hysteresis
    half, span = 0.5 * float(np.ptp(loop.twist)), float(np.ptp(loop.torque))
    while True:
        free = [f"stiffness.{field['name']}" for field in spring.fields]
        free += ["hysteresis.stiffness", "hysteresis.breakaway"] if elements.stiffness else []
        found = _in_order(fit(start.gear.replace(stiffness=spring, hysteresis=elements), loop, free, training=training))
        fitted = _pairs(found.gear)
        slipping = [(k, f) for k, f in fitted if NEGLIGIBLE * span < f < 0.99 * half * k]
        if len(slipping) == len(fitted):
            return found
        assert isinstance(found.gear.stiffness, Spring)
        spring = _stiffened(found.gear.stiffness, sum(k for k, f in fitted if f >= 0.99 * half * k))
        elements = hysteresis.MaxwellSlip(stiffness=[k for k, _ in slipping], breakaway=[f for _, f in slipping])


def _pairs(gear: Gear) -> list[tuple[float, float]]:
    """Stiffness and breakaway of each Maxwell element of a gear."""
    elements = gear.hysteresis
    assert isinstance(elements, hysteresis.MaxwellSlip)
    return list(zip(elements.stiffness, elements.breakaway, strict=True))


def _stiffened(spring: Spring, k: float) -> Spring:
    """A spring in parallel with a linear one of stiffness k."""
    if isinstance(spring, stiffness.Linear):
        return spring.replace(k=spring.k + k)
    if isinstance(spring, stiffness.Cubic):
        return spring.replace(a1=spring.a1 + k)
    knees = spring.twist(np.array([spring.t1, spring.t2]))
    t1, t2 = spring.t1 + k * float(knees[0]), spring.t2 + k * float(knees[1])
    return stiffness.ThreeSegment(k1=spring.k1 + k, k2=spring.k2 + k, k3=spring.k3 + k, t1=t1, t2=t2)


def _name(spring: str, gear: Gear) -> str:
    count = len(_pairs(gear))
    return f"{spring.replace('_', '-')} spring with {count} Maxwell element{'s' if count != 1 else ''}"


def _in_order(found: Fit) -> Fit:
    """The same curve with its knees in order: a second knee below the first is none."""
    spring = found.gear.stiffness
    if not isinstance(spring, stiffness.ThreeSegment) or spring.t2 >= spring.t1:
        return found
    ordered = stiffness.ThreeSegment(k1=spring.k1, k2=spring.k2, k3=spring.k3, t1=spring.t1, t2=spring.t1)
    return replace(found, model=found.gear.replace(stiffness=ordered))


Spring = stiffness.Linear | stiffness.Cubic | stiffness.ThreeSegment


@dataclass(frozen=True)
class _Start:
    """Where the refinement starts: the convex problem's answer."""

    gear: Gear
    loop: TorsionLoop
    spring: Spring
    hysteresis: hysteresis.MaxwellSlip
    torque_zero: float
    error: float


def _start(gear: Gear, loop: TorsionLoop, training: NDArray[np.bool_], spring: str) -> _Start:
    from scipy.optimize import nnls

    half = 0.5 * float(np.ptp(loop.twist))
    slips = half * np.geomspace(5e-3, 0.95, SLIP_TWISTS)
    plays = np.column_stack([_play(loop, slip) for slip in slips])
    best: tuple[float, Array, tuple[float, ...]] | None = None
    for knees in _knees(spring, half):
        columns = np.column_stack((_spring_columns(spring, loop.twist - loop.middle, half, knees), plays, _zero_columns(loop)))
        try:
            weights, residual = nnls(columns[training], loop.torque[training])
        except RuntimeError:  # the active set cycles; other knees remain
            continue
        if best is None or residual < best[0]:
            best = float(residual), weights, knees
    if best is None:
        raise ValueError("no spring with Maxwell elements fits this loop")
    error, weights, knees = best
    count = columns.shape[1] - len(slips) - 2
    torque_zero = float(np.abs(loop.torque).max() * (weights[-2] - weights[-1]))
    return _Start(
        gear,
        loop,
        _spring(spring, weights[:count], half, knees),
        _elements(weights[count:-2], slips),
        torque_zero,
        error,
    )


def _play(loop: TorsionLoop, slip: float) -> Array:
    """Torque of an element of unit stiffness that slips at `slip` [rad]."""
    element = hysteresis.MaxwellSlip(stiffness=[1.0], breakaway=[slip])
    return element.trace(loop.path(loop.middle))[-len(loop.twist) :]


def _zero_columns(loop: TorsionLoop) -> Array:
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
    return hysteresis.MaxwellSlip(stiffness=[k for k, _ in strongest], breakaway=[f for _, f in strongest])
