"""Files against the start set, and against each other."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import strainwave as sw
from strainwave.files.gear_set import GearSet
from strainwave.identification.checks.comparisons import (
    MAX_CHANCE_OF_START_SET,
    between_files,
    gravity_in_ratings,
    other_loads,
    ratio_in_files,
    with_start_set,
)
from strainwave.identification.reading.recognise import Recognised
from strainwave.identification.results.combined_parameter import combine
from strainwave.identification.results.file_result import Check, FileEstimate, FileResult
from strainwave.typeset import percent

from tests.support.samples import sample

SMALL, LARGE = sw.GearSet.read("hfuc-20-80"), sw.GearSet.read("hfuc-32-50")
FIRST = "gear.stiffness.k1"
PATHS = [f"gear.friction_input.{name}" for name in ("coulomb", "viscous")]
Law = sw.friction.Coulomb | sw.friction.Stribeck


def of(name: str, values: dict[str, float], relative: float = 0.005) -> FileResult:
    units = {"stiffness": "N.m/rad", "friction_input": "N.m"}
    return FileResult(
        name,
        estimates=tuple(
            FileEstimate(path, units[path.split(".")[1]], value, relative * value, "") for path, value in values.items()
        ),
    )


def against(start: sw.GearSet, *files: FileResult) -> Sequence[Check]:
    return list(with_start_set(start, combine(files)))


def test_the_stiffness_of_another_size_fails_though_a_linear_spread_of_30_percent_could_not_exclude_it() -> None:
    """k1 of size 20 against the set of size 32: 14204 against 47560 N.m/rad, 2.3 standard deviations of 30 % below."""
    known = LARGE.gear.stiffness.k1
    assert (known - 14204.0) / (0.3 * known) < 3.0
    (check,) = against(LARGE, of("loop.csv", {FIRST: 14204.0}))
    assert check.failed
    assert "gear.stiffness.k1 = 14204 ± 71 N·m/rad" in check.message
    assert "4.0 σ below" in check.message
    (right,) = against(SMALL, of("loop.csv", {FIRST: 14204.0}))
    assert not right.failed


def test_numbers_are_compared_jointly() -> None:
    """Three numbers, each two and a half standard deviations off, are no chance."""
    measured = sw.files.Entry("test bench", spread=0.2)
    paths = [f"gear.friction_input.{name}" for name in ("coulomb", "viscous")]
    start = SMALL.replace(sources={**SMALL.sources, **dict.fromkeys(paths, measured)})
    off = float(np.exp(2.5 * 0.2))
    law, spread = start.gear.friction_input, float(np.exp(2.5 * 0.3))
    values = {paths[0]: off * law.coulomb, paths[1]: off * law.viscous, FIRST: start.gear.stiffness.k1 * spread}
    for path, value in values.items():
        (alone,) = against(start, of("file.csv", {path: value}))
        assert not alone.failed
    (together,) = against(start, of("file.csv", values))
    assert together.failed


def test_assumed_numbers_contradict_nothing() -> None:
    assert SMALL.sources["gear.friction_input.coulomb"].assumed
    assert against(SMALL, of("table.csv", {"gear.friction_input.coulomb": 50.0})) == []


def test_the_share_that_fails_by_chance_is_the_one_stated() -> None:
    random, known = np.random.default_rng(1), SMALL.gear.stiffness.k1
    count = sample(4000, 20_000)
    factors = np.exp(0.3 * random.standard_normal(count))
    (one,) = against(SMALL, of("loop.csv", {FIRST: known}, 1e-6))
    failed = float(np.mean((np.log(factors) / 0.3) ** 2 > one.limit))
    assert failed == pytest.approx(MAX_CHANCE_OF_START_SET, abs=4.0 * np.sqrt(MAX_CHANCE_OF_START_SET / count))


def test_friction_from_run_to_run_may_differ_by_more_than_its_standard_deviation_and_by_no_factor_of_two() -> None:
    path = "gear.friction_input.coulomb"
    for factor, fails in ((1.2, False), (2.0, True)):
        files = of("a.csv", {path: 0.05}), of("b.csv", {path: 0.05 * factor})
        (check,) = between_files(combine(files), files)
        assert check.failed == fails, factor
        assert f"they differ by {percent(factor - 1.0)}; runs of one gear differ by up to " in check.message
        assert check.message.endswith("; a.csv is taken because its standard deviation is the smaller")


def fitted(name: str, law: Law, noise: float = 1e-4) -> FileResult:
    """A friction table of a law, fitted by the law that it shows."""
    speed = np.geomspace(0.5, 300.0, 25)
    torque = law.steady(speed) + noise * np.random.default_rng(3).standard_normal(len(speed))
    table = sw.Recording({"speed": speed, "torque": torque}, {"speed": "rad/s", "torque": "N.m"})
    (result,) = sw.identify(SMALL, {"friction": table}).files
    return replace(result, name=name)


FALLING = sw.friction.Stribeck(coulomb=0.04, breakaway=0.07, stribeck_speed=30.0, viscous=3e-4)
LEVEL = sw.friction.Coulomb(coulomb=0.05, breakaway=0.05, viscous=3e-4)


@pytest.mark.parametrize(("factor", "fails"), [(1.0, False), (2.5, True)])
def test_friction_by_two_laws_is_compared_as_a_torque(factor: float, fails: bool) -> None:
    """A joint with 2.5 times the friction passed by having another law, whose numbers have other meanings."""
    other = LEVEL.replace(coulomb=factor * LEVEL.coulomb, breakaway=factor * LEVEL.coulomb, viscous=factor * LEVEL.viscous)
    files = fitted("a.csv", FALLING), fitted("b.csv", other)
    assert files[0].friction != files[1].friction
    (check,) = between_files(combine(files), files)
    assert check.failed == fails
    assert "steady_friction (at " in check.message


def test_of_files_with_two_laws_no_mean_is_taken_and_the_gear_has_the_numbers_of_one() -> None:
    files = fitted("a.csv", FALLING), fitted("b.csv", LEVEL)
    numbers = {each.estimate.path: each for each in combine(files, determined_by=dict.fromkeys(PATHS, "a.csv"))}
    for path in PATHS:
        assert (numbers[path].source, numbers[path].mean_of) == ("a.csv", ("a.csv",))


def test_files_that_agree_and_files_with_a_failed_check_are_not_compared() -> None:
    agree = of("a.csv", {FIRST: 14200.0}), of("b.csv", {FIRST: 14250.0})
    assert list(between_files(combine(agree), agree)) == []
    bad = Check("torque at its limit", "b.csv", 0.2, 0.05, "1", True)
    doubtful = FileResult("b.csv", estimates=of("b.csv", {FIRST: 7100.0}).estimates, checks=(bad,))
    files = agree[0], doubtful
    assert list(between_files(combine(files), files)) == []
    (taken,) = combine(files)
    assert (taken.source, taken.mean_of) == ("a.csv", ("a.csv",))


def test_further_segments_of_a_spring_of_the_same_law_are_compared_too() -> None:
    spring = SMALL.gear.stiffness
    segments = {"k1": spring.k1, "k2": 0.2 * spring.k2}
    estimates = tuple(
        FileEstimate(f"gear.stiffness.{name}", "N.m/rad", value, 0.01 * value, "three_segment")
        for name, value in segments.items()
    )
    (check,) = against(SMALL, FileResult("loop.csv", estimates=estimates))
    assert check.failed
    assert "gear.stiffness.k2" in check.message


def log(name: str, numbers: dict[str, tuple[float, str]], same_as: str = "") -> FileResult:
    constants: dict[str, float] = {}
    read = Recognised(Path(name), "log", {}, {}, None, (), (), constants, sw.Recording({"time": [0.0, 1.0]}, {"time": "s"}))
    estimates = tuple(FileEstimate(path, unit, value, 0.01 * value, "") for path, (value, unit) in numbers.items())
    return FileResult(name, read, estimates=estimates, same_as=same_as)


def test_logs_with_different_loads_may_be_of_two_joints() -> None:
    friction = {"gear.friction_input.coulomb": (0.05, "N.m")}
    first = log("one.csv", {**friction, "load.inertia": (1.0, "kg.m2"), "load.gravity_torque": (25.0, "N.m")})
    again = log("again.csv", {**friction, "load.inertia": (1.08, "kg.m2"), "load.gravity_torque": (25.5, "N.m")})
    other = log("two.csv", {**friction, "load.inertia": (3.0, "kg.m2")})
    remarks = other_loads((first, again, other))
    assert list(remarks) == ["two.csv"]
    assert "load.inertia = 3.000 ± 0.030 against 1.000 ± 0.010 kg·m²" in remarks["two.csv"]
    assert "no load.gravity_torque against 25.00 ± 0.25 N·m, of one.csv" in remarks["two.csv"]
    assert "two joints" in remarks["two.csv"]
    assert not other_loads((first, log("copy.csv", {"load.inertia": (3.0, "kg.m2")}, same_as="one.csv")))
    in_current = log("a.csv", {"load.inertia": (30.0, "A.s2/rad"), "load.gravity_torque": (250.0, "A")})
    assert not other_loads((first, in_current))


@pytest.mark.parametrize(("gravity", "unit", "failed"), [(1600.0, "N.m", [False]), (1700.0, "N.m", [True]), (1700.0, "A", [])])
def test_gravity_that_would_destroy_the_gear_fails(gravity: float, unit: str, failed: list[bool]) -> None:
    """The gear of size 20 buckles at 560 N.m, three times which are 1680 N.m."""
    file = FileResult("log.csv", estimates=(FileEstimate("load.gravity_torque", unit, gravity, 1.0, ""),))
    assert [check.failed for check in gravity_in_ratings(SMALL, combine([file]))] == failed


@pytest.mark.parametrize(("stated", "given", "failed"), [(50.0, {}, True), (101.0, {}, False), (50.0, {"ratio": 50.0}, None)])
def test_the_ratio_in_a_file_is_compared_with_the_set(stated: float, given: dict[str, float], failed: bool | None) -> None:
    file = log("one.csv", {"load.inertia": (1.0, "kg.m2")})
    assert file.recognised is not None
    file = replace(file, recognised=replace(file.recognised, ratio=stated, constants=given))
    checks = list(ratio_in_files(GearSet.read("csg-20-100"), [file]))
    assert [check.failed for check in checks] == ([] if failed is None else [failed])
    if failed:
        assert checks[0].message == "a remark in the file states a ratio of 50, the set CSG-20-100 has 100"
