"""The page of the position control article's experiments, the lines for a terminal, and the script that writes both."""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator
from pathlib import Path

import position_control as study
import pytest
import strainwave as sw
from position_control import FULL, SIMPLIFIED, PositionControl, position_control
from position_control_page import page, summary, write_page

from tests.papers.markdown import section, tables
from tests.python.report.reading import printed

pytestmark = pytest.mark.slow("papers")  # an article's study runs for seconds


@pytest.fixture(scope="module")
def found(tmp_path_factory: pytest.TempPathFactory) -> Iterator[PositionControl]:
    """The study with few strokes."""
    path = tmp_path_factory.mktemp("measured") / "own.csv"
    path.write_text("time [s],command [rad],output_angle [rad]\n0,0.05,0.05\n0.1,0.05,0.05\n0.2,0.06,0.058\n0.5,0.06,0.0605\n")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(study, "VOLTAGES", (12.0,))
        patch.setattr(study, "PULSES_PER_VOLTAGE", 4)
        patch.setattr(study, "STROKES", (0.5, 20.0, 230.0))
        yield position_control(path)


@pytest.fixture(scope="module")
def text(found: PositionControl) -> str:
    return page(found)


def milli(text: str) -> float:
    value, unit = text.rsplit(" ", 1)
    assert unit == "mrad"
    return 1e-3 * printed(value)


def test_the_tables_say_what_the_recordings_hold(found: PositionControl, text: str) -> None:
    for number, experiment in enumerate(found.experiments):
        head, rms, largest, correlation, *settling = tables(section(text, "The three experiments"))[number]
        assert head == ["output angle", "full − command", "simplified − command", "full − simplified"]
        agreements = [*(experiment.tracking[model] for model in (FULL, SIMPLIFIED)), experiment.between["output_angle"]]
        assert [1e-3 * printed(cell) for cell in rms[1:]] == pytest.approx([each.rms for each in agreements], rel=6e-3)
        assert [1e-3 * printed(cell) for cell in largest[1:]] == pytest.approx([each.largest for each in agreements], rel=6e-3)
        assert [printed(cell) for cell in correlation[1:]] == pytest.approx([a.correlation for a in agreements], abs=1e-6)
        for row in settling:
            for cell, model in zip(row[1:3], (FULL, SIMPLIFIED), strict=True):
                ends = re.fullmatch(r"([\d.]+)(?: to ([\d.]+))?", cell)
                assert ends
                times = experiment.settling[model]
                assert float(ends[1]) == pytest.approx(1e3 * min(times), abs=0.5)
                assert float(ends[2] or ends[1]) == pytest.approx(1e3 * max(times), abs=0.5)
        assert bool(settling) == bool(experiment.settling[FULL])


def test_a_measurement_stands_beside_both_models(found: PositionControl, text: str) -> None:
    assert found.measured is not None
    head, rms, *_ = tables(section(text, "Your measurement"))[0]
    assert head[1:] == ["full − measured", "simplified − measured"]
    errors = [agreement.rms for agreement in found.measured.agreement.values()]
    assert [1e-3 * printed(cell) for cell in rms[1:]] == pytest.approx(errors, rel=6e-3)


def test_strokes_are_listed_with_their_shares(found: PositionControl, text: str) -> None:
    pulses = found.by_pulse[12.0]
    _, *rows = tables(section(text, "From small to large strokes"))[1]
    assert len(rows) == len(pulses)
    for row, stroke, width, full in zip(rows, pulses["stroke"], pulses["width"], pulses["full"], strict=True):
        assert printed(row[0]) == pytest.approx(stroke, rel=6e-3)
        assert printed(row[1]) == pytest.approx(1e3 * width, rel=6e-3)
        assert printed(row[2]) == pytest.approx(100.0 * (full / stroke - 1.0), rel=6e-2)


