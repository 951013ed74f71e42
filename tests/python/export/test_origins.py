"""Origin of the numbers of a gear in the files of every export."""

from __future__ import annotations

from io import BytesIO
from pathlib import Path
from typing import cast
from xml.etree import ElementTree
from zipfile import ZipFile

import pytest
import strainwave as sw
import yaml
from strainwave.export import FIRMWARE, FORMS
from strainwave.export.exported import ORIGINS_FILE, Exported
from strainwave.files.identified_tables import Validation

JOINT = sw.GearSet.read("robot-joint")
DAMPING = "gear.damping"
MEASURED = Validation("run-a.csv", "log", "current", "A", 0.1, 1.0, 0.1, 1.0, measured={"input_speed": (-90.0, 120.0)})
IDENTIFIED = JOINT.replace(
    sources={**JOINT.sources, DAMPING: sw.files.Entry("identified from run--a.csv", uncertainty=1e-6)}, validation=(MEASURED,)
)
RANGE = "run-a.csv: input speed -90 to 120 rad/s; output torque, output angle, temperature not known"
LINE = f"{DAMPING} = {JOINT.gear.damping:.6g} ± 1e-06 N.m.s/rad, identified from run"


@pytest.mark.parametrize(
    ("found", "files"),
    [
        (sw.export.joint(IDENTIFIED), ["joint.xml", "joint.urdf"]),
        (sw.export.mjcf(IDENTIFIED), ["gear.xml"]),
        (sw.export.ros2(IDENTIFIED, name="elbow"), ["elbow.xacro", "elbow_controllers.yaml", "drive_node.py"]),
        (sw.export.fmu(IDENTIFIED, platforms=(), name="block"), [ORIGINS_FILE]),
        (sw.export.slot(IDENTIFIED, "coulomb-viscous"), [ORIGINS_FILE]),
        (sw.export.bam(IDENTIFIED), [ORIGINS_FILE]),
        (sw.export.newton(IDENTIFIED, gpu=False, compare=False), ["__init__.py", "drive.hpp", "README.md"]),
    ],
    ids=lambda each: each.kind if isinstance(each, Exported) else "",
)
def test_files_state_what_was_identified_and_are_read_as_without(found: Exported, files: list[str]) -> None:
    for name in files:
        text = found.files[name]
        assert isinstance(text, str)
        assert LINE in text
        assert "gear.input_inertia = " in text
        assert RANGE in text
        if name.endswith((".xml", ".urdf", ".xacro")):
            ElementTree.fromstring(text)
        elif name == "drive.hpp":
            assert text.startswith("// numbers of Robot joint\n// identified")
        elif name.endswith(".yaml"):
            assert isinstance(yaml.safe_load(text), dict)
        elif name.endswith(".py"):
            compile(text, name, "exec")
    assert found.remarks[-1] == f"its identified numbers were measured by {RANGE}; nothing checks them beyond"


def test_an_fmu_states_in_its_documentation_what_was_identified() -> None:
    with ZipFile(BytesIO(cast(bytes, sw.export.fmu(IDENTIFIED, platforms=(), name="block").files["block.fmu"]))) as block:
        page = block.read("documentation/index.html").decode()
    assert LINE in page
    assert RANGE in page
    assert "gear.input_inertia = " in page


def test_every_export_states_that_a_log_counts_its_current_the_other_way() -> None:
    why = "assumed; in a.csv current is counted against the motion, so, current of the log = -current of the model"
    turned = IDENTIFIED.replace(sources={**IDENTIFIED.sources, "motor.inertia": sw.files.Entry(why)})
    for found, file in ((sw.export.joint(turned), "joint.xml"), (sw.export.mjcf(turned), "gear.xml")):
        assert f"motor.inertia: {why}" in found.remarks
        assert why in str(found.files[file])
    assert not any("of the log" in each for each in sw.export.joint(IDENTIFIED).remarks)


@pytest.mark.slow("export")
@pytest.mark.usefixtures("kept_builds")
def test_compiled_exports_state_what_was_identified() -> None:
    plugin = sw.export.mujoco_plugin(IDENTIFIED).files
    package = sw.export.modelica(IDENTIFIED, name="Joint").files
    for text in (plugin["gear.xml"], package["Joint/package.mo"], package["Joint/Resources/Include/joint.h"]):
        assert LINE in str(text)
        assert RANGE in str(text)


def test_firmware_and_gear_files_state_what_was_identified(tmp_path: Path) -> None:
    written = sw.export.firmware(IDENTIFIED, tmp_path, part="gear.friction_input")
    IDENTIFIED.save(tmp_path / "gear.toml")
    for path, comment in ((written.header, "//   "), (written.source, "//   "), (tmp_path / "gear.toml", "#   ")):
        assert {f"{comment}{LINE}--a.csv", f"{comment}{RANGE}"} <= set(path.read_text().splitlines())
    assert sw.GearSet.read(tmp_path / "gear.toml") == IDENTIFIED


def test_every_export_states_origins_but_not_those_of_a_set_of_which_nothing_was_identified() -> None:
    assert [form for form in FORMS if not hasattr(form.write, "__wrapped__")] == [FIRMWARE]
    assert JOINT.origins == []
    assert "<!--" not in str(sw.export.mjcf(JOINT).files["gear.xml"])
    assert not any("were measured" in each for each in sw.export.joint(JOINT).remarks)


def test_an_export_of_an_accepted_gear_states_that_a_check_failed() -> None:
    accepted = sw.export.joint(IDENTIFIED.replace(note="Accepted in spite of failed checks: run.csv: its friction is large."))
    assert accepted.remarks[-1].endswith("nothing checks them beyond; a check failed, as the note of the gear states")
    (heading,) = (each for each in IDENTIFIED.replace(note=JOINT.note).origins if each.startswith("identified numbers"))
    assert "failed" not in heading
