"""Torque of a joint by the joints that move with it, without a model of the arm.

The energy of an arm of rigid links is a sum of products of two speeds, or of gravity, with sines and cosines of sums of the
angles; the inertia of two joints depends on the angles of those behind the first of them alone (KhalilDombre2002, ch. 9).
Lagrange's equations make of each such term of the energy one of the torque, centrifugal and Coriolis forces included:

.. math:: \\frac{\\mathrm d}{\\mathrm dt} \\frac{\\partial E}{\\partial \\dot q_j} - \\frac{\\partial E}{\\partial q_j}

The geometry of an arm determines its terms, and is not known here. Gravity acts along a chain of joints (`Chain`). Of the
kinetic energy the terms that explain the torque best are added one by one, as long as they also predict blocks of time by which
they were not chosen. A term of one more joint must explain twice as much, as joints of an arm move in like periods.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations, combinations_with_replacement, product

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive
from strainwave.identification.candidates.plain import stretches
from strainwave.identification.experiments.motion import Motion, motion_of
from strainwave.identification.experiments.motion_log import MotionLog, per_torque
from strainwave.statistics.linear_fit import solved

Array = NDArray[np.float64]
Rows = NDArray[np.bool_]

TIME_BLOCKS = 10  # of the motion before the last stretch: terms are chosen by the even ones, and checked by the odd ones
SHARE_OF_JOINT = 0.5  # weight of a term in the selection for each other joint in it
SLOW_SHARES = (0.1, 0.5)  # of the usual speed, at which friction may fall
END_OF_RIGID, END_OF_FRICTION = 3, 9  # of the columns of a joint by itself: inertia and gravity, offset and friction
PLAIN_BASE = (0, 3, 4, 5)  # of these columns, those that are fitted together with gravity: inertia, offset, Coulomb, viscous
MIN_INDEPENDENT_WAVE = 0.02  # of the size of a sine or cosine of gravity, that those before it must not explain
MIN_ROWS_OF_TERMS = 50  # in the pass band before the last stretch, by which terms are found
TERMS_AT_ONCE = 64  # that are filtered
MAX_TERMS = 40  # terms
MAX_IDLE_TERMS = 4  # terms that may bring nothing before the search ends
MAX_STEP_ERROR = 0.99  # of the error, that the terms of a step must leave at most
MIN_INDEPENDENT = 1e-3  # of the size of a term, that terms before it must not explain
Sum = tuple[tuple[int, int], ...]  # places of joints in the chain, each with the sign of its angle

ACROSS, RELATIONS = 0, (0, 1, -1)  # axes at right angles; besides, parallel ones of the same and of opposite sense
MAX_BEAM_WIDTH = 6  # parts of the chain of each length that are made longer
MAX_SUMS = 30  # of a part of the chain
MIN_GAIN_PER_SUM = 0.02  # relative decrease of the error by each sum of angles (assumed)
MAX_ROWS_OF_CHAIN = 1500  # of the motion, by which parts are compared
CHAIN_FOLDS = 3  # stretches of the motion, each predicted by the others
MIN_SINGULAR_OF_CHAIN = 1e-4  # singular values below this share of the largest are taken as zero


def coupled(log: MotionLog, drive: Drive, time: Array, others: Mapping[str, Array], joint: str = "") -> Iterator[MotionLog]:
    """Yield a log with terms of other joints as regressors: those of gravity alone, and with those of the energy.

    The last 30 % of the motion, which judge the models, take no part.

    Args:
        log: of the joint
        drive: that it is compared with
        time: of the angles [s], shape (m,)
        others: angle of each other joint that moves [rad], by its name, shape (m,)
        joint: name of the joint. Where all names are numbers they count from the base, and terms that no chain has are left out
    """
    ratio = drive.gear.kinematics.ratio
    own = log.motion
    itself = replace(own, angle=own.angle / ratio, speed=own.speed / ratio, acceleration=own.acceleration / ratio)
    arm = _Arm(joint, {joint: itself} | {name: motion_of(time, angle, own.cutoff) for name, angle in others.items()})
    torque = ratio * log.measured[0] / per_torque(drive, log.effort) - own.filtered(log.extra[np.newaxis])[0]
    base = own.filtered(_alone(itself)).T
    known = own.rows < int(np.argmax(stretches(log)[-1]))
    if np.count_nonzero(known) < MIN_ROWS_OF_TERMS:
        return
    gravity = _gravity(arm, own, torque[known], base[known], known)
    if gravity:
        with_gravity = _with_regressors(log, gravity)
        yield with_gravity
        base = np.column_stack([base, own.filtered(np.stack(list(gravity.values()))).T])
        log = with_gravity
    yield from _with_energy(log, arm, torque, base, known)


def _gravity(arm: _Arm, own: Motion, torque: Array, base: Array, known: Rows) -> dict[str, Array]:
    """Return the sines and cosines of the sums of angles by which gravity acts on a joint, by name, shape (n,) each."""
    names = arm.chain
    angles = [arm.moving[name].angle for name in names]

    def series(each: Sum) -> Array:
        angle = sum((sense * angles[place] for place, sense in each), np.zeros_like(angles[0]))
        return np.stack([np.sin(angle), np.cos(angle)])

    place, count = names.index(arm.joint), len(names)
    chain = best_chain(torque, base[:, PLAIN_BASE], lambda each: own.filtered(series(each)).T[known], place, count)
    sums = [each for each in (chain.sums() if chain else ()) if len(each) > 1]  # its own angle has a place in the load
    waves = {
        f"{wave}({word})": values
        for each, word in zip(sums, named(sums, names), strict=True)
        for wave, values in zip(("sin", "cos"), series(each), strict=True)
    }
    if not waves:
        return {}
    separable = independent(base, own.filtered(np.stack(list(waves.values()))).T[known], MIN_INDEPENDENT_WAVE)
    return {name: values for place, (name, values) in enumerate(waves.items()) if place in separable}


def _with_energy(log: MotionLog, arm: _Arm, torque: Array, base: Array, known: Rows) -> Iterator[MotionLog]:
    """Yield the log with terms of the kinetic energy, chosen with a loss under load, which they can imitate, and without."""
    own, terms = log.motion, list(arm.terms())
    columns = _columns(own, arm, terms)
    rigid = np.array([*range(END_OF_RIGID), *range(END_OF_FRICTION, base.shape[1])])
    size = np.abs(base[:, rigid] @ solved(base[known], torque[known])[rigid])  # of what a gear loses a share
    lossy = np.column_stack([base, size * np.sign(own.speed[own.rows])])
    begin, end = log.time[known][[0, -1]]
    block = np.clip(TIME_BLOCKS * (log.time - begin) / (end - begin), 0.0, TIME_BLOCKS - 1.0).astype(int)
    weights = np.array([term.weight(arm.joint) for term in terms])
    even, odd = known & (block % 2 == 0), known & (block % 2 == 1)
    if not (even.any() and odd.any()):
        return
    for places in dict.fromkeys(tuple(Selection(torque, each, weights, even, odd).best(columns)) for each in (lossy, base)):
        selected = {terms[place].name: terms[place].torque(arm) for place in places}
        if selected:
            yield _with_regressors(log, selected)


def _with_regressors(log: MotionLog, series: Mapping[str, Array]) -> MotionLog:
    return replace(log, regressors={**log.regressors, **series})


def _alone(joint: Motion) -> Array:
    """Return inertia, gravity, an offset, and friction of any shape over the speed, shape (columns, n).

    Terms of other joints would imitate a friction that is missing.
    """
    angle, speed = joint.angle, joint.speed
    way, usual = np.sign(speed), float(np.median(np.abs(speed[joint.rows])))
    falling = (way * np.exp(-np.abs(speed) / (part * usual)) for part in SLOW_SHARES)
    friction = [way, speed, way * np.sqrt(np.abs(speed)), *falling]
    return np.stack([joint.acceleration, np.sin(angle), np.cos(angle), np.ones_like(angle), *friction])


@dataclass(frozen=True, eq=False)
class _Arm:
    """Joints that move, by their names, and which of them it is about."""

    joint: str
    moving: Mapping[str, Motion]

    @property
    def chain(self) -> list[str]:
        """Names of the joints from the base on, if they are numbers; else in alphabetical order."""
        return in_order(self.moving)

    def behind(self, name: str, other: str) -> list[str]:
        """Return the joints behind the first of two, on which alone their inertia depends; all if no order is known."""
        if not are_numbers(self.moving):
            return sorted(self.moving)
        return in_order(each for each in self.moving if int(each) > min(int(name), int(other)))

    def terms(self) -> Iterator[_Term]:
        """Yield those of the kinetic energy of which the torque of the joint has anything."""
        for pair in combinations_with_replacement(sorted(self.moving), 2):
            if self.joint in pair and len(set(pair)) == 2:
                yield _Term(pair, (), False)
            for each in _sums(self.behind(*pair)):
                if self.joint in pair or self.joint in dict(each):
                    yield from (_Term(pair, each, is_sine) for is_sine in (True, False))


def are_numbers(names: Iterable[str]) -> bool:
    """True if all joints are named by numbers, which count from the base."""
    return all(each.isdigit() for each in names)


def in_order(names: Iterable[str]) -> list[str]:
    """Return joints from the base on, if they are named by numbers; else in alphabetical order."""
    names = list(names)
    return sorted(names, key=int if are_numbers(names) else None)


def _sums(names: Sequence[str]) -> Iterator[tuple[tuple[str, int], ...]]:
    """Yield the sums of one or two angles and their doubles, each but for its sign."""
    for count in (1, 2):
        for chosen in combinations(names, count):
            for factors in product((1, 2), *((1, 2, -1, -2) for _ in chosen[1:])):
                yield tuple(zip(chosen, factors, strict=True))


@dataclass(frozen=True)
class _Term:
    """A term of the kinetic energy: the sine or cosine of a sum of angles, or 1, times the speeds of two joints."""

    speeds: tuple[str, str]
    sum_of: tuple[tuple[str, int], ...]
    is_sine: bool

    @property
    def name(self) -> str:
        """Name as `dq1 dq2 cos(2q2-q3)`."""
        inner = "".join(
            f"{'-' if times < 0 else '+'}{abs(times) if abs(times) > 1 else ''}q{name}" for name, times in self.sum_of
        )
        wave = f"{'sin' if self.is_sine else 'cos'}({inner.removeprefix('+')})" if self.sum_of else ""
        return " ".join([*(f"dq{name}" for name in self.speeds), *([wave] if wave else [])])

    def weight(self, joint: str) -> float:
        """Return its weight in the selection: joints move in like periods, so that terms of many of them explain anything."""
        others = {*self.speeds, *dict(self.sum_of)} - {joint}
        return float(SHARE_OF_JOINT ** len(others))

    def torque(self, arm: _Arm) -> Array:
        """Return what it adds to the torque of the joint, by Lagrange's equations, shape (n,)."""
        moving, own = arm.moving, arm.joint
        angle = sum((times * moving[name].angle for name, times in self.sum_of), np.zeros_like(moving[own].angle))
        wave, slope = (np.sin(angle), np.cos(angle)) if self.is_sine else (np.cos(angle), -np.sin(angle))
        by_own = dict(self.sum_of).get(own, 0) * slope
        first, second = (moving[name] for name in self.speeds)
        centrifugal: Array = -by_own * first.speed * second.speed
        if own not in self.speeds:
            return centrifugal
        other = second if self.speeds[0] == own else first
        twice = 2.0 if other is moving[own] else 1.0
        if other is moving[own]:  # about its mean, so that the inertia of the joint is that in the mean
            wave = wave - np.average(wave, weights=other.acceleration**2)
        rate = slope * sum((times * moving[name].speed for name, times in self.sum_of), np.zeros_like(angle))
        return centrifugal + twice * (wave * other.acceleration + rate * other.speed)


