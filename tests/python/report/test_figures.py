"""The figures of a report: legible, complete, and where the numbers say."""

from __future__ import annotations

import itertools
import re
from dataclasses import replace
from xml.etree import ElementTree

import numpy as np
import pytest
import strainwave as sw
from strainwave.demo import position_drive, torsion_rig
from strainwave.identification.experiments.torsion_loop import TorsionLoop
from strainwave.report import figures
from strainwave.report.experiment import SimulatedExperiment
from strainwave.report.twin import twin_report

from tests.python.report.reading import Node, Page, points, section
from tests.python.report.twins import HOSTILE, swing

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


def drawings(found: sw.Twin) -> list[Node]:
    long_names = SimulatedExperiment("long names", ((LONG, swing(50)), (HOSTILE, swing(60))), response="output_angle")
    return Page(twin_report(found, [long_names])).root.find("svg")


def test_every_text_of_a_figure_is_inside_it_and_on_no_other(each: sw.Twin) -> None:
    for svg in drawings(each):
        _, _, width, height = (float(number) for number in svg.attributes["viewbox"].split())
        texts = boxes(svg)
        assert len(texts) > 10
        for name, (left, top, right, bottom) in texts.items():
            assert 0.0 <= left < right <= width, name
            assert 0.0 <= top < bottom <= height, name
        for (name, one), (other_name, other) in itertools.combinations(texts.items(), 2):
            assert apart(one, other), f"{name}; {other_name}"


def test_every_curve_has_its_name_in_the_legend(each: sw.Twin) -> None:
    wanted = {"friction": {"measured", "model"}, "torsion": {"measured", "held out"}, "log": {"measured", "model"}}
    for evidence in each.evidence:
        for svg in section(twin_report(each), evidence.kind).find("svg"):
            assert wanted[evidence.kind] <= {text.text for text in svg.find("text")}


def test_nothing_is_drawn_across_what_was_left_out(from_input: sw.Twin) -> None:
    evidence = from_input.evidence[0]
    loop = evidence.fit.experiment
    assert isinstance(loop, TorsionLoop)
    starts = figures.gaps(loop)
    assert starts
    assert all(abs(loop.twist[i] - loop.twist[i - 1]) > 0.015 * np.ptp(loop.twist) for i in starts)
    drawn = Page(figures.torsion_loop(evidence)).root
    curves = [path for path in drawn.find("path") if re.search(r"stroke: var\(--model", path.attributes.get("style", ""))]
    assert len([curve for curve in curves if len(points(curve)) > 10]) == len(starts) + 1


def test_a_loop_of_which_nothing_was_left_out_has_no_gap(from_input: sw.Twin, from_torsion: sw.Twin) -> None:
    loop, at_output = (found.evidence[0].fit.experiment for found in (from_input, from_torsion))
    assert isinstance(loop, TorsionLoop)
    assert isinstance(at_output, TorsionLoop)
    assert figures.gaps(replace(loop, samples=len(loop.twist))) == []
    assert figures.gaps(replace(at_output, samples=9_000)) == []


def test_points_are_drawn_where_they_were_measured() -> None:
    found = position_drive()
    drawn = Page(figures.friction_table(found.evidence[0])).root
    groups = [group for group in drawn.find("g") if "--measured" in group.attributes.get("style", "")]
    places = np.array([(float(use.attributes["x"]), float(use.attributes["y"])) for use in groups[0].find("use")])
    recording = found.evidence[0].recording
    for column, name in enumerate(("speed", "torque")):
        line = np.polynomial.Polynomial.fit(recording[name], places[:, column], 1)
        assert np.abs(line(recording[name]) - places[:, column]).max() < 0.01, "SVG is written to hundredths"


def test_residuals_are_drawn_over_their_samples(from_torsion: sw.Twin) -> None:
    evidence = from_torsion.evidence[0]
    drawn = Page(figures.torsion_loop(evidence)).root
    curves = [points(path) for path in drawn.find("path") if "--ink" in path.attributes.get("style", "")]
    across, upright = max(curves, key=len).T
    residual = evidence.fit.residuals[0]
    sample = np.rint((across - across[0]) / np.ptp(across) * (len(residual) - 1)).astype(int)
    assert len(np.unique(sample)) > 0.9 * len(residual), "points on a straight line may be left out"
    assert np.corrcoef(upright, residual[sample])[0, 1] == pytest.approx(-1.0, abs=1e-4)


@pytest.mark.parametrize("scheme", [figures.LIGHT, figures.DARK])
def test_every_colour_can_be_told_from_the_paper(scheme: dict[str, str], from_friction: sw.Twin) -> None:
    """Contrast by WCAG 2.2: 4.5 for text, 3 for graphics; the rules of the grid are meant to be faint."""
    paper = re.findall(r"--paper: (#\w{6})", twin_report(from_friction))[scheme is figures.DARK]
    for name, colour in scheme.items():
        assert contrast(colour, paper) > {"ink": 7.0, "rule": 1.2}.get(name, 4.5)


def contrast(one: str, other: str) -> float:
    light, dark = sorted((luminance(one), luminance(other)), reverse=True)
    return (light + 0.05) / (dark + 0.05)


def luminance(colour: str) -> float:
    channels = np.array([int(colour[i : i + 2], 16) for i in (1, 3, 5)]) / 255.0
    linear = np.where(channels <= 0.04045, channels / 12.92, ((channels + 0.055) / 1.055) ** 2.4)
    return float(linear @ (0.2126, 0.7152, 0.0722))


def test_no_colour_is_fixed_so_that_figures_follow_the_scheme(html: str) -> None:
    figures_of_page = Page(html).root.find("svg")
    assert figures_of_page
    for node in (node for svg in figures_of_page for node in svg.walk()):
        for value in node.attributes.values():
            assert not re.search(r"#[0-9a-f]{6}\b", re.sub(r"var\(--[\w-]+, #\w{6}\)", "", value))


def test_the_overview_stands_by_itself() -> None:
    picture = figures.overview(torsion_rig().evidence[0], position_drive().evidence[0])
    assert len(picture) < 60_000
    root = ElementTree.fromstring(picture)
    assert root.tag == "{http://www.w3.org/2000/svg}svg"
    style = root[0].text or ""
    for colours in (figures.LIGHT, figures.DARK):
        assert all(f"--{name}: {colour};" in style for name, colour in colours.items())
