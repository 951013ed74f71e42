"""The page of the study of document P's experiments, the lines for a terminal, and the command that writes both."""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator
from contextlib import redirect_stdout
from io import StringIO
from pathlib import Path

import pytest
import strainwave as sw
from strainwave.commands import cli
from strainwave.files import writing
from strainwave.report.position_control import position_control_report, summary
from strainwave.report.provenance import Provenance
from strainwave.studies import position_control as study
from strainwave.studies.position_control import FULL, SIMPLIFIED, PositionControl, position_control

from tests.python.report.measured import HOSTILE
from tests.python.report.reading import Node, Page, printed, section


@pytest.fixture(scope="module")
def found(tmp_path_factory: pytest.TempPathFactory) -> Iterator[PositionControl]:
    """The study with few strokes."""
    path = tmp_path_factory.mktemp("measured") / "own <b>&.csv"
    path.write_text("time [s],command [rad],output_angle [rad]\n0,0.05,0.05\n0.1,0.05,0.05\n0.2,0.06,0.058\n0.5,0.06,0.0605\n")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(study, "VOLTAGES", (12.0,))
        patch.setattr(study, "PULSES_PER_VOLTAGE", 4)
        patch.setattr(study, "STROKES", (0.5, 20.0, 230.0))
        yield position_control(path)


@pytest.fixture(scope="module")
def html(found: PositionControl) -> str:
    return position_control_report(found, Provenance("2026-01-01", HOSTILE, {}))


def cells(row: Node) -> list[str]:
    return [cell.text for cell in row.children if isinstance(cell, Node)]


def table(html: str, name: str, number: int) -> list[list[str]]:
    """The rows of a table of a section, the head among them."""
    return [cells(row) for row in section(html, name).find("table")[number].find("tr")]


def milli(text: str) -> float:
    value, unit = text.rsplit(" ", 1)
    assert unit == "mrad"
    return 1e-3 * printed(value)


@pytest.mark.slow("papers")
def test_the_page_is_well_formed_and_needs_nothing_else(html: str) -> None:
    names = [node.attributes["id"] for node in Page(html).root.walk() if "id" in node.attributes]
    assert len(names) == len(set(names))
    references = re.findall(r"(?:href=\"|url\()#([^\")]+)", html)
    assert references
    assert set(references) <= set(names)
    assert not re.search(r"https?:|//\w|@import|<link|<img|<iframe|<script", html)


@pytest.mark.slow("papers")
def test_markup_in_names_is_shown_and_not_obeyed(html: str) -> None:
    assert "own <b>&.csv" in section(html, "measured").text
    assert Page(html).root.find("footer")[0].find("code")[0].text == HOSTILE


@pytest.mark.slow("papers")
def test_the_same_study_gives_the_same_bytes_and_the_date_is_the_one_given(found: PositionControl, html: str) -> None:
    assert position_control_report(found, Provenance("2026-01-01", HOSTILE, {})) == html
    assert re.findall(r"20\d\d-\d\d-\d\d", html) == ["2026-01-01"]


@pytest.mark.slow("papers")
def test_the_tables_say_what_the_recordings_hold(found: PositionControl, html: str) -> None:
    for number, experiment in enumerate(found.experiments):
        head, rms, largest, correlation, *settling = table(html, "experiments", number)
        assert head == ["Output angle", "Full − command", "Simplified − command", "Full − simplified"]
        agreements = [*(experiment.tracking[model] for model in (FULL, SIMPLIFIED)), experiment.between["output_angle"]]
        assert [1e-3 * printed(text) for text in rms[1:]] == pytest.approx([each.rms for each in agreements], rel=6e-3)
        assert [1e-3 * printed(text) for text in largest[1:]] == pytest.approx([each.largest for each in agreements], rel=6e-3)
        assert [printed(text) for text in correlation[1:]] == pytest.approx([a.correlation for a in agreements], abs=1e-6)
        for row in settling:
            for text, model in zip(row[1:3], (FULL, SIMPLIFIED), strict=True):
                ends = re.fullmatch(r"([\d.]+)(?: to ([\d.]+))?", text)
                assert ends
                times = experiment.settling[model]
                assert float(ends[1]) == pytest.approx(1e3 * min(times), abs=0.5)
                assert float(ends[2] or ends[1]) == pytest.approx(1e3 * max(times), abs=0.5)
        assert bool(settling) == bool(experiment.settling[FULL])


@pytest.mark.slow("papers")
def test_a_measurement_stands_beside_both_models(found: PositionControl, html: str) -> None:
    assert found.measured is not None
    head, rms, *_ = table(html, "measured", 0)
    assert head[1:] == ["Full − measured", "Simplified − measured"]
    errors = [agreement.rms for agreement in found.measured.agreement.values()]
    assert [1e-3 * printed(text) for text in rms[1:]] == pytest.approx(errors, rel=6e-3)


