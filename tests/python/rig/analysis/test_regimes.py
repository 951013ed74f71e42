"""Where a loop is cut, wherever it begins, however it drifts, and what is refused."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from strainwave.rig import Loop, cycles
from strainwave.rig.analysis.regimes import NAMES, segment

from tests.python.rig.loops import PEAK, loop_of_table, parallelogram, straight


def loop(angle: np.ndarray, torque: np.ndarray, **more: object) -> Loop:
    return Loop(angle, torque, side="output", name="loop", **more)  # type: ignore[arg-type]


def begun_at(row: int, whole: Loop) -> Loop:
    """The same cycle, begun at another of its points."""
    order = np.roll(np.arange(len(whole) - 1), -row)
    order = np.append(order, order[0])
    return loop(whole.angle[order], whole.torque[order])


def test_the_regimes_are_the_quarters_of_the_cycle() -> None:
    cut = segment(loop_of_table())
    assert tuple(regime.name for regime in cut.regimes) == NAMES
    assert cut.closed
    assert cut.remarks == ()
    ends = [(regime.torque[0], regime.torque[-1]) for regime in cut.regimes]
    assert ends == [(0.0, PEAK), (-PEAK, 0.0), (-PEAK, 0.0), (0.0, PEAK)]
    angles = [np.degrees(regime.angle[[0, -1]]) for regime in cut.regimes]  # the corners of physics, section 8
    assert np.concatenate(angles) == pytest.approx(
        [-4.573499, 0.0, -59.326382, -4.573499, -59.326382, -55.073499, -55.073499, 0.0], abs=1e-6
    )


@pytest.mark.parametrize("row", range(0, 72, 5))
def test_it_does_not_matter_where_the_cycle_begins(row: int) -> None:
    whole = loop_of_table()
    cut = segment(begun_at(row, whole))
    assert cut.closed
    for found, known in zip(cut.regimes, segment(whole).regimes, strict=True):
        assert (found.name, found.torque.tolist()) == (known.name, known.torque.tolist())
        assert found.angle == pytest.approx(known.angle, abs=1e-12)


def test_a_first_loading_is_no_part_of_the_cycle() -> None:
    whole = loop_of_table()
    first = np.linspace(0.0, PEAK, 10, endpoint=False)
    cut = segment(loop(np.append(first - PEAK, whole.angle), np.append(first, whole.torque)))
    assert cut.cycle.tolist() == list(range(10, 10 + len(whole)))
    assert len(cut.regimes) == 4


def test_of_several_cycles_each_can_be_had() -> None:
    whole = loop_of_table()
    angle, torque = np.tile(whole.angle[:-1], 3), np.tile(whole.torque[:-1], 3)
    thrice = loop(np.append(angle, 0.0), np.append(torque, PEAK))
    assert segment(thrice).cycles == 3
    for each in cycles(thrice):
        assert each.angle == pytest.approx(whole.angle, abs=1e-12)
        assert np.array_equal(each.torque, whole.torque)
    assert cycles(whole) == [whole]


@settings(max_examples=50, deadline=None)
@given(drift=st.floats(-0.1, 0.1), gap=st.floats(-0.1, 0.1), seed=st.integers(0, 50))
def test_drift_gaps_and_noise_leave_the_regimes_where_they_are(drift: float, gap: float, seed: int) -> None:
    whole = loop_of_table()
    n = len(whole)
    noise = 2e-4 * np.random.default_rng(seed).normal(size=n)
    angle = whole.angle + drift * np.arange(n) / n + np.where(np.arange(n) > 60, gap, 0.0) + noise
    cut = segment(loop(angle, whole.torque))
    assert cut.closed
    assert [sorted(regime.rows.tolist()) for regime in cut.regimes] == [
        sorted(regime.rows.tolist()) for regime in segment(whole).regimes
    ]


def test_repeated_points_stay_in_their_regime() -> None:
    whole = loop_of_table()
    rows = np.sort(np.append(np.arange(len(whole)), [0, 5, 5, 18, 39, 50]))
    cut = segment(loop(whole.angle[rows], whole.torque[rows]))
    assert cut.closed
    assert [regime.torque[[0, -1]].tolist() for regime in cut.regimes] == [
        regime.torque[[0, -1]].tolist() for regime in segment(whole).regimes
    ]
    assert sum(len(regime.rows) for regime in cut.regimes) >= sum(len(regime.rows) for regime in segment(whole).regimes) + 4


def test_creep_at_the_peak_belongs_to_the_way_there() -> None:
    angle, torque = straight(2.0, 0.5, 1.0, 5)
    creeping = [0.05, 0.08, 0.1]
    angle = np.concatenate((angle[:-1], angle[0] - 0.25 + np.array(creeping), angle[-1:] + 0.1))
    torque = np.concatenate((torque[:-1], np.ones(3), torque[-1:]))
    cut = segment(loop(angle, torque))
    assert cut.rising is not None
    assert cut.rising.angle[-1] == pytest.approx(angle[-1])
    assert cut.rising.rows[-1] == len(angle) - 1


def test_a_level_stretch_ends_where_the_angle_turns() -> None:
    angle, torque = parallelogram(k=10.0, spring=0.0, slip=1.0, amplitude=1.0, points=7)
    cut = segment(loop(angle, torque))
    assert cut.falling is not None
    assert cut.rising is not None
    assert (cut.falling.angle[0], cut.falling.angle[-1]) == (pytest.approx(-1.0), pytest.approx(1.0))
    assert cut.falling.rows[0] == cut.rising.rows[0] == 14


def test_the_angle_at_zero_torque_is_read_between_its_neighbours() -> None:
    cut = segment(loop(np.array([2.0, 1.0, -3.0, -2.0, 2.1]), np.array([2.0, 1.0, -3.0, -1.0, 2.0]), angle_sigma=0.1))
    regime = cut.regimes[0]
    assert regime.torque.tolist() == [0.0, 1.0, 2.0]
    assert regime.angle[0] == pytest.approx(0.0)  # a quarter of the way from 1 to -3
    assert regime.angle_sigma[0] == pytest.approx(0.1 * np.hypot(0.75, 0.25))
    assert regime.measured.tolist() == [False, True, True]


def test_a_smaller_loop_on_the_way_is_left_out_and_told() -> None:
    whole = loop_of_table()
    detour = [30, 29, 28, 27, 28, 29]
    rows = np.concatenate((np.arange(31), detour[1:], np.arange(30, len(whole))))
    cut = segment(loop(whole.angle[rows], whole.torque[rows]))
    assert any("turns back at point 31" in remark for remark in cut.remarks)
    assert [regime.torque.tolist() for regime in cut.regimes][1].count(whole.torque[28]) == 1
    assert cut.closed


def test_a_step_left_out_is_told_where_it_is() -> None:
    angle, torque = straight(2.0, 0.5, 1.0, 10)
    keep = np.arange(len(angle)) != 5
    (remark,) = segment(loop(angle[keep], torque[keep])).remarks
    assert remark.startswith("the torque changes between points 5 and 6 by 0.2 N.m, and by 0.1 N.m as a rule")


def test_steps_left_out_are_told_together() -> None:
    angle, torque = straight(2.0, 0.5, 1.0, 20)
    keep = ~np.isin(np.arange(len(angle)), [5, 9, 13, 17, 25, 29])
    (remark,) = segment(loop(angle[keep], torque[keep])).remarks
    assert remark.count("by 0.1 N.m") == 4
    assert "and 2 more" in remark


def test_one_branch_has_the_regimes_it_has() -> None:
    whole = loop_of_table()
    half = segment(loop(whole.angle[:39], whole.torque[:39]))
    assert [regime.name for regime in half.regimes] == ["positive_unloading", "negative_loading"]
    assert not half.closed
    assert half.remarks[-1] == "not measured from zero torque to the peak: negative unloading, positive loading"


def test_a_loop_of_one_sign_has_two_regimes() -> None:
    angle, torque = straight(2.0, 0.5, 1.0, 5)
    cut = segment(loop(angle, torque + 1.0))
    assert [regime.name for regime in cut.regimes] == ["positive_unloading", "positive_loading"]


def test_a_branch_that_begins_a_little_beyond_zero_says_so() -> None:
    torque = np.linspace(0.05, 1.0, 20)
    cut = segment(loop(torque / 2.0, torque))
    assert not cut.regimes[0].from_zero
    assert "it has no secant from zero torque" in cut.remarks[-1]


def test_a_cycle_cut_short_is_not_closed() -> None:
    whole = loop_of_table()
    cut = segment(loop(whole.angle[:60], whole.torque[:60]))
    assert not cut.closed
    assert [regime.name for regime in cut.regimes] == ["positive_unloading", "negative_loading", "negative_unloading"]


WHOLE = loop_of_table()


@pytest.mark.parametrize(
    ("angle", "torque", "message"),
    [
        ([0.0, 1.0], [0.0, 1.0], "2 points are no loop"),
        ([0.0, 1.0, 2.0], [1.0, 1.0, 1.0], "the torque is 1 N.m throughout"),
        ([1.0, 1.0, 1.0], [0.0, 1.0, 2.0], "the angle is 1 rad throughout"),
        ([3.0, 2.0, -3.0, -2.0, 3.0], [-1.0, 0.0, 1.0, 0.0, -1.0], "the torque falls as the angle grows"),
    ],
)
def test_what_is_no_loop_is_refused(angle: list[float], torque: list[float], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        segment(loop(np.array(angle), np.array(torque)))


@pytest.mark.parametrize("by", ["torque", "angle"])
def test_sorted_points_are_refused(by: str) -> None:
    order = np.argsort(getattr(WHOLE, by), kind="stable")
    with pytest.raises(ValueError, match="put the points in the order measured"):
        segment(loop(WHOLE.angle[order], WHOLE.torque[order]))


@pytest.mark.parametrize("step", [0.06, 0.12])
@pytest.mark.parametrize("by", ["torque", "angle"])
@pytest.mark.parametrize("sense", [1, -1])
def test_sorted_points_of_a_short_loop_are_refused(by: str, sense: int, step: float) -> None:
    short = loop_of_table(step=step)
    order = np.argsort(sense * getattr(short, by), kind="stable")
    with pytest.raises(ValueError, match=f"sorted by {by}|order measured, not sorted"):
        segment(loop(short.angle[order], short.torque[order]))


@pytest.mark.parametrize("by", ["torque", "angle"])
def test_a_narrow_loop_that_is_sorted_is_told(by: str) -> None:
    angle, torque = parallelogram(k=1.0, spring=50.0, slip=1.0, amplitude=2.0, points=30)
    order = np.argsort(angle if by == "angle" else torque, kind="stable")
    first, *_ = segment(loop(angle[order], torque[order])).remarks
    assert f"if the file holds a whole loop, it was sorted by {by}" in first


@settings(max_examples=50, deadline=None)
@given(seed=st.integers(0, 1000), noise=st.floats(0.0, 0.01))
def test_one_way_with_noise_is_not_taken_for_a_sorted_loop(seed: int, noise: float) -> None:
    torque = np.linspace(-1.0, 1.0, 20)
    cut = segment(loop(torque + noise * np.random.default_rng(seed).normal(size=20), torque))
    assert not any("was sorted" in remark for remark in cut.remarks)


@settings(max_examples=50, deadline=None)
@given(seed=st.integers(0, 1000))
def test_shuffled_points_are_refused(seed: int) -> None:
    order = np.random.default_rng(seed).permutation(len(WHOLE))
    with pytest.raises(ValueError, match="put the points in the order measured"):
        segment(loop(WHOLE.angle[order], WHOLE.torque[order]))


def test_times_that_fall_are_refused() -> None:
    time = np.arange(float(len(WHOLE)))
    time[[3, 4]] = time[[4, 3]]
    with pytest.raises(ValueError, match=r"time\[4\] = 3 s is before time\[3\] = 4 s"):
        segment(loop(WHOLE.angle, WHOLE.torque, time=time))
