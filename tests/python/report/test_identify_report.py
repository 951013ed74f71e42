"""The report of an identification: nothing of the result is lost, and failed checks come first."""

from __future__ import annotations

import csv
import io
import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from strainwave.files.gear_set import GearSet
from strainwave.files.recording import Recording
from strainwave.identification.checks.comparisons import between_files
from strainwave.identification.identify import Identified
from strainwave.identification.reading.recognise import recognise
from strainwave.identification.results import pictures
from strainwave.identification.results.combined_parameter import combine
from strainwave.identification.results.file_result import Check, FileEstimate, FileResult, HeldOut
from strainwave.identification.results.pictures import Look, Picture
from strainwave.parameters import gear_numbers
from strainwave.report import identify_figures
from strainwave.report.identify import identify_report
from strainwave.report.identify_files import failed_lines, identify_files, identify_summary
from strainwave.report.parameter_names import name_of
from strainwave.report.provenance import Provenance
from strainwave.workbench.page import BEGIN, END

from tests.python.report.reading import Page, section
from tests.support.samples import sample

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
    read, drawn, bare = recognise(path), (Picture(curves(), "table"),), (Picture(curves(sigma=False), "table"),)
    findings = (
        FileResult("warm.csv", read, "a law", (told(COULOMB, 0.05, 0.001),), ("a remark of warm",), pictures=drawn),
        FileResult("cold.csv", read, "a law", (told(COULOMB, 0.08, 0.002),)),
        FileResult("copy.csv", read, "a law", (told(COULOMB, 0.05, 0.001),), same_as="warm.csv", pictures=bare),
        FileResult(
            "loop.csv", read, "a spring",
            (told(STIFF, 14000.0, 90.0, "N.m/rad", "three_segment"), told("gear.stiffness.k2", 1.0, 9.0, why="low load")),
            pictures=(Picture(curves("twist"), "loop"),),
        ),
        FileResult("<b>notes</b>.txt", refused="no name of a column tells what it measures; give --column"),
    )  # fmt: skip
    parameters = combine(findings)
    return Identified(START, findings, parameters, START, tuple(between_files(parameters, findings)))


@pytest.fixture(scope="module")
def page(found: Identified) -> str:
    return identify_report(found, Provenance("2026-03-02", "strainwave identify", {"warm.csv": "ab12"}))


def text_of(html: str) -> str:
    return Page(html).root.text


@pytest.mark.slow("report")
def test_the_verdict_comes_first_then_files_measured_against_predicted_then_parameters(page: str) -> None:
    text = text_of(page)
    order = (
        "5 files: 3 determine 2 parameters, 1 contains the measurement of another, 1 is refused; the one check passed.",
        "Files that cannot be used", "give --column", "Friction over speed", "from warm.csv", "from the start set HFUC-20-80",
        "Measured and modelled",
        "Estimates more than 3 σ apart", "13 σ apart.",  # 0.03 over the root of 0.001² + 0.002²
        "By the check “agreement of files” no two files",
    )  # fmt: skip
    places = [text.index(each) for each in order]
    assert places == sorted(places)


@pytest.mark.slow("report")
def test_a_failed_check_stands_first_with_what_to_do_and_marks_its_file(found: Identified) -> None:
    check = Check(
        "input speed", "warm.csv", 2e3, 1.6e3, "rad/s", True, "its input would turn too fast", "see whether units are right"
    )
    warm = replace(found.files[0], checks=(check,))
    failed = Identified(START, (warm,), combine((warm,)), START, (check,))
    root = Page(identify_report(failed)).root
    (alert,) = (each for each in root.walk() if each.attributes.get("role") == "alert")
    for words in ("warm.csv", check.message, check.remedy):
        assert words in alert.text
    assert "1 of 1 check failed, and no gear was written" in root.text
    assert "--accept" in alert.text
    accepted = text_of(identify_report(failed, accepted=True))
    assert "accepted" in accepted
    assert "--accept" not in accepted
    assert "A check of this file failed" in section(identify_report(failed), "measured").text
    results = json.loads(identify_files(failed)["results.json"])
    assert results["failed"] == ["input speed"]
    assert results["checks"][0]["value"] == 2e3


def test_what_is_fine_needs_no_alarm(found: Identified) -> None:
    one = found.files[0]
    html = identify_report(Identified(START, (one,), combine((one,)), START))
    assert not [each for each in Page(html).root.walk() if each.attributes.get("role") == "alert"]
    assert "The file determines 1 parameter; no check applied." in text_of(html)
    assert "Comparison of files" not in text_of(html)


