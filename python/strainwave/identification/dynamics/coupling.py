"""Torque of a joint by the joints that move with it, without a model of the arm.

The energy of an arm of rigid links is a sum of products of two speeds, or of gravity, with sines and cosines of sums of the
angles; the inertia of two joints depends on the angles of those behind the first of them alone (KhalilDombre2002, ch. 9).
Lagrange's equations make of each such term of the energy one of the torque, centrifugal and Coriolis forces included:

.. math:: \\frac{\\mathrm d}{\\mathrm dt} \\frac{\\partial E}{\\partial \\dot q_j} - \\frac{\\partial E}{\\partial q_j}

Which terms an arm has, its geometry says, which is not known here: those are taken, one after another, that explain the torque
best, for as long as they also predict blocks of time that they were not chosen by. A term of one more joint must explain twice
as much, as joints of an arm often move in like periods, and many terms then explain the same.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations, combinations_with_replacement, product

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive
from strainwave.identification.experiments.motion import Motion, motion_of
from strainwave.identification.experiments.motion_log import MotionLog, per_torque

Array = NDArray[np.float64]

BLOCKS = 10  # of time; the odd ones are left for who compares models, of the others every second one checks
MOST = 40  # terms
PATIENCE = 4  # terms that may bring nothing before the search ends
BETTER = 0.99  # of the error, that the terms of a step must leave at most
PLAIN = 0.5  # what a term counts for each other joint in it
INDEPENDENT = 1e-3  # of a term's size, that must not be told by terms before it
RIGID = 3  # of what a joint has by itself: inertia and gravity
SLOW = (0.1, 0.5)  # of the usual speed, at which friction may fall
AT_ONCE = 64  # terms that are filtered at a time
CROSSED = 3  # angles in a sum, for gravity


@dataclass(frozen=True)
class Coupled:
    """A log with the terms of other joints.

    Attributes:
        log: with the terms as regressors, by their names
        joints: that move, too
        before, after: rms error on the blocks that check, over the rms of the torque about its mean, without and with the terms
    """

    log: MotionLog
    joints: tuple[str, ...]
    before: float
    after: float


def coupled(log: MotionLog, drive: Drive, time: Array, others: Mapping[str, Array], joint: str = "") -> Coupled:
    """A log with those terms of other joints that its torque shows.

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
    search = _Search(torque, base, np.array([term.plain(joint) for term in terms]), block % 4 == 0, block % 4 == 2)
    loss = search.transmitted(columns[:, search.best(columns)]) * np.sign(own.speed[own.rows])
    search = replace(search, base=np.column_stack([base, loss]))
    places = search.best(columns)
    taken = [terms[place] for place in places]
    regressors = {term.name: term.torque(arm) for term in taken}
    found = replace(log, regressors={**log.regressors, **regressors})
    return Coupled(found, tuple(others), search.error(columns[:, []]), search.error(columns[:, places]))


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


@dataclass(frozen=True, eq=False)
class _Search:
    """Forward selection of terms by orthogonal least squares (ChenBillingsLuo1989), checked on other blocks of time.

    Attributes:
        torque: shape (n,)
        plain: what a term counts for beside others that explain as much, shape (t,)
        base: columns of what every joint has, shape (n, b)
        train, check: rows that terms are chosen by, and those that check them, shape (n,)
    """

    torque: Array
    base: Array
    plain: Array
    train: NDArray[np.bool_]
    check: NDArray[np.bool_]

    def best(self, columns: Array) -> list[int]:
        """The columns to take, in the order of what they explain."""
        taken: list[int] = []
        errors = [self.error(columns[:, taken])]
        left = columns[self.train] / np.maximum(np.linalg.norm(columns[self.train], axis=0), 1e-300)
        orthogonal, _ = np.linalg.qr(self.base[self.train])
        left -= orthogonal @ (orthogonal.T @ left)
        rest = self.torque[self.train] - orthogonal @ (orthogonal.T @ self.torque[self.train])
        while len(taken) < min(MOST, columns.shape[1]):
            squares = np.einsum("ij,ij->j", left, left)
            explained = (rest @ left) ** 2 / np.maximum(squares, 1e-300)
            scores = np.where(squares > INDEPENDENT**2, self.plain * explained, 0.0)
            place = int(np.argmax(scores))
            if scores[place] == 0.0:
                break
            direction = left[:, place] / np.sqrt(squares[place])
            left -= np.outer(direction, direction @ left)
            rest -= direction * (direction @ rest)
            taken.append(place)
            errors.append(self.error(columns[:, taken]))
            if min(errors[-PATIENCE:]) > BETTER * min(errors[:-PATIENCE] or [np.inf]):
                break
        least = min(errors)
        return taken[: next(count for count, error in enumerate(errors) if error <= least / BETTER)]

    def transmitted(self, columns: Array) -> Array:
        """Size of the torque without friction, of which some is lost, shape (n,)."""
        kept = np.hstack([self.base[:, :RIGID], columns])
        shares = _shares(np.hstack([kept, self.base[:, RIGID:]])[self.train], self.torque[self.train])
        return np.asarray(np.abs(kept @ shares[: kept.shape[1]]))

    def error(self, columns: Array) -> float:
        """Error of the rows that check, by the shares that the others tell, over how much the torque varies."""
        every = np.hstack([self.base, columns])
        left = self.torque[self.check] - every[self.check] @ _shares(every[self.train], self.torque[self.train])
        return float(np.sqrt(np.mean(left**2)) / np.std(self.torque))


def _shares(columns: Array, torque: Array) -> Array:
    """By least squares."""
    size = np.linalg.norm(columns, axis=0)
    size[size == 0.0] = 1.0
    found: Array = np.linalg.lstsq(columns / size, torque, rcond=1e-8)[0] / size
    return found


def _columns(motion: Motion, arm: _Arm, terms: Sequence[_Term]) -> Array:
    """The terms in the pass band, a column each."""
    found = np.empty((len(motion.rows), len(terms)))
    for begin in range(0, len(terms), AT_ONCE):
        some = terms[begin : begin + AT_ONCE]
        found[:, begin : begin + len(some)] = motion.filtered(np.stack([term.torque(arm) for term in some])).T
    return found
