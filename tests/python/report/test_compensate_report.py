"""The report of a compensation: what is on its page, beside the numbers that it was made from."""

from __future__ import annotations

import json
import tomllib
from dataclasses import replace

import numpy as np
import pytest
import strainwave as sw
from strainwave.report.compensate import compensate_files, compensate_summary, too_much
from strainwave.tuning.judging import OverCompensation

from tests.python.report.reading import Page
from tests.support.compensated_joint import robot_joint


@pytest.fixture(scope="module")
def found() -> sw.tuning.Compensated:
    return robot_joint()


@pytest.fixture(scope="module")
def files(found: sw.tuning.Compensated) -> dict[str, str]:
    return compensate_files(found)


@pytest.mark.slow("report")
def test_the_page_needs_nothing_else_and_has_every_controller(found: sw.tuning.Compensated, files: dict[str, str]) -> None:
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


def test_the_numbers_are_those_of_the_result(found: sw.tuning.Compensated, files: dict[str, str]) -> None:
    numbers = json.loads(files["results.json"])
    assert numbers["chosen"] == found.chosen.candidate.name
    for written, each in zip(numbers["controllers"], found.tried, strict=True):
        assert written["median"]["tracking error"] == pytest.approx(each.median("tracking error"))


def test_the_verdict_is_the_first_line_and_each_effect_is_named(found: sw.tuning.Compensated) -> None:
    first, *rest = compensate_summary(found).splitlines()
    assert first == found.verdict.replace("\N{NO-BREAK SPACE}", " ")
    assert f"(−{100.0 * found.gain:.0f} %)" in first if found.is_compensated else "no compensation gains" in first
    assert "in the median of 3 gears drawn anew" in first
    assert rest[0].strip() == "tracking error on the gears by which one was chosen, and median of settling time:"
    effects = {line.split(":")[0].strip() for line in rest if "its model" in line}
    assert effects == {"torsion", "kinematic error"}  # friction is the line that the cascade has, too


def test_margins_conditions_and_less_of_an_effect_are_on_the_page_and_among_the_numbers(
    found: sw.tuning.Compensated, files: dict[str, str]
) -> None:
    root, numbers = Page(files["report.html"]).root, json.loads(files["results.json"])
    rows = [each.text for each in root.find("section", id="conditions")[0].find("tr")]
    assert len(rows) == 2 + len(found.conditions) + sum(len(each.factors) for each in found.over_compensation)
    assert len(root.find("section", id="margins")[0].find("tr")) == 3
    assert numbers["margins"]["speed"]["modulus"] == found.margins.speed.modulus
    assert [each["name"] for each in numbers["conditions"]] == [each.name for each in found.conditions]
    assert numbers["conditions"][1]["chosen"] == found.conditions[1].chosen.median("tracking error")
    for written, each in zip(numbers["over_compensation"], found.over_compensation, strict=True):
        assert (written["effect"], written["gains_up_to"]) == (each.effect, each.gains_up_to)
        assert written["chosen"] == list(each.chosen)


@pytest.mark.parametrize(
    ("chosen", "words"),
    [
        ((1.0, 2.0, 3.0), "gains if the drive has up to 3 times less of it than the model"),
        ((1.0, 2.0, 5.0), "gains if the drive has up to 2 times less of it than the model"),
        ((5.0, 2.0, np.nan), "gains with none of these; runs fail above 2 times"),
    ],
)
def test_how_much_less_of_an_effect_the_drive_may_have(
    found: sw.tuning.Compensated, chosen: tuple[float, ...], words: str
) -> None:
    less = OverCompensation("torsion", np.array([1.25, 2.0, 3.0]), np.full(3, 4.0), np.array(chosen))
    (line,) = too_much(replace(found, over_compensation=(less,)))
    assert line == f"torsion, tried with 1.25 to 3 times less: the controller {words}"


def test_what_is_not_reached_is_a_dash_and_no_number(found: sw.tuning.Compensated) -> None:
    """As a settling time of an error that stays outside its band."""
    never = replace(found.tried[0], figures=found.tried[0].figures | {"settling time": np.full(3, np.inf)})
    changed = replace(found, tried=(never, *found.tried[1:]))
    row = compensate_summary(changed).splitlines()[3]
    assert row.split()[6] == "–"
    assert json.loads(compensate_files(changed)["results.json"])["controllers"][0]["median"]["settling time"] is None


def test_the_caption_names_the_cascade(found: sw.tuning.Compensated, files: dict[str, str]) -> None:
    text = Page(files["report.html"]).root.find("section", id="gain")[0].text
    assert found.baseline.candidate.name.capitalize() in text
    assert "{{" not in text