def _columns(motion: Motion, arm: _Arm, terms: Sequence[_Term]) -> Array:
    """Return the terms in the pass band, a column each, shape (rows, terms)."""
    columns = np.empty((len(motion.rows), len(terms)))
    for begin in range(0, len(terms), TERMS_AT_ONCE):
        some = terms[begin : begin + TERMS_AT_ONCE]
        columns[:, begin : begin + len(some)] = motion.filtered(np.stack([term.torque(arm) for term in some])).T
    return columns


# ---- Selection of terms ----------------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Selection:
    """Forward selection of terms by orthogonal least squares (ChenBillingsLuo1989), checked on other blocks of time.

    Attributes:
        torque: shape (n,)
        base: columns that every joint has, shape (n, b)
        weights: of terms that explain as much, shape (t,)
        train, check: rows that terms are chosen by, and those that check them, shape (n,)
    """

    torque: Array
    base: Array
    weights: Array
    train: NDArray[np.bool_]
    check: NDArray[np.bool_]

    def best(self, columns: Array) -> list[int]:
        """Return the places of the columns to add, in the order in which they explain."""
        chosen: list[int] = []
        errors = [self.error(columns[:, chosen])]
        left = columns[self.train] / np.maximum(np.linalg.norm(columns[self.train], axis=0), 1e-300)
        orthogonal, _ = np.linalg.qr(self.base[self.train])
        left -= orthogonal @ (orthogonal.T @ left)
        rest = self.torque[self.train] - orthogonal @ (orthogonal.T @ self.torque[self.train])
        while len(chosen) < min(MAX_TERMS, columns.shape[1]):
            squares = np.einsum("ij,ij->j", left, left)
            explained = (rest @ left) ** 2 / np.maximum(squares, 1e-300)
            scores = np.where(squares > MIN_INDEPENDENT**2, self.weights * explained, 0.0)
            place = int(np.argmax(scores))
            if scores[place] == 0.0:
                break
            direction = left[:, place] / np.sqrt(squares[place])
            left -= np.outer(direction, direction @ left)
            rest -= direction * (direction @ rest)
            chosen.append(place)
            errors.append(self.error(columns[:, chosen]))
            if min(errors[-MAX_IDLE_TERMS:]) > MAX_STEP_ERROR * min(errors[:-MAX_IDLE_TERMS] or [np.inf]):
                break
        least = min(errors)
        return chosen[: next(count for count, error in enumerate(errors) if error <= least / MAX_STEP_ERROR)]

    def error(self, columns: Array) -> float:
        """Return the error of the rows that check, by the shares of the others, over how much the torque varies."""
        every = np.hstack([self.base, columns])
        left = self.torque[self.check] - every[self.check] @ solved(every[self.train], self.torque[self.train])
        return float(np.sqrt(np.mean(left**2)) / np.std(self.torque))


