"""Dissipation that is fitted to a loop together with the spring: Maxwell elements, friction at the input, or another law.

Each law of hysteresis is linear in a factor of its torques at constant twists: convex problems find the best initial values of
a table of twists and exponents, as those of the spring.
"""

from __future__ import annotations

import warnings
from abc import ABC, abstractmethod
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import combinations, product

import numpy as np
from numpy.typing import NDArray

from strainwave import friction, hysteresis, stiffness
from strainwave._core import Gear, PassivityWarning
from strainwave.identification.candidates.friction import dissipating
from strainwave.identification.candidates.torsion.springs import MIN_STIFFNESS_SHARE, Choice, Library, scaled, unit_compliance
from strainwave.identification.experiments.torsion_loop import TorsionLoop
from strainwave.identification.fitting.fit import Fit

Array = NDArray[np.float64]
TRIED_SLIPS = np.geomspace(5e-3, 0.85, 14)  # of half the span: twists of slip that are tried; no loop tried separates more
MAX_LOOP_ELEMENTS = 6  # kept after the convex step
Dry = friction.Coulomb | friction.Stribeck | friction.LuGre  # friction whose breakaway a loop can determine
Law = (
    hysteresis.FadingMemory
    | hysteresis.BoucWen
    | hysteresis.Preisach
    | hysteresis.Regimes
    | hysteresis.FrictionalWindup
    | hysteresis.MaxwellSlip
)
MIN_TORQUE = 1e-9  # N.m: a law without torque has no shape


class Dissipation(ABC):
    """The dissipative part of the gear that is fitted together with the spring, or none."""

    whole_spring = False  # True for a part that is a spring, too, and takes its place
    is_slow = False  # True if its library takes long to build
    minima = 1  # count of initial values that are fitted
    name = ""  # its part of the name of the candidate
    numbers: tuple[str, ...] = ()  # paths of the fitted parameters

    def words(self, gear: Gear) -> str:
        """Return its part of the name of the candidate."""
        return self.name

    def known(self, loop: TorsionLoop, gear: Gear) -> Array:
        """Return the torque of the loop that is not fitted [N.m], shape (n,)."""
        return loop.friction(gear)

    @abstractmethod
    def library(self, loop: TorsionLoop, gear: Gear) -> Library:
        """Return the torques that it can contribute to the loop."""

    def free(self, gear: Gear, stiff: Collection[int] = ()) -> list[str]:
        """Return the paths of the fitted parameters; of `stiff` Maxwell elements the breakaway alone."""
        return [*self.numbers]

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
        slips = half_span(loop) * TRIED_SLIPS
        traces = unit_traces(loop.path(loop.centre), slips)
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

    name = ", hysteresis kept"

    def known(self, loop: TorsionLoop, gear: Gear) -> Array:
        return loop.friction(gear) + _kept_hysteresis(loop, gear)

    def library(self, loop: TorsionLoop, gear: Gear) -> Library:
        return Library(np.empty((len(loop.twist), 0)), (Choice((), lambda g, weights: g),))


class InputFriction(Dissipation):
    """Breakaway of the friction at the input, with the hysteresis of the gear; Coulomb's torque keeps its ratio to it."""

    name = " with friction at the input, hysteresis kept"
    numbers = ("friction_input.breakaway",)

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

    def finished(self, found: Fit, start: Gear) -> Fit:
        known, breakaway = _dry(start), _dry(found.gear).breakaway
        law = dissipating(known.replace(coulomb=known.coulomb / known.breakaway * breakaway, breakaway=breakaway))
        return replace(found, model=found.gear.replace(friction_input=law))


def half_span(loop: TorsionLoop) -> float:
    """Return half of the range of the twist of a loop [rad]."""
    return 0.5 * float(np.ptp(loop.twist))


def unit_traces(path: Array, slips: Array) -> list[Array]:
    """Return the torques along a path of Maxwell elements of stiffness 1, one for each twist of slip."""
    return [np.asarray(hysteresis.MaxwellSlip(stiffness=[1.0], breakaway=[slip]).trace(path)) for slip in slips.tolist()]


def pairs(gear: Gear) -> list[tuple[float, float]]:
    """Return stiffness and breakaway of each Maxwell element of a gear."""
    elements = gear.hysteresis
    assert isinstance(elements, hysteresis.MaxwellSlip)
    return list(zip(elements.stiffness, elements.breakaway, strict=True))


