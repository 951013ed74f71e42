"""Stretches at constant speed in a record of an angle, and their torque levels without gravity."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import strainwave as sw
from strainwave.identification.experiments.steady_motion import constant_speeds, levels_of
from strainwave.identification.identify import identify

COULOMB, VISCOUS, GRAVITY, PHASE = 12.0, 2.0, 40.0, 0.2
DEGREES = (0.3, 1.0, 3.0, 10.0, 30.0, 60.0)  # per second


def sweep(speed: float, seed: int, irregular: float = 0.3) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Time, angle and torque of an arm that starts at 0, moves one way with irregular speed, and rests at the end."""
    random, time = np.random.default_rng(seed), np.arange(0.0, 6.0, 0.01)
    rate = np.where(time < 4.0, speed * np.minimum(time / 0.05, 1.0), 0.0)
    rate = rate * (1.0 + irregular * np.sin(2.0 * np.pi * random.uniform(2.0, 5.0) * time + random.uniform(0.0, 6.0)))
    angle = np.cumsum(rate) * 0.01
    torque = GRAVITY * np.sin(angle + PHASE) + np.sign(speed) * COULOMB + VISCOUS * rate
    torque = torque + 50.0 * np.gradient(rate, time) * (time < 0.1) + 0.5 * random.normal(size=len(time))
    return time, angle + 1e-5 * random.normal(size=len(time)), torque


def sweeps() -> list[tuple[np.ndarray, np.ndarray, np.ndarray, float]]:
    both = [sign * np.radians(each) for each in DEGREES for sign in (1.0, -1.0)]
    return [(*sweep(speed, seed), float(speed)) for seed, speed in enumerate(both)]


def test_irregular_motion_one_way_is_one_stretch_without_start_and_rest() -> None:
    for time, angle, _, _ in sweeps():
        (part,) = constant_speeds(time, angle)
        assert 1 <= part.start < 40
        assert 370 < part.stop < 420


@pytest.mark.parametrize("angle", [np.sin, lambda t: np.sin(t) + 0.3 * np.sin(3.1 * t), lambda t: t**2])
def test_other_motion_has_no_constant_speed(angle: object) -> None:
    time = np.linspace(0.0, 20.0, 2001)
    assert callable(angle)
    assert constant_speeds(time, angle(time)) == []


def test_levels_of_sweeps_from_one_place_are_friction_without_gravity() -> None:
    taken = [
        (torque[part], angle[part], speed) for time, angle, torque, speed in sweeps() for part in constant_speeds(time, angle)
    ]
    speed = np.array([each[2] for each in taken])
    levels = levels_of([each[0] for each in taken], [each[1] for each in taken], speed)
    assert levels.gravity_sigma is not None
    for value, truth, sigma in zip(
        (levels.cosine, levels.sine), (GRAVITY * np.sin(PHASE), GRAVITY * np.cos(PHASE)), levels.gravity_sigma, strict=True
    ):
        assert abs(value - truth) < 3.5 * sigma < 8.0
    off = (levels.torque - np.sign(speed) * COULOMB - VISCOUS * speed) / levels.sigma
    assert np.abs(off).max() < 3.5


def test_without_gravity_the_levels_are_means() -> None:
    random = np.random.default_rng(2)
    torques = [0.05 + 1e-3 * random.normal(size=300) for _ in range(6)]
    angles = [np.linspace(0.0, 3.0, 300)] * 6
    levels = levels_of(torques, angles, np.array([1.0, -1.0, 2.0, -2.0, 4.0, -4.0]))
    assert levels.gravity_sigma is None
    assert levels.torque == pytest.approx([each.mean() for each in torques])
    assert levels.sigma == pytest.approx(1e-3 / np.sqrt(300), rel=0.3)


@pytest.mark.slow("identification")
def test_an_arm_at_constant_speeds_gives_friction_and_gravity(tmp_path: Path) -> None:
    units = {"time": "s", "joint_position": "rad", "joint_torque": "N.m"}
    for number, (time, angle, torque, _) in enumerate(sweeps()):
        columns = {"time": time, "joint_position": angle, "joint_torque": torque}
        sw.Recording(columns, units).to_csv(tmp_path / f"run{number}.csv")
    found = identify("csg-20-100", sorted(tmp_path.glob("*.csv")))
    numbers = {each.estimate.path: each.estimate for each in found.parameters}
    for path, truth, error in (
        ("load.gravity_torque", GRAVITY, 2.0),
        ("load.gravity_phase", PHASE, 0.06),
        ("gear.friction_input.coulomb", COULOMB / 100.0, 0.005),
    ):
        assert abs(numbers[path].value - truth) < 3.5 * numbers[path].sigma, path
        assert numbers[path].sigma < error, path
