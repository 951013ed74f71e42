"""Gear files: what is read."""

from __future__ import annotations

import math
import subprocess
import sys
from pathlib import Path

import pytest
import strainwave as sw
from strainwave.files.entries import Entry
from strainwave.files.gear_set import GearSet

from tests.python.files.gear_file_texts import BASE, with_line


def test_numbers_in_other_units_are_converted_to_si(folder: Path) -> None:
    text = with_line("a1", 'a1 = { value = 12.5, unit = "N.m/deg", uncertainty = 0.4, source = "x" }')
    text = text.replace("2e6", "2e3").replace("N.m/rad3", "kN.m/rad3")
    text += """
[kinematic_error]
model = "fourier"
order = { value = [2.0], source = "x" }
amplitude = { value = [3.0], unit = "arcmin", source = "x", spread = 0.5 }
phase = { value = [90.0], unit = "°", source = "x" }
[friction_input]
model = "stribeck"
coulomb = { value = 20.0, unit = "mN.m", source = "x" }
breakaway = { value = 3.0, unit = "Ncm", source = "x" }
stribeck_speed = { value = 10.0, unit = "rpm", source = "x" }
viscous = { value = 0.1, unit = "mN.m.s/rad", source = "x" }
[gear]
damping = { value = 1, unit = "N.m.s/rad", source = "x" }
input_inertia = { value = 21.0, unit = "g.cm2", source = "x" }
"""
    Path("my.toml").write_text(text, encoding="utf-8")
    gear_set = GearSet.read("my.toml")
    gear = gear_set.gear
    assert gear.stiffness.a1 == pytest.approx(12.5 * 180 / math.pi, rel=1e-15)
    assert gear.stiffness.a3 == 2e6
    assert gear.kinematic_error.amplitude[0] == pytest.approx(3 * math.pi / 10_800, rel=1e-15)
    assert gear.kinematic_error.phase[0] == pytest.approx(math.pi / 2, rel=1e-15)
    assert gear.friction_input.coulomb == pytest.approx(0.02, rel=1e-15)
    assert gear.friction_input.breakaway == pytest.approx(0.03, rel=1e-15)
    assert gear.friction_input.stribeck_speed == pytest.approx(math.pi / 3, rel=1e-15)
    assert gear.friction_input.viscous == pytest.approx(1e-4, rel=1e-15)
    assert gear.damping == 1.0
    assert gear.input_inertia == pytest.approx(2.1e-6, rel=1e-15)
    uncertainty = gear_set.sources["gear.stiffness.a1"].uncertainty
    assert uncertainty == pytest.approx(0.4 * 180 / math.pi, rel=1e-15)
    assert gear_set.sources["gear.kinematic_error.amplitude[0]"].spread == 0.5  # relative: the same in every unit


def test_a_table_left_out_does_nothing_and_says_so(folder: Path) -> None:
    Path("my.toml").write_text(BASE)
    gear_set = GearSet.read("my.toml")
    gear = gear_set.gear
    assert gear.kinematics == sw.kinematics.PlainRatio(reduction=20.0)
    assert gear.kinematic_error.error(1.0) == 0.0
    assert gear.friction_input.steady(3.0) == gear.friction_output.steady(3.0) == 0.0
    assert not gear.hysteresis.trace([0.0, 1e-3]).any()
    assert gear.damping == gear.input_inertia == 0.0
    not_given = {path for path, entry in gear_set.sources.items() if entry == Entry("not given")}
    noise = {f"gear.kinematic_noise.{field['name']}" for field in gear.kinematic_noise.fields}
    friction = {f"gear.friction_{place}.viscous" for place in ("input", "mesh", "output")}
    softening = {f"gear.softening.{field['name']}" for field in gear.softening.fields}
    assert not_given == noise | friction | softening | {"gear.damping", "gear.input_inertia"}
    gear_set.save("again.toml")
    assert GearSet.read("again.toml") == gear_set


def test_each_number_of_a_sequence_can_have_its_own_source(folder: Path) -> None:
    Path("my.toml").write_text(
        BASE
        + """
[hysteresis]
model = "maxwell_slip"
stiffness = { value = [300, 150.0], unit = "N.m/rad", source = "loop" }
breakaway = [
    { value = 200.0, unit = "mN.m", source = "loop", uncertainty = 30.0 },
    { value = 0.4, unit = "N.m", source = "assumed" },
]
"""
    )
    gear_set = GearSet.read("my.toml")
    assert gear_set.gear.hysteresis == sw.hysteresis.MaxwellSlip(stiffness=[300.0, 150.0], breakaway=[0.2, 0.4])
    sources = {path: entry for path, entry in gear_set.sources.items() if path.startswith("gear.hysteresis.")}
    assert sources == {
        "gear.hysteresis.stiffness[0]": Entry("loop"),
        "gear.hysteresis.stiffness[1]": Entry("loop"),
        "gear.hysteresis.breakaway[0]": Entry("loop", uncertainty=0.03),
        "gear.hysteresis.breakaway[1]": Entry("assumed"),
    }
    gear_set.save("again.toml")
    assert GearSet.read("again.toml") == gear_set


def test_a_byte_order_mark_and_windows_line_ends_are_no_matter(folder: Path) -> None:
    Path("my.toml").write_text(BASE)
    Path("windows.toml").write_bytes(b"\xef\xbb\xbf" + BASE.replace("\n", "\r\n").encode())
    assert GearSet.read("windows.toml") == GearSet.read("my.toml")


def test_importing_the_module_imports_no_heavy_one() -> None:
    code = "import strainwave.files.gear_file, sys; print({'pydantic', 'tomlkit'} & sys.modules.keys())"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "set()"
