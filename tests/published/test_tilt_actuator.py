"""The actuator of document A: its ramp, its balance of torques worked out by hand, its friction, its noise, its loops."""

from __future__ import annotations

import math
from functools import cache
from pathlib import Path

import numpy as np
import pytest
import strainwave as sw

from tests.python.command import strainwave

SCENARIO = Path(__file__).resolve().parents[2] / "examples" / "scenarios" / "tilt-ramp.toml"
RATIO = 101.0
RATE = math.radians(18.0)  # of the ramp [rad/s]
ACROSS = 0.5 * 1.225 * 40.0**2 * 0.16 * 0.4 * 0.32  # N.m, of the stream on the nacelle at 90 deg: rho V^2 / 2 S c C_1
DRAG = 0.5 * 1.225 * 0.16 * 1.2 * 0.3**3 * RATE**2  # N.m, of turning
SLIDING = 3.7 + 3.56 * RATE  # N.m, friction at the output: the excess of the breakaway has faded by exp(-(0.314 / 0.02)^2)
TORQUE_CONSTANT = 0.0919  # N.m/A
BREAKAWAY = 4.66  # N.m
LUMPED, STAGED = "tilt-actuator-lumped", "tilt-actuator"
STEP = {LUMPED: 2e-4, STAGED: 2e-4}  # s
every_gear = pytest.mark.parametrize("name", STEP)


def without_noise(drive: sw.Drive) -> sw.Drive:
    seen = drive.sensors
    return drive.replace(
        sensors=seen.replace(current=seen.current.law, input_speed=seen.input_speed.law, output_angle=seen.output_angle.law)
    )


def aligned(drive: sw.Drive) -> sw.Drive:
    return drive.replace(gear=drive.gear.replace(kinematic_error=sw.kinematic_error.Fourier()))


@cache
def ramp_of(name: str, *, noise: bool = False, misaligned: bool = True) -> sw.Recording:
    drive = sw.load(name)
    drive = drive if noise else without_noise(drive)
    drive = drive if misaligned else aligned(drive)
    return sw.simulate(drive, sw.scenario.ramp(RATE, 5.0), STEP[name], sample=1e-3)


# The ramp


@pytest.mark.parametrize(("name", "noise"), [(LUMPED, True), (LUMPED, False), (STAGED, False)])
def test_it_tilts_by_ninety_degrees_in_five_seconds(name: str, noise: bool) -> None:
    """Within 0.03 deg at the end, and 0.25 deg on the way, where it starts against its friction."""
    run = ramp_of(name, noise=noise)
    assert run["output_angle"][-1] == pytest.approx(math.radians(90.0), abs=math.radians(0.03))
    assert np.abs(run["output_angle"] - run["command"]).max() < math.radians(0.25)
    assert np.abs(run["voltage"]).max() < 28.0
    assert np.abs(run["current"]).max() < 10.0


@every_gear
def test_it_leads_the_ramp_by_the_lag_of_its_sensor(name: str) -> None:
    """In still air: the loop holds the reading on the command, and the reading is 2 zeta / omega_0 late."""
    drive = aligned(without_noise(sw.load(name))).replace({"load.airspeed": 0.0})
    run = sw.simulate(drive, sw.scenario.ramp(RATE, 3.0), STEP[name], sample=1e-3)
    assert (run["output_angle"] - run["command"])[-1] == pytest.approx(2.0 * 0.7 / 1200.0 * RATE, rel=1e-6)


@every_gear
def test_its_current_carries_load_and_friction(name: str) -> None:
    """Without misalignment at every instant, by hand: 24.89 N.m over 101 and 0.0919 N.m/A are 2.68 A across the stream."""
    run = ramp_of(name, misaligned=False)
    later = run.time > 1.0
    expected = (ACROSS * np.sin(run["output_angle"]) + DRAG + SLIDING) / (RATIO * TORQUE_CONSTANT)
    assert run["current"][later] == pytest.approx(expected[later], rel=1e-3)
    assert run["current"][-1] == pytest.approx(2.68, abs=5e-3)


def test_misalignment_and_noise_do_not_change_the_mean_current() -> None:
    """Over whole turns of the wave generator: they ask for no work, but for what the ripple loses."""
    turn = 2.0 * math.pi / (RATIO * RATE)
    noisy, straight = ramp_of(LUMPED, noise=True), ramp_of(LUMPED, misaligned=False)
    means = [run.between(5.0 - 5.0 * turn, 5.0)["current"].mean() for run in (noisy, straight)]
    assert means[0] == pytest.approx(means[1], rel=2e-3)