@pytest.mark.slow("papers")
def test_strokes_are_listed_with_their_shares(found: PositionControl, html: str) -> None:
    pulses = found.by_pulse[12.0]
    _, *rows = table(html, "strokes", 1)
    assert len(rows) == len(pulses)
    for row, stroke, width, full in zip(rows, pulses["stroke"], pulses["width"], pulses["full"], strict=True):
        assert printed(row[0]) == pytest.approx(stroke, rel=6e-3)
        assert printed(row[1]) == pytest.approx(1e3 * width, rel=6e-3)
        assert printed(row[2]) == pytest.approx(100.0 * (full / stroke - 1.0), rel=6e-2)


@pytest.mark.slow("papers")
def test_table_4_is_not_claimed_and_only_resolutions_stand_beside_it(found: PositionControl, html: str) -> None:
    assert "Table 4 is not reproduced" in section(html, "table-4").text
    _, *rows = table(html, "table-4", 0)
    for row, experiment, published in zip(rows, found.experiments, (2.1, 1.8, 1.5), strict=True):
        assert row[0] == experiment.title
        assert row[1] == f"{published} mrad"
        apart = experiment.between["output_angle"].rms
        assert milli(row[2]) == pytest.approx(apart, rel=6e-2)
        assert float(row[3]) == pytest.approx(1e-3 * published / apart, rel=6e-2)


@pytest.mark.slow("papers")
def test_every_number_has_its_source_and_what_is_assumed_says_so(html: str) -> None:
    head, *rows = table(html, "sources", 0)
    assert head == ["Number", "Value", "Unit", "Model", "Source"]
    assert all(row[4] for row in rows)
    by_place = {(row[0], row[3]): row for row in rows}
    assert by_place["gear.stiffness.k", "both"][1:3] == ["150", "N·m/rad"]
    assert by_place["gear.friction_input.coulomb", "simplified"][1] == "0.072"
    assert by_place["gear.friction_input.quadratic", "full"][1] == "1.5738 × 10⁻⁶"
    for place in ("control.proportional", "control.derivative", "gear.friction_output.coulomb", "gear.friction_input.sine"):
        (row,) = (row for row in rows if row[0] == place)
        assert row[4].startswith("assumed: "), place
    assert not by_place["motor.resistance", "both"][4].startswith("assumed")


@pytest.mark.slow("papers")
def test_cells_name_their_columns_where_a_page_is_narrow(html: str) -> None:
    for each in Page(html).root.find("table"):
        columns = [column.text for column in each.find("thead")[0].find("th")]
        for row in each.find("tbody")[0].find("tr"):
            for column, cell in zip(columns, (c for c in row.children if isinstance(c, Node)), strict=True):
                assert cell.attributes.get("data-label", column) == column


@pytest.mark.slow("papers")
def test_every_experiment_is_drawn_with_command_response_error_and_current(html: str) -> None:
    drawings = section(html, "experiments").find("svg")
    assert len(drawings) == 3
    for svg in drawings:
        written = " ".join("".join(c for c in text.children if isinstance(c, str)) for text in svg.find("text"))
        for words in ("output angle [mrad]", "response − command [mrad]", "full − simplified", "current [A]", "time [s]"):
            assert words in written


@pytest.mark.slow("papers")
def test_the_lines_for_a_terminal_say_the_same(found: PositionControl) -> None:
    lines = summary(found).splitlines()
    step = found.experiments[0]
    apart = next(line for line in lines if line.startswith("  full − simplified"))
    assert 1e-3 * printed(apart.split()[3]) == pytest.approx(step.between["output_angle"].rms, rel=6e-3)
    assert any("up to 14.6 rad of the motor" in line for line in lines)
    assert any("not reproduced" in line for line in lines)
    assert all(line == line.rstrip() and len(line) < 170 for line in lines)


@pytest.mark.slow("papers")
def test_the_command_writes_recordings_and_a_page(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(study, "VOLTAGES", (12.0,))
    monkeypatch.setattr(study, "PULSES_PER_VOLTAGE", 2)
    monkeypatch.setattr(study, "STROKES", (0.5, 230.0))
    monkeypatch.setattr(sys, "argv", ["strainwave", "study", "position-control", "--out", str(tmp_path / "new" / "study")])
    monkeypatch.setattr(writing, "written", [])
    said = StringIO()
    with redirect_stdout(said), pytest.raises(SystemExit) as end:
        cli.main()
    assert not end.value.code
    written = sorted(path.name for path in (tmp_path / "new" / "study").iterdir())
    runs = [f"{name}-{model}.parquet" for name in ("pulse-train", "sine", "step") for model in (FULL, SIMPLIFIED)]
    assert written == sorted([*runs, "report.html", "strokes-by-pulse-12V.parquet", "strokes-under-control.parquet"])
    assert sorted(path.name for path in writing.written) == written
    page = Page((tmp_path / "new" / "study" / "report.html").read_text()).root
    assert "measured" not in [node.attributes.get("id") for node in page.walk()], "there was no measurement"
    step = sw.Recording.read(tmp_path / "new" / "study" / "step-full.parquet")
    assert step["command"][-1] == pytest.approx(0.09)
    assert step.unit("current") == "A"
    assert "full − simplified" in said.getvalue()
