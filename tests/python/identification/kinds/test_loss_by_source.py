"""Several torsion loops of one gear: shares of sources against drawn truths, and what the files together say."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import strainwave as sw
from strainwave.identification import loss_shares
from strainwave.identification.experiments.loss_loop import LossLoop
from strainwave.identification.kinds.torsion_loop import lossy_loop
from strainwave.identification.reading.recognise import recognise

from tests.evidence.drawn import relaxing_material
from tests.evidence.drawn.loss_sources import SOURCES, outcome, split

UNITS = {"twist": "rad", "torque": "N.m", "input_angle": "rad", "input_torque": "N.m", "time": "s"}
RATIO, STIFFNESS = -100.0, 2e4
GEAR = sw.load("hfuc-25-100")


def loop(reach: float, *, at_input: bool, dry: float = 0.4, mesh: float = 0.03, bearing: float = 6e-3) -> sw.Recording:
    """Return two cycles whose width is that of dry friction and of a share of the load."""
    way = np.sin(np.linspace(0.5, 4.5, 801) * np.pi)
    half = dry + mesh * np.abs(reach * way) + at_input * bearing * abs(RATIO)
    twist, torque = reach / STIFFNESS * way, reach * way + half * np.sign(np.gradient(way))
    series = {"input_angle": RATIO * twist, "input_torque": torque / RATIO} if at_input else {"twist": twist, "torque": torque}
    return sw.Recording(series, {name: UNITS[name] for name in series})


def test_shares_of_loops_at_both_sides_are_those_of_their_making() -> None:
    result = loss_shares([loop(reach, at_input=side) for reach in (20.0, 40.0) for side in (True, False)], GEAR)
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
    result = loss_shares([loop(reach, at_input=True) for reach in (20.0, 40.0)], GEAR)
    for name, other in (("bearing, dry", "gear, dry"), ("gear, dry", "bearing, dry")):
        assert not result[name].is_separated
        assert result[name].why.startswith(f"{name} + {other} = 0.00")
        assert "at the output with the input locked would determine it to ± 2 %" in result[name].why
    assert result["mesh, in proportion to the load"].is_separated
    assert any("no loop was measured at the output" in each for each in result.remarks)


def test_loops_at_the_output_show_no_bearing() -> None:
    result = loss_shares([loop(reach, at_input=False) for reach in (20.0, 40.0)], GEAR)
    assert [each.name for each in result.shares] == ["gear, dry", "mesh, in proportion to the load", "flexspline, material"]


def test_a_torque_of_the_motor_counted_at_the_output_is_a_loop_at_the_input(tmp_path: Path) -> None:
    measured = loop(40.0, at_input=True)
    rows = np.column_stack([measured["input_angle"] / RATIO, measured["input_torque"] * RATIO])
    np.savetxt(
        tmp_path / "loop.csv", rows, delimiter=",", header="deflection [rad],motor_torque_output_side [N.m]", comments=""
    )
    found = lossy_loop(recognise(tmp_path / "loop.csv"), GEAR)
    assert found.names == measured.names
    for name in measured.names:
        assert found[name] == pytest.approx(measured[name], rel=1e-12)
    (tmp_path / "loop.csv").write_text((tmp_path / "loop.csv").read_text().replace("motor_torque_output_side", "torque"))
    assert lossy_loop(recognise(tmp_path / "loop.csv"), GEAR).names == ("twist", "torque")


RELAXING = "flexspline, relaxing material"
BRANCH = sw.material.GeneralisedMaxwell(stiffness=[2e3], relaxation_time=[5.0])
DRY, VISCOUS, TWIST = 0.4, 300.0, 2e-3  # N.m, N.m.s/rad, rad


def relaxing(frequency: float, law: sw.material.GeneralisedMaxwell = BRANCH) -> sw.Recording:
    """Return two cycles under a sine: a spring with a material that relaxes, dry and viscous friction, and noise."""
    time = np.linspace(0.0, 4.0 * np.pi / frequency, 1601)
    twist, rate = TWIST * np.sin(frequency * time), TWIST * frequency * np.cos(frequency * time)
    torque = (STIFFNESS + law.storage(frequency)) * twist + (law.loss(frequency) / frequency + VISCOUS) * rate
    torque += DRY * np.sign(rate) + 0.02 * np.random.default_rng(round(100.0 * frequency)).normal(size=len(time))
    return sw.Recording({"time": time, "twist": twist, "torque": torque}, {"time": "s", "twist": "rad", "torque": "N.m"})


def test_loops_at_four_rates_separate_a_material_that_relaxes() -> None:
    stiff = 0.5  # rad/s: the slowest loop whose torque is within 5 % of the largest
    result = loss_shares([relaxing(frequency) for frequency in (0.02, 0.1, stiff, 2.5)], GEAR)
    work = {
        "gear, dry": 4.0 * DRY * TWIST,
        "gear, viscous": np.pi * TWIST**2 * VISCOUS * stiff,
        RELAXING: np.pi * TWIST**2 * BRANCH.loss(stiff),
    }
    assert result.loss == pytest.approx(sum(work.values()), rel=0.02)
    for name, energy in work.items():
        assert result[name].is_separated
        assert abs(result[name].share - energy / sum(work.values())) < 2.0 * result[name].sigma
    assert result[RELAXING].share > 0.1
    assert f"{RELAXING}: one Maxwell branch that relaxes in 5.01 ± 0.18 s" in result.remarks


def test_a_material_that_relaxes_is_not_separable_at_three_rates() -> None:
    result = loss_shares([relaxing(frequency) for frequency in (0.02, 0.1, 0.5, 0.51)], GEAR)
    assert RELAXING not in [each.name for each in result.shares]
    words = "not separable: loops at 4 rates would separate it from viscous friction and a loss factor"
    assert f"{RELAXING}: {words}" in result.remarks


def test_loops_at_four_rates_without_a_material_that_relaxes_are_explained_without_it() -> None:
    elastic = sw.material.GeneralisedMaxwell()
    result = loss_shares([relaxing(frequency, elastic) for frequency in (0.02, 0.1, 0.5, 2.5)], GEAR)
    assert RELAXING not in [each.name for each in result.shares]
    assert f"{RELAXING}: viscous friction and a loss factor explain the loops at all rates without it" in result.remarks


WHOLE, TWO_TEMPERATURES, INPUT_ALONE = 0, 4, 6  # seeds of designs
SLOW = pytest.mark.slow("identification")


@SLOW
@pytest.mark.parametrize("seed", [0, 1, 5])  # the last one does not relax
def test_drawn_materials_that_relax_are_right_or_not_separable(seed: int) -> None:
    assert relaxing_material.outcome(seed).verdict == "right"


@SLOW
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
    plain = loop(20.0, at_input=False)
    timed = plain.with_column("time", np.arange(float(len(plain))), "s")
    with pytest.raises(ValueError, match="loop 2 of 2 has no time, others have one"):
        loss_shares([timed, plain], GEAR)
    branch = sw.Recording(
        {"twist": np.linspace(0.0, 1e-3, 50), "torque": np.linspace(0.0, 20.0, 50)}, {"twist": "rad", "torque": "N.m"}
    )
    with pytest.raises(ValueError, match="needs ways up and down"):
        loss_shares([branch], GEAR)


@SLOW
def test_identify_splits_the_loss_of_several_loops(tmp_path: Path) -> None:
    for name, reach, side in (("a", 40.0, True), ("b", 40.0, False), ("c", 20.0, False)):
        loop(reach, at_input=side).to_csv(tmp_path / f"{name}.csv")
    found = sw.identify("hfuc-25-100", tmp_path, accept=True)
    together = next(each for each in found.files if each.name == "all torsion loops")
    assert together.title == "the loss of a cycle by its source"
    assert together.model.startswith(
        "bearing, dry 38 ± 2 %; gear, dry 25 ± 2 %; mesh, in proportion to the load 37 ± 2 %; flexspline"
    )
    assert together.remarks[0].startswith("12.8 mJ are lost in a cycle of the loop of ±")
