"""Torque of a joint by the joints that move with it, without a model of the arm.

The energy of an arm of rigid links is a sum of products of two speeds, or of gravity, with sines and cosines of sums of the
angles; the inertia of two joints depends on the angles of those behind the first of them alone (KhalilDombre2002, ch. 9).
Lagrange's equations make of each such term of the energy one of the torque, centrifugal and Coriolis forces included:

.. math:: \\frac{\\mathrm d}{\\mathrm dt} \\frac{\\partial E}{\\partial \\dot q_j} - \\frac{\\partial E}{\\partial q_j}

Which terms an arm has, its geometry says, which is not known here. Two ways lead to them. Those are taken, one after another,
that explain the torque best, for as long as they also predict blocks of time that they were not chosen by; a term of one more
joint must explain twice as much. Of a long record that finds what there is. Of a short one it may fail: joints of an arm move
in like periods, and many terms explain the same. Then all are taken, with shares that are normal about zero. Those of the
energy are inertias of links, of one size but for sums of more angles; those of gravity are larger by its acceleration over a
length. The combinations of terms that the record tells are unknowns of a fit; of the others the little that is told is taken
as known. Of the two ways that one is gone which predicts blocks of time better that were left out.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations, combinations_with_replacement, product

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive
from strainwave.identification.dynamics.selection import Selection
from strainwave.identification.dynamics.shrinkage import Shrunk, Told
from strainwave.identification.experiments.motion import Motion, motion_of
from strainwave.identification.experiments.motion_log import MotionLog, per_torque

Array = NDArray[np.float64]

BLOCKS = 10  # of time; the odd ones are left for who compares models, of the others each checks what the rest tell
BETTER = 0.99  # of an error, that must be left at most
PLAIN = 0.5  # what a term counts for each other joint in it, where terms are selected
SMALLER = 0.3  # share of a term over that of one with an angle less in its sum (assumed)
NAMED = 5  # terms that are named of combinations
SLOW = (0.1, 0.5)  # of the usual speed, at which friction may fall
AT_ONCE = 64  # terms that are filtered at a time
CROSSED = 3  # angles in a sum, for gravity


@dataclass(frozen=True)
class Coupled:
    """A log with the terms of other joints.

    Attributes:
        log: with terms, or combinations of them, as regressors
        joints: that move, too
        terms: names of those that were selected, or of those with the largest part in the torque
        combined: whether all terms are taken, in combinations
        before, after: rms error on the blocks that check, over the rms of the torque about its mean, without and with the terms
    """

    log: MotionLog
    joints: tuple[str, ...]
    terms: tuple[str, ...]
    combined: bool
    before: float
    after: float


def coupled(log: MotionLog, drive: Drive, time: Array, others: Mapping[str, Array], joint: str = "") -> Coupled:
    """A log with what its torque shows of the terms of other joints.

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
    moving = {joint: itself} | {name: motion_of(time, angle, own.cutoff) for name, angle in others.items()}
    arm = _Arm(joint, moving)
    torque = ratio * log.measured[0] / per_torque(drive, log.effort) - own.filtered(log.extra[np.newaxis])[0]
    block = np.minimum((BLOCKS * (log.time - log.time[0]) / np.ptp(log.time)).astype(int), BLOCKS - 1)
    terms = list(arm.terms())
    columns, base = _columns(own, arm, terms), own.filtered(_alone(itself)).T
    expected, is_energy = np.array([term.expected for term in terms]), np.array([bool(term.speeds) for term in terms])
    shrunk = Shrunk(torque, base, columns, expected, is_energy)
    even, checks = block % 2 == 0, [block == place for place in range(0, BLOCKS, 2)]
    loss = shrunk.transmitted(even) * np.sign(own.speed[own.rows])
    shrunk = replace(shrunk, base=np.column_stack([base, loss]))
    plain = np.array([term.plain(joint) for term in terms])
    places = Selection(torque, shrunk.base, plain, block % 4 == 0, block % 4 == 2).best(columns)
    told = shrunk.told(even)
    before, with_all = (shrunk.error(even, checks, scatter) for scatter in (np.zeros_like(told.scatter), told.scatter))
    with_selected = shrunk.beside_base(columns[:, places]).error(even, checks, np.zeros(0))
    joints = tuple(others)
    if not min(with_selected, with_all) < BETTER * before:
        return Coupled(log, joints, (), False, before, before)
    if with_selected * BETTER <= with_all:
        selected = {terms[place].name: terms[place].torque(arm) for place in places}
        found = replace(log, regressors={**log.regressors, **selected})
        return Coupled(found, joints, tuple(selected), False, before, with_selected)
    combined, left = _on_grid(arm, terms, told)
    size = np.sqrt(np.mean(own.filtered(combined) ** 2, axis=1))
    regressors = {f"combination {place + 1}": each / size[place] for place, each in enumerate(combined)}
    found = replace(log, regressors={**log.regressors, **regressors}, extra=log.extra + left)
    parts = np.std(columns, axis=0) * np.abs(told.shares)
    largest = tuple(terms[place].name for place in np.argsort(-parts)[:NAMED])
    return Coupled(found, joints, largest, True, before, with_all)


