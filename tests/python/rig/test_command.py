"""The command `strainwave rig`: plans, guides, follows, analyses and simulates torsion tests."""

from __future__ import annotations

import hashlib
import json
import shutil
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
import strainwave as sw
from strainwave.files.recording import Recording
from strainwave.report.provenance import Provenance
from strainwave.rig.analysis.cycle import cycle_to
from strainwave.rig.bench.steps import read_steps, write_steps
from strainwave.rig.influence.series import Series, analyse_series, trend_words
from strainwave.rig.report.influence import influence_report, summary
from strainwave.rig.running.plan import plan

from tests.python.command import Result, refused, strainwave
from tests.python.report.measured import HOSTILE
from tests.python.report.reading import Page, section

PUBLISHED = Path(sw.__file__).with_name("published")
LOOP, GEAR = PUBLISHED / "torsional-stiffness-loop.csv", PUBLISHED / "torsional-stiffness.toml"
SMALL = ("--torque", 0.1, "--positions", "0")  # nine steps


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A virtual test of one position with 29 steps."""
    folder = tmp_path_factory.mktemp("test")
    result = strainwave("rig", "simulate", "--positions", 0, "--out", "test", folder=folder)
    assert result.returncode == 0, result.stderr
    return folder / "test"


@pytest.fixture(scope="module")
def analysed(made: Path) -> Result:
    """The analysis of it, in `found` beside it."""
    result = strainwave("rig", "analyse", "test", "--gear", GEAR, "--out", "found", folder=made.parent)
    assert result.returncode == 0, result.stderr
    return result


@pytest.fixture(scope="module")
def short(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A virtual test of nine steps."""
    folder = tmp_path_factory.mktemp("short")
    assert strainwave("rig", "simulate", *SMALL, "--out", "test", folder=folder).returncode == 0
    return folder / "test"


@pytest.fixture
def test(short: Path, tmp_path: Path) -> Path:
    """The same, to be changed at will."""
    return Path(shutil.copytree(short, tmp_path / "test"))


@pytest.fixture
def typed(monkeypatch: pytest.MonkeyPatch) -> Iterator[list[str]]:
    """What is answered at the rig, one after the other; then nobody is there any more."""
    answers: list[str] = []

    def read() -> str:
        if not answers:
            raise EOFError
        return answers.pop(0)

    monkeypatch.setattr("builtins.input", read)
    return answers


# ---- plan ------------------------------------------------------------------------------------------------------------


def test_a_plan_is_printed_step_by_step_and_written(tmp_path: Path) -> None:
    result = strainwave("rig", "plan", "--specimens", "A,B", "--out", "plan.csv", folder=tmp_path)
    assert result.returncode == 0
    printed = " ".join(result.stdout.split())
    assert "0.36 N.m is no step of these masses" in printed
    assert "positive pans: lay 7 x 25 g on each" in printed
    expected = plan(sw.rig.load("couple-rig"), units=["A", "B"])
    assert tuple(read_steps(tmp_path / "plan.csv")) == expected.steps
    rows = [line for line in result.stdout.splitlines() if line.startswith("  step ")]
    assert len(rows) == len(expected.steps) == 2 * 3 * 29


def test_options_change_the_plan(tmp_path: Path) -> None:
    coarse = strainwave("rig", "plan", "--positions", "0", "--step", 0.1, "--cycles", 2, "--unequal", folder=tmp_path)
    assert "  step 1     0.36775  N·m  at 0°, 375 g and 0 g, peak" in coarse.stdout
    assert "side force" in " ".join(coarse.stdout.split())


@pytest.mark.parametrize(
    ("options", "expected"),
    [
        (("--rig", "nope"), 'no rig "nope" comes with the package'),
        (("--rig", "nope.toml"), "nope.toml"),
        (("--torque", "-1"), "peak = -1.0 N.m must lie in (0, inf)"),
        (("--torque", "9"), "at most 1200 g, which is 1.177 N.m: ask for less"),
        (("--positions", "0,left"), "--positions 0,left: write numbers with commas between"),
        (("--positions", "0,\u0663"), "write numbers with commas between"),
        (("--torque", "\u0663"), "'--torque': \"\u0663\" is no number"),
        (("--step", "nan"), "'--step': \"nan\" is no number"),
        (("--cycles", "\u0663"), "'--cycles': \"\u0663\" is no whole number"),
        (("--cycles", 5000 * "9"), "is no whole number; write digits, at most 18"),
        (("--step", "1e-9", "--torque", "1e300"), "at most 1200 g"),
        (("--cycles", "1000000"), "the plan has about 96000000 steps; at most 100000"),
        (("--positions", "0,0"), "must each name a thing once"),
        (("--cycles", "0"), "cycles = 0 must be 1 or more"),
        (("--out", "plan.txt"), "--out plan.txt must end in .csv"),
    ],
)
def test_a_plan_that_cannot_be_made_is_refused(tmp_path: Path, options: tuple[str, ...], expected: str) -> None:
    refused(tmp_path, ("rig", "plan", *options), expected)


