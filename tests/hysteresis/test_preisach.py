"""Preisach's law: against hysterons followed one by one, against the textbook's turning points, and its laws of memory."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence

import numpy as np
import pytest
from hypothesis import given, strategies as st
from numpy.typing import NDArray
from strainwave.hysteresis import GridDensity, PowerDensity, Preisach

Array = NDArray[np.float64]

UNIFORM = PowerDensity(limit=1.0, saturation=1.0, exponent=2.0)

exponents = st.integers(1, 9).map(float) | st.floats(1.0, 20.0)
powers = st.builds(PowerDensity, limit=st.floats(0.5, 2.0), saturation=st.floats(0.1, 10.0), exponent=exponents)
rows = st.integers(1, 10)
torques = st.just(0.0) | st.floats(0.01, 1.0)


def grid_of(n: int) -> st.SearchStrategy[GridDensity]:
    """Weights around one, on rows as wide as a power of two: their edges are exact."""
    count = n * (n + 1) // 2
    weights = st.lists(torques, min_size=count, max_size=count)
    return weights.map(lambda weight: GridDensity(limit=n * 2.0**-3, weight=weight))


grids = rows.flatmap(grid_of)
laws = (powers | grids).map(lambda density: Preisach(density=density))


def rows_of(density: GridDensity) -> int:
    return math.isqrt(2 * len(density.weight))


def capacity(law: Preisach) -> float:
    """Half the torque between the two saturations [N.m]."""
    density = law.density
    return density.saturation if isinstance(density, PowerDensity) else sum(density.weight)


def scaled(law: Preisach, path: Sequence[float] | Array) -> Array:
    """A path from rest, in units of the limit."""
    return np.append(0.0, law.density.limit * np.asarray(path))


def slack(law: Preisach) -> float:
    """What rounding leaves in torques [N.m]; times the limit, in works [J] of a few passages."""
    return 1e-12 * capacity(law) + 1e-300


paths = st.lists(st.floats(-1.5, 1.5), min_size=1, max_size=12)


# Numbers computed independently


@pytest.mark.parametrize("density", [UNIFORM, GridDensity(limit=1.0, weight=[1.0])])
def test_uniform_density_is_an_elastic_line_less_preisachs_relays(density: PowerDensity | GridDensity) -> None:
    """From negative saturation, relays of uniform density give .125, -.12, .005, .125, .62."""
    path = np.array([0.0, -1.0, 0.5, -0.2, 0.3, 0.5, 0.8])
    relays = 2.0 * path - Preisach(density=density).trace(path)
    assert relays[1:] == pytest.approx([-1.0, 0.125, -0.12, 0.005, 0.125, 0.62], rel=1e-14, abs=1e-15)


def test_preisachs_relays_as_torque_of_a_twist_would_give_out_energy() -> None:
    """Why the law is not the relays themselves: over a minor loop of width d they give out d^3 / 6, which this law takes in."""
    law = Preisach(density=UNIFORM)
    path = np.array([0.0, -1.0, 0.5, -0.2, 0.5])
    loss = np.diff(law.work(path))[-2:].sum()
    line = np.diff(path**2)[-2:].sum()
    assert loss == pytest.approx(0.7**3 / 6.0, rel=1e-13, abs=0.0)
    assert line - loss == pytest.approx(-(0.7**3) / 6.0, rel=1e-13, abs=0.0)


def hysterons(density: GridDensity, path: Sequence[int]) -> list[float]:
    """Torques along a path in half rows, from hysterons followed one by one, four to a cell and more on the diagonal.

    Each pushes forward from where its window is entered from below, back from where it is entered from above. The windows
    around the start that reach farther back have been entered from above, as after an oscillation that died out.
    """
    n = rows_of(density)
    weights = iter(density.weight)
    cells = {(i, j): next(weights) for i in range(n) for j in range(i + 1)}
    pairs = [(p, q) for p in range(2 * n) for q in range(p + 1)]
    end, begin = (np.array(side) + 0.5 - n for side in zip(*pairs, strict=True))
    carried = np.array([cells[p // 2, q // 2] * (0.5 if p // 2 == q // 2 and p > q else 0.25) for p, q in pairs])
    push = np.sign(end + begin)
    push[begin > 0.0] = -1.0
    push[end < 0.0] = 1.0
    start, torque = float(carried @ push), [0.0]
    for old, new in itertools.pairwise(path):
        low, high = min(old, new), max(old, new)
        met = ((low < end) & (end < high)) | ((low < begin) & (begin < high))
        push[met] = np.sign(new - old)
        torque.append(float(carried @ push) - start)
    return torque


lattices = st.shared(rows, key="rows").flatmap(lambda n: st.lists(st.integers(-n - 1, n + 1), min_size=1, max_size=12))
lattice_grids = st.shared(rows, key="rows").flatmap(grid_of)


@given(lattice_grids, lattices)
def test_a_grid_is_the_sum_of_its_hysterons(density: GridDensity, turns: list[int]) -> None:
    law, path = Preisach(density=density), [0, *turns]
    torque = law.trace(np.array(path) * density.limit / rows_of(density))
    assert torque == pytest.approx(hysterons(density, path), rel=0.0, abs=slack(law))


@given(lattice_grids, lattices)
def test_the_work_of_a_grid_is_torque_over_twist(density: GridDensity, turns: list[int]) -> None:
    """Between the edges of rows the torque is quadratic: Simpson's rule is exact."""
    law, half_row = Preisach(density=density), density.limit / rows_of(density)
    fine = [0.0]
    for old, new in itertools.pairwise([0, *turns]):
        fine += np.linspace(old, new, 2 * abs(new - old) + 1)[1:].tolist()
    torque = law.trace(np.array(fine) * half_row)
    steps = np.diff(np.array(fine))[::2] * half_row / 3.0
    simpson = np.append(0.0, np.cumsum(steps * (torque[:-2:2] + 4.0 * torque[1::2] + torque[2::2])))
    at = np.append(0, np.cumsum(np.abs(np.diff([0, *turns]))))
    work = law.work(np.array([0, *turns]) * half_row)
    assert work == pytest.approx(simpson[at], rel=0.0, abs=10.0 * slack(law) * density.limit)


