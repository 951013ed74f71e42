"""The permanent-magnet synchronous motor against its steady states, its step response, and its three phases."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import strainwave as sw
from hypothesis import given, strategies as st
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.linalg import expm

from tests.support.flywheel import course, flywheel, settled, torque_of, turning
from tests.support.geared import RATIO, SERVO, K, geared

Array = NDArray[np.float64]
PMSM = sw.motor.PMSM
FREE = {"supply_voltage": 1e4, "current_limit": 1e4}  # no limit acts
SURFACE = PMSM(resistance=0.4, direct_inductance=8e-4, quadrature_inductance=8e-4, flux_linkage=0.012, pole_pairs=5, **FREE)
SALIENT = PMSM(
    resistance=0.4,
    direct_inductance=6e-4,
    quadrature_inductance=1.5e-3,
    flux_linkage=0.012,
    pole_pairs=5,
    direct_current=-4.0,
    **FREE,
)
BOTH = pytest.mark.parametrize("motor", [SURFACE, SALIENT], ids=["surface", "salient"])
speeds = st.floats(-400.0, 400.0)
voltages = st.floats(-30.0, 30.0)


def electric(motor: PMSM, across: float | Array, along: float | Array) -> float | Array:
    """The textbook's torque of currents [A] across and along the magnets."""
    difference = motor.direct_inductance - motor.quadrature_inductance
    return 1.5 * motor.pole_pairs * (motor.flux_linkage + difference * along) * across


@BOTH
@given(voltage=voltages, speed=speeds)
def test_its_currents_settle_where_the_voltages_balance(motor: PMSM, voltage: float, speed: float) -> None:
    shown = settled(motor, voltage, speed)
    turning_fast = motor.pole_pairs * speed
    along = motor.direct_current
    across = (voltage - turning_fast * (motor.direct_inductance * along + motor.flux_linkage)) / motor.resistance
    assert shown["direct_current"] == pytest.approx(along, rel=1e-9, abs=1e-9)
    assert shown["current"] == pytest.approx(across, rel=1e-9, abs=1e-9)
    assert shown["direct_voltage"] == pytest.approx(
        motor.resistance * along - turning_fast * motor.quadrature_inductance * across, rel=1e-9, abs=1e-7
    )


@BOTH
def test_a_voltage_switched_on_at_speed_gives_the_response_of_a_linear_system(motor: PMSM) -> None:
    """Both currents at once, by the exponential of a matrix: the inverter decouples i_d only."""
    voltage, speed = 9.0, 120.0
    run = course(motor, voltage, speed, 0.01)
    r, l_d, l_q, w = motor.resistance, motor.direct_inductance, motor.quadrature_inductance, motor.pole_pairs * speed
    matrix = np.zeros((3, 3))  # of i_q, i_d and 1
    matrix[0] = [-r / l_q, -w * l_d / l_q, (voltage - w * motor.flux_linkage) / l_q]
    matrix[1] = [0.0, -r / l_d, r * motor.direct_current / l_d]
    wanted = np.array([expm(matrix * t) @ [0.0, 0.0, 1.0] for t in run.time[::20]])
    assert run["current"][::20] == pytest.approx(wanted[:, 0], rel=1e-8, abs=1e-8)
    assert run["direct_current"][::20] == pytest.approx(wanted[:, 1], rel=1e-8, abs=1e-8)


PHASES = 2.0 * np.pi / 3.0 * np.arange(3)


def park(angle: float) -> Array:
    """From currents or voltages along, across and (none) to the three phases: amplitudes stay amplitudes."""
    return np.stack([np.cos(angle - PHASES), -np.sin(angle - PHASES), np.ones(3)], axis=1)


def inductances(motor: PMSM, angle: float) -> Array:
    """Of three phases [H], at an electric angle."""
    frame = park(angle)
    return frame @ np.diag([motor.direct_inductance, motor.quadrature_inductance, 1e-4]) @ np.linalg.inv(frame)


