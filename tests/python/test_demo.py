"""The demonstration identifies a joint, and a gear from document P's Table 2, and states what contradicts that."""

from __future__ import annotations

import re
import shlex

import pytest
from strainwave.commands.cli import app
from strainwave.commands.demo import NEXT
from strainwave.demo import DEMONSTRATIONS, ROBOT_LOG, TORQUE_CONSTANT, position_drive, robot_joint
from strainwave.friction import Coulomb
from typer.testing import CliRunner


@pytest.mark.slow("identification")
def test_the_joint_passes_all_checks_and_what_is_told_next_runs(tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    found = robot_joint()
    assert not found.failed
    found.gear_set.save("gear.toml")
    lines = NEXT.format(gear="gear.toml").replace("YOUR-LOG.csv", str(ROBOT_LOG)).splitlines()
    commands = [shlex.split(line)[1:] for line in lines if line.startswith("  strainwave ") and "docs" not in line]
    assert [words[0] for words in commands] == ["identify", "predict", "export"]
    assert all(f"torque_constant={TORQUE_CONSTANT}" in words for words in commands[:2])
    for words in commands:
        done = CliRunner().invoke(app, words)
        assert done.exit_code == 0, done.output


@pytest.mark.parametrize("name", ["torsion-rig", "position-drive"])
def test_names_of_published_gears_are_whole_and_without_a_code(name: str) -> None:
    found = DEMONSTRATIONS[name].identified()
    (file,) = found.files
    assert found.gear_set.name == f"gear of {file.name}"
    assert "article, Table 2" in file.name
    assert not re.search(r"E-[A-Z]\d|document [PTRA]", file.name)


def test_the_demonstration_names_its_reading_of_table_2_which_contradicts_the_others() -> None:
    found = position_drive()
    assert isinstance(found.gear_set.gear.friction_input, Coulomb)
    (check,) = found.failed
    assert "as friction" in found.files[0].name
    assert "gear.friction_input.viscous = 0.03084" in check.message
    assert "gear.friction_input.coulomb = 0.01255" in check.message
