"""Friction at constant speed: levels without gravity, over the angle by assumed parameters, and over a warm-up."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest
import strainwave as sw
from numpy.typing import NDArray
from strainwave.identification.candidates.steady_friction import (
    constant_speeds,
    fit_position,
    friction_over_temperature,
    levels_of,
)
from strainwave.identification.identify import identify

COULOMB, VISCOUS, GRAVITY, PHASE = 12.0, 2.0, 40.0, 0.2
DEGREES = (0.3, 1.0, 3.0, 10.0, 30.0, 60.0)  # per second
Array = NDArray[np.float64]

S1, S2, S3 = 1.5738e-6, -3.7901e-4, 0.0720  # printed


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


def over_200_rad(speeds: Sequence[float], torque: float, seed: int) -> list[tuple[Array, Array]]:
    """Torque [N.m] and angle [rad] of a motor of ratio 100 with the printed parabola, under gravity `torque` at the output."""
    random, stretches = np.random.default_rng(seed), []
    for speed in speeds:
        angle = np.linspace(0.0, 200.0, 400)[:: int(np.sign(speed))]
        friction = np.sign(speed) * (S1 * angle**2 + S2 * angle + S3) + 4e-4 * speed
        gravity = torque / 100.0 * np.sin(angle / 100.0 + PHASE)
        stretches.append((friction + gravity + 5e-4 * random.normal(size=len(angle)), angle))
    return stretches


@pytest.mark.parametrize(("torque", "seed"), [(0.0, 1), (0.0, 2), (3.0, 3)])
@pytest.mark.parametrize("speeds", [(2.0,), (1.0, 4.0, 10.0), (-1.0, -4.0)])
def test_motion_one_way_does_not_separate_gravity_from_friction_over_the_angle(
    speeds: tuple[float, ...], torque: float, seed: int
) -> None:
    stretches = over_200_rad(speeds, torque, seed)
    levels = levels_of([each for each, _ in stretches], [angle / 100.0 for _, angle in stretches], np.array(speeds))
    assert levels.gravity_sigma is None
    assert levels.torque == pytest.approx([each.mean() for each, _ in stretches])


@pytest.mark.parametrize("seed", range(5))
def test_motion_both_ways_separates_gravity_from_friction_over_the_angle(seed: int) -> None:
    speeds = np.array([1.0, -1.0, 4.0, -4.0])
    stretches = over_200_rad(speeds, 3.0, seed)
    levels = levels_of([each for each, _ in stretches], [angle / 100.0 for _, angle in stretches], speeds)
    assert levels.gravity_sigma is not None
    off = (np.array([levels.cosine, levels.sine]) - 0.03 * np.array([np.sin(PHASE), np.cos(PHASE)])) / levels.gravity_sigma
    assert np.abs(off).max() < 3.5
    assert max(levels.gravity_sigma) < 2e-3
    runs = [run(angle, each, speed=np.full(400, v)) for (each, angle), v in zip(stretches, speeds, strict=True)]
    law = {each.path: each for each in fit_position(runs, gravity_order=0.01).estimates}
    for path, truth in (("quadratic", S1), ("linear", S2), ("viscous", 4e-4)):
        assert abs(law[path].value - truth) < 3.5 * law[path].sigma < 0.1 * abs(truth)


@pytest.mark.parametrize("rows", [200, 300, 400])
@pytest.mark.parametrize("seed", range(3))
def test_a_load_twice_a_turn_is_not_taken_for_gravity(rows: int, seed: int) -> None:
    """Of the joint, over 1 to 2 rad: one wave explains most of it, with 12 to 13 N.m that are not there."""
    speeds = np.array([20.0, -20.0])
    stretches = [
        ((torque + 0.04 * np.sin(2.0 * angle / 100.0))[angle <= 0.5 * rows], angle[angle <= 0.5 * rows])
        for torque, angle in over_200_rad(speeds.tolist(), 0.0, seed)
    ]
    levels = levels_of([each for each, _ in stretches], [angle / 100.0 for _, angle in stretches], speeds)
    assert levels.gravity_sigma is None


@pytest.mark.parametrize("ways", [(1.0,), (1.0, -1.0)])
def test_a_table_over_the_angle_has_gravity_at_the_output_if_it_goes_both_ways(ways: tuple[float, ...], tmp_path: Path) -> None:
    speeds = [2.0 * way for way in ways]
    torque, angle = map(np.concatenate, zip(*over_200_rad(speeds, 3.0, 6), strict=True))
    columns = {"angle": angle, "speed": np.repeat(speeds, 400), "torque": torque}
    sw.Recording(columns, {"angle": "rad", "speed": "rad/s", "torque": "N.m"}).to_csv(tmp_path / "table.csv")
    found = identify("position-drive", [tmp_path / "table.csv"])
    gravity = [each.estimate for each in found.parameters if each.estimate.path == "load.gravity_torque"]
    assert len(gravity) == len(ways) - 1
    assert all(abs(each.value - 3.0) < 3.5 * each.sigma < 1.0 for each in gravity)
    assert not found.failed


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


def truth(seed: int, viscous: float = 0.0) -> tuple[Array, sw.friction.PositionDependent]:
    """The printed average, and amplitudes that fall with the order (assumed; P prints none)."""
    random = np.random.default_rng(seed)
    fall = 0.008 / np.arange(1, 11)
    cosine, sine = fall * random.normal(size=10), fall * random.normal(size=10)
    law = sw.friction.PositionDependent(
        quadratic=S1, linear=S2, constant=S3, cosine=cosine.tolist(), sine=sine.tolist(), viscous=viscous, domain_start=0.0,
        domain_end=240.82,
    )  # fmt: skip
    return np.array([S1, S2, S3, *cosine, *sine]), law


def level(numbers: Array, angle: Array) -> Array:
    """P's equations, written out."""
    s1, s2, s3 = numbers[:3]
    k = np.arange(1, 11)[:, np.newaxis]
    return np.asarray(s1 * angle**2 + s2 * angle + s3 + numbers[3:13] @ np.cos(k * angle) + numbers[13:] @ np.sin(k * angle))