@BOTH
def test_its_three_phases_say_the_same(motor: PMSM) -> None:
    """u = R i + d(L(theta) i + psi(theta))/dt of each phase; the torque is the work of a small turn at constant currents."""
    voltage, speed, duration = 9.0, 120.0, 4e-3
    run = course(motor, voltage, speed, duration, 1e-5)
    turn = 1e-6

    def magnets(angle: float) -> Array:
        return motor.flux_linkage * np.cos(angle - PHASES)

    def slope(function: Any, angle: float) -> Array:
        return (function(angle + turn) - function(angle - turn)) / (2.0 * turn)

    def rate(time: float, current: Array) -> Array:
        angle, w = motor.pole_pairs * speed * time, motor.pole_pairs * speed
        across = (np.linalg.inv(park(angle)) @ current)[1]
        u_d = motor.resistance * motor.direct_current - w * motor.quadrature_inductance * across
        induced = w * (slope(lambda a: inductances(motor, a), angle) @ current + slope(magnets, angle))
        return np.linalg.solve(
            inductances(motor, angle), park(angle) @ [u_d, voltage, 0.0] - motor.resistance * current - induced
        )

    phases = solve_ivp(rate, (0.0, duration), np.zeros(3), rtol=1e-9, atol=1e-10, t_eval=[duration]).y[:, -1]
    angle = motor.pole_pairs * speed * duration
    along, across, none = np.linalg.inv(park(angle)) @ phases
    assert none == pytest.approx(0.0, abs=1e-6)
    assert (along, across) == pytest.approx((run["direct_current"][-1], run["current"][-1]), rel=1e-5, abs=1e-6)
    work = 0.5 * phases @ slope(lambda a: inductances(motor, a), angle) @ phases + phases @ slope(magnets, angle)
    currents = {"motor.quadrature_current": across, "motor.direct_current": along}
    assert torque_of(motor, speed, currents, voltage) == pytest.approx(motor.pole_pairs * work, rel=1e-6)


@BOTH
@given(across=st.floats(-20.0, 20.0), along=st.floats(-20.0, 20.0), speed=speeds)
def test_the_torque_is_that_of_the_magnets_and_of_the_saliency(motor: PMSM, across: float, along: float, speed: float) -> None:
    currents = {"motor.quadrature_current": across, "motor.direct_current": along}
    assert torque_of(motor, speed, currents) == pytest.approx(electric(motor, across, along), rel=1e-13, abs=1e-15)


def test_current_against_the_magnets_adds_the_torque_of_the_saliency() -> None:
    """By hand: 1.5 x 5 x (0.012 + (6e-4 - 1.5e-3) x (-4)) x 10 A = 1.17 N.m, of which 0.27 N.m by the saliency."""
    currents = {"motor.quadrature_current": 10.0, "motor.direct_current": -4.0}
    assert torque_of(SALIENT, 0.0, currents) == pytest.approx(1.17, rel=1e-14)


@BOTH
def test_it_runs_up_to_the_speed_at_which_its_torque_meets_the_friction(motor: PMSM) -> None:
    """tau = b omega, with i_q = (u_q - p omega (L_d i_d0 + psi)) / R: linear in omega."""
    voltage, viscous = 12.0, 2e-3
    drive = geared(
        motor=motor.replace(inertia=1e-5),
        load=sw.loads.Inertia(inertia=1e-3),
        friction_input=sw.friction.Viscous(viscous=viscous),
    )
    run = sw.simulate(drive, sw.scenario.constant(voltage, 0.5), 1e-4)
    per_current = electric(motor, 1.0, motor.direct_current)
    induced = motor.pole_pairs * (motor.direct_inductance * motor.direct_current + motor.flux_linkage)
    speed = per_current * voltage / (motor.resistance * viscous + per_current * induced)
    assert run["input_speed"][-1] == pytest.approx(speed, rel=1e-9)
    assert run["current"][-1] == pytest.approx(viscous * speed / per_current, rel=1e-9)


def test_a_locked_output_is_held_against_its_torque() -> None:
    drive = geared(motor=SALIENT, load=sw.loads.Prescribed(), damping=50.0)
    run = sw.simulate(drive, sw.scenario.constant(2.0, 0.4), 1e-4, inputs={"output_angle": 0.3})
    assert run["current"][-1] == pytest.approx(2.0 / 0.4, rel=1e-9)
    assert run["load_torque"][-1] == pytest.approx(RATIO * electric(SALIENT, 5.0, -4.0), rel=1e-9)


