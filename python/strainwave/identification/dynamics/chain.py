"""Gravity on a joint of an arm whose joints move together, without a model of the arm.

The axes of neighbouring joints of nearly all arms are parallel or at right angles. Angles of parallel axes add up; an axis at
right angles multiplies what is behind it by the sine and cosine of its angle. The gravity torque of a joint is thus a sum of
sines and cosines of sums of angles, which the relations of the axes alone determine (KhalilDombre2002, ch. 3 and 9). Lengths,
masses and zeros of the angles are in their shares. The relations are not known here. A part of the chain around the joint is
made longer at both ends, by each relation. The part that predicts stretches of the motion best is taken, each by the others.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Sum = tuple[tuple[int, int], ...]  # places of joints in the chain, each with the sign of its angle

ACROSS, RELATIONS = 0, (0, 1, -1)  # axes at right angles; besides, parallel ones of the same and of opposite sense
MAX_BEAM_WIDTH = 6  # parts of the chain of each length that are made longer
MAX_SUMS = 30  # of a part of the chain
MIN_GAIN_PER_SUM = 0.02  # relative decrease of the error by each sum of angles (assumed)
MAX_ROWS = 1500  # of the motion, by which parts are compared
FOLD_COUNT = 3  # stretches of the motion, each predicted by the others
MIN_SINGULAR = 1e-4  # singular values below this share of the largest are taken as zero


@dataclass(frozen=True)
class Chain:
    """A part of a chain of joints.

    Attributes:
        joint: place of the joint whose gravity it is
        first: place of the first joint of the part
        relations: of the axes of each joint and the next one, of the part: 0 at right angles, 1 or -1 parallel
    """

    joint: int
    first: int
    relations: tuple[int, ...] = ()

    @property
    def last(self) -> int:
        """Place of the last joint of the part."""
        return self.first + len(self.relations)

    def longer(self, count: int) -> Iterator[Chain]:
        """Yield the parts that are one joint longer, of a chain of `count` joints."""
        for relation in RELATIONS:
            if self.first > 0:
                yield replace(self, first=self.first - 1, relations=(relation, *self.relations))
            if self.last < count - 1:
                yield replace(self, relations=(*self.relations, relation))

    def sums(self) -> tuple[Sum, ...]:
        """Return the sums of angles whose sines and cosines make the gravity torque of all links up to the last joint."""
        return tuple(sorted({each for last in range(self.joint, self.last + 1) for each in self._sums_of_link(last)}))

    def _sums_of_link(self, last: int) -> Iterator[Sum]:
        """Yield the sums of the link behind a joint: of each bundle of parallel axes the sine, the cosine or neither."""
        bundles = list(self._bundles(last))
        own = next(place for place, bundle in enumerate(bundles) if self.joint in bundle)
        signs: list[tuple[int, ...]] = [(0, 1, -1) if place else (1, -1) for place in range(len(bundles))]
        signs[own] = (bundles[own][self.joint],)  # so that the angle of the joint itself counts as positive
        for chosen in product(*signs):
            yield tuple(
                (at, sign * sense) for sign, each in zip(chosen, bundles, strict=True) if sign for at, sense in each.items()
            )

    def _bundles(self, last: int) -> Iterator[dict[int, int]]:
        """Yield the joints up to one in bundles of parallel axes, each with its sense."""
        bundle = {self.first: 1}
        for place, relation in enumerate(self.relations[: last - self.first], self.first + 1):
            if relation == ACROSS:
                yield bundle
            bundle = {place: 1} if relation == ACROSS else {**bundle, place: relation * bundle[place - 1]}
        yield bundle


def best_chain(torque: Array, base: Array, wave: Callable[[Sum], Array], joint: int, count: int) -> Chain | None:
    """Return the part of a chain whose gravity predicts a torque best.

    Args:
        torque: of the joint, shape (n,)
        base: columns of what the joint has by itself, shape (n, b)
        wave: sine and cosine of a sum of angles, shape (n, 2)
        joint: its place in the chain
        count: joints of the chain

    Returns:
        the part; None if none predicts better than the base
    """
    every = slice(None, None, -(-len(torque) // MAX_ROWS))
    torque, base = torque[every], base[every]
    waves, costs = dict[Sum, Array](), dict[tuple[Sum, ...], float]()

    def cost(chain: Chain | None) -> float:
        sums = chain.sums() if chain else ()
        if sums not in costs:
            waves.update({each: wave(each)[every] for each in sums if each not in waves})
            error = _error(torque, np.column_stack([base, *(waves[each] for each in sums)]))
            costs[sums] = error * (1.0 + MIN_GAIN_PER_SUM) ** len(sums)
        return costs[sums]

    longest = [Chain(joint, joint)]
    best: Chain | None = min(longest[0], None, key=cost)
    for _ in range(count - 1):
        longer = {chain for each in longest for chain in each.longer(count)}
        longest = sorted((each for each in longer if len(each.sums()) <= MAX_SUMS), key=cost)[:MAX_BEAM_WIDTH]
        best = min([best, *longest], key=cost)
    return best


def _error(torque: Array, columns: Array) -> float:
    """Return the root mean square error of least squares over stretches, each predicted by the others."""
    columns = columns / np.maximum(np.linalg.norm(columns, axis=0), 1e-300)
    squares = 0.0
    for stretch in np.array_split(np.arange(len(torque)), FOLD_COUNT):
        others = np.ones(len(torque), bool)
        others[stretch] = False
        shares = np.linalg.lstsq(columns[others], torque[others], rcond=MIN_SINGULAR)[0]
        squares += float(np.sum((torque[stretch] - columns[stretch] @ shares) ** 2))
    return float(np.sqrt(squares / len(torque)))


def named(sums: Sequence[Sum], names: Sequence[str]) -> list[str]:
    """Return sums of angles as text, as `q2+q3-q4`."""
    words = ("".join(f"{'+' if sense > 0 else '-'}q{names[place]}" for place, sense in each) for each in sums)
    return [each.removeprefix("+") for each in words]