def run(angle: Array, torque: Array, **more: Array) -> sw.Recording:
    units = {"angle": "rad", "torque": "N.m"} | dict.fromkeys(more, "rad/s")
    return sw.Recording({"angle": angle, "torque": torque, **more}, units)


def off(seed: int) -> Array:
    """A run over 19.7 turns, with noise of the RMSE that the position control article states."""
    numbers, _ = truth(seed)
    angle = np.linspace(30.0, 30.0 + 19.7 * 2.0 * np.pi, 1500)
    torque = level(numbers, angle) + 5.2e-3 * np.random.default_rng(1000 + seed).normal(size=len(angle))
    found = fit_position(run(angle, torque))
    return np.array([(each.value - value) / each.sigma for each, value in zip(found.estimates, numbers, strict=True)])


def test_the_procedure_recovers_assumed_parameters_as_well_as_it_says() -> None:
    table = np.array([off(seed) for seed in range(50)])
    assert np.mean(np.abs(table) <= 2.0) >= 0.9
    scatter = np.sqrt(np.mean(table**2, axis=0))
    assert np.all((scatter > 0.7) & (scatter < 1.4)), scatter


def test_integrals_over_whole_turns_and_least_squares_find_the_same_without_noise() -> None:
    numbers, law = truth(1)
    angle = np.linspace(0.0, 20.0 * 2.0 * np.pi, 8001)
    found = fit_position(run(angle, level(numbers, angle)))
    assert [each.value for each in found.estimates] == pytest.approx(numbers.tolist(), rel=1e-9, abs=1e-12)
    assert found.law.steady(1.0, angle=100.0) == pytest.approx(law.steady(1.0, angle=100.0), rel=1e-10)
    whole = found.integrated
    assert whole is not None
    assert [whole.quadratic, whole.linear, whole.constant] == pytest.approx([S1, S2, S3], rel=1e-3)
    assert [*whole.cosine, *whole.sine] == pytest.approx(numbers[3:].tolist(), abs=3e-5)


def test_part_of_a_turn_at_the_end_does_not_shift_least_squares() -> None:
    numbers, _ = truth(2)
    angle = np.linspace(0.0, 3.4 * 2.0 * np.pi, 2000)
    found = fit_position(run(angle, level(numbers, angle)))
    assert [each.value for each in found.estimates] == pytest.approx(numbers.tolist(), rel=1e-7, abs=1e-9)


def test_runs_at_several_speeds_tell_the_viscous_part_and_both_directions_agree() -> None:
    numbers, law = truth(3, viscous=4e-4)
    runs = []
    for v in (0.8, 20.0, -50.0):
        angle = np.linspace(0.0, 60.0, 1500)[:: int(np.sign(v))]
        torque = np.sign(v) * (level(numbers, angle) + 4e-4 * abs(v))
        runs.append(run(angle, torque, speed=np.full(1500, v)))
    found = fit_position(runs)
    assert found.estimates[-1].path == "viscous"
    assert found.law.steady([0.8, -50.0], angle=20.0) == pytest.approx(law.steady([0.8, -50.0], angle=20.0), rel=1e-8)


