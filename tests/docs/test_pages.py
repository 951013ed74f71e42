"""README and pages: the names in them exist, and a page that refers to a document gives its title."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
import strainwave as sw
import typer
from strainwave import _core
from strainwave.commands.cli import app

ROOT = Path(__file__).resolve().parents[2]
README = (ROOT / "README.md").read_text(encoding="utf-8")
PAGES = [page for page in sorted((ROOT / "docs").rglob("*.md")) if page.name != "errata.md"]
VERBS = typer.main.get_command(app).commands  # type: ignore[attr-defined]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_a_page_that_refers_to_a_document_gives_its_title(page: Path) -> None:
    errata = (ROOT / "docs" / "validation" / "errata.md").read_text(encoding="utf-8")
    titles = dict(re.findall(r'^\| \*\*([RPAT])\*\* \| "([^"]+)"', errata, re.MULTILINE))
    text = " ".join(page.read_text(encoding="utf-8").split())
    assert [letter for letter in sorted(set(re.findall(r"[Dd]ocument ([RPAT])\b", text))) if titles[letter] not in text] == []


def test_the_names_in_the_readme_exist() -> None:
    names = set(re.findall(r"`sw\.(\w+)", README))
    assert len(names) > 30
    assert sorted(name for name in names if not hasattr(sw, name)) == []
    verbs = re.findall(r"`strainwave ([\w-]+)", README)
    assert [verb for verb in verbs if verb not in VERBS] == []


def test_the_guide_to_the_models_has_a_row_for_each_that_can_be_chosen() -> None:
    guide = (ROOT / "docs" / "how-to" / "which-model.md").read_text(encoding="utf-8")
    rows = " ".join(row.split("|")[1] for row in guide.splitlines() if row.startswith("|"))
    names = {kind.__name__ for family, kinds in _core.families.items() if family != "kinematics" for kind in kinds.values()}
    without_effect = {"Constant", "NoDither", "NoFeedforward", "NoLearning", "NoMeter", "NoObserver"}
    assert names - without_effect - set(re.findall(r"\b\w+", rows)) == set()


def test_the_guide_to_the_command_lists_its_verbs() -> None:
    guide = (ROOT / "docs" / "how-to" / "command-line.md").read_text(encoding="utf-8")
    table = guide.partition("| verb | what it does |\n")[2].partition("\n\n")[0]
    listed = [verb for row in table.splitlines()[1:] for verb in re.findall(r"`([\w-]+)`", row.split("|")[1])]
    assert sorted(listed) == sorted(VERBS)


def test_the_readme_counts_the_sets_of_the_catalogue() -> None:
    gears, drives = sw.catalogue(), sw.catalogue("drives")
    series = {name.partition("-")[0] for name in gears}
    assert (len(gears), len(series), len(drives)) == (127, 3, 8)
    assert "127 gear sets of three series and eight [whole drives]" in README
