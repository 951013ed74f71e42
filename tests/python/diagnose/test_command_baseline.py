"""Comparison with a baseline on joints with known truth: rate of false alarms, power, drift, conditions."""

from __future__ import annotations

from math import tau

import numpy as np
import pytest
import strainwave as sw
from scipy.stats import binom
from strainwave.diagnose.baseline import BaselineComparison, baseline_of, compared
from strainwave.diagnose.refusals import usable
from strainwave.diagnose.replicates import JointMotion, apart, blocks_of, cells_of, joint_motion

ORDERS = (2.0, 1.0, 4.0)
RATE, DURATION, NOISE = 100.0, 60.0, 0.05


def joint(
    seed: int, ripple: float = 0.1, drift: float = 0.0, begin: float = 0.0, speed: float = 30.0, slope: float = 0.0
) -> JointMotion:
    """A motor to and fro with order 2, whose amplitude drifts with the time and grows with the speed."""
    time = np.arange(0.0, DURATION, 1.0 / RATE)
    pace = tau * 4.0 / DURATION
    angle = speed / pace * np.sin(pace * time)
    velocity = np.abs(speed * np.cos(pace * time))
    size = ripple * (1.0 + drift * (begin + time / DURATION)) + slope * velocity
    current = 0.4 * np.sign(np.cos(pace * time)) + size * np.cos(2.0 * angle + 0.3)
    current += np.random.default_rng(seed).normal(0.0, NOISE, len(time))
    columns = {"time": time, "input_angle": angle, "current": current}
    return joint_motion(usable(sw.Recording(columns, {"time": "s", "input_angle": "rad", "current": "A"}), f"run {seed}"))


def against(healthy: JointMotion, motion: JointMotion, false_alarm: float = 1e-3) -> BaselineComparison:
    return compared(baseline_of([healthy], ORDERS), motion, false_alarm=false_alarm)


def test_amplitudes_are_those_of_the_ripple_and_sigma_that_of_the_noise() -> None:
    """The bound of Rife and Boorstyn for M samples: sigma of a component sqrt(2 / M) of the noise, of half of them each way."""
    motion = joint(0)
    (cells,) = cells_of(motion, ORDERS, np.zeros(len(motion.shaft.series), dtype=int))
    for direction in cells:
        cell = direction[0]
        assert cell is not None
        assert abs(cell.amplitude - 0.1) < 4.0 * cell.sigma
        assert cell.sigma == pytest.approx(NOISE * np.sqrt(2.0 / (0.5 * RATE * DURATION)), rel=0.2)


def test_blocks_have_equal_motion() -> None:
    motion = joint(0)
    block = blocks_of(motion, motion.travel / 7.0)
    moved = np.bincount(block, np.abs(motion.shaft.own.speed) * (motion.shaft.weight > 0.5))
    assert len(moved) == 7
    assert np.allclose(moved, moved.mean(), rtol=0.05)


@pytest.mark.slow("diagnose")
def test_false_alarms_are_no_more_than_stated() -> None:
    """Of 80 healthy recordings, at a stated rate of 1 in 10: more alarms than 1 in 1000 sets would have are a failure."""
    alarms = sum(bool(against(joint(2 * k), joint(2 * k + 1), false_alarm=0.1).alarms) for k in range(80))
    print(f"\n{alarms} of 80 at a rate of 0.1")
    assert alarms <= binom.isf(1e-3, 80, 0.1)


@pytest.mark.slow("diagnose")
@pytest.mark.parametrize("drift", [0.5, 1.0])
def test_a_drift_that_goes_on_from_the_baseline_is_no_alarm(drift: float) -> None:
    alarms = [against(joint(k, drift=drift), joint(100 + k, drift=drift, begin=1.0)).alarms for k in range(10)]
    assert not any(alarms)


def test_a_change_above_its_limit_is_an_alarm_and_one_far_below_is_none() -> None:
    healthy = joint(1)
    limit = max(each.limit for each in against(healthy, joint(2)).changes if each.order == 2.0)
    assert limit < NOISE
    larger = against(healthy, joint(3, ripple=0.1 + 1.5 * limit))
    assert {each.order for each in larger.alarms} == {2.0}
    assert all(each.low < 1.5 * limit < each.high for each in larger.alarms)
    assert not against(healthy, joint(4, ripple=0.1 + 0.2 * limit)).alarms


