"""The gear in stages against the equations of tests/support/actuator_equations.py, closed forms, and the lumped gear."""

from __future__ import annotations

from math import cos, pi, sin, tan
from typing import Any

import numpy as np
import pytest
import strainwave as sw
from hypothesis import given, settings, strategies as st

from tests.structure.staged_gear import (
    DRIVE,
    ERROR,
    FRICTIONS,
    GEAR,
    MISALIGNED,
    PUSHED,
    RELIEVED,
    SHAKEN,
    STRUCTURE,
    everywhere,
    orientation,
    shaken,
    varying,
)
from tests.structure.written_down import FIXED, NOTHING, Waves, by_scipy, document, free
from tests.support.actuator_equations import IN, OUT, WG, X2, Y1, Y2, damping_matrix, masses, stiffness_matrix
from tests.support.samples import sample

# Against the equations


def agree(run: sw.Recording, known: dict[str, np.ndarray], tolerance: float) -> None:
    """All columns to this part of their largest value."""
    for name, values in known.items():
        assert np.abs(run[name] - values).max() <= tolerance * np.abs(values).max(), name


@pytest.mark.slow("physics")
@orientation
@pytest.mark.parametrize("vary", [lambda gear: gear, everywhere], ids=["even", "varying"])
@pytest.mark.parametrize("speed", [0.0, 70.0])
def test_a_run_is_what_the_equations_integrated_by_scipy_give(fixed: str, vary: Any, speed: float) -> None:
    """All that a recording shows of the stages, to 1e-8 of the largest: with a kinematic error, dampers and varying springs."""
    drive = DRIVE.replace(gear=vary(GEAR.replace(kinematics=FIXED[fixed])))
    run = shaken(drive, 0.02, initial={"input_speed": speed} if speed else None)
    known = by_scipy(drive, SHAKEN, lambda *at: -PUSHED(*at), run.time, speed)
    agree(run, known, 1e-8)


@pytest.mark.slow("physics")
@orientation
@pytest.mark.parametrize("combine", ["single", "mean", "max"])
def test_misalignment_moves_the_stages_as_the_equations_have_it(fixed: str, combine: str) -> None:
    law = sw.kinematic_error.Misalignment(
        major_radius=25.3e-3,
        minor_radius=24.7e-3,
        pitch_radius=25e-3,
        pressure_angle=pi / 6.0,
        offset=4e-3,
        housing_eccentricity=20e-6,
        housing_direction=0.4,
        housing_tilt_x=2e-3,
        generator_eccentricity=10e-6,
        generator_tilt_y=1e-3,
        combine=combine,
    )
    drive = DRIVE.replace(gear=GEAR.replace(kinematics=FIXED[fixed], kinematic_error=law))
    run = shaken(drive, 0.02, 1e-10 if combine == "max" else 1e-11, initial={"input_speed": 100.0})
    known = by_scipy(drive, SHAKEN, lambda *at: -PUSHED(*at), run.time, 100.0)
    agree(run, known, 1e-6 if combine == "max" else 1e-8)


@orientation
def test_fixed_steps_approach_the_equations_in_fourth_order(fixed: str) -> None:
    """Of one radian of the fastest vibration on, springs varying."""
    drive = DRIVE.replace(gear=everywhere(GEAR.replace(kinematics=FIXED[fixed])))
    times = np.linspace(0.0, 0.01, 51)
    known = by_scipy(drive, SHAKEN, lambda *at: -PUSHED(*at), times)["torque"]
    off = []
    for dt in (1e-4, 5e-5, 2.5e-5):
        run = sw.simulate(drive, SHAKEN.scenario(0.01), dt, load_torque=PUSHED.scenario(0.01), sample=2e-4)
        off.append(np.abs(run["torque"] - known).max())
    assert np.log2(np.array(off[:-1]) / np.array(off[1:])) == pytest.approx([4.0, 4.0], abs=0.4)


# At rest


def held(gear: sw.Gear, torque: float, angle: float = 0.3) -> sw.Run:
    """A moment of a gear at rest under a torque at its output; its motor shaft held by friction."""
    stuck = gear.replace(friction_input=sw.friction.Coulomb(coulomb=1e3))
    drive = free(stuck, 5e-5, sw.loads.Inertia(inertia=0.02))
    return sw.simulate(
        drive,
        sw.scenario.constant(0.0, 2e-8),
        1e-8,
        load_torque=torque,
        initial={"input_angle": angle, "input_speed": 0.0, "output_speed": 0.0},
    )


stiffnesses = st.fixed_dictionaries(
    {
        "pressure_angle": st.floats(0.2, 0.9),
        "coupling_stiffness": st.floats(20.0, 5e3),
        "bearing_stiffness": st.floats(1e6, 1e8),
        "mesh_stiffness": st.floats(1e6, 1e8),
        "circular_spline_stiffness": st.floats(1e3, 1e5),
    }
)