def maxwell(elements: Sequence[tuple[float, float]]) -> hysteresis.MaxwellSlip:
    """Return Maxwell elements of these stiffnesses and breakaways, in the order in which they slip."""
    in_order = sorted(elements, key=lambda element: element[1] / max(element[0], 1e-300))
    return hysteresis.MaxwellSlip(stiffness=[k for k, _ in in_order], breakaway=[f for _, f in in_order])


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
    strongest = sorted(sorted(elements, key=lambda e: -e[1])[:MAX_LOOP_ELEMENTS], key=lambda e: e[1] / e[0])
    return maxwell(strongest)


def _dry(gear: Gear) -> friction.Coulomb | friction.Stribeck | friction.LuGre:
    """Return the friction at the input, whose breakaway a loop can determine."""
    law = gear.friction_input
    assert isinstance(law, Dry)
    return law


def _kept_hysteresis(loop: TorsionLoop, gear: Gear) -> Array:
    return np.asarray(gear.hysteresis.trace(loop.path(0.0 if loop.single_branch else loop.centre))[loop.compared])


# ---- Other laws of hysteresis ----------------------------------------------------------------------------------------


class Without(Dissipation):
    """No hysteresis at all: an elastic gear."""

    name = " without hysteresis"

    def library(self, loop: TorsionLoop, gear: Gear) -> Library:
        none = hysteresis.MaxwellSlip(stiffness=[], breakaway=[])
        return Library(np.empty((len(loop.twist), 0)), (Choice((), lambda g, weights: g.replace(hysteresis=none)),))


@dataclass(frozen=True)
class FadingMemory(Dissipation):
    """A count of branches that forget. The torque of each is linear in its stiffness."""

    branches: int
    numbers = ("hysteresis.stiffness", "hysteresis.forgetting")
    rates = np.geomspace(0.3, 100.0, 16)  # per half the span, of forgetting, tried

    def words(self, gear: Gear) -> str:
        return f" with fading memory of {self.branches} branch{'es' if self.branches > 1 else ''}"

    def library(self, loop: TorsionLoop, gear: Gear) -> Library:
        rates = (self.rates / half_span(loop)).tolist()

        def choice(places: tuple[int, ...]) -> Choice:
            def put(g: Gear, weights: Array) -> Gear:
                least = MIN_STIFFNESS_SHARE * float(weights.sum()) + MIN_TORQUE
                stiffnesses = [max(float(weight), least) for weight in weights]
                law = hysteresis.FadingMemory(stiffness=stiffnesses, forgetting=[rates[place] for place in places])
                return g.replace(hysteresis=law)

            return Choice(places, put)

        units = [hysteresis.FadingMemory(stiffness=[1.0], forgetting=[rate]) for rate in rates]
        places = combinations(range(len(rates)), self.branches)
        return Library.of([_traced(unit, loop) for unit in units], [choice(each) for each in places])


class Scaled(Dissipation):
    """A law whose torque has a factor; its other numbers are tried."""

    is_slow = True
    minima = 4

    def library(self, loop: TorsionLoop, gear: Gear) -> Library:
        laws = [*self.units(loop, gear)]
        tried = [(law, torque) for law in laws if np.isfinite(torque := _traced(law, loop)).all()]

        def choice(place: int, law: Law) -> Choice:
            return Choice((place,), lambda g, weights: self.put(g, law, max(float(weights[0]), MIN_TORQUE)), place)

        return Library.of([torque for _, torque in tried], [choice(place, law) for place, (law, _) in enumerate(tried)])

    @abstractmethod
    def units(self, loop: TorsionLoop, gear: Gear) -> Iterator[Law]:
        """Yield laws to try, of about unit torque."""

    @abstractmethod
    def put(self, gear: Gear, law: Law, factor: float) -> Gear:
        """Return the gear with a multiple of the law."""


class BoucWen(Scaled):
    """Bouc and Wen's law. Its twist is the reach, saturation over stiffness."""

    name = " with Bouc and Wen's hysteresis"
    numbers = ("hysteresis.stiffness", "hysteresis.saturation", "hysteresis.sharpness", "hysteresis.shape")

    def units(self, loop: TorsionLoop, gear: Gear) -> Iterator[Law]:
        for reach, sharpness, shape in product(np.geomspace(0.02, 1.0, 7), (1.2, 2.5, 6.0), (0.55, 0.75, 0.95)):
            stiff = 1.0 / (float(reach) * half_span(loop))
            yield hysteresis.BoucWen(stiffness=stiff, saturation=1.0, sharpness=sharpness, shape=shape)

    def put(self, gear: Gear, law: Law, factor: float) -> Gear:
        assert isinstance(law, hysteresis.BoucWen)
        return gear.replace(hysteresis=law.replace(stiffness=factor * law.stiffness, saturation=factor))


