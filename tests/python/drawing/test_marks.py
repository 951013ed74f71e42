"""Marks of drawings: curves keep their extremes, axes their units, and figures the style of the package."""

from __future__ import annotations

from io import BytesIO

import matplotlib as mpl
import numpy as np
import pytest
from strainwave.drawing import marks
from strainwave.drawing.style import FIGURE_WIDTH, LIGHT, RUNS


def test_a_figure_has_the_style_of_the_package_whatever_the_caller_prefers() -> None:
    with mpl.rc_context({"axes.grid": False, "font.size": 30.0, "text.parse_math": True}):
        with marks.new_figure(2.0, "cost in $") as figure:
            axes = figure.subplots()
            axes.plot([0.0, 1.0], [0.0, 2e-3])
            marks.label_axes(axes, "twist", "rad", "time", "s")
        figure.savefig(BytesIO(), format="svg")
        assert mpl.rcParams["font.size"] == 30.0
    assert figure.get_size_inches().tolist() == [FIGURE_WIDTH, 2.0]
    assert (figure.get_suptitle(), axes.get_title(loc="left"), axes.get_xlabel()) == ("cost in $", "twist [mrad]", "time [s]")
    assert axes.xaxis.label.get_size() == 9.0
    assert "2" in {text.get_text() for text in axes.get_yticklabels()}  # mrad


def test_a_title_is_broken_to_the_width_of_the_figure() -> None:
    with marks.new_figure(2.0, "word " * 30) as figure:
        figure.subplots()
    figure.savefig(BytesIO(), format="png")
    title = figure.texts[0] if figure.texts else figure._suptitle  # type: ignore[attr-defined]
    assert title is not None
    assert title.get_window_extent().width < figure.bbox.width


def test_ticks_of_huge_numbers_stay_short() -> None:
    with marks.new_figure(2.0) as figure:
        axes = figure.subplots()
        axes.plot([0.0, 1.0], [-1e300, 1e300])
        marks.label_axes(axes, "speed", "rpm")
    figure.savefig(BytesIO(), format="png")
    assert max(len(label.get_text()) for label in axes.get_yticklabels()) < 16


def test_curves_beside_each_other_differ_in_colour_and_in_line() -> None:
    styles = [marks.line_style(place) for place in range(len(RUNS))]
    for key in ("color", "linestyle"):
        assert len({style[key] for style in styles}) == len(RUNS)
    assert styles[0] == marks.line_style(len(RUNS))
    assert all(style["color"] in LIGHT.values() for style in styles)


@pytest.mark.parametrize("below", [False, True])
def test_a_legend_lies_outside_all_axes_and_the_title(below: bool) -> None:
    with marks.new_figure(3.0, "" if not below else "Title") as figure:
        axes = figure.subplots()
        for place in range(5):
            axes.plot([0.0, 1.0], [0.0, place], label=f"curve number {place}")
        marks.legend(figure, axes)
    figure.savefig(BytesIO(), format="png")
    box = figure.legends[0].get_window_extent()
    assert not box.overlaps(axes.get_window_extent())
    assert bool(box.y1 < axes.get_window_extent().y0) is below


def test_the_envelope_of_a_curve_keeps_its_extremes() -> None:
    time = np.arange(100_000.0)
    drawn, values = marks.envelope(time, np.where(time == 777.0, 1.0, 0.0), stretches=10)
    assert (values.max(), drawn[values.argmax()], len(drawn)) == (1.0, 777.0, 21)
