"""Where a drive rests or runs, against closed forms and against what a simulation makes of it."""

from __future__ import annotations

from contextlib import suppress
from math import cos, pi, sin

import numpy as np
import pytest
import strainwave as sw
from hypothesis import given, reject, settings
from numpy.typing import NDArray
from scipy.optimize import fsolve
from strainwave import _core
from strainwave.simulation.state import StateLayout

from tests.structure.written_down import FIXED, document, start
from tests.support.actuator_equations import OUT, WG, X2, Y1, Y2, corrected
from tests.support.geared import MOTOR, RATIO, K, geared, outputs
from tests.support.reference_drive import DRIVE
from tests.support.samples import sample
from tests.support.strategies import made, smooth_drives

Array = NDArray[np.float64]
BREAKAWAY = 4.66  # N.m, of document A's actuator at the output


def stays(drive: sw.Drive, state: _core.State, command: float, load_torque: float = 0.0) -> None:
    """A run from `state` does not move, but for rounding."""
    run = sw.simulate(drive, sw.scenario.constant(command, 0.2), load_torque=load_torque, initial=state)
    for name in ("input_angle", "output_angle", "twist", "current"):
        assert np.ptp(run[name]) <= 1e-9 * max(np.abs(run[name]).max(), 1e-3), name


# At rest


@pytest.mark.parametrize("command", [-0.7, 0.0, 0.4, pi / 2])
def test_a_pendulum_under_proportional_control_hangs_below_its_command(command: float) -> None:
    """k_p (i r - theta_in) K_m / R = T / i and T = m g l sin theta_out = k delta: two springs in series, and gravity."""
    drive = geared(control=sw.control.PID(proportional=2.0, derivative=0.05))
    found = outputs(drive, sw.analysis.equilibrium(drive, command=command), command)
    motor_torque = 2.0 * (RATIO * command - found["input_angle"]) / MOTOR.resistance * MOTOR.torque_constant
    gravity = 15.0 * sin(found["output_angle"])
    assert RATIO * motor_torque == pytest.approx(gravity, rel=1e-9, abs=1e-12)
    assert K * (found["input_angle"] / RATIO - found["output_angle"]) == pytest.approx(gravity, rel=1e-9, abs=1e-12)
    assert found["output_angle"] == pytest.approx(command, abs=0.1)


def test_an_integral_brings_the_input_to_its_command_and_bears_the_load() -> None:
    drive = geared(control=sw.control.PID(proportional=2.0, integral=5.0, derivative=0.05))
    state = sw.analysis.equilibrium(drive, command=0.4, load_torque=3.0)
    found = outputs(drive, state, 0.4, 3.0)
    assert found["input_angle"] == pytest.approx(RATIO * 0.4, rel=1e-12)
    load = 15.0 * sin(found["output_angle"]) + 3.0
    assert found["load_torque"] == pytest.approx(load, rel=1e-12)
    assert found["torque"] == pytest.approx(load, rel=1e-10)
    volts = load / RATIO / MOTOR.torque_constant * MOTOR.resistance
    assert 5.0 * state["control.error_integral"] == pytest.approx(volts, rel=1e-9)
    stays(drive, state, 0.4, 3.0)


LAGS = [
    sw.sensor.FirstOrder(time_constant=2e-3),
    sw.sensor.SecondOrder(natural_frequency=900.0),
    sw.sensor.Delayed(law=sw.sensor.SecondOrder(natural_frequency=900.0), delay=2e-3),
]


@pytest.mark.parametrize("feedback", ["input", "output"])
@pytest.mark.parametrize("sensor", LAGS)
def test_a_sensor_that_lags_has_settled(sensor: object, feedback: str) -> None:
    """So the drive rests where it would without it, and nothing moves from there."""
    drive = geared(control=sw.control.PID(proportional=2.0, derivative=0.02, feedback=feedback))
    lagging = drive.replace(
        sensors=sw.Sensors(input_angle=sensor, output_angle=sensor, input_speed=sensor, output_speed=sensor, torque=sensor)
    )
    found, ideal = sw.analysis.equilibrium(lagging, command=0.4), sw.analysis.equilibrium(drive, command=0.4)
    assert outputs(lagging, found, 0.4) == pytest.approx(outputs(drive, ideal, 0.4), rel=1e-9)
    stays(lagging, found, 0.4)


