"""A body in an air stream: numbers by hand, and where its energy goes."""

from __future__ import annotations

import numpy as np
import pytest
import strainwave as sw
from hypothesis import given, strategies as st

from tests.load.free import free, placed, run_of
from tests.support.geared import outputs

FLAP = sw.loads.Aerodynamic(
    inertia=0.2, area=0.5, chord=0.3, airspeed=40.0, moment_coefficient=0.02, moment_slope=0.1, neutral_angle=0.05
)
BLADE = sw.loads.Aerodynamic(inertia=0.2, area=0.4, airspeed=0.0, drag_coefficient=1.2, drag_radius=0.5)


def torque(load: sw.loads.Aerodynamic, angle: float, speed: float = 0.0) -> float:
    drive = free(load)
    return outputs(drive, placed(drive, angle, speed))["load_torque"]


def test_the_hinge_moment_is_dynamic_pressure_times_area_chord_and_coefficient() -> None:
    """1/2 x 1.225 x 40^2 = 980 Pa; x 0.5 m2 x 0.3 m = 147 N.m; x (0.02 + 0.1 sin 0.2) = 147 x 0.0398669330795061."""
    assert torque(FLAP, 0.25) == pytest.approx(5.860439162687397, rel=1e-12)


def test_the_drag_of_turning_is_dynamic_pressure_at_its_radius() -> None:
    """(3 rad/s x 0.5 m)^2 = 2.25; 1/2 x 1.225 x 2.25 = 1.378125 Pa; x 0.4 m2 x 1.2 = 0.6615 N; x 0.5 m = 0.33075 N.m."""
    assert torque(BLADE, 0.7, 3.0) == pytest.approx(0.33075, rel=1e-12)
    assert torque(BLADE, 0.7, -3.0) == pytest.approx(-0.33075, rel=1e-12)


@given(angle=st.floats(-0.02, 0.02), factor=st.floats(0.1, 10.0))
def test_it_grows_with_the_square_of_the_airspeed_and_in_proportion_to_small_angles(angle: float, factor: float) -> None:
    load = FLAP.replace(moment_coefficient=0.0, neutral_angle=0.0)
    assert torque(load, angle) == pytest.approx(147.0 * 0.1 * angle, rel=1e-4, abs=1e-12)  # sin x = x (1 - x^2 / 6)
    faster = load.replace(airspeed=factor * 40.0)
    assert torque(faster, angle) == pytest.approx(factor**2 * torque(load, angle), rel=1e-12, abs=1e-15)
    assert torque(load.replace(density=factor * 1.225), angle) == pytest.approx(
        factor * torque(load, angle), rel=1e-12, abs=1e-15
    )


def test_without_drag_a_surface_swings_for_ever() -> None:
    """1/2 J w^2 + q S c (C_0 theta - C_1 cos(theta - theta_0)) stays."""
    drive = free(FLAP)
    run = run_of(drive, 2.0, 5e-4, placed(drive, 0.6))
    angle = run["output_angle"]
    potential = 147.0 * (0.02 * angle - 0.1 * np.cos(angle - 0.05))
    kinetic = 0.1 * run["output_speed"] ** 2
    assert np.ptp(kinetic) > 1.0
    assert kinetic + potential == pytest.approx(potential[0], abs=1e-7)
    assert run["energy_load"] == pytest.approx(potential - potential[0], abs=1e-7)


def test_small_swings_have_the_frequency_of_the_slope() -> None:
    drive = free(FLAP.replace(moment_coefficient=0.0))
    run = run_of(drive, 2.0, 5e-4, placed(drive, 0.05 + 1e-4))
    w = np.sqrt(147.0 * 0.1 / 0.2)
    assert run["output_angle"] - 0.05 == pytest.approx(1e-4 * np.cos(w * run.time), abs=1e-10)


def test_drag_stops_a_body_as_the_hyperbola_of_the_square() -> None:
    """J dw/dt = -c w^2: w = w_0 / (1 + c w_0 t / J), and what is missing is in the air."""
    drive = free(BLADE)
    run = run_of(drive, 5.0, 1e-3, placed(drive, 0.0, -20.0))
    c = 0.5 * 1.225 * 0.4 * 1.2 * 0.5**3
    speed = 20.0 / (1.0 + c * 20.0 * run.time / 0.2)
    assert run["output_speed"] == pytest.approx(-speed, rel=1e-9)
    assert run["energy_load"] == pytest.approx(0.1 * (400.0 - speed**2), rel=1e-8, abs=1e-9)
