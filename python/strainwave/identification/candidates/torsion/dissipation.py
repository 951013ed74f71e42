"""Dissipation that is fitted to a loop together with the spring: Maxwell elements, friction at the input, or nothing."""

from __future__ import annotations

import warnings
from abc import ABC, abstractmethod
from collections.abc import Collection, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from strainwave import friction, hysteresis
from strainwave._core import Gear, PassivityWarning
from strainwave.identification.candidates.friction import dissipating
from strainwave.identification.candidates.torsion.library import Choice, Library
from strainwave.identification.experiments.torsion_loop import TorsionLoop
from strainwave.identification.fitting.fit import Fit

Array = NDArray[np.float64]
SLIPS = np.geomspace(5e-3, 0.85, 14)  # of half the span: twists of slip that are tried; no loop tried separates more
MAX_ELEMENTS = 6  # kept after the convex step
Dry = friction.Coulomb | friction.Stribeck | friction.LuGre  # friction whose breakaway a loop can determine


class Dissipation(ABC):
    """The dissipative part of the gear that is fitted together with the spring, or none."""

    whole_spring = False  # True for a part that is a spring, too, and takes its place
    is_slow = False  # True if its library takes long to build
    minima = 1  # count of initial values that are fitted

    @abstractmethod
    def words(self, gear: Gear) -> str:
        """Return its part of the name of the candidate."""

    def known(self, loop: TorsionLoop, gear: Gear) -> Array:
        """Return the torque of the loop that is not fitted [N.m], shape (n,)."""
        return loop.friction(gear)

    @abstractmethod
    def library(self, loop: TorsionLoop, gear: Gear) -> Library:
        """Return the torques that it can contribute to the loop."""

    @abstractmethod
    def free(self, gear: Gear, stiff: Collection[int] = ()) -> list[str]:
        """Return the paths of the fitted parameters; of `stiff` Maxwell elements the breakaway alone."""

    def elements(self, gear: Gear) -> list[tuple[float, float]]:
        """Return stiffness and breakaway of each fitted Maxwell element."""
        return []

    def finished(self, found: Fit, start: Gear) -> Fit:
        """Return the fit with the numbers that follow from the fitted parameters."""
        return found


class Elements(Dissipation):
    """Maxwell elements in place of the gear's hysteresis."""

    def words(self, gear: Gear) -> str:
        count = len(pairs(gear))
        return f" with {count} Maxwell element{'s' if count != 1 else ''}"

    def library(self, loop: TorsionLoop, gear: Gear) -> Library:
        """Return the torques of elements of unit stiffness."""
        path, slips = loop.path(loop.centre), half_span(loop) * SLIPS
        traces = [hysteresis.MaxwellSlip(stiffness=[1.0], breakaway=[slip]).trace(path) for slip in slips.tolist()]
        places = tuple(range(len(slips)))
        put = Choice(places, lambda g, weights: g.replace(hysteresis=_neighbours(weights, slips)))
        return Library.of([trace[loop.compared] for trace in traces], [put])

    def free(self, gear: Gear, stiff: Collection[int] = ()) -> list[str]:
        count = range(len(pairs(gear)))
        stiffnesses = [f"hysteresis.stiffness[{i}]" for i in count if i not in stiff]
        return stiffnesses + [f"hysteresis.breakaway[{i}]" for i in count]

    def elements(self, gear: Gear) -> list[tuple[float, float]]:
        return pairs(gear)


class Nothing(Dissipation):
    """The spring alone; hysteresis and friction are as in the gear."""

    def words(self, gear: Gear) -> str:
        return ", hysteresis kept"

    def known(self, loop: TorsionLoop, gear: Gear) -> Array:
        return loop.friction(gear) + _kept_hysteresis(loop, gear)

    def library(self, loop: TorsionLoop, gear: Gear) -> Library:
        return Library(np.empty((len(loop.twist), 0)), (Choice((), lambda g, weights: g),))

    def free(self, gear: Gear, stiff: Collection[int] = ()) -> list[str]:
        return []


class InputFriction(Dissipation):
    """Breakaway of the friction at the input, with the hysteresis of the gear; Coulomb's torque keeps its ratio to it."""

    def words(self, gear: Gear) -> str:
        return " with friction at the input, hysteresis kept"

    def known(self, loop: TorsionLoop, gear: Gear) -> Array:
        return _kept_hysteresis(loop, gear)

    def library(self, loop: TorsionLoop, gear: Gear) -> Library:
        return Library.of([loop.friction(gear) / _dry(gear).breakaway], [Choice((0,), self._put)])

    @staticmethod
    def _put(gear: Gear, weights: Array) -> Gear:
        # while it is fitted, breakaway must not meet Coulomb's torque, below which it does not count
        law = _dry(gear)
        breakaway = max(float(weights[0]), 1e-3 * law.breakaway)
        with warnings.catch_warnings(action="ignore", category=PassivityWarning):
            return gear.replace(friction_input=law.replace(coulomb=0.0, breakaway=breakaway))

    def free(self, gear: Gear, stiff: Collection[int] = ()) -> list[str]:
        return ["friction_input.breakaway"]

    def finished(self, found: Fit, start: Gear) -> Fit:
        known, breakaway = _dry(start), _dry(found.gear).breakaway
        law = dissipating(known.replace(coulomb=known.coulomb / known.breakaway * breakaway, breakaway=breakaway))
        return replace(found, model=found.gear.replace(friction_input=law))


def half_span(loop: TorsionLoop) -> float:
    """Return half of the range of the twist of a loop [rad]."""
    return 0.5 * float(np.ptp(loop.twist))


def pairs(gear: Gear) -> list[tuple[float, float]]:
    """Return stiffness and breakaway of each Maxwell element of a gear."""
    elements = gear.hysteresis
    assert isinstance(elements, hysteresis.MaxwellSlip)
    return list(zip(elements.stiffness, elements.breakaway, strict=True))


def maxwell(elements: Sequence[tuple[float, float]]) -> hysteresis.MaxwellSlip:
    """Return Maxwell elements of these stiffnesses and breakaways."""
    return hysteresis.MaxwellSlip(stiffness=[k for k, _ in elements], breakaway=[f for _, f in elements])


def _neighbours(weights: Array, slips: Array) -> hysteresis.MaxwellSlip:
    """Return the elements that carry torque; neighbours on the grid are one element that slips between them."""
    elements: list[tuple[float, float]] = []
    last = -2
    for i in np.flatnonzero(weights * slips > 1e-3 * np.sum(weights * slips)).tolist():
        k, torque = float(weights[i]), float(weights[i] * slips[i])
        if i == last + 1:
            elements[-1] = elements[-1][0] + k, elements[-1][1] + torque
        else:
            elements.append((k, torque))
        last = i
    strongest = sorted(sorted(elements, key=lambda e: -e[1])[:MAX_ELEMENTS], key=lambda e: e[1] / e[0])
    return maxwell(strongest)


def _dry(gear: Gear) -> friction.Coulomb | friction.Stribeck | friction.LuGre:
    """Return the friction at the input, whose breakaway a loop can determine."""
    law = gear.friction_input
    assert isinstance(law, Dry)
    return law


def _kept_hysteresis(loop: TorsionLoop, gear: Gear) -> Array:
    return np.asarray(gear.hysteresis.trace(loop.path(0.0 if loop.single_branch else loop.centre))[loop.compared])
