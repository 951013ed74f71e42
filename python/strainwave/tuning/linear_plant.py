"""The linear model of a drive that a controller of its state is designed for."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from strainwave import Sensors, arguments, friction, hysteresis, kinematic_error, meter, stiffness, thermal
from strainwave.analysis.linear import linearise
from strainwave.messages import listed
from strainwave.tuning.cascade import Plant, line_of_friction

Array = NDArray[np.float64]

ENCODER_STATES = ("input_angle", "input_speed", "output_speed", "transmission_error")  # by the encoders of both shafts


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
        """Return the linear model of a plant; with a largest torque [N.m] its spring is the secant to it, without hysteresis.

        Without one, the spring is as stiff as for small deviations from rest.
        """
        _, viscous = line_of_friction(plant.drive.gear)
        none = friction.Viscous()
        law = friction.Viscous(viscous=viscous)
        gear = plant.drive.gear.replace(friction_input=law, friction_mesh=none, friction_output=none)
        gear = gear.replace(kinematic_error=kinematic_error.Fourier())
        if largest_torque is not None:
            secant = float(largest_torque / gear.twist([largest_torque])[0])  # N.m/rad, from rest
            gear = gear.replace(stiffness=stiffness.Linear(k=secant), hysteresis=hysteresis.MaxwellSlip())
        alone = plant.drive.replace(gear=gear, sensors=Sensors(), meter=meter.NoMeter(), thermal=thermal.Isothermal())
        linear = linearise(alone)
        shares = {"input_angle": 1.0 / plant.ratio, "transmission_error": -1.0}
        output = np.array([shares.get(name, 0.0) for name in linear.states])
        b, torque = linear.B[:, linear.inputs.index("command")], linear.C[linear.outputs.index("torque")]
        return cls(linear.A, b, linear.states, output, torque)

    def cost(self, error: float, speed_error: float | None = None) -> Array:
        """Return the weights of the states, shape (n, n): squares of the output angle and speed over errors [rad], [rad/s].

        The speed does not count if it has no error.
        """
        weights = np.outer(self.output, self.output) / arguments.number("error", error, "rad", low=0.0) ** 2
        if speed_error is not None:
            place = self.states.index("output_speed")
            weights[place, place] += 1.0 / arguments.number("speed_error", speed_error, "rad/s", low=0.0) ** 2
        return weights

    def measured_by_encoders(self) -> LinearPlant:
        """Return the plant; refuse one with states besides angle and speed of both shafts."""
        if sorted(self.states) != sorted(ENCODER_STATES):
            raise ValueError(
                f"the states of the drive are {listed(self.states)}, and encoders measure only angle and speed of both shafts; "
                "take the lumped gear (structure.Lumped) and a load that is one inertia"
            )
        return self

    def held(self, period: float, delay: float = 0.0) -> HeldPlant:
        """Return the plant from one sampling instant to the next, whose input comes a delay [s] after the instant."""
        (first, before), (rest, after) = _held(self.a, self.b, delay), _held(self.a, self.b, period - delay)
        return HeldPlant(rest @ first, rest @ before, after, period)


@dataclass(frozen=True)
class HeldPlant:
    """A linear plant from one sampling instant to the next, x + = F x + G_1 v + G_0 u, with v the input of the instant before.

    Attributes:
        step: F
        late: G_1, zero without delay
        now: G_0
        period: [s]
    """

    step: Array
    late: Array
    now: Array
    period: float

    @property
    def is_late(self) -> bool:
        """True if the input of the instant before is a state."""
        return bool(self.late.any())

    @property
    def extended(self) -> tuple[Array, Array]:
        """F and G of the states and the input of the instant before, as the last of them."""
        count = len(self.step)
        step = np.zeros((count + 1, count + 1))
        step[:count, :count], step[:count, count] = self.step, self.late
        return step, np.append(self.now, 1.0)

    @property
    def whole(self) -> tuple[Array, Array]:
        """The same if the input before is a state, else F and G_0."""
        return self.extended if self.is_late else (self.step, self.now)

    def gains(self, cost: Array, effort: float) -> Array:
        """Return the gains K of u = -K x that minimise the sum of x' cost x + (u / effort)^2."""
        return optimal(*self.whole, cost, effort)[1]


def optimal(step: Array, driven: Array, cost: Array, effort: float) -> tuple[Array, Array]:
    """Return the least sum of x' cost x + (u / effort)^2, as a form of the state, and the gains of u = -K x that reach it.

    By the discrete Riccati equation: AstromWittenmark1997, section 11.2. `step` and `driven` are F and G of x + = F x + G u;
    the cost is of the first states, and an input of `effort` is as bad as a cost of 1.
    """
    from scipy.linalg import solve_discrete_are

    weights = np.zeros_like(step)
    weights[: len(cost), : len(cost)] = cost
    scaled = driven * effort
    try:
        value: Array = np.asarray(solve_discrete_are(step, scaled[:, np.newaxis], weights, np.eye(1)), dtype=np.float64)
    except np.linalg.LinAlgError as error:
        raise ValueError(f"no regulator is found for this drive and these weights: {error}") from None
    gains: Array = effort * (scaled @ value @ step) / (1.0 + scaled @ value @ scaled)
    return value, gains


def _held(a: Array, b: Array, time: float) -> tuple[Array, Array]:
    """Return the transition over a time [s] and the effect of an input that is held over it."""
    from scipy.linalg import expm

    count = len(a)
    whole = np.zeros((count + 1, count + 1))
    whole[:count, :count], whole[:count, count] = a, b
    exact = expm(whole * time)
    return exact[:count, :count], exact[:count, count]