def test_a_sensor_that_shows_too_much_moves_the_rest() -> None:
    """Without load k_p (i r - g theta_in - o) = 0."""
    sensor = sw.sensor.Gain(gain=1.02, offset=0.1)
    drive = geared(sw.loads.Inertia(inertia=0.5), sw.control.PID(proportional=2.0)).replace(
        sensors=sw.Sensors(input_angle=sensor)
    )
    found = outputs(drive, sw.analysis.equilibrium(drive, command=0.4), 0.4)
    assert found["input_angle"] == pytest.approx((RATIO * 0.4 - 0.1) / 1.02, rel=1e-12)


def test_an_encoder_has_no_equilibrium() -> None:
    encoder = sw.sensor.Delayed(law=sw.sensor.Encoder(counts=4096), delay=2e-3)
    drive = geared(control=sw.control.PID(proportional=2.0)).replace(sensors=sw.Sensors(output_angle=encoder))
    with pytest.raises(ValueError, match=r"sensors that do not count; sensors\.output_angle does"):
        sw.analysis.equilibrium(drive, command=0.4)


def test_many_turns_are_counted_as_a_run_counts_them() -> None:
    drive = geared(sw.loads.Inertia(inertia=0.5), sw.control.PID(proportional=2.0, derivative=0.05))
    state = sw.analysis.equilibrium(drive, command=3.0)
    assert state.turns == round(60.0 / (2.0 * pi))
    assert state.input_angle + 2.0 * pi * state.turns == pytest.approx(60.0, rel=1e-14)


def test_a_side_that_friction_holds_stays_where_it_is() -> None:
    """The input stands, and the spring alone carries the pendulum."""
    drive = geared(friction_input=sw.friction.Coulomb(coulomb=0.9, breakaway=1.0))
    start = drive.rest()
    start = start.replace(input_angle=2.0, transmission_error=1e-4)
    state = sw.analysis.equilibrium(drive, initial=start)
    found = outputs(drive, state)
    assert state.input_slip_direction == 0.0
    assert found["input_angle"] == 2.0
    assert K * (2.0 / RATIO - found["output_angle"]) == pytest.approx(15.0 * sin(found["output_angle"]), rel=1e-12)
    stays(drive, state, 0.0)


@pytest.mark.parametrize("command", [0.5, -0.5])
def test_a_side_that_breaks_away_stops_where_kinetic_friction_balances(command: float) -> None:
    drive = geared(
        control=sw.control.PID(proportional=2.0, derivative=0.05),
        friction_input=sw.friction.Coulomb(coulomb=0.3, breakaway=0.4),
    )
    state = sw.analysis.equilibrium(drive, command=command)
    found = outputs(drive, state, command)
    driving = MOTOR.torque_constant * found["current"] - found["torque"] / RATIO
    assert driving == pytest.approx(0.3 * np.sign(command), rel=1e-9)
    assert state.input_slip_direction == 0.0
    assert found["friction_input"] == pytest.approx(driving, rel=1e-12)
    stays(drive, state, command)


def test_an_output_that_friction_holds_stays_while_the_input_winds_the_spring() -> None:
    drive = geared(friction_output=sw.friction.Coulomb(coulomb=50.0, breakaway=60.0))
    state = sw.analysis.equilibrium(drive, command=10.0)
    found = outputs(drive, state, 10.0)
    assert found["torque"] == pytest.approx(RATIO * 0.1 * 10.0 / 0.5, rel=1e-12)
    assert found["output_angle"] == pytest.approx(0.0, abs=1e-15)
    assert state.output_slip_direction == 0.0


def misaligned(structure: str, fixed: str) -> sw.Drive:
    """Document A's actuator with ideal sensors, in still air; its position loop closes on the output."""
    drive = sw.load("tilt-actuator" if structure == "staged" else "tilt-actuator-lumped")
    gear = drive.gear.replace(kinematics=FIXED[fixed])
    return drive.replace({"gear": gear, "sensors": sw.Drive().sensors, "load": sw.loads.Inertia(inertia=0.6)})