def test_the_error_on_data_held_out_stands_beside_plain_least_squares(found: Identified) -> None:
    held_out = HeldOut("last 30 % of the motion", "current", "A", 0.281, 1.2, 0.363, 900)
    warm = replace(found.files[0], held_out=held_out)
    html = identify_report(Identified(START, (warm,), combine((warm,)), START))
    text = section(html, "measured").text
    for expected in (
        "last 30 % of the motion",
        "This model0.281 A23 %",
        "Plain least squares0.363 A30 %",
        "Predicting the mean1.2 A100 %",
    ):
        assert expected in text, expected
    assert "; RMS error on held-out data 0.281 A (plain least squares 0.363 A), 23 % of the signal; " in text_of(html)


@pytest.mark.slow("report")
def test_each_file_is_listed_with_what_it_is_and_why(page: str) -> None:
    text = section(page, "files").text
    for expected in (
        "a table of steady friction", "speed: Drehzahl [1/min]", "torque: Reibmoment [mN·m]", "side: input", "a law",
        "a remark of warm", "the same measurement as warm.csv", "refused", "<b>notes</b>.txt",
    ):  # fmt: skip
        assert expected in text or expected.replace("mN·m", "mNm") in text, expected


def test_each_parameter_stands_with_its_file_the_start_set_and_the_others(page: str) -> None:
    row = next(each for each in section(page, "parameters").find("tr") if "coulomb" in each.text)
    assert "0.0500 ± 0.0010" in row.text
    assert "0.0480 to 0.0520" in row.text
    assert "warm.csv" in row.text
    assert f"{gear_numbers(START.gear)[COULOMB][0]:.4g}" in row.text
    assert "cold.csv: 0.0800 ± 0.0020 (13 σ apart, not counted)" in row.text
    assert "1 more of the same measurement" in row.text


