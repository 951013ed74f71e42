"""PI control of a speed."""

from __future__ import annotations

import numpy as np
import pytest
import strainwave as sw

from tests.control import by_hand
from tests.control.discrete import DC, RATIO, TIMES, TORQUE, check, drive

LAW = sw.control.PI(proportional=0.02, integral=1.5, limit=24.0)


@pytest.mark.parametrize(("period", "delay", "dt"), TIMES)
@pytest.mark.parametrize("feedback", ["input", "output"])
@pytest.mark.parametrize("limit", [24.0, 0.15], ids=["free", "limited"])
def test_sampled_it_is_the_recursion(period: float, delay: float, dt: float, feedback: str, limit: float) -> None:
    law = LAW.replace(feedback=feedback, limit=limit)
    wanted = check(law, by_hand.PI(law, period), DC, period, delay, dt)
    assert (np.abs(wanted["actuation"]).max() == limit) == (limit < 1.0)


def test_its_poles_are_those_of_the_textbook() -> None:
    """On an inertia alone: J s^2 + k_p s + k_i = 0."""
    law = sw.control.PI(proportional=0.02, integral=1.5)
    stiff = drive(law, TORQUE).replace({"gear.stiffness.k": 1e9, "gear.damping": 0.0})
    inertia = TORQUE.inertia + 0.05 / RATIO**2
    wanted = np.roots([inertia, law.proportional, law.integral])
    found = sorted(sw.linearise(stiff).poles, key=lambda pole: abs(pole + 45.0))
    for pole in wanted:
        assert np.abs(np.array(found) - pole).min() <= 1e-5 * abs(pole)


def test_it_leaves_no_error_under_a_load() -> None:
    """At a constant speed the integral holds the whole torque: T_load / i."""
    run = sw.simulate(drive(LAW, TORQUE), sw.scenario.constant(2.0, 3.0), load_torque=0.5, sample=0.01)
    assert run["output_speed"][-1] == pytest.approx(2.0, rel=1e-8)
    assert run["motor_torque"][-1] == pytest.approx(0.5 / RATIO, rel=1e-8)
    assert LAW.integral * run.end["control.error_integral"] == pytest.approx(0.5 / RATIO, rel=1e-8)


def test_its_integral_does_not_wind_up() -> None:
    """An inertia that the limit accelerates for a second: once there, the speed comes back at once."""
    law = sw.control.PI(proportional=0.02, integral=0.2, limit=0.01)
    one = drive(law, TORQUE)
    inertia = TORQUE.inertia + 0.05 / RATIO**2
    speed = 0.01 / inertia / RATIO  # what the limit reaches in a second
    run = sw.simulate(one, sw.scenario.constant(speed, 3.0), sample=1e-3)
    assert run["motor_torque"][500] == 0.01
    assert run["output_speed"][500] == pytest.approx(0.5 * speed, rel=0.02)
    limited = np.flatnonzero(run["motor_torque"] >= 0.01)
    assert 0.9 < run.time[limited[-1]] < 1.0
    assert run["output_speed"].max() < 1.03 * speed  # what a second of error summed up would overshoot by tenfold
    assert run["output_speed"][-1] == pytest.approx(speed, rel=1e-6)


@pytest.mark.parametrize("integral", [2.0, 20.0])
def test_a_run_to_a_tolerance_passes_the_limit_of_the_motor(integral: float) -> None:
    """Where the integral ended at once, what is asked would slide along the limit, and no step would be short enough."""
    motor = sw.motor.BrushlessDC(resistance=0.5, inductance=5e-4, torque_constant=0.1, inertia=1e-4, current_limit=1.5)
    limited = drive(sw.control.PI(proportional=0.1, integral=integral), motor)
    command = sw.scenario.step(1.0, duration=0.2)
    run = sw.simulate_adaptively(limited, command, 1e-8, sample=1e-3)
    assert run["current"].max() == pytest.approx(1.5, rel=1e-2)
    assert run["input_speed"] == pytest.approx(sw.simulate(limited, command, 1e-5, sample=1e-3)["input_speed"], abs=1e-4)
