"""A linear drive under a computer, simulated by hand: the plant exactly between the instants, the law in numpy at them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import strainwave as sw
from numpy.typing import NDArray
from scipy.linalg import expm

Array = NDArray[np.float64]
RATIO, SPRING, DAMPING = 20.0, 200.0, 0.4
DC = sw.motor.DC(resistance=0.5, inductance=5e-4, torque_constant=0.1, back_emf=0.12, inertia=1e-4)
PROMPT = DC.replace(inductance=0.0)  # its current follows the voltage at once
TORQUE = sw.motor.TorqueSource(inertia=1e-4)
CURRENT = sw.motor.CurrentSource(torque_constant=0.1, inertia=1e-4)
ARM = sw.loads.Inertia(inertia=0.05)
DURATION = 0.06
COMMAND = sw.scenario.sine(0.3, 4.0, DURATION) + sw.scenario.ramp(0.8, DURATION)
# Period, delay and longest step [s]: steps that end at the instants and others, delays of nothing, of a part and of all.
TIMES = [(1e-3, 0.0, 5e-6), (1e-3, 3e-4, 5e-6), (7.3e-4, 2.1e-4, 5.3e-6), (1e-3, 1e-3, 5e-6)]


Law = Callable[[sw.simulation.Observation], float]


def drive(control: object, motor: object = DC, **parts: object) -> sw.Drive:
    """A motor, a gear of ratio 20 with a linear spring, and an arm."""
    gear = sw.Gear(
        kinematics=sw.kinematics.PlainRatio(reduction=RATIO),
        stiffness=sw.stiffness.Linear(k=SPRING),
        damping=DAMPING,
        input_inertia=0.0,
    )
    return sw.Drive(gear=gear, motor=motor, control=control, load=ARM, **parts)


@dataclass(frozen=True)
class Plant:
    r"""The same drive as matrices: \dot x = A x + B u with x = current, both angles, both speeds, as far as they live."""

    motor: object

    @property
    def matrices(self) -> tuple[Array, Array]:
        """A, shape (5, 5), and B, shape (5,), of current, input angle, input speed, output angle, output speed."""
        a, b = np.zeros((5, 5)), np.zeros(5)
        inertia = self.motor.inertia  # type: ignore[attr-defined]
        twist = np.array([0.0, 1.0 / RATIO, 0.0, -1.0, 0.0])
        torque = SPRING * twist + DAMPING * np.roll(twist, 1)
        a[1, 2] = a[3, 4] = 1.0
        a[2] = -torque / RATIO / inertia
        a[4] = torque / ARM.inertia
        match self.motor:
            case sw.motor.DC(inductance=0.0) as dc:
                b[2] = dc.torque_constant / dc.resistance / inertia
                a[2, 2] -= dc.back_emf * b[2]
            case sw.motor.DC() as dc:
                a[0, 0], a[0, 2], b[0] = -dc.resistance / dc.inductance, -dc.back_emf / dc.inductance, 1.0 / dc.inductance
                a[2, 0] = dc.torque_constant / inertia
            case sw.motor.CurrentSource() as source:
                b[2] = source.torque_constant / inertia
            case _:
                b[2] = 1.0 / inertia
        return a, b

    def over(self, time: float) -> tuple[Array, Array]:
        """Transition and input matrix over a time [s] in which the actuation is held, exactly."""
        a, b = self.matrices
        whole = np.zeros((6, 6))
        whole[:5, :5], whole[:5, 5] = a, b
        exact = expm(whole * time)
        return exact[:5, :5], exact[:5, 5]

    def current(self, x: Array, actuation: float) -> float:
        """Of the motor [A]."""
        match self.motor:
            case sw.motor.DC(inductance=0.0) as dc:
                return float((actuation - dc.back_emf * x[2]) / dc.resistance)
            case sw.motor.DC():
                return float(x[0])
            case sw.motor.CurrentSource():
                return actuation
            case _:
                return 0.0

    def seen(self, x: Array, actuation: float, time: float, command: sw.scenario.Scenario) -> sw.simulation.Observation:
        """All that is measured, under the actuation that is held."""
        torque = SPRING * (x[1] / RATIO - x[3]) + DAMPING * (x[2] / RATIO - x[4])
        asked = float(command.value(time)), float(command.rate(time))
        return sw.simulation.Observation(time, *asked, *x[1:], self.current(x, actuation), float(torque), -np.inf, np.inf)


def simulated(motor: object, law: Law, period: float, delay: float, command: sw.scenario.Scenario) -> dict[str, Array]:
    """The motion at the instants 0, period, … and the actuation that comes of each."""
    plant = Plant(motor)
    (late, late_input), (rest, rest_input) = plant.over(delay), plant.over(period - delay)
    instants = period * np.arange(int(command.duration / period))
    x, acting, held = np.zeros(5), 0.0, 0.0
    states, currents, given = [], [], []
    for time in instants:
        now = plant.seen(x, acting, time, command)
        states.append(x)
        currents.append(now.current)
        asked = law(now)
        x = late @ x + late_input * held
        x = rest @ x + rest_input * asked
        acting, held = (asked if delay < period else held), asked  # what acts just before the next instant, and just after
        given.append(asked)
    names = ("input_angle", "input_speed", "output_angle", "output_speed")
    motion = dict(zip(names, np.array(states).T[1:], strict=True))
    return motion | {"time": instants, "current": np.array(currents), "actuation": np.array(given)}


def check(
    control: object, law: Law, motor: object, period: float, delay: float, dt: float = 5e-6, share: float = 1e-12
) -> dict[str, Array]:
    """The run of the package is that simulation to a share of the largest; returns the latter."""
    wanted = simulated(motor, law, period, delay, COMMAND)
    one = drive(sw.control.Sampled(law=control, period=period, delay=delay), motor)  # type: ignore[arg-type]
    run = sw.simulate(one, COMMAND, dt, sample=period)
    actuation = next(name for name in ("voltage", "motor_torque", "current") if name in run.names)
    count = len(wanted["time"])
    for name in ("input_angle", "input_speed", "output_angle", "output_speed", "current"):
        if name in run.names and name != actuation:
            error = np.abs(run[name][1:count] - wanted[name][1:]).max()
            assert error <= share * np.abs(wanted[name]).max(), (name, error)
    error = np.abs(run[actuation][1:count] - wanted["actuation"][: count - 1]).max()  # recorded just before the next
    if delay == period:
        error = np.abs(run[actuation][2:count] - wanted["actuation"][: count - 2]).max()
    assert error <= share * np.abs(wanted["actuation"]).max(), (actuation, error)
    return wanted
