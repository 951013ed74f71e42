"""An observer of how much friction there is: it finds the true scale, within its bounds, by a function that never grows."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import strainwave as sw
from hypothesis import given, strategies as st
from strainwave.compensation import FrictionScale, ModelFeedforward

from tests.compensation.ideal import KINEMATICS, LIGHT, RATIO, state

LEVEL, TRUE, PERIOD = 0.05, 1.3, 1e-3  # N.m, of that of the model, s
INERTIA, DAMPING = 2e-4, 4e-3  # kg.m2, N.m.s/rad of the speed loop
MODEL = sw.friction.Coulomb(coulomb=LEVEL, breakaway=LEVEL, viscous=5e-4)
DRY = sw.friction.Coulomb(coulomb=LEVEL, breakaway=LEVEL)


def gear(friction: Any) -> sw.Gear:
    return sw.Gear(kinematics=KINEMATICS, stiffness=sw.stiffness.Linear(k=1e5), damping=30.0, friction_input=friction)


def more(law: sw.friction.Coulomb, scale: float) -> sw.friction.Coulomb:
    """The same friction, some times as large."""
    return sw.friction.Coulomb(coulomb=scale * law.coulomb, breakaway=scale * law.breakaway, viscous=scale * law.viscous)


def drive(observer: Any, friction: sw.friction.Coulomb = MODEL, scale: float = TRUE, position: float = 20.0,
          period: float = PERIOD) -> sw.Drive:  # fmt: skip
    """A rotor in a speed loop without an integral, whose gear has `scale` times the friction of the model."""
    law = sw.control.PID(proportional=position * DAMPING, derivative=DAMPING, limit=5.0)
    feedforward = ModelFeedforward(gear=gear(friction), load=LIGHT, motor_inertia=INERTIA)
    part = sw.Compensation(feedforward=feedforward, observer=observer)
    return sw.Drive(
        gear=gear(more(friction, scale)),
        motor=sw.motor.TorqueSource(inertia=INERTIA),
        load=LIGHT,
        control=sw.control.Sampled(law=law, period=period, compensation=part),
    )


def scale(run: Any) -> float:
    return state(run.end, "observer")["scale"]


@pytest.mark.parametrize("command", [sw.scenario.ramp(0.3, 6.0), sw.scenario.sine(0.3, 0.5, 12.0)], ids=["ramp", "sine"])
@pytest.mark.parametrize("true", [0.7, 1.0, 1.3])
def test_it_converges_to_the_true_scale(command: sw.scenario.Scenario, true: float) -> None:
    """Of all friction, Coulomb's and viscous; back and forth too, if it waits until a reversal is over."""
    found = sw.simulate(drive(FrictionScale(gain=30.0, min_speed=29.0), scale=true), command, sample=1e-2)
    assert scale(found) == pytest.approx(true, abs=0.01)


def test_the_speed_error_goes_with_the_friction_that_was_missing() -> None:
    errors = []
    for gain in (0.0, 30.0):
        found = sw.simulate(drive(FrictionScale(gain=gain)), sw.scenario.ramp(0.3, 6.0), sample=1e-2)
        errors.append(abs(RATIO * found["command"][-1] - found["input_angle"][-1]))
    missing = (TRUE - 1.0) * (LEVEL + 5e-4 * 30.0)
    assert errors[0] == pytest.approx(missing / (20.0 * DAMPING), rel=0.01)
    assert errors[1] < 0.01 * errors[0]


@pytest.mark.parametrize(("min_speed", "learns"), [(29.9, True), (30.1, False)])
def test_below_the_slowest_it_stands_still(min_speed: float, learns: bool) -> None:
    """At 30 rad/s of the input."""
    found = sw.simulate(drive(FrictionScale(gain=30.0, min_speed=min_speed)), sw.scenario.ramp(0.3, 1.0), sample=1e-2)
    assert (scale(found) != 1.0) == learns


@given(st.floats(0.0, 1.0), st.floats(1.0, 3.0), st.floats(0.0, 1e4), st.floats(0.1, 5.0))
def test_it_stays_within_its_bounds(least: float, most: float, gain: float, true: float) -> None:
    """However fast, and whatever the friction is."""
    one = drive(FrictionScale(gain=gain, min_scale=least, max_scale=most), scale=true)
    found = sw.simulate(one, sw.scenario.sine(0.1, 2.0, 0.5), sample=1e-2)
    assert least <= scale(found) <= most


@pytest.mark.parametrize("gain", [30.0, 300.0])
@pytest.mark.parametrize("true", [0.7, 1.3])
@pytest.mark.parametrize("position", [0.0, 20.0])
def test_its_lyapunov_function_does_not_grow(gain: float, true: float, position: float) -> None:
    """J (sigma^2 + lambda^2 e^2) + (s - s^)^2 / gamma under a loop that gives k sigma, k > lambda J: at a short period."""
    period, speed = 5e-5, 0.3  # s, rad/s of the output
    one = drive(FrictionScale(gain=gain, position_gain=position), friction=DRY, scale=true, position=position, period=period)
    now = one.rest().replace(
        {
            "input_speed": RATIO * speed,
            "output_speed": speed,
            "control.compensation.feedforward.sense": -1.0,
            "control.compensation.feedforward.begun": 1.0,
            "control.compensation.feedforward.speed": speed,
        }
    )
    values = []
    for number in range(3000):
        now = one.step(now, command=speed * number * period, command_rate=speed, dt=period)
        angle = RATIO * speed * (number + 1) * period - now.input_angle - 2.0 * np.pi * now.turns
        error = RATIO * speed - now.input_speed + position * angle
        missing = true - now["control.compensation.observer.scale"]
        values.append(INERTIA * (error**2 + (position * angle) ** 2) + missing**2 / gain)
    assert np.diff(values).max() < 2e-4 * values[0]  # what a period leaves of it
    assert values[-1] < 0.6 * values[0]


def test_by_the_speed_alone_a_motion_of_one_sense_does_not_determine_it() -> None:
    """Where k_p e = (s - s^) F the speed has no error: s^ = 1 + gamma F e stays between 1 and s."""
    gain, level = 300.0, LEVEL
    one = drive(FrictionScale(gain=gain, position_gain=0.0), friction=DRY)
    speed = {"input_speed": -30.0, "output_speed": 0.3}
    start = one.rest().replace({**speed, "control.compensation.feedforward.sense": -1.0})
    found = sw.simulate(one, sw.scenario.ramp(0.3, 6.0), sample=1e-2, initial=start)
    stiffness = 20.0 * DAMPING
    wanted = 1.0 + (TRUE - 1.0) * gain * level**2 / (stiffness + gain * level**2)
    assert scale(found) == pytest.approx(wanted, abs=2e-3)


def test_without_a_model_of_friction_there_is_nothing_to_scale() -> None:
    one = drive(FrictionScale(gain=1e3))
    one = one.replace({"control.compensation.feedforward.friction_share": 0.0})
    assert scale(sw.simulate(one, sw.scenario.ramp(0.3, 1.0), sample=1e-2)) == 1.0


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"min_scale": 1.1}, r"friction_scale\.min_scale = 1\.1 must lie in \[0, 1\]"),
        ({"max_scale": 0.9}, r"friction_scale\.max_scale = 0\.9 must lie in"),
        ({"gain": -1.0}, r"friction_scale\.gain = -1"),
    ],
)
def test_what_is_wrong_is_refused(changed: dict[str, float], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        FrictionScale(**changed)