@pytest.mark.parametrize("command", [0.0, 1e-3, -1e-3])
@pytest.mark.parametrize("fixed", FIXED)
def test_an_output_held_off_its_command_is_pushed_there_by_the_integral(fixed: str, command: float) -> None:
    """Document A's equations: the output at its command, its friction against the way there, all within in balance."""
    drive = misaligned("staged", fixed)
    gear, way = document(drive.gear), np.sign(command + drive.gear.kinematic_error.error(0.0))

    def forces(places: Array) -> Array:
        return corrected(gear, np.append(places, command), np.zeros(6))

    def unbalanced(places: Array) -> Array:
        of_bodies, on_output = forces(places)[[WG, X2, Y1, Y2]], forces(places)[OUT]
        return np.append(of_bodies, on_output - way * BREAKAWAY)

    scale = np.array([1.0, 1.0, 1e-3, 1e-3, 1e-3])
    expected = scale * fsolve(lambda q: unbalanced(scale * q), start(gear, 0.0)[:5] / scale, xtol=1e-13)
    assert np.abs(unbalanced(expected)).max() < 1e-7

    held = sw.analysis.equilibrium(drive, command=command)
    angle = held.input_angle + 2.0 * np.pi * held.turns
    assert angle == pytest.approx(expected[0], rel=1e-9)
    assert angle / drive.gear.kinematics.ratio - held.transmission_error == pytest.approx(command, abs=1e-12)
    assert held["structure.windup"] == pytest.approx(expected[0] - expected[1], rel=1e-7)
    assert held["motor.current"] * 0.0919 == pytest.approx(-forces(expected)[0], rel=1e-7)


@pytest.mark.parametrize("structure", ["staged", "lumped"])
def test_where_it_was_pushed_to_it_rests(structure: str) -> None:
    drive = misaligned(structure, "flexspline")
    held = sw.analysis.equilibrium(drive)
    run = sw.simulate(drive, sw.scenario.constant(0.0, 0.05), 3e-5, initial=held, record=["output_angle", "current"])
    assert run["output_angle"] == pytest.approx(0.0, abs=1e-10)
    assert run["current"] == pytest.approx(held["motor.current"], rel=1e-6)
    assert held["motor.current"] < 0.0  # it came from the side of positive angles


def test_hysteresis_and_bristles_remember_the_way() -> None:
    """Along a path that never turns back, each Maxwell element holds min(k_i delta, F_i), the bristle what it takes to slip."""
    memory = sw.hysteresis.MaxwellSlip(stiffness=[3e3, 2e3], breakaway=[0.5, 100.0])
    bristle = made(sw.friction.LuGre, coulomb=0.3, breakaway=0.3, bristle_stiffness=50.0)
    drive = geared(hysteresis=memory, friction_input=bristle)
    state = sw.analysis.equilibrium(drive, load_torque=5.0)
    found = outputs(drive, state, 0.0, 5.0)
    assert found["torque"] == pytest.approx(K * found["twist"] + 0.5 + 2e3 * found["twist"], rel=1e-9)
    assert found["torque"] == pytest.approx(5.0 + 15.0 * sin(found["output_angle"]), rel=1e-9)
    expected = -0.3 / 50.0 * (1.0 - np.exp(-50.0 / 0.3 * abs(found["input_angle"])))
    assert state["friction_input.deflection"] == pytest.approx(expected, rel=1e-9)
    assert 50.0 * state["friction_input.deflection"] == pytest.approx(-found["torque"] / RATIO, rel=1e-9)
    back = sw.analysis.equilibrium(drive, initial=state)
    assert outputs(drive, back)["twist"] != pytest.approx(0.0, abs=1e-6)
    stays(drive, state, 0.0, 5.0)


@pytest.mark.parametrize("command", [0.0, 0.3])
def test_the_reference_drive_rests_there(command: float) -> None:
    state = sw.analysis.equilibrium(DRIVE, command=command)
    assert outputs(DRIVE, state, command)["output_angle"] == pytest.approx(command, abs=0.02)
    stays(DRIVE, state, command)


