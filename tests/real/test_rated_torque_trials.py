"""Logs whose torque is a share of a rated torque, of a joint whose numbers are known."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
import strainwave as sw
from strainwave.identification.reading.mapping import FileMapping

TRIALS = Path(os.environ.get("STRAINWAVE_TRIALS", Path(__file__).parents[3] / "shared" / "trials"))
FRICTION = {"gear.friction_input.coulomb": 0.060, "gear.friction_input.viscous": 4e-4, "load.gravity_torque": 25.0}
SPRING = {
    "gear.stiffness.a1": 1.6e4, "gear.stiffness.a3": 3e9, "gear.hysteresis.stiffness[0]": 3e3, "gear.damping": 20.0,
    "gear.hysteresis.breakaway[0]": 1.0, "load.inertia": 1.2,
}  # fmt: skip
UNITS = {
    "epos/permille.csv": {"Torque actual value": "permille of 0.4 N.m"},
    "twincat/scope_single.csv": {"Motor position": "counts/1048576", "Axis1.ActTorque": "permille of 0.4 N.m"},
}

pytestmark = pytest.mark.skipif(not TRIALS.is_dir(), reason=f"trials not found: {TRIALS} (set STRAINWAVE_TRIALS)")


@pytest.mark.slow("identification")
@pytest.mark.parametrize(("name", "truth"), [("epos/permille.csv", FRICTION), ("twincat/scope_single.csv", FRICTION | SPRING)])
def test_the_plus_minus_of_every_number_contains_the_truth(name: str, truth: dict[str, float]) -> None:
    found = sw.identify("csg-20-100", [TRIALS / name], mapping=FileMapping(units=UNITS[name]))
    numbers = {each.estimate.path: each.estimate for each in found.parameters}
    for path, value in truth.items():
        assert abs(numbers[path].value - value) < 2.0 * numbers[path].sigma < 0.1 * value, path
    (validation,) = found.gear_set.validation
    low, high = validation.measured["output_torque"]
    assert -26.0 < low < -15.0 < 15.0 < high < 26.0  # of gravity alone 22 N.m, at the ends of the motion
    assert validation.measured.keys() == {"input_speed", "output_torque", "output_angle"}
