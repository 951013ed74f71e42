"""The brushless motor with the limits of its amplifier: stall, no load, rise of the current, and what a controller is told."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import strainwave as sw
from hypothesis import given, strategies as st
from numpy.typing import NDArray

from tests.support.flywheel import course, flywheel, instant, settled, torque_of, turning
from tests.support.geared import RATIO, SERVO, geared

Array = NDArray[np.float64]
MOTOR = sw.motor.BrushlessDC(
    resistance=0.5, inductance=1e-3, torque_constant=0.1, inertia=1e-4, supply_voltage=24.0, current_limit=10.0
)
FREE = MOTOR.replace(supply_voltage=1e4, current_limit=1e4)
OVERSPEED = (24.0 + 0.5 * 10.0) / 0.1  # rad/s, beyond which the supply cannot hold the current back
speeds = st.floats(-OVERSPEED, OVERSPEED)
voltages = st.floats(-60.0, 60.0)


@pytest.mark.parametrize(("voltage", "current"), [(2.0, 4.0), (-4.0, -8.0), (5.0, 10.0), (12.0, 10.0), (-100.0, -10.0)])
def test_at_a_standstill_the_resistance_or_the_limit_decides_its_current(voltage: float, current: float) -> None:
    assert settled(MOTOR, voltage, 0.0)["current"] == pytest.approx(current, rel=1e-12)


def test_a_locked_drive_stalls_at_the_torque_of_the_limit() -> None:
    run = sw.simulate(
        geared(motor=MOTOR, load=sw.loads.Prescribed(), damping=50.0),
        sw.scenario.constant(24.0, 0.4),
        1e-4,
        inputs={"output_angle": 0.0},
    )
    assert run["load_torque"][-1] == pytest.approx(RATIO * 0.1 * 10.0, rel=1e-9)


@pytest.mark.parametrize(("voltage", "speed"), [(12.0, 120.0), (-20.0, -200.0), (50.0, 240.0)])
def test_without_load_its_back_emf_is_the_voltage(voltage: float, speed: float) -> None:
    run = sw.simulate(geared(motor=MOTOR, load=sw.loads.Inertia(inertia=2e-3)), sw.scenario.constant(voltage, 1.0), 1e-4)
    assert run["input_speed"][-1] == pytest.approx(speed, rel=1e-9)
    assert run["current"][-1] == pytest.approx(0.0, abs=1e-7)


@given(voltage=voltages, speed=speeds)
def test_its_current_settles_where_voltage_or_limit_put_it(voltage: float, speed: float) -> None:
    """By the three cases: neither acts, the supply does, or the current's limit does."""
    asked = np.clip(voltage, -24.0, 24.0)
    current = np.clip((asked - 0.1 * speed) / 0.5, -10.0, 10.0)
    assert settled(MOTOR, voltage, speed)["current"] == pytest.approx(current, rel=1e-9, abs=1e-9)


@given(voltage=voltages, speed=speeds)
def test_its_current_rises_as_that_of_a_resistance_and_an_inductance(voltage: float, speed: float) -> None:
    run = course(MOTOR, voltage, speed, 0.01, 1e-4)
    end = np.clip((np.clip(voltage, -24.0, 24.0) - 0.1 * speed) / 0.5, -10.0, 10.0)
    assert run["current"] == pytest.approx(end * (1.0 - np.exp(-run.time * 0.5 / 1e-3)), rel=1e-6, abs=1e-9)


@given(asked=st.lists(voltages, min_size=1, max_size=6), speed=speeds)
def test_its_current_never_exceeds_the_limit_nor_its_voltage_the_supply(asked: list[float], speed: float) -> None:
    drive = flywheel(MOTOR)
    state = turning(drive, speed)
    for voltage in asked:
        run = sw.simulate(drive, sw.scenario.constant(voltage, 3e-3), 1e-4, initial=state)
        state = run.end
        assert np.abs(run["current"]).max() <= 10.0 * (1.0 + 1e-12)
        assert np.abs(run["voltage"]).max() <= 24.0


