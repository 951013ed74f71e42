"""The help of every verb: complete within 80 columns, and its examples run."""

from __future__ import annotations

import re
import shlex
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import strainwave as sw
import typer
from strainwave.commands.cli import HEADINGS, app
from strainwave.commands.docs import documentation
from strainwave.commands.help import summary
from strainwave.workbench.page import is_installed

from tests.python.command import strainwave

TUTORIALS = Path(__file__).parents[3] / "examples" / "tutorials"
WEAR = "work [kJ],play [arcmin],stiffness [N.m/rad]\n0,0.34,20100\n1000,0.46,19800\n2000,0.55,19500\n"
MOVE = 'duration = 0.2\n[command]\nkind = "ramp"\nrate = 0.5\n'
# Command whose result other examples of a room read.
FIRST = {"rig": "rig simulate --positions 0 --out rehearsal"}


def verbs(command: Any = None, words: tuple[str, ...] = ()) -> Iterator[tuple[tuple[str, ...], Any]]:
    """Yield the words of every verb, with the verb; rooms too."""
    command = command or typer.main.get_command(app)
    if words:
        yield words, command
    if hasattr(command, "list_commands"):
        context = command.context_class(command)
        for name in command.list_commands(context):
            yield from verbs(command.get_command(context, name), (*words, name))


VERBS = dict(verbs())
NAMES = [" ".join(words) for words in VERBS]


def examples(verb: Any) -> list[str]:
    """Return the command lines at the end of a help."""
    text = (verb.epilog or "").partition("Examples:\n")[2].replace("\\\n", " ")
    return [line.strip() for line in text.splitlines() if line.strip()]


@pytest.mark.parametrize("name", ["", *NAMES])
def test_help_fits_80_columns_and_cuts_nothing(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "80")
    short, long = (strainwave(*name.split(), option, folder=tmp_path).stdout for option in ("-h", "--help"))
    assert short == long != ""
    assert [line for line in long.splitlines() if len(line) > 80 or (line.endswith("...") and "Usage" not in line)] == []
    for line in examples(VERBS[tuple(name.split())]) if name else []:
        assert shlex.split(line)[: 1 + len(name.split())] == ["strainwave", *name.split()], "an example of another verb"


@pytest.mark.parametrize("name", NAMES)
def test_every_verb_has_two_examples_and_a_summary_of_one_line(name: str) -> None:
    verb = VERBS[tuple(name.split())]
    assert verb.epilog is None or len(examples(verb)) == 2
    assert verb.epilog is not None or hasattr(verb, "list_commands"), "a room may have none: its verbs have them"
    room = name.rpartition(" ")[0]
    names = [each.rpartition(" ")[2] for each in NAMES if each.rpartition(" ")[0] == room]
    assert room == "export" or 2 + max(map(len, names)) + 2 + len(summary(verb)) <= 80


def test_the_help_has_the_verbs_under_headings(tmp_path: Path) -> None:
    shown = strainwave("--help", folder=tmp_path).stdout
    headings = re.split(r"^(\S.*):$", shown.partition("\n  Exit codes")[0], flags=re.MULTILINE)[3:]
    found = {
        heading: re.findall(r"^  ([\w-]+) ", rows, re.MULTILINE)
        for heading, rows in zip(headings[::2], headings[1::2], strict=True)
    }
    assert found == {heading: list(rows) for heading, rows in HEADINGS.items()}


@pytest.fixture(scope="module")
def inputs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The files that the examples name: the logs and tables of the tutorials, a gear from one of them, a move, a plan."""
    folder = tmp_path_factory.mktemp("inputs")
    for file in TUTORIALS.glob("*.csv"):
        shutil.copy(file, folder)
    plan = (TUTORIALS / "09_fault_data_plan.toml").read_text()
    (folder / "plan.toml").write_text(plan.replace("number = 60", "number = 100"))  # enough for a classifier
    (folder / "series.csv").write_text("torque_max [N.m],area [J]\n30,0.09\n45,0.2\n60,0.36\n75,0.56\n")
    (folder / "move.toml").write_text(MOVE)
    (folder / "wear.csv").write_text(WEAR)
    for load in (20.0, 40.0):  # torsion loops
        elastic = load * np.sin(np.pi * np.linspace(0.5, 4.5, 801))
        torque = elastic + (1.0 + 0.02 * np.abs(elastic)) * np.sign(np.gradient(elastic))
        loop = {"twist": elastic / 3e4, "torque": torque}
        sw.Recording(loop, {"twist": "rad", "torque": "N.m"}).to_csv(folder / f"{load:g}Nm.csv")
    made = strainwave(*["identify", "hfuc-20-80", "robot_log.csv", "--constant", "torque_constant=0.0755"], folder=folder)
    assert made.returncode == 0, made.stderr
    shutil.copy(folder / "out" / "identify" / "gear.toml", folder)
    return folder


@pytest.mark.slow("commands")
@pytest.mark.parametrize("room", dict.fromkeys(room for name in NAMES if (room := name.split()[0]) != "studio"))  # that serves
def test_every_example_runs(room: str, inputs: Path, tmp_path: Path) -> None:
    folder = Path(shutil.copytree(inputs, tmp_path / "folder"))
    lines = [line for words, verb in VERBS.items() if words[0] == room for line in examples(verb)]
    assert lines
    lines.sort(key=lambda line: FIRST.get(room, "") not in line)
    for line in lines:
        if "--camera" in line or ("--path" in line and documentation() is None) or (room == "workbench" and not is_installed()):
            continue  # needs a person, or pages that are not built
        done = strainwave(*shlex.split(line)[1:], folder=folder)
        assert done.returncode == 0, f"{line}: {done.stderr}"
