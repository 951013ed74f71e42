"""Ideal sources of current and torque against the DC motor that is one."""

from __future__ import annotations

import numpy as np
import pytest
import strainwave as sw
from hypothesis import given, strategies as st

from tests.support.geared import geared

COMMAND = sw.scenario.sine(0.5, 3.0, 0.5)
DC = sw.motor.DC(resistance=1.0, back_emf=0.0, torque_constant=0.08, inertia=2e-5)  # its voltage is its current


@pytest.mark.slow("physics")
@given(gain=st.floats(-3.0, 3.0), constant=st.floats(0.01, 0.5))
def test_a_motor_whose_voltage_is_its_current_is_a_current_source(gain: float, constant: float) -> None:
    control = sw.control.OpenLoop(gain=gain)
    runs = [
        sw.simulate(geared(motor=motor, control=control), COMMAND, sample=1e-2)
        for motor in (
            DC.replace(torque_constant=constant),
            sw.motor.CurrentSource(torque_constant=constant, inertia=2e-5),
        )
    ]
    for name in ("output_angle", "input_speed", "torque", "current"):
        assert np.array_equal(runs[0][name], runs[1][name])


@pytest.mark.slow("physics")
@given(constant=st.floats(0.01, 0.5))
def test_a_torque_source_gives_what_it_is_asked_for(constant: float) -> None:
    asked = sw.simulate(geared(motor=sw.motor.TorqueSource(inertia=2e-5), control=sw.control.OpenLoop(gain=constant)), COMMAND)
    motor = sw.simulate(geared(motor=DC.replace(torque_constant=constant)), COMMAND)
    assert asked["motor_torque"] == pytest.approx(constant * asked["command"])
    assert asked["output_angle"] == pytest.approx(motor["output_angle"], rel=1e-9, abs=1e-12)


def test_a_drive_shows_what_its_motor_has() -> None:
    shown = {
        kind: sw.simulate(geared(motor=kind()), COMMAND).names for kind in vars(sw.motor).values() if isinstance(kind, type)
    }
    assert {"current", "voltage"} <= set(shown[sw.motor.DC])
    assert "voltage" not in shown[sw.motor.CurrentSource]
    assert "current" in shown[sw.motor.CurrentSource]
    assert "current" not in shown[sw.motor.TorqueSource]
    assert "motor_torque" in shown[sw.motor.TorqueSource]


@pytest.mark.parametrize(
    ("motor", "unit"),
    [(DC, "V"), (sw.motor.CurrentSource(), "A"), (sw.motor.TorqueSource(), "N.m")],
    ids=["DC", "current", "torque"],
)
def test_the_command_of_an_open_loop_has_the_unit_of_what_the_motor_takes(motor: object, unit: str) -> None:
    assert sw.simulate(sw.Drive(motor=motor), COMMAND).unit("command") == unit
    assert sw.simulate(sw.Drive(motor=motor, control=sw.control.PID()), COMMAND).unit("command") == "rad"


def test_the_equilibrium_under_a_torque_balances_it() -> None:
    drive = geared(motor=sw.motor.TorqueSource())
    held = sw.analysis.equilibrium(drive, command=0.05)
    run = sw.simulate(drive, sw.scenario.constant(0.05, 0.1), initial=held)
    assert run["torque"] == pytest.approx(0.05 * drive.gear.kinematics.ratio, rel=1e-9)
    assert run["output_angle"] == pytest.approx(run["output_angle"][0], abs=1e-9)
