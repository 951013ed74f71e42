"""Which parameters a file determines, and why not the others."""

from __future__ import annotations

import tempfile
import warnings
from copy import deepcopy
from pathlib import Path

import numpy as np
import pytest
import strainwave as sw
from strainwave.files.gear_set import GearSet
from strainwave.identification.fitting.influence import InfluenceOfKept
from strainwave.identification.identify import Identified
from strainwave.identification.results.file_result import FileEstimate
from strainwave.identification.results.identifiability import JudgedFit
from strainwave.report.identify_files import identify_summary

from tests.python.identification.candidates.test_torsion import SPRINGS, at_the_input

SPEED = np.geomspace(0.5, 300.0, 30)


def branch() -> sw.Recording:
    twist = np.linspace(0.0, 2e-3, 200)
    torque = SPRINGS["three_segment"].torque(twist) + 0.02 * np.random.default_rng(0).normal(size=200)
    return sw.Recording({"twist": twist, "torque": torque}, {"twist": "rad", "torque": "N.m"})


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
    found = sw.identify("hfuc-20-80", {"torsion": branch().with_column("temperature", np.full(200, 295.0), "K")})
    assert any("not used: temperature" in remark for remark in found.files[0].remarks)


def test_limits_of_the_maker_that_a_measurement_exceeds_are_remarked() -> None:
    twist = 1.2 * branch()["twist"]
    heavy = sw.Recording({"twist": 3.0 * twist, "torque": 3.0 * branch()["torque"]}, {"twist": "rad", "torque": "N.m"})
    remarks = sw.identify("csg-20-100", {"torsion": heavy}).files[0].remarks
    assert any(remark.startswith("beyond what the maker allows: peak torque") for remark in remarks)
