r"""Torque on the loaded shaft: from what lies on the pans, less what the pulleys hold, and how well it is known.

With m the total on the two pans of a pair (its erratum 7), the cords give

.. math:: T = (m_+ - m_-)\, g\, r\, a(\varphi)

where a = 1 of a cord wound on the rim, and a = cos(angle - tangent) of one from a fixed point. The friction of the pulleys acts
against the motion (its erratum 8): the shaft gets T - T_p when it moved forward, T + T_p when it moved backward. After a
reversal it does not move until the torque has changed by 2 T_p; until then the pulleys hold something in between. All three
cases are one play of half width T_p = T_0 + s \|T\| between the torque of the cords and that of the shaft.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from math import hypot, sqrt
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from strainwave import arguments, typeset
from strainwave.equality import ComparedByFields
from strainwave.presentation import Presented, Row
from strainwave.rig.bench.setup import Masses, Rig, Value
from strainwave.rig.bench.steps import Step
from strainwave.rig.loop import Loop, not_negative, signed
from strainwave.statistics.scale import student

Array = NDArray[np.float64]
CONFIDENCE_LEVEL = 0.95  # probability of the intervals of a torque [1]
Kind = Literal["random", "common", "by direction"]
PICTURE = "shape of the picture, by the markers"


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
    weighed = np.hypot(
        *(
            np.array([mass_sigma(getattr(step, pair), rig.masses) for step in steps])
            for pair in ("mass_positive", "mass_negative")
        )
    )
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


@dataclass(frozen=True)
class Contribution:
    """Contribution of one number to the uncertainty of a result.

    Attributes:
        name: what it comes from
        sigma: standard deviation that it alone would give, in the unit of the result
        kind: random from point to point; common to all points, so that no mean lowers it; or by direction: of one sign where
            the shaft moved forward, of the other where it moved backward
    """

    name: str
    sigma: float
    kind: Kind


@dataclass(frozen=True)
class Budget(Presented):
    """Uncertainty of a result: independent contributions, whose squares add up (JCGM 100:2008, eq. 10).

    Attributes:
        quantity: what it is of
        value: of the result
        unit: of value and contributions
        contributions: the largest first

    >>> parts = [Contribution("masses", 3e-4, "random"), Contribution("radius", 4e-4, "common")]
    >>> budget = Budget.of("torque", 0.36, "N.m", parts)
    >>> budget.sigma, budget.share(budget.contributions[0])
    (0.0005, 0.64)
    >>> print(budget)
    Budget: torque 0.36000 ± 0.00050 N·m (0.14 %)
      radius  0.0004  N·m  64 %, common
      masses  0.0003  N·m  36 %, random
    """

    quantity: str
    value: float
    unit: str
    contributions: tuple[Contribution, ...]

    @classmethod
    def of(cls, quantity: str, value: float, unit: str, contributions: Iterable[Contribution]) -> Budget:
        """The budget of these contributions, without those that are nothing."""
        ordered = sorted((each for each in contributions if each.sigma > 0.0), key=lambda each: -each.sigma)
        return cls(quantity, value, unit, tuple(ordered))

    @property
    def sigma(self) -> float:
        """Standard deviation of the result."""
        return hypot(*(each.sigma for each in self.contributions))

    def of_kind(self, kind: Kind) -> float:
        """Standard deviation that the contributions of a kind give, in `unit`."""
        return hypot(*(each.sigma for each in self.contributions if each.kind == kind))

    def share(self, contribution: Contribution) -> float:
        """Share of a contribution in the variance of the result [1]."""
        return round(contribution.sigma**2 / self.sigma**2, 12)

    def _headline(self) -> str:
        relative = f" ({100.0 * self.sigma / abs(self.value):.2g} %)" if self.value else ""
        return f"{self.quantity} {typeset.uncertain_quantity(self.value, self.sigma, self.unit)}{relative}"

    def _rows(self) -> Iterator[Row]:
        for each in self.contributions:
            share = f"{100.0 * self.share(each):.0f} %, {each.kind}"
            yield Row(each.name, each.sigma, self.unit, note=share)


def torque_budget(rig: Rig, step: Step, angle: float = 0.0) -> Budget:
    r"""Return the uncertainty of the torque of the masses at one step.

    .. math:: T = (m_+ - m_-) g r a, \quad \sigma_T^2 = (g r a \sigma_m)^2 + T^2 \left( (\sigma_g/g)^2 + (\sigma_r/r)^2
              + (\tan(\varphi - \varphi_t) \sigma_t)^2 + \sigma_s^2 \right) + \sigma_{T_0}^2

    Args:
        rig: which rig
        step: what lies on the pans
        angle: reading of the angle of the disk [rad]

    Returns:
        The contributions to the standard deviation of the torque [N.m], the largest first.

    Raises:
        ValueError: as `arm`

    >>> from strainwave import rig
    >>> print(torque_budget(rig.load("couple-rig"), rig.Step(1, mass_positive=0.35)))
    Budget: torque 0.3432 ± 0.0035 N·m (1 %)
      friction of the pulleys, share of the torque
                           0.0034323  N·m  96 %, by direction
      gravity                 0.0007  N·m  4 %, common
      masses              0.00017336  N·m  0 %, random
      radius of the disk  0.00017162  N·m  0 %, common
    """
    force = rig.gravity.value * rig.disk_radius.value * float(arm(rig, angle))
    torque = force * (step.mass_positive - step.mass_negative)
    masses = hypot(*(mass_sigma(total, rig.masses) for total in (step.mass_positive, step.mass_negative)))
    shared = shared_errors(rig, [angle], np.array([torque]))
    contributions = [Contribution("masses", force * masses, "random")]
    contributions += [Contribution(name, abs(torque) * share, _kind(name)) for name, share in shared.items()]
    contributions.append(Contribution("friction of the pulleys, whatever the load", rig.pulley_torque.sigma, "by direction"))
    return Budget.of("torque", torque, "N.m", contributions)


def angle_budget(rig: Rig, angle: float, sigma: float, torque: Budget, scale: float = 0.0) -> Budget:
    r"""Return the uncertainty of the gear's own angle, theta - C T: the reading less the rotation of coupling and frame.

    Args:
        rig: which rig
        angle: of the gear [rad]
        sigma: standard deviation of a reading [rad]
        torque: the budget of the torque there
        scale: standard deviation of what all readings share, relative to the angle, as `Angles.scale` [1]

    Returns:
        The contributions to the standard deviation of the angle [rad], the largest first.

    Raises:
        ValueError: the angle is not finite, or a standard deviation is negative

    >>> from strainwave.rig import load, Step
    >>> rig = load("couple-rig")
    >>> angle_budget(rig, 0.08, 3e-5, torque_budget(rig, Step(1, mass_positive=0.35))).sigma
    3e-05
    """
    angle = signed("angle", angle, "rad")
    sigma, scale = not_negative("sigma", sigma, "rad"), not_negative("scale", scale, "1")
    contributions = [
        Contribution("reading of the markers", sigma, "random"),
        Contribution(PICTURE, abs(angle) * scale, "common"),
        Contribution("compliance of coupling and frame", abs(torque.value) * rig.compliance.sigma, "common"),
        Contribution("torque, through the compliance", rig.compliance.value * torque.sigma, "common"),
    ]
    return Budget.of("angle", angle, "rad", contributions)


def stiffness_budget(
    rig: Rig, stiffness: float, steps: Sequence[Step], angle: float = 0.0, angle_sigma: float = 0.0, angle_scale: float = 0.0
) -> Budget:
    r"""Return the uncertainty of the stiffness of a straight regime, by regression of angle on torque over its steps.

    .. math:: \frac{\sigma_k^2}{k^2} = (1 + k C)^2 \left( \frac{\sigma_T^2}{S^2} + \frac{\sigma_g^2}{g^2}
              + \frac{\sigma_r^2}{r^2} + \overline{\tan^2} \, \sigma_t^2 + \sigma_s^2 \right)
              + \frac{k^2 \sigma_\theta^2}{S^2} + k^2 \sigma_C^2 + \sigma_q^2,
              \quad S^2 = \sum (T_i - \bar T)^2

    An error of the torque counts 1 + k C times, as C T is taken out of a reading to which the true torque has led.

    Args:
        rig: which rig
        stiffness: of the regime [N.m/rad]
        steps: of the regime, two or more at different torques
        angle: reading of the angle in the middle of the regime [rad]
        angle_sigma: standard deviation of a reading [rad]
        angle_scale: of what all readings share, relative to the angle, as `Angles.scale` [1]

    Returns:
        The contributions to the standard deviation of the stiffness [N.m/rad], the largest first.

    Raises:
        ValueError: the steps have one torque, the stiffness is not positive, or as `arm`

    >>> from strainwave.rig import load, Step
    >>> steps = [Step(n, mass_positive=0.05 * n) for n in range(1, 8)]
    >>> print(stiffness_budget(load("couple-rig"), 4.51, steps, angle_sigma=4e-5))
    Budget: stiffness 4.510 ± 0.046 N·m/rad (1 %)
      friction of the pulleys, share of the torque
                                 0.0451  N·m/rad  95 %, by direction
      gravity                 0.0091978  N·m/rad  4 %, common
      reading of the markers  0.0031358  N·m/rad  0 %, random
      radius of the disk       0.002255  N·m/rad  0 %, common
      masses                  0.0022435  N·m/rad  0 %, random
    """
    stiffness = arguments.number("stiffness", stiffness, "N.m/rad", low=0.0)
    budgets = [torque_budget(rig, step, angle) for step in steps]
    torque = np.array([budget.value for budget in budgets])
    spread = sqrt(float(np.sum((torque - torque.mean()) ** 2))) if len(torque) else 0.0
    if spread == 0.0:
        raise ValueError("steps: the stiffness of a regime needs two steps or more at different torques")
    weighed = np.array([budget.of_kind("random") for budget in budgets])
    masses = float(np.linalg.norm((torque - torque.mean()) * weighed)) / spread**2
    shared = shared_errors(rig, np.full(len(torque), angle), torque)
    of_torque = [Contribution("masses", masses, "random")]
    of_torque += [Contribution(name, share, _kind(name)) for name, share in shared.items()]
    lever = 1.0 + stiffness * rig.compliance.value
    relative = [dataclasses.replace(each, sigma=lever * each.sigma) for each in of_torque]
    relative.append(Contribution("reading of the markers", stiffness * angle_sigma / spread, "random"))
    relative.append(Contribution(PICTURE, angle_scale, "common"))
    relative.append(Contribution("compliance of coupling and frame", stiffness * rig.compliance.sigma, "common"))
    scaled = [Contribution(each.name, stiffness * each.sigma, each.kind) for each in relative]
    return Budget.of("stiffness", stiffness, "N.m/rad", scaled)


def _kind(name: str) -> Kind:
    return "by direction" if name.startswith("friction") else "common"


def torque_of_masses(rig: Rig, step: Step) -> float:
    """Torque of what lies on the pans at the full radius, pulleys left out [N.m]: what is shown while a test is being made.

    >>> from strainwave.rig import load
    >>> round(torque_of_masses(load("couple-rig"), Step(1, mass_positive=0.35)), 4)
    0.3432
    """
    return (step.mass_positive - step.mass_negative) * rig.gravity.value * rig.disk_radius.value