@given(voltage=voltages, beyond=st.floats(1.01, 3.0), sense=st.sampled_from([1.0, -1.0]))
def test_turned_too_fast_it_gives_all_that_the_supply_has_against_the_current(
    voltage: float, beyond: float, sense: float
) -> None:
    """The current is then that of back-EMF less supply, whatever is asked for, and of either sense alike."""
    speed = sense * beyond * OVERSPEED
    shown = settled(MOTOR, voltage, speed)
    assert shown["voltage"] == sense * 24.0
    assert shown["current"] == pytest.approx((sense * 24.0 - 0.1 * speed) / 0.5, rel=1e-9)
    assert sense * shown["current"] < -10.0


@pytest.mark.parametrize("sense", [1.0, -1.0], ids=["forward", "reverse"])
def test_a_controller_keeps_its_own_limit_where_the_motor_is_turned_too_fast(sense: float) -> None:
    control = sw.control.Sampled(law=sw.control.PID(proportional=1.0, limit=12.0), period=1e-3)
    drive = flywheel(MOTOR).replace(control=control)
    start = turning(drive, sense * 1.2 * OVERSPEED)
    run = sw.simulate(drive, sw.scenario.constant(0.0, 0.01), 1e-4, initial=start)
    assert run.end["control.actuation"] == sense * 12.0
    assert run["voltage"][-1] == sense * 24.0


@given(voltage=voltages, speed=st.floats(-300.0, 300.0), current=st.floats(-50.0, 50.0))
def test_where_no_limit_acts_it_is_the_dc_motor(voltage: float, speed: float, current: float) -> None:
    same = sw.motor.DC(resistance=0.5, inductance=1e-3, torque_constant=0.1, back_emf=0.1, inertia=1e-4)
    found = []
    for motor in (FREE, same):
        drive = geared(motor=motor, load=sw.loads.Inertia(inertia=0.05))
        start = turning(drive, speed, {"motor.current": current})
        found.append(sw.simulate(drive, sw.scenario.constant(voltage, 0.01), 1e-4, initial=start))
    for name in ("current", "voltage", "input_speed", "output_speed", "torque"):
        scale = np.abs(found[1][name]).max()
        assert found[0][name] == pytest.approx(found[1][name], rel=1e-12, abs=1e-12 * scale)


def test_the_limits_follow_speed_and_temperature() -> None:
    """At 40 degC copper has 1.0786 times the resistance of 20 degC; at 100 rad/s the back-EMF is 10 V: 10 -/+ 5.393 V."""
    drive = flywheel(MOTOR.replace(resistance_rise=0.00393))
    for asked, given_ in ((1e3, 15.393), (-1e3, 4.607), (7.0, 7.0)):
        _, shown, _ = instant(drive, turning(drive, 100.0), asked, 0.0, 313.15)
        assert shown["voltage"] == pytest.approx(given_, rel=1e-12)


@given(current=st.floats(-20.0, 20.0))
def test_its_torque_is_proportional_to_its_current(current: float) -> None:
    assert torque_of(MOTOR, 50.0, {"motor.current": current}) == pytest.approx(0.1 * current, rel=1e-15)


# What the motor hands back keeps integrals from winding up.

SPEED_STEP = 8.0  # rad/s at the output: 160 rad/s at the input, of 240 rad/s that the supply reaches
LOAD = sw.loads.Inertia(inertia=0.4)
TOTAL = 1e-4 + 0.4 / RATIO**2
STIFF = {"stiffness": sw.stiffness.Linear(k=1e6), "damping": 200.0}
SPEED_LAW = sw.control.PI(proportional=0.3, integral=6.0, limit=1e6)