@given(voltage=voltages, speed=st.floats(-200.0, 200.0))
def test_without_saliency_and_limits_it_is_a_dc_motor(voltage: float, speed: float) -> None:
    constant = 1.5 * SURFACE.pole_pairs * SURFACE.flux_linkage
    same = sw.motor.DC(
        resistance=SURFACE.resistance,
        inductance=SURFACE.quadrature_inductance,
        torque_constant=constant,
        back_emf=constant / 1.5,
    )
    runs = [course(motor, voltage, speed, 0.01, 1e-4) for motor in (SURFACE, same)]
    assert runs[0]["current"] == pytest.approx(runs[1]["current"], rel=1e-12, abs=1e-12)
    current = float(runs[0]["current"][-1])
    assert torque_of(SURFACE, speed, {"motor.quadrature_current": current}) == pytest.approx(
        torque_of(same, speed, {"motor.current": current}), rel=1e-13, abs=1e-15
    )


# Limits


LIMITED = {"supply_voltage": 24.0, "current_limit": 12.0}
REACH = 24.0 / np.sqrt(3.0)


def most_current(motor: PMSM, speed: float) -> float:
    """The largest steady i_q at a speed: on the circle of the voltage, or on that of the current, whichever is less.

    u_d = R i_d - w L_q i_q and u_q = R i_q + w (L_d i_d + psi); u_d^2 + u_q^2 = U^2 / 3 is a quadratic equation for i_q.
    """
    r, w, along = motor.resistance, motor.pole_pairs * speed, motor.direct_current
    cross, induced = w * motor.quadrature_inductance, w * (motor.direct_inductance * along + motor.flux_linkage)
    a, b, c = r**2 + cross**2, 2.0 * r * (induced - cross * along), (r * along) ** 2 + induced**2 - REACH**2
    by_voltage = (-b + np.sqrt(b * b - 4.0 * a * c)) / (2.0 * a)
    return float(min(by_voltage, np.sqrt(motor.current_limit**2 - along**2)))


@BOTH
@pytest.mark.parametrize("speed", [0.0, 50.0, 120.0, 150.0, 180.0, 200.0, 220.0])
def test_its_torque_falls_with_the_speed_along_the_curve_of_its_limits(motor: PMSM, speed: float) -> None:
    limited = motor.replace(**LIMITED)
    shown = settled(limited, 1e3, speed)
    wanted = most_current(limited, speed)
    assert shown["direct_current"] == pytest.approx(motor.direct_current, abs=1e-9)
    assert shown["current"] == pytest.approx(wanted, rel=1e-9)
    currents = {"motor.quadrature_current": shown["current"], "motor.direct_current": shown["direct_current"]}
    assert torque_of(limited, speed, currents) == pytest.approx(electric(motor, wanted, motor.direct_current), rel=1e-9)


@pytest.mark.parametrize("along", [0.0, -5.0])
def test_a_current_against_the_magnets_lets_it_turn_faster(along: float) -> None:
    """No torque is left where (R i_d)^2 + (w (psi + L_d i_d))^2 = U^2 / 3: field weakening by hand."""
    motor = SURFACE.replace(direct_current=along, **LIMITED)
    flux = motor.flux_linkage + motor.direct_inductance * along
    most = np.sqrt(REACH**2 - (motor.resistance * along) ** 2) / (motor.pole_pairs * flux)
    assert most == pytest.approx({0.0: 230.94, -5.0: 342.8}[along], rel=1e-3)
    assert settled(motor, 1e3, most, direct_current=along)["current"] == pytest.approx(0.0, abs=1e-9)
    assert settled(motor, 1e3, 0.98 * most, direct_current=along)["current"] > 0.1


