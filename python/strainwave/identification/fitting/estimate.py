"""Estimate of a parameter, with the interval that contains its true value."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from strainwave import arguments, typeset
from strainwave.equality import ComparedByFields
from strainwave.presentation import Presented
from strainwave.statistics.scale import ONE_SIGMA, student


@dataclass(frozen=True, eq=False)
class Estimate(ComparedByFields, Presented):
    """Estimate of one parameter.

    Attributes:
        path: of the parameter in the model
        unit: its unit
        start: value before the fit
        value: value after it
        sigma: half the width of the interval that contains the true value with 68 %, by Student's distribution: the standard
            deviation if samples are many; infinite if the data do not determine it
        at_limit: True if the fit ended at a limit of the parameter
        freedom: independent samples beyond the number of unknowns [1]

    >>> import numpy as np
    >>> import strainwave as sw
    >>> speed = np.linspace(1.0, 50.0, 60)
    >>> torque = 0.02 + 3e-4 * speed + 1e-4 * np.random.default_rng(0).normal(size=60)
    >>> table = sw.Recording({"speed": speed, "torque": torque}, {"speed": "rad/s", "torque": "N.m"})
    >>> gear = sw.Gear(friction_input=sw.friction.Coulomb(coulomb=0.01, breakaway=0.01, viscous=3e-4))
    >>> (estimate,) = sw.fit(gear, table, ["friction_input.coulomb"]).estimates
    >>> round(estimate.value, 5), [round(end, 5) for end in estimate.interval()], estimate.unit
    (0.02001, [0.01998, 0.02004], 'N.m')
    """

    path: str
    unit: str
    start: float
    value: float
    sigma: float
    at_limit: bool
    freedom: float = np.inf

    def interval(self, confidence: float = 0.95) -> tuple[float, float]:
        """Return the interval that contains the true value with this probability, if the model is right.

        >>> low, high = Estimate("friction_input.coulomb", "N.m", 0.1, 0.02, 0.001, False, freedom=4.0).interval()
        >>> round(low, 4), round(high, 4)
        (0.0176, 0.0224)
        """
        confidence = arguments.number("confidence", confidence, low=0.0, high=1.0)
        reach = self.sigma * student(confidence, self.freedom) / student(ONE_SIGMA, self.freedom)
        return self.value - reach, self.value + reach

    def _headline(self) -> str:
        limit = ", at its limit" if self.at_limit else ""
        return f"{self.path} = {typeset.uncertain_quantity(self.value, self.sigma, self.unit)}{limit}"