def test_a_motor_that_prescribes_an_acceleration_has_an_equilibrium_without_one_only() -> None:
    drive = sw.Drive(motor=sw.motor.AccelerationSource(), control=sw.control.OpenLoop(), load=sw.loads.Inertia(inertia=0.1))
    assert sw.analysis.equilibrium(drive, command=0.0, load_torque=0.1).input_speed == 0.0
    with pytest.raises(ValueError, match=r"nor run steadily: the motor prescribes an acceleration that is not zero"):
        sw.analysis.equilibrium(drive, command=0.01)


def test_an_angle_that_is_lost_among_turns_is_no_place_to_rest() -> None:
    """Nothing holds the input of this drive; after 10^22 turns the error has any slope that rounding gives it."""
    error = sw.kinematic_error.Misalignment(
        major_radius=0.024, minor_radius=0.024, pitch_radius=0.024, pressure_angle=1e-6, housing_tilt_x=1e-3, combine="single"
    )
    gear = sw.Gear(
        kinematics=sw.kinematics.StrainWave(flexspline_teeth=2, circular_spline_teeth=3, fixed="circular_spline"),
        kinematic_error=error,
        stiffness=sw.stiffness.Linear(k=10.0),
        input_inertia=1e-5,
    )
    idle = sw.motor.DC(resistance=0.03, torque_constant=0.0, back_emf=0.0, inertia=0.0)
    drive = sw.Drive(gear=gear, motor=idle, control=sw.control.OpenLoop(gain=0.0), load=sw.loads.Inertia(inertia=1e-5))
    with pytest.raises(ValueError, match=r"nor run steadily"):
        sw.analysis.equilibrium(drive, command=0.01, load_torque=0.1)


@pytest.mark.whole_path("analysis")
@settings(max_examples=sample(3, 20))
@given(smooth_drives)
def test_any_drive_rests_where_it_is_said_to(drive: sw.Drive) -> None:
    """What has no equilibrium says so; in all others no side accelerates, nor does the current or the controller."""
    inputs, state = {"command": 0.01, "load_torque": 0.1}, None
    with suppress(ValueError):
        state = sw.analysis.equilibrium(drive, **inputs)
    if state is None:
        with pytest.raises(ValueError, match=r"no equilibrium at|nor run steadily"):
            sw.analysis.equilibrium(drive, **inputs)
        reject()
    if state.input_speed != 0.0:
        gear = drive.gear.replace(kinematic_error=sw.kinematic_error.Fourier(), kinematic_noise=sw.kinematic_error.Stochastic())
        drive = drive.replace(gear=gear)
    values, slopes = _core.differentiate_rates(drive, state.numbers, np.array([0.01, 0.0, 0.1, 0.0, 293.15, 0.0]))
    layout = StateLayout(drive)
    n = layout.count
    numbers = state.numbers[:n]
    counted = np.maximum(np.abs(numbers), 1e-9 * inputs["command"])  # a smaller number is rounding of the others
    size = counted @ np.abs(slopes[:n, :n]) + np.abs([0.01, 0.0, 0.1, 0.0, 293.15, 0.0]) @ np.abs(slopes[n:, :n])
    for name in ("motor", "input_speed", "output_speed"):
        place = layout.places[name]
        assert (np.abs(values[place]) <= 1e-9 * size[place]).all()


# Running


def test_a_motor_runs_at_the_speed_that_load_and_viscous_friction_leave_it() -> None:
    drive = geared(
        sw.loads.Inertia(inertia=0.5),
        friction_input=sw.friction.Viscous(viscous=2e-3),
        friction_output=sw.friction.Coulomb(coulomb=1.0, viscous=0.4),
    )
    state = sw.analysis.equilibrium(drive, command=12.0, load_torque=3.0)
    braking = 0.1 * 0.12 / 0.5 + 2e-3 + 0.4 / RATIO**2
    speed = (0.1 * 12.0 / 0.5 - (3.0 + 1.0) / RATIO) / braking
    assert state.input_speed == pytest.approx(speed, rel=1e-12)
    assert state.output_speed == pytest.approx(speed / RATIO, rel=1e-12)
    assert state["motor.current"] == pytest.approx((12.0 - 0.12 * speed) / 0.5, rel=1e-12)
    assert state.transmission_error == pytest.approx((3.0 + 1.0 + 0.4 * speed / RATIO) / K, rel=1e-12)
    assert state.output_slip_direction == 1.0


