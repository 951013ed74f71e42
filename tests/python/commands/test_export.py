"""The command `strainwave export`: files of each kind, and one line for what cannot be exported."""

from __future__ import annotations

import json
from inspect import signature
from pathlib import Path
from typing import Any
from xml.etree import ElementTree
from zipfile import ZipFile

import pytest
import strainwave as sw
import typer
from strainwave.commands.export import export
from strainwave.export import FIRMWARE, FORMS
from strainwave.export.exported import Form

from tests.python.command import refused, strainwave


@pytest.mark.slow("commands")
def test_each_kind_writes_its_files_and_numbers(tmp_path: Path) -> None:
    for words, file in (
        (("joint", "csg-20-100"), "joint.urdf"),
        (("mjcf", "csg-20-100", "--load-inertia", "1.2"), "gear.xml"),
        (("bam", "robot-joint"), "bam.json"),
    ):
        done = strainwave("export", *words, "--out", words[0], folder=tmp_path)
        assert f"{file}, " in done.stdout
        folder = tmp_path / words[0]
        assert (folder / file).exists()
        assert json.loads((folder / "export.json").read_text())["kind"] == words[0]


NO_OPTIONS = {"slot": {"motion"}, "firmware": {"folder"}}  # arguments: a motion is no text, and the folder is --out


@pytest.mark.parametrize("form", FORMS, ids=lambda form: form.verb)
def test_each_argument_of_an_export_is_an_option_with_its_default(form: Form) -> None:
    group = typer.main.get_group(export)
    verb: Any = group.get_command(typer.Context(group), form.verb)
    options = {option.name: option for option in verb.params}
    _, *others = signature(form.write).parameters.values()
    arguments = {each.name: each for each in others if each.name not in NO_OPTIONS.get(form.verb, ())}
    own = {form.model, "out", "motor", "load", "control", *(["report"] if form is FIRMWARE else [])}
    assert options.keys() - arguments.keys() == own - arguments.keys()
    assert arguments.keys() <= options.keys()
    for name, each in arguments.items():
        assert options[name].help
        assert each.default in (each.empty, options[name].default)


def test_every_export_is_a_verb(tmp_path: Path) -> None:
    functions = {name for name in sw.export.__all__ if name.islower()} - {"read_bam"}
    assert {form.write.__name__ for form in FORMS} == functions
    shown = strainwave("export", "--help", folder=tmp_path).stdout
    assert [line.split()[0] for line in shown.partition("Verbs:")[2].splitlines() if line[:3].strip()] == [
        *(form.verb for form in FORMS),
        "from-bam",
    ]


def test_a_controller_becomes_firmware(tmp_path: Path) -> None:
    done = strainwave("export", "firmware", "robot-joint", "--name", "joint", "--out", "firmware", folder=tmp_path)
    assert "wrote joint.hpp, joint.h, joint.cpp, joint_main.c to firmware, to be called every 0.00025 s" in done.stdout
    assert (tmp_path / "firmware" / "joint.cpp").exists()


def test_a_law_of_a_gear_becomes_firmware(tmp_path: Path) -> None:
    done = strainwave("export", "firmware", "csg-20-100", "--part", "gear.stiffness", "--out", "firmware", folder=tmp_path)
    assert "wrote stiffness.hpp, stiffness.h, stiffness.cpp, stiffness_main.c to firmware\n" in done.stdout


def test_a_gear_alone_gets_motor_load_and_control(tmp_path: Path) -> None:
    words = ("--motor", "DC,resistance=0.5", "--load", "Inertia,inertia=0.3", "--control", "position-drive")
    strainwave("export", "fmu", "csg-20-100", *words, "--platform", "source", "--out", "block", folder=tmp_path)
    with ZipFile(tmp_path / "block" / "CSG-20-100.fmu") as block:
        description = ElementTree.fromstring(block.read("modelDescription.xml"))
    starts = {each.attrib["name"]: each[0].get("start") for each in description.iter("ScalarVariable")}
    assert (starts["motor.resistance"], starts["load.inertia"]) == ("0.5", "0.3")
    assert "control.proportional" in starts
    assert starts["gear.stiffness.k1"] == repr(float(sw.load("csg-20-100").stiffness.k1))


def test_parameters_of_bam_become_a_gear_file(tmp_path: Path) -> None:
    strainwave("export", "bam", "robot-joint", "--out", "bam", folder=tmp_path)
    strainwave("export", "from-bam", "bam/bam.json", "--ratio", "100", "--out", "mine.toml", folder=tmp_path)
    assert "coulomb" in (tmp_path / "mine.toml").read_text()


@pytest.mark.parametrize(
    ("words", "reason"),
    [
        (("mjcf", "csg-20-100"), "--load-inertia"),
        (("mjcf", "csg-20-100", "--into", "."), "into and joint belong together"),
        (("bam", "csg-20-100"), "add a [motor] to the file"),
        (("firmware", "csg-20-100"), "give --motor and --load, as --motor robot-joint --load Inertia"),
        (("fmu", "csg-20-100", "--load", "Inertia"), "has no [motor]"),
        (("joint", "csg-20-100", "--motor", "DCC"), "--motor DCC is no model (AccelerationSource, BrushlessDC"),
        (("joint", "csg-20-100", "--motor", "DC,resistence=2"), "has no parameter 'resistence'"),
        (("joint", "csg-20-100", "--motor", "csg-20-80"), "--motor csg-20-80: that set has no [motor]"),
        (("firmware", "tilt-actuator"), "must be sampled"),
        (("firmware", "tilt-actuator", "--part", "motor"), "must be one of control, drive, gear.friction_input"),
        (("from-bam", "nothing.json", "--ratio", "100"), "nothing.json cannot be read"),
        (("mjcf", "csg-20-100", "--into", "robot.xml", "--joint", "elbow"), "robot.xml cannot be read"),
        (("joint", "csg-20-100", "--max-torque", "-5"), "max_torque = -5.0 N.m must lie in (0, inf)"),
        (("newton", "robot-joint", "--step", "5"), "step = 5 s is too coarse"),
        (("firmware", "robot-joint", "--part", "drive", "--period", "0.02"), "period = 0.02 s is too coarse"),
    ],
)
def test_what_cannot_be_exported_is_refused_in_one_line(words: tuple[str, ...], reason: str, tmp_path: Path) -> None:
    refused(tmp_path, ("export", *words), reason)
