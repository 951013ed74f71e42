"""The figures of a report: legible, complete, and where the numbers say."""

from __future__ import annotations

import itertools
import re
from xml.etree import ElementTree

import numpy as np
import pytest
from matplotlib.figure import Figure
from strainwave.demo import position_drive, torsion_rig
from strainwave.drawing import marks
from strainwave.drawing.style import DARK, FIGURE_WIDTH, LIGHT
from strainwave.identification.identify import Identified
from strainwave.report import figures
from strainwave.report.identify import identify_report
from strainwave.report.identify_figures import file_figure, overview

from tests.python.report.measured import HOSTILE, swing
from tests.python.report.reading import Node, Page, points, section

LONG = "what a run may be called when somebody wants to tell how it differs from the one before it"
Box = tuple[float, float, float, float]


def boxes(svg: Node) -> dict[str, Box]:
    """Left, top, right and bottom of every text of a drawing, in letters as wide as DejaVu Sans."""
    from matplotlib.textpath import TextPath

    found = {}
    for text in svg.find("text"):
        style = dict(re.findall(r"([\w-]+): ([^;]+)", text.attributes["style"]))
        size = float(style["font-size"].removesuffix("px"))
        width = TextPath((0.0, 0.0), text.text.replace("$", " "), size=size).get_extents().width
        x, y = (float(number) for number in re.findall(r"-?[\d.]+", text.attributes["transform"])[-2:])
        left = x - {"start": 0.0, "middle": 0.5, "end": 1.0}[style.get("text-anchor", "start")] * width
        found[f"{text.text} at {x:g}, {y:g}"] = (left, y - 0.7 * size, left + width, y)
    return found


def apart(one: Box, other: Box) -> bool:
    return one[2] < other[0] or other[2] < one[0] or one[3] < other[1] or other[3] < one[1]


def drawings(found: Identified) -> list[Node]:
    """Return the drawings of a report, and one of curves with long names."""

    def draw(figure: Figure) -> None:
        axes = figure.subplots()
        for name, run in ((LONG, swing(50)), (HOSTILE, swing(60))):
            marks.curve(axes, run.time, run["output_angle"], label=name)
        marks.label_axes(axes, "output angle", "rad", "time", "s")
        marks.legend(figure, axes)

    long_names = figures.inline(draw, (FIGURE_WIDTH, 3.9), "long", "curves with long names")
    return [svg for page in (identify_report(found), long_names) for svg in Page(page).root.find("svg")]


@pytest.mark.slow("report")
def test_every_text_of_a_figure_is_inside_it_and_on_no_other(each: Identified) -> None:
    for svg in drawings(each):
        _, _, width, height = (float(number) for number in svg.attributes["viewbox"].split())
        texts = boxes(svg)
        assert len(texts) > 10
        for name, (left, top, right, bottom) in texts.items():
            assert 0.0 <= left < right <= width, name
            assert 0.0 <= top < bottom <= height, name
        for (name, one), (other_name, other) in itertools.combinations(texts.items(), 2):
            assert apart(one, other), f"{name}; {other_name}"


@pytest.mark.whole_path("report")
def test_every_curve_has_its_name_in_the_legend(html: str) -> None:
    for svg in section(html, "measured").find("svg"):
        assert {"measured", "model"} <= {text.text for text in svg.find("text")}


def test_points_are_drawn_where_they_were_measured() -> None:
    (result,) = position_drive().files
    (picture,) = result.pictures
    drawn = Page(file_figure(result, picture, "table")).root
    groups = [group for group in drawn.find("g") if "--measured" in group.attributes.get("style", "")]
    places = np.array([(float(use.attributes["x"]), float(use.attributes["y"])) for use in groups[0].find("use")])
    for column, name in enumerate(("speed", "torque")):
        values = picture.curves[name][np.argsort(picture.curves["speed"], kind="stable")]
        line = np.polynomial.Polynomial.fit(values, places[:, column], 1)
        assert np.abs(line(values) - places[:, column]).max() < 0.01, "SVG is written to hundredths"


def test_residuals_are_drawn_over_their_samples(from_torsion: Identified) -> None:
    (result,) = from_torsion.files
    drawn = Page(file_figure(result, result.pictures[0], "loop")).root
    curves = [points(path) for path in drawn.find("path") if "--ink" in path.attributes.get("style", "")]
    across, upright = max(curves, key=len).T
    assert result.fit is not None
    residual = result.fit.residuals[0]
    sample = np.rint((across - across[0]) / np.ptp(across) * (len(residual) - 1)).astype(int)
    assert len(np.unique(sample)) > 0.9 * len(residual), "points on a straight line may be left out"
    assert np.corrcoef(upright, residual[sample])[0, 1] == pytest.approx(-1.0, abs=1e-4)


@pytest.mark.slow("report")
@pytest.mark.parametrize("scheme", [LIGHT, DARK])
def test_every_colour_can_be_told_from_the_paper(scheme: dict[str, str], from_friction: Identified) -> None:
    """Contrast by WCAG 2.2: 4.5 for text, 3 for graphics; the rules of the grid are meant to be faint."""
    paper = re.findall(r"--paper: (#\w{6})", identify_report(from_friction))[scheme is DARK]
    for name, colour in scheme.items():
        assert contrast(colour, paper) > {"ink": 7.0, "rule": 1.2}.get(name, 4.5)


def contrast(one: str, other: str) -> float:
    light, dark = sorted((luminance(one), luminance(other)), reverse=True)
    return (light + 0.05) / (dark + 0.05)


def luminance(colour: str) -> float:
    channels = np.array([int(colour[i : i + 2], 16) for i in (1, 3, 5)]) / 255.0
    linear = np.where(channels <= 0.04045, channels / 12.92, ((channels + 0.055) / 1.055) ** 2.4)
    return float(linear @ (0.2126, 0.7152, 0.0722))


@pytest.mark.slow("report")
def test_no_colour_is_fixed_so_that_figures_follow_the_scheme(html: str) -> None:
    figures_of_page = Page(html).root.find("svg")
    assert figures_of_page
    for node in (node for svg in figures_of_page for node in svg.walk()):
        for value in node.attributes.values():
            assert not re.search(r"#[0-9a-f]{6}\b", re.sub(r"var\(--[\w-]+, #\w{6}\)", "", value))


def test_the_overview_stands_by_itself() -> None:
    (loop,), (table,) = torsion_rig().files[0].pictures, position_drive().files[0].pictures
    picture = overview(loop, table)
    assert len(picture) < 60_000
    root = ElementTree.fromstring(picture)
    assert root.tag == "{http://www.w3.org/2000/svg}svg"
    style = root[0].text or ""
    for colours in (LIGHT, DARK):
        assert all(f"--{name}: {colour};" in style for name, colour in colours.items())
