"""The steady loop of a gear as its model has it: slow, so that only spring, hysteresis and friction at rest speak."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from strainwave import _core, arguments
from strainwave._core import Gear
from strainwave.equality import ComparedByFields
from strainwave.presentation import Presented
from strainwave.rig.loop import COLUMNS, Side, positive

Array = NDArray[np.float64]

POINTS_PER_QUARTER = 200  # of a cycle: the area is then within 1e-4 of the exact one
POINTS_FOR_ENDS = 1  # of a quarter if only its ends are needed: the laws are exact over any monotone step
CYCLES_RUN = 2  # the last one counts


@dataclass(frozen=True)
class Factors:
    """Factors of the torques of a gear: of its spring, of its hysteresis, and of its friction at the input.

    >>> import strainwave as sw
    >>> warm = sw.rig.Factors(stiffness=0.99, friction=0.8)
    >>> sw.rig.cycle_to(sw.load("csg-25-100"), 0.5, side="input", factors=warm).area < 0.9 * sw.rig.cycle_to(
    ...     sw.load("csg-25-100"), 0.5, side="input"
    ... ).area
    True
    """

    stiffness: float = 1.0
    hysteresis: float = 1.0
    friction: float = 1.0


@dataclass(frozen=True, eq=False)
class Cycle(ComparedByFields, Presented):
    """A steady cycle from the positive peak to the negative one and back.

    Args:
        angle: of the loaded shaft [rad], shape (n,)
        torque: on the loaded shaft [N.m], shape (n,)
        elastic: torque of spring and hysteresis alone, at the output [N.m], shape (n,)
        side: the loaded shaft

    >>> import strainwave as sw
    >>> loop = sw.rig.cycle_to(sw.load("csg-25-100"), 87.0)
    >>> loop.peak, round(loop.stiffness), round(loop.area, 5)  # N.m, N.m/rad, J
    (87.0, 47912, 0.01344)
    """

    angle: Array
    torque: Array
    elastic: Array
    side: Side

    @property
    def peak(self) -> float:
        """Largest torque [N.m]."""
        return float(self.torque.max())

    @property
    def area(self) -> float:
        """Energy lost in the cycle [J]."""
        return float(np.trapezoid(self.torque, self.angle))

    @property
    def stiffness(self) -> float:
        """Secant between the two peaks [N.m/rad]."""
        return float(np.ptp(self.torque) / np.ptp(self.angle))

    @property
    def width(self) -> float:
        """Widest separation at equal torque [rad]: the torsional stiffness article's hysteresis."""
        return float(self._separations().max())

    @property
    def width_at_zero(self) -> float:
        """Separation at zero torque [rad]: the catalogue's hysteresis loss."""
        return float(np.interp(0.0, self._levels(), self._separations()))

    @property
    def high_stiffness(self) -> float:
        """Slope of the unloading regimes [N.m/rad], regression of the angle on the torque, mean compliance of both senses."""
        down, up = self._branches()
        return _mean_stiffness([(*down, 1.0), (*up, -1.0)])

    @property
    def low_stiffness(self) -> float:
        """Slope of the loading regimes [N.m/rad], from zero to the peaks, likewise."""
        down, up = self._branches()
        return _mean_stiffness([(*down, -1.0), (*up, 1.0)])

    def _branches(self) -> tuple[tuple[Array, Array], tuple[Array, Array]]:
        turn = int(np.argmin(self.elastic))
        return (self.torque[: turn + 1], self.angle[: turn + 1]), (self.torque[turn:], self.angle[turn:])

    def _levels(self) -> Array:
        return np.linspace(-self.peak, self.peak, 4 * POINTS_PER_QUARTER + 1)

    def _separations(self) -> Array:
        (down, back), (up, forth) = self._branches()
        levels = self._levels()
        apart = np.interp(levels, down[::-1], back[::-1]) - np.interp(levels, up, forth)
        return np.asarray(apart)


def _mean_stiffness(regimes: list[tuple[Array, Array, float]]) -> float:
    """Return the mean stiffness of regimes, each given by torque and angle of a branch and the sign of its torque."""
    compliances = []
    for torque, angle, sign in regimes:
        order = np.argsort(torque)
        levels = np.linspace(0.0, sign * np.abs(torque).max(), POINTS_PER_QUARTER + 1)
        compliances.append(np.polyfit(levels, np.interp(levels, torque[order], angle[order]), 1)[0])
    return float(1.0 / np.mean(compliances))


