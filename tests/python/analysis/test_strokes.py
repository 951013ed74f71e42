"""Differences of two models over moves of growing stroke, and the stroke that agrees within a tolerance."""

from __future__ import annotations

from math import inf

import numpy as np
import pytest
import strainwave as sw
from strainwave.analysis.strokes import move_of


def test_a_move_under_control_is_half_a_cosine_from_rest_to_rest() -> None:
    move = move_of(0.4)
    time = np.linspace(0.0, 2.0, 201)
    assert move.value(time) == pytest.approx(0.2 * (1.0 - np.cos(0.5 * np.pi * time)), abs=1e-15)
    assert move.rate([0.0, 2.0]) == pytest.approx([0.0, 0.0], abs=1e-15)


def test_models_that_differ_in_friction_differ_by_its_effect_on_current_and_angle() -> None:
    """Friction that is wrong by D moves the output by D R / (K_m k_p i), and takes D / K_m more current, after the start."""
    drive = sw.load("position-drive")
    wrong = 5.2e-3  # N.m
    stronger = drive.replace({"gear.friction_input.coulomb": 0.072 + wrong, "gear.friction_input.breakaway": 0.0748 + wrong})
    apart = sw.analysis.strokes_apart(stronger, drive, [20.0, 100.0])
    assert apart.names == ("stroke", "output_angle", "current", "used")
    assert apart["output_angle"] == pytest.approx(wrong * 2.0 / (0.05 * 20.0) / 100.0, rel=0.15)
    assert apart["current"] == pytest.approx(wrong / 0.05, rel=0.25)
    run = sw.simulate(stronger, move_of(1.0), 1e-3, sample=1e-3)
    assert apart["used"][1] == pytest.approx(np.sqrt(np.mean(run["current"] ** 2)), rel=1e-9)


@pytest.mark.parametrize(("value", "name"), [((-1.0,), "stroke"), ((float("nan"),), "stroke")])
def test_a_stroke_that_is_none_is_refused(value: tuple[float, ...], name: str) -> None:
    drive = sw.load("position-drive")
    with pytest.raises(ValueError, match=f"{name} = "):
        sw.analysis.strokes_apart(drive, drive, value)


@pytest.mark.parametrize(
    ("excess", "place"), [([-1.0, -1.0, 1.0, 3.0], 2.5), ([-1.0, -1.0, 0.0, -1.0], inf), ([1.0, -1.0, 0.0, 2.0], 1.0)]
)
def test_a_limit_lies_where_the_excess_first_becomes_positive(excess: list[float], place: float) -> None:
    columns = {"stroke": [1.0, 2.0, 3.0, 4.0], "output_angle": np.array(excess) + 5.0}
    assert sw.analysis.stroke_within(sw.Recording(columns, dict.fromkeys(columns, "rad")), 5.0) == place
