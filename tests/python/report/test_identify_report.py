"""The page of what files tell: nothing of it is lost, and what contradicts or is refused comes first."""

from __future__ import annotations

import csv
import io
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from strainwave.files.gear_set import GearSet
from strainwave.files.recording import Recording
from strainwave.identification.evidence.verdict import numbers
from strainwave.identification.identify import Identified
from strainwave.identification.reading.recognise import recognise
from strainwave.identification.results.file_result import FileEstimate, FileResult, combine
from strainwave.report import identify_figures
from strainwave.report.identify import identify_files, identify_report, name_of
from strainwave.report.provenance import Provenance

from tests.python.report.reading import Page, section
from tests.samples import sample

START = GearSet.read("hfuc-20-80")
COULOMB, STIFF = "gear.friction_input.coulomb", "gear.stiffness.k1"
SPEED = np.array([-100.0, -10.0, -1.0, 1.0, 10.0, 100.0])


def told(path: str, value: float, sigma: float, unit: str = "N.m", law: str = "", why: str = "") -> FileEstimate:
    return FileEstimate(path, unit, value, sigma, law, why)


def curves(over: str = "speed", sigma: bool = True) -> Recording:
    columns = {over: SPEED, "torque": np.sign(SPEED) * 0.05 + 1e-3 * np.cos(SPEED), "modelled": np.sign(SPEED) * 0.05}
    columns |= {"held_out": (SPEED > 5.0).astype(float)} | ({"sigma": np.full(6, 1e-3)} if sigma else {})
    units = {over: {"speed": "rad/s", "twist": "rad"}.get(over, "s"), "held_out": "1"}
    return Recording(columns, dict.fromkeys(columns, "N.m") | units)


@pytest.fixture(scope="module")
def found(tmp_path_factory: pytest.TempPathFactory) -> Identified:
    """Two tables that differ, a copy of the first, a loop that tells half, and a file that was not read."""
    path = tmp_path_factory.mktemp("files") / "warm.csv"
    path.write_text("Drehzahl [1/min];Reibmoment [mNm]\n600;41,2\n-600;-40,9\n1200;50,1\n")
    read = recognise(path)
    findings = (
        FileResult("warm.csv", read, "a law", (told(COULOMB, 0.05, 0.001),), 0.02, ("a remark of warm",), curves=curves()),
        FileResult("cold.csv", read, "a law", (told(COULOMB, 0.08, 0.002),), 0.03, curves=curves()),
        FileResult("copy.csv", read, "a law", (told(COULOMB, 0.05, 0.001),), same_as="warm.csv", curves=curves(sigma=False)),
        FileResult(
            "loop.csv", read, "a spring",
            (told(STIFF, 14000.0, 90.0, "N.m/rad", "three_segment"), told("gear.stiffness.k2", 1.0, 9.0, why="low load")),
            curves=curves("twist"),
        ),
        FileResult("<b>notes</b>.txt", refused="no name of a column tells what it measures; give --column"),
    )  # fmt: skip
    return Identified(START, findings, combine(findings), START)


@pytest.fixture(scope="module")
def page(found: Identified) -> str:
    return identify_report(found, Provenance("2026-03-02", "strainwave identify", {"warm.csv": "ab12"}))


def text_of(html: str) -> str:
    return Page(html).root.text


def test_contradictions_and_refused_files_come_first_with_what_to_do(page: str) -> None:
    text = text_of(page)
    places = [
        text.index(each)
        for each in ("Files contradict each other", "What to do", "Files that tell nothing", "What each file is")
    ]
    assert places == sorted(places)
    assert "13 standard deviations lie between them" in text  # 0.03 over the root of 0.001² + 0.002²
    assert "give --column" in text


def test_it_counts_what_files_come_to(page: str) -> None:
    assert "5 files: 3 tell 2 numbers, 1 shows what another file shows too, 1 is refused" in text_of(page)


