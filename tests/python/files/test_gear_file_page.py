"""Gear files: the page that documents them is right."""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import Any

import pytest
import strainwave as sw
from strainwave.files.entries import Entry
from strainwave.files.gear_set import GearSet, load

from tests.python.files.test_gear_file_refusals import REFUSED

ROOT = Path(__file__).resolve().parents[3]
DOCUMENT = (ROOT / "docs" / "reference" / "gear-files.md").read_text(encoding="utf-8")


def blocks(language: str) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", DOCUMENT, re.DOTALL)


def write_examples() -> None:
    """The files of the page, each under the name its first line gives."""
    for example in blocks("toml"):
        Path(example.partition("\n")[0].removeprefix("# ")).write_text(example, encoding="utf-8")


def test_the_examples_of_the_page_are_read_as_they_are_meant(folder: Path) -> None:
    write_examples()
    gear_set = GearSet.read("mine.toml")
    assert gear_set.gear.kinematics.ratio == -20.0
    assert gear_set.gear.stiffness.a1 == pytest.approx(12.5 * 180 / math.pi, rel=1e-15)
    assert gear_set.gear.friction_input.breakaway == pytest.approx(0.025, rel=1e-15)
    assert gear_set.motor.inertia == pytest.approx(5e-6, rel=1e-15)
    run = sw.simulate(gear_set.drive, sw.scenario.step(amplitude=3.0, duration=0.1))
    assert run["input_angle"][-1] > 1.0
    assert load("mine.toml") == gear_set.drive
    varying = load("varying.toml")
    law = sw.friction.Coulomb(coulomb=0.02, breakaway=0.025, viscous=1e-4)
    assert varying.friction_input.law.law == law
    assert varying.friction_input.steady(1.0, angle=math.pi / 4) == pytest.approx(1.1 * law.steady(1.0), rel=1e-12)
    assert varying.friction_mesh.steady(1.0, load=5.0) == pytest.approx(1.0, rel=1e-12)
    assert varying.kinematic_noise.amplitude == pytest.approx(math.radians(0.1 / 60.0), rel=1e-14)
    assert varying.hysteresis.trace([0.0, math.radians(0.1)])[-1] == pytest.approx(0.2, rel=1e-12)


def test_the_gear_of_stages_of_the_page_is_read_as_it_is_meant(folder: Path) -> None:
    write_examples()
    gear = load("staged.toml")
    assert gear.structure.mesh_stiffness == pytest.approx(1e8, rel=1e-15)
    assert gear.structure.radial_mass == pytest.approx(gear.structure.flexspline_inertia / gear.structure.pitch_radius**2)
    assert gear.structure.bearing_variation == sw.variation.Periodic(order=[10], amplitude=[0.02], phase=[0.0])
    assert gear.structure.mesh_variation == sw.variation.Constant()
    assert gear.stiffness_variation.amplitude == (0.05,)
    gear_set = GearSet.read("staged.toml")
    gear_set.save("copy.toml")
    assert GearSet.read("copy.toml") == gear_set


def test_the_whole_drive_of_the_page_is_read_and_runs(folder: Path) -> None:
    write_examples()
    gear_set = GearSet.read("joint.toml")
    assert gear_set.control.period == pytest.approx(1e-3, rel=1e-15)
    assert gear_set.gear.friction_input.stribeck_speed == pytest.approx(math.pi, rel=1e-15)
    assert gear_set.thermal.initial_temperature == pytest.approx(293.15, rel=1e-15)
    run = sw.simulate(gear_set, sw.scenario.step(amplitude=0.2, duration=1.0))
    assert run["output_angle"][-1] == pytest.approx(0.2, rel=0.05)
    supplied, lost = run["energy_supplied"][-1], sum(run[name][-1] for name in run.names if name.startswith("energy_friction"))
    assert supplied > lost > 0.0
    gear_set.save("copy.toml")
    assert GearSet.read("copy.toml") == gear_set


def test_the_file_of_the_page_on_a_set_of_the_catalogue_has_its_tables(folder: Path) -> None:
    write_examples()
    arm, gear = GearSet.read("arm.toml"), GearSet.read("csg-25-100")
    assert (arm.name, arm.maker, arm.note) == ("Arm on the bench", "", "")
    assert (arm.gear, arm.ratings, arm.drive.load.inertia) == (gear.gear, gear.ratings, 0.5)
    assert gear.sources.items() <= arm.sources.items()
    arm.save("copy.toml")
    assert "base" not in Path("copy.toml").read_text(encoding="utf-8")
    assert GearSet.read("copy.toml") == arm


def test_the_code_of_the_page_runs(folder: Path) -> None:
    write_examples()
    names: dict[str, Any] = {}
    for code in blocks("python"):
        exec(code, names)
    assert load("new.toml") == load("mine.toml")
    assert load("gear.toml") == load("mine.toml").gear
    assert GearSet.read("copy.toml") == GearSet.read("mine.toml")
    assert load("changed.toml").gear.friction_input.coulomb == 0.0213
    assert names["varying"].sources["gear.friction_input.law.amplitude[0]"] == Entry("slow run, one turn")


def test_the_errors_of_the_page_are_those_one_sees() -> None:
    (shown,) = blocks("text")
    seen = set(REFUSED.values()) | {"my.toml cannot be read: No such file or directory"}
    assert {line for line in shown.splitlines() if "valid TOML" not in line} <= seen