# ---- simulate and analyse ----------------------------------------------------------------------------------------------


@pytest.mark.slow("commands")
def test_a_virtual_test_gives_back_the_row_of_document_t(made: Path, analysed: Result) -> None:
    out = made.parent / "found"
    names = {"report.html", "results.json", "loop-0deg.csv", "loop-0deg.parquet", "angles.csv", "angles.parquet"}
    assert {path.name for path in out.iterdir()} == names
    found = json.loads((out / "results.json").read_text())
    (loop,) = found["loops"]
    printed = {"positive_unloading": 4.51, "negative_loading": 0.31, "negative_unloading": 4.85, "positive_loading": 0.30}
    for regime, value in printed.items():
        softest = loop["stiffness"][regime]["softest"]
        assert softest["low"] < value < softest["high"], regime
        assert abs(softest["value"] / value - 1.0) < 0.01
    assert np.degrees(loop["width_at_zero"]["low"]) < 50.5 < np.degrees(loop["width_at_zero"]["high"])
    assert found["deviations_from_plan"] == []
    steps = read_steps(made)
    assert set(found["photographs"]) == {step.image for step in steps}
    assert f"for a gear: strainwave identify {GEAR} found/loop-0deg.csv\n" in analysed.stdout


@pytest.mark.slow("commands")
def test_the_photographs_stay_as_they_are_and_the_report_has_their_hashes(test: Path, tmp_path: Path) -> None:
    before = {path.name: hashlib.sha256(path.read_bytes()).hexdigest() for path in test.iterdir()}
    assert strainwave("rig", "analyse", "test", folder=tmp_path).returncode == 0
    after = {path.name: hashlib.sha256(path.read_bytes()).hexdigest() for path in test.iterdir() if path.is_file()}
    assert after == before
    html = (test / "analysis" / "report.html").read_text()
    assert all(digest in html for name, digest in before.items() if name.endswith(".png") or name in ("steps.csv", "rig.toml"))


@pytest.mark.slow("commands")
def test_the_loop_feeds_an_identification_without_retyping(made: Path, analysed: Result) -> None:
    command = next(line for line in analysed.stdout.splitlines() if line.startswith("for a gear: "))
    result = strainwave(*command.removeprefix("for a gear: strainwave ").split(), "--out", "gear", folder=made.parent)
    assert result.returncode == 0, result.stderr
    assert "loop-0deg.csv: a torsion loop or branch" in result.stdout
    assert "gear.stiffness.a1," in (made.parent / "gear" / "numbers.csv").read_text()


@pytest.mark.slow("commands")
def test_a_loop_that_others_measured_is_analysed(tmp_path: Path) -> None:
    result = strainwave("rig", "analyse", LOOP, "--gear", GEAR, "--rated-torque", 0.36, folder=tmp_path)
    assert result.returncode == 0, result.stderr
    (loop,) = json.loads((tmp_path / "out" / "rig" / "results.json").read_text())["loops"]
    assert np.degrees(loop["hysteresis_loss"]["value"]) == pytest.approx(50.5, abs=1e-3)
    assert loop["area"]["value"] == pytest.approx(0.3063483432, rel=1e-4)
    again = Recording.read(tmp_path / "out" / "rig" / "loop-0deg.csv")
    assert np.allclose(again.values("input_angle", "deg"), Recording.read(LOOP)["input_angle"])


