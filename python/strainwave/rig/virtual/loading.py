"""A gear under the steps of a torsion test: where its loaded shaft comes to rest, the other one held."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from strainwave import arguments
from strainwave._core import Gear
from strainwave.equality import ComparedByFields
from strainwave.files.gear_file import at
from strainwave.rig.bench.setup import Rig
from strainwave.rig.bench.steps import Step

Array = NDArray[np.float64]
POINTS_PER_STRETCH = 64  # evaluated at once in a search
STRETCH_GROWTH = 4.0  # ratio of a stretch to the one before [1]: the spacing is 1/16 of the distance or less
SEARCH_REFINEMENTS = 9  # of the first stretch, each by 1/64: 64^-9 is below rounding
FIRST_REACH, MAX_REACH = 1e-7, 1e5  # rad, of the shaft: where a search begins and where it gives up


@dataclass(frozen=True, eq=False)
class Loading(ComparedByFields):
    """Angles and torques of a gear and its rig under the steps of a test, each of shape (n,).

    Attributes:
        angle: of the disk, from where it is at the first step [rad]
        seen: the same as photographed, before all of it had settled [rad]
        applied: torque of the weights on the disk [N.m]
        shaft: torque on the shaft, what pulleys hold taken off [N.m]
        elastic: torque of the gear's springs at that shaft, what its friction holds taken off, too [N.m]
        twist: of the gear, at its output [rad]
    """

    angle: Array
    seen: Array
    applied: Array
    shaft: Array
    elastic: Array
    twist: Array


def load_by_steps(
    gear: Gear, rig: Rig, steps: Sequence[Step], *, wait: float = 60.0, settling: float = 0.0, virgin: bool = False
) -> Loading:
    r"""Load a gear slowly by the masses of a test, step after step.

    Springs and hysteresis of the gear are followed with all their memory. Dry friction holds in series with them: that of the
    pulleys, T_0 + share \|T\|, then that of the gear itself at rest, at its breakaway. Each is a play: the torque behind it
    follows the torque before it once they differ by what the friction holds. With m the total on a pair of pans,

    .. math:: T = (m_+ - m_-) g r, \quad T_{shaft} \leftarrow \operatorname{clip}(T_{shaft}, T \pm (T_0 + s |T|)), \quad
              T_{el} \leftarrow \operatorname{clip}(T_{el}, T_{shaft} \pm F(T_{el})), \quad
              \theta_{disk} = \theta + C \, T_{shaft}

    On the input side, output held, :math:`\delta = \theta / i - e(\theta)` and :math:`T_{el} = T(\delta) (1/i - e')`; on the
    output side, input held, theta is the twist. A cord from a fixed point has the arm r cos(angle - tangent), so the torque
    changes as the disk turns. The disk moves one way until it first finds an equilibrium. Everything is at the reference
    temperature; errors that follow load or speed are taken as they are without.

    Args:
        gear: which gear
        rig: which rig; the values of its numbers are taken to be true
        steps: as made; a torque measured otherwise is taken as that of the shaft, without cords and pulleys
        wait: between the change of the masses and the photograph, if steps have no times [s]
        settling: time constant with which the disk comes to rest [s]; 0 if at once
        virgin: whether the gear was never loaded before; else it goes through all the steps once beforehand

    Returns:
        Angles and torques of every step.

    Raises:
        TypeError: no gear
        ValueError: there are no steps, the gear's parts are not those of one spring, no equilibrium exists

    Source:
        play in series: the definition of dry friction; plays in series are one, Visintin1994

    >>> import strainwave as sw
    >>> from strainwave.rig import Rig, Step, Value
    >>> gear = sw.Gear(stiffness=sw.stiffness.Linear(k=1e4), friction_input=sw.friction.Coulomb(coulomb=0.02))
    >>> rig = Rig("bench", "input", disk_radius=Value(0.1), gravity=Value(10.0))
    >>> masses = [0.0, 0.1, 0.2, 0.1, 0.0]
    >>> loading = load_by_steps(gear, rig, [Step(n, mass) for n, mass in enumerate(masses, 1)], virgin=True)
    >>> loading.angle.round(3).tolist(), loading.applied.round(3).tolist()
    ([0.0, 0.08, 0.18, 0.12, 0.02], [0.0, 0.1, 0.2, 0.1, 0.0])
    """
    arguments.gear(gear)
    wait = arguments.number("wait", wait, "s", brackets="[)", low=0.0)
    settling = arguments.number("settling", settling, "s", brackets="[)", low=0.0)
    if not steps:
        raise ValueError("steps: a test needs one step or more")
    states = _through(gear, rig, steps, virgin)
    angle = np.array([state.disk - states[0].disk for state in states])
    gaps = [wait if a.time is None or b.time is None else b.time - a.time for a, b in pairwise(steps)]
    seen = angle.copy()  # as a first-order delay shows it, which is at rest where the first step is
    for k in range(1, len(angle)) if settling > 0.0 else ():
        seen[k] = angle[k] + (seen[k - 1] - angle[k]) * np.exp(-gaps[k - 1] / settling)
    return Loading(
        angle,
        seen,
        np.array([state.applied for state in states]),
        np.array([state.torque for state in states]),
        np.array([state.elastic for state in states]),
        np.array([state.twist for state in states]),
    )


@dataclass(frozen=True)
class _State:
    """State of rest: angle of the disk, torques, twist."""

    disk: float = 0.0
    applied: float = 0.0
    torque: float = 0.0
    elastic: float = 0.0
    twist: float = 0.0


def _through(gear: Gear, rig: Rig, steps: Sequence[Step], virgin: bool) -> list[_State]:
    shaft, state = _Shaft(gear, rig), _State()
    for _ in range(1 if virgin else 2):
        states: list[_State] = []
        for step in steps:
            reference = states[0].disk if states else None
            with at(f"step {step.number}:"):
                state = _moved(shaft, rig, state, _Weights(rig, step, reference))
            states.append(state)
    return states


@dataclass(frozen=True)
class _Weights:
    """Torque on the disk over its angle at one step; the reading of the angle is 0 at the first one, which has no reference."""

    rig: Rig
    step: Step
    reference: float | None

    def torque(self, disk: Array) -> Array:
        if self.step.torque is not None:
            return np.full_like(disk, self.step.torque)
        mass = self.step.mass_positive - self.step.mass_negative
        arm = np.full_like(disk, self.rig.disk_radius.value)
        if self.rig.cord == "fixed point":
            reading = disk - self.reference if self.reference is not None else 0.0
            arm *= np.cos(reading - self.rig.cord_tangent.value)
        return mass * self.rig.gravity.value * arm

    def behind_pulleys(self, disk: Array, sense: float) -> Array:
        """Torque that arrives at the shaft while the disk turns in a sense."""
        torque = self.torque(disk)
        if self.step.torque is not None:
            return torque
        return torque - sense * (self.rig.pulley_torque.value + self.rig.pulley_share.value * np.abs(torque))


class _Shaft:
    """The loaded shaft of a gear: its torques along the path that it has gone."""

    def __init__(self, gear: Gear, rig: Rig) -> None:
        for part in ("structure", "stiffness_variation"):
            if getattr(gear, part).fields:
                model = type(getattr(gear, part)).__name__
                raise ValueError(f"gear.{part} = {model}(...): the virtual rig loads gears of one spring that does not vary")
        self.gear, self.input = gear, rig.side == "input"
        self.at_zero = float(self._error(np.zeros(1))[0])
        self.path = np.zeros(1)  # where it turned back, and where it is

    def go(self, angle: float) -> None:
        """Moves on; what lies between two turning points leaves no memory."""
        on = len(self.path) > 1 and (angle - self.path[-1]) * (self.path[-1] - self.path[-2]) > 0.0
        self.path = np.append(self.path[:-1] if on else self.path, angle)

    def _error(self, angle: Array) -> Array:
        return np.asarray(self.gear.kinematic_error.error(angle) + self.gear.kinematic_noise.error(angle))

    def twist(self, angle: Array) -> Array:
        """Twist of the gear [rad], nothing of it where the test began."""
        if not self.input:
            return angle
        return angle / self.gear.kinematics.ratio - (self._error(angle) - self.at_zero)

    def _per_angle(self, angle: Array) -> Array:
        """Twist per angle of the shaft [1]."""
        if not self.input:
            return np.ones_like(angle)
        slope = self.gear.kinematic_error.slope(angle) + self.gear.kinematic_noise.slope(angle)
        per_angle: Array = 1.0 / self.gear.kinematics.ratio - slope
        if np.any(per_angle * self.gear.kinematics.ratio <= 0.0):
            raise ValueError("the kinematic error is so steep that it turns the twist back; the virtual rig cannot follow it")
        return per_angle

    def torques(self, further: Array) -> tuple[Array, Array]:
        """Torque of the springs, and what friction adds while it moves, further along the path [N.m]."""
        angle = np.append(self.path, further)
        twist, per_angle = self.twist(angle), self._per_angle(angle)
        spring = self.gear.trace(twist)
        elastic, gear = per_angle * spring, self.gear
        if self.input:
            friction = gear.friction_input.quasistatic(angle, load=elastic)
            friction = friction + per_angle * gear.friction_mesh.quasistatic(twist, load=spring)
        else:  # a twist of the spring turns the output back
            friction = -gear.friction_output.quasistatic(-angle, load=spring)
        return elastic[len(self.path) :], friction[len(self.path) :]


def _moved(shaft: _Shaft, rig: Rig, state: _State, weights: _Weights) -> _State:
    """Return the state of rest under other weights."""
    here = np.array([state.disk])
    for sense in (1.0, -1.0):
        push = float(weights.behind_pulleys(here, sense)[0]) - state.torque
        if sense * push > 0.0:
            return _followed(shaft, rig.compliance.value, state, weights, sense)
    return _State(state.disk, float(weights.torque(here)[0]), state.torque, state.elastic, state.twist)


def _followed(shaft: _Shaft, compliance: float, state: _State, weights: _Weights, sense: float) -> _State:
    """Return the state of rest in the direction of motion. The coupling gives way first, then the shaft breaks away."""
    still = float(shaft.path[-1])

    def rest(torque: float, angle: float) -> _State:
        disk = angle + compliance * torque
        elastic, twist = float(shaft.torques(np.array([angle]))[0][0]), float(shaft.twist(np.array([angle]))[0])
        return _State(disk, float(weights.torque(np.array([disk]))[0]), torque, elastic, twist)

    nearly = np.array([still + sense * 1e-13 * max(1.0, abs(still))])
    elastic, friction = shaft.torques(nearly)
    breakaway = sense * max(sense * float(elastic[0] + friction[0]), sense * state.torque)

    def lacking(torque: Array) -> Array:  # while the shaft sticks
        return sense * (weights.behind_pulleys(still + compliance * torque, sense) - torque)

    if lacking(np.array([breakaway]))[0] <= 0.0:
        return rest(_crossing(lacking, state.torque, breakaway), still)

    def moving(angle: Array) -> Array:
        torque = np.add(*shaft.torques(angle))
        return sense * (weights.behind_pulleys(angle + compliance * torque, sense) - torque)

    angle = _searched(moving, still, sense)
    torque = float(np.add(*shaft.torques(np.array([angle])))[0])
    state = rest(torque, angle)
    shaft.go(angle)
    return state


def _searched(lacking: Callable[[Array], Array], start: float, sense: float) -> float:
    """Return the first zero of the lacking torque on the way from the start."""
    near, reach = 0.0, FIRST_REACH
    while lacking(start + sense * np.linspace(near, reach, POINTS_PER_STRETCH)[1:]).min() > 0.0:
        near, reach = reach, STRETCH_GROWTH * reach
        if reach > MAX_REACH:
            raise ValueError("nothing holds the disk: the gear, or the arm of the cord, gives way for ever")
    return _crossing(lacking, start + sense * near, start + sense * reach)


def _crossing(lacking: Callable[[Array], Array], low: float, high: float) -> float:
    """The first point between two, as fine as numbers are, where what is lacking is nothing."""
    for _ in range(SEARCH_REFINEMENTS):
        points = np.linspace(low, high, POINTS_PER_STRETCH)
        beyond = np.flatnonzero(lacking(points[1:]) <= 0.0)
        if not len(beyond):
            return high
        low, high = float(points[beyond[0]]), float(points[beyond[0] + 1])
    return high
