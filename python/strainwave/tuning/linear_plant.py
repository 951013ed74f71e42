"""The linear model of a drive that a controller of its state is designed for."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from strainwave import Gear, Sensors, friction, hysteresis, kinematic_error, meter, stiffness, thermal
from strainwave.analysis.linear import linearise
from strainwave.tuning.cascade import Plant, line_of_friction

Array = NDArray[np.float64]


@dataclass(frozen=True)
class LinearPlant:
    """A drive near rest at the output angle 0: dx/dt = A x + B u, with viscous friction and without kinematic error.

    Attributes:
        a, b: A, shape (n, n), and B of the actuation, shape (n,)
        states: names
        output, torque: the output angle and the torque of the gear as sums of the states, shape (n,)
    """

    a: Array
    b: Array
    states: tuple[str, ...]
    output: Array
    torque: Array

    @classmethod
    def of(cls, plant: Plant, largest_torque: float | None = None) -> LinearPlant:
        """Return the linear model of a plant.

        Args:
            largest_torque: for which the spring is right [N.m]: the secant to it, without hysteresis; if none, the spring is as
                stiff as for small deviations from rest
        """
        _, viscous = line_of_friction(plant.drive.gear)
        none = friction.Viscous()
        law = friction.Viscous(viscous=viscous)
        gear = plant.drive.gear.replace(friction_input=law, friction_mesh=none, friction_output=none)
        gear = gear.replace(kinematic_error=kinematic_error.Fourier())
        if largest_torque is not None:
            spring = stiffness.Linear(k=_secant(gear, largest_torque))
            gear = gear.replace(stiffness=spring, hysteresis=hysteresis.MaxwellSlip())
        alone = plant.drive.replace(gear=gear, sensors=Sensors(), meter=meter.NoMeter(), thermal=thermal.Isothermal())
        linear = linearise(alone)
        shares = {"input_angle": 1.0 / plant.ratio, "transmission_error": -1.0}
        output = np.array([shares.get(name, 0.0) for name in linear.states])
        b, torque = linear.B[:, linear.inputs.index("command")], linear.C[linear.outputs.index("torque")]
        return cls(linear.A, b, linear.states, output, torque)

    def held(self, time: float) -> tuple[Array, Array]:
        """Return the transition over a time [s] and the effect of an input that is held over it."""
        from scipy.linalg import expm

        count = len(self.a)
        whole = np.zeros((count + 1, count + 1))
        whole[:count, :count], whole[:count, count] = self.a, self.b
        exact = expm(whole * time)
        return exact[:count, :count], exact[:count, count]

    def held_late(self, period: float, delay: float) -> tuple[Array, Array]:
        """Return the transition over a period [s] of the states and the input before, and the effect of an input.

        An input acts a delay [s] after the period begins; until then the one before does.
        """
        (late, late_input), (rest, rest_input) = self.held(delay), self.held(period - delay)
        count = len(self.a)
        step = np.zeros((count + 1, count + 1))
        step[:count, :count], step[:count, count] = rest @ late, rest @ late_input
        return step, np.append(rest_input, 1.0)


def _secant(gear: Gear, torque: float) -> float:
    """Return the torque over its twist, from rest [N.m/rad]."""
    return float(torque / gear.twist([torque])[0])
