"""The report of a torsion test: what stands in it agrees with what was found."""

from __future__ import annotations

import json
from dataclasses import replace
from math import degrees, radians
from pathlib import Path

import numpy as np
import pytest
from strainwave.files.gear_set import GearSet
from strainwave.files.recording import Recording
from strainwave.identification.reading.recognise import recognise
from strainwave.report.provenance import Provenance
from strainwave.report.results_json import plain, results_json
from strainwave.rig import Camera, Loop, Step, Value, analyse, load
from strainwave.rig.analysis.result import Result
from strainwave.rig.reading.evaluation import Evaluation, evaluate
from strainwave.rig.report.figures import COLOURS, loop_figure, stiffness_figure
from strainwave.rig.report.files import angle_files, loop_files, loop_names, results
from strainwave.rig.report.page import rig_report, setting, summary, unknown
from strainwave.rig.report.tables import rig_rows, stated
from strainwave.rig.virtual.loading import load_by_steps
from strainwave.rig.virtual.printed import printed_gear
from strainwave.rig.virtual.render import Scene, render
from strainwave.rig.vision.angle import Angles, measure_angles
from strainwave.rig.vision.image import as_image

from tests.python.report.reading import Page, points, printed, section

HOSTILE = "<script>alert(1)</script>"
RIG = load("couple-rig")
MASSES = np.concatenate((np.arange(0.375, -0.376, -0.025), np.arange(-0.35, 0.376, 0.025))).round(6)


def loop_at(position: int) -> Loop:
    """What a perfect rig measures of document T's gear at a position."""
    steps = [Step(n, max(m, 0.0), max(-m, 0.0)) for n, m in enumerate(MASSES.tolist(), 1)]
    found = load_by_steps(printed_gear(position), RIG, steps)
    errors = {"angle_sigma": 3e-5, "torque_sigma": 1e-4, "torque_scale": 2e-3}
    return Loop(found.angle, found.shaft, side="input", name="made", position=radians(position), **errors)


@pytest.fixture(scope="module")
def gear_set() -> GearSet:
    return GearSet.of(printed_gear(0), name="Gear <T>", source="assumed: example")


@pytest.fixture(scope="module")
def angles() -> Angles:
    """Of three photographs, one of which shows no markers."""
    scene, random = Scene(size=(160, 120), radius=12.0, distance=80.0, noise=0.01), np.random.default_rng(1)
    shown = [as_image(f"{n}.png", render(scene, angle, random)) for n, angle in enumerate((0.0, -0.2, -0.4), 1)]
    blind = as_image("blind.png", render(replace(scene, markers=(0.78, 0.78)), 0.0, random))
    return measure_angles([*shown, blind])


@pytest.fixture(scope="module")
def found(gear_set: GearSet, angles: Angles) -> Evaluation:
    steps = [Step(n, max(m, 0.0), max(-m, 0.0), time=60.0 * n) for n, m in enumerate(MASSES.tolist(), 1)]
    return evaluate(
        [loop_at(0), loop_at(60)],
        gear_set=gear_set,
        rated_torque=0.37,
        rig=RIG,
        steps=steps,
        angles=[angles],
        remarks=(HOSTILE,),
        deviations=(),
    )


@pytest.fixture(scope="module")
def html(found: Evaluation) -> str:
    return rig_report(found, Provenance("2026-01-01 12:00 UTC", "strainwave rig analyse test", {"steps.csv": "0a1b"}))


@pytest.mark.slow("report")
def test_the_page_is_whole_safe_and_the_same_each_time(found: Evaluation, html: str) -> None:
    root = Page(html).root
    assert not root.find("script")
    assert "Gear &lt;T&gt;" in html
    assert html == rig_report(found, Provenance("2026-01-01 12:00 UTC", "strainwave rig analyse test", {"steps.csv": "0a1b"}))
    anchors = {link.attributes["href"].removeprefix("#") for link in root.find("a")}
    assert anchors <= {node.attributes.get("id", "") for node in root.walk()}
    identifiers = [node.attributes["id"] for node in root.walk() if "id" in node.attributes]
    assert len(identifiers) == len(set(identifiers))


@pytest.mark.slow("report")
def test_the_table_has_the_rows_of_document_t(html: str) -> None:
    first = section(html, "table").find("tbody")[0]
    for row, expected in zip(first.find("tr"), ((4.51, 0.31, 4.85, 0.30, 50.5), (4.36, 0.29, 3.59, 0.33, 51.9)), strict=True):
        cells = [str(cell.children[0]) for cell in row.find("td")]
        assert [printed(cell) for cell in cells[:4]] == pytest.approx(expected[:4], rel=0.01)
        assert printed(cells[4]) == pytest.approx(expected[4], rel=0.005)
        assert printed(cells[5]) == pytest.approx(0.6 * expected[4], rel=0.005)  # arcmin at the output of a gear 1:100


