"""The staged gear of several tests, its drive, and the motions that shake it."""

from __future__ import annotations

from math import pi
from typing import Any

import pytest
import strainwave as sw

from tests.structure.written_down import FIXED, Waves, free

ERROR = sw.kinematic_error.Fourier(order=[2.0, 4.0, 1.0], amplitude=[3e-4, 0.8e-4, 1e-4], phase=[0.3, -1.1, 2.0])
STRUCTURE = sw.structure.Staged(
    pitch_radius=0.025,
    pressure_angle=pi / 6.0,
    coupling_stiffness=60.0,
    coupling_damping=2e-4,
    bearing_stiffness=2e6,
    bearing_damping=20.0,
    mesh_stiffness=4e6,
    mesh_damping=30.0,
    circular_spline_stiffness=3e3,
    circular_spline_damping=0.3,
    radial_mass=0.08,
    flexspline_inertia=5e-5,
    circular_spline_inertia=3e-4,
)
GEAR = sw.Gear(
    kinematics=FIXED["flexspline"],
    stiffness=sw.stiffness.Linear(k=2e3),
    damping=0.2,
    input_inertia=2e-5,
    kinematic_error=ERROR,
    structure=STRUCTURE,
)
DRIVE = free(GEAR, 5e-5, sw.loads.Inertia(inertia=0.02))
DAMPINGS = ["coupling_damping", "bearing_damping", "mesh_damping", "circular_spline_damping"]
SHAKEN = Waves([(0.4, 31.0, 0.3), (0.3, 170.0, 1.0), (0.2, 600.0, 2.0)])
PUSHED = Waves([(6.0, 45.0, 0.0), (4.0, 333.0, 0.0)])  # nothing at the start: the gear is not loaded there
orientation = pytest.mark.parametrize("fixed", list(FIXED))


MISALIGNED = sw.kinematic_error.Misalignment(
    major_radius=25.3e-3, minor_radius=24.7e-3, pitch_radius=25e-3, pressure_angle=pi / 6.0, housing_eccentricity=20e-6
)
RELIEVED = sw.kinematic_error.Scaled(law=ERROR, load_sensitivity=0.02)
FRICTIONS = {
    "viscous": sw.friction.Viscous(viscous=0.1),
    "sticking": sw.friction.Stribeck(coulomb=0.8, breakaway=1.0, stribeck_speed=0.02, viscous=0.1),
}


def varying(amplitude: float, order: float, phase: float) -> Any:
    return sw.variation.Periodic(order=[order], amplitude=[amplitude], phase=[phase])


def everywhere(gear: sw.Gear) -> sw.Gear:
    """Every spring varies, each in its own way."""
    return gear.replace(
        stiffness_variation=varying(0.10, 2.0, 0.3),
        structure=gear.structure.replace(
            coupling_variation=varying(0.05, 1.0, 1.0),
            bearing_variation=varying(0.15, 2.0, -0.7),
            mesh_variation=varying(0.20, 4.0, 2.0),
            circular_spline_variation=varying(0.07, 3.0, 0.1),
        ),
    )


def shaken(drive: sw.Drive, duration: float, rtol: float = 1e-11, **others: Any) -> sw.Run:
    return sw.simulate_adaptively(
        drive, SHAKEN.scenario(duration), rtol, load_torque=PUSHED.scenario(duration), sample=duration / 40.0, **others
    )
