"""The DC motor: inductance or none, what brushes take, and its winding as it warms up, against closed forms."""

from __future__ import annotations

import numpy as np
import pytest
import strainwave as sw
from hypothesis import given, strategies as st
from numpy.typing import NDArray
from scipy.linalg import expm

from tests.support.flywheel import course, flywheel, instant, settled, turning
from tests.support.geared import RATIO, K, geared

Array = NDArray[np.float64]
PLAIN = sw.motor.DC(resistance=2.0, torque_constant=0.05, back_emf=0.05, inertia=1e-3)  # document P's, of another inertia
SLOW = PLAIN.replace(inductance=2.7e-3)
BRUSHED = PLAIN.replace(brush_drop=1.5)
B = 4e-4  # N.m.s/rad
speeds = st.floats(-300.0, 300.0)
voltages = st.floats(-48.0, 48.0)


@given(voltage=voltages, speed=speeds)
def test_without_inductance_its_current_follows_at_once(voltage: float, speed: float) -> None:
    drive = flywheel(PLAIN)
    _, shown, _ = instant(drive, turning(drive, speed), voltage)
    assert shown["current"] == pytest.approx((voltage - 0.05 * speed) / 2.0, rel=1e-14, abs=1e-14)


@given(voltage=voltages, speed=speeds)
def test_with_inductance_its_current_rises_with_the_electric_time_constant(voltage: float, speed: float) -> None:
    run = course(SLOW, voltage, speed, 0.01)
    end = (voltage - 0.05 * speed) / 2.0
    assert run["current"] == pytest.approx(end * (1.0 - np.exp(-run.time * 2.0 / 2.7e-3)), rel=1e-9, abs=1e-11)


@pytest.mark.parametrize("motor", [PLAIN, SLOW], ids=["no inductance", "inductance"])
def test_a_step_of_its_voltage_moves_a_drive_as_a_linear_system(motor: sw.motor.DC) -> None:
    """Current, both speeds and the twist by the exponential of a matrix; of no inductance that of a tiny one, in the limit."""
    inertia, damping, voltage = 0.05, 5.0, 12.0
    drive = geared(motor=motor, load=sw.loads.Inertia(inertia=inertia), friction_input=sw.friction.Viscous(viscous=B))
    run = sw.simulate(drive, sw.scenario.constant(voltage, 0.5), 5e-5, sample=1e-2)
    i, j = RATIO, motor.inertia
    shafts = np.array(  # of input speed, output speed, twist: by themselves
        [
            [-(B + damping / i**2) / j, damping / (i * j), -K / (i * j)],
            [damping / (i * inertia), -damping / inertia, K / inertia],
            [1.0 / i, -1.0, 0.0],
        ]
    )
    if motor.inductance:
        matrix = np.zeros((5, 5))
        matrix[1:4, 1:4] = shafts
        matrix[1, 0] = 0.05 / j
        matrix[0, [0, 1, 4]] = np.array([-2.0, -0.05, voltage]) / motor.inductance
        first = 1
    else:
        matrix = np.zeros((4, 4))
        matrix[:3, :3] = shafts
        matrix[0, [0, 3]] += np.array([-0.05 * 0.05 / 2.0, 0.05 * voltage / 2.0]) / j
        first = 0
    one = np.eye(len(matrix))[-1]
    wanted = np.array([expm(matrix * t) @ one for t in run.time])
    for column, name in enumerate(("input_speed", "output_speed", "twist"), first):
        assert run[name] == pytest.approx(wanted[:, column], rel=1e-6, abs=1e-7 * np.abs(wanted[:, column]).max())
    current = wanted[:, 0] if motor.inductance else (voltage - 0.05 * wanted[:, 0]) / 2.0
    assert run["current"] == pytest.approx(current, rel=1e-6, abs=1e-6)


# Brushes


@given(voltage=voltages, speed=speeds)
def test_brushes_take_their_voltage_from_any_current(voltage: float, speed: float) -> None:
    driving = voltage - 0.05 * speed
    drive = flywheel(BRUSHED)
    _, shown, _ = instant(drive, turning(drive, speed), voltage)
    wanted = 0.0 if abs(driving) <= 1.5 else (driving - np.copysign(1.5, driving)) / 2.0
    assert shown["current"] == pytest.approx(wanted, rel=1e-13, abs=1e-15)
    assert shown["voltage"] == voltage


@pytest.mark.parametrize("voltage", [1.4999, -1.4999])
def test_below_the_drop_of_the_brushes_nothing_moves(voltage: float) -> None:
    run = sw.simulate(geared(motor=BRUSHED, load=sw.loads.Inertia(inertia=0.05)), sw.scenario.constant(voltage, 0.1), 1e-4)
    assert not run["current"].any()
    assert not run["input_angle"].any()


def test_with_brushes_it_runs_at_the_speed_and_current_of_its_balance() -> None:
    """K (u - V_b - K omega) / R = b omega; by hand with 12 V: omega = 0.05 x 10.5 / (2 x 4e-4 + 0.0025) = 159.0909 rad/s."""
    drive = geared(
        motor=BRUSHED.replace(inertia=1e-5), load=sw.loads.Inertia(inertia=1e-3), friction_input=sw.friction.Viscous(viscous=B)
    )
    run = sw.simulate(drive, sw.scenario.constant(12.0, 1.0), 1e-4)
    assert run["input_speed"][-1] == pytest.approx(159.090909090909, rel=1e-9)
    assert run["current"][-1] == pytest.approx(B * 159.090909090909 / 0.05, rel=1e-9)


