"""Presliding loops and breakaway: truths of closed form are found as well as is said."""

from __future__ import annotations

import sys
from itertools import pairwise

import numpy as np
import pytest
import strainwave as sw
from numpy.typing import NDArray
from strainwave.identification.candidates.presliding import (
    BreakawayPoint,
    PreslidingLoop,
    breakaway_torque,
    breakaways,
    fit_presliding,
)

Array = NDArray[np.float64]

TURNS = [0.0, 1.0, -1.0, 0.4, -0.4, 0.7, -0.7, 1.0, -1.0, 0.2, -0.2, 1.0]  # of the amplitude


def path(amplitude: float, samples: int = 30) -> Array:
    """To and fro with several amplitudes [rad]."""
    return amplitude * np.concatenate([np.linspace(a, b, samples, endpoint=False) for a, b in pairwise(TURNS)])


def bristle(angle: Array, stiffness: float, level: float) -> Array:
    """The closed form between reversals, virgin at the start (physics of the Dahl model, order 1)."""
    torque, carried, start = np.empty_like(angle), 0.0, 0
    turns = [i for i in range(1, len(angle) - 1) if (angle[i] - angle[i - 1]) * (angle[i + 1] - angle[i]) < 0.0]
    for end in (*turns, len(angle) - 1):
        way = angle[start : end + 1] - angle[start]
        sense = np.sign(way[-1])
        torque[start : end + 1] = sense * level + (carried - sense * level) * np.exp(-stiffness * np.abs(way) / level)
        carried, start = torque[end], end
    return torque


def elements(angle: Array, stiffness: Array, level: Array) -> Array:
    """Jenkins elements, sample by sample."""
    carried, torque = np.zeros(len(stiffness)), []
    for step in np.diff(angle, prepend=angle[0]):
        carried = np.clip(carried + stiffness * step, -level, level)
        torque.append(carried.sum())
    return np.array(torque)


def noisy(angle: Array, torque: Array, random: np.random.Generator) -> PreslidingLoop:
    spread = 0.01 * float(np.abs(torque).max())
    return PreslidingLoop.along(angle, torque + 0.003 + spread * random.normal(size=len(torque)))


def bristle_off(seed: int) -> Array:
    random = np.random.default_rng(seed)
    stiffness, level = random.uniform(20.0, 80.0), random.uniform(0.03, 0.08)
    angle = path(random.uniform(2.0, 5.0) * level / stiffness)
    best = next(
        each
        for each in fit_presliding(noisy(angle, bristle(angle, stiffness, level), random), elements=1)
        if each.name == "bristle"
    )
    return np.array([(e.value - truth) / e.sigma for e, truth in zip(best.estimates, (stiffness, level), strict=True)])


def elements_off(seed: int) -> Array:
    random = np.random.default_rng(seed)
    reach = random.uniform(1e-3, 1.5e-3) * np.array([1.0, random.uniform(2.5, 4.0)])
    level = random.uniform(0.02, 0.05, 2)
    angle = path(1.5 * reach[1])
    found = fit_presliding(noisy(angle, elements(angle, level / reach, level), random), elements=2)
    best = next(each for each in found if each.name == "2 Maxwell elements")
    truth = [*(level / reach), *level]
    return np.array([(e.value - t) / e.sigma for e, t in zip(best.estimates, truth, strict=True)])


def calibrated(off: list[Array]) -> None:
    table = np.array(off)
    inside, scatter = np.mean(np.abs(table) <= 2.0, axis=0), np.sqrt(np.mean(table**2, axis=0))
    assert np.all(inside >= 0.9), inside
    assert np.all((scatter > 0.7) & (scatter < 1.4)), scatter


@pytest.mark.slow("identification")
def test_a_bristle_is_found_as_well_as_is_said() -> None:
    calibrated([bristle_off(seed) for seed in range(30)])


@pytest.mark.slow("identification")
def test_maxwell_elements_are_found_as_well_as_is_said() -> None:
    calibrated([elements_off(seed) for seed in range(30)])


@pytest.mark.slow("identification")
def test_the_model_that_made_a_loop_is_ranked_first() -> None:
    random = np.random.default_rng(5)
    angle = path(4e-3)
    first = [fit_presliding(noisy(angle, bristle(angle, 50.0, 0.05), random))[0].name for _ in range(3)]
    first += [
        fit_presliding(noisy(angle, elements(angle, np.array([30.0, 10.0]), np.array([0.03, 0.025])), random))[0].name
        for _ in range(3)
    ]
    assert first == 3 * ["bristle"] + 3 * ["2 Maxwell elements"]


