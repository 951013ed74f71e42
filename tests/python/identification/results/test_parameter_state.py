"""The state of every number of the gear: determined by a file, or kept, and why."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import get_args

import numpy as np
import pytest
import strainwave as sw
from strainwave import _core
from strainwave.files.entries import Entry
from strainwave.identification.identify import Identified
from strainwave.identification.results.file_result import State

SPEED = np.geomspace(1.0, 200.0, 30)


def table(coulomb: float, viscous: float, noise: float = 1e-4) -> sw.Recording:
    torque = coulomb + viscous * SPEED + noise * np.random.default_rng(4).normal(size=len(SPEED))
    return sw.Recording({"speed": SPEED, "torque": torque}, {"speed": "rad/s", "torque": "N.m"}, "table of today")


def loop(amplitude: float = 1e-3) -> sw.Recording:
    quarter = np.linspace(0.0, amplitude, 60)
    path = np.concatenate((quarter[::-1], -quarter[1:], -quarter[-2::-1], quarter[1:]))
    elements = sw.hysteresis.MaxwellSlip(stiffness=[8e3, 4e3], breakaway=[0.8, 1.2])
    torque = elements.trace(np.concatenate((path, path)))[-len(path) :] + 3e4 * path
    torque += 0.01 * np.random.default_rng(5).normal(size=len(path))
    return sw.Recording({"twist": path, "torque": torque}, {"twist": "rad", "torque": "N.m"})


@pytest.fixture(scope="module")
def found() -> Identified:
    return sw.identify("hfuc-25-100", {"friction": table(0.02, 3e-4), "torsion": loop()})


def test_every_number_of_the_gear_has_a_state_and_a_reason(found: Identified) -> None:
    paths = [f"gear.{path}" for path, *_ in _core.parameters(found.gear_set.gear)]
    assert [each.path for each in found.states] == paths
    assert {each.state for each in found.states} <= set(get_args(State))
    assert all(each.why for each in found.states)


def test_what_was_measured_is_identified_and_near_the_truth(found: Identified) -> None:
    assert found.failed == ()
    states = {each.path: each for each in found.states}
    assert found.gear_set.gear.stiffness.k == pytest.approx(3e4, rel=0.01)
    for path, truth in (("gear.friction_input.coulomb", 0.02), ("gear.friction_input.viscous", 3e-4)):
        assert states[path].state == "identified"
        assert abs(states[path].value - truth) < 4.0 * states[path].sigma


def test_what_was_not_measured_is_kept_with_its_source(found: Identified) -> None:
    start = found.start_set
    kept = {each.path: each for each in found.states if each.state == "kept"}
    assert kept["gear.input_inertia"].value == start.gear.input_inertia
    assert start.sources["gear.input_inertia"].source in kept["gear.input_inertia"].why
    assert found.gear_set.gear.kinematic_error == start.gear.kinematic_error


def test_a_value_that_follows_from_a_fit_does_not_keep_its_old_source(found: Identified) -> None:
    path = "gear.friction_input.breakaway"
    assert found.gear_set.gear.friction_input.breakaway != found.start_set.gear.friction_input.breakaway
    assert "follows from the parameters fitted" in found.gear_set.sources[path].source
    state = next(each for each in found.states if each.path == path)
    assert (state.state, "follows from the parameters fitted" in state.why) == ("kept", True)


def test_the_gear_file_gives_the_gear_back_with_its_uncertainties(found: Identified, tmp_path: Path) -> None:
    found.gear_set.save(tmp_path / "mine.toml")
    again = sw.GearSet.read(tmp_path / "mine.toml")
    assert again.gear == found.gear_set.gear
    for each in found.states:
        if each.state == "identified":
            assert again.sources[each.path].uncertainty == pytest.approx(each.sigma)
            assert "identified from" in again.sources[each.path].source


def test_a_measured_value_of_the_start_set_is_contradicted_and_never_averaged() -> None:
    start = sw.GearSet.read("hfuc-25-100")
    path, measured = "gear.friction_input.coulomb", Entry(source="test bench, last year", uncertainty=1e-3)
    law = start.gear.friction_input.replace(coulomb=0.1)
    start = replace(start, gear=start.gear.replace(friction_input=law), sources=dict(start.sources) | {path: measured})
    found = sw.identify(start, {"friction": table(0.02, 3e-4)}, accept=True)
    (check,) = found.failed
    assert check.name == "numbers of the start set"
    assert "gear.friction_input.coulomb = 0.02" in check.message
    assert "0.1 ± 1 %" in check.message
    assert found.gear_set.gear.friction_input.coulomb == pytest.approx(0.02, rel=0.02)


def test_springs_of_different_kinds_are_compared_by_their_stiffness_at_zero_twist() -> None:
    soft = loop()
    torque = soft["torque"] - 2.85e4 * soft["twist"]  # a spring of 1500 N.m/rad where the catalogue has 26 700
    recording = sw.Recording({"twist": soft["twist"], "torque": torque}, {"twist": "rad", "torque": "N.m"})
    found = sw.identify("hfuc-25-100", {"torsion": recording})
    (check,) = found.failed
    assert check.name == "stiffness of the start set"
    assert check.value > check.limit == pytest.approx(np.exp(0.9))


def test_files_of_no_kind_are_refused() -> None:
    with pytest.raises(ValueError, match="at least one file"):
        sw.identify("hfuc-25-100", {})
    with pytest.raises(ValueError, match=r"'speed' is no kind of measurement; the kinds are friction, effort, starting, "):
        sw.identify("hfuc-25-100", {"speed": table(0.02, 3e-4)})
    with pytest.raises(TypeError, match="a measurement must be a path or a Recording, not 3"):
        sw.identify("hfuc-25-100", {"friction": 3})  # type: ignore[dict-item]


def test_a_run_needs_motor_and_load() -> None:
    log = sw.Recording(
        {"time": [0.0, 0.1, 0.2], "command": [0.0, 1.0, 0.0], "input_angle": [0.0, 0.1, 0.2]},
        {"time": "s", "command": "V", "input_angle": "rad"},
    )
    with pytest.raises(ValueError, match="motor"):
        sw.identify("hfuc-25-100", {"run": log})
