"""Which parameters a file determines, and why not the others."""

from __future__ import annotations

import tempfile
import warnings
from copy import deepcopy
from pathlib import Path

import numpy as np
import pytest
import strainwave as sw
from hypothesis import given, settings, strategies as some
from strainwave.files.gear_set import GearSet
from strainwave.identification.fitting.fit import fit
from strainwave.identification.fitting.influence import InfluenceOfKept
from strainwave.identification.fitting.unknowns import Unknown
from strainwave.identification.identify import Identified
from strainwave.identification.results.file_result import FileEstimate, FileResult
from strainwave.identification.results.gear_so_far import GearSoFar
from strainwave.identification.results.identifiability import JudgedFit, with_friction_at, with_set_before, without_bare_knees
from strainwave.identification.results.steady_friction import friction_at, sizes_of
from strainwave.parameters import every
from strainwave.report.identify_files import identify_summary

from tests.evidence.drawn.written_gears import outcome
from tests.python.identification.candidates.test_torsion import SPRINGS, at_the_input

SPEED = np.geomspace(0.5, 300.0, 30)
START = sw.GearSet.read("csg-20-100")
LAW = START.gear.friction_input


def branch() -> sw.Recording:
    twist = np.linspace(0.0, 2e-3, 200)
    torque = SPRINGS["three_segment"].torque(twist) + 0.02 * np.random.default_rng(0).normal(size=200)
    return sw.Recording({"twist": twist, "torque": torque}, {"twist": "rad", "torque": "N.m"})


@pytest.mark.parametrize(
    ("slope", "why", "reason"),
    [
        (30e3, "", ""),
        (21e3, "", "do not differ significantly"),
        (30e3, "disagrees with a kept number", "a slope beside this knee is not identified"),
    ],
)
def test_a_knee_is_identified_between_slopes_that_are_and_that_differ(slope: float, why: str, reason: str) -> None:
    names = {"k1": (20e3, 500.0, ""), "k2": (slope, 500.0, why), "t1": (10.0, 0.5, "")}
    estimates = [FileEstimate(f"gear.stiffness.{name}", "", *numbers[:2], "", numbers[2]) for name, numbers in names.items()]
    (*slopes, knee) = without_bare_knees(estimates)
    assert slopes == estimates[:2]
    assert reason in knee.why
    assert bool(knee.why) is bool(reason)


def test_a_slope_is_identified_between_knees_that_are_apart() -> None:
    numbers = {"k1": (20e3, 500.0), "k2": (30e3, 500.0), "k3": (40e3, 500.0), "t1": (10.0, 0.5), "t2": (40.0, 1.0)}
    for sigma, open_paths in ((0.5, []), (16.0, ["gear.stiffness.k2", "gear.stiffness.t1", "gear.stiffness.t2"])):
        stated_numbers = numbers | {"t1": (10.0, sigma)}
        estimates = [FileEstimate(f"gear.stiffness.{name}", "", *each, "") for name, each in stated_numbers.items()]
        assert [each.path for each in without_bare_knees(estimates) if each.why] == open_paths


def stated(found: Identified) -> dict[str, str]:
    return {each.path: each.state for each in found.states}


def spread_within(found: Identified, place: int) -> dict[str, float]:
    """Standard deviations by the fit to a file alone."""
    fit = found.files[place].fit
    assert fit is not None
    return {f"gear.{each.path}": each.sigma for each in fit.estimates}


def test_spring_and_hysteresis_of_a_single_branch_are_determined_together() -> None:
    found = sw.identify("hfuc-20-80", {"torsion": branch()}, accept=True)
    estimates = {each.path: each for each in found.files[0].estimates}
    assert {each.state for each in estimates.values()} == {"identified in combination"}
    first = estimates["gear.stiffness.k1"]
    assert "the hysteresis was kept" in first.why
    assert first.sigma > spread_within(found, 0)[first.path], "the uncertainty of the hysteresis is in it"
    assert stated(found)["gear.stiffness.k1"] == "identified in combination"
    assert stated(found)["gear.hysteresis.breakaway[0]"] == "kept"