def test_the_law_traces_the_loop_that_it_was_found_in() -> None:
    angle = path(4e-3)
    table = sw.friction.Stribeck(coulomb=0.04, breakaway=0.055, stribeck_speed=3.0, viscous=2e-4)
    torque = elements(angle, np.array([30.0, 10.0]), np.array([0.03, 0.025]))
    best = fit_presliding(PreslidingLoop.along(angle, torque))[0]
    law = best.law(table)
    assert (law.coulomb, law.breakaway, law.viscous) == pytest.approx((0.04, 0.055, 2e-4), rel=1e-6)
    assert law.quasistatic(angle) == pytest.approx(torque, abs=1e-6)
    bent = fit_presliding(PreslidingLoop.along(angle, bristle(angle, 50.0, 0.055)))[0].law(table)
    assert isinstance(bent, sw.friction.LuGre)
    assert bent.quasistatic(angle) == pytest.approx(bristle(angle, 50.0, 0.055), abs=1e-6)


def test_a_coarse_encoder_makes_the_stiffness_smaller_by_what_is_said() -> None:
    """A step of a tenth of the reach of the stiffer element: some three percent, and the level within one."""
    angle, random = path(4e-3, 200), np.random.default_rng(0)
    torque = elements(angle, np.array([30.0, 10.0]), np.array([0.03, 0.025])) + 5e-4 * random.normal(size=len(angle))
    step = 1e-4
    read = np.round((angle + 2e-5 * random.normal(size=len(angle))) / step) * step
    found = next(each for each in fit_presliding(PreslidingLoop.along(read, torque), elements=2) if len(each.estimates) == 4)
    assert 0.95 * 40.0 < found.stiffness < 40.0
    assert found.breakaway == pytest.approx(0.055, rel=0.01)


def test_a_loop_that_never_slides_says_so() -> None:
    angle = path(2e-4)
    small = fit_presliding(PreslidingLoop.along(angle, elements(angle, np.array([30.0]), np.array([0.03]))))
    assert next(each for each in small if each.name == "1 Maxwell element").reach <= 1.0
    assert next(each for each in small if each.name == "1 Maxwell element").stiffness == pytest.approx(30.0, rel=1e-3)


def test_a_path_that_does_not_turn_back_is_refused() -> None:
    recording = sw.Recording({"angle": [0.0, 1e-3, 2e-3], "torque": [0.0, 0.1, 0.2]}, {"angle": "rad", "torque": "N.m"})
    with pytest.raises(ValueError, match="turns back 0 times"):
        PreslidingLoop.of(recording)


def ramp(
    breakaway: float, coulomb: float, rate: float, inertia: float = 1e-3, spring: float = 60.0
) -> tuple[Array, Array, Array]:
    """Torque r t on a shaft that bends by T / k while it sticks and then obeys J w' = r t - F_c: its closed form."""
    begun = breakaway / rate
    time = np.arange(0.0, begun + 0.15, 1e-3)
    late = np.maximum(time - begun, 0.0)
    angle = np.minimum(rate * time, breakaway) / spring
    return time, rate * time, angle + ((breakaway - coulomb) * late**2 / 2.0 + rate * late**3 / 6.0) / inertia


def ramps(*cases: tuple[float, float, float, int], noise: float, seed: int = 0) -> sw.Recording:
    """Ramps one after the other, each followed by rest where it ended."""
    columns: list[list[Array]] = [[], [], []]
    now, place = 0.0, 0.3
    for breakaway, coulomb, rate, way in cases:
        time, torque, angle = ramp(breakaway, coulomb, rate)
        rest = np.arange(1, 300) * 1e-3
        columns[0] += [now + time, now + time[-1] + rest]
        columns[1] += [way * torque, 0.0 * rest]
        columns[2] += [place + way * angle, place + way * angle[-1] + 0.0 * rest]
        now, place = float(columns[0][-1][-1]) + 1e-3, float(columns[2][-1][-1])
    time, torque, angle = map(np.concatenate, columns)
    random = np.random.default_rng(seed)
    angle = angle + noise * random.normal(size=len(angle))
    torque = torque + 2e-4 * random.normal(size=len(torque))
    return sw.Recording({"time": time, "torque": torque, "angle": angle}, {"time": "s", "torque": "N.m", "angle": "rad"})


