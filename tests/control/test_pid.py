"""PID control of an angle."""

from __future__ import annotations

import numpy as np
import pytest
import strainwave as sw

from tests.control import by_hand
from tests.control.discrete import DC, PROMPT, RATIO, TIMES, TORQUE, check, drive

LAW = sw.control.PID(proportional=0.5, integral=3.0, derivative=0.01, limit=24.0)


@pytest.mark.parametrize(("period", "delay", "dt"), TIMES)
@pytest.mark.parametrize("feedback", ["input", "output"])
@pytest.mark.parametrize("limit", [24.0, 0.6], ids=["free", "limited"])
def test_sampled_it_is_the_recursion(period: float, delay: float, dt: float, feedback: str, limit: float) -> None:
    law = LAW.replace(feedback=feedback, limit=limit)
    wanted = check(law, by_hand.PID(law, period), DC, period, delay, dt)
    assert (np.abs(wanted["actuation"]).max() == limit) == (limit < 1.0)


@pytest.mark.parametrize("motor", [PROMPT, TORQUE], ids=["prompt current", "torque"])
def test_sampled_it_is_the_recursion_on_other_motors(motor: object) -> None:
    gain = 1.0 if motor == PROMPT else 0.1
    law = LAW.replace(proportional=0.5 * gain, integral=3.0 * gain, derivative=0.01 * gain)
    check(law, by_hand.PID(law, 1e-3), motor, 1e-3, 3e-4)


def test_at_rest_its_integral_rises_with_the_error_itself() -> None:
    """Where the error is zero, the integral of its linear view has one slope, not the sum of those of both signs."""
    linear = sw.linearise(drive(LAW, TORQUE))
    integral, angle = (linear.states.index(name) for name in ("control.error_integral", "input_angle"))
    assert linear.A[integral, angle] == pytest.approx(-1.0, rel=1e-12)
    assert linear.B[integral, linear.inputs.index("command")] == pytest.approx(RATIO, rel=1e-12)


def test_it_tracks_a_ramp_without_error_and_holds_a_load() -> None:
    run = sw.simulate(drive(LAW, TORQUE), sw.scenario.ramp(0.5, 3.0), load_torque=0.4, sample=0.01)
    assert run["input_angle"][-1] == pytest.approx(RATIO * 1.5, rel=1e-9)
    assert run["motor_torque"][-1] == pytest.approx(0.4 / RATIO, rel=1e-8)


def test_an_integral_at_the_limit_comes_back_with_the_error() -> None:
    """It rests only while it would lead further beyond. If it rested in both senses, this drive would run away at its limit."""
    law = sw.control.PID(proportional=0.0, integral=20.0, limit=1.0)
    run = sw.simulate(drive(law), sw.scenario.constant(0.2, 4.0), sample=1e-3)
    passed = int(np.argmax(run["input_angle"] > RATIO * 0.2))
    assert run["voltage"][passed] == pytest.approx(1.0, rel=1e-3)
    later = run.time > run.time[passed] + 0.5
    assert run["voltage"][later].min() < -0.5
    assert np.abs(run["output_angle"]).max() < 0.4


def test_its_integral_does_not_wind_up() -> None:
    """A torque limit holds it up for long; summed up meanwhile, the error would ask for twelve times the limit."""
    law = sw.control.PID(proportional=0.02, integral=0.005, derivative=0.01, limit=0.02)
    run = sw.simulate(drive(law, TORQUE), sw.scenario.constant(3.0, 20.0), sample=1e-2)
    error = RATIO * 3.0 - run["input_angle"]
    limited = run["motor_torque"] == 0.02
    assert law.integral * error[limited].sum() * 1e-2 > 8.0 * law.limit
    assert run["output_angle"].max() < 1.1 * 3.0
    assert run["output_angle"][-1] == pytest.approx(3.0, rel=1e-3)