@pytest.mark.slow("identification")
def test_the_hysteresis_of_a_loop_at_the_input_has_the_uncertainty_of_the_friction_too() -> None:
    start = GearSet.read("hfuc-20-80")
    law = sw.friction.Coulomb(coulomb=0.05, breakaway=0.05, viscous=3e-4)
    torque = law.steady(SPEED) + 5e-4 * np.random.default_rng(1).normal(size=len(SPEED))
    table = sw.Recording({"speed": SPEED, "torque": torque}, {"speed": "rad/s", "torque": "N.m"})
    found = sw.identify(start, {"friction": table, "torsion": at_the_input(noise=1e-3)})
    elements = [each for each in found.files[1].estimates if each.path.startswith("gear.hysteresis.breakaway")]
    own = spread_within(found, 1)
    assert any(each.sigma > own[each.path] for each in elements)
    held = sum(each.value for each in elements) + 80.0 * found.gear_set.gear.friction_input.hold()
    assert held == pytest.approx(2.0 + 80.0 * 0.05, rel=0.03), "friction is counted once"


def test_a_loop_from_the_input_alone_determines_friction_and_hysteresis_together() -> None:
    found = sw.identify("hfuc-20-80", {"torsion": at_the_input(noise=1e-3)})
    together = [each.path for each in found.files[0].estimates if each.state == "identified in combination"]
    assert together in (["gear.friction_input.breakaway"], [path for path in together if "hysteresis.breakaway" in path])
    assert any("give a friction table to separate them" in remark for remark in found.files[0].remarks)
    whys = [each.why for each in found.files[0].estimates if each.path in together]
    assert all(why.startswith("determined together with ") and "breakaway" in why and " ± " in why for why in whys)


def test_a_number_without_effect_has_that_reason_and_is_that_of_the_set() -> None:
    """Steady friction depends on bristles by rounding alone, and not on what lets their damping fade, at its limit 0."""
    law = sw.friction.LuGre(
        coulomb=0.05, breakaway=0.06, bristle_stiffness=40.0, bristle_damping=1e-4, stribeck_speed=2.0, viscous=3e-4
    )
    gear = sw.Gear(friction_input=law)
    torque = law.steady(SPEED) + 1e-4 * np.random.default_rng(4).normal(size=len(SPEED))
    table = sw.Recording({"speed": SPEED, "torque": torque}, {"speed": "rad/s", "torque": "N.m"})
    free = [f"friction_input.{name}" for name in ("coulomb", "bristle_stiffness", "damping_fading")]
    found = sw.fit(gear, table, free)
    judged = {
        each.path.rpartition(".")[2]: each
        for each in JudgedFit(found, "table.csv", InfluenceOfKept.none(len(found.estimates))).estimates({}, ())
    }
    assert judged["coulomb"].state == "identified"
    for name in ("bristle_stiffness", "damping_fading"):
        assert judged[name].value == pytest.approx(getattr(law, name), rel=1e-3), name
        assert judged[name].state == "not identified", name
    assert judged["damping_fading"].why == "table.csv stays the same when it changes"


def test_a_number_at_a_bound_is_not_identified() -> None:
    table = sw.Recording({"speed": SPEED, "torque": 0.05 + 3e-4 * SPEED + 1e-4 * np.cos(9.0 * SPEED)},
                         {"speed": "rad/s", "torque": "N.m"})  # fmt: skip
    gear = sw.Gear(friction_input=sw.friction.Coulomb(coulomb=0.02, breakaway=0.02, viscous=3e-4))
    found = sw.fit(gear, table, ["friction_input.coulomb"], bounds={"friction_input.coulomb": (0.0, 0.03)})
    (judged,) = JudgedFit(found, "table.csv", InfluenceOfKept.none(1)).estimates({}, ())
    assert judged.why == "ended at its bound; table.csv would move it further"