@pytest.mark.parametrize("noise", [0.0, 1e-5])
def test_breakaway_of_each_ramp_is_where_the_shaft_began_to_move(noise: float) -> None:
    cases = [(0.06, 0.045, 0.05, 1), (0.05, 0.04, 0.05, -1), (0.062, 0.045, 0.1, 1), (0.051, 0.04, 0.2, -1)]
    found = breakaways(ramps(*cases, noise=noise))
    assert [each.torque for each in found] == pytest.approx([way * level for level, _, _, way in cases], rel=0.02)
    assert [each.rate for each in found] == pytest.approx([rate for *_, rate, _ in cases], rel=0.02)
    assert [each.bent for each in found] == pytest.approx([level / 60.0 for level, *_ in cases], rel=0.2)


def test_breakaway_has_an_interval_for_each_direction_that_holds_the_truth() -> None:
    off = []
    for seed in range(50):
        random = np.random.default_rng(seed)
        made = [
            BreakawayPoint(0.0, way * (level + 0.002 * random.normal()), 0.1, 0.0) for way, level in 8 * [(1, 0.06), (-1, 0.05)]
        ]
        found = breakaway_torque(made)
        assert found.slope is None
        off.append([(e.value - t) / e.sigma for e, t in ((found.forward, 0.06), (found.reverse, 0.05)) if e is not None])
    calibrated([np.array(each) for each in off])


def test_breakaway_that_falls_with_the_rate_has_a_slope() -> None:
    random = np.random.default_rng(1)
    rates = np.geomspace(0.01, 1.0, 12)
    made = [BreakawayPoint(0.0, 0.06 - 0.005 * np.log10(r / 0.1) + 2e-4 * random.normal(), r, 0.0) for r in rates]
    slope = breakaway_torque(made).slope
    assert slope is not None
    low, high = slope.interval(0.99)
    assert low < -0.005 < high < 0.0


def test_ramps_that_move_nothing_are_refused() -> None:
    time = np.arange(0.0, 1.0, 1e-3)
    still = sw.Recording(
        {"time": time, "torque": 0.01 * time, "angle": 0.0 * time + 0.3}, {"time": "s", "torque": "N.m", "angle": "rad"}
    )
    with pytest.raises(ValueError, match="no ramp of torque is followed by a motion"):
        breakaways(still)


if __name__ == "__main__":
    for off in (bristle_off, elements_off):
        table = np.array([off(seed) for seed in range(int(sys.argv[1]))])
        print(off.__name__, np.mean(np.abs(table) <= 2.0, axis=0).round(3), np.sqrt(np.mean(table**2, axis=0)).round(2))


def test_bristles_that_yield_before_they_slide_break_away_where_they_slide() -> None:
    """A shaft on a bristle bends without limit as the torque nears its breakaway; below, it has only yielded."""
    level, stiffness, rate = 10.0, 1.0e5, 0.5
    time = np.arange(0.0, 24.0, 0.015)
    torque = rate * time
    yielded = -level / stiffness * np.log1p(-np.minimum(torque, 0.999 * level) / level)
    slid = 0.02 * np.maximum(time - level / rate, 0.0) ** 2
    angle = np.round((yielded + slid) / 5e-6) * 5e-6
    recording = sw.Recording({"time": time, "torque": torque, "angle": angle}, {"time": "s", "torque": "N.m", "angle": "rad"})
    (found,) = breakaways(recording)
    assert 0.8 * level < found.torque < 1.02 * level


def test_a_torque_that_no_bristle_follows_fails_the_check_and_determines_nothing() -> None:
    angle = path(1e-3)
    torque = np.cumsum(np.random.default_rng(0).standard_normal(len(angle))) * 1e-3
    columns = {"time": 0.01 * np.arange(len(angle)), "angle": angle, "torque": torque}
    found = sw.identify("csg-20-100", {"presliding": sw.Recording(columns, {"time": "s", "angle": "rad", "torque": "N.m"})})
    assert "error left unexplained" in [check.name for check in found.failed]
    assert found.parameters == ()
