"""Unidirectional positioning: the lost motion of a gear, and paths that always arrive from the same side."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from strainwave import Gear, arguments, typeset
from strainwave.presentation import Pictured, Presented, counted
from strainwave.simulation import scenario
from strainwave.simulation.scenario import Scenario
from strainwave.simulation.time_grid import check_instants

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Array = NDArray[np.float64]

SETTLING_CYCLES = 32  # of the torque before the one that is read; hysteresis without closed minor loops then repeats
CREEP_SPEED = 1e-9  # rad/s: friction at this speed and at twice as much, extrapolated to 0, has no viscous part
PEAK_SPEED = 15.0 / 8.0  # of a minimum-jerk motion, over its mean speed
PEAK_ACCELERATION = 10.0 / np.sqrt(3.0)  # of a minimum-jerk motion, over travel / duration^2
DEFAULT_FACTOR = 1.2  # overshoot over lost motion


@dataclass(frozen=True)
class LostMotion(Presented):
    """Lost motion of a gear whose output turns back under a load torque.

    Attributes:
        load_torque: mean torque of the load [N.m]
        swing: largest deviation of the torque from it, either way [N.m]
        width: separation of both branches of the loop at the load torque, at the output [rad]
        extent: whole twist of the loop, from one end of the torque to the other, at the output [rad]
        ratio: size of the ratio of the gear, input over output [1]

    >>> import strainwave as sw
    >>> lost = sw.tuning.lost_motion(sw.rig.printed_gear(0), swing=36.0)  # N.m of friction and inertia at the output
    >>> [round(1e3 * angle, 1) for angle in (lost.width, lost.extent, lost.overshoot())]  # mrad at the output
    [8.8, 10.4, 12.4]
    """

    load_torque: float
    swing: float
    width: float
    extent: float
    ratio: float

    @property
    def input_width(self) -> float:
        """The width as an angle of the input [rad]."""
        return self.width * self.ratio

    @property
    def input_extent(self) -> float:
        """The extent as an angle of the input [rad]."""
        return self.extent * self.ratio

    def overshoot(self, factor: float = DEFAULT_FACTOR) -> float:
        """Return the travel of the output [rad] that takes up the lost motion with a margin.

        Args:
            factor: overshoot over extent, 1 or more

        Raises:
            ValueError: the factor is less than 1
        """
        return arguments.number("factor", factor, "", "[)", 1.0) * self.extent

    def _headline(self) -> str:
        width, extent = (typeset.quantity(angle, "rad") for angle in (self.width, self.extent))
        return f"width {width}, extent {extent} at the output, load {typeset.quantity(self.load_torque, 'N.m')}"


def lost_motion(gear: Gear, load_torque: float = 0.0, swing: float = 0.0) -> LostMotion:
    r"""Return the lost motion of a gear between both senses of motion, from its quasi-static loop.

    While the output moves, the gear transmits the load torque and the friction of the output, T = T_l + s F, with s the sense
    of motion. When the output rests, friction holds this torque, and with it the twist. So the output stops at

    .. math:: \theta_{out} = \theta_{in} / i - \delta(T_l + s\,S), \qquad S = F + \text{swing}

    and arrivals from both sides differ by the extent of the loop between T_l + S and T_l - S; that from below rests lower. If
    an inertia without friction is braked smoothly, the torque returns to T_l: they differ by its width, and that from below
    rests higher.

    Friction of the input and the mesh does not change the twist at given input angle. It changes where a position loop without
    integral action leaves the input.

    Args:
        gear: any spring and hysteresis; the friction of its output counts at rest, under the load torque, at 293.15 K
        load_torque: constant torque of the load, positive if it holds the output back [N.m]
        swing: what the load takes besides, either way: friction of its own, inertia times acceleration [N.m]

    Returns:
        Width and extent of the loop, as angles of the output [rad] and of the input.

    Raises:
        TypeError: `gear` is no gear
        ValueError: a number is out of its range, no twist yields the torque, or neither friction of the output nor `swing` lets
            the torque change its size

    Source:
        the torsional stiffness article, section "Discussion" (unidirectional positioning); the loop: own derivation

    >>> import math
    >>> import strainwave as sw
    >>> lost = lost_motion(sw.rig.printed_gear(0), swing=36.0)  # of the article, 0.36 N.m at the input of 1:100
    >>> round(math.degrees(lost.input_width), 6)
    50.5
    """
    gear = arguments.gear(gear)
    load = arguments.number("load_torque", load_torque, "N.m")
    added = arguments.number("swing", swing, "N.m", "[)", 0.0)
    deviation = friction_at_rest(gear.friction_output, load) + added
    if deviation == 0.0:
        raise ValueError(
            "swing = 0 N.m, and the gear has no friction of the output: its torque does not change when the output turns back; "
            "state the friction of the load, or its inertia times its acceleration"
        )
    high, low = load + deviation, load - deviation
    twist = gear.twist(np.concatenate(([0.0], np.tile([high, low], SETTLING_CYCLES), [high, load, low, load, high])))
    falling, lowest, rising, highest = twist[-4:]
    return LostMotion(load, deviation, float(falling - rising), float(highest - lowest), abs(float(gear.kinematics.ratio)))


def friction_at_rest(law: Any, load: float = 0.0) -> float:
    """Return the torque [N.m] that a friction takes at rest, under a load [N.m]; that of bristles where they begin to slide."""
    torques = []
    for sense in (1.0, -1.0):
        slow, twice = (law.steady(factor * sense * CREEP_SPEED, load=load) for factor in (1.0, 2.0))
        torques += [float(law.hold(sense, load=load)), 2.0 * slow - twice]
    return float(np.abs(torques).max())


@dataclass(frozen=True)
class PositioningPath(Pictured):
    """A path that visits targets and rests at each.

    Attributes:
        command: angle of the output over time [rad]
        targets: in the order of their visits [rad], shape (n,)
        rests: time at the end of the rest at each target [s], shape (n,)

    >>> import strainwave as sw
    >>> path = sw.tuning.positioning_path([0.2, 0.1], 0.02, speed=1.0, acceleration=10.0)
    >>> path.rests.round(3), path.command.value(path.rests).round(6)
    (array([0.875, 2.246]), array([0.2, 0.1]))
    """

    command: Scenario
    targets: Array
    rests: Array

    def _headline(self) -> str:
        return f"{counted(len(self.targets), 'target')} in {typeset.quantity(self.command.duration, 's')}"

    def plot(self) -> Figure:
        """Return a figure of the commanded angle of the output over time."""
        return self.command.plot("angle of the output", "rad")


def positioning_path(
    targets: ArrayLike,
    overshoot: float,
    *,
    speed: float,
    acceleration: float,
    rest: float = 0.5,
    start: float = 0.0,
    from_above: bool = False,
    sample: float = 1e-3,
) -> PositioningPath:
    r"""Return a path that arrives at each target from the same side, after a travel of at least the overshoot.

    From below, the path goes to target - overshoot first, unless it comes from there or from farther below; so every last
    motion is at least as long as the overshoot. Each motion has minimum jerk,

    .. math:: \theta(t) = \theta_0 + D\,(10 s^3 - 15 s^4 + 6 s^5), \quad s = t/\tau, \quad
              \tau = \max\!\Big(\tfrac{15}{8}\tfrac{D}{v}, \sqrt{\tfrac{10}{\sqrt 3} \tfrac{D}{a}}\Big)

    in straight pieces of at most `sample`.

    Args:
        targets: angles of the output [rad], shape (n,), in the order of the visits
        overshoot: as `LostMotion.overshoot` returns it [rad]; 0 for the plain path, straight from target to target
        speed: largest v of the output [rad/s]
        acceleration: largest a of the output [rad/s^2]
        rest: at each target, and where the motion turns back [s]
        start: angle of the output at the begin [rad]
        from_above: True to arrive from above, so in falling motion
        sample: longest piece of the command [s]

    Returns:
        The command [rad] over time, and the time at the end of the rest at each target [s], shape (n,).

    Raises:
        TypeError: an argument is not of its kind
        ValueError: there is no target, a number is not finite or out of its range, or the path has too many pieces

    Source:
        the torsional stiffness article, section "Discussion"; motion of minimum jerk: FlashHogan1985

    >>> path = positioning_path([0.2, 0.1], 0.02, speed=1.0, acceleration=10.0)
    >>> [round(float(path.command.value(time)), 9) for time in path.rests]
    [0.2, 0.1]
    >>> low = path.command.value(np.linspace(path.rests[0], path.rests[1], 1001)).min()
    >>> round(float(low), 9)  # it turns back below the second target
    0.08
    """
    angles = np.atleast_1d(arguments.numbers("targets", targets)).copy()
    if angles.ndim != 1 or not angles.size or not np.isfinite(angles).all():
        raise ValueError("targets must be a series of one or more finite angles")
    overshoot = arguments.number("overshoot", overshoot, "rad", "[)", 0.0)
    speed = arguments.number("speed", speed, "rad/s", low=0.0)
    acceleration = arguments.number("acceleration", acceleration, "rad/s^2", low=0.0)
    rest, sample = arguments.seconds("rest", rest), arguments.seconds("sample", sample)
    place, now = arguments.number("start", start, "rad"), 0.0
    times, values, rests = [np.zeros(1)], [np.full(1, place)], []
    side = -1.0 if from_above else 1.0
    for target in angles.tolist():
        before = target - side * overshoot
        turns = overshoot > 0.0 and side * (place - before) > 0.0
        for goal in (before, target) if turns else (target,):
            time, share = _minimum_jerk(abs(goal - place), speed, acceleration, sample)
            end = time[-1] + rest
            times.append(now + np.append(time[1:], end))
            values.append(np.append(place + (goal - place) * share[1:], goal))
            place, now = goal, now + end
        rests.append(now)
    return PositioningPath(scenario.table(np.concatenate(times), np.concatenate(values)), angles, np.array(rests))


def _minimum_jerk(travel: float, speed: float, acceleration: float, sample: float) -> tuple[Array, Array]:
    """Return the times [s] of a motion within limits, from 0, and its shares of the travel; one instant if there is none."""
    duration = max(PEAK_SPEED * travel / speed, float(np.sqrt(PEAK_ACCELERATION * travel / acceleration)))
    check_instants(duration, sample, "take longer pieces")
    part = np.linspace(0.0, 1.0, int(np.ceil(duration / sample)) + 1)
    return duration * part, part**3 * (10.0 - 15.0 * part + 6.0 * part**2)