def branch(density: PowerDensity, high: float, low: float) -> float:
    """Half the change of torque between two turning points."""
    high, low = (min(max(twist, -density.limit), density.limit) for twist in (high, low))
    return density.saturation * (1.0 - (1.0 - (high - low) / (2.0 * density.limit)) ** density.exponent)


def textbook(density: PowerDensity, path: Sequence[float]) -> float:
    """The torque at the end of a path: the farthest twist, then always the farthest back since."""
    far = max(range(len(path)), key=lambda i: (abs(path[i]), i))
    sense = 1.0 if path[far] > 0.0 else -1.0
    torque = sense * branch(density, abs(path[far]), -abs(path[far]))
    while far < len(path) - 1:
        sense = -sense
        back = max(range(far + 1, len(path)), key=lambda i: (sense * path[i], i))
        torque += sense * 2.0 * branch(density, *sorted((path[far], path[back]), reverse=True))
        far = back
    return torque


@given(powers, paths)
def test_a_power_density_follows_the_turning_points_of_the_textbook(density: PowerDensity, turns: list[float]) -> None:
    law = Preisach(density=density)
    path = scaled(law, turns)
    expected = [textbook(density, path[: i + 1].tolist()) for i in range(len(path))]
    assert law.trace(path) == pytest.approx(expected, rel=0.0, abs=slack(law))


@given(powers, st.floats(-12.0, -1.0))
def test_a_small_twist_keeps_its_digits(density: PowerDensity, decades: float) -> None:
    law, share = Preisach(density=density), 10.0**decades
    expected = -math.expm1(density.exponent * math.log1p(-share)) * density.saturation
    assert law.trace([0.0, share * density.limit])[1] == pytest.approx(expected, rel=1e-13, abs=0.0)


@given(st.floats(1.0, 20.0), st.floats(-12.0, -1.0))
def test_a_small_twist_keeps_the_digits_of_its_work(exponent: float, decades: float) -> None:
    """By quadrature of a torque that keeps its own."""
    law, twist = Preisach(density=PowerDensity(limit=1.0, saturation=1.0, exponent=exponent)), 10.0**decades
    nodes, weights = np.polynomial.legendre.leggauss(20)
    torque = -np.expm1(exponent * np.log1p(-twist * (nodes + 1.0) / 2.0))
    assert law.work([0.0, twist])[1] == pytest.approx(float(weights @ torque) * twist / 2.0, rel=1e-12, abs=0.0)


inner_paths = st.lists(st.floats(-0.9, 0.9), min_size=1, max_size=8)