class Preisach(Scaled):
    """Preisach's law of a density that falls as a power."""

    name = " with Preisach's hysteresis of a power density"
    numbers = ("hysteresis.density.limit", "hysteresis.density.saturation", "hysteresis.density.exponent")

    def units(self, loop: TorsionLoop, gear: Gear) -> Iterator[Law]:
        for limit, exponent in product((0.3, 0.45, 0.6, 0.75, 0.9, 1.05, 1.5, 3.0), (1.3, 2.0, 4.0, 8.0)):
            density = hysteresis.PowerDensity(limit=limit * half_span(loop), saturation=1.0, exponent=exponent)
            yield hysteresis.Preisach(density=density)

    def put(self, gear: Gear, law: Law, factor: float) -> Gear:
        assert isinstance(law, hysteresis.Preisach)
        assert isinstance(law.density, hysteresis.PowerDensity)
        return gear.replace(hysteresis=law.replace(density=law.density.replace(saturation=factor)))


class Regimes(Scaled):
    """A stiffness for each regime, tried with equal regimes in both senses: lost motion from the width of the loop."""

    whole_spring = True
    name = "a stiffness for each of four regimes"

    def units(self, loop: TorsionLoop, gear: Gear) -> Iterator[Law]:
        half = half_span(loop)
        for unloading, loading, onset, width in product((1.3, 2.0, 4.0, 8.0), (0.3, 0.7), (0.02, 0.1), (0.1, 0.4, 1.2)):
            yield hysteresis.Regimes(
                positive_unloading=unloading / half,
                negative_unloading=unloading / half,
                positive_loading=loading / half,
                negative_loading=loading / half,
                onset=onset,
                lost_motion=width * half,
            )

    def put(self, gear: Gear, law: Law, factor: float) -> Gear:
        names = ("positive_unloading", "negative_unloading", "positive_loading", "negative_loading", "onset")
        return _alone(gear, law.replace(**{name: factor * getattr(law, name) for name in names}), factor)

    def free(self, gear: Gear, stiff: Collection[int] = ()) -> list[str]:
        return [f"hysteresis.{field['name']}" for field in gear.hysteresis.fields]


class FrictionalWindup(Scaled):
    """Flexspline and wave generator as springs in series, and friction between them."""

    whole_spring = True
    name = "friction inside multi-compliance"
    numbers = (
        "hysteresis.springs.flexspline_stiffness",
        "hysteresis.springs.flexspline_hardening",
        "hysteresis.springs.wave_generator_stiffness",
        "hysteresis.springs.wave_generator_hardening",
        "hysteresis.friction",
    )

    def units(self, loop: TorsionLoop, gear: Gear) -> Iterator[Law]:
        half, ratio = half_span(loop), abs(gear.kinematics.ratio)
        for share, flexspline, wave_generator, dry in product((0.2, 0.5, 0.8), (0.1, 1.0), (0.1, 1.0), (0.02, 0.1, 0.3)):
            springs = unit_compliance(half, ratio, share, flexspline, wave_generator)
            yield hysteresis.FrictionalWindup(springs=springs, friction=dry)

    def put(self, gear: Gear, law: Law, factor: float) -> Gear:
        assert isinstance(law, hysteresis.FrictionalWindup)
        law = law.replace(springs=scaled(law.springs, factor), friction=factor * law.friction)
        return _alone(gear, law, factor)


WHOLE: tuple[Dissipation, ...] = (Regimes(), FrictionalWindup())
WITH_A_SPRING: tuple[Dissipation, ...] = (Without(), FadingMemory(1), FadingMemory(2), BoucWen(), Preisach())


def _alone(gear: Gear, law: Law, factor: float) -> Gear:
    """Return the gear with a law that is its whole spring, and a linear spring of negligible stiffness."""
    return gear.replace(stiffness=stiffness.Linear(k=MIN_STIFFNESS_SHARE * factor), hysteresis=law)


def _traced(law: Law, loop: TorsionLoop) -> Array:
    try:
        return np.asarray(law.trace(loop.path(loop.centre))[loop.compared])
    except ValueError:  # beyond the bound of its springs
        return np.full(len(loop.twist), np.nan)
