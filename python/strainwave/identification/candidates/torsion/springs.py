"""Kinds of spring that a loop may show, each with what it starts from: linear in positive weights, its knees tried."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations, product

import numpy as np
from numpy.typing import NDArray

from strainwave import stiffness
from strainwave._core import Gear
from strainwave.identification.candidates.torsion.library import Choice, Library

Array = NDArray[np.float64]
Part = stiffness.Linear | stiffness.Cubic | stiffness.Piecewise | stiffness.ThreeSegment | stiffness.MultiCompliance
Spring = Part | stiffness.Backlash
KNEES = np.array([*np.arange(0.1, 1.0, 0.1), 0.95, 0.988])  # of half the span: tried for the knees of a spring
CLEARANCES = np.array(
    [0.02, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.65, 0.8, 1.2]
)  # of half the span: tried for a play from flank to flank
SHARES = (0.2, 0.5, 0.8)  # of the compliance at zero torque: tried for the wave generator's
HARDENINGS = (0.1, 1.0, 4.0)  # per the torque at half the span: tried for flexspline and wave generator
NEGLIGIBLE = 1e-6  # of the secant stiffness: a spring that stands for none


class Kind(ABC):
    """A kind of spring."""

    name: str
    words: str
    minima = 1  # of least squares: from how many starts they are sought

    @abstractmethod
    def library(self, twist: Array, half: float, gear: Gear) -> Library:
        """What it can add to the torque along a twist from its zero [rad], shape (n,), that reaches about `half` either way."""

    def free(self, gear: Gear) -> list[str]:
        """Paths of its numbers."""
        return [f"stiffness.{field['name']}" for field in gear.stiffness.fields]

    def stiffened(self, spring: Spring, k: float) -> Spring:
        """The spring in parallel with a linear one of stiffness k, if that is of the same kind; else the spring itself."""
        return spring

    def in_order(self, spring: Spring) -> Spring:
        """The same curve, its knees in order."""
        return spring

    @property
    def knows_zero(self) -> bool:
        """True if its curve determines where the twist is zero."""
        return True


class Linear(Kind):
    name, words = "linear", "linear spring"

    def library(self, twist: Array, half: float, gear: Gear) -> Library:
        return Library.of([twist], [Choice((0,), lambda g, w: g.replace(stiffness=stiffness.Linear(k=_soft(w))))])

    def stiffened(self, spring: Spring, k: float) -> Spring:
        assert isinstance(spring, stiffness.Linear)
        return spring.replace(k=spring.k + k)

    @property
    def knows_zero(self) -> bool:
        return False


class Cubic(Kind):
    name, words = "cubic", "cubic spring"

    def library(self, twist: Array, half: float, gear: Gear) -> Library:
        def put(g: Gear, w: Array) -> Gear:
            return g.replace(stiffness=stiffness.Cubic(a1=_soft(w), a3=float(w[1]) / half**2))

        return Library.of([twist, half * (twist / half) ** 3], [Choice((0, 1), put)])

    def stiffened(self, spring: Spring, k: float) -> Spring:
        assert isinstance(spring, stiffness.Cubic)
        return spring.replace(a1=spring.a1 + k)


class Piecewise(Kind):
    name, words = "piecewise", "piecewise spring"

    def library(self, twist: Array, half: float, gear: Gear) -> Library:
        def choice(place: int, knee: float) -> Choice:
            def put(g: Gear, w: Array) -> Gear:
                return g.replace(stiffness=stiffness.Piecewise(k1=_soft(w), k2=float(w[1]), knee=knee))

            return Choice((0, 1 + place), put)

        knees = (half * KNEES).tolist()
        return Library.of([twist, *_beyond(twist, knees)], [choice(place, knee) for place, knee in enumerate(knees)])

    def stiffened(self, spring: Spring, k: float) -> Spring:
        assert isinstance(spring, stiffness.Piecewise)
        return spring.replace(k1=spring.k1 + k)


class ThreeSegment(Kind):
    """Slopes may only grow from segment to segment at the start; a fit may end elsewhere."""

    name, words = "three_segment", "three-segment spring"

    def library(self, twist: Array, half: float, gear: Gear) -> Library:
        knees = (half * KNEES).tolist()

        def choice(first: int, second: int) -> Choice:
            def put(g: Gear, w: Array) -> Gear:
                k1 = _soft(w)
                k2, k3 = k1 + float(w[1]), k1 + float(w[1] + w[2])
                t1 = k1 * knees[first]
                t2 = t1 + k2 * (knees[second] - knees[first])
                return g.replace(stiffness=stiffness.ThreeSegment(k1=k1, k2=k2, k3=k3, t1=t1, t2=t2))

            return Choice((0, 1 + first, 1 + second), put)

        places = combinations(range(len(knees)), 2)
        return Library.of([twist, *_beyond(twist, knees)], [choice(*both) for both in places])

    def stiffened(self, spring: Spring, k: float) -> Spring:
        assert isinstance(spring, stiffness.ThreeSegment)
        knees = spring.twist(np.array([spring.t1, spring.t2]))
        t1, t2 = spring.t1 + k * float(knees[0]), spring.t2 + k * float(knees[1])
        return stiffness.ThreeSegment(k1=spring.k1 + k, k2=spring.k2 + k, k3=spring.k3 + k, t1=t1, t2=t2)

    def in_order(self, spring: Spring) -> Spring:
        """A second knee below the first is none."""
        assert isinstance(spring, stiffness.ThreeSegment)
        if spring.t2 >= spring.t1:
            return spring
        return stiffness.ThreeSegment(k1=spring.k1, k2=spring.k2, k3=spring.k3, t1=spring.t1, t2=spring.t1)


class MultiCompliance(Kind):
    """Its torque is linear in a factor of both stiffnesses that divides both hardenings; all else is tried."""

    name, words = "multi_compliance", "multi-compliance spring"
    minima = 4

    def library(self, twist: Array, half: float, gear: Gear) -> Library:
        ratio = abs(gear.kinematics.ratio)
        shapes = [unit_compliance(half, ratio, *shape) for shape in product(SHARES, HARDENINGS, HARDENINGS)]
        inside = [shape for shape in shapes if np.isfinite(_torque(shape, twist)).all()]

        def choice(place: int, unit: stiffness.MultiCompliance) -> Choice:
            return Choice((place,), lambda g, w: g.replace(stiffness=scaled(unit, float(w[0]))), place)

        return Library.of(
            [_torque(shape, twist) for shape in inside], [choice(place, unit) for place, unit in enumerate(inside)]
        )

    def free(self, gear: Gear) -> list[str]:
        return [path for path in super().free(gear) if not path.endswith("reduction")]


@dataclass(frozen=True)
class Backlash(Kind):
    """Play before a spring of another kind."""

    law: Kind
    minima = 6

    @property
    def name(self) -> str:  # type: ignore[override]
        return f"backlash_{self.law.name}"

    @property
    def words(self) -> str:  # type: ignore[override]
        return f"{self.law.words} behind play"

    def library(self, twist: Array, half: float, gear: Gear) -> Library:
        torques: list[Array] = []
        choices: list[Choice] = []
        first = 0
        for clearance in (half * CLEARANCES).tolist():
            behind = twist - np.clip(twist, -0.5 * clearance, 0.5 * clearance)
            law = self.law.library(behind, half - 0.5 * clearance, gear)
            choices += [_behind_play(choice, clearance, first) for choice in law.choices]
            torques.append(law.torques)
            first += law.torques.shape[1]
        return Library.of(torques, choices)

    def free(self, gear: Gear) -> list[str]:
        spring = gear.stiffness
        assert isinstance(spring, stiffness.Backlash)
        of_law = self.law.free(gear.replace(stiffness=spring.law))
        return ["stiffness.clearance", *(path.replace("stiffness.", "stiffness.law.", 1) for path in of_law)]

    def in_order(self, spring: Spring) -> Spring:
        assert isinstance(spring, stiffness.Backlash)
        law = self.law.in_order(spring.law)
        assert not isinstance(law, stiffness.Backlash)
        return spring if law is spring.law else spring.replace(law=law)


def _behind_play(choice: Choice, clearance: float, first: int) -> Choice:
    def put(gear: Gear, weights: Array) -> Gear:
        law = choice.put(gear, weights).stiffness
        assert not isinstance(law, stiffness.Backlash)
        return gear.replace(stiffness=stiffness.Backlash(law=law, clearance=clearance))

    return Choice(tuple(first + column for column in choice.columns), put, clearance)


class Negligible(Kind):
    """No spring: the hysteresis is a whole spring by itself."""

    name, words = "none", "no spring"

    def library(self, twist: Array, half: float, gear: Gear) -> Library:
        return Library(np.empty((len(twist), 0)), (Choice((), lambda g, w: g),))

    def free(self, gear: Gear) -> list[str]:
        return []


LINEAR, CUBIC, PIECEWISE, THREE_SEGMENT, MULTI_COMPLIANCE = Linear(), Cubic(), Piecewise(), ThreeSegment(), MultiCompliance()
PLAIN = (LINEAR, CUBIC, PIECEWISE, THREE_SEGMENT, MULTI_COMPLIANCE)
KINDS: tuple[Kind, ...] = (*PLAIN, *(Backlash(kind) for kind in PLAIN))


def unit_compliance(
    half: float, ratio: float, share: float, flexspline: float, wave_generator: float
) -> stiffness.MultiCompliance:
    """Flexspline and wave generator that twist by `half` [rad] under 1 N.m.

    Args:
        half: that twist [rad]
        ratio: of the gear, without its sign
        share: of the compliance at zero torque that is the wave generator's
        flexspline: its hardening per that torque
        wave_generator: its hardening per that torque, at the output's scale
    """
    flexed = (1.0 - share) * np.arctan(flexspline) / flexspline
    wound = share * -np.expm1(-wave_generator) / wave_generator
    softness = half / (flexed + wound)
    return stiffness.MultiCompliance(
        flexspline_stiffness=1.0 / ((1.0 - share) * softness),
        flexspline_hardening=flexspline,
        wave_generator_stiffness=1.0 / (share * softness * ratio**2),
        wave_generator_hardening=wave_generator * ratio,
        reduction=ratio,
    )


def scaled(unit: stiffness.MultiCompliance, torque: float) -> stiffness.MultiCompliance:
    """That twists as far under so many times the torque."""
    factor = max(torque, 1e-9)
    return unit.replace(
        flexspline_stiffness=factor * unit.flexspline_stiffness,
        flexspline_hardening=unit.flexspline_hardening / factor,
        wave_generator_stiffness=factor * unit.wave_generator_stiffness,
        wave_generator_hardening=unit.wave_generator_hardening / factor,
    )


def _torque(spring: stiffness.MultiCompliance, twist: Array) -> Array:
    try:
        return np.asarray(spring.torque(twist))
    except ValueError:  # beyond its bound
        return np.full(len(twist), np.nan)


def _beyond(twist: Array, knees: Sequence[float]) -> list[Array]:
    return [np.sign(twist) * np.maximum(np.abs(twist) - knee, 0.0) for knee in knees]


def _soft(weights: Array) -> float:
    """A stiffness that is not zero, whatever the weights."""
    return max(float(weights[0]), NEGLIGIBLE * float(np.sum(weights)), 1e-9)