@st.composite
def limited_runs(draw: st.DrawFn) -> tuple[PMSM, float, list[float]]:
    """A motor, a speed, and voltages asked for one after the other."""
    l_d, l_q = draw(st.floats(3e-4, 3e-3)), draw(st.floats(3e-4, 3e-3))
    motor = PMSM(
        resistance=draw(st.floats(0.2, 1.0)),
        direct_inductance=l_d,
        quadrature_inductance=l_q,
        flux_linkage=draw(st.floats(0.005, 0.02)),
        pole_pairs=draw(st.integers(2, 8)),
        direct_current=draw(st.floats(-9.0, 9.0)),
        supply_voltage=24.0,
        current_limit=10.0,
    )
    w = draw(st.floats(-1.0, 1.0)) * most_speed(motor)
    return motor, w, draw(st.lists(st.floats(-100.0, 100.0), min_size=1, max_size=5))


def most_speed(motor: PMSM) -> float:
    """Up to which the inverter reaches every voltage that currents within their limit ask for [rad/s]."""
    limit = motor.current_limit
    flux = np.hypot(motor.flux_linkage + motor.direct_inductance * limit, motor.quadrature_inductance * limit)
    return max(REACH - 2.0 * motor.resistance * limit, 0.0) / (motor.pole_pairs * flux)


@given(limited_runs())
def test_neither_voltage_nor_current_is_ever_longer_than_its_limit(drawn: tuple[PMSM, float, list[float]]) -> None:
    motor, speed, asked = drawn
    drive = flywheel(motor)
    state = turning(drive, speed)
    for voltage in asked:
        run = sw.simulate(drive, sw.scenario.constant(voltage, 2e-3), 5e-5, initial=state)
        state = run.end
        assert np.hypot(run["voltage"], run["direct_voltage"]).max() <= REACH * (1.0 + 1e-12)
        assert np.hypot(run["current"], run["direct_current"]).max() <= motor.current_limit * (1.0 + 1e-9)


@pytest.mark.parametrize("sense", [1.0, -1.0], ids=["forward", "reverse"])
def test_where_the_load_turns_it_too_fast_the_inverter_gives_what_it_can(sense: float) -> None:
    """Far beyond the speed of no load the motor brakes, with more current than it should, but no voltage beyond the supply."""
    motor = SURFACE.replace(**LIMITED)
    shown = settled(motor, 0.0, sense * 500.0)
    assert np.hypot(shown["voltage"], shown["direct_voltage"]) <= REACH * (1.0 + 1e-12)
    assert (
        sense
        * torque_of(
            motor,
            sense * 500.0,
            {"motor.quadrature_current": shown["current"], "motor.direct_current": shown["direct_current"]},
        )
        < 0.0
    )


# Cogging and offset


COGGING = PMSM(flux_linkage=0.0, cogging_torque=0.02, cogging_order=12, inertia=2e-4, **FREE)  # without magnets no current


@given(angle=st.floats(-3.0, 3.0))
def test_cogging_is_a_sine_over_the_angle(angle: float) -> None:
    assert torque_of(COGGING, 30.0, angle=angle) == pytest.approx(0.02 * np.sin(12.0 * angle), abs=1e-16)


def test_cogging_holds_its_energy() -> None:
    """A rotor on the spring of a locked gear, thrown over a cog: 1/2 J w^2 + 1/2 k twist^2 + tau_c/n cos(n theta) stays."""
    drive = geared(motor=COGGING, load=sw.loads.Prescribed(), damping=0.0).replace(meter=sw.meter.EnergyMeter())
    start = drive.rest().replace(input_speed=200.0)
    run = sw.simulate(drive, sw.scenario.constant(0.0, 0.05), 1e-5, initial=start, inputs={"output_angle": 0.0})
    assert np.ptp(run["input_angle"]) > 2.0 * np.pi / 12.0
    cogging = 0.02 / 12.0 * np.cos(12.0 * run["input_angle"])
    energy = 0.5 * 2e-4 * run["input_speed"] ** 2 + 0.5 * K * run["twist"] ** 2 + cogging
    assert energy == pytest.approx(energy[0], rel=1e-9)
    assert run["stored_motor"] == pytest.approx(cogging, abs=1e-15)


