"""The demonstration identifies a joint, and a gear from document P's Table 2, and states what contradicts that."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import pytest
from strainwave.commands.cli import app
from strainwave.commands.demo import OWN_LOG
from strainwave.demo import DEMONSTRATIONS, ROBOT_LOG, TORQUE_CONSTANT, position_drive
from strainwave.friction import Coulomb
from strainwave.report.first_screen import next_commands
from typer.testing import CliRunner


@pytest.mark.slow("identification")
@pytest.mark.parametrize("name", DEMONSTRATIONS)
def test_the_commands_of_each_gear_run_and_name_its_files(name: str, tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    found, folder = DEMONSTRATIONS[name].identified(), Path("out", name)
    folder.mkdir(parents=True)
    found.gear_set.save(folder / "gear.toml")
    commands = [shlex.split(command) for _, command in next_commands(found, folder)]
    assert len(commands) == 3
    for words in commands:
        assert str(folder / "gear.toml") in words
        assert "out/" not in shlex.join(words).replace(f"{folder}/", "")
        if words[1] in ("export", "predict"):
            assert words[-2] == "--out"
            assert Path(words[-1]).parent == folder
        done = CliRunner().invoke(app, words[1:])
        assert done.exit_code == 0, done.output
    if name == "robot-joint":
        assert not found.failed
        assert str(ROBOT_LOG) in commands[0]


@pytest.mark.slow("identification")
def test_the_command_for_an_own_log_runs() -> None:
    (words,) = (shlex.split(line) for line in OWN_LOG.splitlines() if "identify" in line)
    assert f"torque_constant={TORQUE_CONSTANT}" in words
    done = CliRunner().invoke(app, [str(ROBOT_LOG) if word == "YOUR-LOG.csv" else word for word in words[1:]])
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
    assert "gear.friction_input.viscous = 0.0308 ± 0.0023 N·m·s/rad, 34.6 σ above" in check.message
    assert "gear.friction_input.coulomb = 0.0126 ± 0.0034 N·m, 6.1 σ below" in check.message
