"""Torque of a joint by the joints that move with it, without a model of the arm.

The energy of an arm of rigid links is a sum of products of two speeds, or of gravity, with sines and cosines of sums of the
angles; the inertia of two joints depends on the angles of those behind the first of them alone (KhalilDombre2002, ch. 9).
Lagrange's equations make of each such term of the energy one of the torque, centrifugal and Coriolis forces included:

.. math:: \\frac{\\mathrm d}{\\mathrm dt} \\frac{\\partial E}{\\partial \\dot q_j} - \\frac{\\partial E}{\\partial q_j}

The geometry of an arm determines its terms, and is not known here. Gravity acts along a chain of joints (`chain`). Of the
kinetic energy the terms that explain the torque best are added one by one, as long as they also predict blocks of time by which
they were not chosen. A term of one more joint must explain twice as much, as joints of an arm move in like periods.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations, combinations_with_replacement, product

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive
from strainwave.identification.candidates.plain import stretches
from strainwave.identification.dynamics.chain import Sum, best_chain, named
from strainwave.identification.dynamics.selection import Selection, independent
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
MIN_ROWS = 50  # in the pass band before the last stretch, by which terms are found
TERMS_AT_ONCE = 64  # that are filtered


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
    if np.count_nonzero(known) < MIN_ROWS:
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
    found = best_chain(torque, base[:, PLAIN_BASE], lambda each: own.filtered(series(each)).T[known], place, count)
    sums = [each for each in (found.sums() if found else ()) if len(each) > 1]  # its own angle has a place in the load
    waves = {
        f"{wave}({word})": values
        for each, word in zip(sums, named(sums, names), strict=True)
        for wave, values in zip(("sin", "cos"), series(each), strict=True)
    }
    if not waves:
        return {}
    kept = independent(base, own.filtered(np.stack(list(waves.values()))).T[known], MIN_INDEPENDENT_WAVE)
    return {name: values for place, (name, values) in enumerate(waves.items()) if place in kept}


def _with_energy(log: MotionLog, arm: _Arm, torque: Array, base: Array, known: Rows) -> Iterator[MotionLog]:
    """Yield the log with terms of the kinetic energy, chosen with a loss under load, which they can imitate, and without."""
    own, terms = log.motion, list(arm.terms())
    columns = _columns(own, arm, terms)
    lossy = np.column_stack([base, _loss(torque, base, known) * np.sign(own.speed[own.rows])])
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


def _loss(torque: Array, base: Array, known: Rows) -> Array:
    """Return the size of the torque by inertia and gravity, of which a gear loses a share, shape (n,)."""
    rigid = np.array([*range(END_OF_RIGID), *range(END_OF_FRICTION, base.shape[1])])
    return np.asarray(np.abs(base[:, rigid] @ solved(base[known], torque[known])[rigid]))


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
    """Return the terms in the pass band, a column each, shape (rows, terms)."""
    found = np.empty((len(motion.rows), len(terms)))
    for begin in range(0, len(terms), TERMS_AT_ONCE):
        some = terms[begin : begin + TERMS_AT_ONCE]
        found[:, begin : begin + len(some)] = motion.filtered(np.stack([term.torque(arm) for term in some])).T
    return found
