"""What is said of each parameter."""

from __future__ import annotations

import tempfile
import warnings
from copy import deepcopy
from pathlib import Path

import numpy as np
import pytest
import strainwave as sw
from strainwave.files.gear_set import GearSet

from tests.python.identification.candidates.test_torsion import SPRINGS, at_the_input, loop

SPEED = np.geomspace(0.5, 300.0, 30)


def branch() -> sw.Recording:
    twist = np.linspace(0.0, 2e-3, 200)
    torque = SPRINGS["three_segment"].torque(twist) + 0.02 * np.random.default_rng(0).normal(size=200)
    return sw.Recording({"twist": twist, "torque": torque}, {"twist": "rad", "torque": "N.m"})


def stated(found: sw.Twin) -> dict[str, str]:
    return {verdict.path: verdict.state for verdict in found.verdicts}


def test_spring_and_hysteresis_of_a_single_branch_are_told_together() -> None:
    found = sw.twin("hfuc-20-80", torsion=branch())
    verdicts = {v.path: v for v in found.verdicts if v.path.startswith("gear.stiffness")}
    assert {v.state for v in verdicts.values()} == {"identified in combination"}
    assert "the hysteresis was kept" in verdicts["gear.stiffness.k1"].why
    own = next(e.sigma for e in found.evidence[0].fit.estimates if e.path == "stiffness.k1")
    assert verdicts["gear.stiffness.k1"].sigma > own, "the uncertainty of the hysteresis is in it"
    assert stated(found)["gear.hysteresis.breakaway[0]"] == "kept"


def test_what_a_twin_of_input_loop_and_friction_tells_has_the_doubt_of_both() -> None:
    start = GearSet.read("hfuc-20-80")
    law = sw.friction.Coulomb(coulomb=0.05, breakaway=0.05, viscous=3e-4)
    torque = law.steady(SPEED) + 5e-4 * np.random.default_rng(1).normal(size=len(SPEED))
    table = sw.Recording({"speed": SPEED, "torque": torque}, {"speed": "rad/s", "torque": "N.m"})
    found = sw.twin(start, friction=table, torsion=at_the_input(noise=1e-3))
    elements = [v for v in found.verdicts if v.path.startswith("gear.hysteresis.breakaway")]
    own = {f"gear.{e.path}": e.sigma for e in found.evidence[1].fit.estimates}
    assert any(v.sigma > own[v.path] for v in elements)
    held = sum(v.value for v in elements) + 80.0 * found.gear_set.gear.friction_input.hold()
    assert held == pytest.approx(2.0 + 80.0 * 0.05, rel=0.03), "friction is counted once"


def test_a_loop_from_the_input_alone_tells_friction_and_hysteresis_together() -> None:
    found = sw.twin("hfuc-20-80", torsion=at_the_input(noise=1e-3))
    states = stated(found)
    told = [path for path in states if states[path] == "identified in combination"]
    assert told in (["gear.friction_input.breakaway"], [path for path in told if "hysteresis.breakaway" in path])
    assert any("give a friction table to tell them apart" in remark for remark in found.evidence[0].remarks)


def test_a_twin_loads_without_a_warning_and_breaks_away_no_lower_than_it_slides() -> None:
    bristles = sw.friction.LuGre(
        coulomb=0.09, breakaway=0.095, stribeck_speed=2.0, bristle_stiffness=50.0, bristle_damping=8e-3, viscous=7e-4
    )
    start = GearSet.of(sw.load("hfuc-20-80").replace(friction_input=bristles), name="bristles", source="assumed")
    truth = sw.friction.Stribeck(coulomb=0.04, breakaway=0.07, stribeck_speed=3.0, viscous=2e-4)
    table = sw.Recording({"speed": SPEED, "torque": truth.steady(SPEED)}, {"speed": "rad/s", "torque": "N.m"})
    found = sw.twin(start, friction=table)
    with tempfile.TemporaryDirectory() as folder, warnings.catch_warnings():
        warnings.simplefilter("error")
        found.gear_set.save(Path(folder, "twin.toml"))
        law = sw.load(Path(folder, "twin.toml")).friction_input
    assert law.name == "lugre"
    assert law.breakaway >= law.coulomb


def test_a_correlated_pair_is_told_in_combination_with_what_the_data_do_tell() -> None:
    measured = loop(SPRINGS["linear"], 1.5e-3 * np.sin(np.linspace(0.0, 2.0 * np.pi, 200)))
    recording = sw.Recording({"twist": measured.twist, "torque": measured.torque}, {"twist": "rad", "torque": "N.m"})
    found = sw.twin("hfuc-20-80", torsion=recording)
    for verdict in found.verdicts:
        if verdict.state == "identified in combination":
            assert "told together with" in verdict.why
            assert "correlation" in verdict.why


def test_a_twin_equals_its_copy() -> None:
    found = sw.twin("hfuc-20-80", torsion=branch())
    assert found == deepcopy(found)


def test_columns_that_no_fit_uses_are_said() -> None:
    found = sw.twin("hfuc-20-80", torsion=branch().with_column("temperature", np.full(200, 295.0), "K"))
    assert "not used: temperature" in found.evidence[0].remarks


def test_limits_of_the_maker_that_a_measurement_exceeds_are_told() -> None:
    twist = 1.2 * branch()["twist"]
    heavy = sw.Recording({"twist": 3.0 * twist, "torque": 3.0 * branch()["torque"]}, {"twist": "rad", "torque": "N.m"})
    exceeded = [check.name for check in sw.twin("csg-20-100", torsion=heavy).ratings if check.exceeded]
    assert "peak_torque" in exceeded