@pytest.mark.slow("report")
def test_document_t_s_own_rows_are_said_not_to_close_as_secants(html: str) -> None:
    """The gaps are those of physics section 8: +1.90, -7.61 and -2.82 degrees."""
    text = section(html, "table").text
    assert all(gap in text for gap in ("+1.90°", "−7.61°", "−2.82°", "0.292", "0.286"))


@pytest.mark.slow("report")
def test_each_loop_has_its_widths_by_every_definition(html: str, found: Evaluation) -> None:
    loops = section(html, "loops")
    widths = loops.find("table", **{"class": "rows widths"})
    assert len(widths) == len(found.analyses)
    names = [row.find("th")[0].text for row in widths[0].find("tr")[1:]]
    assert names[:4] == ["Hysteresis", "Width at zero torque", "Hysteresis loss", "Lost motion"]
    cells = {row.find("th")[0].text: str(row.find("td")[1].children[0]) for row in widths[0].find("tr")[1:]}
    analysis = found.analyses[0]
    assert analysis.hysteresis_loss is not None
    assert printed(cells["Hysteresis loss"].rstrip("°")) == pytest.approx(degrees(analysis.hysteresis_loss.value), abs=0.01)
    assert len(loops.find("svg")) == 2 * len(found.analyses)


@pytest.mark.slow("report")
def test_the_legend_has_the_regimes_first_and_the_regression_in_ink(html: str) -> None:
    local = section(html, "loops").find("svg")[1]
    words = [text for node in local.find("text") if (text := node.text.strip()) in (*COLOURS, "regression over the regime")]
    assert words == [*COLOURS, "regression over the regime"]


@pytest.mark.slow("report")
def test_the_definitions_of_widths_are_as_wide_as_a_narrow_screen(html: str) -> None:
    assert "(min-width: 48.01rem) { .widths td:nth-child(2) { width: 45%; } }" in html


@pytest.mark.slow("report")
def test_budget_photographs_steps_and_rig_are_in_the_page(html: str, angles: Angles) -> None:
    assert "friction of the pulleys, share of the torque" in section(html, "uncertainty").text
    photographs = section(html, "photographs").text
    assert "of no use: no marker" in photographs
    assert all(frame.sha256 in html for frame in angles.frames)
    assert "Every step was made as planned" in section(html, "steps").text
    assert "Radius of the disk" in section(html, "setup").text
    assert "0a1b" in html
    assert "Tested by" in html


@pytest.mark.slow("report")
def test_what_could_not_be_told_comes_first(found: Evaluation, html: str) -> None:
    said = unknown(found)
    assert any("One specimen" in each for each in said)
    assert any("friction of the wave generator" in each for each in said)
    assert f"{HOSTILE}." in said
    assert "Limits of this test" in section(html, "summary").text


def test_a_loop_alone_makes_a_report_that_says_what_is_missing() -> None:
    alone = evaluate([Loop([3.0, 2.0, -3.0, -2.0, 3.0], [1.0, 0.0, -1.0, 0.0, 1.0], side="output", name="alone")])
    page = rig_report(alone)
    assert "No rig was given" in section(page, "uncertainty").text
    assert not Page(page).root.find("section", id="photographs")
    assert any("No gear is named" in each for each in unknown(alone))
    assert "′" in section(page, "loops").text  # arcminutes at the output
    assert "Flexspline at 0°" in summary(alone)


def test_a_photograph_that_is_left_out_is_told_once() -> None:
    loop = Loop([3.0, 2.0, -3.0, -2.0, 3.0], [1.0, 0.0, -1.0, 0.0, 1.0], side="output", name="alone")
    fault = "a.png: cannot be read: is empty"
    found = evaluate([replace(loop, remarks=(f"step 2 is left out: {fault}",))], remarks=(fault, "b.png: blurred"))
    assert [each for each in unknown(found) if ".png" in each] == [f"Step 2 is left out: {fault}.", "b.png: blurred."]


@pytest.mark.slow("report")
def test_the_setting_says_what_was_tested(found: Evaluation) -> None:
    said = setting(found)
    assert said["Specimen"] == "Gear <T>"
    assert said["Positions of the flexspline"] == "0°, 60°"
    assert said["Photographs"] == "4, 1 without an angle"
    assert said["Duration"] == "1 h 00 min"


def test_a_number_is_rounded_to_its_interval() -> None:
    def of(value: float, half: float) -> str:
        return str(stated(Result(value, "", half / 2.0, 0.0, value - half, value + half)))

    assert of(4.5123, 0.0876) == "4.512 (4.425 to 4.600)"
    assert of(31234.0, 870.0) == "31230 (30360 to 32100)"
    assert of(-0.5, 0.05) == "−0.500 (−0.550 to −0.450)"
    assert of(0.3, 1e-9) == "0.300000 (± 1 × 10⁻⁹)"
    assert str(stated(Result(2.0, "", 0.1, 0.0, 1.5, float("inf")))) == "2 (1.5 to ∞)"


# ---- Files in its folder ---------------------------------------------------------------------------------------------