@given(powers, inner_paths)
def test_the_work_of_a_power_density_is_torque_over_twist(density: PowerDensity, turns: list[float]) -> None:
    """By quadrature between all twists at which a turning point may be passed."""
    law = Preisach(density=density)
    path = scaled(law, turns)
    nodes, weights = np.polynomial.legendre.leggauss(40)
    known = np.concatenate((path, -path))
    fine, weight, ends = [0.0], [0.0], [0]
    for old, new in itertools.pairwise(path):
        inside = np.sort(known[(known > min(old, new)) & (known < max(old, new))])
        edges = [old, *(inside if new > old else inside[::-1]), new]
        for start, end in itertools.pairwise(edges):
            fine += ((start + end) / 2.0 + (end - start) / 2.0 * nodes).tolist()
            weight += ((end - start) / 2.0 * weights).tolist()
        fine.append(new)
        weight.append(0.0)
        ends.append(len(fine) - 1)
    quadrature = np.cumsum(law.trace(fine) * weight)[ends]
    assert law.work(path) == pytest.approx(quadrature, rel=0.0, abs=slack(law) * density.limit)


@given(powers, st.floats(0.01, 1.9))
def test_a_loop_loses_twice_the_width_of_every_window_within_it(density: PowerDensity, width: float) -> None:
    """Of the windows of width t, d - t lie within a loop of width d."""
    law, d = Preisach(density=density), width * density.limit
    path = [0.0, -density.limit, d - density.limit, -density.limit]
    loss = np.diff(law.work(path))[-2:].sum()
    p, full = density.exponent, 2.0 * density.limit
    nodes, weights = np.polynomial.legendre.leggauss(60)
    t = d * (nodes + 1.0) / 2.0
    hysterons_per_area = p * (p - 1.0) * density.saturation / full**2 * (1.0 - t / full) ** (p - 2.0)
    expected = float(weights @ (2.0 * t * (d - t) * hysterons_per_area)) * d / 2.0
    assert loss == pytest.approx(expected, rel=1e-10, abs=slack(law) * density.limit)


# What every density obeys


@given(laws, st.floats(1.0, 5.0), st.floats(1.0, 5.0))
def test_everything_slips_beyond_the_limit(law: Preisach, forward: float, back: float) -> None:
    torque = law.trace(scaled(law, [1.0, forward, 1.0, -1.0, -back]))
    assert torque[[2, 3]] == pytest.approx(torque[[1, 1]], rel=0.0, abs=slack(law))
    assert torque[1] - torque[4] == pytest.approx(2.0 * capacity(law), rel=1e-12, abs=1e-300)
    assert torque[5] == pytest.approx(torque[4], rel=0.0, abs=slack(law))


@given(laws, paths)
def test_from_rest_no_path_yields_work(law: Preisach, turns: list[float]) -> None:
    assert law.work(scaled(law, turns)).min() >= -10.0 * slack(law) * law.density.limit


@given(laws, paths, paths)
def test_every_cycle_costs_work(law: Preisach, history: list[float], turns: list[float]) -> None:
    """Once its turning points are the farthest since, a cycle leaves the memory as it was."""
    around = history[-1]
    cycle = scaled(law, [*turns, around])[1:]
    before = law.advance(np.concatenate((scaled(law, history), cycle)))
    path = np.append(law.density.limit * around, cycle)
    assert law.work(path, state=before)[-1] >= -20.0 * slack(law) * law.density.limit
    torque = law.trace(path, state=before)
    assert torque[-1] == pytest.approx(torque[0], rel=0.0, abs=slack(law))


@given(laws, paths)
def test_torque_follows_the_motion(law: Preisach, turns: list[float]) -> None:
    path = scaled(law, turns)
    assert (np.sign(np.diff(path)) * np.diff(law.trace(path))).min() >= -slack(law)


@given(laws, paths, st.lists(st.floats(0.0, 1.0), min_size=1, max_size=5))
def test_a_path_and_not_its_sampling_decides(law: Preisach, turns: list[float], shares: list[float]) -> None:
    path = scaled(law, turns)
    inner = path[:-1, None] + np.diff(path)[:, None] * np.sort(shares)
    fine = np.append(np.column_stack((path[:-1], inner)).ravel(), path[-1])
    every = slice(None, None, len(shares) + 1)
    assert law.trace(fine)[every] == pytest.approx(law.trace(path), rel=0.0, abs=slack(law))
    assert law.work(fine)[every] == pytest.approx(law.work(path), rel=0.0, abs=10.0 * slack(law) * law.density.limit)