def test_an_encoder_that_begins_anew_with_each_turn_is_followed() -> None:
    numbers, _ = truth(4)
    angle = np.linspace(0.0, 40.0, 3000)
    wrapped = fit_position(run(np.remainder(angle, 2.0 * np.pi), level(numbers, angle)))
    assert wrapped.estimates[2].value == pytest.approx(S3, rel=1e-6)


@pytest.mark.parametrize(
    ("turns", "samples", "message"),
    [(0.8, 500, r"cover 0\.80 turns"), (30.0, 300, "300 samples over 30.0 turns do not separate 10 orders")],
)
def test_too_little_is_refused(turns: float, samples: int, message: str) -> None:
    angle = np.linspace(0.0, turns * 2.0 * np.pi, samples)
    with pytest.raises(ValueError, match=message):
        fit_position(run(angle, 0.07 + 0.0 * angle))


if __name__ == "__main__":
    table = np.array([off(seed) for seed in range(int(sys.argv[1]))])
    print(np.mean(np.abs(table) <= 2.0, axis=0).round(2), np.sqrt(np.mean(table**2, axis=0)).round(2))


def log(seed: int, slope: float = -0.01, memory: float = 0.9, n: int = 4000) -> sw.Recording:
    """An axis to and fro under its weight, warming up by 10 K, with noise that forgets itself over ten samples."""
    random = np.random.default_rng(seed)
    time = np.arange(n) * 1.0
    speed = np.sin(0.7 * time) * np.sin(0.031 * time)
    temperature = 42.0 - 10.0 * np.exp(-time / 1500.0)
    noise, white = np.empty(n), 0.3 * random.normal(size=n)
    noise[0] = white[0]
    for i in range(1, n):
        noise[i] = memory * noise[i - 1] + np.sqrt(1.0 - memory**2) * white[i]
    current = -0.6 + 0.002 * (temperature - 40.0) + np.sign(speed) * (0.4 + slope * (temperature - 38.0)) + noise
    units = {"time": "s", "speed": "rad/s", "temperature": "degC", "current": "A"}
    return sw.Recording({"time": time, "speed": speed, "temperature": temperature, "current": current}, units)


def test_a_known_fall_lies_within_its_interval_as_often_as_is_said() -> None:
    off = []
    for seed in range(50):
        found = friction_over_temperature(log(seed))
        reference = found.reference_temperature - 273.15
        level = 0.4 - 0.01 * (reference - 38.0)
        truths = (level, -0.01, 0.01 / level)
        off.append([(e.value - t) / e.sigma for e, t in zip((found.friction, found.slope, found.fall), truths, strict=True)])
    table = np.array(off)
    assert np.all(np.mean(np.abs(table) <= 2.0, axis=0) >= 0.9)
    scatter = np.sqrt(np.mean(table**2, axis=0))
    assert np.all((scatter > 0.7) & (scatter < 1.4)), scatter


def test_no_fall_is_not_told_from_none() -> None:
    low, high = friction_over_temperature(log(1, slope=0.0)).slope.interval(0.99)
    assert low < 0.0 < high


def test_one_way_the_slope_is_that_of_the_friction_and_its_level_has_the_weight_inside() -> None:
    both, off = log(3), []
    for seed in range(20):
        random = np.random.default_rng(seed)
        warmth = both["temperature"] - both["temperature"].mean()
        current = 0.9 - 0.01 * warmth + 0.1 * random.normal(size=len(warmth))
        one = both.with_column("speed", np.full(len(warmth), 1.0), "rad/s").with_column("current", current, "A")
        found = friction_over_temperature(one)
        assert found.one_way
        off.append([(found.slope.value + 0.01) / found.slope.sigma, (found.friction.value - 0.9) / found.friction.sigma])
    assert np.all(np.abs(off) < 4.0)
    assert np.all(np.sqrt(np.mean(np.square(off), axis=0)) < 1.5)


def test_a_temperature_that_hardly_changes_is_refused() -> None:
    recording = log(0).with_column("temperature", np.full(4000, 30.0), "K")
    with pytest.raises(ValueError, match="the temperature changes by 0 K only"):
        friction_over_temperature(recording)


def test_an_effort_without_friction_is_refused() -> None:
    still = log(0).with_column("current", np.zeros(4000), "A")
    with pytest.raises(ValueError, match="no part of current turns round with the motion"):
        friction_over_temperature(still)
