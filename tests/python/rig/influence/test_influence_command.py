"""`strainwave rig influence`: what it writes, and what it refuses."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import strainwave as sw
from strainwave.report.influence import influence_report, summary
from strainwave.report.provenance import Provenance
from strainwave.rig.influence.cycle import cycle_to
from strainwave.rig.influence.series import Series, analyse_series
from strainwave.rig.influence.trend_words import trend_words

from tests.python.command import refused, strainwave
from tests.python.report.measured import HOSTILE
from tests.python.report.reading import Page, section


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
