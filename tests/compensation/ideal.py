"""Drives whose motion has closed forms: an input that accelerates as it is asked to, and a rotor that turns without a load."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import strainwave as sw
from numpy.typing import NDArray

Array = NDArray[np.float64]

KINEMATICS = sw.kinematics.StrainWave(flexspline_teeth=200, circular_spline_teeth=202, fixed="circular_spline")
RATIO = KINEMATICS.ratio  # -100
PERIOD = 1e-3  # s
STIFFNESS, DAMPING = 1e4, 200.0  # of the position loop: (s + 100)^2
LIGHT = sw.loads.Inertia(inertia=1e-2)  # kg.m2: at the input a millionth of that


def gear(**parts: Any) -> sw.Gear:
    """A gear so stiff that the output does what the input does, but for the kinematic error."""
    return sw.Gear(kinematics=KINEMATICS, stiffness=sw.stiffness.Linear(k=1e5), damping=30.0, **parts)


def following(error: Any, learning: Any) -> sw.Drive:
    """A drive whose input follows what it is to follow, in a linear loop, whatever torque that takes."""
    law = sw.control.PID(proportional=STIFFNESS, derivative=DAMPING, limit=1e9)
    control = sw.control.Sampled(law=law, period=PERIOD, compensation=sw.Compensation(learning=learning))
    return sw.Drive(gear=gear(kinematic_error=error), motor=sw.motor.AccelerationSource(), load=LIGHT, control=control)


def followed(frequency: float) -> complex:
    """P: input angle over the angle that it is to follow, at a frequency [rad/s]; of a double integrator under a computer."""
    transition, held = np.array([[1.0, PERIOD], [0.0, 1.0]]), np.array([0.5 * PERIOD**2, PERIOD])
    gains, forward = np.array([STIFFNESS, DAMPING]), np.exp(1j * frequency * PERIOD)
    closed = forward * np.eye(2) - transition + np.outer(held, gains)
    return complex(np.linalg.solve(closed, held * (STIFFNESS + 1j * frequency * DAMPING))[0])


@dataclass(frozen=True)
class Course:
    """A run at constant speed.

    Attributes:
        run: as recorded, once a period
        error: of the output angle [rad]
    """

    run: sw.Recording

    @classmethod
    def at(cls, drive: sw.Drive, input_speed: float, duration: float, **others: Any) -> Course:
        output_speed = input_speed / RATIO
        start = {} if "initial" in others else {"initial": {"input_speed": input_speed, "output_speed": output_speed}}
        return cls(sw.simulate(drive, sw.scenario.ramp(output_speed, duration), sample=PERIOD, **start, **others))

    @property
    def error(self) -> Array:
        return self.run["command"] - self.run["output_angle"]

    def turns(self) -> list[Array]:
        """The samples of each whole turn of the input."""
        turn = np.floor(np.abs(self.run["input_angle"]) / (2.0 * np.pi)).astype(int)
        return [np.flatnonzero(turn == number) for number in range(turn.max())]

    def waves(self, order: float) -> tuple[Array, Array]:
        """Time [s] of each turn, and the complex amplitude of an order of the error in it [rad]."""
        found, times = [], []
        for at in self.turns():
            angle = order * self.run["input_angle"][at]
            columns = np.column_stack([np.sin(angle), np.cos(angle), np.ones(at.size)])
            sine, cosine, _ = np.linalg.lstsq(columns, self.error[at], rcond=None)[0]
            found.append(sine + 1j * cosine)
            times.append(self.run.time[at].mean())
        return np.array(times), np.array(found)


def state(start: sw.State, part: str) -> dict[str, float]:
    """Numbers of a compensator, `learning` or `observer`, by their own names."""
    prefix = f"control.compensation.{part}."
    return {name.removeprefix(prefix): value for name, value in start.items() if name.startswith(prefix)}
