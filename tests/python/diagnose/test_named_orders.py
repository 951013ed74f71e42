"""Orders and causes of a gear with either fixed member are those that its faults have."""

from __future__ import annotations

from math import tau

import numpy as np
import pytest
import strainwave as sw
from strainwave.diagnose.diagnosis import Question, RunDiagnosis, diagnosed
from strainwave.diagnose.named_orders import causes, named_orders
from strainwave.diagnose.refusals import JointRecording, usable

SETS = {"circular_spline": sw.GearSet.read("csg-25-100"), "flexspline": sw.GearSet.read("tilt-actuator-lumped")}
FIXED = pytest.mark.parametrize("fixed", SETS)


def record(seed: int, turns: float = 30.0, lines: dict[float, float] | None = None) -> JointRecording:
    """A motor in one direction, whose current has order 2 and further lines."""
    time = np.arange(0.0, 30.0, 0.01)
    angle = tau * turns * time / time[-1]
    current = 1.0 + 0.1 * np.cos(2.0 * angle) + np.random.default_rng(seed).normal(0.0, 0.03, len(time))
    current += sum((size * np.cos(order * angle + order) for order, size in (lines or {}).items()), np.zeros_like(time))
    columns = {"time": time, "input_angle": angle, "current": current}
    made = sw.Recording(columns, {"time": "s", "input_angle": "rad", "current": "A"})
    return usable(made, f"run {seed}", ratio=100.0)


def crack_orders(fixed: str) -> list[float]:
    kinematics = SETS[fixed].gear.kinematics
    facts = sw.fault.Facts(
        flexspline_teeth=kinematics.flexspline_teeth,
        circular_spline_teeth=kinematics.circular_spline_teeth,
        fixed=fixed,
        ratio=kinematics.ratio,
    )
    return [change[-1] for change in sw.fault.FlexsplineCrack(waves=4).changes(facts)][1:]


@FIXED
def test_the_orders_of_a_crack_are_named(fixed: str) -> None:
    named = [each.per_input for each in named_orders(record(0), SETS[fixed].gear.kinematics, (), ())]
    wanted = crack_orders(fixed)
    assert [min(abs(order - each) for each in named) < 1e-9 for order in wanted] == [True, fixed == "flexspline", True, True]


def test_a_fixed_flexspline_names_the_orders_of_the_circular_spline_that_turns() -> None:
    kinematics = SETS["flexspline"].gear.kinematics
    named = {each.per_input: each for each in named_orders(record(0), kinematics, (), ())}
    passes = 2.0 * kinematics.flexspline_teeth / kinematics.circular_spline_teeth
    for times in (1.0, 3.0, 4.0):
        (name,) = [each.name for order, each in named.items() if abs(order - times * passes) < 1e-9]
        assert name.startswith("wave generator against the other spline")
    assert not any(order - round(order) > 1e-9 for order in named)  # as 2.02, 6.06 and 8.08 are


@FIXED
def test_a_crack_is_named_with_the_orders_of_the_flexspline_alone(fixed: str) -> None:
    kinematics = SETS[fixed].gear.kinematics
    fine = 1e-3
    crack, *others = causes([(order, fine) for order in crack_orders(fixed)], 1.0, kinematics, ())
    assert not others
    assert "a crack of the flexspline or its damaged teeth" in crack
    turned = 2.0 * kinematics.flexspline_teeth / kinematics.circular_spline_teeth if fixed == "flexspline" else 2.0
    (other,) = causes([(turned, fine)], 1.0, kinematics, ())
    assert "damaged teeth of the circular spline" in other
    assert "crack" not in other


def test_without_teeth_no_order_is_excluded_from_the_splines() -> None:
    (whole,) = causes([(4.0, 1e-3)], 1.0, None, ())
    assert "the spline that does not turn" in whole
    (turning,) = causes([(6.06, 1e-3)], 1.0, None, ())
    assert "the spline that turns, a bearing" in turning


def changed(lines: dict[float, float], healthy: dict[float, float] | None = None) -> RunDiagnosis:
    days = [record(seed, lines=healthy) for seed in range(3)]
    (found,) = diagnosed([record(9, lines=lines)], Question(SETS["circular_spline"], 100.0), baseline=days).runs
    assert found.verdict == "changed"
    return found


def test_a_whole_order_that_blocks_do_not_separate_from_one_of_a_crack_is_no_crack() -> None:
    """Blocks of ten turns contain order 6 as 6.06, and the record of 30 turns separates both."""
    found = changed({6.0: 0.05})
    assert found.comparison is not None
    assert {round(each.order, 2) for each in found.comparison.alarms} == {6.0}
    assert len(found.causes) == 1
    assert "whole multiples" in found.causes[0]
    assert "crack" not in found.reason + found.causes[0]


def test_an_order_of_a_crack_is_one_where_the_recording_separates_it() -> None:
    found = changed({6.06: 0.05})
    assert found.comparison is not None
    assert {round(each.order, 2) for each in found.comparison.alarms} == {6.06}
    assert "a crack of the flexspline" in found.causes[0]


def test_a_change_beside_a_line_of_the_healthy_joint_is_of_either_spline() -> None:
    found = changed({6.0: 0.03, 6.06: 0.2}, healthy={6.0: 0.03})
    assert "of either spline, which this record does not separate" in found.causes[0]
