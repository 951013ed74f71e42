"""Modes of the flexspline's ring against tests/support/ring_equations.py, closed forms, the rigid ring, and energy."""

from __future__ import annotations

from math import cos, pi
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import strainwave as sw
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from strainwave import _core
from strainwave.simulation.state import StateLayout, beginning_numbers

from tests.structure.staged_gear import DRIVE, GEAR, PUSHED, SHAKEN, STRUCTURE, everywhere, orientation, shaken
from tests.structure.written_down import FIXED, Waves, document, free
from tests.support.actuator_equations import masses
from tests.support.ring_equations import Ring, forces, rates, stiffness_matrix
from tests.support.side_by_side import side_by_side

Array = NDArray[np.float64]

RING = sw.ring.Modes(
    natural_frequency=[3000.0, 5000.0, 1500.0], waves=[2, 4, 0], damping=[0.03, 0.02, 0.05], mass=[0.3, 0.2, 1.5]
)
UNDAMPED = RING.replace(damping=[0.0, 0.0, 0.0])
MESH_LEVER = STRUCTURE.pitch_radius * cos(STRUCTURE.pressure_angle)  # m


def with_ring(drive: sw.Drive, ring: Any = RING) -> sw.Drive:
    return drive.replace({"gear.structure": drive.gear.structure.replace(ring=ring)})


def written(ring: Any) -> Ring:
    columns = (ring.natural_frequency, ring.waves, ring.damping, ring.mass)
    return Ring(*(np.array(column) for column in columns))


def by_scipy(drive: sw.Drive, times: Array, speed: float) -> dict[str, Array]:
    """Columns of a recording of a shaken drive by the equations in the frame of the flexspline."""
    gear, ring = document(drive.gear), written(drive.gear.structure.ring)
    count = 6 + 2 * len(ring.n)
    equations = rates(gear, ring, drive.motor.inertia, drive.load.inertia, SHAKEN, lambda *at: -PUSHED(*at))
    start = np.zeros(2 * count)
    e, slope = gear.e_WG(0.0)
    tangent = np.tan(gear.alpha_t)
    at_rest = gear.fixed == "flexspline"
    for place, radial in (0, e), (count, (gear.r_g / (gear.tau * tangent) + slope) * speed):
        start[place + 2] = radial
        start[place + (4 if at_rest else 3)] = radial * tangent
        start[place + 5] = (1.0 if at_rest else -1.0) * radial * tangent / gear.r_g
    start[count] = start[count + 1] = speed
    run = solve_ivp(equations, (0.0, times[-1]), start, "DOP853", times, rtol=1e-12, atol=1e-14)
    sense = 1.0 if at_rest else -1.0
    return {
        "input_angle": run.y[0],
        "output_angle": run.y[5],
        "input_speed": run.y[count],
        "radial_displacement": sense * run.y[2],
        "ring_displacement": sense * np.array([ring.displacement(gear, y[:count]) for y in run.y.T]),
        "mesh_force": sense * np.array([forces(gear, ring, y[:count], y[count:])[1] for y in run.y.T]),
    }


@pytest.mark.slow("physics")
@orientation
@pytest.mark.parametrize("speed", [0.0, 900.0])
def test_a_run_is_what_the_equations_in_the_frame_of_the_flexspline_give(fixed: str, speed: float) -> None:
    """To 1e-7 of the largest, with a kinematic error, dampers and varying springs; 900 rad/s is above two critical speeds."""
    drive = with_ring(DRIVE.replace(gear=everywhere(GEAR.replace(kinematics=FIXED[fixed]))))
    run = shaken(drive, 0.004, initial={"input_speed": speed} if speed else None)
    for name, values in by_scipy(drive, run.time, speed).items():
        assert np.abs(run[name] - values).max() <= 1e-7 * np.abs(values).max(), name


@pytest.mark.slow("physics")
@orientation
def test_fixed_steps_approach_that_run_in_fourth_order(fixed: str) -> None:
    drive = with_ring(DRIVE.replace(gear=GEAR.replace(kinematics=FIXED[fixed])))
    initial = {"input_speed": 300.0}
    exact = shaken(drive, 0.004, initial=initial)["ring_displacement"]
    off = [
        np.abs(
            sw.simulate(drive, SHAKEN.scenario(0.004), dt, load_torque=PUSHED.scenario(0.004), sample=1e-4, initial=initial)[
                "ring_displacement"
            ]
            - exact
        ).max()
        for dt in (1e-4, 5e-5, 2.5e-5)
    ]
    assert np.log2(np.array(off[:-1]) / np.array(off[1:])) == pytest.approx([4.0, 4.0], abs=0.5)


# Closed forms


def response(ring: Any, frequency: float) -> complex:
    """u over a force of this angular frequency at a place that does not turn, of the first mode [m/N]."""
    omega, zeta, mass = ring.natural_frequency[0], ring.damping[0], ring.mass[0]
    return 1.0 / (mass * (omega**2 - frequency**2 + 2j * zeta * omega * frequency))