def scaled(gear: Gear, factors: Factors) -> Gear:
    """The gear with the torques of spring and hysteresis multiplied, at every twist and for every law.

    A number of unit N.m/rad or N.m grows with the torque, one of unit 1/(N.m) falls, others stay.

    >>> import strainwave as sw
    >>> gear = scaled(sw.load("csg-25-100"), Factors(stiffness=1.1))
    >>> round(gear.stiffness.k2), round(gear.hysteresis.stiffness[0])
    (55000, 17800)
    """
    numbers = []
    for path, value, unit, *_ in _core.parameters(gear):
        part = path.partition(".")[0]
        factor = {"stiffness": factors.stiffness, "hysteresis": factors.hysteresis}.get(part, 1.0)
        above, _, below = unit.partition("/")
        numbers.append(value * factor ** (("N.m" in above) - ("N.m" in below)))
    changed: Gear = _core.with_numbers(gear, numbers)
    return changed


def cycle(gear: Gear, amplitude: float, *, side: Side = "output", factors: Factors = Factors()) -> Cycle:
    """The steady loop between equal and opposite elastic torques.

    At the input, with the output held, the friction of the wave generator is added: it opposes the motion, so that its sign
    changes at each turn.

    Args:
        gear: the gear, without stages of its own
        amplitude: largest torque of spring and hysteresis at the output [N.m]
        side: the shaft that is loaded
        factors: what parts of the gear are multiplied by

    Raises:
        ValueError: `amplitude` is not positive, `side` is another, or the gear has stages, or cannot carry the torque

    >>> import strainwave as sw
    >>> loop = cycle(sw.load("csg-25-100"), 87.0)
    >>> round(loop.width_at_zero * 60.0 * 180.0 / 3.141592653589793, 4)  # arcmin: half the maker's bound
    0.5
    """
    _check(gear, side)
    return _cycle(gear, positive("amplitude", amplitude, "N.m"), side, factors, POINTS_PER_QUARTER)


def _cycle(gear: Gear, amplitude: float, side: Side, factors: Factors, points: int) -> Cycle:
    quarter = np.linspace(0.0, amplitude, points + 1)
    down = np.concatenate((quarter[::-1], -quarter[1:]))
    once = np.concatenate((down, -down[1:]))
    path = np.concatenate((quarter, *[once[1:]] * CYCLES_RUN))
    twist = scaled(gear, factors).twist(path)
    last = slice(-len(once), None)
    if side == "output":
        return Cycle(twist[last], path[last], path[last], side)
    ratio = abs(float(gear.kinematics.ratio))
    angle = ratio * twist
    friction = factors.friction * np.asarray(gear.friction_input.quasistatic(angle, load=path))
    return _with_turns(angle[last], path[last], friction[last], ratio)


def _with_turns(angle: Array, elastic: Array, friction: Array, ratio: float) -> Cycle:
    """The loop at the input; at each turn, friction changes its sign before the shaft moves back."""
    torque = elastic / ratio + friction
    turn = int(np.argmin(elastic))
    where = [1, turn + 1]  # behind a peak the shaft still stands where it was; the torque is that of the way back
    back = elastic[[0, turn]] / ratio + friction[[1, turn + 1]]
    return Cycle(
        np.insert(angle, where, angle[[0, turn]]),
        np.insert(torque, where, back),
        np.insert(elastic, where, elastic[[0, turn]]),
        "input",
    )


def cycle_to(gear: Gear, peak: float, *, side: Side = "output", factors: Factors = Factors()) -> Cycle:
    """The steady loop between equal and opposite torques on the loaded shaft.

    Args:
        gear, side, factors: as for `cycle`
        peak: largest torque on the loaded shaft [N.m]

    Raises:
        ValueError: as `cycle`, or friction at the input holds all of the torque

    >>> import strainwave as sw
    >>> loop = cycle_to(sw.load("csg-25-100"), 0.5, side="input")
    >>> round(loop.peak, 9), round(float(loop.elastic.max()), 6)  # 100 x (0.5 - 0.09005)
    (0.5, 40.995)
    """
    from scipy.optimize import brentq

    _check(gear, side)
    peak = positive("peak", peak, "N.m")
    if side == "output":
        return _cycle(gear, peak, side, factors, POINTS_PER_QUARTER)
    most = peak * abs(float(gear.kinematics.ratio))

    def beyond(amplitude: float) -> float:
        return _cycle(gear, amplitude, side, factors, POINTS_FOR_ENDS).peak - peak

    least = 1e-6 * most
    if beyond(least) >= 0.0:
        raise ValueError(
            f"peak = {peak:g} N.m does not turn the input: its friction holds as much; take a larger torque, or load the output"
        )
    amplitude = most if beyond(most) <= 0.0 else float(brentq(beyond, least, most, xtol=1e-9 * most))
    return _cycle(gear, amplitude, side, factors, POINTS_PER_QUARTER)


def _check(gear: Gear, side: Side) -> None:
    arguments.one_of("side", side, COLUMNS)
    if arguments.gear(gear).structure.fields:
        raise ValueError(
            f"the gear has stages that move by themselves (structure {gear.structure.name}); a loop is made of one spring: "
            "take a gear with the structure lumped, as tilt-actuator-lumped"
        )
