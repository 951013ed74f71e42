"""Friction at the speeds measured, where a measurement does not determine Coulomb and viscous friction one by one."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import strainwave as sw
from strainwave.identification.identify import identify
from strainwave.identification.results.steady_friction import best_known_friction, friction_at_speeds, steady_friction_at

START = "csg-20-100"
COULOMB, VISCOUS = 0.05, 3e-4


def table(path: Path, speed: np.ndarray, seed: int = 3) -> Path:
    noise = 5e-4 * np.random.default_rng(seed).normal(size=len(speed))
    torque = np.sign(speed) * (COULOMB + VISCOUS * np.abs(speed)) + noise
    sw.Recording({"speed": speed, "torque": torque}, {"speed": "rad/s", "torque": "N.m"}).to_csv(path)
    return path


def turning(path: Path, speed: float, seed: int = 1) -> Path:
    """A record at one speed over four turns, with a wave of second order in its torque."""
    angle = np.linspace(0.0, 8.0 * np.pi, 3000) * np.sign(speed)
    torque = np.sign(speed) * (COULOMB + VISCOUS * abs(speed) + 0.01 * np.cos(2.0 * angle))
    torque += 1e-3 * np.random.default_rng(seed).normal(size=len(angle))
    columns = {"speed": np.full(3000, speed), "angle": angle, "torque": torque}
    sw.Recording(columns, {"speed": "rad/s", "angle": "rad", "torque": "N.m"}).to_csv(path)
    return path


def test_the_covariance_of_a_collinear_fit_gives_the_friction_at_the_speed_measured() -> None:
    speed, paths = 20.0 + 0.2 * np.linspace(-1.0, 1.0, 20), ["friction_input.coulomb", "friction_input.viscous"]
    columns = np.stack([np.ones(20), speed], axis=1)
    covariance = 1e-3**2 * np.linalg.inv(columns.T @ columns)
    gear = sw.Gear(friction_input=sw.friction.Coulomb(coulomb=COULOMB, breakaway=COULOMB, viscous=VISCOUS))
    assert np.sqrt(np.diag(covariance)) == pytest.approx([0.0368, 0.00184], rel=0.01)  # neither is determined
    found = steady_friction_at(gear, paths, covariance, 20.0)
    assert (found.value, found.sigma) == pytest.approx((COULOMB + 20.0 * VISCOUS, 1e-3 / np.sqrt(20)))
    assert best_known_friction(gear, paths, covariance, [5.0, 20.0, 80.0]) == found


def test_the_interval_of_friction_at_a_speed_contains_the_truth_as_often_as_it_states() -> None:
    random, speed = np.random.default_rng(4), np.array([10.0, -10.0, 10.0, -10.0, 10.0, -10.0])
    inside = 0
    for _ in range(1000):
        (found,), _ = friction_at_speeds(speed, np.sign(speed) * COULOMB + 1e-3 * random.normal(size=6) + 0.02)
        inside += abs(found.value - COULOMB) < found.sigma
    assert 0.63 < inside / 1000 < 0.74  # one standard deviation: 68 %


def test_numbers_that_do_not_act_at_a_speed_leave_its_friction_known() -> None:
    gear = sw.Gear(friction_input=sw.friction.Coulomb(coulomb=2.0, breakaway=2.0, viscous=0.5))
    covariance = np.diag([0.01, np.inf])
    assert steady_friction_at(gear, ["gear.friction_input.coulomb", "gear.damping"], covariance, 1.0).sigma == pytest.approx(
        0.1
    )
    undetermined = ["gear.friction_input.coulomb", "gear.friction_input.viscous"]
    assert steady_friction_at(gear, undetermined, covariance, 1.0).sigma == np.inf


def test_both_directions_cancel_a_zero_error() -> None:
    speed, torque = np.array([0.4, -0.4, 0.4, -0.4]), np.array([2.51, -2.11, 2.49, -2.09])
    (found,), remarks = friction_at_speeds(speed, torque, side="output")
    assert found.value == pytest.approx(2.3)
    assert found.label == "steady_friction (at 0.4 rad/s of the output)"
    assert "no law" in remarks[0]
    assert len(remarks) == 1
    _, remarks = friction_at_speeds(speed[::2], torque[::2])
    assert "zero error" in remarks[1]


def test_a_table_of_speeds_close_together_determines_friction_there_and_the_set_divides_it(tmp_path: Path) -> None:
    speed = np.concatenate([sign * np.linspace(19.8, 20.2, 8) for sign in (1.0, -1.0)])
    found = identify(START, [table(tmp_path / "pq.csv", speed)])
    (number,) = found.parameters
    assert number.estimate.label == "steady_friction (at 20 rad/s of the input)"
    assert abs(number.estimate.value - COULOMB - 20.0 * VISCOUS) < 3.0 * number.estimate.sigma < 1e-3
    law, before = found.gear_set.gear.friction_input, sw.load(START).friction_input
    assert law.steady(20.0) == pytest.approx(number.estimate.value, rel=1e-3)
    assert law.viscous / law.coulomb == pytest.approx(before.viscous / before.coulomb, rel=1e-3)
    assert found.gear_set.sources["gear.friction_input.viscous"].source.startswith("identified in combination: pq.csv")


def test_friction_at_a_speed_with_a_large_standard_deviation_is_not_identified() -> None:
    (found,), _ = friction_at_speeds(np.array([0.4]), np.array([5.43]), np.array([[2.9**2]]))
    assert found.state == "not identified"
    (found,), _ = friction_at_speeds(np.array([0.4]), np.array([5.43]), np.array([[2.5**2]]))
    assert found.state == "identified"


def test_a_record_at_one_speed_identifies_no_viscous_friction(tmp_path: Path) -> None:
    found = identify(START, [turning(tmp_path / "pq.csv", 20.0)])
    numbers = {each.estimate.label: each.estimate for each in found.parameters}
    friction = numbers["steady_friction (at 20 rad/s of the input)"]
    assert abs(friction.value - COULOMB - 20.0 * VISCOUS) < 3.0 * friction.sigma < 3e-3
    assert not {"gear.friction_input.viscous", "gear.friction_input.constant"} & numbers.keys()
    identified = {path for path, entry in found.gear_set.sources.items() if entry.source.startswith("identified from")}
    assert identified == {"gear.friction_input.cosine[1]", "gear.friction_input.sine[1]"}
    assert found.gear_set.gear.friction_input.constant == pytest.approx(friction.value, rel=0.01)