@orientation
@pytest.mark.parametrize("speed", [0.0, 700.0, 1480.0, 1600.0, -1480.0])
def test_a_constant_force_deflects_the_mesh_by_the_distance_to_the_critical_speed(fixed: str, speed: float) -> None:
    """u = F / (m (omega^2 - n^2 W^2)) of an undamped mode, W = W_in (1 - 1/i) if the flexspline turns."""
    ring = sw.ring.Modes(natural_frequency=[3000.0], waves=[2], damping=[0.0], mass=[0.05])
    gear = GEAR.replace(kinematics=FIXED[fixed], kinematic_error=sw.kinematic_error.Fourier())
    drive = with_ring(DRIVE.replace(gear=gear), ring)
    initial = {"input_speed": speed, "torque": 5.0}
    run = sw.simulate(drive, sw.scenario.constant(0.0, 1e-6), 1e-6, initial=initial)
    passing = speed if fixed == "flexspline" else speed * (1.0 - 1.0 / gear.kinematics.ratio)
    known = 5.0 / MESH_LEVER / (0.05 * (3000.0**2 - 4.0 * passing**2))
    assert run["ring_displacement"][0] == pytest.approx(known, rel=1e-9)
    start = beginning_numbers(drive, initial, np.array([0.0, 0.0, 5.0, 0.0, 293.15, 0.0]))
    found = dict(zip(StateLayout(drive).names, _core.differentiate_rates(drive, start, np.zeros(6))[0], strict=False))
    largest = 5.0 / MESH_LEVER / 0.05  # m/s2
    assert abs(found["structure.ring.speed[0]"]) < 1e-9 * largest
    assert abs(found["structure.ring.cross_speed[0]"]) < 1e-9 * largest


SPINNING = sw.Drive(
    gear=GEAR.replace(
        kinematics=sw.kinematics.PlainRatio(reduction=101.0),
        input_inertia=1e3,  # the wave generator turns evenly
        kinematic_error=sw.kinematic_error.Fourier(order=[6.0], amplitude=[1e-4], phase=[0.0]),
        structure=STRUCTURE.replace(
            coupling_stiffness=1e6, coupling_damping=1e3, circular_spline_damping=3.0, bearing_damping=300.0, mesh_damping=0.0
        ),
        damping=2.0,
    ),
    motor=sw.motor.AccelerationSource(inertia=1.0),
    control=sw.control.OpenLoop(),
    load=sw.loads.Prescribed(),
)
ORDER = 6.0


@pytest.mark.parametrize("speed", [100.0, 375.0, 500.0, 750.0, 1100.0])
def test_a_force_of_one_order_moves_the_mesh_as_the_two_waves_of_the_pair_do(speed: float) -> None:
    """u / F = (H((q + n) W) + H((q - n) W)) / 2 for q = 6 and n = 2: largest at omega / 8 = 375 and omega / 4 = 750 rad/s."""
    ring = sw.ring.Modes(natural_frequency=[3000.0], waves=[2], damping=[0.05], mass=[2.0])
    drive = with_ring(SPINNING, ring)
    turns = 2.0 * pi / speed
    duration = np.ceil(0.15 / turns) * turns
    course = sw.scenario.ramp(speed / 101.0, duration)
    run = sw.simulate(
        drive, sw.scenario.constant(0.0, duration), 1e-5, inputs={"output_angle": course}, initial={"input_speed": speed}
    )
    last = run.time > duration - turns * 4
    wave = np.exp(-1j * ORDER * run["input_angle"][last])
    basis = np.stack([np.ones(wave.size), wave.real, -wave.imag], axis=1)
    u, force = (np.linalg.lstsq(basis, run[name][last], rcond=None)[0] for name in ("ring_displacement", "mesh_force"))
    known = 0.5 * (response(ring, (ORDER + 2.0) * speed) + response(ring, (ORDER - 2.0) * speed))
    found = (u[1] - 1j * u[2]) / (force[1] - 1j * force[2])
    assert abs(found - known) < 1e-3 * abs(known)


def test_the_modes_are_those_of_masses_and_springs() -> None:
    """Six bodies and a ring at rest, whose waves across the lobes vibrate alone."""
    drive = with_ring(DRIVE)
    gear, ring = document(drive.gear), written(RING)
    m = 1.0 / np.sqrt(np.concatenate([masses(gear, drive.motor.inertia, drive.load.inertia), np.tile(ring.m, 2)]))
    known = np.sqrt(np.abs(np.linalg.eigvalsh(m[:, None] * stiffness_matrix(gear, ring) * m)))
    assert sw.analysis.modes(drive)["free"] == pytest.approx(known[1:], rel=1e-6)
    assert _core.natural_frequency(drive, 0.0) == pytest.approx(known[-1], rel=1e-3)


# Energy