@pytest.mark.slow("commands")
def test_columns_of_a_loop_may_have_other_names_and_no_units(tmp_path: Path) -> None:
    loop = Recording.read(LOOP)
    rows = zip(loop.values("input_angle", "deg").tolist(), loop.values("input_torque", "N.m").tolist(), strict=True)
    (tmp_path / "mine.csv").write_text("turn,load\n" + "".join(f"{turn},{load}\n" for turn, load in rows))
    asked = strainwave("rig", "analyse", "mine.csv", folder=tmp_path)
    assert (asked.returncode, asked.stdout) == (2, "")
    assert "strainwave rig analyse mine.csv --side input --column torque=load" in asked.stderr
    named = ("--column", "input_angle=turn", "--column", "input_torque=load")
    asked = strainwave("rig", "analyse", "mine.csv", *named, folder=tmp_path)
    assert (asked.returncode, asked.stdout) == (2, "")
    assert asked.stderr.rstrip().endswith("--unit input_angle=deg")
    refused(tmp_path, ("rig", "analyse", "mine.csv", "--column", "colour=turn"), "colour is no column of these measurements")
    units = ("--unit", "input_angle=deg", "--unit", "input_torque=N.m")
    result = strainwave("rig", "analyse", "mine.csv", *named, *units, folder=tmp_path)
    assert result.returncode == 0, result.stderr
    again = Recording.read(tmp_path / "out" / "rig" / "loop-0deg.csv")
    assert np.allclose(again.values("input_angle", "deg"), loop.values("input_angle", "deg"))


@pytest.mark.slow("commands")
def test_loops_of_an_earlier_analysis_are_told(tmp_path: Path) -> None:
    for position in (30, 0):
        result = strainwave("rig", "analyse", LOOP, "--positions", position, folder=tmp_path)
    assert "of an earlier analysis, and no part of this one: loop-30deg.csv, loop-30deg.parquet" in result.stdout


def test_a_virtual_test_says_what_its_steps_of_torque_cost(tmp_path: Path) -> None:
    result = strainwave("rig", "simulate", "--positions", 60, "--step", 0.3, "--out", "test", folder=tmp_path)
    assert "the peak is 0.3432 N.m: 0.36 N.m is no step of the masses" in result.stdout
    assert "at 60 degrees the torsional stiffness article's loop has its 51.9 degrees from 0.353 N.m on; " in result.stdout
    assert "at 0.343 N.m it is narrower" in result.stdout


@pytest.mark.slow("commands")
def test_loops_of_several_files_are_compared(tmp_path: Path) -> None:
    other = Recording.read(LOOP)
    Recording({"input_angle": 1.02 * other["input_angle"], "input_torque": other["input_torque"]}, other.units).to_csv(
        tmp_path / "other.csv"
    )
    result = strainwave("rig", "analyse", LOOP, "other.csv", "--positions", "0,60", folder=tmp_path)
    assert "Flexspline at 60°" in result.stdout
    assert "they differ" in result.stdout


@pytest.mark.slow("commands")
def test_friction_from_a_table_is_taken_out(tmp_path: Path) -> None:
    speed = np.array([1.0, 2.0, 5.0, 10.0, 20.0])
    Recording({"speed": speed, "torque": 0.02 + 1e-3 * speed}, {"speed": "rad/s", "torque": "N.m"}).to_csv(
        tmp_path / "friction.csv"
    )
    result = strainwave("rig", "analyse", LOOP, "--gear", GEAR, "--friction", "friction.csv", folder=tmp_path)
    assert result.returncode == 0, result.stderr
    setting, _, limits = result.stdout.partition("limits of this test:")
    assert "Corrections: Friction of the wave generator, ±0.02 N·m at the input, is subtracted (friction table" in setting
    assert "is subtracted" not in limits
    (loop,) = json.loads((tmp_path / "out" / "rig" / "results.json").read_text())["loops"]
    assert loop["corrections"][0].startswith("friction of the wave generator, ±0.02 N.m at the input, is subtracted")
    analysed = tmp_path / "out" / "rig" / "loop-0deg.csv"
    assert Recording.read(analysed)["input_torque"] == pytest.approx(Recording.read(LOOP)["input_torque"])
    command = next(line for line in result.stdout.splitlines() if line.startswith("for a gear: "))
    gear = strainwave(*command.removeprefix("for a gear: strainwave ").split(), folder=tmp_path)
    assert gear.returncode == 0, gear.stderr
    assert "NOT USED" not in gear.stdout
    assert "friction.csv: a table of steady friction" in gear.stdout
    assert "loop-0deg.csv: a torsion loop or branch" in gear.stdout


