"""The gear in stages with document A's numbers, against independent numbers and tests/support/actuator_equations.py."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest
import strainwave as sw

from tests.structure.written_down import FIXED, Waves, by_scipy, free

TAU, R_G = 101.0, 0.025
STRUCTURE = sw.structure.Staged(
    pitch_radius=R_G,
    pressure_angle=pi / 6.0,
    coupling_stiffness=5e3,
    bearing_stiffness=5e7,
    mesh_stiffness=1e8,
    circular_spline_stiffness=1e5,
    radial_mass=2e-5 / R_G**2,
    flexspline_inertia=2e-5,
    circular_spline_inertia=3e-4,
)
GEAR = sw.Gear(kinematics=FIXED["flexspline"], stiffness=sw.stiffness.Linear(k=2e4), input_inertia=8e-6, structure=STRUCTURE)
LOAD = 20.0  # N.m


def test_the_ratio_is_that_of_the_document() -> None:
    assert GEAR.kinematics.ratio == TAU


def test_20_newton_metres_load_the_parts_as_known() -> None:
    """F_m, F_b, T_WG, and between wave generator and circular spline K_out = 12195.12 N.m/rad."""
    drive = free(GEAR.replace(friction_input=sw.friction.Coulomb(coulomb=10.0)), 1e-5, sw.loads.Inertia(inertia=0.05))
    run = sw.simulate(
        drive,
        sw.scenario.constant(0.0, 1e-6),
        1e-7,
        load_torque=LOAD,
        initial={"input_angle": 0.0, "input_speed": 0.0, "output_speed": 0.0},
    )
    assert run["mesh_force"][0] == pytest.approx(923.7604307034012, rel=1e-11)
    assert run["bearing_force"][0] == pytest.approx(461.8802153517006, rel=1e-11)
    assert run["wave_generator_torque"][0] == pytest.approx(0.198019801980198, rel=1e-11)
    assert run["circular_spline_torque"][0] == pytest.approx(LOAD, rel=1e-11)
    generator = run["bearing_displacement"][0] / (R_G * np.tan(0.01714733708184737))
    spline = run["circular_spline_displacement"][0] / R_G
    assert LOAD / (generator / TAU - spline) == pytest.approx(12195.12195121951, rel=1e-9)
    assert generator == pytest.approx(-LOAD / TAU / 5e3, rel=1e-9)
    assert spline - run["output_angle"][0] == pytest.approx(LOAD / 1e5, rel=1e-9)


def test_the_fast_modes_are_the_known_ones_where_motor_and_load_hang_on_soft_shafts() -> None:
    """6298.71, 37476.81 and 66337.87 rad/s are of the gear by itself, both its ends free, as soft couplings leave them."""
    part = STRUCTURE.replace(coupling_stiffness=1e-6, circular_spline_stiffness=1e-3)
    found = sw.analysis.modes(free(GEAR.replace(structure=part), 1.0, sw.loads.Inertia(inertia=1.0)))
    assert found["free"][-3:] == pytest.approx([6298.71, 37476.81, 66337.87], abs=0.005)


@pytest.mark.slow("physics")
@pytest.mark.parametrize("fixed", list(FIXED))
def test_with_the_documents_numbers_it_moves_as_the_equations_have_it(fixed: str) -> None:
    """Three milliseconds, in which the fastest mode swings thirty times; damped by 2 % and less, with the errors of 7.9."""
    error = sw.kinematic_error.Fourier(order=[1.0, 2.0, 4.0], amplitude=[0.8e-4, 3e-4, 0.5e-4], phase=[0.4, -1.0, 2.0])
    part = STRUCTURE.replace(bearing_damping=30.0, mesh_damping=50.0, coupling_damping=1e-3, circular_spline_damping=0.5)
    gear = GEAR.replace(kinematics=FIXED[fixed], kinematic_error=error, structure=part, damping=0.5)
    drive = free(gear, 1e-5, sw.loads.Inertia(inertia=0.05))
    motor, load = Waves([(0.5, 200.0, 0.3), (0.5, 3000.0, 1.0)]), Waves([(20.0, 150.0, 0.0), (10.0, 5000.0, 0.0)])
    run = sw.simulate_adaptively(
        drive,
        motor.scenario(3e-3),
        1e-11,
        load_torque=load.scenario(3e-3),
        sample=1e-4,
        initial={"input_speed": 32.0},
    )
    known = by_scipy(drive, motor, lambda *now: -load(*now), run.time, 32.0)
    for name, values in known.items():
        assert np.abs(run[name] - values).max() <= 1e-8 * np.abs(values).max(), name


# In the current, as of the lumped gear of 7.9


def signature_drive(k: float, amplitude: float, error: float) -> sw.Drive:
    """A speed loop so stiff that it holds the speed, around a gear whose flexspline has the stiffness k and varies."""
    gear = GEAR.replace(
        stiffness=sw.stiffness.Linear(k=k),
        damping=4.0,
        friction_input=sw.friction.Coulomb(coulomb=0.02, breakaway=0.02, viscous=2e-4),
        kinematic_error=sw.kinematic_error.Fourier(order=[2.0], amplitude=[error], phase=[0.0]),
        stiffness_variation=sw.variation.Periodic(order=[2.0], amplitude=[amplitude], phase=[0.0]),
        structure=STRUCTURE.replace(
            coupling_damping=1e-2, bearing_damping=100.0, mesh_damping=100.0, circular_spline_damping=3.0
        ),
    )
    return sw.Drive(
        gear=gear,
        motor=sw.motor.CurrentSource(torque_constant=0.05, inertia=1.5e-4),
        control=sw.control.PI(proportional=4.0, integral=200.0, limit=40.0),
        load=sw.loads.Inertia(inertia=0.05),
    )


def second_order(drive: sw.Drive) -> float:
    """Amplitude of order 2 of the wave generator in the current [A], at 10 rad/s of the motor under 20 N.m."""
    speed, settling = 10.0, 0.6
    duration = settling + 2.0 * pi / speed
    run = sw.simulate(
        drive,
        sw.scenario.constant(speed / TAU, duration),
        1e-5,
        sample=2.0 * pi / speed / 400.0,
        load_torque=LOAD,
        initial={"input_speed": speed},
        record=["input_angle", "current"],
    ).between(settling, duration)
    angle, current = run["input_angle"], run["current"]
    basis = np.column_stack([np.ones_like(angle), *(wave(n * angle) for n in range(1, 7) for wave in (np.sin, np.cos))])
    found = np.linalg.lstsq(basis, current, rcond=None)[0]
    return float(np.hypot(found[3], found[4]))


@pytest.mark.parametrize(
    ("k", "amplitude", "error", "expected"),
    [(8000.0, 0.05, 0.0, 50e-3), (2e4, 0.05, 0.0, 20e-3), (8000.0, 0.0, 3e-4, 240e-3)],
)
def test_a_varying_flexspline_shows_in_the_current_beside_the_error(
    k: float, amplitude: float, error: float, expected: float
) -> None:
    """a T^2 / (k K_t): 50 mA of 5 % at order 2 for the 8000 N.m/rad of the drive that shows 240 mA of an error of 3e-4 rad."""
    assert second_order(signature_drive(k, amplitude, error)) == pytest.approx(expected, rel=0.03)
