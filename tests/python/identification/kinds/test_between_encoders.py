"""Logs of both encoders among other files: what they tell of the gear, and why not."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import strainwave as sw
from strainwave.identification.identify import Identified, identify
from strainwave.report.identify import identify_report

from tests.python.identification.candidates.test_elastic import TRUTH, run


def identified(folder: Path, noise: float) -> Identified:
    """From a log whose output encoder counts the other way round than the ratio of the set has it."""
    random, time = np.random.default_rng(1), run().time
    columns = {
        "time": time,
        "input_angle": run()["input_angle"],
        "output_angle": run()["output_angle"] + noise * random.standard_normal(len(time)),
        "current": run()["current"] + 0.02 * random.standard_normal(len(time)),
    }
    units = {"time": "s", "input_angle": "rad", "output_angle": "rad", "current": "A"}
    sw.Recording(columns, units).to_csv(folder / "log.csv")
    start = sw.GearSet.read("hfuc-20-50")
    sources = {f"motor.{each['name']}": sw.files.Entry("measured", uncertainty=0.0) for each in TRUTH.motor.fields}
    return identify(start.replace(motor=TRUTH.motor, sources={**start.sources, **sources}), [folder / "log.csv"])


@pytest.mark.slow("identification")
def test_a_log_tells_how_the_gear_gives_way_and_the_gear_has_it(tmp_path: Path) -> None:
    found = identified(tmp_path, 1e-5)
    told = {each.estimate.path: each.estimate for each in found.parameters}
    truths = {"gear.hysteresis.breakaway[0]": 0.8, "load.inertia": 0.8, "gear.kinematic_error.amplitude of order 2": 1e-4}
    spring = next(path for path in told if path.startswith("gear.stiffness.k"))
    for path, truth in {spring: 9e3, **truths}.items():
        assert abs(told[path].value - truth) < 4.0 * told[path].sigma, path
        assert told[path].sigma < 0.1 * truth, path
    gear: Any = found.gear_set.gear
    assert gear.hysteresis.breakaway[0] == told["gear.hysteresis.breakaway[0]"].value
    assert gear.damping == told["gear.damping"].value
    assert found.gear_set.sources["gear.damping"].source == "identified from log.csv"
    assert [each.title for each in found.files[0].pictures] == [
        "",
        "twist over torque",
        "between the shafts",
        "transmission error over a turn of the input",
    ]
    assert "log.csv, between the shafts" in identify_report(found)


@pytest.mark.slow("identification")
def test_why_encoders_tell_no_stiffness_is_said(tmp_path: Path) -> None:
    found = identified(tmp_path, 0.03)
    assert any(each.startswith("stiffness and hysteresis are not determined: up to") for each in found.files[0].remarks)
    assert not any(each.estimate.path.startswith("gear.stiffness") for each in found.parameters)