def test_a_shorted_motor_brakes_until_its_back_emf_is_the_drop_of_the_brushes() -> None:
    """omega - V_b / K decays with K^2 / (R J); a motor that turns more slowly turns on for ever."""
    drive = geared(motor=BRUSHED, load=sw.loads.Inertia(inertia=1e-6), stiffness=sw.stiffness.Linear(k=1e3), damping=0.0)
    # The load's inertia counts as 1e-6 / 400, beside 1e-3 kg.m2.
    rate = 0.05**2 / (2.0 * (1e-3 + 1e-6 / RATIO**2))
    run = sw.simulate(drive, sw.scenario.constant(0.0, 2.0), 2e-5, initial=turning(drive, 100.0), sample=1e-2)
    assert run["input_speed"] == pytest.approx(30.0 + 70.0 * np.exp(-rate * run.time), rel=1e-6)
    slow = sw.simulate(drive, sw.scenario.constant(0.0, 0.1), 2e-5, initial=turning(drive, 29.0), sample=1e-2)
    assert slow["input_speed"] == pytest.approx(29.0, rel=1e-12)


@given(voltage=voltages, speed=speeds)
def test_what_brushes_take_is_lost(voltage: float, speed: float) -> None:
    """u i = R i^2 + V_b |i| + K omega i."""
    drive = flywheel(BRUSHED).replace(meter=sw.meter.EnergyMeter())
    _, shown, _ = instant(drive, turning(drive, speed), voltage)
    current = shown["current"]
    assert shown["power_supplied"] == pytest.approx(voltage * current, rel=1e-14)
    assert shown["power_motor"] == pytest.approx(2.0 * current**2 + 1.5 * abs(current), rel=1e-13)
    assert shown["power_supplied"] - shown["power_motor"] == pytest.approx(0.05 * current * speed, rel=1e-9, abs=1e-9)


def test_a_brush_drop_beside_an_inductance_is_refused() -> None:
    with pytest.raises(ValueError, match="a brush_drop needs inductance = 0"):
        sw.motor.DC(brush_drop=1.0, inductance=1e-3)


def test_a_back_emf_above_the_torque_constant_is_lost_as_in_iron() -> None:
    """By hand: 12 V at 100 rad/s: i = (12 - 6) / 2 = 3 A; 36 W in, 18 W copper, 0.05 x 3 x 100 = 15 W out, 3 W in iron."""
    drive = flywheel(PLAIN.replace(back_emf=0.06)).replace(meter=sw.meter.EnergyMeter())
    _, shown, _ = instant(drive, turning(drive, 100.0), 12.0)
    assert shown["current"] == pytest.approx(3.0, rel=1e-14)
    assert (shown["power_supplied"], shown["power_motor"]) == pytest.approx((36.0, 21.0), rel=1e-14)


# Heat


@pytest.mark.parametrize("motor", [PLAIN, SLOW, BRUSHED], ids=["plain", "inductance", "brushed"])
@given(temperature=st.floats(250.0, 420.0))
def test_its_resistance_rises_in_proportion_to_the_temperature(motor: sw.motor.DC, temperature: float) -> None:
    warm = motor.replace(resistance_rise=0.00393)
    drive = flywheel(warm)
    run = sw.simulate(drive, sw.scenario.constant(10.0, 0.06), 1e-4, temperature=temperature, sample=0.06)
    resistance = 2.0 * (1.0 + 0.00393 * (temperature - 293.15))
    assert run["current"][-1] == pytest.approx((10.0 - motor.brush_drop) / resistance, rel=1e-9)


def test_far_below_any_cold_the_resistance_stays_positive() -> None:
    """The line would cross zero at 38.7 K; it levels off at a hundredth."""
    drive = flywheel(PLAIN.replace(resistance_rise=0.00393))
    _, shown, _ = instant(drive, turning(drive, 0.0), 1.0, 0.0, 20.0)
    assert shown["current"] == pytest.approx(1.0 / 0.02, rel=1e-12)


def test_a_settled_motor_without_limits_takes_any_voltage() -> None:
    assert settled(SLOW, 1e4, 0.0)["current"] == pytest.approx(5e3, rel=1e-9)


@pytest.mark.parametrize(("temperature", "current"), [(343.15, 2.5073), (393.15, 2.1536), (493.15, 1.6797), (293.15, 3.0)])
def test_a_run_that_begins_at_a_speed_begins_with_the_current_of_the_warm_winding(temperature: float, current: float) -> None:
    """6 V over 2 Ohm (1 + 0.00393 (T - 293.15 K)), by hand; settled, it does not change."""
    motor = PLAIN.replace(inductance=1e-3, resistance_rise=0.00393)
    run = sw.simulate(
        flywheel(motor), sw.scenario.constant(6.0, 1e-3), 1e-4, temperature=temperature, initial={"input_speed": 0.0}
    )
    assert run["current"][0] == pytest.approx(current, abs=5e-5)
    assert run["current"] == pytest.approx(6.0 / (2.0 * (1.0 + 0.00393 * (temperature - 293.15))), rel=1e-12)


def test_a_run_begins_with_the_current_at_which_a_current_loop_rests() -> None:
    """u = k (i_r - i) and u = R i: i = k i_r / (k + R) = 2 x 3 / (2 + 2) A, with i_r the 3 A that it is limited to."""
    law = sw.control.Cascade(position_gain=20.0, speed_proportional=1.0, current_proportional=2.0, current_limit=3.0)
    for sensor in (sw.sensor.Ideal(), sw.sensor.FirstOrder(time_constant=1e-3)):
        drive = flywheel(SLOW, control=law).replace(sensors=sw.Sensors(current=sensor))
        run = sw.simulate(drive, sw.scenario.constant(1.0, 1e-3), 1e-4, initial={"input_speed": 0.0})
        assert run["current"] == pytest.approx(1.5, rel=1e-9)
