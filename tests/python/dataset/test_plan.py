"""Plans that contradict themselves, the drive or the disk are refused before the first run, in one line with key and value."""

from __future__ import annotations

import shutil
from collections import namedtuple
from pathlib import Path
from typing import Any

import pytest
from strainwave.dataset.make import estimate
from strainwave.dataset.plan import DatasetPlan
from strainwave.dataset.shards import Shards

from tests.python.dataset.plans import SMALL, changed, population, write

CONDITION = SMALL["conditions"][0]


def condition(**changes: Any) -> dict[str, Any]:
    return changed(conditions=[CONDITION | changes])


CONTRADICTIONS = [
    (changed(units={"number": 0}), r"units\.number = 0"),
    (changed(units={"number": 4, "spread": {"motor.resistance": {"low": 2.0, "high": 1.0}}}), "low = 2 is above high = 1"),
    (changed(units={"number": 4, "spread": {"motor.resistance": {}}}), "give one of them"),
    (changed(units={"number": 4, "design": "sobl"}), r"units\.design = 'sobl'"),
    (condition(numbers={"speed": {"low": 1.0, "high": 0.5}}), "low = 1 is above high = 0.5"),
    (condition(profile="hover"), 'profile = "hover" is not known; there are constant_speed'),
    (condition(numbers={}), r"needs the numbers speed \[rad/s\]; there are none"),
    (condition(temperature=20.0), r"temperature = 20 must lie in \[150, 500\] K"),
    (condition(number=10**6), r"number = 1000000"),
    (condition(design="grid", number=5, temperature={"low": 270.0, "high": 300.0}), "take 4 or 9"),
    (changed(splits={"train": 0.9, "test": 0.2}), r"train \+ validation \+ test = 1.25 must be 1"),
    (changed(faults=[{"kind": "crack", "share": 0.5, "severity": 1.5}]), r"severity = 1.5 must lie in \[0, 1\]"),
    (changed(faults=[{"kind": "a", "share": 0.6}, {"kind": "b", "share": 0.6}]), "shares of the faults sum to 1.2"),
    (changed(faults=[{"kind": "a", "share": 0.1}, {"kind": "a", "share": 0.1}]), "different kinds"),
    (changed(simulation={"duration": 0.1, "sample": 2e-2}), "at most a tenth"),
    (changed(simulation={"dt": 4e-3}), "dt = 0.004 s must be at most sample"),
    (changed(simulation={"duration": 3600.0, "sample": 1e-3}), "3.6e[+]06 samples"),
    (changed(features={"start": 0.09}), "at most half"),
    (changed(features={"orders": [2, 2.02]}), "increase by at least 0.5"),
    (changed(script="import os"), "script is no key of a plan"),
    ({key: value for key, value in SMALL.items() if key != "units"}, "units is missing"),
    (changed(units={"number": float("nan")}), r"units\.number = nan"),
    (condition(load_torque=float("inf")), "load_torque = inf"),
    (changed(units={"number": 10**12}, conditions=[CONDITION | {"number": 1000}]), r"1e\+15 members; at most 1e\+12"),
]


@pytest.mark.parametrize(("content", "said"), CONTRADICTIONS, ids=[said[:30] for _, said in CONTRADICTIONS])
def test_a_plan_that_contradicts_itself_is_refused(content: dict[str, Any], said: str) -> None:
    with pytest.raises(ValueError, match=said) as error:
        DatasetPlan.of(content)
    assert "\n" not in str(error.value)


def test_the_small_plan_is_sound() -> None:
    population(SMALL).check()


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (changed(drive="no-such-drive"), "no-such-drive"),
        (changed(drive="csg-20-100"), "a drive needs a motor"),
        (changed(units={"number": 4, "spread": {"motor.resistence": {"relative": 0.1}}}), r"near it are motor\.resistance"),
        (changed(units={"number": 4, "spread": {"motor.resistance": {"low": -1.0, "high": 1.0}}}), "must lie in"),
        (changed(units={"number": 4, "catalogue_spread": True}), "states no spread"),
        (changed(units={"number": 5, "design": "grid", "spread": {"motor.resistance": {"relative": 0.1}}}), None),
        (
            changed(
                units=SMALL["units"] | {"number": 5, "design": "grid"},
            ),
            "take 4 or 9 for the units",
        ),
        (changed(simulation={"dt": 2e-2, "sample": 2e-2}), "dt = 0.02 s is too coarse"),
        (changed(simulation={"sample": 2e-2}), "alias; take simulation.sample ="),
        (changed(samples={"columns": ["colour"]}), 'no output "colour"'),
    ],
)
def test_a_plan_that_contradicts_its_drive_is_refused(content: dict[str, Any], said: str | None) -> None:
    if said is None:
        population(content).check()
        return
    with pytest.raises((ValueError, FloatingPointError), match=said):
        population(content).check()


def test_a_data_set_larger_than_the_disk_is_refused_before_the_first_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    small = namedtuple("Usage", "total used free")(10**6, 10**6 - 1000, 1000)
    monkeypatch.setattr(shutil, "disk_usage", lambda place: small)
    monkeypatch.setattr(Shards, "tables", None)  # no run
    whole = Shards(population(changed(units={"number": 10**9})))
    with pytest.raises(OSError, match=r"takes at least 32 GB, and .* has 1e-06 GB free; take fewer members"):
        estimate(whole, tmp_path / "new", 2)


def test_an_unreadable_plan_names_its_file(tmp_path: Path) -> None:
    path = tmp_path / "plan.toml"
    path.write_text("name = ")
    with pytest.raises(ValueError, match=r"plan\.toml: is not valid TOML"):
        DatasetPlan.read(path)


def test_comments_and_order_do_not_change_the_digest(tmp_path: Path) -> None:
    path = write(tmp_path)
    turned = DatasetPlan.of(dict(reversed(list(SMALL.items()))))
    path.write_text("# a comment\n" + path.read_text())
    assert DatasetPlan.read(path).digest == turned.digest == DatasetPlan.of(SMALL).digest
    assert DatasetPlan.of(changed(seed=6)).digest != turned.digest
