"""Friction under load and dynamometer tables, identified at the first command."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from strainwave.identification.identify import identify

TRIALS = Path(os.environ.get("STRAINWAVE_TRIALS", Path(__file__).parents[3] / "shared" / "trials"))
FOLDER = TRIALS / "loadloss"
TRUTH = {"gear.friction_input.coulomb": 0.050, "gear.friction_input.viscous": 3e-4}  # by the README of the trials
LOSS = 0.2
QUADRANTS = ("driving_forward", "driving_reverse", "backdriving_forward", "backdriving_reverse")

pytestmark = pytest.mark.skipif(not FOLDER.is_dir(), reason=f"trials not found: {FOLDER} (set STRAINWAVE_TRIALS)")


@pytest.mark.slow("identification")
@pytest.mark.parametrize(
    ("name", "quadrants"),
    [
        ("friction_load", QUADRANTS),
        ("dyno", QUADRANTS),
        ("dyno_driving_only", ("driving_reverse",)),
    ],  # the mesh turns backwards
)
def test_friction_and_the_loss_under_load_are_those_of_the_gear(name: str, quadrants: tuple[str, ...]) -> None:
    found = identify("csg-20-100", [FOLDER / f"{name}.csv"])
    numbers = {each.estimate.path: each.estimate for each in found.parameters}
    truth = TRUTH | {f"gear.friction_mesh.{each}": LOSS for each in quadrants}
    assert numbers.keys() == truth.keys()
    for path, value in truth.items():
        assert abs(numbers[path].value - value) < 3.0 * numbers[path].sigma < 0.1 * value, path
    identified = {path for path, entry in found.gear_set.sources.items() if entry.source.startswith("identified")}
    assert identified == truth.keys()
