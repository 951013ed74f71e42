"""The page of the study of document A, the lines for a terminal, and the command that writes both."""

from __future__ import annotations

import re
from math import radians
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import strainwave as sw
from strainwave.diagnose.inversion import displaced
from strainwave.native import kernels
from strainwave.report.misalignment import misalignment_report, summary
from strainwave.report.misalignment_claims import CONFIRMED, CORRECTED, IN_PART, claims
from strainwave.report.provenance import Provenance
from strainwave.studies import misalignment as study
from strainwave.studies.misalignment import MisalignmentStudy, misalignment
from strainwave.studies.pure_error import fitted, pure_error, turn_mean

from tests.python.command import Result, refused, strainwave
from tests.python.report.measured import HOSTILE
from tests.python.report.reading import Node, Page, printed, section

LUMPED = "tilt-actuator-lumped"
LAW = sw.kinematic_error.Misalignment(
    major_radius=25.3e-3, minor_radius=24.7e-3, pitch_radius=25e-3, pressure_angle=radians(20.0)
)


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a measured ramp and a measured curve."""
    folder = tmp_path_factory.mktemp("measured")
    (folder / "own <b>&.csv").write_text("time [s],torque [N.m],current [A]\n5,0,0\n6,8,1.2\n8,17,2.1\n")
    angle = np.linspace(0.0, 2.0 * np.pi, 73)
    curve = displaced(LAW.replace(combine="max"), (30e-6, 10e-6)).error(angle)
    columns = {"input_angle": np.degrees(angle), "kinematic_error": curve}
    sw.Recording(columns, {"input_angle": "deg", "kinematic_error": "rad"}).to_csv(folder / "curve.csv")
    return folder


@pytest.fixture(scope="module")
def command(files: Path) -> tuple[MisalignmentStudy, Result]:
    """The study with few trials and ramp times as the command makes it, and what it prints."""
    made: list[MisalignmentStudy] = []

    def kept(*arguments: Any, **options: Any) -> MisalignmentStudy:
        made.append(misalignment(*arguments, **options))
        return made[0]

    kernels.load(sw.load(LUMPED), "simulate_many", compile_it=True)  # the study takes some million steps of it
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(study, "NOISE_TRIALS", 2)
        patch.setattr(study, "TIMES", (1.0,))
        patch.setattr(study, "misalignment", kept)
        measured = ("--measured", files / "own <b>&.csv", "--measured-error", files / "curve.csv")
        ramp = ("--drive", LUMPED, "--stroke", "60", "--time", "3")
        result = strainwave("study", "misalignment", *ramp, *measured, folder=files)
    return made[0], result


@pytest.fixture(scope="module")
def found(command: tuple[MisalignmentStudy, Result]) -> MisalignmentStudy:
    return command[0]


@pytest.fixture(scope="module")
def html(found: MisalignmentStudy) -> str:
    return misalignment_report(found, Provenance("2026-01-01", HOSTILE, {}))


def cells(row: Node) -> list[str]:
    return [cell.text for cell in row.children if isinstance(cell, Node)]


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
def test_the_same_study_gives_the_same_bytes(found: MisalignmentStudy, html: str) -> None:
    assert misalignment_report(found, Provenance("2026-01-01", HOSTILE, {})) == html


@pytest.mark.slow("papers")
def test_every_claim_has_a_verdict_and_a_number(found: MisalignmentStudy, html: str) -> None:
    answers = claims(found)
    assert len(answers) == 12
    for claim in answers:
        assert claim.verdict in (CONFIRMED, IN_PART, CORRECTED)
        assert re.search(r"\d", claim.answer), claim.words
    _, *rows = section(html, "claims").find("tr")
    assert [cells(row) for row in rows] == [[" ".join(part.split()) for part in claim] for claim in answers]


@pytest.mark.slow("papers")
def test_the_tables_say_what_the_recordings_hold(found: MisalignmentStudy, html: str) -> None:
    tables = section(html, "levels").find("table")
    assert len(tables) == len(found.levels) == 6
    for table, levels in zip(tables, found.levels.values(), strict=True):
        _, *rows = table.find("tr")
        assert len(rows) == 8
        for row, swing in zip(rows[:4], levels.column("e1", "torque_swing"), strict=True):
            said = cells(row)[2]
            assert swing < 1e-3 if said == "< 0.001" else printed(said) == pytest.approx(swing, rel=6e-3)


@pytest.mark.slow("papers")
def test_every_figure_names_its_quantities_and_their_units(html: str) -> None:
    expected = {
        "geometry": ("θ", "β₁", "α₂", "β₃", "h", "section"),
        "error": ("pure kinematic error [arcmin]", "input angle [°]"),
        "ramp": ("torque at the output [N·m]", "motor current [A]", "time [s]", "turns of the input"),
        "levels": ("half swing of torque [N·m]", "|m| [µm]"),
        "orders": ("amplitude, torque [N·m]", "order, per turn of the input"),
        "loop": ("frequency of the order [Hz]", "share [%], loop on the motor encoder", "the whole error, reversed"),
        "recovery": ("m in x [µm]",),
        "measured": ("torque at the output [N·m]", "motor current [A]", "measured"),
    }
    for name, words in expected.items():
        texts = [text for svg in section(html, name).find("svg") for text in svg.find("text")]
        written = " ".join("".join(c for c in text.children if isinstance(c, str)) for text in texts)
        for each in words:
            assert each in written, (name, each)


@pytest.mark.slow("papers")
def test_cells_name_their_columns_where_a_page_is_narrow(html: str) -> None:
    for each in Page(html).root.find("table"):
        columns = [column.text for column in each.find("thead")[0].find("th")]
        for row in each.find("tbody")[0].find("tr"):
            for column, cell in zip(columns, (c for c in row.children if isinstance(c, Node)), strict=True):
                assert cell.attributes.get("data-label", column).replace("_", "") == column


@pytest.mark.slow("papers")
def test_every_number_has_its_source(html: str) -> None:
    head, *rows = (cells(row) for row in section(html, "sources").find("tr"))
    assert head == ["Number", "Value", "Unit", "Source"]
    assert all(row[3] for row in rows)


@pytest.mark.slow("papers")
def test_the_lines_for_a_terminal_say_the_same(found: MisalignmentStudy) -> None:
    lines = summary(found).splitlines()
    assert all(line == line.rstrip() and len(line) < 170 for line in lines)
    assert sum(line.startswith(("confirmed", "corrected")) for line in lines) == 12
    assert sum(line.startswith("from ") for line in lines) == 4


# The pure kinematic error


@pytest.mark.slow("papers")
def test_a_curve_of_the_law_itself_is_found_again(found: MisalignmentStudy) -> None:
    """The dimensions are those of the drive: of the same tan(alpha_t) / r_g m, its m is smaller by tan 20 deg / tan 30 deg."""
    pure = found.pure
    assert pure.source == "curve.csv"
    assert pure.best == "max"
    fit = pure.fits["max"]
    m = abs(complex(fit.determined["m_x"], fit.determined["m_y"]))
    assert m == pytest.approx(abs(30e-6 + 10e-6j) * np.tan(radians(20.0)) / np.tan(radians(30.0)), rel=2e-3)
    assert fit.explained > 0.9999


@pytest.mark.parametrize("combine", ["single", "max"])
def test_a_fit_finds_what_a_curve_tells(combine: str) -> None:
    angle = np.linspace(0.0, 2.0 * np.pi, 181)
    law = LAW.replace(combine=combine)
    curve = displaced(law, (12e-6, -9e-6), c_x=3e-6 if combine == "max" else 0.0).error(angle)
    fit = fitted(angle, curve - turn_mean(angle, curve), law)
    sign = 1.0 if combine == "single" or fit.determined["m_x"] > 0.0 else -1.0
    assert [sign * fit.determined["m_x"], sign * fit.determined["m_y"]] == pytest.approx([12e-6, -9e-6], rel=1e-5)
    assert abs(fit.determined.get("c_x", 3e-6)) == pytest.approx(3e-6, rel=1e-4)
    assert fit.rms < 1e-9


def test_two_lobes_that_share_would_have_to_part_from_the_teeth() -> None:
    """a m^2 / 4 b^2 tan(alpha_t) / r_g = 3e-4 rad asks for m = 1.4 mm; the lobes stand out by 0.3 mm."""
    fit = pure_error(None, LAW).fits["mean"]
    assert fit.size == pytest.approx(np.sqrt(4.0 * 24.7e-3**2 * 3e-4 * 25e-3 / (25.3e-3 * np.tan(radians(20.0)))), rel=0.03)
    assert not fit.possible


def test_the_assumed_curve_has_the_harmonics_stated() -> None:
    pure = pure_error(None, LAW)
    spectrum = 2.0 / 360 * np.abs(np.fft.rfft(pure.curve[:-1]))
    assert spectrum[[1, 2, 4]] == pytest.approx([0.8e-4, 3.0e-4, 0.5e-4], rel=1e-6)
    assert pure.source == ""


def test_a_curve_of_less_than_a_turn_is_refused(tmp_path: Path) -> None:
    rows = "".join(f"{angle},{0.001 * angle}\n" for angle in range(0, 200, 5))
    (tmp_path / "half.csv").write_text("input_angle [deg],kinematic_error [mrad]\n" + rows)
    with pytest.raises(ValueError, match=r"half\.csv: 40 points over 195 deg of input_angle; a curve needs 24 points or more"):
        pure_error(tmp_path / "half.csv", LAW)


# The command


@pytest.mark.slow("papers")
def test_the_command_writes_recordings_tables_and_a_page(command: tuple[MisalignmentStudy, Result], files: Path) -> None:
    found, result = command
    assert result.returncode == 0, result.stderr
    assert summary(found) in result.stdout
    folder = files / "out" / "misalignment"
    written = {path.name for path in folder.iterdir()}
    runs = {f"ramp-{side}-tilt-{tilt}deg.parquet" for side in ("input", "output") for tilt in ("0", "0.1", "0.2", "0.4")}
    assert runs | {"report.html", "levels-max-output.csv", "ramp-times-and-gains-input.csv"} <= written
    run = sw.Recording.read(folder / "ramp-output-tilt-0deg.parquet")
    assert run["command"][-1] == pytest.approx(radians(60.0))
    assert run["time"][-1] >= 3.0
    assert "Tilt actuator, lumped gear: 60° in 3 s" in result.stdout


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (("--stroke", "-5"), "stroke = -5.0 deg must lie in (0, inf)"),
        (("--time", "0"), "time = 0.0 s must lie in [1e-06, 600]"),
        (("--time", "1e-3"), "the drive does not follow a ramp of 90 deg in 0.001 s: its input turns by"),
        (("--stroke", "1e9"), "stroke = 1e+09 deg is 2.8e+08 turns of the input; take 3.56e+04 deg or less"),
        (("--measured", "ampere.csv"), 'ampere.csv column "torque": cannot convert "A" to "N.m"; give the column in that unit'),
        (("--measured", "row.csv"), "row.csv has 1 rows; a ramp needs 2 or more"),
        (
            ("--measured-error", "metre.csv"),
            'metre.csv column "kinematic_error": cannot convert "m" to "rad"; give the column as an angle',
        ),
        (("--drive", "position-drive"), "needs a position loop around a speed loop"),
        (("--drive", "hfuc-25-100"), "a drive needs a motor and a load"),
        (("--measured", "none.csv"), "none.csv cannot be read"),
        (("--measured", "empty.csv"), "empty.csv has none of the columns torque, current, output_angle, input_angle"),
        (("--measured-error", "empty.csv"), 'empty.csv has no column "input_angle"'),
    ],
)
def test_wrong_input_is_refused_in_one_line(words: tuple[str, ...], expected: str, tmp_path: Path) -> None:
    (tmp_path / "empty.csv").write_text("time [s],speed [rad/s]\n0,0\n1,1\n")
    (tmp_path / "ampere.csv").write_text("time [s],torque [A]\n0,0\n1,1\n")
    (tmp_path / "row.csv").write_text("time [s],torque [N.m]\n0,0\n")
    (tmp_path / "metre.csv").write_text("input_angle [rad],kinematic_error [m]\n0,0\n1,1\n")
    refused(tmp_path, ["study", "misalignment", *(() if "--drive" in words else ("--drive", LUMPED)), *words], expected)
