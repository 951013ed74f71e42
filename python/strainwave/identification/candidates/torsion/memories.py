"""Laws of hysteresis of a loop other than Maxwell-slip, each with its initial values.

Each of them is linear in a factor of its torques at constant twists: convex problems find the best initial values of a table of
twists and exponents, as those of the spring.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Collection, Iterator
from dataclasses import dataclass
from itertools import combinations, product

import numpy as np
from numpy.typing import NDArray

from strainwave import hysteresis, stiffness
from strainwave._core import Gear
from strainwave.identification.candidates.torsion.dissipation import Dissipation, half_span
from strainwave.identification.candidates.torsion.library import Choice, Library
from strainwave.identification.candidates.torsion.springs import MIN_STIFFNESS_SHARE, scaled, unit_compliance
from strainwave.identification.experiments.torsion_loop import TorsionLoop

Array = NDArray[np.float64]
Law = (
    hysteresis.FadingMemory
    | hysteresis.BoucWen
    | hysteresis.Preisach
    | hysteresis.Regimes
    | hysteresis.FrictionalWindup
    | hysteresis.MaxwellSlip
)
MIN_TORQUE = 1e-9  # N.m: a law without torque has no shape


class Without(Dissipation):
    """No hysteresis at all: an elastic gear."""

    def words(self, gear: Gear) -> str:
        return " without hysteresis"

    def library(self, loop: TorsionLoop, gear: Gear) -> Library:
        none = hysteresis.MaxwellSlip(stiffness=[], breakaway=[])
        return Library(np.empty((len(loop.twist), 0)), (Choice((), lambda g, weights: g.replace(hysteresis=none)),))

    def free(self, gear: Gear, stiff: Collection[int] = ()) -> list[str]:
        return []


@dataclass(frozen=True)
class FadingMemory(Dissipation):
    """A count of branches that forget. The torque of each is linear in its stiffness."""

    branches: int
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

    def free(self, gear: Gear, stiff: Collection[int] = ()) -> list[str]:
        return ["hysteresis.stiffness", "hysteresis.forgetting"]


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

    def words(self, gear: Gear) -> str:
        return " with Bouc and Wen's hysteresis"

    def units(self, loop: TorsionLoop, gear: Gear) -> Iterator[Law]:
        for reach, sharpness, shape in product(np.geomspace(0.02, 1.0, 7), (1.2, 2.5, 6.0), (0.55, 0.75, 0.95)):
            stiff = 1.0 / (float(reach) * half_span(loop))
            yield hysteresis.BoucWen(stiffness=stiff, saturation=1.0, sharpness=sharpness, shape=shape)

    def put(self, gear: Gear, law: Law, factor: float) -> Gear:
        assert isinstance(law, hysteresis.BoucWen)
        return gear.replace(hysteresis=law.replace(stiffness=factor * law.stiffness, saturation=factor))

    def free(self, gear: Gear, stiff: Collection[int] = ()) -> list[str]:
        return [f"hysteresis.{name}" for name in ("stiffness", "saturation", "sharpness", "shape")]


class Preisach(Scaled):
    """Preisach's law of a density that falls as a power."""

    def words(self, gear: Gear) -> str:
        return " with Preisach's hysteresis of a power density"

    def units(self, loop: TorsionLoop, gear: Gear) -> Iterator[Law]:
        for limit, exponent in product((0.3, 0.45, 0.6, 0.75, 0.9, 1.05, 1.5, 3.0), (1.3, 2.0, 4.0, 8.0)):
            density = hysteresis.PowerDensity(limit=limit * half_span(loop), saturation=1.0, exponent=exponent)
            yield hysteresis.Preisach(density=density)

    def put(self, gear: Gear, law: Law, factor: float) -> Gear:
        assert isinstance(law, hysteresis.Preisach)
        assert isinstance(law.density, hysteresis.PowerDensity)
        return gear.replace(hysteresis=law.replace(density=law.density.replace(saturation=factor)))

    def free(self, gear: Gear, stiff: Collection[int] = ()) -> list[str]:
        return [f"hysteresis.density.{name}" for name in ("limit", "saturation", "exponent")]


class Regimes(Scaled):
    """A stiffness for each regime, tried with equal regimes in both senses: lost motion from the width of the loop."""

    whole_spring = True

    def words(self, gear: Gear) -> str:
        return "a stiffness for each of four regimes"

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

    def words(self, gear: Gear) -> str:
        return "friction inside multi-compliance"

    def units(self, loop: TorsionLoop, gear: Gear) -> Iterator[Law]:
        half, ratio = half_span(loop), abs(gear.kinematics.ratio)
        for share, flexspline, wave_generator, friction in product((0.2, 0.5, 0.8), (0.1, 1.0), (0.1, 1.0), (0.02, 0.1, 0.3)):
            springs = unit_compliance(half, ratio, share, flexspline, wave_generator)
            yield hysteresis.FrictionalWindup(springs=springs, friction=friction)

    def put(self, gear: Gear, law: Law, factor: float) -> Gear:
        assert isinstance(law, hysteresis.FrictionalWindup)
        law = law.replace(springs=scaled(law.springs, factor), friction=factor * law.friction)
        return _alone(gear, law, factor)

    def free(self, gear: Gear, stiff: Collection[int] = ()) -> list[str]:
        parts = ("flexspline_stiffness", "flexspline_hardening", "wave_generator_stiffness", "wave_generator_hardening")
        return [*(f"hysteresis.springs.{part}" for part in parts), "hysteresis.friction"]


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