@pytest.mark.slow("report")
def test_the_gear_is_in_the_workbench_beside_the_report_if_that_is_installed(
    found: Identified, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    asset, link = tmp_path / "workbench.html", 'href="workbench.html"'
    monkeypatch.setattr("strainwave.workbench.page.FILE", asset)
    files = identify_files(found, accepted=True)
    assert "workbench.html" not in files
    assert link not in files["report.html"]
    asset.write_text(f"<p>before</p>{BEGIN}{{}}{END}<p>after</p>")
    files = identify_files(found, accepted=True)
    before, _, content = files["workbench.html"].partition(BEGIN)
    assert (before, json.loads(content.removesuffix(f"{END}<p>after</p>"))["name"]) == ("<p>before</p>", found.accepted.name)
    assert link in files["report.html"]

    def refused(_: GearSet) -> str:
        raise ValueError("no drive")

    monkeypatch.setattr("strainwave.workbench.page.page", refused)
    files = identify_files(found, accepted=True)
    assert "workbench.html" not in files
    assert link not in files["report.html"]


def test_parameters_are_grouped_by_effect(page: str) -> None:
    headings = [each.text for each in section(page, "parameters").find("th") if each.attributes.get("scope") == "rowgroup"]
    assert headings == ["Friction", "Stiffness"]


def test_columns_that_no_parameter_fills_are_left_out(page: str, found: Identified) -> None:
    one = replace(found.files[0], estimates=(told("load.inertia", 1.2, 0.1, "kg.m2"),))
    alone = identify_report(Identified(START, (one,), combine((one,)), START))
    for title in ("Start set", "Each file"):
        assert title in section(page, "parameters").text
        assert title not in section(alone, "parameters").text


def test_an_option_in_a_remedy_is_shown_as_it_is_typed(found: Identified) -> None:
    check = Check("friction", "warm.csv", 2.0, 1.0, "1", True, "too large", "give --column input_torque=tau_1")
    warm = replace(found.files[0], checks=(check,))
    assert "--column input_torque=tau_1" in text_of(identify_report(Identified(START, (warm,), (), START, (check,))))


def test_what_is_not_determined_stands_with_its_state_and_reason(page: str) -> None:
    text = section(page, "undetermined").text
    assert "not identified" in text
    assert "low load" in text
    assert "gear.input_inertia" in text  # kept from the set
    assert "loop.csv" in text


def test_every_file_that_was_fitted_has_a_drawing_of_its_own(page: str, found: Identified) -> None:
    root = Page(page).root
    titles = [each.attributes["aria-label"] for each in root.find("svg")]
    for result in found.files:
        drawn = f"Measured against modelled, {result.name}" in titles
        assert drawn == bool(result.pictures)
    first = [title for title in titles if title.endswith((", warm.csv", ", loop.csv")) and "modelled" not in title]
    assert first == ["Friction over speed, warm.csv", "Twist over torque, loop.csv"]
    assert "Not determined by these files: torque, measured and predicted (needs the torque or current" in root.text
    names = [each.attributes["id"] for each in root.walk() if "id" in each.attributes]
    assert len(names) == len(set(names))
    assert {link.attributes["href"][1:] for link in root.find("a")} <= set(names)


@pytest.mark.whole_path("report")
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
    look: Look = {"speed": "table", "twist": "loop"}.get(over, "series")  # type: ignore[assignment]
    picture = Picture(Recording(columns, units), look)
    drawing = identify_figures.file_figure(FileResult("long.csv"), picture, "long")
    assert len(drawing) < 300_000


def test_the_fitted_loop_is_a_line_through_the_points() -> None:
    twist = 1e-3 * np.cos(np.linspace(0.0, 6.0, 50))
    recording = Recording(
        {"twist": twist, "torque": twist, "modelled": twist}, {"twist": "rad", "torque": "N.m", "modelled": "N.m"}
    )
    drawing = identify_figures.file_figure(FileResult("loop.csv"), Picture(recording, "loop"), "loop")
    lines = re.findall(r'<path d="([^"]*)"[^>]*stroke: var\(--model', drawing)
    assert max(len(re.findall(r"[\d.]+ [\d.]+", line)) for line in lines) == 50


def test_what_is_left_of_two_encoders_is_what_orders_and_loads_do_not_explain() -> None:
    given = curves("time")
    left = np.arange(6.0)
    assert pictures.residual_of(given).tolist() == (given["torque"] - given["modelled"]).tolist()
    with_rest = given.with_column("residual", left, "N.m")
    assert pictures.residual_of(with_rest).tolist() == left.tolist()


def test_numbers_are_called_what_their_law_calls_them() -> None:
    assert "positive speed under positive load" in name_of(told("gear.friction_mesh.driving_forward", 0.1, 0.1))
    assert name_of(told("gear.kinematic_error.amplitude of order 2", 1.0, 1.0)).endswith("of order 2")
    assert name_of(told("gear.hysteresis.breakaway[1]", 1.0, 1.0, law="maxwell_slip")).endswith("no. 2")
    assert "inertia" in name_of(told("load.inertia", 1.0, 1.0)).lower()
    assert name_of(told("load.no_such_thing", 1.0, 1.0)) == "No such thing"


values = st.floats(1e-6, 1e6)


@pytest.mark.slow("report")
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
    assert (rows[-1]["state"], rows[-1]["reason"]) == ("not identified", "noise")
    results = json.loads(made["results.json"])
    assert results["parameters"][0]["best"]["value"] == first
    agree = not same and abs(first - second) <= 2.0 * np.sqrt(5.0) * sigma
    assert bool(results["parameters"][0]["mean_of"]) == agree
    assert (rows[2]["taken"] == "yes") == agree
    assert results["parameters"][0]["others"][0]["value"] == second
    assert results["parameters"][0]["contradicts"] == ["b.csv"][: rows[1]["contradicts"] == "yes"]


def test_a_phase_is_compared_around_the_turn() -> None:
    path = "gear.kinematic_error.phase[0]"
    findings = tuple(
        FileResult(name, estimates=(told(path, phase, 0.05, "rad"),)) for name, phase in (("a.csv", 3.1), ("b.csv", -3.1))
    )
    html = identify_report(Identified(START, findings, combine(findings), START))
    assert "1.2 σ apart)" in text_of(html)  # 2 pi - 6.2 over the root of 2 x 0.05²


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
    assert "b.csv: 0.0535 ± 0.0010 (2.5 σ apart, not counted)" in text_of(page)
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


@pytest.mark.slow("report")
def test_checks_with_one_remedy_name_it_once(found: Identified) -> None:
    failed = [
        Check("agreement of files", name, 9.0, 3.0, "1", True, "they differ", "compare them") for name in ("a, b", "a, c")
    ]
    html = identify_report(Identified(START, found.files, found.parameters, START, tuple(failed)))
    assert text_of(html).count("compare them") == 1
    assert "are among the failed checks" in text_of(html)
    lines = ["FAILED: a, b: they differ", "FAILED: a, c: they differ", "  what to do: compare them"]
    assert list(failed_lines(failed)) == lines


def test_what_was_measured_in_current_is_stated_first() -> None:
    file = FileResult("log.csv", None, "a law", (told(COULOMB, 0.5, 0.01, "N.m").in_current(),))
    found = Identified(START, (file,), combine((file,)), START, ())
    words = (
        "friction measured in A, as the torque constant is not known: give --constant torque_constant=NUMBER, or the gear "
        "keeps friction of the start set"
    )
    assert next(identify_summary(found)) == f"{START.name}: {words}"
    verdict = next(line for line in identify_report(found).splitlines() if 'class="verdict"' in line)
    assert verdict.startswith(f'<p class="verdict">{words[0].upper()}{words[1:]}; the file determines 1 parameter')