def test_a_rotor_vibrates_in_its_cog() -> None:
    """About the angle pi / n the cogging is a spring of the stiffness n tau_c, beside that of the gear."""
    drive = geared(motor=COGGING, load=sw.loads.Prescribed(), damping=0.0)
    held = np.pi / 12.0 / RATIO
    start = drive.rest().replace(input_speed=1e-3)
    run = sw.simulate(
        drive,
        sw.scenario.constant(0.0, 0.05),
        1e-5,
        inputs={"output_angle": held},
        initial=start.replace(input_angle=np.pi / 12.0, transmission_error=0.0),
    )
    w = np.sqrt((K / RATIO**2 + 12.0 * 0.02) / 2e-4)
    assert run["input_angle"] - np.pi / 12.0 == pytest.approx(1e-3 / w * np.sin(w * run.time), abs=1e-6 * 1e-3 / w)


def test_a_current_sensor_with_an_offset_ripples_once_per_pair_of_poles() -> None:
    """Feedback of the current by k_c: L di/dt = -(R + k_c) i - k_c I_o sin(p omega t) - p omega psi."""
    gain, speed, offset = 3.0, 40.0, 0.3
    motor = SURFACE.replace(current_offset=offset)
    drive = flywheel(motor).replace(control=sw.control.StateFeedback(current=gain, limit=1e3))
    w = motor.pole_pairs * speed
    period = 2.0 * np.pi / w
    run = sw.simulate(drive, sw.scenario.constant(0.0, 10.0 * period), period / 400.0, initial=turning(drive, speed))
    last = run["current"][-401:-1]
    spectrum = np.fft.rfft(last) / len(last)
    amplitude = gain * offset / np.hypot(motor.resistance + gain, w * motor.quadrature_inductance)
    assert 2.0 * abs(spectrum[1]) == pytest.approx(amplitude, rel=1e-6)
    assert spectrum[0].real == pytest.approx(-w * motor.flux_linkage / (motor.resistance + gain), rel=1e-9)
    assert np.abs(spectrum[2:]).max() < 1e-6 * amplitude


def test_a_fast_current_loop_turns_the_offset_into_a_ripple_of_the_same_size() -> None:
    gain, speed, offset = 40.0, 1.0, 0.3
    motor = SURFACE.replace(current_offset=offset)
    drive = flywheel(motor).replace(control=sw.control.StateFeedback(current=gain, limit=1e4))
    run = sw.simulate(drive, sw.scenario.constant(0.0, 1.3), 1e-5, initial=turning(drive, speed), sample=1e-3)
    late = run.between(0.1, 1.3)
    wanted = -offset * np.sin(motor.pole_pairs * late["input_angle"])
    assert late["current"] == pytest.approx(wanted, abs=0.02 * offset)


# Heat


@given(temperature=st.floats(250.0, 420.0))
def test_its_resistance_rises_with_the_temperature(temperature: float) -> None:
    """Copper: 0.393 % per kelvin above 20 degC."""
    motor = SURFACE.replace(resistance_rise=0.00393)
    drive = flywheel(motor)
    shown = sw.simulate(drive, sw.scenario.constant(6.0, 0.2), 1e-4, initial=turning(drive, 0.0), temperature=temperature).end
    assert shown["motor.quadrature_current"] == pytest.approx(6.0 / (0.4 * (1.0 + 0.00393 * (temperature - 293.15))), rel=1e-9)


def test_a_current_along_the_magnets_beyond_the_limit_is_refused() -> None:
    with pytest.raises(ValueError, match="direct_current must lie within current_limit"):
        PMSM(direct_current=-10.0, current_limit=10.0)


# A cascade at the limit of the inverter

INERTIA = 1e-4 + 0.4 / RATIO**2
CASCADE = sw.control.Cascade(
    position_gain=20.0,
    speed_proportional=0.3,
    speed_integral=6.0,
    current_proportional=2.0,
    current_integral=500.0,
    speed_limit=150.0,
    current_limit=1e6,
    voltage_limit=1e6,
)