@given(laws, paths, st.integers(0, 12))
def test_a_path_can_be_interrupted(law: Preisach, turns: list[float], where: int) -> None:
    path = scaled(law, turns)
    where = min(where, len(path) - 1)
    middle = law.advance(path[: where + 1])
    assert law.trace(path[where:], state=middle).tolist() == law.trace(path)[where:].tolist()
    assert law.advance(path[where:], state=middle) == law.advance(path)


@given(laws, paths, st.floats(-0.9, 0.9), st.floats(0.0, 1.0), st.floats(0.0, 1.0), st.floats(0.0, 1.0))
def test_a_minor_loop_closes_and_is_forgotten(
    law: Preisach, history: list[float], low: float, ahead: float, back: float, again: float
) -> None:
    """Wiping-out, of the loops within the loop too; whatever came before the branch that the loop is on."""
    top = low + ahead * (1.6 - low)
    bottom = top - back * (top - low)
    inside = [bottom, bottom + again * (top - bottom), bottom + 0.5 * again * (top - bottom)]
    before, after = [*history, 1.6, low, top], [top, 1.6, 2.0, -2.0]
    with_loop = law.trace(scaled(law, [*before, *inside, *after]))[-4:]
    without = law.trace(scaled(law, [*before, *after]))[-4:]
    assert with_loop == pytest.approx(without, rel=0.0, abs=slack(law))


@given(laws, paths, paths, st.floats(-1.0, 1.0), st.floats(-1.0, 1.0))
def test_loops_between_the_same_twists_are_congruent(
    law: Preisach, one: list[float], other: list[float], a: float, b: float
) -> None:
    """Whatever came before; once each has been turned at, so that the initial curve is left."""
    shapes = []
    for history in (one, other):
        turns = [*history, 1.5, -1.5, a, b, a, 0.5 * (a + b), b]
        shapes.append(np.diff(law.trace(scaled(law, turns)))[-3:])
    assert shapes[0] == pytest.approx(shapes[1], rel=0.0, abs=2.0 * slack(law))


@given(laws, st.lists(st.floats(-0.2, 0.2), min_size=1, max_size=5), st.floats(0.05, 0.3))
def test_loops_within_different_larger_loops_are_congruent(law: Preisach, history: list[float], width: float) -> None:
    shapes = []
    for turns in ([1.0, 0.0, width, 0.0], [*history, -1.0, width, 0.0, width, 0.0], [0.9, -0.8, 0.6, 0.0, width, 0.0]):
        shapes.append(np.diff(law.trace(scaled(law, turns)))[-2:])
    for shape in shapes[1:]:
        assert shape == pytest.approx(shapes[0], rel=0.0, abs=2.0 * slack(law))


# What some densities obey


@given(powers, paths)
def test_a_power_density_is_odd(density: PowerDensity, turns: list[float]) -> None:
    law = Preisach(density=density)
    path = scaled(law, turns)
    assert law.trace(-path).tolist() == (-law.trace(path)).tolist()
    assert law.work(-path) == pytest.approx(law.work(path), rel=0.0, abs=slack(law) * density.limit)


@given(grids, paths)
def test_a_symmetric_grid_is_odd(density: GridDensity, turns: list[float]) -> None:
    n = rows_of(density)
    place = {cell: k for k, cell in enumerate((i, j) for i in range(n) for j in range(i + 1))}
    mirrored = [density.weight[place[n - 1 - j, n - 1 - i]] for i, j in place]
    law = Preisach(density=density.replace(weight=(np.array(density.weight) + mirrored).tolist()))
    path = scaled(law, turns)
    assert law.trace(-path) == pytest.approx(-law.trace(path), rel=0.0, abs=slack(law))
    assert law.work(-path) == pytest.approx(law.work(path), rel=0.0, abs=10.0 * slack(law) * density.limit)


@given(powers, st.floats(0.01, 1.0), st.floats(0.0, 1.0))
def test_a_power_density_obeys_masing(density: PowerDensity, amplitude: float, share: float) -> None:
    """After a reversal the branch is the initial curve, twice as large."""
    law = Preisach(density=density)
    torque = law.trace(scaled(law, [amplitude, amplitude * (1.0 - 2.0 * share)]))
    virgin = law.trace(scaled(law, [amplitude * share]))[1]
    assert torque[2] == pytest.approx(torque[1] - 2.0 * virgin, rel=0.0, abs=slack(law))


