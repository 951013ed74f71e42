"""A drive with a gear in stages, and the same by tests/support/actuator_equations.py, which shares nothing with the package."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import pi, sin, tan

import numpy as np
import strainwave as sw
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from tests.support.actuator_equations import OUT, Gear, Spring, deformed, outputs, rates

Array = NDArray[np.float64]

FLEXSPLINE = sw.kinematics.StrainWave(flexspline_teeth=200, circular_spline_teeth=202, fixed="flexspline")
CIRCULAR_SPLINE = sw.kinematics.StrainWave(flexspline_teeth=200, circular_spline_teeth=202, fixed="circular_spline")
FIXED = {"flexspline": FLEXSPLINE, "circular_spline": CIRCULAR_SPLINE}


@dataclass(frozen=True)
class Waves:
    """A torque [N.m]: sines of amplitude [N.m], frequency [Hz] and phase [rad]."""

    waves: Sequence[tuple[float, float, float]]

    def __call__(self, time: float, *_: float) -> float:
        return sum(amplitude * sin(2.0 * pi * frequency * time + phase) for amplitude, frequency, phase in self.waves)

    def scenario(self, duration: float) -> sw.scenario.Scenario:
        parts = [sw.scenario.sine(amplitude, frequency, duration, phase) for amplitude, frequency, phase in self.waves]
        return sum(parts[1:], parts[0])


NOTHING = Waves([(0.0, 1.0, 0.0)])


def spring(k: float, c: float, variation: object) -> Spring:
    """Of stiffness, damping and how it varies."""
    if isinstance(variation, sw.variation.Constant):
        return Spring(k, c)
    return Spring(k, c, variation.order, variation.amplitude, variation.phase)


def radial(law: object, gear: sw.Gear) -> Callable[[float], tuple[float, float]]:
    """A kinematic error at the output as a radial displacement of the wave generator, outwards, and its slope.

    Outwards advances the circular spline, so that with the flexspline fixed the output comes early: e = -displacement
    tan(alpha_t) / r_g. With the circular spline fixed the flexspline goes further back, and e is positive.
    """
    structure = gear.structure
    sense = -1.0 if gear.kinematics.fixed == "flexspline" else 1.0
    lever = sense * structure.pitch_radius / tan(structure.pressure_angle)
    return lambda theta: (lever * law.error(theta), lever * law.slope(theta))


def document(gear: sw.Gear) -> Gear:
    """The gear in the document's symbols."""
    part = gear.structure
    return Gear(
        K_WG=spring(part.coupling_stiffness, part.coupling_damping, part.coupling_variation),
        K_b=spring(part.bearing_stiffness, part.bearing_damping, part.bearing_variation),
        K_t=spring(gear.stiffness.k, gear.damping, gear.stiffness_variation),
        K_m=spring(part.mesh_stiffness, part.mesh_damping, part.mesh_variation),
        K_CS=spring(part.circular_spline_stiffness, part.circular_spline_damping, part.circular_spline_variation),
        J_WG=gear.input_inertia,
        J_FS=part.flexspline_inertia,
        J_CS=part.circular_spline_inertia,
        radial_mass=part.radial_mass,
        tau=abs(gear.kinematics.ratio),
        r_g=part.pitch_radius,
        alpha_t=part.pressure_angle,
        fixed=gear.kinematics.fixed,
        e_WG=radial(gear.kinematic_error, gear),
    )


def free(gear: sw.Gear, motor_inertia: float, load: object, **others: object) -> sw.Drive:
    """A drive whose command is the torque of its motor."""
    return sw.Drive(
        gear=gear, motor=sw.motor.TorqueSource(inertia=motor_inertia), control=sw.control.OpenLoop(), load=load, **others
    )


def start(gear: Gear, input_speed: float) -> Array:
    """No part deformed, the motor shaft at angle zero, all turning together."""
    e, slope = gear.e_WG(0.0)
    lever = gear.r_g / (gear.tau * tan(gear.alpha_t))
    state = np.zeros(12)
    for place, radial in (0, e), (6, (lever + slope) * input_speed):
        ring = radial * tan(gear.alpha_t)
        state[place + 2] = radial
        state[place + (4 if gear.fixed == "flexspline" else 3)] = ring
        state[place + 5] = (ring if gear.fixed == "flexspline" else -ring) / gear.r_g
    state[6] = state[7] = input_speed
    return state


def by_scipy(
    drive: sw.Drive, motor: Waves, load: Callable[[float, float, float], float], times: Array, input_speed: float = 0.0
) -> dict[str, Array]:
    """Columns of a recording, by SciPy. `load`: torque that drives the output forwards, without friction of the gear."""
    gear = document(drive.gear)
    equations = rates(gear, drive.motor.inertia, drive.load.inertia, motor, load)
    span = (0.0, float(times[-1]))
    run = solve_ivp(equations, span, start(gear, input_speed), "DOP853", times, rtol=1e-12, atol=1e-14)
    sense = 1.0 if gear.fixed == "flexspline" else -1.0
    shown = [outputs(gear, y) for y in run.y.T]
    columns = {
        "bearing_displacement": "x1",
        "radial_displacement": "x2",
        "circular_spline_displacement": "y2",
        "bearing_force": "F_b",
        "mesh_force": "F_m",
    }
    torsion = np.array([deformed(gear, y[:6], y[6:]).deformation[2] for y in run.y.T])
    return {
        "input_angle": run.y[0],
        "output_angle": run.y[OUT],
        "input_speed": run.y[6],
        "output_speed": run.y[6 + OUT],
        **{name: sense * np.array([each[symbol] for each in shown]) for name, symbol in columns.items()},
        "flexspline_displacement": sense * gear.r_g * torsion,
        "wave_generator_torque": np.array([each["T_WG"] for each in shown]),
        "torque": np.array([each["T"] for each in shown]),
    }
