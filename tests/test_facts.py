"""What two parts of a gear are told alike: a gear refuses those that contradict each other, and names both numbers."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest
import strainwave as sw
from strainwave.kinematic_error import Misalignment, Scaled, ToothErrors

STAGED = sw.structure.Staged(
    pitch_radius=25e-3,
    pressure_angle=np.radians(30.0),
    coupling_stiffness=5e3,
    bearing_stiffness=5e7,
    mesh_stiffness=1e8,
    circular_spline_stiffness=1e5,
    radial_mass=0.032,
    flexspline_inertia=2e-5,
    circular_spline_inertia=3e-4,
)
GEAR = sw.Gear(structure=STAGED, input_inertia=8e-6)  # 200 and 202 teeth, the circular spline fixed
PLAIN = GEAR.replace(kinematics=sw.kinematics.PlainRatio(reduction=100.0))
MISALIGNED = Misalignment(major_radius=25.25e-3, minor_radius=24.75e-3, pitch_radius=25e-3, pressure_angle=np.radians(30.0))
TEETH = ToothErrors(flexspline_teeth=200, circular_spline_teeth=202, pitch_radius=25e-3, engaged_share=0.3)
SPRINGS = sw.stiffness.MultiCompliance(
    flexspline_stiffness=8e3,
    flexspline_hardening=0.02,
    wave_generator_stiffness=2.0,
    wave_generator_hardening=1.5,
    reduction=100.0,
)
WINDUP = sw.hysteresis.FrictionalWindup(springs=SPRINGS, friction=1.0)

AGREEING: list[dict[str, Any]] = [
    {"kinematic_error": MISALIGNED},
    {"kinematic_error": MISALIGNED.replace(pitch_radius=25e-3 * (1.0 + 1e-12))},
    {"kinematic_error": Scaled(law=MISALIGNED)},
    {"kinematic_error": TEETH},
    {"hysteresis": WINDUP},
    {"structure": sw.structure.Lumped(), "kinematic_error": MISALIGNED.replace(pitch_radius=20e-3, pressure_angle=0.3)},
]


@pytest.mark.parametrize("parts", AGREEING)
@pytest.mark.parametrize("gear", [GEAR, PLAIN], ids=["teeth", "ratio"])
def test_a_gear_takes_parts_that_are_told_the_same(gear: sw.Gear, parts: dict[str, Any]) -> None:
    made = gear.replace(**parts)
    assert all(getattr(made, name) == part for name, part in parts.items())


CONTRADICTING: list[tuple[sw.Gear, dict[str, Any], str]] = [
    (
        GEAR,
        {"kinematic_error": MISALIGNED.replace(pitch_radius=26e-3)},
        "the pitch_radius of kinematic_error, 0.026 m, must be that of structure, 0.025 m; give both alike",
    ),
    (
        GEAR,
        {"kinematic_error": Scaled(law=MISALIGNED.replace(pitch_radius=26e-3))},
        "the pitch_radius of kinematic_error, 0.026 m, must be that of structure, 0.025 m; give both alike",
    ),
    (
        GEAR,
        {"kinematic_error": MISALIGNED.replace(pressure_angle=0.5)},
        f"the pressure_angle of kinematic_error, 0.5 rad, must be that of structure, {np.radians(30.0)} rad; give both alike",
    ),
    (
        GEAR,
        {"kinematic_error": TEETH.replace(pitch_radius=24e-3)},
        "the pitch_radius of kinematic_error, 0.024 m, must be that of structure, 0.025 m; give both alike",
    ),
    (
        GEAR,
        {"kinematic_error": TEETH.replace(flexspline_teeth=100, circular_spline_teeth=102)},
        "the flexspline_teeth of kinematic_error, 100, must be those of kinematics, 200; give both alike",
    ),
    (
        GEAR,
        {"kinematic_error": Scaled(law=TEETH.replace(circular_spline_teeth=204))},
        "the circular_spline_teeth of kinematic_error, 204, must be those of kinematics, 202; give both alike",
    ),
    (
        GEAR,
        {"kinematic_error": TEETH.replace(fixed="flexspline")},
        "kinematic_error has the flexspline fixed, kinematics the circular_spline; give both alike",
    ),
    (
        GEAR,
        {"kinematics": sw.kinematics.StrainWave(fixed="flexspline"), "kinematic_error": TEETH},
        "kinematic_error has the circular_spline fixed, kinematics the flexspline; give both alike",
    ),
    (
        PLAIN,
        {"kinematic_error": TEETH.replace(flexspline_teeth=160, circular_spline_teeth=162)},
        "the teeth of kinematic_error have the ratio 80, kinematics has 100; give both alike",
    ),
    (
        GEAR,
        {"hysteresis": WINDUP.replace(springs=SPRINGS.replace(reduction=50.0))},
        "hysteresis.springs.reduction = 50 must be 100, the ratio of kinematics without its sign; give both alike",
    ),
    (
        GEAR,
        {"stiffness": SPRINGS.replace(reduction=50.0)},
        "stiffness.reduction = 50 must be 100, the ratio of kinematics without its sign; give both alike",
    ),
    (
        GEAR,
        {"input_inertia": 0.0},
        "input_inertia = 0 kg.m2 must exceed 0 with stages: the wave generator is a body of its own; give its inertia",
    ),
]


@pytest.mark.parametrize(("gear", "parts", "message"), CONTRADICTING, ids=[message for *_, message in CONTRADICTING])
def test_a_gear_refuses_parts_that_contradict_each_other(gear: sw.Gear, parts: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=f"^gear: {re.escape(message)}$"):
        gear.replace(**parts)


def test_members_of_an_ensemble_that_contradict_are_refused_alone() -> None:
    drive = sw.load("tilt-actuator")
    with pytest.warns(sw.simulation.EnsembleWarning, match="1 of 2 members have no result"):
        runs = sw.simulate_many(
            drive, sw.scenario.constant(0.0, 1e-4), {"gear.structure.pitch_radius": [25e-3, 26e-3]}, dt=2e-5, record=["torque"]
        )
    assert list(runs.failures) == [1]
    assert "the pitch_radius of kinematic_error, 0.025 m, must be that of structure, 0.026 m" in runs.failures[1]