def test_table_4_is_not_claimed_and_only_resolutions_stand_beside_it(found: PositionControl, text: str) -> None:
    part = section(text, "The article's Table 4")
    assert "Table 4 is not reproduced" in part
    _, *rows = tables(part)[0]
    for row, experiment, published in zip(rows, found.experiments, (2.1, 1.8, 1.5), strict=True):
        assert row[0] == experiment.title
        assert row[1] == f"{published} mrad"
        apart = experiment.between["output_angle"].rms
        assert milli(row[2]) == pytest.approx(apart, rel=6e-2)
        assert float(row[3]) == pytest.approx(1e-3 * published / apart, rel=6e-2)


def test_the_page_has_the_answers_and_the_limits(found: PositionControl, text: str) -> None:
    assert "up to **14.6 rad** of the motor, 8.4° of the output" in text
    assert "5.2 mN·m rms, Table 1" in text
    assert "The average part is least, 49.2 mN·m, at 120.4 rad; at 240.8 rad it is back at its beginning" in text
    assert "own.csv: both models under the same command" in text


def test_every_number_has_its_source_and_what_is_assumed_says_so(text: str) -> None:
    full, simplified = section(text, "Numbers and sources").split("### The simplified model")
    for model in (full, simplified):
        assert re.search(r"^ +k +150 +N\.m/rad +position control article", model, re.MULTILINE)
        assert re.search(r"^ +proportional +20 .* assumed: ", model, re.MULTILINE)
        assert not re.search(r"^ +resistance .* assumed", model, re.MULTILINE)
    assert re.search(r"^ +quadratic +1\.5738e-06 ", full, re.MULTILINE)
    assert re.search(r"^ +sine\[0\] .* assumed: ", full, re.MULTILINE)
    assert re.search(r"^ +coulomb +0\.072 ", simplified, re.MULTILINE)


def test_every_figure_of_the_page_is_drawn(found: PositionControl, text: str, tmp_path: Path) -> None:
    write_page(found, tmp_path)
    shown = re.findall(r"\]\((\S+\.svg)\)", text)
    assert sorted(shown) == sorted(path.name for path in tmp_path.glob("*.svg"))
    assert len(shown) == 7
    assert (tmp_path / "page.md").read_text(encoding="utf-8") == text


def test_the_lines_for_a_terminal_say_the_same(found: PositionControl) -> None:
    lines = summary(found).splitlines()
    step = found.experiments[0]
    apart = next(line for line in lines if line.startswith("  full − simplified"))
    assert 1e-3 * printed(apart.split()[3]) == pytest.approx(step.between["output_angle"].rms, rel=6e-3)
    assert any("up to 14.6 rad of the motor" in line for line in lines)
    assert any("not reproduced" in line for line in lines)
    assert all(line == line.rstrip() and len(line) < 170 for line in lines)


def test_the_script_writes_recordings_and_a_page(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(study, "VOLTAGES", (12.0,))
    monkeypatch.setattr(study, "PULSES_PER_VOLTAGE", 2)
    monkeypatch.setattr(study, "STROKES", (0.5, 230.0))
    monkeypatch.setattr(sys, "argv", ["position_control.py", "--out", str(tmp_path / "new" / "study")])
    study.main()
    written = {path.name for path in (tmp_path / "new" / "study").iterdir()}
    runs = {f"{name}-{model}.parquet" for name in ("pulse-train", "sine", "step") for model in (FULL, SIMPLIFIED)}
    strokes = {"strokes-under-control.parquet", "strokes-by-pulse-12V.parquet"}
    assert {name for name in written if not name.endswith(".svg")} == {*runs, *strokes, "page.md"}
    assert "Your measurement" not in (tmp_path / "new" / "study" / "page.md").read_text(encoding="utf-8")
    step = sw.Recording.read(tmp_path / "new" / "study" / "step-full.parquet")
    assert step["command"][-1] == pytest.approx(0.09)
    assert step.unit("current") == "A"
    assert "full − simplified" in capsys.readouterr().out
