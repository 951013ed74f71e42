"""What every hysteresis obeys: passive, odd, a path and not its sampling; and the memory of those that have one.

Rate independence is structural: no model is told the time.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given, strategies as st
from numpy.typing import NDArray
from strainwave.hysteresis import FadingMemory, MaxwellSlip

from tests.support.strategies import built, log_uniform, models

Array = NDArray[np.float64]

laws = models("hysteresis")
storing = models("hysteresis", "stored")
maxwell = built(MaxwellSlip)
amplitudes = log_uniform(1e-5, 1e-1)


def paths_from_rest(points: int = 12) -> st.SearchStrategy[Array]:
    """Twists in any order, from 0, with reversals large and small."""
    turns = st.lists(st.floats(-1.0, 1.0).map(lambda turn: round(turn, 12)), min_size=2, max_size=points)
    return st.tuples(amplitudes, turns).map(lambda drawn: np.append(0.0, drawn[0] * np.array(drawn[1])))


def largest(law: Any, reach: float) -> float:
    """The largest torque [N.m] on a cycle of this reach; torques are rounded like it."""
    return float(np.abs(law.trace([0.0, reach, -reach, reach])).max())


def rounding(law: Any, path: Sequence[float] | Array) -> tuple[float, float]:
    """What a few operations, and the rounding of the path itself, leave in torques [N.m] and works [J] along it."""
    reach = float(np.abs(path).max())
    if reach == 0.0:
        return 0.0, 0.0
    grid = np.geomspace(1e-9 * reach, reach, 73)
    sweep = np.concatenate(([0.0], grid, grid[::-1], -grid, -grid[::-1], grid))
    steps = np.diff(sweep)
    steepest = float(np.max(np.abs(np.diff(law.trace(sweep))[steps != 0.0] / steps[steps != 0.0])))
    torque = 1e-13 * largest(law, reach) + 1e-15 * steepest * reach
    travel = float(np.abs(np.diff(path)).sum()) + (largest(law, reach) / steepest if steepest else 0.0)
    return torque, (torque + 4e-16 * largest(law, 10.0)) * travel


@given(laws, paths_from_rest())
def test_from_rest_no_path_yields_work(law: Any, path: Array) -> None:
    assert law.work(path).min() >= -rounding(law, path)[1]


@given(laws, paths_from_rest(6))
def test_a_cycle_in_twist_and_memory_costs_work(law: Any, path: Array) -> None:
    cycle = np.append(path, 0.0)
    before = law.advance(np.tile(cycle, 300))
    after = law.advance(cycle, state=before)
    members = [np.array([getattr(state, field["name"]) for state in (before, after)]) for field in type(before).fields]
    size = min(largest(law, np.abs(cycle).max()), 1.0)
    assume(all(np.ptp(member, axis=0).max() <= 1e-12 * size for member in members))
    assert law.work(cycle, state=before)[-1] >= -10.0 * rounding(law, cycle)[1]


@given(models("hysteresis", odd=True), paths_from_rest())
def test_hysteresis_is_odd_in_the_twist(law: Any, path: Array) -> None:
    assert law.trace(-path).tolist() == (-law.trace(path)).tolist()
    assert law.work(-path).tolist() == law.work(path).tolist()


@given(laws, paths_from_rest(), st.lists(st.floats(0.0, 1.0), min_size=1, max_size=5))
def test_a_path_and_not_its_sampling_decides(law: Any, path: Array, shares: list[float]) -> None:
    inner = path[:-1, None] + np.diff(path)[:, None] * np.sort(shares)
    fine = np.append(np.column_stack((path[:-1], inner)).ravel(), path[-1])
    every = slice(None, None, len(shares) + 1)
    torque, work = rounding(law, path)
    np.testing.assert_allclose(law.trace(fine)[every], law.trace(path), rtol=0.0, atol=torque)
    np.testing.assert_allclose(law.work(fine)[every], law.work(path), rtol=0.0, atol=work)


@given(laws, paths_from_rest(), st.integers(1, 10))
def test_a_path_can_be_interrupted(law: Any, path: Array, where: int) -> None:
    where = min(where, len(path) - 1)
    middle = law.advance(path[: where + 1])
    assert law.trace(path[where:], state=middle).tolist() == law.trace(path)[where:].tolist()
    assert law.advance(path[where:], state=middle) == law.advance(path)


@given(laws, paths_from_rest())
def test_work_is_torque_over_twist(law: Any, path: Array) -> None:
    """Mean value theorem; the torque is monotone between points, so that its ends bound the mean."""
    torque, work, step = law.trace(path), law.work(path), np.diff(path)
    ends = np.sort(np.stack((torque[:-1] * step, torque[1:] * step)), axis=0)
    slack = rounding(law, path)[1]
    assert np.all(np.diff(work) >= ends[0] - slack)
    assert np.all(np.diff(work) <= ends[1] + slack)


@given(laws, paths_from_rest())
def test_torque_follows_the_motion(law: Any, path: Array) -> None:
    moved = np.sign(np.diff(path)) * np.diff(law.trace(path))
    assert moved.min() >= -rounding(law, path)[0]


@given(storing, paths_from_rest())
def test_work_is_stored_or_dissipated_and_what_is_dissipated_never_comes_back(law: Any, path: Array) -> None:
    stored = law.stored(path)
    dissipated = law.work(path) - stored
    assert stored.min() >= 0.0
    assert dissipated[0] == 0.0
    assert np.diff(dissipated).min() >= -rounding(law, path)[1]


# What some claim: the memory of a gear


def virgin(law: Any, twist: float) -> float:
    return float(law.trace([0.0, twist])[-1])


@given(models("hysteresis", masing=True), amplitudes, st.floats(0.0, 1.0))
def test_masing(law: Any, amplitude: float, share: float) -> None:
    """After a reversal the branch is the virgin curve, twice as large: Masing1926."""
    path = [0.0, amplitude, amplitude * (1.0 - 2.0 * share)]
    expected = virgin(law, amplitude) - 2.0 * virgin(law, amplitude * share)
    assert law.trace(path)[-1] == pytest.approx(expected, rel=0.0, abs=rounding(law, path)[0])


@given(models("hysteresis", return_point_memory=True), amplitudes, st.floats(0.0, 1.0))
def test_a_path_returns_to_the_point_it_left(law: Any, amplitude: float, share: float) -> None:
    """A minor loop within a larger one closes, and is forgotten from then on: wiping-out."""
    path = amplitude * np.array([0.0, 1.5, -1.5, 1.0, 1.0 - 2.0 * share, 1.0, 2.0, -1.0])
    slack = rounding(law, path)[0]
    with_loop, without = law.trace(path), law.trace(np.delete(path, [4, 5]))
    assert with_loop[5] == pytest.approx(with_loop[3], rel=0.0, abs=slack)
    assert with_loop[6:] == pytest.approx(without[4:], rel=0.0, abs=slack)


@given(models("hysteresis", return_point_memory=True), st.lists(st.floats(0.0, 1.0), min_size=3, max_size=8), amplitudes)
def test_what_a_larger_loop_wipes_out_is_forgotten(law: Any, turns: list[float], amplitude: float) -> None:
    """Whatever happens between the two turning points of a loop, beyond them it never was."""
    history = amplitude * np.concatenate(([0.0, 1.0, -1.0], np.array(turns), [1.0]))
    beyond = amplitude * np.array([1.5, -2.0, 0.5])
    slack = rounding(law, np.append(history, beyond))[0]
    remembered = law.trace(np.append(history, beyond))[-3:]
    forgotten = law.trace(np.append(amplitude * np.array([0.0, 1.0, -1.0, 1.0]), beyond))[-3:]
    assert remembered == pytest.approx(forgotten, rel=0.0, abs=slack)


@given(models("hysteresis", congruent=True), paths_from_rest(), paths_from_rest(), amplitudes)
def test_loops_are_congruent(law: Any, one: Array, other: Array, width: float) -> None:
    """Loops between the same two twists are equal in shape, whatever came before."""
    paths = [np.append(history, [0.0, width, 0.0, width]) for history in (one, other)]
    shapes = [np.diff(law.trace(path))[-2:] for path in paths]
    assert shapes[0] == pytest.approx(shapes[1], rel=0.0, abs=2.0 * max(rounding(law, path)[0] for path in paths))


# Maxwell slip


@given(maxwell, amplitudes)
def test_maxwell_slip_loses_what_slides(law: MaxwellSlip, amplitude: float) -> None:
    """Steady loss of a cycle: the sum of 4 F_i (X - F_i / k_i) over the elements that slip."""
    path = [0.0, amplitude, -amplitude, amplitude]
    work = law.work(path)
    pairs = zip(law.stiffness, law.breakaway, strict=True)
    loss = sum(4.0 * force * max(amplitude - force / stiffness, 0.0) for stiffness, force in pairs)
    assert work[3] - work[1] == pytest.approx(loss, rel=0.0, abs=rounding(law, path)[1])


# Fading memory: what it cannot do


@given(built(FadingMemory), st.floats(0.1, 3.0), st.floats(0.1, 3.0))
def test_minor_loops_of_fading_memory_do_not_close(law: FadingMemory, far: float, back: float) -> None:
    """With twists in 1 / alpha, torques in A / alpha, the gap at t = 1 - e^-f is 1 - 2 e^-b + (1 + t) e^-2b - t."""
    scale = 1.0 / max(law.forgetting, default=1.0)
    torque = law.trace(scale * np.array([0.0, far, far - back, far]))
    gap = 0.0
    for stiffness, forgetting in zip(law.stiffness, law.forgetting, strict=True):
        reach, turn = far * scale * forgetting, back * scale * forgetting
        start = -math.expm1(-reach)
        gap += stiffness / forgetting * (1.0 - 2.0 * math.exp(-turn) + (1.0 + start) * math.exp(-2.0 * turn) - start)
    assert torque[3] - torque[1] == pytest.approx(gap, rel=0.0, abs=1e-12 * largest(law, 10.0 * scale))
