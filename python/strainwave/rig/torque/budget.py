"""Uncertainty budgets of a torsion test: what torque, angle and stiffness owe to each number of the rig."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from math import hypot, sqrt
from typing import Literal

import numpy as np

from strainwave import arguments, typeset
from strainwave.presentation import Presented, Row
from strainwave.rig.bench.setup import Rig
from strainwave.rig.bench.steps import Step
from strainwave.rig.loop import not_negative, signed
from strainwave.rig.torque.torque import arm, mass_sigma, shared_errors

Kind = Literal["random", "common", "by direction"]
PICTURE = "shape of the picture, by the markers"


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
