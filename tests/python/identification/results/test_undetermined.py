"""Numbers that a file does not determine: the set before it is their prior, and sums stay as measured."""

from __future__ import annotations

import numpy as np
import pytest
import strainwave as sw
from hypothesis import given, settings, strategies as some
from strainwave.identification.fitting.fit import fit
from strainwave.identification.fitting.unknowns import Unknown
from strainwave.identification.results.determined import friction_at, sizes_of
from strainwave.identification.results.file_result import FileEstimate
from strainwave.identification.results.gear_so_far import GearSoFar
from strainwave.identification.results.undetermined import with_friction_at, with_set_before
from strainwave.parameters import every

from tests.evidence.drawn.written_gears import outcome

START = sw.GearSet.read("csg-20-100")
LAW = START.gear.friction_input


@settings(deadline=None, max_examples=30)
@given(some.lists(some.floats(0.5, 200.0), min_size=1, max_size=3), some.floats(0.2, 8.0))
def test_friction_at_few_speeds_is_reproduced_and_divided_as_the_set_has_it(speeds: list[float], factor: float) -> None:
    speed, name = sizes_of(np.array(speeds)), "few.csv"
    estimates = [friction_at(each, factor * float(LAW.steady(each)), 1e-5) for each in speed]
    law = with_friction_at(GearSoFar(START), np.append(speed, -speed), estimates, "input", name).gear_set.gear.friction_input
    assert law.steady(speed) == pytest.approx([each.value for each in estimates], rel=2e-3)
    assert (law.coulomb / LAW.coulomb, law.viscous / LAW.viscous) == pytest.approx((factor, factor), rel=0.02)


def test_sums_are_marked_and_friction_of_a_file_before_is_kept() -> None:
    known = with_friction_at(
        GearSoFar(START), np.array([0.1, -0.1]), [friction_at(0.1, 6.4, 0.01, side="output")], "output", "a.csv"
    )
    entry = known.gear_set.sources["gear.friction_input.viscous"]
    assert entry.source.startswith("identified in combination: a.csv determines coulomb + 10 viscous = 0.064 ± 0.0001 N.m")
    table = sw.Recording({"speed": [1.0, 9.0, 40.0, 90.0, 150.0], "torque": [0.05, 0.053, 0.062, 0.077, 0.095]},
                         {"speed": "rad/s", "torque": "N.m"})  # fmt: skip
    found = sw.identify(START, {"friction": table}).gear_set
    one_way = with_friction_at(GearSoFar(START), np.array([10.0]), [friction_at(10.0, 0.2, 0.01)], "input", "b")
    assert one_way.gear_set == START
    again = with_friction_at(
        GearSoFar(found, determined=frozenset({"friction_input"})),
        np.array([10.0]),
        [friction_at(10.0, 0.2, 0.01)],
        "input",
        "b",
    )
    assert again.gear_set == found


@pytest.mark.parametrize(("before", "low", "high", "value", "ended"), [
    (0.05, 0.0, np.inf, 1.8e-18, 0.0), (0.05, 2.0**-126, np.inf, 1e-38, 5e-8), (0.05, 0.0, 0.4, 0.4 - 1e-9, 0.4),
    (0.05, 0.0, np.inf, 0.02, 0.02), (0.0, 0.0, np.inf, 1e-30, 1e-30),
])  # fmt: skip
def test_a_fit_ends_at_a_limit_and_not_beside_it(before: float, low: float, high: float, value: float, ended: float) -> None:
    assert Unknown("load.inertia", "kg.m2", before, low, high).ended(value) == pytest.approx(ended, rel=1e-12)


@settings(deadline=None, max_examples=10)
@given(some.sampled_from(["coulomb", "viscous"]), some.floats(0.01, 0.1), some.integers(0, 1000))
def test_no_number_of_a_fit_is_a_rounding_beside_its_limit(missing: str, size: float, seed: int) -> None:
    """The torque lacks a part of the law, or has it with the wrong sign: its number ends at its limit."""
    speed = np.linspace(5.0, 100.0, 40)
    torque = size * np.ones(40) - 1e-4 * speed if missing == "viscous" else 1e-3 * speed - 0.1 * size
    torque = torque + 1e-4 * np.random.default_rng(seed).standard_normal(40)
    table = sw.Recording({"speed": speed, "torque": torque}, {"speed": "rad/s", "torque": "N.m"})
    gear = START.gear.replace(friction_input=LAW.replace(breakaway=0.5))
    found = fit(gear, table, ["friction_input.coulomb", "friction_input.viscous"])
    assert all(each.value == 0.0 or abs(each.value) > 1e-9 for each in every(found.gear).values())
    assert getattr(found.gear.friction_input, missing) == 0.0