@pytest.mark.slow("commands")
def test_departures_from_the_plan_are_told(test: Path, tmp_path: Path) -> None:
    steps = read_steps(test)
    write_steps([step for step in steps if step.number != 3], test / "steps.csv")
    result = strainwave("rig", "analyse", "test", folder=tmp_path)
    assert "Step 3 of the plan is skipped" in result.stdout


@pytest.mark.slow("commands")
def test_a_photograph_that_tells_nothing_is_left_out_and_told(test: Path, tmp_path: Path) -> None:
    (test / "step-004.png").write_bytes(b"not a picture")
    result = strainwave("rig", "analyse", "test", folder=tmp_path)
    assert result.returncode == 0
    assert "step-004.png" in result.stdout
    assert len(Recording.read(test / "analysis" / "loop-0deg.csv")) == 8


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        (("nowhere",), "nowhere: there is no such folder or file"),
        ((".",), "holds no steps.csv"),
        (("test", "--reference", "x.png"), 'reference = "x.png" is no photograph of a step'),
        (("test", "--rig", "nope"), 'no rig "nope"'),
        (("test", "--gear", "nope"), 'no set "nope"'),
        (("test", "--rated-torque", "-1"), "--rated-torque = -1.0 N.m must lie in (0, inf)"),
        (("test", "--friction", "x.csv"), "needs a gear"),
        (("test", "--positions", "1,2"), "there are 2 positions for 0 files"),
        ((LOOP, "--reference", "x.png"), "are for folders of tests"),
        ((GEAR,), "torsional-stiffness.toml"),
    ],
)
def test_what_cannot_be_analysed_is_refused(test: Path, tmp_path: Path, arguments: tuple[object, ...], expected: str) -> None:
    refused(tmp_path, ("rig", "analyse", *arguments), expected)


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        (("mass_positive [kg]", "mass_positive [m]"), "steps.csv"),
        (("mass_positive [kg]", "mass_positive"), 'column "mass_positive" has no unit'),
        (("0.1,", "-0.1,"), "mass_positive"),
        (("0.1,", "much,"), '"much" is no number'),
    ],
)
def test_a_record_that_is_wrong_is_refused_with_its_place(
    test: Path, tmp_path: Path, change: tuple[str, str], expected: str
) -> None:
    record = test / "steps.csv"
    assert change[0] in record.read_text()
    record.write_text(record.read_text().replace(*change, 1))
    refused(tmp_path, ("rig", "analyse", "test"), "steps.csv", expected)


def test_photographs_that_are_not_there_are_refused_where_none_is_left(test: Path, tmp_path: Path) -> None:
    for path in test.glob("*.png"):
        path.unlink()
    refused(tmp_path, ("rig", "analyse", "test"), "no position has two steps with torque and angle")


@pytest.mark.slow("commands")
def test_results_are_whole_or_not_there(made: Path, tmp_path: Path) -> None:
    (tmp_path / "found" / "report.html").mkdir(parents=True)
    refused(tmp_path, ("rig", "analyse", made, "--out", "found"), "report.html cannot be written: it is a folder")


# ---- measure ---------------------------------------------------------------------------------------------------------


@pytest.mark.slow("commands")
def test_a_test_is_rehearsed_broken_off_and_resumed(tmp_path: Path, typed: list[str]) -> None:
    measure = ("rig", "measure", "--camera", "virtual", "--interval", 1e-6, *SMALL, "--out", "test")
    typed += ["", "t 23.5", "", "q"]
    first = strainwave(*measure, folder=tmp_path)
    assert first.returncode == 0, first.stderr
    assert "stopped after step 3 of 9" in first.stdout
    assert "Step 1 of 9: flexspline at 0 degrees; positive pans: lay 2 x 25 g on each" in first.stderr
    assert [step.temperature for step in read_steps(tmp_path / "test")] == [None, pytest.approx(296.65), None]
    typed += [""] * 6
    second = strainwave(*measure, folder=tmp_path)
    assert "all 9 steps are made" in second.stdout
    assert "Step 4 of 9" in second.stderr
    assert "Step 3 of 9" not in second.stderr
    steps = read_steps(tmp_path / "test")
    assert [step.image for step in steps] == [f"{number:04}.png" for number in range(1, 10)]
    assert {path.name for path in (tmp_path / "test").iterdir()} == {
        *(str(s.image) for s in steps),
        "rig.toml",
        "steps.csv",
        "plan.csv",
    }
    assert strainwave("rig", "analyse", "test", folder=tmp_path).returncode == 0