def test_an_asymmetric_grid_has_asymmetric_loops() -> None:
    """By hand: 2.5 N.m of the 3 between the saturations lie on the positive side, and the branches differ at the same twist."""
    law = Preisach(density=GridDensity(limit=1.0, weight=[0.0, 0.5, 1.0]))
    assert law.trace([0.0, 1.0, 0.0, -1.0, 0.0, 1.0]) == pytest.approx([0.0, 2.5, -0.5, -0.5, 0.5, 2.5], abs=1e-15)


# Memory and its bounds


@given(laws)
def test_a_twist_that_turns_back_too_often_is_followed_all_the_same(law: Preisach) -> None:
    """200 reversals, each closer: continuous, monotone, and the outer turning points are still returned to."""
    turns = [0.9 * (-1.0) ** k * (1.0 - k / 201.0) for k in range(200)]
    path = scaled(law, turns)
    fine = np.interp(np.arange(8 * len(path) - 7) / 8.0, np.arange(len(path)), path)
    torque, stiffest = law.trace(fine), initial_stiffness(law)
    assert np.abs(np.diff(torque)).max() <= stiffest * np.abs(np.diff(fine)).max() + slack(law)
    assert (np.sign(np.diff(fine)) * np.diff(torque)).min() >= -slack(law)
    assert law.trace(path) == pytest.approx(torque[::8], rel=0.0, abs=slack(law))
    outer = list(range(0, 30, 2))[::-1]
    back = law.trace(scaled(law, [*turns, *(turns[k] for k in outer)]))[-len(outer) :]
    assert back == pytest.approx(law.trace(path)[1:][outer], rel=0.0, abs=slack(law))


def initial_stiffness(law: Preisach) -> float:
    """A bound [N.m/rad] on the slope right after any reversal."""
    density = law.density
    if isinstance(density, PowerDensity):
        return density.exponent * density.saturation / density.limit
    n = rows_of(density)
    return 4.0 * sum(density.weight) * n / (2.0 * density.limit)


@given(laws, st.integers(1, 15), st.floats(0.0, 0.05))
def test_beyond_the_last_turning_point_kept_nothing_is_lost_or_gained(law: Preisach, extra: int, width: float) -> None:
    turns = [0.9 * (-1.0) ** k * (1.0 - k / 50.0) for k in range(31 + extra)]
    before = law.advance(scaled(law, turns))
    x = law.density.limit * turns[-1]
    loop = np.array([x, x - np.sign(x) * width * law.density.limit, x])
    assert law.work(loop, state=before)[-1] == pytest.approx(0.0, abs=slack(law) * law.density.limit)
    assert law.trace(loop, state=before)[2] == pytest.approx(law.trace(loop, state=before)[0], rel=0.0, abs=slack(law))


@given(powers, st.integers(1, 32))
def test_sixteen_maxima_and_minima_are_kept(density: PowerDensity, reversals: int) -> None:
    law = Preisach(density=density)
    path = scaled(law, [0.9 * (-1.0) ** k * (1.0 - k / 50.0) for k in range(reversals)])
    assert law.trace(path)[-1] == pytest.approx(textbook(density, path.tolist()), rel=0.0, abs=slack(law))


def test_no_density_is_no_hysteresis() -> None:
    law = Preisach(density=GridDensity(limit=1.0, weight=[]))
    assert law.trace([0.0, 0.5, -2.0]).tolist() == [0.0, 0.0, 0.0]
    assert law.work([0.0, 0.5, -2.0]).tolist() == [0.0, 0.0, 0.0]


@pytest.mark.parametrize("count", [2, 4, 5, 54])
def test_weights_that_fill_no_triangle_are_refused(count: int) -> None:
    with pytest.raises(ValueError, match="weight must have 1, 3, 6, 10"):
        GridDensity(limit=1e-3, weight=[1.0] * count)


def test_a_memory_that_no_path_leaves_is_refused() -> None:
    with pytest.raises(ValueError, match="must enclose the twist"):
        Preisach.State(twist=1e-3)


@given(laws, paths)
def test_every_memory_that_a_path_leaves_can_be_written_down(law: Preisach, turns: list[float]) -> None:
    state = law.advance(scaled(law, turns))
    assert Preisach.State(maximum=state.maximum, minimum=state.minimum, twist=state.twist) == state
