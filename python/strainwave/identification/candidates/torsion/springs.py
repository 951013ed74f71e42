"""Kinds of spring of a loop, each with its initial curves: linear in positive weights, for each of some knees.

A library is a part of a gear whose torque is linear in positive weights: the best of many is found by convex problems.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import chain, combinations, product
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from strainwave import stiffness
from strainwave._core import Gear
from strainwave.equality import ComparedByFields

Array = NDArray[np.float64]
MAX_TURNS = 4  # of choosing spring and hysteresis in turn; no loop tried took more than three
Law = stiffness.Linear | stiffness.Cubic | stiffness.Piecewise | stiffness.ThreeSegment | stiffness.MultiCompliance
Spring = Law | stiffness.TwoSided | stiffness.Backlash
TRIED_KNEES = np.array([*np.arange(0.1, 1.0, 0.1), 0.95, 0.988])  # of half the span, tried
TRIED_CLEARANCES = np.array([0.02, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.65, 0.8, 1.2])  # of half the span: play of flanks
TRIED_FACTORS = (0.5, 0.7, 0.85, 1.2, 1.4, 2.0)  # of the torque at negative twist
WAVE_GENERATOR_SHARES = (0.2, 0.5, 0.8)  # of the compliance at zero torque, tried
TRIED_HARDENINGS = (0.1, 1.0, 4.0)  # per the torque at half the span, of flexspline and wave generator, tried
MIN_STIFFNESS_SHARE = 1e-6  # of the secant stiffness, in place of no spring
MIN_STIFFNESS = 1e-9  # N.m/rad


# ---- Convex problem --------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Choice:
    """A part with all numbers chosen but its weights.

    Attributes:
        columns: of the library's torques, those of its weights
        put: returns the gear with this part, from its weights
        group: choices of one group lead to the same minimum; answers are of several groups
    """

    columns: tuple[int, ...]
    put: Callable[[Gear, Array], Gear]
    group: float = 0.0


@dataclass(frozen=True, eq=False)
class Library(ComparedByFields):
    """Torques that one kind of part can add.

    Attributes:
        torques: of unit weights along the loop [N.m], shape (n, m)
        choices: of which a gear has one
    """

    torques: Array
    choices: tuple[Choice, ...]

    @classmethod
    def of(cls, torques: Sequence[Array], choices: Sequence[Choice]) -> Library:
        return cls(np.column_stack(torques), tuple(choices))


@dataclass(frozen=True, eq=False)
class Answer(ComparedByFields):
    """The best choice of each library.

    Attributes:
        choices: one of each library
        weights: of each, and of the columns that always take part
        error: root of the sum of the squared residuals [N.m]
    """

    choices: tuple[Choice, ...]
    weights: tuple[Array, ...]
    error: float

    def put(self, gear: Gear) -> Gear:
        """Return the gear with all parts."""
        for choice, weights in zip(self.choices, self.weights, strict=False):
            gear = choice.put(gear, weights)
        return gear


def solve(torque: Array, libraries: Sequence[Library], always: Array, most: int = 1) -> list[Answer]:
    """Return the choices of each library that explain a torque best, with positive weights.

    For given choices the weights are a convex problem, non-negative least squares (LawsonHanson1974). The triangle of one QR
    decomposition of all columns replaces the columns. The libraries are tried in turn until nothing improves.

    Args:
        torque: to explain [N.m], shape (n,)
        libraries: kinds of parts; one choice of each is taken
        always: columns that take part in any choice, shape (n, k)
        most: largest count of answers

    Returns:
        answers, best first; their choices of the first library that has several groups are of different ones

    Raises:
        ValueError: no choice has an answer

    >>> x = np.linspace(-1.0, 1.0, 9)
    >>> powers = Library.of([x, x**3, x**5], [Choice((0, 1), lambda gear, w: gear), Choice((0, 2), lambda gear, w: gear)])
    >>> found = solve(2.0 * x + 3.0 * x**5, [powers], np.empty((9, 0)))[0]
    >>> found.choices[0].columns, found.weights[0].round(12)
    ((0, 2), array([2., 3.]))
    """
    matrix = np.column_stack([*(library.torques for library in libraries), always])
    size = np.linalg.norm(matrix, axis=0)
    size = np.where(size > 0.0, size, 1.0)
    triangle = np.asarray(np.linalg.qr(np.column_stack((matrix / size, torque)), mode="r"), float)
    firsts = np.cumsum([0, *(library.torques.shape[1] for library in libraries)])
    constant = [*range(firsts[-1], matrix.shape[1])]

    answers: dict[tuple[int, ...], Answer] = {}

    def tries(numbers: tuple[int, ...]) -> None:
        choices = [library.choices[number] for library, number in zip(libraries, numbers, strict=True)]
        places = [
            [first + column for column in choice.columns] for first, choice in zip(firsts[:-1].tolist(), choices, strict=True)
        ]
        order = [*chain(*places), *constant]
        solution = _positive(triangle[:, order], triangle[:, -1])
        if solution is not None:
            ends = np.cumsum([len(each) for each in places])
            answers[numbers] = Answer(tuple(choices), tuple(np.split(solution[0] / size[order], ends)), solution[1])

    chosen = (0,) * len(libraries)
    for _ in range(MAX_TURNS):
        before = len(answers)
        for place, library in enumerate(libraries):
            for number in range(len(library.choices)):
                numbers = (*chosen[:place], number, *chosen[place + 1 :])
                if numbers not in answers:
                    tries(numbers)
            chosen = min(answers, key=lambda each: answers[each].error, default=chosen)
        if len(answers) == before:
            break
    if not answers:
        raise ValueError("no spring and hysteresis fits this loop; see whether the units of twist and torque are right")
    parted = next((place for place, each in enumerate(libraries) if len({choice.group for choice in each.choices}) > 1), 0)
    of_groups: dict[float, Answer] = {}
    for answer in sorted(answers.values(), key=lambda answer: answer.error):
        of_groups.setdefault(answer.choices[parted].group, answer)
    return [*of_groups.values()][:most]


def _positive(matrix: Array, torque: Array) -> tuple[Array, float] | None:
    """Return non-negative weights and their error; None if the active set cycles, as other choices remain."""
    from scipy.optimize import nnls

    try:
        weights, error = nnls(matrix, torque)
    except RuntimeError:
        return None
    return weights, float(error)


# ---- Springs ---------------------------------------------------------------------------------------------------------


class SpringKind(ABC):
    """A kind of spring."""

    words: str
    minima = 1  # count of initial curves that are fitted
    in_parallel = ""  # number to which a linear spring in parallel adds its stiffness, if the sum is of the same kind
    knows_zero = True  # its curve determines where the twist is zero

    @abstractmethod
    def library(self, twist: Array, half: float, gear: Gear) -> Library:
        """Return its torques along a twist from its zero [rad], shape (n,), that reaches about `half` either way."""

    def free(self, gear: Gear) -> list[str]:
        """Return the paths of its numbers."""
        return [f"stiffness.{field['name']}" for field in gear.stiffness.fields]

    def stiffened(self, spring: Spring, k: float) -> Spring:
        """Return the spring in parallel with a linear one of stiffness k, if that is of the same kind; else the spring."""
        name = self.in_parallel
        return spring.replace(**{name: getattr(spring, name) + k}) if name else spring

    def in_order(self, spring: Spring) -> Spring:
        """Return the same curve, its knees in order."""
        return spring


class Linear(SpringKind):
    words = "linear spring"
    in_parallel = "k"
    knows_zero = False

    def library(self, twist: Array, half: float, gear: Gear) -> Library:
        return Library.of([twist], [Choice((0,), lambda g, w: g.replace(stiffness=stiffness.Linear(k=_soft(w))))])


class Cubic(SpringKind):
    words = "cubic spring"
    in_parallel = "a1"

    def library(self, twist: Array, half: float, gear: Gear) -> Library:
        def put(g: Gear, w: Array) -> Gear:
            return g.replace(stiffness=stiffness.Cubic(a1=_soft(w), a3=float(w[1]) / half**2))

        return Library.of([twist, half * (twist / half) ** 3], [Choice((0, 1), put)])


class Piecewise(SpringKind):
    words = "piecewise spring"
    in_parallel = "k1"

    def library(self, twist: Array, half: float, gear: Gear) -> Library:
        def choice(place: int, knee: float) -> Choice:
            def put(g: Gear, w: Array) -> Gear:
                return g.replace(stiffness=stiffness.Piecewise(k1=_soft(w), k2=float(w[1]), knee=knee))

            return Choice((0, 1 + place), put)

        knees = (half * TRIED_KNEES).tolist()
        return Library.of([twist, *_beyond(twist, knees)], [choice(place, knee) for place, knee in enumerate(knees)])


class ThreeSegment(SpringKind):
    """Three segments, whose initial slopes grow from one to the next; a fit may end elsewhere."""

    words = "three-segment spring"

    def library(self, twist: Array, half: float, gear: Gear) -> Library:
        knees = (half * TRIED_KNEES).tolist()

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
        """Return the same curve; a second knee below the first becomes the first."""
        assert isinstance(spring, stiffness.ThreeSegment)
        if spring.t2 >= spring.t1:
            return spring
        return stiffness.ThreeSegment(k1=spring.k1, k2=spring.k2, k3=spring.k3, t1=spring.t1, t2=spring.t1)


class MultiCompliance(SpringKind):
    """Flexspline and wave generator in series: linear in a factor of both stiffnesses that divides both hardenings."""

    words = "multi-compliance spring"
    minima = 4

    def library(self, twist: Array, half: float, gear: Gear) -> Library:
        ratio = abs(gear.kinematics.ratio)
        shapes = [
            unit_compliance(half, ratio, *shape) for shape in product(WAVE_GENERATOR_SHARES, TRIED_HARDENINGS, TRIED_HARDENINGS)
        ]
        inside = [shape for shape in shapes if np.isfinite(_torque(shape, twist)).all()]

        def choice(place: int, unit: stiffness.MultiCompliance) -> Choice:
            return Choice((place,), lambda g, w: g.replace(stiffness=scaled(unit, float(w[0]))), place)

        return Library.of(
            [_torque(shape, twist) for shape in inside], [choice(place, unit) for place, unit in enumerate(inside)]
        )

    def free(self, gear: Gear) -> list[str]:
        return [path for path in super().free(gear) if not path.endswith("reduction")]


@dataclass(frozen=True)
class Wrapper(SpringKind):
    """A spring of another kind with one number more, in which the torque is not linear."""

    law: SpringKind
    number: ClassVar[str]

    @abstractmethod
    def wrapped(self, law: Spring, number: float) -> Spring:
        """Return a spring with that number."""

    @abstractmethod
    def libraries(self, twist: Array, half: float, gear: Gear) -> Iterator[tuple[float, Library]]:
        """Yield each number that is tried, and the torques of the spring with it."""

    def library(self, twist: Array, half: float, gear: Gear) -> Library:
        torques: list[Array] = []
        choices: list[Choice] = []
        first = 0
        for number, law in self.libraries(twist, half, gear):
            choices += [self._chosen(choice, number, first) for choice in law.choices]
            torques.append(law.torques)
            first += law.torques.shape[1]
        return Library.of(torques, choices)

    def _chosen(self, choice: Choice, number: float, first: int) -> Choice:
        def put(gear: Gear, weights: Array) -> Gear:
            return gear.replace(stiffness=self.wrapped(choice.put(gear, weights).stiffness, number))

        return Choice(tuple(first + column for column in choice.columns), put, number)

    def free(self, gear: Gear) -> list[str]:
        spring: Any = gear.stiffness
        of_law = self.law.free(gear.replace(stiffness=spring.law))
        return [f"stiffness.{self.number}", *(path.replace("stiffness.", "stiffness.law.", 1) for path in of_law)]

    def in_order(self, spring: Spring) -> Spring:
        own: Any = spring
        law = self.law.in_order(own.law)
        return spring if law is own.law else self.wrapped(law, getattr(own, self.number))


class Backlash(Wrapper):
    """Play before a spring of another kind."""

    number = "clearance"
    minima = 6

    @property
    def words(self) -> str:  # type: ignore[override]
        return f"{self.law.words} behind play"

    def wrapped(self, law: Any, number: float) -> Spring:
        return stiffness.Backlash(law=law, clearance=number)

    def libraries(self, twist: Array, half: float, gear: Gear) -> Iterator[tuple[float, Library]]:
        for clearance in (half * TRIED_CLEARANCES).tolist():
            behind = twist - np.clip(twist, -0.5 * clearance, 0.5 * clearance)
            yield clearance, self.law.library(behind, half - 0.5 * clearance, gear)


class TwoSided(Wrapper):
    """A spring of another kind whose torque has a factor in the negative sense of twist."""

    number = "negative_factor"
    minima = 1

    @property
    def words(self) -> str:  # type: ignore[override]
        return f"asymmetric {self.law.words}"

    def wrapped(self, law: Any, number: float) -> Spring:
        return stiffness.TwoSided(law=law, negative_factor=number)

    def libraries(self, twist: Array, half: float, gear: Gear) -> Iterator[tuple[float, Library]]:
        law = self.law.library(twist, half, gear)
        for factor in TRIED_FACTORS:
            yield factor, replace(law, torques=law.torques * np.where(twist < 0.0, factor, 1.0)[:, np.newaxis])


class Negligible(SpringKind):
    """No spring, as the hysteresis is a whole spring by itself."""

    words = "no spring"

    def library(self, twist: Array, half: float, gear: Gear) -> Library:
        return Library(np.empty((len(twist), 0)), (Choice((), lambda g, w: g),))

    def free(self, gear: Gear) -> list[str]:
        return []


LINEAR, CUBIC, PIECEWISE, THREE_SEGMENT, MULTI_COMPLIANCE = Linear(), Cubic(), Piecewise(), ThreeSegment(), MultiCompliance()
PLAIN_SPRINGS = (LINEAR, CUBIC, PIECEWISE, THREE_SEGMENT, MULTI_COMPLIANCE)


def unit_compliance(
    half: float, ratio: float, share: float, flexspline: float, wave_generator: float
) -> stiffness.MultiCompliance:
    """Return flexspline and wave generator that twist by `half` [rad] under 1 N.m.

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
    """Return the spring that twists as far under a multiple of the torque."""
    factor = max(torque, MIN_STIFFNESS)
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
    """Return the first weight as a stiffness that is not zero."""
    return max(float(weights[0]), MIN_STIFFNESS_SHARE * float(np.sum(weights)), MIN_STIFFNESS)
