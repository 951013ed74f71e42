"""The report of a compensation: what is on its page, beside the numbers that it was made from."""

from __future__ import annotations

import json
import tomllib

import pytest
import strainwave as sw
from strainwave.report.compensate import compensate_files, compensate_summary, verdict

from tests.python.report.reading import Page


@pytest.fixture(scope="module")
def found() -> sw.Compensated:
    return sw.compensate("robot-joint", members=3, travel=0.05)


@pytest.fixture(scope="module")
def files(found: sw.Compensated) -> dict[str, str]:
    return compensate_files(found)


def test_the_page_needs_nothing_else_and_has_every_controller(found: sw.Compensated, files: dict[str, str]) -> None:
    root = Page(files["report.html"]).root
    assert not [each for each in root.walk() if each.tag in ("script", "link", "img")]
    rows = [each.text for each in root.find("section", id="controllers")[0].find("tr")][1:]
    assert len(rows) == len(found.tried)
    assert all(row.startswith(each.candidate.name) for row, each in zip(rows, found.tried, strict=True))
    assert next(row for row in rows if "(chosen)" in row).startswith(found.chosen.candidate.name)
    assert files == compensate_files(found)


def test_the_controller_alone_is_that_of_the_drive(files: dict[str, str]) -> None:
    drive, alone = (tomllib.loads(files[name]) for name in ("drive.toml", "compensation.toml"))
    assert alone == {"control": drive["control"]}


def test_the_numbers_are_those_of_the_result(found: sw.Compensated, files: dict[str, str]) -> None:
    numbers = json.loads(files["results.json"])
    assert numbers["chosen"] == found.chosen.candidate.name
    for written, each in zip(numbers["controllers"], found.tried, strict=True):
        assert written["median"]["tracking error"] == pytest.approx(each.median("tracking error"))


def test_the_verdict_is_the_first_line_and_each_effect_is_named(found: sw.Compensated) -> None:
    first, *rest = compensate_summary(found).splitlines()
    assert first == verdict(found).replace("\N{NO-BREAK SPACE}", " ")
    assert f"(−{100.0 * found.gain:.0f} %)" in first if found.is_compensated else "no compensation gains" in first
    effects = {line.split(":")[0].strip() for line in rest if "its model" in line}
    assert effects == {"torsion", "kinematic error"}  # friction is the line that the cascade has, too