@pytest.mark.slow("identification")
@pytest.mark.parametrize("seed", range(3))
def test_a_gear_that_is_written_predicts_with_the_error_stated(seed: int) -> None:
    assert outcome(seed).verdict == "right"


@pytest.mark.slow("identification")
def test_a_log_at_one_speed_keeps_the_sum_and_the_division_of_the_set() -> None:
    time = np.arange(0.0, 24.0, 0.01)
    rate = 10.0 * np.tanh(30.0 * np.sin(2.0 * np.pi * time / 6.0 + 0.2))
    angle = np.concatenate([[0.0], np.cumsum(0.005 * (rate[1:] + rate[:-1]))])
    noise = 2e-3 * np.random.default_rng(5).standard_normal(len(time))
    columns = {"time": time, "input_angle": angle, "input_torque": 0.06 * np.tanh(rate / 0.05) + 4e-4 * rate + noise}
    log = sw.Recording(columns, {"time": "s", "input_angle": "rad", "input_torque": "N.m"})
    found = sw.identify(START, {"log": log}, accept=True)
    law = found.gear_set.gear.friction_input
    assert law.steady(10.0) == pytest.approx(0.064, rel=0.03)
    for number, truth, spread in (("coulomb", 0.06, 0.3), ("viscous", 4e-4, 0.5)):
        assert getattr(law, number) == pytest.approx(truth, rel=spread), number
        (estimate,) = (each for each in found.files[0].estimates if each.path == f"gear.friction_input.{number}")
        assert abs(estimate.value - truth) < 2.5 * estimate.sigma
        assert estimate.value == getattr(law, number)


def test_a_number_that_is_not_identified_is_that_of_the_set_and_the_sum_stays() -> None:
    """Speeds within 2 % do not divide friction: the set does, and friction at these speeds stays as measured."""
    speed = np.linspace(9.9, 10.1, 40)
    torque = 1.5 * LAW.steady(speed) + 2e-3 * np.random.default_rng(0).normal(size=40)
    table = sw.Recording({"speed": speed, "torque": torque}, {"speed": "rad/s", "torque": "N.m"})
    gear = START.gear.replace(
        friction_input=sw.friction.Coulomb(coulomb=LAW.coulomb, breakaway=LAW.coulomb, viscous=LAW.viscous)
    )
    paths = ["friction_input.coulomb", "friction_input.viscous"]
    free = fit(gear, table, paths)
    judged = [
        FileEstimate(f"gear.{each.path}", each.unit, each.value, each.sigma, "", why="not separable") for each in free.estimates
    ]
    again, estimates = with_set_before(free, judged, GearSoFar(START), "gear.")
    before, after = (one.gear.friction_input for one in (free, again))
    assert after.steady(10.0) == pytest.approx(1.5 * LAW.steady(10.0), rel=2e-2)
    assert abs(after.viscous / LAW.viscous - 1.0) < 1.0 < abs(before.viscous / LAW.viscous - 1.0)
    assert [each.value for each in estimates] == [after.coulomb, after.viscous]


def test_a_gear_with_bristles_keeps_them_when_a_table_leaves_the_division_of_friction_to_the_set() -> None:
    """The law that is fitted to a table is not the one that is written: the set's numbers are priors of the former."""
    bristles = sw.friction.LuGre(
        coulomb=0.046, breakaway=0.05, viscous=3.5e-4, bristle_stiffness=40.0, bristle_damping=1e-3, stribeck_speed=1.0
    )
    start = sw.GearSet.of(START.gear.replace(friction_input=bristles), name="bristles", source="assumed")
    speed = np.linspace(9.0, 11.0, 30)
    torque = 0.07 + 3e-4 * speed + 2e-3 * np.random.default_rng(0).normal(size=30)
    columns = {"speed": np.append(speed, -speed), "torque": np.append(torque, -torque)}
    found = sw.identify(start, {"friction": sw.Recording(columns, {"speed": "rad/s", "torque": "N.m"})})
    law = found.gear_set.gear.friction_input
    assert isinstance(law, sw.friction.LuGre)
    assert (law.bristle_stiffness, law.breakaway) == (40.0, law.coulomb)
    assert law.steady(10.0) == pytest.approx(0.073, rel=0.02)