@given(stiffnesses, st.floats(1e3, 5e4), st.floats(-60.0, 60.0), st.sampled_from(list(FIXED)))
@settings(max_examples=sample(10, 25))
def test_at_rest_the_compliances_of_all_stages_add(numbers: dict[str, float], k_t: float, torque: float, fixed: str) -> None:
    """1/K = 1/K_t + 1/K_CS + tan^2/(K_b r^2) + 1/(K_m r^2 cos^2) + 1/(i^2 K_WG), and all forces are in equilibrium."""
    part = STRUCTURE.replace(**numbers)
    gear = GEAR.replace(
        kinematics=FIXED[fixed],
        stiffness=sw.stiffness.Linear(k=k_t),
        kinematic_error=sw.kinematic_error.Fourier(),
        structure=part,
    )
    run = held(gear, torque)
    r, t, c, ratio = part.pitch_radius, tan(part.pressure_angle), cos(part.pressure_angle), gear.kinematics.ratio
    compliance = (
        1.0 / k_t
        + 1.0 / part.circular_spline_stiffness
        + t * t / (part.bearing_stiffness * r * r)
        + 1.0 / (part.mesh_stiffness * r * r * c * c)
        + 1.0 / (ratio * ratio * part.coupling_stiffness)
    )
    size = abs(torque) + 1e-3
    for place in 0, -1:
        assert run["transmission_error"][place] == pytest.approx(torque * compliance, abs=1e-9 * size * compliance)
        assert run["torque"][place] == pytest.approx(torque, abs=1e-9 * size)
        assert run["mesh_force"][place] == pytest.approx(torque / (r * c), abs=1e-9 * size / (r * c))
        assert run["bearing_force"][place] == pytest.approx(torque * t / r, abs=1e-9 * size * t / r)
        assert run["wave_generator_torque"][place] == pytest.approx(torque / ratio, abs=1e-9 * size / abs(ratio))
        assert run["circular_spline_torque"][place] == pytest.approx(torque, abs=1e-9 * size)
        assert run["twist"][place] == pytest.approx(torque / k_t, abs=1e-9 * size / k_t)


@orientation
def test_at_rest_a_kinematic_error_and_varying_springs_are_in_equilibrium_too(fixed: str) -> None:
    """Nothing moves, though the bearing's lever and the springs' stiffness change with the angle."""
    run = held(everywhere(GEAR.replace(kinematics=FIXED[fixed])), 15.0, angle=0.8)
    angle = 0.8 - run["wave_generator_torque"][0] / (60.0 * (1.0 + 0.05 * sin(0.8 + 1.0)))
    for name in "torque", "bearing_force", "mesh_force", "wave_generator_torque", "output_angle":
        np.testing.assert_allclose(run[name], run[name][0], rtol=1e-9)
    lever = 0.025 / tan(pi / 6.0)
    assert run["bearing_force"][0] * lever == pytest.approx(15.0, rel=1e-9)
    slope = ERROR.slope(angle)
    reaction = 15.0 * (1.0 / run_ratio(fixed) - slope)
    turning = 0.5 * 2e3 * 0.10 * 2.0 * cos(2.0 * angle + 0.3) * (15.0 / (2e3 * (1.0 + 0.10 * sin(2.0 * angle + 0.3)))) ** 2
    for k, a, h, phase in (
        (2e6 * lever**2, 0.15, 2.0, -0.7),
        (4e6 * (0.025 * cos(pi / 6.0)) ** 2, 0.20, 4.0, 2.0),
        (3e3, 0.07, 3.0, 0.1),
    ):
        factor, rise = 1.0 + a * sin(h * angle + phase), a * h * cos(h * angle + phase)
        turning += 0.5 * k * rise * (15.0 / (k * factor)) ** 2
    bend = run["wave_generator_torque"][0] ** 2 * 0.05 * cos(angle + 1.0) / (120.0 * (1.0 + 0.05 * sin(angle + 1.0)) ** 2)
    assert run["wave_generator_torque"][0] == pytest.approx(reaction + turning + bend, rel=2e-4)


def run_ratio(fixed: str) -> float:
    return FIXED[fixed].ratio


