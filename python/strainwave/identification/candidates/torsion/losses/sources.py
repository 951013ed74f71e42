"""Sources of loss, and the half widths of torsion loops that they make."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from strainwave.identification.candidates.steady_shapes import MIN_TEMPERATURE_SPAN
from strainwave.identification.candidates.torsion.losses.relaxation import Relaxation
from strainwave.identification.experiments.loss_loop import LossLoop

Array = NDArray[np.float64]

FALL_SIGMA = 0.05  # 1/K: of the relative fall of friction with the temperature, about none (assumed)
COMPLEX_STEP = 1e-30  # of a change, for derivatives without cancellation (Squire and Trapp, SIAM Review 40 (1998) 110)


class Curve(NamedTuple):
    """The torque on the curve that both ways of a loop share, and its ends [N.m]."""

    torque: Array
    low: float
    high: float

    @property
    def reach(self) -> float:
        """Half of the difference between both ends [N.m]."""
        return 0.5 * (self.high - self.low)

    @property
    def bow(self) -> Array:
        """1 - (S/T)² about the middle, shape (n,)."""
        return np.clip((self.high - self.torque) * (self.torque - self.low), 0.0, None) / self.reach**2


Shape = Callable[[LossLoop, Curve], Array]


@dataclass(frozen=True)
class Source:
    """A source of loss.

    Attributes:
        name: of it
        quantity: its number, in words
        unit: of that
        shapes: half of the width of a loop for the number 1 [N.m], one or several that are added
        lubricant: the fall with the temperature that it shares with others; empty if it has none
    """

    name: str
    quantity: str
    unit: str
    shapes: tuple[Shape, ...]
    lubricant: str = ""


SOURCES = (
    Source("bearing, dry", "torque at the input", "N.m", (lambda loop, _: np.full(len(loop.twist), loop.ratio),), "bearing"),
    Source("bearing, viscous", "at the input", "N.m.s/rad", (lambda loop, _: loop.ratio**2 * loop.rate,), "oil"),
    Source("gear, dry", "torque at the output", "N.m", (lambda loop, _: np.ones(len(loop.twist)),), "mesh"),
    Source("gear, viscous", "at the output", "N.m.s/rad", (lambda loop, _: loop.rate,), "oil"),
    Source("mesh, in proportion to the load", "share of the load", "1", (lambda _, curve: np.abs(curve.torque),), "mesh"),
    Source(
        "flexspline, material", "loss factor", "1",
        (lambda _, curve: curve.reach * np.sqrt(curve.bow), lambda _, curve: 3.0 * np.pi / 8.0 * curve.reach * curve.bow),
    ),
)  # fmt: skip
RELAXING = Source(
    "flexspline, relaxing material", "loss modulus at the rate of the largest loop", "N.m/rad",
    (lambda loop, _: loop.rate / loop.frequency,),
)  # fmt: skip


def possible_sources(has_input: bool, timed: bool) -> list[Source]:
    """Return the sources that loops may contain."""
    return [
        source
        for source in SOURCES
        if (has_input or not source.name.startswith("bearing")) and (timed or not source.name.endswith("viscous"))
    ]


@dataclass(frozen=True, eq=False)
class Widths:
    """Half widths of all shapes of sources on loops at temperatures.

    Attributes:
        sources: that the loops may contain
        lubricants: whose fall with the temperature the loops show
        reference_temperature: of the largest loop [K]
        relaxation: of the last source; None if no material relaxes
    """

    sources: list[Source]
    lubricants: list[str]
    reference_temperature: float
    relaxation: Relaxation | None

    @classmethod
    def of(cls, loops: Sequence[LossLoop], largest: int, *, relaxing: bool) -> Widths:
        """Return the sources that loops may contain, referred to the largest, and the lubricants whose fall they show."""
        sources = possible_sources(any(loop.ratio for loop in loops), all(loop.is_timed for loop in loops))
        temperatures = np.array([loop.temperature for loop in loops])
        warmed = bool(np.isfinite(temperatures).all()) and float(np.ptp(temperatures)) >= MIN_TEMPERATURE_SPAN
        lubricants = [*dict.fromkeys(source.lubricant for source in sources if source.lubricant)] if warmed else []
        relaxation = Relaxation.of(loops, largest) if relaxing else None
        return cls([*sources, *([RELAXING] if relaxation else [])], lubricants, temperatures[largest].item(), relaxation)

    @property
    def shape_sums(self) -> Array:
        """Matrix that adds the shapes of each source, shape (sources, shapes)."""
        return np.repeat(np.eye(len(self.sources)), [len(source.shapes) for source in self.sources], axis=1)

    @property
    def scales(self) -> Array:
        """Standard deviations of what is not linear before the loops: falls [1/K], logarithm of the relaxation time."""
        return np.array([FALL_SIGMA] * len(self.lubricants) + ([self.relaxation.spread] if self.relaxation else []))

    def of_loop(self, loop: LossLoop, curve: Curve) -> Array:
        """Return them for the number 1 at temperature and rate of the largest loop, shape (n, shapes)."""
        shapes = [shape(loop, curve) for source in self.sources for shape in source.shapes]
        return loop.sense[:, np.newaxis] * np.stack(shapes, axis=1)

    def factors(self, loop: LossLoop, changes: NDArray[Any]) -> NDArray[Any]:
        """Return the factor of each shape at temperature and rate of a loop, shape (shapes,); changes may be complex."""
        warmer = loop.temperature - self.reference_temperature if self.lubricants else 0.0
        falls = dict(zip(self.lubricants, changes, strict=False))
        factors = [np.exp(-warmer * falls.get(source.lubricant, 0.0)) for source in self.sources for _ in source.shapes]
        if self.relaxation:
            factors[-1] = self.relaxation.factor(loop.frequency, changes[-1])
        return np.array(factors)

    def jacobian(self, widths: Array, loop: LossLoop, amplitudes: Array, changes: Array) -> Array:
        """Return the derivatives of the torque by amplitudes and changes, shape (n, shapes + changes)."""
        steps = 1j * COMPLEX_STEP * np.eye(len(changes))
        slopes = [amplitudes * self.factors(loop, changes + step).imag / COMPLEX_STEP for step in steps]
        return np.column_stack((widths * self.factors(loop, changes), *(widths @ slope for slope in slopes)))

    def cycle_loss(self, loop: LossLoop, curve: Curve) -> Array:
        """Return the loss of a cycle for the number 1 of each shape, from reversal to reversal and back [J]."""
        losses = []
        for sense in (1.0, -1.0):
            way = np.flatnonzero(loop.sense == sense)
            way = way[np.argsort(loop.twist[way])]
            twist = np.concatenate((loop.ends[:1], loop.twist[way], loop.ends[1:]))
            torque = np.concatenate(([curve.low], curve.torque[way], [curve.high]))
            whole = replace(loop, twist=twist, torque=torque, sense=np.ones(len(twist)), rate=np.pad(loop.rate[way], 1, "edge"))
            losses.append(np.trapezoid(self.of_loop(whole, curve._replace(torque=torque)), twist, axis=0))
        return np.asarray(np.sum(losses, axis=0))