def by_hand(duration: float, *, rests: bool, dt: float = 1e-5) -> Array:
    """Speed of the input under a PI law, of a rigid drive without its electric time constant, by Euler's method.

    `rests`: what leads the integral further beyond what supply and current allow fades over a twentieth of that range.
    """
    speed = integral = 0.0
    speeds = [speed]
    for _ in range(round(duration / dt)):
        error = RATIO * SPEED_STEP - speed
        asked = 0.3 * error + 6.0 * integral
        low, high = max(0.1 * speed - 5.0, -24.0), min(0.1 * speed + 5.0, 24.0)
        beyond = max(asked - high if error > 0.0 else low - asked, 0.0) if rests else 0.0
        current = (min(max(asked, low), high) - 0.1 * speed) / 0.5
        integral += max(1.0 - beyond / (0.05 * (high - low)), 0.0) * dt * error
        speed += dt * 0.1 * current / TOTAL
        speeds.append(speed)
    return np.array(speeds)


def test_an_integral_that_rests_at_the_limit_of_the_motor_overshoots_little() -> None:
    """Against a recursion written by hand, with the integral resting and without: there the speed overshoots by a third."""
    motor = MOTOR.replace(inductance=1e-6)
    drive = geared(motor=motor, load=LOAD, control=SPEED_LAW, **STIFF)
    run = sw.simulate(drive, sw.scenario.constant(SPEED_STEP, 1.0), 2e-5, sample=1e-3)
    resting, winding = by_hand(1.0, rests=True), by_hand(1.0, rests=False)
    wanted = RATIO * SPEED_STEP
    assert run["input_speed"] == pytest.approx(resting[::100], abs=2e-3 * wanted)
    assert winding.max() > 1.3 * wanted
    assert run["input_speed"].max() < 1.1 * wanted
    assert run["input_speed"].max() - wanted < 0.25 * (winding.max() - wanted)


def test_an_integral_does_not_move_while_the_motor_is_at_its_limit() -> None:
    """Ended at any moment before the law asks for less than the limit, the integral is still exactly 0."""
    drive = geared(motor=MOTOR, load=LOAD, control=SPEED_LAW, **STIFF)
    for duration in (0.01, 0.05, 0.08):
        run = sw.simulate(drive, sw.scenario.constant(SPEED_STEP, duration), 1e-4)
        asked = 0.3 * (RATIO * SPEED_STEP - run["input_speed"][-1])
        assert asked > run["voltage"][-1]
        assert run.end["control.error_integral"] == 0.0


CASCADE = sw.control.Cascade(
    position_gain=20.0,
    speed_proportional=0.3,
    speed_integral=6.0,
    current_proportional=2.0,
    current_integral=500.0,
    speed_limit=1e6,
    current_limit=1e6,
    voltage_limit=1e6,
)


@pytest.mark.parametrize(
    ("law", "integrals"),
    [
        (SPEED_LAW, ["error_integral"]),
        (sw.control.PID(proportional=2.0, integral=30.0, derivative=0.1, limit=1e6), ["error_integral"]),
        (
            sw.control.PositionSpeed(
                position_gain=20.0, speed_proportional=0.3, speed_integral=6.0, speed_limit=1e6, limit=1e6
            ),
            ["speed_integral"],
        ),
        (CASCADE, ["speed_integral", "current_integral"]),
    ],
    ids=lambda value: getattr(value, "name", ""),
)
@pytest.mark.parametrize(
    "motor",
    [MOTOR, SERVO],
    ids=["brushless_dc", "pmsm"],
)
def test_every_law_lets_its_integrals_rest_while_any_motor_is_at_its_limit(law: Any, integrals: list[str], motor: Any) -> None:
    drive = geared(motor=motor, load=LOAD, control=law, **STIFF)
    run = sw.simulate(drive, sw.scenario.constant(SPEED_STEP, 0.02), 1e-4)
    assert run["voltage"][1] == pytest.approx(5.0, rel=1e-2)  # R I and a little back-EMF, of all that the law asks for
    for name in integrals:
        assert run.end[f"control.{name}"] == 0.0
    at_ease = drive.replace(motor=motor.replace(supply_voltage=1e6, current_limit=1e6))
    moved = sw.simulate(at_ease, sw.scenario.constant(SPEED_STEP, 0.002), 1e-5)
    assert all(moved.end[f"control.{name}"] > 0.0 for name in integrals)