def test_what_is_fine_needs_no_alarm(found: Identified) -> None:
    one = found.files[0]
    html = identify_report(Identified(START, (one,), combine((one,)), START))
    assert not [each for each in Page(html).root.walk() if each.attributes.get("role") == "alert"]
    assert "1 file: 1 tells 1 number." in text_of(html)
    assert "Files beside each other" not in text_of(html)


def test_each_file_is_listed_with_what_it_is_and_why(page: str) -> None:
    text = section(page, "files").text
    for expected in (
        "a table of steady friction", "speed: Drehzahl [1/min]", "torque: Reibmoment [mN·m]", "side: input", "a law",
        "error 2 %", "a remark of warm", "the same measurement as warm.csv", "refused", "<b>notes</b>.txt",
    ):  # fmt: skip
        assert expected in text or expected.replace("mN·m", "mNm") in text, expected


def test_each_number_stands_with_its_file_the_initial_set_and_the_others(page: str) -> None:
    row = next(each for each in section(page, "numbers").find("tr") if "coulomb" in each.text)
    assert "0.0500 ± 0.0010" in row.text
    assert "warm.csv" in row.text
    assert f"{numbers(START.gear)[COULOMB][0]:.4g}" in row.text
    assert "cold.csv: 0.0800 ± 0.0020 (13 σ apart: contradiction)" in row.text
    assert "1 more of the same measurement" in row.text


def test_what_is_not_told_stands_with_its_reason(page: str) -> None:
    text = section(page, "untold").text
    assert "low load" in text
    assert "gear.input_inertia" in text  # kept from the set
    assert "loop.csv" in text


def test_every_file_that_was_fitted_has_a_drawing_of_its_own(page: str, found: Identified) -> None:
    root = Page(page).root
    titles = [each.attributes["aria-label"] for each in root.find("svg")]
    for finding in found.files:
        drawn = f"Measured against modelled, {finding.name}" in titles
        assert drawn == (finding.curves is not None)
    names = [each.attributes["id"] for each in root.walk() if "id" in each.attributes]
    assert len(names) == len(set(names))
    assert {link.attributes["href"][1:] for link in root.find("a")} <= set(names)


def test_a_page_needs_nothing_else_and_is_the_same_each_time(page: str, found: Identified) -> None:
    assert identify_report(found, Provenance("2026-03-02", "strainwave identify", {"warm.csv": "ab12"})) == page
    for each in Page(page).root.walk():
        assert each.tag not in ("script", "link", "img")
        assert not each.attributes.get("href", "#").startswith("http")


@pytest.mark.parametrize("over", ["speed", "twist", "time", "input_angle"])
@pytest.mark.parametrize("count", [1, 6, 5000])
def test_any_length_can_be_drawn(over: str, count: int) -> None:
    x = np.linspace(1.0, 500.0, count)
    columns = {over: x, "torque": np.sin(x), "modelled": np.sin(x) + 0.1, "sigma": np.full(count, 0.1)}
    units = dict.fromkeys(columns, "N.m") | {over: {"speed": "rad/s", "time": "s"}.get(over, "rad")}
    drawing = identify_figures.file_figure(FileResult("long.csv", curves=Recording(columns, units)), "long")
    assert len(drawing) < 300_000


def test_what_is_left_of_two_encoders_is_what_orders_and_loads_do_not_explain() -> None:
    given = curves("time")
    left = np.arange(6.0)
    assert identify_figures.residual_of(given).tolist() == (given["torque"] - given["modelled"]).tolist()
    with_rest = given.with_column("residual", left, "N.m")
    assert identify_figures.residual_of(with_rest).tolist() == left.tolist()


def test_numbers_are_called_what_their_law_calls_them() -> None:
    assert "positive speed under positive load" in name_of(told("gear.friction_mesh.driving_forward", 0.1, 0.1))
    assert name_of(told("gear.kinematic_error.amplitude of order 2", 1.0, 1.0)).endswith("of order 2")
    assert name_of(told("gear.hysteresis.breakaway[1]", 1.0, 1.0, law="maxwell_slip")).endswith("no. 2")
    assert "inertia" in name_of(told("load.inertia", 1.0, 1.0)).lower()
    assert name_of(told("load.no_such_thing", 1.0, 1.0)) == "No such thing"