@every_gear
def test_misalignment_shows_in_the_current_and_passes_to_the_position(name: str) -> None:
    """Twice per turn of the wave generator, 10.1 Hz, which the loop of the speed follows and that of the position does not.

    The load T asks for T e' more torque at the input, 2 T A at the second order. So the current shows about that, and the
    output the error itself: small against the stroke, but not because of the loop.
    """
    straight, skew = (ramp_of(name, misaligned=misaligned) for misaligned in (False, True))
    turn = 2.0 * math.pi / (RATIO * RATE)
    late = skew.between(5.0 - 5.0 * turn, 5.0)
    error, current, angle = (
        sw.orders.order_amplitudes(late, each, [2.0]).amplitude[0] for each in ("kinematic_error", "current", "output_angle")
    )
    asked = 2.0 * (ACROSS + SLIDING) * error / TORQUE_CONSTANT
    assert 0.5 * asked < current < 2.0 * asked
    assert angle == pytest.approx(error, rel=0.05)
    assert angle < 1e-4 * math.radians(90.0)
    assert sw.orders.order_amplitudes(straight.between(5.0 - 5.0 * turn, 5.0), "current", [2.0]).amplitude[0] < 1e-2 * current
    assert 1.0 < math.degrees(np.ptp(late["kinematic_error"])) * 60.0 < 1.2  # arcmin


# Friction


@every_gear
@pytest.mark.parametrize(("push", "moves"), [(0.99 * BREAKAWAY, False), (-0.99 * BREAKAWAY, False), (1.01 * BREAKAWAY, True)])
def test_without_current_the_friction_holds_the_nacelle_up_to_its_breakaway(name: str, push: float, moves: bool) -> None:
    drive = sw.load(name).replace(control=sw.control.OpenLoop())
    run = sw.simulate(drive, sw.scenario.constant(0.0, 0.1), STEP[name], load_torque=push, sample=1e-3)
    assert (np.ptp(run["output_angle"]) > 0.0) == moves
    if not moves:
        stream = ACROSS * math.sin(run["output_angle"][-1])  # the nacelle begins where the error of the gear has it
        assert run["friction_output"][-1] == pytest.approx(run["torque"][-1] - push - stream, abs=1e-9)
        assert abs(run["torque"][-1]) < 1e-3 * BREAKAWAY


def test_it_comes_to_rest_at_the_end_of_the_stroke() -> None:
    """It sticks there: friction takes what load and gear leave, and the noise of the sensors does not move it."""
    stop = sw.scenario.table(time=[0.0, 1.0, 4.0], value=[0.0, RATE, RATE])
    run = sw.simulate(sw.load(LUMPED), stop, STEP[LUMPED], sample=1e-3)
    rest = run.between(3.0, 4.0)
    assert not rest["output_speed"].any()
    assert np.abs(rest["output_angle"] - RATE).max() < math.radians(0.03)
    assert rest["friction_output"] == pytest.approx(rest["torque"] - rest["load_torque"], abs=1e-9)
    assert np.abs(rest["friction_output"]).max() < BREAKAWAY


# Noise


@every_gear
def test_its_noise_follows_from_its_seeds(name: str) -> None:
    drive, command = sw.load(name), sw.scenario.ramp(RATE, 0.05)
    runs = [sw.simulate(drive, command, STEP[name], sample=1e-3)["current"] for _ in range(2)]
    np.testing.assert_array_equal(*runs)
    many = sw.simulate_many(
        drive, command, {"sensors.output_angle.seed": [3.0, 4.0]}, record=["current"], dt=STEP[name], sample=1e-3
    )
    np.testing.assert_array_equal(many["current"][0], runs[0])
    assert np.abs(many["current"][1] - runs[0]).max() > 1e-3
    seeds = [getattr(drive.sensors, place).seed for place in ("current", "input_speed", "output_angle")]
    assert len(set(seeds)) == 3


# Files and the command