@pytest.mark.slow("physics")
@orientation
@pytest.mark.parametrize("ring", [RING, UNDAMPED], ids=["damped", "undamped"])
def test_what_the_motor_supplies_is_stored_lost_or_at_the_load(fixed: str, ring: Any) -> None:
    """To 1e-9 of the largest energy in play, through the critical speeds; the ring's dampers only ever take."""
    random = np.random.default_rng(4)
    gear = everywhere(GEAR.replace(kinematics=FIXED[fixed]))
    drive = with_ring(free(gear, 5e-5, sw.loads.Inertia(inertia=0.02), meter=sw.meter.EnergyMeter()), ring)
    motor, load = (
        Waves([(size * random.normal(), 10.0 ** random.uniform(1.0, 3.0), random.uniform(0.0, 6.0)) for _ in range(4)])
        for size in (0.3, 8.0)
    )
    run = sw.simulate_adaptively(
        drive, motor.scenario(0.02), 1e-9, load_torque=load.scenario(0.02), sample=5e-4, initial={"input_speed": 1200.0}
    )
    stored = sum(run[name] for name in run.names if name.startswith("stored_"))
    taken = sum(run[name] for name in run.names if name.startswith("energy_") and name != "energy_supplied")
    turned_over = max(np.abs(run[name]).max() for name in run.names if name.startswith(("stored_", "energy_")))
    assert np.abs(run["energy_supplied"] - taken - (stored - stored[0])).max() < 1e-9 * turned_over
    assert np.all(run["power_damping"] >= 0.0)


# The rigid ring as a limit


@pytest.mark.slow("physics")
@orientation
def test_the_stiffer_the_ring_the_closer_a_run_is_to_the_rigid_one(fixed: str) -> None:
    """In proportion to its compliance: twice as stiff it is half as far."""
    rigid = DRIVE.replace(gear=everywhere(GEAR.replace(kinematics=FIXED[fixed])))
    known = shaken(rigid, 0.004)["torque"]
    off = []
    for stiffer in 1e3, 2e3:
        ring = sw.ring.Modes(natural_frequency=[3e4], waves=[2], damping=[1.0], mass=[5.0 * stiffer])
        off.append(np.abs(shaken(with_ring(rigid, ring), 0.004)["torque"] - known).max())
    assert off[0] < 1e-5 * np.abs(known).max()
    assert off[1] == pytest.approx(0.5 * off[0], rel=0.02)


def test_a_ring_without_modes_changes_no_bit() -> None:
    none = with_ring(DRIVE, sw.ring.Modes(natural_frequency=[], waves=[], damping=[], mass=[]))
    command, load = SHAKEN.scenario(0.005), PUSHED.scenario(0.005)
    one, other = (sw.simulate(drive, command, 1e-5, load_torque=load, sample=1e-4) for drive in (DRIVE, none))
    for name in one.names:
        np.testing.assert_array_equal(one[name], other[name])


# What any part takes part in


def test_side_by_side_it_is_what_it_is_alone() -> None:
    drives = [with_ring(DRIVE, RING.replace(mass=[mass, 0.2, 1.5])) for mass in (0.3, 0.25, 0.4)]
    course: dict[str, Any] = {"load_torque": PUSHED.scenario(0.003), "sample": 1e-4, "initial": {"input_speed": 300.0}}
    together = side_by_side(drives, SHAKEN.scenario(0.003), 1e-5, **course)
    for number, drive in enumerate(drives):
        alone = sw.simulate(drive, SHAKEN.scenario(0.003), 1e-5, **course)
        for name in "torque", "ring_displacement", "wave_generator_torque":
            np.testing.assert_array_equal(together[name][number], alone[name])


@pytest.mark.parametrize("name", ["natural_frequency", "damping", "mass"])
def test_derivatives_by_its_numbers_are_what_differences_show(name: str) -> None:
    drive = with_ring(DRIVE)
    path = f"gear.structure.ring.{name}[0]"
    course: dict[str, Any] = {"load_torque": PUSHED.scenario(0.003), "sample": 3e-4, "initial": {"input_speed": 300.0}}
    found = sw.analysis.derivatives(drive, SHAKEN.scenario(0.003), [path], 1e-5, **course)
    values = getattr(RING, name)
    step = 1e-5 * values[0]
    more, less = (
        sw.simulate(
            with_ring(DRIVE, RING.replace(**{name: (values[0] + by, *values[1:])})), SHAKEN.scenario(0.003), 1e-5, **course
        )
        for by in (step, -step)
    )
    for output in "torque", "ring_displacement":
        difference = (more[output] - less[output]) / (2.0 * step)
        np.testing.assert_allclose(found[output, path], difference, rtol=0.0, atol=1e-5 * np.abs(difference).max())


def test_a_file_brings_it_back_with_all_its_numbers(tmp_path: Path) -> None:
    drive = with_ring(DRIVE)
    sw.save(drive, tmp_path / "ring.toml", name="ring", source="made up")
    assert sw.load(tmp_path / "ring.toml") == drive


def test_numbers_that_contradict_each_other_are_refused() -> None:
    with pytest.raises(ValueError, match="natural_frequency, waves, damping and mass must have equally many elements"):
        RING.replace(waves=[2])
    with pytest.raises(TypeError, match=r"modes\.waves must be a whole number, not 2\.5"):
        RING.replace(waves=[2.5, 4, 0])