@orientation
@pytest.mark.parametrize("speed", [0.0, 30.0, -250.0])
def test_unloaded_and_aligned_the_output_turns_by_the_ratio_exactly(fixed: str, speed: float) -> None:
    """To rounding over a hundred turns, and no force anywhere."""
    gear = GEAR.replace(kinematics=FIXED[fixed], kinematic_error=sw.kinematic_error.Fourier())
    drive = DRIVE.replace(gear=gear)
    duration = 628.0 / abs(speed) if speed else 0.1
    run = sw.simulate_adaptively(
        drive, sw.scenario.constant(0.0, duration), sample=duration / 20.0, initial={"input_speed": speed}
    )
    ratio = gear.kinematics.ratio
    np.testing.assert_allclose(run["output_angle"], run["input_angle"] / ratio, rtol=0.0, atol=1e-13)
    np.testing.assert_allclose(run["output_speed"], speed / ratio, rtol=1e-12)
    assert np.abs(run["torque"]).max() < 1e-9
    assert np.abs(run["mesh_force"]).max() < 1e-6


# Modes


def frequencies(drive: sw.Drive, moving: list[int]) -> np.ndarray:
    gear = document(drive.gear)
    m = 1.0 / np.sqrt(masses(gear, drive.motor.inertia, drive.load.inertia)[moving])
    return np.sqrt(np.abs(np.linalg.eigvalsh(m[:, None] * stiffness_matrix(gear)[np.ix_(moving, moving)] * m)))


@given(stiffnesses, st.floats(1e3, 5e4), st.floats(1e-5, 1e-3), st.floats(1e-3, 1.0), st.sampled_from(list(FIXED)))
@settings(max_examples=sample(4, 10), deadline=None)
def test_the_modes_are_those_of_masses_and_springs(
    numbers: dict[str, float], k_t: float, j_in: float, j_out: float, fixed: str
) -> None:
    """Of the equations' matrices: six bodies, the input held or free."""
    gear = GEAR.replace(kinematics=FIXED[fixed], stiffness=sw.stiffness.Linear(k=k_t), structure=STRUCTURE.replace(**numbers))
    drive = free(gear, j_in, sw.loads.Inertia(inertia=j_out))
    found = sw.analysis.modes(drive)
    assert found["free"] == pytest.approx(frequencies(drive, [IN, WG, X2, Y1, Y2, OUT])[1:], rel=1e-6)
    assert found["input held"] == pytest.approx(frequencies(drive, [WG, X2, Y1, Y2, OUT]), rel=1e-6)


@orientation
def test_linearised_it_has_the_poles_of_masses_springs_and_dampers(fixed: str) -> None:
    gear = GEAR.replace(kinematics=FIXED[fixed], kinematic_error=sw.kinematic_error.Fourier())
    drive = DRIVE.replace(gear=gear, load=sw.loads.TorsionSpring(inertia=0.02, stiffness=50.0))
    written = document(gear)
    inverse = 1.0 / masses(written, 5e-5, 0.02)[:, None]
    stiff = stiffness_matrix(written)
    stiff[OUT, OUT] += 50.0
    state = np.block([[np.zeros((6, 6)), np.eye(6)], [-inverse * stiff, -inverse * damping_matrix(written)]])
    poles = np.linalg.eigvals(state)
    found = sw.linearise(drive, drive.rest()).poles
    for pole in poles:
        assert np.abs(found - pole).min() < 1e-6 * np.abs(poles).max()
    assert len(found) == 12


# Energy


@pytest.mark.slow("physics")
@orientation
@pytest.mark.parametrize(("seed", "error"), [(0, ERROR), (1, MISALIGNED), (2, RELIEVED)])
@pytest.mark.parametrize("friction", FRICTIONS.values(), ids=FRICTIONS)
def test_what_the_motor_supplies_is_stored_lost_or_at_the_load(fixed: str, seed: int, error: Any, friction: Any) -> None:
    """To 1e-9 of the largest energy in play, under random torques; the dampers only ever take."""
    random = np.random.default_rng(seed)
    gear = everywhere(GEAR.replace(kinematics=FIXED[fixed], kinematic_error=error, friction_output=friction))
    drive = free(gear, 5e-5, sw.loads.Inertia(inertia=0.02), meter=sw.meter.EnergyMeter())
    motor, load = (
        Waves([(size * random.normal(), 10.0 ** random.uniform(1.0, 3.0), random.uniform(0.0, 6.0)) for _ in range(4)])
        for size in (0.3, 8.0)
    )
    run = sw.simulate_adaptively(
        drive,
        motor.scenario(0.04),
        1e-9,
        load_torque=load.scenario(0.04),
        sample=5e-4,
        initial={"input_speed": random.uniform(-100.0, 100.0)},
    )
    stored = sum(run[name] for name in run.names if name.startswith("stored_"))
    taken = sum(run[name] for name in run.names if name.startswith("energy_") and name != "energy_supplied")
    turned_over = max(np.abs(run[name]).max() for name in run.names if name.startswith(("stored_", "energy_")))
    assert np.abs(run["energy_supplied"] - taken - (stored - stored[0])).max() < 1e-9 * turned_over
    assert np.all(run["power_damping"] >= 0.0)


