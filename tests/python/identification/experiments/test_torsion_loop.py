"""Compliance in series with the spring: against the statics of document A, solved as equations."""

from __future__ import annotations

import numpy as np
import pytest
import strainwave as sw
from strainwave.analysis.torsion_loop import series_compliance
from strainwave.identification.experiments.torsion_loop import TorsionLoop

STAGES = sw.structure.Staged(
    pitch_radius=25e-3,
    bearing_stiffness=5e7,
    mesh_stiffness=1e8,
    coupling_stiffness=5e3,
    circular_spline_stiffness=1e5,
    radial_mass=0.032,
    flexspline_inertia=2e-5,
    circular_spline_inertia=3e-4,
)
SPRING = sw.stiffness.Linear(k=2.5e4)
FIXED = sw.kinematics.StrainWave(flexspline_teeth=200, circular_spline_teeth=202, fixed="flexspline")


def staged() -> sw.Gear:
    return sw.Gear(kinematics=FIXED, structure=STAGES, stiffness=SPRING, input_inertia=8e-6)


def test_the_stages_give_way_as_document_a_has_it() -> None:
    """Its equations at rest, with the input held and the output turned by an angle, as a linear system."""
    s, ratio = STAGES, staged().kinematics.ratio
    r, alpha = s.pitch_radius, s.pressure_angle
    slope = 1.0 / (ratio * np.tan(alpha))  # tan alpha_n
    # unknowns: theta_WG, x_2, y_1, theta_CS, F_b, F_m; the output stands at -1 rad, so that the torque on it is positive
    rows = [
        ([-s.bearing_stiffness * r * slope, s.bearing_stiffness, 0, 0, 1, 0], 0.0),
        (
            [
                0,
                -s.mesh_stiffness * np.sin(alpha),
                s.mesh_stiffness * np.cos(alpha),
                s.mesh_stiffness * r * np.cos(alpha),
                0,
                1,
            ],
            0.0,
        ),
        ([0, 0, 0, 0, 1, -np.sin(alpha)], 0.0),
        ([s.coupling_stiffness, 0, 0, 0, r * slope, 0], 0.0),
        ([0, 0, -SPRING.k / r, 0, 0, r * np.cos(alpha)], 0.0),
        ([0, 0, 0, -s.circular_spline_stiffness, 0, r * np.cos(alpha)], s.circular_spline_stiffness),
    ]
    found = np.linalg.solve(np.array([row for row, _ in rows]), np.array([right for _, right in rows]))
    torque = float(found[5]) * r * np.cos(alpha)
    assert 1.0 / torque == pytest.approx(series_compliance(staged()) + 1.0 / SPRING.k, rel=1e-12)


def test_a_loop_of_a_gear_with_stages_tells_its_spring() -> None:
    torque = 40.0 * np.sin(np.linspace(0.0, 4.0 * np.pi, 200))
    twist = torque * (1.0 / SPRING.k + series_compliance(staged()))
    recording = sw.Recording({"twist": twist, "torque": torque}, {"twist": "rad", "torque": "N.m"})
    found = sw.fit(staged().replace(stiffness=sw.stiffness.Linear(k=1e4)), recording, ["stiffness.k"])
    assert found.gear.stiffness.tangent(0.0) == pytest.approx(SPRING.k, rel=1e-9)


def test_a_loop_at_the_input_of_a_gear_with_stages_is_refused() -> None:
    angle = np.sin(np.linspace(0.0, 4.0 * np.pi, 200))
    columns = {"input_angle": angle, "input_torque": 0.1 * angle}
    recording = sw.Recording(columns, {"input_angle": "rad", "input_torque": "N.m"})
    with pytest.raises(ValueError, match="measure it at the output, or fit a gear without stages"):
        TorsionLoop.of(recording, staged())
