"""Whole tests: their loops, named, compared and budgeted."""

from __future__ import annotations

import numpy as np
import pytest
from strainwave.rig import Loop, Step, load
from strainwave.rig.reading.evaluation import budgets, evaluate

CYCLE = np.array([4.0, 3.0, 2.0, 1.0, 0.0, -1.0, -2.0, -3.0, -4.0, -3.0, -2.0, -1.0, 0.0, 1.0, 2.0, 3.0, 4.0]) / 10.0
WIDE = np.concatenate((np.full(8, 0.05), np.full(8, -0.05), [0.05]))  # what the angle lags behind


def loop(position: float = 0.0, unit: str = "", stiffness: float = 4.0, wide: float = 1.0) -> Loop:
    angle = CYCLE / stiffness + wide * WIDE
    return Loop(angle, CYCLE, side="input", name="made", angle_sigma=1e-5, torque_sigma=1e-5, position=position, unit=unit)


def test_loops_are_called_by_unit_and_position_and_those_alike_are_numbered() -> None:
    found = evaluate([loop(), loop(np.pi / 3.0), loop(unit="A"), loop()])
    expected = ("Flexspline at 0°, no. 1", "Flexspline at 60°", "Unit A, flexspline at 0°", "Flexspline at 0°, no. 2")
    assert found.labels == expected


def test_positions_and_units_are_compared_where_there_are_several() -> None:
    assert evaluate([loop()]).comparisons == ()
    assert [each.by for each in evaluate([loop(), loop(1.0)]).comparisons] == ["position"]
    assert [each.by for each in evaluate([loop(unit="A"), loop(unit="B")]).comparisons] == ["unit"]


def test_without_a_loop_there_is_nothing_to_evaluate() -> None:
    with pytest.raises(ValueError, match="one loop or more"):
        evaluate([])


def test_a_gear_without_a_loop_may_have_a_negative_area_by_chance() -> None:
    noise = np.random.default_rng(3).normal(0.0, 1e-5, len(CYCLE))
    areas = []
    for sign in (1.0, -1.0):
        made = Loop(CYCLE / 4.0 + sign * noise, CYCLE, side="input", name="steel", angle_sigma=1e-5)
        (analysis,) = evaluate([made]).analyses
        assert analysis.area is not None
        assert abs(analysis.area.value) < 4.0 * analysis.area.sigma
        areas.append(analysis.area.value)
    assert min(areas) < 0.0 < max(areas)
    with pytest.raises(ValueError, match="instead of losing energy"):
        evaluate([Loop(loop().angle[::-1], CYCLE[::-1], side="input", name="backwards", angle_sigma=1e-5)])


def test_budgets_are_those_of_the_rig_and_there_are_none_without() -> None:
    rig = load("couple-rig")
    per_mass = rig.gravity.value * rig.disk_radius.value
    masses = CYCLE / per_mass
    steps = [Step(n, max(m, 0.0), max(-m, 0.0)) for n, m in enumerate(masses.tolist(), 1)]
    found = evaluate([loop()], rig=rig, steps=steps)
    made = {each.quantity: each for each in budgets(found, found.analyses[0])}
    assert made["torque"].value == pytest.approx(0.4)
    # Gravity is known to 0.02 of 9.80665: its share of the stiffness is the same share of it.
    unloading = made["stiffness, positive unloading"]
    gravity = next(part for part in unloading.contributions if part.name == "gravity")
    assert gravity.sigma == pytest.approx(unloading.value * 0.02 / 9.80665)
    assert unloading.value == pytest.approx(4.0, rel=0.01)
    assert budgets(evaluate([loop()]), found.analyses[0]) == []
