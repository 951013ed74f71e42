"""No name is cut, and no code of ours stands without its words, in what catalogue, help, demonstration and reports print."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
import strainwave as sw
from strainwave.commands.cli import app
from strainwave.commands.list import description, models
from strainwave.demo import DEMONSTRATIONS
from strainwave.files import gear_file
from strainwave.report.identify import identify_report
from strainwave.report.identify_files import identify_summary
from typer.testing import CliRunner

from tests.python.report.reading import Page

PACKAGE = Path(sw.__file__).parent
CODE = re.compile(r"\bE-[A-Z]?\d+\b|\b[Dd]ocuments? (?:[A-Z]|[a-z])\b(?![a-z'’])")
CUT = re.compile(r"…|(?<!\w)\w+-$|\.\.\.$", re.MULTILINE)


def faults(text: str) -> list[str]:
    return [*CODE.findall(text), *CUT.findall(text)]


def test_a_code_and_a_cut_name_are_found() -> None:
    """The issue: `gear of document P, Table 2 (measured), read as all friction; see E-`."""
    assert faults("gear of document P, Table 2 (measured), read as all friction; see E-") == ["document P", "E-"]
    assert faults("as the loop (erratum E-T4) has it") == ["E-T4"]
    assert faults("a name that is cu…") == ["…"]
    assert faults("the document gives no numbers; size 20-100 of HFUC-20-80") == []


@pytest.mark.parametrize(
    "path", sorted([*(PACKAGE / "catalogue").rglob("*.toml"), *(PACKAGE / "rig").rglob("*.toml")]), ids=lambda path: path.stem
)
def test_sets_name_their_sources_in_words(path: Path) -> None:
    assert faults(path.read_text(encoding="utf-8")) == []


def test_published_tables_and_templates_of_pages_have_no_code() -> None:
    paths = [
        *(PACKAGE / "published").iterdir(),
        *(PACKAGE / "report").rglob("*.*"),
        *(PACKAGE / "rig" / "report").rglob("*.*"),
    ]
    texts = [path for path in paths if path.is_file() and path.suffix != ".pyc"]
    found = {path.name: CODE.findall(path.read_text(encoding="utf-8")) for path in texts}
    assert not {name: codes for name, codes in found.items() if codes}


@pytest.mark.slow("identification")
@pytest.mark.parametrize("name", DEMONSTRATIONS)
def test_the_demonstration_prints_and_writes_whole_names(name: str) -> None:
    found = DEMONSTRATIONS[name].identified()
    page = Page(identify_report(found, accepted=True)).root.text
    printed = "\n".join([DEMONSTRATIONS[name].heading, *identify_summary(found)])
    for text in (printed, page, gear_file.text(found.accepted)):
        assert faults(text) == []
    title = found.files[0].name
    assert title in page
    assert title in printed


def helps(words: tuple[str, ...] = ()) -> list[tuple[str, ...]]:
    """Every verb, and every verb below one."""
    from typer.main import get_command

    command = get_command(app)
    for word in words:
        command = command.commands[word]  # type: ignore[attr-defined]
    return [words, *(each for name in getattr(command, "commands", {}) for each in helps((*words, name)))]


@pytest.mark.parametrize("words", helps(), ids=lambda words: " ".join(words) or "strainwave")
def test_helps_have_no_code(words: tuple[str, ...]) -> None:
    assert CODE.findall(CliRunner().invoke(app, [*words, "--help"]).stdout) == []


def test_the_descriptions_of_models_have_no_code() -> None:
    texts = {name: description(name) for name in models()} | {"gear": str(sw.Gear.__doc__), "drive": str(sw.Drive.__doc__)}
    found = {name: CODE.findall(text) for name, text in texts.items()}
    assert not {name: codes for name, codes in found.items() if codes}


def test_a_gear_has_the_whole_name_of_its_file(tmp_path: Path) -> None:
    path = tmp_path / f"{'friction of the third joint of the second arm, measured cold and without load ' * 2}.csv"
    path.write_text(
        "speed [rad/s],torque [N.m]\n" + "\n".join(f"{w},{0.05 + 3e-4 * w:.6f}" for w in (2, 5, 10, 20, 50, 100, 200))
    )
    gear_set = sw.identify("hfuc-25-100", [path]).gear_set
    assert gear_set.name == f"gear of {path.stem}"
    assert f"Identified from {path.name}, starting from" in gear_set.note
