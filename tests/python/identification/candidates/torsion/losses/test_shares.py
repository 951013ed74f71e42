"""Shares of sources of loss against those of their making and drawn truths."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
import strainwave as sw
from numpy.typing import NDArray
from strainwave.identification import loss_shares
from strainwave.identification.experiments.loss_loop import LossLoop

from tests.evidence.drawn.loss_sources import SOURCES, outcome, split
from tests.support.loss_loops import GEAR, STIFFNESS, loss_loop

Array = NDArray[np.float64]

WHOLE, TWO_TEMPERATURES, INPUT_ALONE = 0, 4, 6  # seeds of designs


def test_shares_of_loops_at_both_sides_are_those_of_their_making() -> None:
    result = loss_shares([loss_loop(reach, at_input=side) for reach in (20.0, 40.0) for side in (True, False)], GEAR)
    way, work = (
        4.0 * 40.0 / STIFFNESS,
        {"bearing, dry": 0.6, "gear, dry": 0.4, "mesh, in proportion to the load": 0.5 * 0.03 * 40.0},
    )
    assert result.loss == pytest.approx(way * sum(work.values()), rel=0.02)
    for name, torque in work.items():
        assert result[name].is_separated
        assert result[name].share == pytest.approx(torque / sum(work.values()), abs=0.01)
    assert result["bearing, dry"].value == pytest.approx(6e-3, rel=0.02)
    assert abs(result["flexspline, material"].share) < 0.01
    with pytest.raises(KeyError, match="'rust' is no source"):
        result["rust"]


def test_one_side_alone_determines_the_sum_of_bearing_and_gear_and_names_the_loop_that_is_missing() -> None:
    result = loss_shares([loss_loop(reach, at_input=True) for reach in (20.0, 40.0)], GEAR)
    for name, other in (("bearing, dry", "gear, dry"), ("gear, dry", "bearing, dry")):
        assert not result[name].is_separated
        assert result[name].why.startswith(f"{name} + {other} = 0.00")
        assert "at the output with the input locked would determine it to ± 2 %" in result[name].why
    assert result["mesh, in proportion to the load"].is_separated
    assert any("no loop was measured at the output" in each for each in result.remarks)


def test_loops_at_the_output_show_no_bearing() -> None:
    result = loss_shares([loss_loop(reach, at_input=False) for reach in (20.0, 40.0)], GEAR)
    assert [each.name for each in result.shares] == ["gear, dry", "mesh, in proportion to the load", "flexspline, material"]


@pytest.mark.slow("identification")
@pytest.mark.parametrize("seed", [WHOLE, TWO_TEMPERATURES, INPUT_ALONE])
def test_drawn_sources_are_right_or_not_separable(seed: int) -> None:
    result, truth = split(seed)
    assert outcome(seed).verdict == "right"
    assert {each.name for each in result.shares} == set(SOURCES)
    assert all(abs(each.share - truth[each.name]) < 2.0 * each.sigma for each in result.shares if each.is_separated)
    assert sum(each.is_separated for each in result.shares) == (2 if seed == INPUT_ALONE else 6)


def test_loops_of_several_amplitudes_and_of_mixed_conditions_are_refused() -> None:
    way = np.concatenate((np.sin(np.linspace(0.5, 2.5, 201) * np.pi), 0.5 * np.sin(np.linspace(0.5, 2.5, 201) * np.pi)))
    several = sw.Recording(
        {"twist": 1e-3 * way, "torque": 20.0 * way + 0.5 * np.sign(np.gradient(way))}, {"twist": "rad", "torque": "N.m"}
    )
    with pytest.raises(ValueError, match="it reverses at several amplitudes"):
        LossLoop.of(several, GEAR)
    plain = loss_loop(20.0, at_input=False)
    timed = plain.with_column("time", np.arange(float(len(plain))), "s")
    with pytest.raises(ValueError, match="loop 2 of 2 has no time, others have one"):
        loss_shares([timed, plain], GEAR)
    branch = sw.Recording(
        {"twist": np.linspace(0.0, 1e-3, 50), "torque": np.linspace(0.0, 20.0, 50)}, {"twist": "rad", "torque": "N.m"}
    )
    with pytest.raises(ValueError, match="needs ways up and down"):
        loss_shares([branch], GEAR)


def made(width: Callable[[Array], Array], noise: float = 0.0) -> sw.Recording:
    """A loop of ±20 N.m with half of its width [N.m] over the twist as a share of the largest."""
    way = np.sin(np.linspace(0.5, 4.5, 801) * np.pi)
    torque = 20.0 * way + width(way) * np.sign(np.gradient(way)) + np.random.default_rng(0).normal(0.0, noise, len(way))
    return sw.Recording({"twist": 5e-4 * way, "torque": torque}, {"twist": "rad", "torque": "N.m"})


def test_a_loop_whose_area_no_source_makes_is_refused() -> None:
    """Wider as the sixth power of the twist: the forms of friction, load and material make 40 % more area."""
    with pytest.raises(ValueError, match=r"loses 2\.\d+ mJ, and the forms of .* make 3\.\d+ mJ of it: play"):
        loss_shares([made(lambda way: 8.0 * way**6)], GEAR)


def test_a_loop_that_hardly_loses_is_refused() -> None:
    with pytest.raises(ValueError, match="noise or other forms hide it; load it further"):
        loss_shares([made(lambda way: np.full(len(way), 0.001), 0.2)], GEAR)