def independent(base: Array, columns: Array, least: float = MIN_INDEPENDENT) -> list[int]:
    """Return the columns of which at least a share is made up neither by a base nor by columns before them."""
    places: list[int] = []
    orthogonal, _ = np.linalg.qr(base)
    for place, column in enumerate(columns.T):
        rest = column - orthogonal @ (orthogonal.T @ column)
        if np.linalg.norm(rest) > least * np.linalg.norm(column):
            places.append(place)
            orthogonal = np.column_stack([orthogonal, rest / np.linalg.norm(rest)])
    return places


# ---- Gravity along a chain of joints ---------------------------------------------------------------------------------


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
    every = slice(None, None, -(-len(torque) // MAX_ROWS_OF_CHAIN))
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
    for stretch in np.array_split(np.arange(len(torque)), CHAIN_FOLDS):
        others = np.ones(len(torque), bool)
        others[stretch] = False
        shares = np.linalg.lstsq(columns[others], torque[others], rcond=MIN_SINGULAR_OF_CHAIN)[0]
        squares += float(np.sum((torque[stretch] - columns[stretch] @ shares) ** 2))
    return float(np.sqrt(squares / len(torque)))


def named(sums: Sequence[Sum], names: Sequence[str]) -> list[str]:
    """Return sums of angles as text, as `q2+q3-q4`."""
    words = ("".join(f"{'+' if sense > 0 else '-'}q{names[place]}" for place, sense in each) for each in sums)
    return [each.removeprefix("+") for each in words]
