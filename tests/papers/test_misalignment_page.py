"""The page of the study of the actuator paper, the lines for a terminal, and the script that writes both."""

from __future__ import annotations

import re
import sys
from math import radians
from pathlib import Path

import misalignment as study
import numpy as np
import pytest
import strainwave as sw
from misalignment import MisalignmentStudy, misalignment
from misalignment_claims import CONFIRMED, CORRECTED, IN_PART, claims
from misalignment_page import page, summary
from pure_error import fitted, pure_error, turn_mean
from strainwave.diagnose import displaced
from strainwave.native import kernels

from tests.papers.markdown import section, tables
from tests.python.report.reading import printed

pytestmark = pytest.mark.slow("papers")  # an article's study runs for seconds

LUMPED = "tilt-actuator-lumped"
LAW = sw.kinematic_error.Misalignment(
    major_radius=25.3e-3, minor_radius=24.7e-3, pitch_radius=25e-3, pressure_angle=radians(20.0)
)


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a measured ramp and a measured curve."""
    folder = tmp_path_factory.mktemp("measured")
    (folder / "own.csv").write_text("time [s],torque [N.m],current [A]\n5,0,0\n6,8,1.2\n8,17,2.1\n")
    angle = np.linspace(0.0, 2.0 * np.pi, 73)
    curve = displaced(LAW.replace(combine="max"), (30e-6, 10e-6)).error(angle)
    columns = {"input_angle": np.degrees(angle), "kinematic_error": curve}
    sw.Recording(columns, {"input_angle": "deg", "kinematic_error": "rad"}).to_csv(folder / "curve.csv")
    return folder


@pytest.fixture(scope="module")
def found(files: Path, tmp_path_factory: pytest.TempPathFactory) -> MisalignmentStudy:
    """The study with few trials and ramp times as the script makes it; its results are in the folder of `files`."""
    made: list[MisalignmentStudy] = []

    def kept(*arguments: object) -> MisalignmentStudy:
        made.append(misalignment(*arguments))  # type: ignore[arg-type]
        return made[0]

    kernels.load(sw.load(LUMPED), "simulate_many", compile_it=True)  # the study takes some million steps of it
    words = ["--drive", LUMPED, "--stroke", "60", "--time", "3", "--out", str(files / "out")]
    words += ["--measured", str(files / "own.csv"), "--measured-error", str(files / "curve.csv")]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(study, "NOISE_TRIALS", 2)
        patch.setattr(study, "TIMES", (1.0,))
        patch.setattr(study, "misalignment", kept)
        patch.setattr(sys, "argv", ["misalignment.py", *words])
        study.main()
    return made[0]


@pytest.fixture(scope="module")
def text(found: MisalignmentStudy) -> str:
    return page(found)


def test_every_claim_has_a_verdict_and_a_number(found: MisalignmentStudy, text: str) -> None:
    answers = claims(found)
    assert len(answers) == 12
    for claim in answers:
        assert claim.verdict in (CONFIRMED, IN_PART, CORRECTED)
        assert re.search(r"\d", claim.answer), claim.words
    _, *rows = tables(section(text, "The paper's claims"))[0]
    assert rows == [list(claim) for claim in answers]


def test_the_tables_say_what_the_recordings_hold(found: MisalignmentStudy, text: str) -> None:
    shown = tables(section(text, "Effect against level"))
    assert len(shown) == len(found.levels) == 6
    for (_, *rows), levels in zip(shown, found.levels.values(), strict=True):
        assert len(rows) == 8
        for row, swing in zip(rows[:4], levels.column("e1", "torque_swing"), strict=True):
            assert swing < 1e-3 if row[2] == "< 0.001" else printed(row[2]) == pytest.approx(swing, rel=6e-3)


def test_every_figure_of_the_page_is_drawn(text: str, files: Path) -> None:
    shown = re.findall(r"\]\((\S+\.svg)\)", text)
    assert sorted(shown) == sorted(path.name for path in (files / "out").glob("*.svg"))
    assert len(shown) == 11


def test_the_recoveries_of_the_page_are_those_found(found: MisalignmentStudy, text: str) -> None:
    _, *rows = tables(section(text, "Recovery from the record of a ramp"))[0]
    assert len(rows) == len(found.recoveries) == 4
    for row, recovery in zip(rows, found.recoveries, strict=True):
        assert float(row[1].split(" ± ")[0]) == pytest.approx(1e6 * recovery.best.size, abs=0.5)
        assert row[5] == f"{recovery.within} of 2"


def test_every_number_has_its_source(text: str) -> None:
    numbers = section(text, "Numbers and sources")
    assert re.search(r"^ +torque_constant +\S+ +N\.m/A +\S", numbers, re.MULTILINE)
    assert "assumed" in numbers


def test_the_lines_for_a_terminal_say_the_same(found: MisalignmentStudy) -> None:
    lines = summary(found).splitlines()
    assert all(line == line.rstrip() and len(line) < 170 for line in lines)
    assert sum(line.startswith(("confirmed", "corrected")) for line in lines) == 12
    assert sum(line.startswith("from ") for line in lines) == 4


# The pure kinematic error


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


# The script


def test_the_script_writes_recordings_tables_and_a_page(found: MisalignmentStudy, text: str, files: Path) -> None:
    folder = files / "out"
    written = {path.name for path in folder.iterdir()}
    runs = {f"ramp-{side}-tilt-{tilt}deg.parquet" for side in ("input", "output") for tilt in ("0", "0.1", "0.2", "0.4")}
    assert runs | {"page.md", "levels-max-output.csv", "ramp-times-and-gains-input.csv"} <= written
    assert (folder / "page.md").read_text(encoding="utf-8") == text
    run = sw.Recording.read(folder / "ramp-output-tilt-0deg.parquet")
    assert run["command"][-1] == pytest.approx(radians(60.0))
    assert run["time"][-1] >= 3.0
    assert "own.csv, with the simulated ramp" in text
    assert "60° in 3 s" in text


@pytest.mark.parametrize(
    ("options", "expected"),
    [
        ({"measured": "ampere.csv"}, 'ampere.csv column "torque": cannot convert "A" to "N.m"; give the column in that unit'),
        ({"measured": "row.csv"}, "row.csv has 1 rows; a ramp needs 2 or more"),
        (
            {"measured_error": "metre.csv"},
            'metre.csv column "kinematic_error": cannot convert "m" to "rad"; give the column as an angle',
        ),
        ({"drive": "position-drive"}, "needs a position loop around a speed loop"),
        ({"drive": "hfuc-25-100"}, "a drive needs a motor and a load"),
        ({"measured": "none.csv"}, "none.csv cannot be read"),
        ({"measured": "empty.csv"}, "empty.csv has none of the columns torque, current, output_angle, input_angle"),
        ({"measured_error": "empty.csv"}, 'empty.csv has no column "input_angle"'),
    ],
)
def test_wrong_input_is_refused(
    options: dict[str, str], expected: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "empty.csv").write_text("time [s],speed [rad/s]\n0,0\n1,1\n")
    (tmp_path / "ampere.csv").write_text("time [s],torque [A]\n0,0\n1,1\n")
    (tmp_path / "row.csv").write_text("time [s],torque [N.m]\n0,0\n")
    (tmp_path / "metre.csv").write_text("input_angle [rad],kinematic_error [m]\n0,0\n1,1\n")
    monkeypatch.chdir(tmp_path)
    with pytest.raises((ValueError, OSError), match=re.escape(expected)):
        misalignment(**({"drive": LUMPED} | options))  # type: ignore[arg-type]