@pytest.mark.slow("report")
def test_results_are_json_with_every_number(found: Evaluation) -> None:
    read = json.loads(results_json(results(found, "today")))
    assert [loop["label"] for loop in read["loops"]] == list(found.labels)
    softest = read["loops"][0]["stiffness"]["negative_loading"]["softest"]
    assert softest["value"] == found.analyses[0].stiffnesses[1].softest.value
    assert read["photographs"] == {frame.name: frame.sha256 for each in found.angles for frame in each.frames}
    assert plain({"not": float("nan"), "endless": float("inf")}) == {"not": None, "endless": None}


@pytest.mark.slow("report")
def test_loops_are_written_as_a_twin_reads_them(found: Evaluation) -> None:
    files = loop_files(found.measured)
    assert set(files) == {f"{name}.{ending}" for name in loop_names(found.loops) for ending in ("csv", "parquet")}
    assert files["loop-0deg.csv"].splitlines()[1] == b'"input_angle [rad]","input_torque [N.m]"'


@pytest.mark.slow("report")
def test_names_of_files_hold_nothing_that_a_path_must_not() -> None:
    loops = [replace(loop_at(0), unit=unit) for unit in ("../A", "B 1", "B 1")]
    assert loop_names(loops) == ["loop-A-0deg", "loop-B-1-0deg-1", "loop-B-1-0deg-2"]


def test_the_table_of_angles_has_a_row_for_each_photograph(angles: Angles) -> None:
    rows = angle_files([angles])["angles.csv"].decode().splitlines()
    assert len(rows) == 1 + len(angles.frames)
    assert rows[0].startswith("image,sha256,reference,angle [rad],angle_sigma [rad],fault,warnings,marker_1_x [px]")
    assert rows[-1].startswith("blind.png,")
    assert angle_files([]) == {}


# ---- Rig and figures -------------------------------------------------------------------------------------------------


def test_the_rig_is_told_in_units_of_the_workshop() -> None:
    rows = {row.name: row for row in rig_rows(RIG)}
    assert (rows["Radius of the disk"].value, rows["Radius of the disk"].unit) == ("100.000 ± 0.050", "mm")
    assert rows["16 masses of"].value == "25.000 ± 0.025"
    assert rows["Camera"].value == "not calibrated"
    calibrated = replace(
        RIG,
        cord="fixed point",
        cord_tangent=Value(0.1),
        camera=Camera(tilt=0.1, distance=3000.0, centre=(320.0, 240.0), radial=(1e-8, 0.0), sources={"tilt": "level"}),
    )
    rows = {row.name: row for row in rig_rows(calibrated)}
    assert rows["Tilt of the camera"].source == "level"
    assert rows["Distance of the target"].value == "3000"
    assert rows["Angle at which the cord is tangent"].value == "5.72958"


def test_a_loop_is_drawn_with_its_regimes_in_the_order_run() -> None:
    angle, torque = [0.0, -0.04, -0.08, -1.0, -0.96, -0.92, 0.0], [1.0, 0.5, 0.0, -1.0, -0.5, 0.0, 1.0]
    analysis = analyse(Loop(angle, torque, side="input", name="made"))
    root = Page(str(loop_figure(analysis, "A loop", "one", 100.0))).root
    lines = [path for path in root.find("path") if "--measured" in path.attributes.get("style", "")]
    drawn = next(points(path) for path in lines if path.attributes["d"].count(" ") > 3)
    assert np.all(np.diff(drawn[:3, 0]) < 0.0)  # leftwards, as the angle falls
    texts = {node.text for node in root.find("text")}
    assert {"positive unloading", "a: hysteresis", "a", "angle of the input [°]", "torque on the input [N·m]"} <= texts
    assert any("at the output [arcmin]" in each for each in texts)


def test_soft_spots_are_shaded_and_wide_ranges_are_logarithmic() -> None:
    up = np.linspace(-0.4, 0.4, 81)
    soft = np.cumsum(np.where((up > 0.12) & (up < 0.28), 1.0 / 0.3, 1.0 / 4.5)) * (up[1] - up[0])
    angle, torque = np.concatenate([soft[-1] + (up[::-1] - up[-1]) / 1.2, soft]), np.concatenate([up[::-1], up])
    analysis = analyse(Loop(angle, torque, side="input", name="made", angle_sigma=1e-6))
    texts = [node.text for node in Page(str(stiffness_figure(analysis, "made", "soft"))).root.find("text")]
    assert "soft spot" in texts
    assert {"0.5", "1", "2", "5"} <= set(texts)


def test_a_loop_that_was_recorded_fast_is_written_without_its_clock_and_one_in_steps_with_it(tmp_path: Path) -> None:
    angle = np.concatenate([np.linspace(a, b, 60) for a, b in ((0.2, -0.2), (-0.2, 0.2))])
    for interval, names in ((0.01, 2), (60.0, 3)):
        loop = Loop(angle, 4.0 * angle, side="input", name="a spring", time=interval * np.arange(len(angle)))
        path = tmp_path / "loop-0deg.csv"
        path.write_bytes(loop_files([loop])[path.name])
        assert recognise(path).kind == "torsion"
        assert len(Recording.read(path).names) == names