@pytest.mark.slow("commands")
def test_another_plan_does_not_go_on_with_a_test(tmp_path: Path, typed: list[str]) -> None:
    measure = ("rig", "measure", "--camera", "virtual", "--interval", 1e-6, "--out", "test")
    typed += ["", "q"]
    assert strainwave(*measure, *SMALL, folder=tmp_path).returncode == 0
    refused(tmp_path, (*measure, "--positions", "0"), "plan.csv holds another plan")


def test_a_folder_that_another_program_fills_is_a_camera(tmp_path: Path, short: Path) -> None:
    camera = tmp_path / "camera"
    camera.mkdir()

    def filled() -> str:  # the other program takes a picture while the guide waits for the next
        def take() -> None:
            time.sleep(0.05)
            shutil.copyfile(short / "step-001.png", camera / f"{len(list(camera.iterdir()))}.png")

        threading.Thread(target=take).start()
        return ""

    with pytest.MonkeyPatch.context() as patch:
        answers = iter([filled, lambda: "q"])
        patch.setattr("builtins.input", lambda: next(answers)())
        options = ("--camera", "camera", "--pictures", 1, "--interval", 0.01, "--out", "test")
        result = strainwave("rig", "measure", *options, *SMALL, folder=tmp_path)
    assert "stopped after step 1 of 9" in result.stdout
    assert (tmp_path / "test" / "0001.png").read_bytes() == (short / "step-001.png").read_bytes()


@pytest.mark.parametrize(
    ("options", "expected"),
    [
        (("--camera", "nowhere"), "--camera nowhere: there is no such folder"),
        (("--camera", "virtual", "--gear", "nope"), 'no set "nope"'),
        (("--camera", "virtual", "--positions", "30"), "position = 30 degrees must be 0, 60 or 120"),
        (("--camera", "\u0663"), "there is no such folder"),
        (("--camera", "virtual", "--interval", "0"), "--interval 0 s must be above 0 and at most 1e+06"),
        (("--camera", "virtual", "--interval", "inf"), "'--interval': \"inf\" is no number"),
        (("--camera", "virtual", "--pictures", "0"), "--pictures 0 must be 1 to 1000"),
        (("--camera", "virtual", "--rig", "nope"), 'no rig "nope"'),
    ],
)
def test_a_test_that_cannot_be_made_is_refused_and_leaves_nothing(
    tmp_path: Path, options: tuple[str, ...], expected: str
) -> None:
    refused(tmp_path, ("rig", "measure", "--out", "test", *options), expected)


def test_a_camera_without_opencv_says_what_to_install(
    tmp_path: Path, typed: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "cv2", None)
    typed.append("")
    result = strainwave("rig", "measure", "--camera", 0, *SMALL, "--out", "test", folder=tmp_path)
    assert result.returncode == 2
    assert "install strainwave[video]" in result.stderr.splitlines()[-1]