def by_hand(target: float, duration: float, *, rests: bool, dt: float = 1e-5) -> Array:
    """The input angle of a rigid drive under the cascade, by Euler's method.

    `rests`: what leads the integrals further beyond what the inverter can give fades over a twentieth of that range.
    """
    angle = speed = current = of_speed = of_current = 0.0
    angles = [angle]
    for _ in range(round(duration / dt)):
        speed_error = min(max(20.0 * (target - angle), -150.0), 150.0) - speed
        current_error = 0.3 * speed_error + 6.0 * of_speed - current
        asked, induced = 2.0 * current_error + 500.0 * of_current, speed / 15.0
        low, high = max(induced - 5.0, -24.0), min(induced + 5.0, 24.0)
        beyond = max(asked - high, 0.0) - max(low - asked, 0.0) if rests else 0.0
        left = max(1.0 - abs(beyond) / (0.05 * (high - low)), 0.0)
        kept = [left * error if error * beyond > 0.0 else error for error in (speed_error, current_error)]
        voltage = min(max(asked, low), high)
        angle, speed = angle + dt * speed, speed + dt * 0.1 * current / INERTIA
        current += dt * (voltage - 0.5 * current - induced) / 1e-3
        of_speed, of_current = of_speed + dt * kept[0], of_current + dt * kept[1]
        angles.append(angle)
    return np.array(angles)


@pytest.mark.slow("physics")
def test_integrals_that_rest_at_the_limit_of_the_inverter_overshoot_little() -> None:
    """A step of 20 rad, against a recursion written by hand: 26 rad; with integrals that wind up 78 rad, for ever."""
    drive = geared(
        motor=SERVO, load=sw.loads.Inertia(inertia=0.4), control=CASCADE, stiffness=sw.stiffness.Linear(k=1e6), damping=200.0
    )
    run = sw.simulate(drive, sw.scenario.constant(1.0, 1.5), 5e-5, sample=1e-3)
    resting, winding = (by_hand(RATIO, 1.5, rests=rests) for rests in (True, False))
    assert run["input_angle"] == pytest.approx(resting[::100], abs=3e-4 * RATIO)
    assert winding.max() > 3.5 * RATIO
    assert run["input_angle"].max() < 1.35 * RATIO
    assert run["input_angle"][-1] == pytest.approx(RATIO, rel=1e-3)
    assert run["current"].max() <= 10.0 * (1.0 + 1e-9)


@pytest.mark.parametrize("inductance", [1e-4, 1e-3, 1e-2])
def test_a_run_begins_with_the_currents_at_which_a_saturated_voltage_holds_them(inductance: float) -> None:
    """At 2000 rad/s u_d takes all of U = 48 V / sqrt(3): R i_d = U + p w L i_q and R i_q = -p w (L i_d + psi)."""
    both = {"direct_inductance": inductance, "quadrature_inductance": inductance}
    motor = PMSM(resistance=1.0, flux_linkage=0.02, pole_pairs=4, **both)
    run = sw.simulate(flywheel(motor), sw.scenario.constant(0.0, 1e-3), 1e-5, initial={"input_speed": 2000.0})
    turning_fast, reach = 4 * 2000.0, 48.0 / np.sqrt(3.0)
    equations = np.array([[1.0, turning_fast * inductance], [-turning_fast * inductance, 1.0]])
    across, along = np.linalg.solve(equations, [-turning_fast * 0.02, reach])
    assert run["current"][0] == pytest.approx(across, rel=1e-9)
    assert run["direct_current"][0] == pytest.approx(along, rel=1e-9)
    assert run["direct_voltage"][0] == pytest.approx(reach, rel=1e-12)


def test_a_run_begins_with_the_currents_of_the_warm_winding() -> None:
    """At 393.15 K: R = 0.4 Ohm x 1.393; i_q = (9 V - p w (L_d i_d0 + psi)) / R, i_d = i_d0."""
    motor = SALIENT.replace(resistance_rise=0.00393)
    run = sw.simulate(
        flywheel(motor), sw.scenario.constant(9.0, 1e-3), 1e-5, temperature=393.15, initial={"input_speed": 120.0}
    )
    assert run["current"] == pytest.approx((9.0 - 5 * 120.0 * (6e-4 * -4.0 + 0.012)) / (0.4 * 1.393), rel=1e-9)
    assert run["direct_current"] == pytest.approx(-4.0, rel=1e-9)