@pytest.mark.parametrize("sensor", [sw.sensor.Ideal(), *LAGS])
@pytest.mark.parametrize("motor", [MOTOR, sw.motor.BrushlessDC(), sw.motor.PMSM()])
def test_an_integral_brings_the_speed_to_its_command(motor: sw.motor.DC, sensor: object) -> None:
    """And bears the load: K i_m = T / i, of the DC motor u = R i_m + K_b omega as well."""
    control = sw.control.PI(proportional=0.05, integral=1.0)
    drive = geared(sw.loads.Inertia(inertia=0.5), control, motor).replace(sensors=sw.Sensors(input_speed=sensor))
    state = sw.analysis.equilibrium(drive, command=1.5, load_torque=3.0)
    found = outputs(drive, state, 1.5, 3.0)
    assert found["input_speed"] == pytest.approx(RATIO * 1.5, rel=1e-12)
    assert found["torque"] == pytest.approx(3.0, rel=1e-9)
    if motor == MOTOR:
        current = 3.0 / RATIO / MOTOR.torque_constant
        assert found["voltage"] == pytest.approx(MOTOR.resistance * current + MOTOR.back_emf * 30.0, rel=1e-9)
        assert state["control.error_integral"] == pytest.approx(found["voltage"], rel=1e-9)
    run = sw.simulate(drive, sw.scenario.constant(1.5, 0.1), load_torque=3.0, initial=state)
    assert np.ptp(run["input_speed"]) < 1e-8


def test_a_proportional_law_leaves_a_speed_behind() -> None:
    """k_p (i r - omega) = u = R T / (i K_m) + K_b omega."""
    drive = geared(sw.loads.Inertia(inertia=0.5), sw.control.PI(proportional=0.2))
    volts = MOTOR.resistance * 3.0 / RATIO / MOTOR.torque_constant
    expected = (0.2 * RATIO * 1.5 - volts) / (0.2 + MOTOR.back_emf)
    assert sw.analysis.equilibrium(drive, command=1.5, load_torque=3.0).input_speed == pytest.approx(expected, rel=1e-10)


def test_a_drive_with_bristles_and_losses_under_load_runs_on_as_it_is() -> None:
    drive = geared(
        sw.loads.Inertia(inertia=0.05),
        friction_input=made(sw.friction.LuGre, coulomb=0.03, breakaway=0.05, bristle_damping=0.01, viscous=1e-4),
        friction_mesh=sw.friction.LoadDependent(
            driving_forward=0.1, driving_reverse=0.15, backdriving_forward=0.2, backdriving_reverse=0.25
        ),
        hysteresis=sw.hysteresis.MaxwellSlip(stiffness=[1e3], breakaway=[0.5]),
    )
    for command, load_torque in ((12.0, 3.0), (-12.0, 3.0), (0.0, 30.0)):
        state = sw.analysis.equilibrium(drive, command=command, load_torque=load_torque)
        run = sw.simulate(drive, sw.scenario.constant(command, 0.2), load_torque=load_torque, initial=state)
        for name in ("input_speed", "twist", "current"):
            assert run[name] == pytest.approx(np.full(len(run), run[name][0]), rel=1e-9), name
        assert abs(run["input_speed"][0]) > 1.0


def test_the_kinematic_error_is_left_out_of_running() -> None:
    plain = geared(sw.loads.Inertia(inertia=0.5))
    error = sw.kinematic_error.Fourier(order=[1, 2], amplitude=[1e-4, 2e-4], phase=[0.3, 0.7])
    uneven = plain.replace(gear=plain.gear.replace(kinematic_error=error))
    assert sw.analysis.equilibrium(uneven, command=12.0).input_speed == sw.analysis.equilibrium(plain, command=12.0).input_speed


