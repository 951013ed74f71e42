"""A position loop around a speed loop."""

from __future__ import annotations

from math import tau

import numpy as np
import pytest
import strainwave as sw

from tests.control import by_hand
from tests.control.discrete import CURRENT, DC, RATIO, TIMES, TORQUE, Plant, check, drive

LAW = sw.control.PositionSpeed(
    position_gain=25.0,
    speed_proportional=0.04,
    speed_integral=0.6,
    speed_feedforward=0.9,
    viscous_feedforward=0.002,
    coulomb_feedforward=0.05,
    limit=20.0,
)


@pytest.mark.parametrize(("period", "delay", "dt"), TIMES)
@pytest.mark.parametrize("feedback", ["input", "output"])
@pytest.mark.parametrize("changed", [{}, {"limit": 0.4}, {"speed_limit": 9.0}], ids=["free", "current", "speed"])
def test_sampled_it_is_the_recursion(period: float, delay: float, dt: float, feedback: str, changed: dict[str, float]) -> None:
    law = LAW.replace(feedback=feedback, **changed)
    wanted = check(law, by_hand.PositionSpeed(law, period), CURRENT, period, delay, dt)
    assert (np.abs(wanted["actuation"]).max() == law.limit) == ("limit" in changed)


@pytest.mark.parametrize("motor", [DC, TORQUE], ids=["voltage", "torque"])
def test_sampled_it_is_the_recursion_on_other_motors(motor: object) -> None:
    gain = 10.0 if motor == DC else 0.1
    law = LAW.replace(speed_proportional=0.04 * gain, speed_integral=0.6 * gain)
    check(law, by_hand.PositionSpeed(law, 1e-3), motor, 1e-3, 3e-4)


@pytest.mark.parametrize("integral", [0.0, 0.05])
@pytest.mark.parametrize(("share", "viscous"), [(0.0, 0.0), (1.0, 0.0), (1.0, 3e-3), (0.5, 1e-3)])
def test_its_response_is_that_of_the_block_diagram(integral: float, share: float, viscous: float) -> None:
    """theta = P u, u = (k_s + k_i / s) (k_p (i r - theta) + f s i r - s theta) + b s i r."""
    law = sw.control.PositionSpeed(
        position_gain=25.0,
        speed_proportional=0.004,
        speed_integral=integral,
        speed_feedforward=share,
        viscous_feedforward=viscous,
        limit=1e6,
        speed_limit=1e6,
    )
    frequency = np.array([0.3, 2.0, 7.0, 30.0])
    found = sw.linearise(drive(law, TORQUE)).response(frequency, output="input_angle")
    a, b = Plant(TORQUE).matrices
    for f, response in zip(frequency, found, strict=True):
        s = 1j * tau * f
        plant = np.linalg.solve(s * np.eye(4) - a[1:, 1:], b[1:])[0]
        loop = (law.speed_proportional + integral / s) * (25.0 + s)
        forward = (law.speed_proportional + integral / s) * (25.0 + share * s) + viscous * s
        assert response == pytest.approx(RATIO * plant * forward / (1.0 + plant * loop), rel=1e-9)


FED_FORWARD = sw.control.PositionSpeed(
    position_gain=25.0,
    speed_proportional=0.004,
    speed_feedforward=1.0,
    viscous_feedforward=2e-4,
    coulomb_feedforward=0.03,
    limit=10.0,
)


def rubbing(law: sw.control.PositionSpeed) -> sw.Drive:
    """A drive that is held back by Coulomb and viscous friction at its input."""
    friction = sw.friction.Coulomb(coulomb=0.03, viscous=2e-4)
    return drive(law, TORQUE).replace({"gear.friction_input": friction})


def test_fed_forward_it_follows_a_ramp_without_any_error() -> None:
    """All that friction takes is given before an error asks for it: the controller has no integral, and stays idle."""
    start = {"input_speed": 0.8 * RATIO, "output_speed": 0.8}
    command = sw.scenario.ramp(0.8, 1.0)
    run = sw.simulate(rubbing(FED_FORWARD), command, sample=0.01, initial=start)
    assert run["output_angle"] == pytest.approx(run["command"], abs=1e-13)
    assert run["motor_torque"][1:] == pytest.approx(0.03 + 2e-4 * 0.8 * RATIO, rel=1e-9)


@pytest.mark.parametrize(
    ("missing", "error"),
    [
        ("speed_feedforward", 0.8 * RATIO / 25.0),
        ("viscous_feedforward", 2e-4 * 0.8 * RATIO / (0.004 * 25.0)),
        ("coulomb_feedforward", 0.03 / (0.004 * 25.0)),
    ],
)
def test_what_is_not_fed_forward_costs_its_error(missing: str, error: float) -> None:
    """Behind a ramp the input stays back by what the loops need to give the same."""
    law = FED_FORWARD.replace(**{missing: 0.0})
    run = sw.simulate(rubbing(law), sw.scenario.ramp(0.8, 4.0), sample=0.01)
    assert RATIO * 0.8 * 4.0 - run["input_angle"][-1] == pytest.approx(error, rel=1e-6)


def test_it_never_asks_for_more_than_its_speed_limit() -> None:
    law = sw.control.PositionSpeed(position_gain=25.0, speed_proportional=0.05, speed_limit=30.0, limit=10.0)
    run = sw.simulate(drive(law, TORQUE), sw.scenario.constant(2.0, 2.0), sample=1e-3)
    assert run.between(0.8, 1.0)["input_speed"] == pytest.approx(30.0, rel=1e-3)
    assert run["input_angle"][-1] == pytest.approx(2.0 * RATIO, rel=1e-5)


def test_its_integral_does_not_wind_up() -> None:
    law = sw.control.PositionSpeed(position_gain=10.0, speed_proportional=0.01, speed_integral=0.5, limit=0.01)
    run = sw.simulate(drive(law, TORQUE), sw.scenario.constant(1.0, 8.0), sample=1e-3)
    limited = np.abs(run["motor_torque"]) == 0.01
    assert np.count_nonzero(limited) > 300
    assert run["output_angle"][-1] == pytest.approx(1.0, rel=1e-6)