def test_a_gear_loads_without_a_warning_and_breaks_away_no_lower_than_it_slides() -> None:
    bristles = sw.friction.LuGre(
        coulomb=0.09, breakaway=0.095, stribeck_speed=2.0, bristle_stiffness=50.0, bristle_damping=8e-3, viscous=7e-4
    )
    start = GearSet.of(sw.load("hfuc-20-80").replace(friction_input=bristles), name="bristles", source="assumed")
    truth = sw.friction.Stribeck(coulomb=0.04, breakaway=0.07, stribeck_speed=3.0, viscous=2e-4)
    table = sw.Recording({"speed": SPEED, "torque": truth.steady(SPEED)}, {"speed": "rad/s", "torque": "N.m"})
    found = sw.identify(start, {"friction": table})
    with tempfile.TemporaryDirectory() as folder, warnings.catch_warnings():
        warnings.simplefilter("error")
        found.gear_set.save(Path(folder, "mine.toml"))
        law = sw.load(Path(folder, "mine.toml")).friction_input
    assert law.name == "lugre"
    assert law.breakaway >= law.coulomb


def collinear(noise: float) -> list[FileEstimate]:
    """Estimates of a friction table at speeds around 20 rad/s, which hardly separates Coulomb and viscous friction."""
    speed = 20.0 + 0.2 * np.linspace(-1.0, 1.0, 20)
    torque = 0.05 + 3e-4 * speed + noise * np.random.default_rng(3).normal(size=20)
    gear = sw.Gear(friction_input=sw.friction.Coulomb(coulomb=0.05, breakaway=0.05, viscous=3e-4))
    free = ["friction_input.coulomb", "friction_input.viscous"]
    recording = sw.Recording({"speed": speed, "torque": torque}, {"speed": "rad/s", "torque": "N.m"})
    found = sw.fit(gear, {"friction": recording}, free=free)
    return list(JudgedFit(found, "table.csv", InfluenceOfKept.none(len(found.estimates))).estimates({}, ()))


def test_uncertain_estimates_of_a_correlated_pair_are_identified_in_combination() -> None:
    states = {each.path: (each.state, each.why) for each in collinear(noise=1e-3)}
    state, why = states["gear.friction_input.viscous"]
    assert state == "identified in combination"
    assert why.startswith(
        "determined together with friction_input.coulomb: viscous + 0.0498 coulomb = 0.0027874 ± 1.8e-05 N.m.s/rad"
    )


def test_a_correlated_pair_with_small_standard_deviations_is_identified() -> None:
    assert {each.state for each in collinear(noise=1e-6)} == {"identified"}


def test_estimates_in_combination_are_listed_on_the_terminal() -> None:
    lines = list(identify_summary(sw.identify("hfuc-20-80", {"torsion": branch()})))
    assert any(line.startswith("  gear.stiffness.k1 ") and line.endswith("identified in combination") for line in lines)


def test_a_result_equals_its_copy() -> None:
    found = sw.identify("hfuc-20-80", {"torsion": branch()})
    assert found == deepcopy(found)


def test_columns_that_no_fit_uses_are_said() -> None:
    found = sw.identify("hfuc-20-80", {"torsion": branch().with_column("supply", np.full(200, 22.0), "V")})
    assert any("not used: supply" in remark for remark in found.files[0].remarks)


def test_limits_of_the_maker_that_a_measurement_exceeds_are_remarked() -> None:
    twist = 1.2 * branch()["twist"]
    heavy = sw.Recording({"twist": 3.0 * twist, "torque": 3.0 * branch()["torque"]}, {"twist": "rad", "torque": "N.m"})
    remarks = sw.identify("csg-20-100", {"torsion": heavy}).files[0].remarks
    assert any(remark.startswith("beyond what the maker allows: peak torque") for remark in remarks)


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


@pytest.mark.parametrize(
    ("phase", "size"),
    [
        ("gear.kinematic_error.phase[2]", "gear.kinematic_error.amplitude[2]"),
        ("gear.friction_input.detent_phase", "gear.friction_input.detent_torque"),
    ],
)
def test_a_phase_is_determined_only_if_the_size_of_its_wave_is(phase: str, size: str) -> None:
    def states(why: str) -> list[str]:
        estimates = (FileEstimate(size, "rad", 1e-5, 4e-6, "", why), FileEstimate(phase, "rad", 0.3, 0.1, ""))
        return [each.state for each in FileResult("a.csv", estimates=estimates).estimates]

    assert states("standard deviation exceeds half the value") == ["not identified", "not identified"]
    assert states("") == ["identified", "identified"]
