"""The map for contributors is true: its rooms are all rooms, and the files that its pages name exist."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from tests.support.rooms import ROOT, rooms

PAGES = sorted((ROOT / "docs" / "contributing").glob("*.md"))
NAMED = re.compile(r"`((?:include|src|python|tests|docs|examples|benchmarks|\.ci|\.github)/[\w./-]+)`( \(new\))?")
MAX_MAP_LINES = 110  # of CONTRIBUTING, which a stranger reads whole


def folders(of: str) -> set[str]:
    """Return the folders in a folder, without hidden ones and those that contain nothing but bytecode."""
    inside = (path for path in (ROOT / of).iterdir() if path.is_dir() and not path.name.startswith(("_", ".")))
    return {path.name for path in inside if any(each.name != "__pycache__" for each in path.iterdir())}


def test_each_room_of_the_map_exists() -> None:
    assert [path for path in rooms() if not (ROOT / path).is_dir()] == []


GENERATED = {".": {"build", "dist", "out"}, "python/strainwave": {"docs"}}  # folders that git ignores


@pytest.mark.parametrize("of", [".", "include/strainwave", "python/strainwave", "tests"])
def test_each_folder_is_a_room_of_the_map(of: str) -> None:
    mirrored = folders("include/strainwave") if of == "tests" else set[str]()
    named = {Path(path).relative_to(of).parts[0] for path in rooms() if Path(path).is_relative_to(of) and path != of}
    assert folders(of) - mirrored - GENERATED.get(of, set()) - named == set()


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_each_file_that_a_page_names_exists_unless_it_is_new(page: Path) -> None:
    named = NAMED.findall(page.read_text(encoding="utf-8"))
    assert named
    for path, new in named:
        assert (ROOT / path).exists() != bool(new), path
        assert (ROOT / path).parent.is_dir(), path


def test_the_map_lists_every_page_and_is_short() -> None:
    text = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    listed = re.findall(r"^- \[.*?\]\(docs/contributing/(\S+)\)", text, re.MULTILINE)
    assert sorted(listed) == [page.name for page in PAGES]
    assert len(text.splitlines()) <= MAX_MAP_LINES
