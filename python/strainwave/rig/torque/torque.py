r"""Torque on the loaded shaft: from what lies on the pans, less what the pulleys hold, and how well it is known.

With m the total on the two pans of a pair (its erratum 7), the cords give

.. math:: T = (m_+ - m_-)\, g\, r\, a(\varphi)

where a = 1 of a cord wound on the rim, and a = cos(angle - tangent) of one from a fixed point. The friction of the pulleys acts
against the motion (its erratum 8): the shaft gets T - T_p when it moved forward, T + T_p when it moved backward. After a
reversal it does not move until the torque has changed by 2 T_p; until then the pulleys hold something in between. All three
cases are one play of half width T_p = T_0 + s \|T\| between the torque of the cords and that of the shaft.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from strainwave import arguments
from strainwave.equality import ComparedByFields
from strainwave.presentation import Presented
from strainwave.rig.bench.setup import Masses, Rig, Value
from strainwave.rig.bench.steps import Step
from strainwave.rig.loop import Loop
from strainwave.statistics.scale import student

Array = NDArray[np.float64]
CONFIDENCE_LEVEL = 0.95  # probability of the intervals of a torque [1]


@dataclass(frozen=True, eq=False)
class Torque(ComparedByFields, Presented):
    """Torques of the steps of a test, each of shape (n,).

    Attributes:
        cords: what the cords give, or what was measured instead [N.m]
        shaft: what the shaft got [N.m]
        sense: in which the pulleys last turned: 1 forward, -1 backward, 0 where a step did not move them
        sigma: standard deviation of each torque by itself [N.m]
        scale: of what all torques share, relative to the torque [1]
        friction_sigma: of the friction of the pulleys [N.m]

    >>> import strainwave as sw
    >>> bench = sw.rig.Rig("bench", "input", sw.rig.Value(0.1), pulley_torque=sw.rig.Value(0.01))
    >>> torque = sw.rig.torque_of([sw.rig.Step(1, mass_positive=0.3), sw.rig.Step(2, mass_positive=0.2)], bench)
    >>> torque.cords.round(3), torque.shaft.round(3), torque.sense
    (array([0.294, 0.196]), array([0.284, 0.206]), array([ 1., -1.]))
    """

    cords: Array
    shaft: Array
    sense: Array
    sigma: Array
    scale: float
    friction_sigma: float


def arm(rig: Rig, angle: Sequence[float] | Array | float) -> Array:
    """Arm of the cords, relative to the radius of the disk [1], of the shape of `angle`.

    Args:
        rig: how the cords leave the disk
        angle: reading of the angle [rad]

    Raises:
        ValueError: a cord from a fixed point has been turned by 90 degrees or more from where it is tangent

    >>> from strainwave.rig import Rig, Value
    >>> rig = Rig("bench", "input", Value(0.1), cord="fixed point")
    >>> float(arm(rig, np.radians(59.3)).round(2))
    0.51
    """
    turned = arguments.numbers("angle", angle) - rig.cord_tangent.value
    if rig.cord == "wound":
        return np.ones_like(turned)
    if np.any(np.abs(turned) >= 0.5 * np.pi):
        farthest = np.degrees(np.nanmax(np.abs(turned)))
        allowed = "a cord from a fixed point has an arm within 90 degrees of where it is tangent only"
        raise ValueError(
            f'angle: the disk turned {farthest:.4g} degrees from cord_tangent; {allowed}; write cord = "wound" if it is'
        )
    return np.cos(turned)


def torque_of(steps: Sequence[Step], rig: Rig, angle: Sequence[float] | Array | None = None) -> Torque:
    """Return the torque on the shaft at consecutive steps, the first one reached from zero.

    A torque that was measured otherwise is taken as that of the shaft: there are no pulleys between.

    Args:
        steps: as made, of one position and unit
        rig: which rig
        angle: reading of the angle of the disk [rad], shape (n,), not-a-number where there is none; needed only by cords from a
            fixed point

    Returns:
        Torques and their uncertainty; not-a-number where an angle is needed and missing.

    Raises:
        ValueError: there are no steps, or as `arm`

    >>> from strainwave.rig import Rig, Step, Value
    >>> rig = Rig("bench", "input", Value(0.1), gravity=Value(10.0), pulley_torque=Value(0.01))
    >>> found = torque_of([Step(1, 0.3), Step(2, 0.25), Step(3, 0.3), Step(4, 0.0, 0.1)], rig)
    >>> found.cords.round(3).tolist(), found.shaft.round(3).tolist()
    ([0.3, 0.25, 0.3, -0.1], [0.29, 0.26, 0.29, -0.09])
    """
    if not steps:
        raise ValueError("steps: a test needs one step or more")
    radius = arm(rig, np.zeros(len(steps)) if angle is None else angle) * rig.disk_radius.value
    difference = np.array([step.mass_positive - step.mass_negative for step in steps])
    measured = np.array([step.torque is not None for step in steps])
    cords = np.where(measured, [step.torque or 0.0 for step in steps], difference * rig.gravity.value * radius)
    held = np.where(measured, 0.0, rig.pulley_torque.value + rig.pulley_share.value * np.abs(cords))
    shaft, sense = _play(cords, held)
    weighed = np.hypot(*(_mass_sigmas(steps, rig, pair) for pair in ("mass_positive", "mass_negative")))
    sigma = np.where(measured, 0.0, weighed * rig.gravity.value * radius)
    if np.all(measured):
        return Torque(cords, shaft, sense, sigma, 0.0, 0.0)
    scale = np.sqrt(sum(share**2 for share in shared_errors(rig, angle, cords).values()))
    friction_sigma = np.hypot(rig.pulley_torque.sigma, rig.pulley_share.sigma * _rms(cords))
    return Torque(cords, shaft, sense, sigma, float(scale), float(friction_sigma))


def _play(cords: Array, held: Array) -> tuple[Array, Array]:
    """The torque behind a dry friction that holds so much, and the sense in which it was last overcome."""
    shaft, sense = cords.copy(), np.zeros(len(cords))
    behind = 0.0
    for k in np.flatnonzero(np.isfinite(cords)):
        before, behind = behind, float(np.clip(behind, cords[k] - held[k], cords[k] + held[k]))
        shaft[k], sense[k] = behind, np.sign(behind - before)
    return shaft, sense


def _rms(values: Array) -> float:
    known = values[np.isfinite(values)]
    return float(np.sqrt(np.mean(known**2))) if len(known) else 0.0


def shared_errors(rig: Rig, angle: Sequence[float] | Array | None, cords: Array) -> dict[str, float]:
    """Standard deviations that all torques share, relative to the torque [1], by what they come from.

    That of the tangency depends on the angle: it is the root of its mean square, weighted with the torque.
    """
    shares = {
        "radius of the disk": rig.disk_radius.sigma / rig.disk_radius.value,
        "gravity": rig.gravity.sigma / rig.gravity.value,
        "friction of the pulleys, share of the torque": rig.pulley_share.sigma,
    }
    if rig.cord == "fixed point" and angle is not None:
        turned = np.asarray(angle) - rig.cord_tangent.value
        share = _rms(cords * np.tan(turned)) / (_rms(cords) or 1.0)
        shares["angle at which the cords are tangent"] = share * rig.cord_tangent.sigma
    return shares


def _mass_sigmas(steps: Sequence[Step], rig: Rig, pair: str) -> Array:
    """Standard deviation of the total on a pair of pans at each step [kg]."""
    return np.array([mass_sigma(getattr(step, pair), rig.masses) for step in steps])


def mass_sigma(total: float, sets: Sequence[Masses]) -> float:
    """Standard deviation of a total that is made of the fewest masses [kg]; their errors are independent.

    What the sets cannot make is taken to be as well known as their worst mass.

    >>> from strainwave.rig import Masses
    >>> round(mass_sigma(0.15, [Masses(0.025, 16, 3e-5), Masses(0.1, 9, 4e-5)]), 8)  # 100 g, twice 25 g
    5.831e-05
    """
    rest, variance = total, 0.0
    for masses in sorted(sets, key=lambda each: -each.mass):
        number = min(masses.count, int(rest / masses.mass + 1e-6))
        rest -= number * masses.mass
        variance += number * masses.sigma**2
    worst = max((masses.sigma / masses.mass for masses in sets), default=0.0)
    return float(np.sqrt(variance + (worst * max(rest, 0.0)) ** 2))


def without_compliance(angle: Array, torque: Array, compliance: Value) -> Array:
    """Angle of the gear alone: coupling and frame are in series with it and turn by C T under the same torque [rad].

    >>> from strainwave.rig import Value
    >>> without_compliance(np.array([0.1]), np.array([0.36]), Value(0.01)).round(4).tolist()
    [0.0964]
    """
    return angle - compliance.value * torque


def blank(loop: Loop, confidence: float = CONFIDENCE_LEVEL) -> Value:
    r"""Return the compliance of coupling and frame, from a run with a rigid dummy in place of the gear.

    It is the slope of the regression of angle on torque. Its standard deviation joins the scatter about the line with what all
    torques and all angles share.

    Args:
        loop: of the dummy, evaluated with a rig whose compliance is 0
        confidence: of the interval that the source states [1]

    Returns:
        The compliance [rad/(N.m)]: 0 where the slope is negative by chance.

    Raises:
        ValueError: fewer than three points, one torque only, or a slope that is negative beyond chance

    >>> torque = np.array([-0.3, -0.1, 0.1, 0.3])
    >>> found = blank(Loop(0.01 * torque + [1e-5, -1e-5, -1e-5, 1e-5], torque, side="input", name="steel dummy"))
    >>> round(found.value, 6), found.source
    (0.01, 'steel dummy: regression over 4 points, 95 % from 0.009864 to 0.01014 rad/(N.m)')
    """
    arguments.number("confidence", confidence, low=0.0, high=1.0)
    n, torque = len(loop), loop.torque - np.mean(loop.torque)
    spread = float(torque @ torque)
    if n < 3 or spread == 0.0:
        raise ValueError(f"{loop.name}: a blank run needs three points or more at different torques; it has {n}")
    slope = float(torque @ loop.angle) / spread
    residual = loop.angle - np.mean(loop.angle) - slope * torque
    scatter = float(np.sqrt(residual @ residual / (n - 2) / spread))
    sigma = float(np.hypot(scatter, slope * np.hypot(loop.torque_scale, loop.angle_scale)))
    half = student(confidence, n - 2) * sigma
    if slope + half < 0.0:
        raise ValueError(f"{loop.name}: the angle falls with the torque, by {-slope:.4g} rad/(N.m); a sign is wrong")
    interval = f"{100.0 * confidence:g} % from {slope - half:.4g} to {slope + half:.4g} rad/(N.m)"
    return Value(max(slope, 0.0), sigma, f"{loop.name}: regression over {n} points, {interval}")