@pytest.mark.slow("commands")
def test_a_guide_that_is_killed_leaves_what_was_done(tmp_path: Path) -> None:
    command = [
        sys.executable,
        "-m",
        "strainwave",
        "rig",
        "measure",
        "--camera",
        "virtual",
        "--interval",
        "0.001",
        "--out",
        "test",
    ]
    with subprocess.Popen(
        [*command, *map(str, SMALL)], cwd=tmp_path, stdin=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as process:
        assert process.stdin is not None
        assert process.stderr is not None
        process.stdin.write("\n\n")
        process.stdin.flush()
        while "0002.png" not in (line := process.stderr.readline()):
            assert line
        process.kill()
    assert [step.image for step in read_steps(tmp_path / "test")] == ["0001.png", "0002.png"]


# ---- watch -----------------------------------------------------------------------------------------------------------


@pytest.mark.slow("commands")
def test_a_folder_is_followed(made: Path, tmp_path: Path) -> None:
    result = strainwave("rig", "watch", made, "--idle", 1e-3, "--interval", 1e-3, folder=tmp_path)
    assert result.returncode == 0
    lines = result.stderr.splitlines()
    assert len(lines) == 29
    assert lines[0].startswith("step-001.png  +0.343 N·m  +0.0000°")
    assert "29 photographs, 29 of them with an angle" in result.stdout


def test_without_a_record_the_plan_tells_the_torque(test: Path, tmp_path: Path) -> None:
    (test / "steps.csv").unlink()
    shutil.copyfile(test / "step-001.png", test / "step-003.png")
    result = strainwave("rig", "watch", "test", "--idle", 0.2, "--interval", 1e-3, folder=tmp_path)
    assert "step-002.png  +0.049 N·m  −0.6" in result.stderr
    assert "is the same picture as" in result.stderr
    (test / "plan.csv").unlink()
    result = strainwave("rig", "watch", "test", "--idle", 0.2, "--interval", 1e-3, folder=tmp_path)
    assert "step-002.png  torque not known" in result.stderr


def test_a_folder_that_cannot_be_followed_is_refused(test: Path, tmp_path: Path) -> None:
    refused(tmp_path, ("rig", "watch", "nowhere"), "nowhere: there is no such folder")
    refused(tmp_path, ("rig", "watch", "test", "--idle", "0"), "--idle 0 s must be above 0")
    refused(tmp_path, ("rig", "watch", "test", "--plan", "nope.csv"), "nope.csv")


def test_the_command_writes_a_page_of_the_loops(tmp_path: Path) -> None:
    gear, loops = sw.load("csg-25-100"), []
    for torque in (20.0, 40.0, 60.0, 87.0):
        loop = cycle_to(gear, torque)
        columns = {"twist": loop.angle[::10], "torque": loop.torque[::10]}
        sw.Recording(columns, {"twist": "rad", "torque": "N.m"}).to_csv(tmp_path / f"{torque:g}.csv")
        loops += ["--loop", f"{torque:g}.csv,torque_max={torque:g}"]
    result = strainwave("rig", "influence", *loops, "--out", "found", folder=tmp_path)
    assert result.returncode == 0, result.stderr
    assert [path.name for path in (tmp_path / "found").iterdir()] == ["report.html"]
    assert result.stdout.startswith("4 loops, 4 loops\n  loop area goes with the power 0.8")
    files = Page((tmp_path / "found" / "report.html").read_text()).root.find("footer")[0].text
    assert "20.csv" in files
    assert "87.csv" in files


def test_the_page_and_the_lines_have_every_trend() -> None:
    warm = np.array([280.0, 290.0, 300.0, 310.0, 320.0, 330.0])
    series = Series({"temperature": warm}, {"area": np.exp(-0.02 * warm), "friction": warm}, name="<b>&", units=list("AABBAB"))
    trends = analyse_series(series)
    html, lines = influence_report(series, trends, Provenance("2026-01-01", HOSTILE, {})), summary(series, trends)
    page = section(html, "measured")
    assert len(trends) == len(page.find("tbody")[0].find("tr")) == 2
    for trend in trends:
        assert trend_words(trend) in page.text
        assert trend_words(trend).split()[0] in lines
    assert [row.find("td")[-1].text for row in page.find("tbody")[0].find("tr")] == ["significant", "significant"]
    assert "<b>&, 6 loops" in Page(html).root.find("header")[0].text
    assert "elastic" not in page.text
    assert [len(page.find("svg"))] == [1]
    assert max(map(len, lines.splitlines())) <= 110
    assert influence_report(series, trends, Provenance("2026-01-01", HOSTILE, {})) == html


def test_a_law_of_the_wrong_shape_is_told() -> None:
    torque = np.repeat([0.05, 0.1, 0.2, 0.4, 0.8], 3)
    area = np.minimum(torque, 0.2) * (1.0 + 0.01 * np.tile([-1.0, 0.0, 1.0], 5))
    series = Series({"torque_max": torque}, {"area": area}, name="saturates")
    (trend,) = analyse_series(series)
    assert "the law is not that of the measurements" in trend_words(trend)


@pytest.mark.slow("rig")
def test_wrong_options_are_refused_in_a_line(tmp_path: Path) -> None:
    (tmp_path / "series.csv").write_text("torque_max [N.m],speed [rpm]\n1,2\n")
    refused(tmp_path, ["rig", "influence"], "give one series: a table with --measured, or its loops with --loop")
    refused(tmp_path, ["rig", "influence", "--measured", "series.csv"], 'series.csv has a column "speed"')
    refused(tmp_path, ["rig", "influence", "--measured", "series.csv", "--loop", "a.csv,hours=1"], "give one series")
