"""A sensor of order zero."""

from __future__ import annotations

from math import tau

import pytest
import strainwave as sw

from tests.sensor.probe import SPRING, run_of

LAW = sw.sensor.Gain(gain=1.02, offset=0.05)
MOTION = sw.scenario.sine(0.3, 4.0, 0.5) + sw.scenario.ramp(0.2, 0.5)


@pytest.mark.parametrize("quantity", ["output_angle", "output_speed", "torque"])
def test_it_shows_a_share_and_an_offset_at_once(quantity: str) -> None:
    run = run_of(LAW, MOTION, 1e-3, quantity)
    there_is = {
        "output_angle": MOTION.value(run.time),
        "output_speed": MOTION.rate(run.time),
        "torque": -SPRING * MOTION.value(run.time),  # the other end of the spring stands still
    }
    assert run["motor_torque"] == pytest.approx(1.02 * there_is[quantity] + 0.05, abs=1e-9)
    assert run[quantity] == pytest.approx(there_is[quantity], abs=1e-9)  # a recording has what there is


def test_a_current_that_is_read_too_high_is_too_low() -> None:
    """A current loop with an integral ends where the sensor shows what is asked for."""
    motor = sw.motor.DC(resistance=0.5, inductance=5e-4, torque_constant=0.1, back_emf=0.0, inertia=1e3)
    law = sw.control.Cascade(
        position_gain=0.0, speed_proportional=0.0, viscous_feedforward=0.5, current_proportional=0.5, current_integral=500.0
    )
    drive = sw.Drive(motor=motor, control=law, load=sw.loads.Inertia(inertia=1e3), sensors=sw.Sensors(current=LAW))
    drive = drive.replace({"gear.kinematics": sw.kinematics.PlainRatio(reduction=20.0)})
    run = sw.simulate(drive, sw.scenario.ramp(1.0 / tau, 0.1))
    assert run["current"][-1] == pytest.approx((0.5 * 20.0 / tau - 0.05) / 1.02, rel=1e-9)
