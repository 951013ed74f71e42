"""A friction brake: it holds exactly, slips at its torque, and takes what it brakes."""

from __future__ import annotations

import numpy as np
import pytest
import strainwave as sw
from hypothesis import given, strategies as st

from tests.load.free import free, placed, run_of
from tests.support.geared import RATIO, geared

BRAKE = sw.loads.Brake(inertia=0.02)
SOURCE = sw.motor.TorqueSource(inertia=1e-3)


def driven(load: sw.loads.Brake = BRAKE, **parts: object) -> sw.Drive:
    return geared(load=load, motor=SOURCE, **parts).replace(meter=sw.meter.EnergyMeter())


@given(brake=st.floats(0.5, 20.0), speed=st.floats(-20.0, 20.0).filter(lambda w: abs(w) > 0.1))
def test_it_stops_a_body_at_its_torque_and_holds_it(brake: float, speed: float) -> None:
    """J dw/dt = -B sgn w: at rest after J |w| / B, and after J w^2 / (2 B) of a way."""
    drive = free(BRAKE)
    stop = 0.02 * abs(speed) / brake
    run = run_of(drive, 1.5 * stop, stop / 10.0, placed(drive, 0.0, speed), inputs={"brake_torque": brake})
    moving = np.maximum(stop - run.time, 0.0)
    assert run["output_speed"] == pytest.approx(np.sign(speed) * brake / 0.02 * moving, abs=1e-12 * abs(speed))
    assert not run["output_speed"][run.time > 1.01 * stop].any()
    assert run["output_angle"][-1] == pytest.approx(0.5 * 0.02 * speed * abs(speed) / brake, rel=1e-9)
    assert run["energy_load"][-1] == pytest.approx(0.01 * speed**2, rel=1e-9)
    assert run["load_torque"][1:9] == pytest.approx(np.sign(speed) * brake, rel=1e-12)


@pytest.mark.parametrize("torque", [0.24, -0.24])
def test_it_holds_whatever_is_less_than_its_torque(torque: float) -> None:
    """4.8 N.m at the output against 5 N.m: no motion at all. The gear's damper lets the input come to rest."""
    run = sw.simulate(driven(damping=20.0), sw.scenario.ramp(torque / 0.5, 0.5), inputs={"brake_torque": 5.0})
    assert not run["output_speed"].any()
    assert np.abs(run["output_angle"]).max() < 1e-16  # the difference of two angles that turn, to rounding
    assert run["load_torque"] == pytest.approx(run["torque"], abs=1e-12)
    assert run["load_torque"][-1] == pytest.approx(RATIO * torque, rel=0.05)
    assert run["energy_load"][-1] == 0.0


def test_it_breaks_away_at_its_torque_and_slips_with_it() -> None:
    """A torque that grows slowly: the output sets off as 5 N.m at the output are exceeded, and accelerates by the rest."""
    drive = driven(damping=20.0)
    run = sw.simulate(drive, sw.scenario.ramp(0.5, 1.0), 1e-4, inputs={"brake_torque": 5.0})
    first = int(np.flatnonzero(run["output_speed"])[0])
    assert run["torque"][first - 1] <= 5.0 < run["torque"][first] + 0.05
    assert run["load_torque"][first + 1 :] == pytest.approx(5.0)
    assert run["load_torque"][:first] == pytest.approx(run["torque"][:first], abs=1e-12)


def test_at_rest_it_may_hold_more_than_it_resists() -> None:
    sticky = driven(BRAKE.replace(breakaway_ratio=1.5), damping=20.0)
    run = sw.simulate(sticky, sw.scenario.ramp(0.5, 1.0), 1e-4, inputs={"brake_torque": 5.0})
    first = int(np.flatnonzero(run["output_speed"])[0])
    assert run["torque"][first - 1] <= 7.5 < run["torque"][first] + 0.05
    assert run["load_torque"][first + 1 : first + 5] == pytest.approx(5.0)


@pytest.mark.parametrize("brake", [0.0, -3.0])
def test_a_brake_of_no_torque_lets_go(brake: float) -> None:
    drive = free(BRAKE)
    run = run_of(drive, 0.1, 1e-3, placed(drive, 0.0, 2.0), inputs={"brake_torque": brake})
    assert run["output_speed"] == pytest.approx(2.0, rel=1e-12)
    assert not run["load_torque"].any()


def test_a_brake_that_is_let_go_lets_the_wound_up_gear_go() -> None:
    """Held against the spring until 0.05 s, then free: it vibrates about the input with the energy of the spring."""
    drive = geared(load=BRAKE, motor=sw.motor.TorqueSource(inertia=1e12), damping=0.0)
    start = drive.rest().replace(transmission_error=4e-4)  # 1e4 N.m/rad x 4e-4 rad = 4 N.m
    brake = sw.scenario.constant(5.0, 0.1) - sw.scenario.step(5.0, 0.1, start=0.05)
    run = sw.simulate(drive, sw.scenario.constant(0.0, 0.1), 1e-5, initial=start, inputs={"brake_torque": brake})
    held = run.time <= 0.05
    assert run["output_angle"][held] == pytest.approx(-4e-4, rel=1e-12)
    w = np.sqrt(1e4 / 0.02)
    free_time = run.time[~held] - 0.05
    assert run["output_angle"][~held] == pytest.approx(-4e-4 * np.cos(w * free_time), abs=1e-9)


def test_a_brake_and_the_friction_of_the_output_share_what_they_hold() -> None:
    """3 N.m of friction and 5 N.m of brake hold 4 N.m: 1.5 and 2.5."""
    drive = geared(
        load=BRAKE,
        motor=sw.motor.TorqueSource(inertia=1e12),
        damping=0.0,
        friction_output=sw.friction.Coulomb(coulomb=3.0),
    )
    run = sw.simulate(
        drive,
        sw.scenario.constant(0.0, 0.01),
        initial=drive.rest().replace(transmission_error=4e-4),
        inputs={"brake_torque": 5.0},
    )
    assert not run["output_speed"].any()
    assert run["load_torque"] == pytest.approx(2.5, rel=1e-12)
    assert run["friction_output"] == pytest.approx(1.5, rel=1e-12)


def test_the_brake_takes_what_the_motor_gives_while_it_slips() -> None:
    """At constant speed: the work of the brake is its torque times the way."""
    drive = geared(load=BRAKE, motor=sw.motor.TorqueSource(inertia=1e12), damping=5.0).replace(meter=sw.meter.EnergyMeter())
    twist = 2.0 / 1e4
    start = drive.rest().replace(input_speed=20.0, output_speed=1.0, transmission_error=twist)
    run = sw.simulate(drive, sw.scenario.constant(0.0, 0.5), 1e-4, initial=start, inputs={"brake_torque": 2.0})
    assert run["output_speed"] == pytest.approx(1.0, rel=1e-9)
    assert run["energy_load"] == pytest.approx(2.0 * run.time, rel=1e-9, abs=1e-12)
    assert run["torque"] == pytest.approx(2.0, rel=1e-9)
