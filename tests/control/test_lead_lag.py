"""Two sections, one to lead and one to lag."""

from __future__ import annotations

from math import tau

import numpy as np
import pytest
import strainwave as sw
from scipy.signal import cont2discrete, dlsim

from tests.control import by_hand
from tests.control.discrete import DC, RATIO, TIMES, TORQUE, Array, Plant, check, drive

LAW = sw.control.LeadLag(
    gain=0.8, lead_numerator=0.03, lead_denominator=0.004, lag_numerator=0.1, lag_denominator=0.5, limit=48.0
)
STILL = sw.motor.TorqueSource(inertia=1e12)  # nothing moves it


@pytest.mark.parametrize(("period", "delay", "dt"), TIMES)
@pytest.mark.parametrize("feedback", ["input", "output"])
@pytest.mark.parametrize("limit", [48.0, 0.5], ids=["free", "limited"])
def test_sampled_it_is_the_recursion(period: float, delay: float, dt: float, feedback: str, limit: float) -> None:
    law = LAW.replace(feedback=feedback, limit=limit)
    wanted = check(law, by_hand.LeadLag(law, period), DC, period, delay, dt)
    assert (np.abs(wanted["actuation"]).max() == limit) == (limit < 1.0)


@pytest.mark.parametrize("changed", [{}, {"lead_numerator": 0.0}, {"lag_numerator": 0.5}], ids=["both", "no lead", "no lag"])
def test_its_response_is_that_of_its_transfer_function(changed: dict[str, float]) -> None:
    """theta = P u, u = k (1 + a1 s) / (1 + b1 s) (1 + a2 s) / (1 + b2 s) (i r - theta)."""
    law = LAW.replace(limit=1e9, **changed)
    frequency = np.array([0.05, 0.4, 3.0, 20.0, 150.0])
    found = sw.linearise(drive(law, TORQUE)).response(frequency, output="motor_torque")
    a, b = Plant(TORQUE).matrices
    for f, response in zip(frequency, found, strict=True):
        s = 1j * tau * f
        plant = np.linalg.solve(s * np.eye(4) - a[1:, 1:], b[1:])[0]
        lead = (1.0 + law.lead_numerator * s) / (1.0 + law.lead_denominator * s)
        lag = (1.0 + law.lag_numerator * s) / (1.0 + law.lag_denominator * s)
        alone = law.gain * lead * lag
        assert response == pytest.approx(RATIO * alone / (1.0 + plant * alone), rel=1e-9)


def stepped(law: sw.control.LeadLag, time: Array) -> Array:
    """What a step of the error by 1 makes of it: partial fractions."""
    a1, b1, a2, b2 = law.lead_numerator, law.lead_denominator, law.lag_numerator, law.lag_denominator
    first = (1.0 - a1 / b1) * (1.0 - a2 / b1) / (1.0 - b2 / b1)
    second = (1.0 - a2 / b2) * (1.0 - a1 / b2) / (1.0 - b1 / b2)
    return law.gain * (1.0 - first * np.exp(-time / b1) - second * np.exp(-time / b2))


def test_it_answers_a_step_as_its_partial_fractions_do() -> None:
    run = sw.simulate(drive(LAW, STILL), sw.scenario.constant(1.0 / RATIO, 1.0), 1e-4, sample=1e-3)
    assert run["motor_torque"] == pytest.approx(stepped(LAW, run.time), rel=1e-7)


@pytest.mark.parametrize("period", [1e-4, 2e-3, 1e-2, 0.1])
def test_sampled_each_section_is_exact_for_what_is_held(period: float) -> None:
    """SciPy's discretisation of each section with a zero-order hold; no period is too long for it."""
    law = sw.control.Sampled(law=LAW, period=period)
    run = sw.simulate(drive(law, STILL), sw.scenario.constant(1.0 / RATIO, 1.0), 1e-3, sample=period)
    signal = np.ones((len(run), 1))
    for top, bottom in ((LAW.lead_numerator, LAW.lead_denominator), (LAW.lag_numerator, LAW.lag_denominator)):
        numerator, denominator, _ = cont2discrete(([top, 1.0], [bottom, 1.0]), period)
        signal = dlsim((numerator[0], denominator, period), signal)[1]
    assert run["motor_torque"][1:] == pytest.approx(LAW.gain * signal[:-1, 0], rel=1e-9)


def test_sampled_fast_it_becomes_the_continuous_one() -> None:
    command = sw.scenario.sine(0.2, 2.0, 0.5)
    wanted = sw.simulate(drive(LAW), command, 1e-4, sample=2e-3)["output_angle"]
    errors = []
    for period in (1e-3, 5e-4):
        run = sw.simulate(drive(sw.control.Sampled(law=LAW, period=period)), command, 1e-4, sample=2e-3)
        errors.append(np.abs(run["output_angle"] - wanted).max())
    assert errors[0] == pytest.approx(2.0 * errors[1], rel=0.1)


def test_a_lag_lowers_the_error_that_is_left_by_its_ratio() -> None:
    """Under a load the error is T / (i k) at rest, so it falls with the gain at rest and not with that at high frequency."""
    for gain in (0.5, 2.0):
        law = LAW.replace(gain=gain, lag_numerator=0.5)
        run = sw.simulate(drive(law, TORQUE), sw.scenario.constant(0.0, 6.0), load_torque=0.4, sample=0.1)
        assert run["input_angle"][-1] == pytest.approx(-0.4 / RATIO / gain, rel=1e-6)


@pytest.mark.parametrize("slow", ["lead_denominator", "lag_denominator"])
def test_steps_that_cannot_follow_a_section_are_refused_unless_it_is_sampled(slow: str) -> None:
    """Its output is limited, so that numbers which mean nothing would not show."""
    law, command = LAW.replace(**{slow: 4e-5}), sw.scenario.constant(0.0, 0.01)
    sw.simulate(drive(law), command, 0.99e-4)
    with pytest.raises(FloatingPointError, match="as fast as a vibration of 1e\\+04 rad/s"):
        sw.simulate(drive(law), command, 1.01e-4)
    sw.simulate(drive(sw.control.Sampled(law=law, period=1e-3)), command, 1.01e-4)
