"""The readings of the article's Table 2 have its line and name what they contradict; experiments run with each."""

from __future__ import annotations

import numpy as np
import pytest
import strainwave as sw
from friction_table import FRICTION, PRINTED, SPEED, experiments, figures_of, readings, summary
from position_control import TABLE_4
from strainwave.demo import PUBLISHED


@pytest.mark.whole_path("papers")
def test_the_readings_of_table_2_have_its_line_and_say_what_they_exclude() -> None:
    """Numbers of the page of errata: dry friction 0.0126 or 0.0720 + 0.0126 N.m, slope 0.0308 or 3.08e-4 N.m.s/rad."""
    total, part, at_output = readings()
    assert (total.part, part.part, at_output.part) == (False, True, True)
    for reading in (total, part):
        assert (reading.coulomb, reading.viscous) == pytest.approx((0.012554434963, 0.030840444789), rel=1e-9)
    assert (
        total.contradicts[0] == "its 0.012 N·m in all at 0.1 rad/s are less than the 0.0492 N·m that the law has at every angle"
    )
    assert "77.1 times the law's 0.0004" in total.contradicts[1]
    assert len(part.contradicts) == 1, "nothing contradicts the Coulomb level"
    assert "77.1 times" in part.contradicts[0]
    assert "adds to the law's 0.072 N·m" in part.remark
    assert at_output.viscous == pytest.approx(0.000308404448, rel=1e-9)
    assert at_output.coulomb == part.coulomb
    assert "0.771 times" in at_output.contradicts[0]


def test_a_table_that_agrees_with_the_law_contradicts_nothing() -> None:
    speed = np.array([1.0, 10.0, 50.0, 100.0])
    noise = 1e-5 * np.random.default_rng(1).normal(size=4)
    total, *_ = readings(speed, 0.072 + 4e-4 * speed + noise)
    assert total.contradicts == ()


def test_the_table_is_that_of_the_demonstration() -> None:
    published = sw.Recording.read(PUBLISHED / "position-control-friction.csv")
    assert published["speed"].tolist() == list(SPEED)
    assert published["torque"].tolist() == list(FRICTION)


def test_the_experiments_run_with_each_reading() -> None:
    found = experiments()
    assert list(found) == list(TABLE_4)
    lines = list(summary(found))
    for name, runs in found.items():
        assert list(runs) == [*(each.name for each in readings()), PRINTED]
        assert len({figures_of(run)[0] for run in runs.values()}) == 4, "no two of the runs are the same"
        run = runs[PRINTED]
        error = run["output_angle"] - run["command"]
        assert figures_of(run)[:2] == pytest.approx((np.sqrt(np.mean(error**2)), np.abs(error).max()))
        (head,) = (line for line in lines if line.startswith(f"\n| {name} |"))
        assert head.splitlines()[1].endswith("article, Table 4 |")
    assert "| root mean square error [rad] | 0.01041 | 0.01091 | 0.009068 | 0.009019 | 0.0021 |" in lines