@every_gear
def test_the_command_runs_it_through_the_scenario_of_the_examples(name: str, tmp_path: Path) -> None:
    """For as long as a test may take."""
    scenario = SCENARIO.read_text(encoding="utf-8")
    assert "duration = 5.0\n" in scenario
    (tmp_path / "ramp.toml").write_text(scenario.replace("duration = 5.0\n", "duration = 0.1\n"))
    words = ["simulate", name, "--scenario", "ramp.toml", "-o", "run.parquet", "--dt", STEP[name]]
    result = strainwave(*words, folder=tmp_path)
    assert (result.returncode, result.stderr) == (0, "")
    written = sw.Recording.read(tmp_path / "run.parquet")
    expected = sw.simulate(sw.load(name), sw.scenario.ramp(RATE, 0.1), STEP[name], sample=1e-3)
    assert written.names == expected.names
    for column in expected.names:
        np.testing.assert_allclose(written[column], expected[column], rtol=1e-9, atol=1e-12)


# Loops


def transfer(drive: sw.Drive, s: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Open loops of speed and position, each with what lies inside it closed, of motor, one spring, load and sensors.

    Gains and sensors are those of the set; friction is its viscous part, the nacelle lies along the stream.
    """
    gear, motor, law, seen = drive.gear, drive.motor, drive.control, drive.sensors
    shown_speed = 1.0 / (1.0 + seen.input_speed.law.time_constant * s)
    omega, zeta = seen.output_angle.law.natural_frequency, seen.output_angle.law.damping_ratio
    shown_angle = omega**2 / (s**2 + 2.0 * zeta * omega * s + omega**2)
    spring = gear.stiffness.k + gear.damping * s
    output = drive.load.inertia * s**2 + gear.friction_output.viscous * s + ACROSS
    rotor = (motor.inertia + gear.input_inertia) * s**2 + spring * output / (spring + output) / RATIO**2
    speed = s / rotor * motor.torque_constant  # input speed per current
    current = law.current_proportional + law.current_integral / s
    induced = (motor.torque_constant - law.back_emf_feedforward * shown_speed) * speed
    followed = current / (motor.inductance * s + motor.resistance + current + induced)
    speed_loop = (law.speed_proportional + law.speed_integral / s) * followed * speed * shown_speed
    closed = speed_loop / shown_speed / (1.0 + speed_loop)
    return speed_loop, law.position_gain * RATIO * closed / s * spring / (spring + output) / RATIO * shown_angle


def margins(loop: np.ndarray, frequency: np.ndarray) -> tuple[float, float, float]:
    """Last crossover [Hz], least phase margin [deg], least factor of gain that is left."""
    size = np.abs(loop)
    crossings = np.flatnonzero((size[:-1] > 1.0) & (size[1:] <= 1.0))
    turned = np.flatnonzero((loop.imag[:-1] * loop.imag[1:] < 0.0) & (loop.real[:-1] < 0.0) & (size[:-1] < 1.0))
    phase = 180.0 - np.abs(np.degrees(np.angle(loop[crossings])))
    return float(frequency[crossings[-1]]), float(phase.min()), float((1.0 / size[turned]).min())


def test_the_loops_have_the_margins_that_the_page_names() -> None:
    """Position: 2.7 Hz, 80 deg, a factor of 7; speed: 64 Hz where the motor turns alone, 62 deg, a factor of 14."""
    drive = sw.load(LUMPED)
    frequency = np.geomspace(0.1, 2000.0, 200_001)
    speed, position = (margins(loop, frequency) for loop in transfer(drive, 2j * math.pi * frequency))
    assert speed == pytest.approx((64.5, 62.8, 14.6), rel=0.02)
    assert position == pytest.approx((2.7, 80.0, 7.4), rel=0.02)


def test_the_poles_are_those_of_the_loops() -> None:
    """Each pole of the drive, linearised without dry friction, closes the loop worked out by hand; all are well damped."""
    drive = without_noise(aligned(sw.load(LUMPED)))
    free = sw.friction.Viscous(viscous=drive.gear.friction_output.viscous)
    linear = sw.linearise(drive.replace(gear=drive.gear.replace(friction_output=free)))
    hand = drive.replace(sensors=sw.load(LUMPED).sensors)
    _, position = transfer(hand, linear.poles)
    assert position == pytest.approx(np.full(len(linear.poles), -1.0), rel=1e-6)
    assert linear.damping_ratios.min() > 0.7
    assert linear.poles.real.max() < -5.0


def test_it_rests_on_the_stream_where_nothing_pulls() -> None:
    """Commanded to 0 its gear is out by its error: the wave generator turns by i e, and no current flows but for rounding."""
    drive = without_noise(sw.load(LUMPED))
    free = sw.friction.Viscous(viscous=drive.gear.friction_output.viscous)
    found = sw.analysis.equilibrium(drive.replace({"gear.friction_output": free}), command=0.0)
    error = drive.gear.kinematic_error.error(found.input_angle)
    assert found.transmission_error == pytest.approx(error, rel=1e-12)
    assert found.input_angle == pytest.approx(RATIO * error, rel=1e-12)
    assert abs(found["motor.current"]) < 1e-12


def test_gains_follow_from_motor_gear_and_load() -> None:
    """As their sources say."""
    drive = sw.load(LUMPED)
    law, motor, gear = drive.control, drive.motor, drive.gear
    best = math.sqrt(gear.stiffness.k * drive.load.inertia) / RATIO**2 / motor.torque_constant
    assert law.speed_proportional == pytest.approx(best, rel=2e-3)
    assert law.speed_integral / law.speed_proportional == pytest.approx(10.0, rel=1e-9)
    rotor = motor.inertia + gear.input_inertia
    bandwidth = law.speed_proportional * motor.torque_constant / (rotor + drive.load.inertia / RATIO**2)
    assert bandwidth / law.position_gain == pytest.approx(6.0, rel=0.02)
    assert law.current_proportional == pytest.approx(2000.0 * motor.inductance, rel=1e-9)
    assert law.current_integral == pytest.approx(2000.0 * motor.resistance, rel=1e-9)
    assert law.back_emf_feedforward == motor.torque_constant
    assert motor.current_limit * motor.torque_constant * RATIO < 107.0  # N.m, repeated peak torque of the gear


# Stages


def test_the_stages_carry_what_the_balance_of_torques_says() -> None:
    """Document A, eq. (1), corrected: F_m = T / (r_g cos alpha_t), F_b = F_m sin alpha_t, T_WG = T / 101; T less friction."""
    end = ramp_of(STAGED, misaligned=False)
    torque = ACROSS * math.sin(end["output_angle"][-1]) + DRAG + SLIDING
    pressure, radius = math.radians(30.0), 0.025
    expected = {
        "torque": torque,
        "circular_spline_torque": torque,
        "output_torque": torque - SLIDING,
        "mesh_force": torque / (radius * math.cos(pressure)),
        "bearing_force": torque / radius * math.tan(pressure),
        "wave_generator_torque": torque / RATIO,
        "flexspline_displacement": torque / 2e4 * radius,
        "circular_spline_displacement": radius * (end["output_angle"][-1] + torque / 2e5),
    }
    assert {name: end[name][-1] for name in expected} == pytest.approx(expected, rel=2e-4)


@pytest.mark.slow("physics")
def test_stages_and_lump_are_one_drive_below_the_modes_of_the_stages() -> None:
    """The lump lacks the inertia of the circular spline, 0.05 %, and vibrations above 3 kHz."""
    staged, ramp = ramp_of(STAGED), sw.scenario.ramp(RATE, 5.0)
    lumped = sw.simulate(without_noise(sw.load(LUMPED)), ramp, 1.5e-5, sample=1e-3)  # whose steps pass over jumps of the slope
    for name, unlike in (("output_angle", 5e-6), ("torque", 0.02), ("current", 1e-3)):
        assert np.abs(staged[name] - lumped[name]).max() < unlike, name


def stages() -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """By hand, at the output: inertias, stiffnesses and dampings of rotor, wave generator, rings and nacelle, and how they hang
    together: radial displacements times tan(alpha_t) / r_g, forces of the mesh times r_g cos(alpha_t)."""
    radial, mesh = (0.025 / math.tan(math.radians(30.0))) ** 2, (0.025 * math.cos(math.radians(30.0))) ** 2
    inertia = np.array([1.7e-5 * RATIO**2, 8e-6 * RATIO**2, 0.032 * radial, 2e-5, 3e-4, 0.6])
    stiffness = np.array([2e3 * RATIO**2, 5e7 * radial, 1e8 * mesh, 2e4, 2e5])
    damping = np.array([4.17e-3 * RATIO**2, 53.0 * radial, 60.0 * mesh, 0.02, 0.306])
    joined = np.array(
        [[1, -1, 0, 0, 0, 0], [0, 1, -1, 0, 0, 0], [0, 0, 1, -1, -1, 0], [0, 0, 0, 1, 0, 0], [0, 0, 0, 0, 1, -1]], dtype=float
    )
    return inertia, stiffness, damping, joined


def test_each_mode_of_the_stages_is_damped_by_two_percent() -> None:
    """At 19, 26, 38 and 66 thousand rad/s; that of the nacelle on the gear, 253 rad/s, by friction and motor alone."""
    inertia, stiffness, damping, joined = stages()
    spring, damper = (joined.T @ np.diag(each) @ joined for each in (stiffness, damping))
    system = np.block([[np.zeros((6, 6)), np.eye(6)], [-spring / inertia[:, None], -damper / inertia[:, None]]])
    poles = np.array(sorted((pole for pole in np.linalg.eigvals(system) if pole.imag > 1.0), key=abs))
    assert np.abs(poles) == pytest.approx([253.4, 19170.0, 26150.0, 37510.0, 66490.0], rel=1e-3)
    ratios = -poles.real / np.abs(poles)
    assert ratios[1:] == pytest.approx(0.02, rel=0.2)
    drive = aligned(without_noise(sw.load(STAGED))).replace({"load.airspeed": 0.0})
    assert sw.analysis.modes(drive)["free"] == pytest.approx(np.abs(poles), rel=1e-3)


def test_the_lump_is_as_stiff_and_as_damped_as_the_stages_in_series() -> None:
    _, stiffness, damping, _ = stages()
    series = 1.0 / np.sum(1.0 / stiffness)
    lump = sw.load(LUMPED).gear
    assert lump.stiffness.k == pytest.approx(series, rel=2e-4)
    assert lump.damping == pytest.approx(series**2 * np.sum(damping / stiffness**2), rel=2e-3)


def test_it_rests_and_runs_with_its_stages_as_the_balance_says() -> None:
    """At 1 rad the stream alone: wave generator, rings and flank give way to T as their springs say. In open loop it runs."""
    drive = without_noise(sw.load(STAGED))
    free = sw.friction.Viscous(viscous=drive.gear.friction_output.viscous)
    found = sw.analysis.equilibrium(drive.replace({"gear.friction_output": free}), command=1.0)
    torque = ACROSS * math.sin(1.0)
    assert found["structure.held_angle"] == pytest.approx(torque / 2e4, rel=1e-9)
    assert found["structure.driving_lead"] == pytest.approx(torque / 2e5, rel=1e-9)
    turning = found["motor.current"] * TORQUE_CONSTANT
    assert found["structure.windup"] == pytest.approx(turning / 2e3, rel=1e-9)
    assert turning == pytest.approx(torque / RATIO, rel=0.1)  # and what the error of the gear asks for
    motor = drive.replace({"control": sw.control.OpenLoop(), "sensors": sw.Sensors(), "load": sw.loads.Inertia(inertia=0.6)})
    running = sw.analysis.equilibrium(motor, command=10.0, load_torque=5.0)
    current, speed = running["motor.current"], running.input_speed
    assert 0.284 * current + TORQUE_CONSTANT * speed == pytest.approx(10.0, rel=1e-12)
    assert current * TORQUE_CONSTANT * RATIO == pytest.approx(5.0 + 3.7 + 3.56 * speed / RATIO, rel=1e-9)
    assert running["structure.generator_speed"] == pytest.approx(speed, rel=1e-12)


def test_the_loops_leave_the_stages_alone_and_damp_the_rest() -> None:
    """Linearised across the stream's pull: the modes of the stages keep their 2 %, all others have more than 60 %."""
    drive = without_noise(sw.load(STAGED))
    free = sw.friction.Viscous(viscous=drive.gear.friction_output.viscous)
    linear = sw.linearise(drive.replace({"gear.friction_output": free}), command=1.0)
    of_stages = np.abs(linear.poles) > 1e4
    assert of_stages.sum() == 8
    assert linear.damping_ratios[of_stages] == pytest.approx(0.02, rel=0.2)
    assert linear.damping_ratios[~of_stages].min() > 0.6


def test_both_sets_differ_in_their_gear_alone() -> None:
    lumped, staged = sw.GearSet.read(LUMPED), sw.GearSet.read(STAGED)
    parts = ("structure", "stiffness", "damping")
    assert staged.drive.replace({f"gear.{part}": getattr(lumped.gear, part) for part in parts}) == lumped.drive
    assert staged.ratings == lumped.ratings
    structure, law = staged.gear.structure, staged.gear.kinematic_error
    assert (structure.pitch_radius, structure.pressure_angle) == (law.pitch_radius, law.pressure_angle)
    assert structure.radial_mass == pytest.approx(structure.flexspline_inertia / structure.pitch_radius**2, rel=1e-12)