def _on_grid(arm: _Arm, terms: Sequence[_Term], told: Told) -> tuple[Array, Array]:
    """The combinations that a record tells, shape (k, n), and the torque of the others as they are expected, shape (n,)."""
    points = len(arm.moving[arm.joint].angle)
    combined, left = np.zeros((told.combinations.shape[1], points)), np.zeros(points)
    for term, shares, rest in zip(terms, told.combinations, told.rest, strict=True):
        torque = term.torque(arm)
        combined += np.outer(shares, torque)
        left += rest * torque
    return combined, left


def _alone(joint: Motion) -> Array:
    """What any joint has by itself: inertia, gravity, an offset, and friction of any shape over the speed, which else terms of
    other joints would make up for."""
    angle, speed = joint.angle, joint.speed
    way, usual = np.sign(speed), float(np.median(np.abs(speed[joint.rows])))
    friction = [way, speed, way * np.sqrt(np.abs(speed)), *(way * np.exp(-np.abs(speed) / (part * usual)) for part in SLOW)]
    return np.stack([joint.acceleration, np.sin(angle), np.cos(angle), np.ones_like(angle), *friction])


@dataclass(frozen=True, eq=False)
class _Arm:
    """Joints that move, by their names, and which of them it is about."""

    joint: str
    moving: Mapping[str, Motion]

    def behind(self, name: str, other: str) -> list[str]:
        """The joints behind the first of two, on whose angles alone their inertia depends; all where no order is known."""
        if not all(each.isdigit() for each in self.moving):
            return sorted(self.moving)
        return sorted((each for each in self.moving if int(each) > min(int(name), int(other))), key=int)

    def terms(self) -> Iterator[_Term]:
        """Of the energy, as far as the torque of the joint has anything of them."""
        for each in _sums(sorted(self.moving), CROSSED, (1,)):
            if self.joint in dict(each) and len(each) > 1:
                yield from (_Term((), each, is_sine) for is_sine in (True, False))
        for pair in combinations_with_replacement(sorted(self.moving), 2):
            if self.joint in pair and len(set(pair)) == 2:
                yield _Term(pair, (), False)
            for each in _sums(self.behind(*pair), 2, (1, 2)):
                if self.joint in pair or self.joint in dict(each):
                    yield from (_Term(pair, each, is_sine) for is_sine in (True, False))


def _sums(names: Sequence[str], most: int, times: Sequence[int]) -> Iterator[tuple[tuple[str, int], ...]]:
    """Sums of multiples of angles, each but for its sign."""
    for count in range(1, most + 1):
        for chosen in combinations(names, count):
            for factors in product(times, *((*times, *(-each for each in times)) for _ in chosen[1:])):
                yield tuple(zip(chosen, factors, strict=True))


@dataclass(frozen=True)
class _Term:
    """Of the energy: the sine or cosine of a sum of angles, times the speeds of two joints, or of none for gravity."""

    speeds: tuple[str, ...]
    sum_of: tuple[tuple[str, int], ...]
    is_sine: bool

    @property
    def name(self) -> str:
        """As `dq1 dq2 cos(2q2-q3)`."""
        inner = "".join(
            f"{'-' if times < 0 else '+'}{abs(times) if abs(times) > 1 else ''}q{name}" for name, times in self.sum_of
        )
        wave = f"{'sin' if self.is_sine else 'cos'}({inner.removeprefix('+')})" if self.sum_of else ""
        return " ".join([*(f"dq{name}" for name in self.speeds), *([wave] if wave else [])])

    def plain(self, joint: str) -> float:
        """Less for each other joint in it: arms move in like periods, so that terms of many joints explain what a few cause."""
        others = {*self.speeds, *dict(self.sum_of)} - {joint}
        return float(PLAIN ** len(others))

    @property
    def expected(self) -> float:
        """How large its share may be, over that of the plainest terms: less for each more angle and multiple in its sum."""
        angles = sum(abs(times) for _, times in self.sum_of)
        return float(SMALLER ** max(angles - 1, 0))

    def torque(self, arm: _Arm) -> Array:
        """What it adds to the torque of the joint, by Lagrange's equations, shape (n,)."""
        moving, own = arm.moving, arm.joint
        angle = sum((times * moving[name].angle for name, times in self.sum_of), np.zeros_like(moving[own].angle))
        wave, slope = (np.sin(angle), np.cos(angle)) if self.is_sine else (np.cos(angle), -np.sin(angle))
        by_own = dict(self.sum_of).get(own, 0) * slope
        if not self.speeds:
            return by_own
        first, second = (moving[name] for name in self.speeds)
        found: Array = -by_own * first.speed * second.speed
        if own not in self.speeds:
            return found
        other = second if self.speeds[0] == own else first
        twice = 2.0 if other is moving[own] else 1.0
        if other is moving[own]:  # about its mean, so that the inertia of the joint is that in the mean
            wave = wave - np.average(wave, weights=other.acceleration**2)
        rate = slope * sum((times * moving[name].speed for name, times in self.sum_of), np.zeros_like(angle))
        return found + twice * (wave * other.acceleration + rate * other.speed)


def _columns(motion: Motion, arm: _Arm, terms: Sequence[_Term]) -> Array:
    """The terms in the pass band, a column each."""
    found = np.empty((len(motion.rows), len(terms)))
    for begin in range(0, len(terms), AT_ONCE):
        some = terms[begin : begin + AT_ONCE]
        found[:, begin : begin + len(some)] = motion.filtered(np.stack([term.torque(arm) for term in some])).T
    return found
