"""Numbers and parts of a model by their paths."""

from __future__ import annotations

import warnings
from typing import Any

import pytest
import strainwave as sw
from strainwave import _core

from tests.support.each import each
from tests.support.reference_drive import DRIVE

PATHS = [path for path, *_ in _core.parameters(DRIVE) if ".order" not in path and ".reduction" not in path]


@each("path", PATHS)
def test_a_number_replaced_by_its_path_is_that_number_and_no_other(path: str) -> None:
    before = {path: value for path, value, *_ in _core.parameters(DRIVE)}
    with warnings.catch_warnings(action="ignore"):  # bristles that can create energy
        drive = DRIVE.replace({path: 1.25 * before[path]})
    assert {path: value for path, value, *_ in _core.parameters(drive)} == before | {path: 1.25 * before[path]}


def test_parts_whole_numbers_and_names_are_replaced_by_their_paths_too() -> None:
    gear = sw.load("hfuc-25-100")
    changed = gear.replace(
        {"stiffness": sw.stiffness.Cubic(a1=1e4, a3=1e9), "stiffness.a3": 2e9, "kinematics.flexspline_teeth": 100}, damping=3.0
    )
    assert (changed.stiffness.a3, changed.kinematics.flexspline_teeth, changed.damping) == (2e9, 100, 3.0)


@each(
    ("changes", "message"),
    [
        ({"gear.stiffnes.k1": 2e4}, "the model has no parameter"),
        ({"gear.stiffness.k9": 2e4}, "has no parameter 'k9'"),
        ({"gear.hysteresis.stiffness[99]": 1.0}, "the model has no parameter"),
        ({"gear.hysteresis.stiffness[\u0660]": 1.0}, "the model has no parameter"),
        ({f"gear.hysteresis.stiffness[{5000 * '9'}]": 1.0}, "the model has no parameter"),
        ({"load.inertia": 10**400}, "pendulum.inertia must be a number, not 1000"),
        ({"load.inertia": -1.0}, r"pendulum.inertia = -1 kg.m2 must lie in \(0, inf\)"),
        ({3: 1.0}, "the path of a parameter"),
    ],
)
def test_what_is_no_path_is_told(changes: dict[Any, Any], message: str) -> None:
    with pytest.raises((TypeError, ValueError), match=message):
        DRIVE.replace(changes)