def test_below_breakaway_a_drive_in_open_loop_rests_above_it_runs() -> None:
    drive = geared(sw.loads.Inertia(inertia=0.5), friction_input=sw.friction.Coulomb(coulomb=0.5, breakaway=1.0))
    volts_at_breakaway = 1.0 / 0.1 * 0.5
    assert sw.analysis.equilibrium(drive, command=0.999 * volts_at_breakaway).input_speed == 0.0
    running = sw.analysis.equilibrium(drive, command=1.001 * volts_at_breakaway)
    assert running.input_speed == pytest.approx((0.1 * 1.001 * 5.0 / 0.5 - 0.5) / (0.1 * 0.12 / 0.5), rel=1e-12)


def test_a_free_drive_stays_where_it_is() -> None:
    start = geared(sw.loads.Inertia(inertia=0.5)).rest()
    start = start.replace(input_angle=1.0)
    assert sw.analysis.equilibrium(geared(sw.loads.Inertia(inertia=0.5)), initial=start).input_angle == 1.0


# Refusals


@pytest.mark.slow("analysis")
def test_what_has_no_equilibrium_says_why() -> None:
    torque_source = sw.motor.DC(resistance=1.0, back_emf=0.0, torque_constant=0.1, inertia=1e-4)
    with pytest.raises(ValueError, match=r"cannot rest at command = 1 V.*nothing limits its speed"):
        sw.analysis.equilibrium(geared(sw.loads.Inertia(inertia=0.5), motor=torque_source), command=1.0)
    with pytest.raises(ValueError, match=r"cannot rest at command = 12 V.*depends on the angle"):
        sw.analysis.equilibrium(geared(sw.loads.Pendulum(inertia=0.5, gravity_torque=1.0)), command=12.0)
    with pytest.raises(ValueError, match=r"no equilibrium at command = 0 rad, load_torque = 1000 N.m"):
        sw.analysis.equilibrium(geared(control=sw.control.PID(proportional=2.0, limit=12.0)), load_torque=1000.0)


@pytest.mark.parametrize("amplitude", [1e154, 1e160, 1e300])
def test_torques_beyond_all_numbers_are_told_in_a_line_without_a_word_of_libraries(
    amplitude: float, capfd: pytest.CaptureFixture[str]
) -> None:
    error = sw.kinematic_error.Fourier(order=[2.0], amplitude=[amplitude], phase=[0.3])
    drive = sw.Drive(gear=sw.Gear(kinematic_error=error))
    for look in (sw.analysis.equilibrium, sw.linearise):
        with pytest.raises(ValueError, match=r"^no equilibrium can be found: torques or .* grow beyond all numbers"):
            look(drive, load_torque=1.0)
    with pytest.raises(ValueError, match=r"^the drive cannot be linearised: torques or .* grow beyond all numbers"):
        sw.linearise(drive, drive.rest())
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize("load_torque", [1e160, 1e300, 1.7e308])
def test_a_load_beyond_all_numbers_is_told_in_a_line(load_torque: float, capfd: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(ValueError, match=r"^[^\n]*(nothing limits its speed|grow beyond all numbers)[^\n]*$"):
        sw.analysis.equilibrium(sw.Drive(), load_torque=load_torque)
    assert capfd.readouterr() == ("", "")


def test_inputs_that_make_no_sense_are_refused() -> None:
    with pytest.raises(ValueError, match="command = nan must be finite"):
        sw.analysis.equilibrium(geared(), command=float("nan"))
    with pytest.raises(ValueError, match="temperature = 0 K must lie in"):
        sw.analysis.equilibrium(geared(), temperature=0.0)


def test_gravity_decides_whether_the_pendulum_above_is_stable() -> None:
    """Standing upside down under no control, it rests; the poles tell that it will not."""
    drive = geared(friction_input=sw.friction.Coulomb(coulomb=5.0))
    start = drive.rest()
    up = start.replace(transmission_error=-pi + 1e-6)
    soft = drive.replace(gear=drive.gear.replace(stiffness=sw.stiffness.Linear(k=1e-3)))
    state = sw.analysis.equilibrium(soft, initial=up)
    assert cos(outputs(soft, state)["output_angle"]) == pytest.approx(-1.0, abs=1e-3)
    assert sw.linearise(soft, state).poles.real.max() > 0.0