@orientation
def test_an_output_that_sticks_stands_still_and_the_bodies_within_swing(fixed: str) -> None:
    """Exactly, as long as what the gear transmits is less than its breakaway."""
    friction = sw.friction.Stribeck(coulomb=8.0, breakaway=10.0, stribeck_speed=0.02)
    drive = DRIVE.replace(gear=GEAR.replace(kinematics=FIXED[fixed], friction_output=friction))
    run = sw.simulate(drive, sw.scenario.constant(0.04, 0.05), 1e-5, sample=1e-4)
    assert 2.0 < np.abs(run["torque"]).max() < 10.0
    assert np.all(run["output_speed"] == 0.0)
    assert np.ptp(run["output_angle"]) < 1e-15  # it follows from input angle and transmission error
    assert np.ptp(run["mesh_force"]) > 10.0
    np.testing.assert_allclose(run["output_torque"], 0.0, atol=1e-12)


# The lumped gear as a limit


def lumped(gear: sw.Gear) -> sw.Gear:
    return gear.replace(structure=sw.structure.Lumped())


def stiffened(gear: sw.Gear, times: float, mass: float) -> sw.Gear:
    """Stages so many times as stiff as the flexspline, without damping, their bodies of this inertia at the output [kg.m2]."""
    part = gear.structure
    r, k = part.pitch_radius, gear.stiffness.k
    return gear.replace(
        structure=part.replace(
            coupling_stiffness=times * k / gear.kinematics.ratio**2,
            bearing_stiffness=times * k / r**2,
            mesh_stiffness=times * k / r**2,
            circular_spline_stiffness=times * k,
            coupling_damping=0.0,
            bearing_damping=0.0,
            mesh_damping=0.0,
            circular_spline_damping=0.0,
            radial_mass=mass / r**2,
            flexspline_inertia=mass,
            circular_spline_inertia=mass,
        )
    )


@orientation
def test_stiff_stages_rest_as_the_lumped_gear_does(fixed: str) -> None:
    """To 1e-6; the bodies are heavy, which at rest is of no account and lets steps follow."""
    gear = GEAR.replace(kinematics=FIXED[fixed], stiffness_variation=varying(0.05, 2.0, 0.3))
    for torque in 20.0, -7.0:
        staged, whole = held(stiffened(gear, 1e9, 1e4), torque), held(lumped(gear), torque)
        for name in "twist", "torque", "transmission_error", "kinematic_error", "output_angle":
            assert staged[name][0] == pytest.approx(whole[name][0], rel=1e-6)


@orientation
def test_stiff_and_light_stages_answer_as_the_lumped_gear_does(fixed: str) -> None:
    """To 1e-6 from far below its resonance at 50 Hz to far above, with a kinematic error."""
    gear = GEAR.replace(kinematics=FIXED[fixed], stiffness_variation=varying(0.05, 2.0, 0.3))
    load = sw.loads.TorsionSpring(inertia=0.02, stiffness=50.0)
    staged, whole = (
        sw.linearise(drive, drive.rest())
        for drive in (free(one, 5e-5, load) for one in (stiffened(gear, 1e8, 5e-10), lumped(gear)))
    )
    frequency = np.array([0.1, 1.0, 10.0, 30.0, 45.0, 55.0, 70.0, 100.0, 150.0])
    for source in "command", "load_torque":
        for name in "input_angle", "output_angle", "torque", "twist":
            known = whole.response(frequency, name, source)
            assert np.abs(staged.response(frequency, name, source) - known).max() < 1e-6 * np.abs(known).max()


@pytest.mark.slow("physics")
@orientation
def test_the_stiffer_and_lighter_the_stages_the_closer_a_run_is_to_the_lumped_gear(fixed: str) -> None:
    """In proportion to compliance and mass, so that twice as stiff and light it is half as far."""
    gear, duration = GEAR.replace(kinematics=FIXED[fixed]), 0.004
    push = Waves([(6.0, 100.0, 0.0)])

    def torque(one: sw.Gear) -> np.ndarray:
        drive = free(one, 5e-5, sw.loads.Inertia(inertia=0.02))
        run = sw.simulate_adaptively(drive, NOTHING.scenario(duration), 1e-9, load_torque=push.scenario(duration), sample=1e-4)
        return run["torque"]

    exact = torque(lumped(gear))
    near, nearer = (torque(stiffened(gear, times, 1e-3 / times)) - exact for times in (100.0, 200.0))
    assert np.abs(near).max() < 0.05 * np.abs(exact).max()
    assert np.abs(2.0 * nearer - near).max() < 0.1 * np.abs(near).max()