def test_an_amplitude_that_grows_with_the_speed_is_compared_at_the_same_speed() -> None:
    """At half of the fast motion's speed the ripple is smaller, as in the healthy joint."""
    healthy = joint(5, slope=0.01)
    slower = against(healthy, joint(6, slope=0.01, speed=24.0))
    order = [each for each in slower.changes if each.order == 2.0]
    assert order
    assert {each.condition for each in order} == {"speed"}
    assert not slower.alarms


def test_motion_that_the_baseline_does_not_contain_is_not_compared() -> None:
    comparison = against(joint(7, speed=10.0), joint(8, speed=60.0))
    assert not comparison.alarms
    assert any("speed from" in each and "not compared" in each for each in comparison.remarks)


def beating(seed: int, begin: float, turns: float = 8.0, ratio: float | None = 100.0) -> JointMotion:
    """A motor to and fro from an angle [rad of the input] on, with lines of both splines alike."""
    time = np.arange(0.0, DURATION, 1.0 / RATE)
    angle = begin + turns * tau * 0.5 * (1.0 - np.cos(tau * 4.0 * time / DURATION))
    current = 0.4 * np.sign(np.gradient(angle)) + 0.1 * np.cos(2.0 * angle) + 0.1 * np.cos(2.02 * angle)
    current += np.random.default_rng(seed).normal(0.0, NOISE, len(time))
    columns = {"time": time, "input_angle": angle, "current": current}
    recording = sw.Recording(columns, {"time": "s", "input_angle": "rad", "current": "A"})
    return joint_motion(usable(recording, f"run {seed}", ratio=ratio))


def test_a_healthy_joint_at_another_place_of_the_output_is_not_compared() -> None:
    """Orders 2 and 2.02 beat over the output: 1.2 rad further the ripple is smaller, without any change of the joint."""
    days = [beating(seed, 0.0) for seed in range(3)]
    moved = compared(baseline_of(days, ORDERS), beating(9, 120.0))
    assert not moved.changes
    assert any("blocks are between 1.2 and 1.7 rad of the output, outside of the 0 to 0.503" in each for each in moved.remarks)
    near = compared(baseline_of(days, ORDERS), beating(9, 0.1))
    assert near.changes
    assert not near.alarms


def test_two_distant_places_cover_no_revolution_between_them() -> None:
    days = [beating(seed, begin) for seed, begin in enumerate((0.0, 0.0, 700.0))]
    between = compared(baseline_of(days, ORDERS), beating(9, 120.0))
    assert not between.changes
    assert any("outside of the 0 to 0.503 and 7 to 7.5 that" in each for each in between.remarks)


def test_a_baseline_over_a_whole_revolution_of_the_output_covers_every_place() -> None:
    days = [beating(seed, 0.0, turns=105.0) for seed in range(2)]
    assert compared(baseline_of(days, ORDERS), beating(9, 900.0, turns=105.0)).changes


def test_without_a_ratio_places_of_the_input_do_not_come_again() -> None:
    days = [beating(seed, 0.0, turns=105.0, ratio=None) for seed in range(2)]
    near = compared(baseline_of(days, ORDERS), beating(9, 0.1, turns=105.0, ratio=None))
    assert near.changes
    far = compared(baseline_of(days, ORDERS), beating(9, 900.0, turns=105.0, ratio=None))
    assert not far.changes
    assert any("rad of the input" in each and "the ratio is not known" in each for each in far.remarks)


def test_several_days_of_a_baseline_are_the_spread() -> None:
    """Ripple that is another each day by 20 %: one day as a baseline shows less of it than five."""
    days = [joint(10 + k, ripple=0.1 * (1.0 + 0.2 * (-1.0) ** k)) for k in range(6)]
    one = compared(baseline_of(days[:1], ORDERS), days[1])
    many = compared(baseline_of(days[:5], ORDERS), days[5])
    spreads = [{each.order: each.spread for each in found.changes}[2.0] for found in (one, many)]
    assert spreads[1] > 0.02
    assert spreads[1] > spreads[0]
    assert not many.alarms


def test_a_short_baseline_and_none_without_orders_are_refused() -> None:
    with pytest.raises(
        ValueError, match=r"baseline is too short: .* periods of order 0.02; a spread needs 48 .* record longer"
    ):
        baseline_of([joint(1)], [0.02])
    with pytest.raises(ValueError, match=r"no order to compare: .* give --gear or --ratio"):
        baseline_of([joint(1)], [])


def test_of_orders_that_a_block_does_not_separate_the_first_is_kept() -> None:
    assert apart([2.0, 2.02, 4.0], 0.1) == (2.0, 4.0)
    assert baseline_of([joint(1)], [2.0, 2.001, 4.0]).orders == (2.0, 4.0)
