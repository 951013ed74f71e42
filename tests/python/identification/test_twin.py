"""The main job: what is known of each parameter, why, and what excludes what."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import get_args

import numpy as np
import pytest
import strainwave as sw
from strainwave.demo import position_drive
from strainwave.files.entries import Entry
from strainwave.identification.evidence.verdict import State

SPEED = np.geomspace(1.0, 200.0, 30)


def table(coulomb: float, viscous: float, noise: float = 1e-4) -> sw.Recording:
    torque = coulomb + viscous * SPEED + noise * np.random.default_rng(4).normal(size=len(SPEED))
    return sw.Recording({"speed": SPEED, "torque": torque}, {"speed": "rad/s", "torque": "N.m"})


def loop(amplitude: float = 1e-3) -> sw.Recording:
    quarter = np.linspace(0.0, amplitude, 60)
    path = np.concatenate((quarter[::-1], -quarter[1:], -quarter[-2::-1], quarter[1:]))
    elements = sw.hysteresis.MaxwellSlip(stiffness=[8e3, 4e3], breakaway=[0.8, 1.2])
    torque = elements.trace(np.concatenate((path, path)))[-len(path) :] + 3e4 * path
    torque += 0.01 * np.random.default_rng(5).normal(size=len(path))
    return sw.Recording({"twist": path, "torque": torque}, {"twist": "rad", "torque": "N.m"})


@pytest.fixture(scope="module")
def found() -> sw.Twin:
    return sw.twin(sw.GearSet.read("hfuc-25-100"), friction=table(0.02, 3e-4), torsion=loop())


def test_every_parameter_of_the_gear_has_a_verdict(found: sw.Twin) -> None:
    from strainwave import _core

    paths = [f"gear.{path}" for path, *_ in _core.parameters(found.gear_set.gear)]
    assert [verdict.path for verdict in found.verdicts] == paths
    assert {verdict.state for verdict in found.verdicts} <= set(get_args(State))
    assert all(verdict.why for verdict in found.verdicts)


def test_what_was_measured_is_identified_and_near_the_truth(found: sw.Twin) -> None:
    verdicts = {verdict.path: verdict for verdict in found.verdicts}
    assert found.gear_set.gear.stiffness.k == pytest.approx(3e4, rel=0.01)
    for path, truth in (("gear.friction_input.coulomb", 0.02), ("gear.friction_input.viscous", 3e-4)):
        assert verdicts[path].state == "identified"
        assert abs(verdicts[path].value - truth) < 4.0 * verdicts[path].sigma


def test_what_was_not_measured_is_kept_with_its_source(found: sw.Twin) -> None:
    start = found.start
    kept = {verdict.path: verdict for verdict in found.verdicts if verdict.state == "kept"}
    assert kept["gear.input_inertia"].value == start.gear.input_inertia
    assert start.sources["gear.input_inertia"].source in kept["gear.input_inertia"].why
    assert found.gear_set.gear.kinematic_error == start.gear.kinematic_error


def test_the_gear_file_of_the_twin_gives_the_twin_back(found: sw.Twin, tmp_path: Path) -> None:
    found.gear_set.save(tmp_path / "mine.toml")
    again = sw.GearSet.read(tmp_path / "mine.toml")
    assert again.gear == found.gear_set.gear
    identified = {v.path: v for v in found.verdicts if v.state == "identified"}
    for path, verdict in identified.items():
        assert again.sources[path].uncertainty == pytest.approx(verdict.sigma)
        assert "identified from" in again.sources[path].source


def test_assumed_values_contradict_nothing() -> None:
    start = sw.GearSet.read("hfuc-25-100")
    assert start.sources["gear.friction_input.coulomb"].source.startswith("assumed")
    assert sw.twin(start, friction=table(0.5, 1e-2)).contradictions == ()


def test_a_measured_value_is_contradicted_and_never_averaged() -> None:
    start = sw.GearSet.read("hfuc-25-100")
    measured = Entry(source="test bench, last year", uncertainty=1e-3)
    start = replace(
        start,
        gear=start.gear.replace(friction_input=start.gear.friction_input.replace(coulomb=0.1)),
        sources=dict(start.sources) | {"gear.friction_input.coulomb": measured},
    )
    found = sw.twin(start, friction=table(0.02, 3e-4))
    (contradiction,) = found.contradictions
    assert (contradiction.path, contradiction.earlier) == ("gear.friction_input.coulomb", 0.1)
    assert contradiction.measured == pytest.approx(0.02, rel=0.02)
    assert found.gear_set.gear.friction_input.coulomb == contradiction.measured
    assert contradiction.distance == pytest.approx(0.08 / np.hypot(1e-3, contradiction.sigma), rel=0.02)


def test_a_catalogue_stiffness_within_its_spread_is_no_contradiction() -> None:
    start = sw.GearSet.read("hfuc-25-100")
    assert not [c for c in sw.twin(start, torsion=loop()).contradictions if "stiffness" in c.path]


def test_the_two_friction_data_sets_of_document_p_are_shown_as_contradictory() -> None:
    """Errata E-P6 and E-P7: Table 2, read as all friction, against Tables 1 and 3 of the same document."""
    found = position_drive()
    contradictions = {c.path: c for c in found.contradictions}
    coulomb, viscous = contradictions["gear.friction_input.coulomb"], contradictions["gear.friction_input.viscous"]
    assert (coulomb.earlier, viscous.earlier) == (0.072, 4e-4)
    assert coulomb.measured == pytest.approx(0.012554434963, rel=1e-9)
    assert viscous.measured == pytest.approx(0.030840444789, rel=1e-9)
    assert viscous.measured / viscous.earlier == pytest.approx(77.1, abs=0.05)
    assert min(coulomb.distance, viscous.distance) > 4.0  # of five speeds: Student's distribution with three degrees of freedom


def test_a_twin_without_measurement_is_refused() -> None:
    with pytest.raises(ValueError, match="at least one measurement"):
        sw.twin(sw.GearSet.read("hfuc-25-100"))


def test_a_log_needs_motor_and_load() -> None:
    log = sw.Recording(
        {"time": [0.0, 0.1, 0.2], "command": [0.0, 1.0, 0.0], "input_angle": [0.0, 0.1, 0.2]},
        {"time": "s", "command": "V", "input_angle": "rad"},
    )
    with pytest.raises(ValueError, match="motor"):
        sw.twin(sw.GearSet.read("hfuc-25-100"), log=log)


def test_springs_of_different_kinds_are_compared_by_their_stiffness_at_zero_twist() -> None:
    soft = loop()
    torque = soft["torque"] - 2.85e4 * soft["twist"]  # a spring of 1500 N.m/rad where the catalogue has 26 700
    recording = sw.Recording({"twist": soft["twist"], "torque": torque}, {"twist": "rad", "torque": "N.m"})
    found = sw.twin(sw.GearSet.read("hfuc-25-100"), torsion=recording)
    (contradiction,) = (c for c in found.contradictions if "stiffness" in c.path)
    assert contradiction.earlier == found.start.gear.stiffness.k1
    assert contradiction.measured == pytest.approx(1.5e3, rel=0.05)


def test_a_value_that_follows_from_a_fit_does_not_keep_its_old_source(found: sw.Twin) -> None:
    path = "gear.friction_input.breakaway"
    assert found.gear_set.gear.friction_input.breakaway != found.start.gear.friction_input.breakaway
    assert found.gear_set.sources[path].source != found.start.sources[path].source
    assert "follows from the parameters fitted" in found.gear_set.sources[path].source