values = st.floats(1e-6, 1e6)


@given(first=values, second=values, sigma=st.floats(1e-9, 1e3), same=st.booleans())
@settings(max_examples=sample(5, 15), deadline=None)
def test_files_hold_every_number_to_the_last_digit(first: float, second: float, sigma: float, same: bool) -> None:
    findings = (
        FileResult("a.csv", estimates=(told(COULOMB, first, sigma),)),
        FileResult(
            "b.csv",
            estimates=(told(COULOMB, second, 2.0 * sigma), told(STIFF, 1.0, 2.0, why="noise")),
            same_as="a.csv" if same else "",
        ),
    )
    made = identify_files(Identified(START, findings, combine(findings), START))
    rows = list(csv.DictReader(io.StringIO(made["numbers.csv"])))
    assert [(row["file"], float(row["value"]), float(row["sigma"])) for row in rows[:2]] == [
        ("a.csv", first, sigma), ("b.csv", second, 2.0 * sigma)
    ]  # fmt: skip
    assert float(rows[1]["sigmas_apart"]) == pytest.approx(abs(first - second) / (np.sqrt(5.0) * sigma))
    assert rows[1]["same_measurement"] == ("yes" if same else "no")
    assert rows[-1]["not_told_because"] == "noise"
    results = json.loads(made["results.json"])
    assert results["numbers"][0]["best"]["value"] == first
    agree = not same and abs(first - second) <= 2.0 * np.sqrt(5.0) * sigma
    assert bool(results["numbers"][0]["mean_of"]) == agree
    assert (rows[2]["taken"] == "yes") == agree
    assert results["numbers"][0]["others"][0]["value"] == second
    assert results["numbers"][0]["contradicts"] == ["b.csv"][: rows[1]["contradicts"] == "yes"]


def test_a_phase_is_compared_around_the_turn() -> None:
    path = "gear.kinematic_error.phase[0]"
    findings = tuple(
        FileResult(name, estimates=(told(path, phase, 0.05, "rad"),)) for name, phase in (("a.csv", 3.1), ("b.csv", -3.1))
    )
    html = identify_report(Identified(START, findings, combine(findings), START))
    assert "1.2 σ)" in text_of(html)  # 2 pi - 6.2 over the root of 2 x 0.05²


def test_numbers_of_nothing_and_without_size_do_not_stop_the_page(found: Identified) -> None:
    findings = (
        FileResult("a.csv", estimates=(told(COULOMB, 0.0, 0.001),)),
        FileResult("b.csv", estimates=(told(COULOMB, 0.01, 0.001),)),
        replace(found.files[0], name=f"{'long' * 20}.csv"),
    )
    html = identify_report(Identified(START, findings, combine(findings), START))
    assert Page(html)
    assert Path(findings[2].name).suffix == ".csv"


def test_a_file_beyond_two_sigma_is_shown_as_not_counted() -> None:
    findings = tuple(
        FileResult(name, estimates=(told(COULOMB, value, 1e-3, "N.m"),)) for name, value in (("a.csv", 0.05), ("b.csv", 0.0535))
    )
    page = identify_report(Identified(START, findings, combine(findings), START))
    assert "b.csv: 0.0535 ± 0.0010 (2.5 σ, not counted)" in text_of(page)
    drawn = next(each for each in Page(page).root.find("svg")).text
    assert "not counted" in drawn
    assert "agrees" not in drawn


def test_numbers_of_the_gear_come_before_the_loads_of_runs() -> None:
    first, second = "load.inertia", "load.gravity_torque"
    findings = tuple(
        FileResult(name, estimates=tuple(told(path, 1.0, 0.1, "kg.m2") for path in (first, second, COULOMB)))
        for name in ("a.csv", "b.csv")
    )
    order = [(each.estimate.path, each.source) for each in combine(findings)]
    assert order == [(COULOMB, "a.csv"), (first, "a.csv"), (second, "a.csv"), (first, "b.csv"), (second, "b.csv")]
