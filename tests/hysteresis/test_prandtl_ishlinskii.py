"""The exact inverse of Maxwell-slip in parallel with a spring."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import given, strategies as st
from numpy.typing import NDArray
from strainwave.hysteresis import MaxwellSlip, PrandtlIshlinskii

Array = NDArray[np.float64]

SLIP = MaxwellSlip(stiffness=[1000.0, 600.0, 300.0], breakaway=[0.5, 0.9, 0.9])

elements = st.lists(st.tuples(st.floats(1.0, 10.0), st.just(0.0) | st.floats(0.1, 2.0)), max_size=16)


def of(drawn: list[tuple[float, float]]) -> MaxwellSlip:
    return MaxwellSlip(stiffness=[k for k, _ in drawn], breakaway=[force for _, force in drawn])


gears = elements.map(of)
springs = st.floats(1.0, 100.0)
paths = st.lists(st.floats(-1.0, 1.0), min_size=1, max_size=12).map(lambda turns: np.append(0.0, turns))


def test_the_inverse_of_three_elements_and_a_spring() -> None:
    plays = SLIP.inverse(500.0)
    assert plays.threshold == pytest.approx([0.0, 1.2, 2.6, 3.8], rel=1e-14, abs=0.0)
    weights = [1 / 2400, 1 / 1400 - 1 / 2400, 1 / 800 - 1 / 1400, 1 / 500 - 1 / 800]
    assert plays.weight == pytest.approx(weights, rel=1e-13, abs=0.0)


def test_no_element_leaves_the_spring() -> None:
    plays = MaxwellSlip().inverse(500.0)
    assert (plays.threshold, plays.weight) == ((0.0,), (1 / 500,))


@given(gears, springs, paths)
def test_the_twist_is_found_from_the_torque(gear: MaxwellSlip, spring: float, path: Array) -> None:
    twist = gear.inverse(spring).trace(gear.trace(path) + spring * path)
    assert twist == pytest.approx(path, rel=0.0, abs=1e-12)


@given(gears, springs, paths)
def test_the_torque_is_found_from_the_twist(gear: MaxwellSlip, spring: float, path: Array) -> None:
    torque = 10.0 * path
    twist = gear.inverse(spring).trace(torque)
    stiffest = spring + sum(gear.stiffness)
    assert gear.trace(twist) + spring * twist == pytest.approx(torque, rel=0.0, abs=1e-14 * stiffest * 10.0 / spring + 1e-12)


@given(elements, springs, paths)
def test_the_order_of_the_elements_does_not_matter(drawn: list[tuple[float, float]], spring: float, path: Array) -> None:
    in_order = sorted(drawn, key=lambda element: element[1] / element[0])
    one, other = of(drawn).inverse(spring), of(in_order).inverse(spring)
    assert one.threshold == pytest.approx(other.threshold, rel=1e-13, abs=1e-300)
    assert one.trace(10.0 * path) == pytest.approx(other.trace(10.0 * path), rel=0.0, abs=1e-12)


@given(gears, springs)
def test_thresholds_rise_and_no_weight_is_negative(gear: MaxwellSlip, spring: float) -> None:
    plays = gear.inverse(spring)
    assert plays.threshold[0] == 0.0
    assert min(np.diff(plays.threshold), default=0.0) >= 0.0
    assert min(plays.weight) >= 0.0
    assert sum(plays.weight) == pytest.approx(1.0 / spring, rel=1e-13, abs=0.0)


def test_elements_that_slip_together_are_one() -> None:
    together = MaxwellSlip(stiffness=[300.0, 700.0], breakaway=[0.15, 0.35]).inverse(500.0)
    one = MaxwellSlip(stiffness=[1000.0], breakaway=[0.5]).inverse(500.0)
    torque = [0.0, 0.5, 2.0, -1.0, 0.3]
    assert together.trace(torque) == pytest.approx(one.trace(torque), rel=1e-14, abs=1e-18)


def test_an_element_without_breakaway_adds_nothing() -> None:
    with_it = MaxwellSlip(stiffness=[5000.0, 1000.0], breakaway=[0.0, 0.5]).inverse(500.0)
    without = MaxwellSlip(stiffness=[1000.0], breakaway=[0.5]).inverse(500.0)
    torque = [0.0, 0.5, 2.0, -1.0, 0.3]
    assert with_it.trace(torque) == pytest.approx(without.trace(torque), rel=1e-14, abs=1e-18)


@pytest.mark.parametrize("spring", [0.0, -1.0])
def test_slipping_elements_without_a_spring_have_no_inverse(spring: float) -> None:
    with pytest.raises(ValueError, match="positive final slope"):
        SLIP.inverse(spring)


# Plays by themselves

plays = st.lists(st.tuples(st.just(0.0) | st.floats(0.01, 1.0), st.floats(0.1, 1.0)), max_size=17).map(
    lambda drawn: PrandtlIshlinskii(threshold=[r for r, _ in drawn], weight=[w for _, w in drawn])
)


@given(plays, paths)
def test_each_play_lags_by_its_threshold(law: PrandtlIshlinskii, path: Array) -> None:
    """A play by turning points: it moves only as it is pushed."""
    expected = []
    positions = [0.0] * len(law.weight)
    for torque in path:
        for j, width in enumerate(law.threshold):
            if torque - positions[j] > width:
                positions[j] = torque - width
            if positions[j] - torque > width:
                positions[j] = torque + width
        expected.append(sum(weight * position for weight, position in zip(law.weight, positions, strict=True)))
    assert law.trace(path) == pytest.approx(expected, rel=0.0, abs=1e-14 * (1.0 + sum(law.weight)))


@given(plays, paths)
def test_plays_are_odd(law: PrandtlIshlinskii, path: Array) -> None:
    assert law.trace(-path).tolist() == (-law.trace(path)).tolist()


@given(plays, paths, st.integers(0, 12))
def test_a_torque_path_can_be_interrupted(law: PrandtlIshlinskii, path: Array, where: int) -> None:
    where = min(where, len(path) - 1)
    middle = law.advance(path[: where + 1])
    assert law.trace(path[where:], state=middle).tolist() == law.trace(path)[where:].tolist()


@given(plays, paths)
def test_a_torque_path_and_not_its_sampling_decides(law: PrandtlIshlinskii, path: Array) -> None:
    fine = [path[0]]
    for old, new in itertools.pairwise(path):
        fine += [old + 0.25 * (new - old), old + 0.75 * (new - old), new]
    assert law.trace(fine)[::3] == pytest.approx(law.trace(path), rel=0.0, abs=1e-14 * (1.0 + sum(law.weight)))
