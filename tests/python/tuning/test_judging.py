"""Other conditions than those of the choice: less of an effect, other loads, speeds and temperatures."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import strainwave as sw
from strainwave.tuning.candidates import baseline
from strainwave.tuning.cascade import Plant, Setting
from strainwave.tuning.drawn import drawn_gears
from strainwave.tuning.goals import position
from strainwave.tuning.judging import (
    OTHER_TEMPERATURES,
    OverCompensation,
    conditions,
    depends_on_temperature,
    judged,
    smaller_effect,
)

from tests.support.compensated_joint import robot_joint

SET = sw.GearSet.read("robot-joint")


@pytest.fixture(scope="module")
def found() -> sw.tuning.Compensated:
    return robot_joint()


def test_a_spring_of_less_twist_takes_more_torque() -> None:
    """Of half the torsion, every twist needs twice the torque, on every branch of the hysteresis."""
    torque = np.array([0.0, 30.0, -30.0, 10.0])
    parts = smaller_effect(SET.drive, "torsion", np.array([2.0]))
    half = SET.drive.replace({path: float(value[0]) for path, value in parts.items()}).gear
    assert half.twist(2.0 * torque) == pytest.approx(SET.gear.twist(torque), rel=1e-6)


@pytest.mark.parametrize("effect", ["friction", "kinematic error"])
def test_friction_and_error_shrink_by_the_factor(effect: str) -> None:
    parts = smaller_effect(SET.drive, effect, np.array([2.0]))
    half = SET.drive.replace({path: float(value[0]) for path, value in parts.items()}).gear
    if effect == "friction":
        assert half.friction_input.steady(5.0) == pytest.approx(0.5 * SET.gear.friction_input.steady(5.0))
    else:
        angle = np.linspace(0.0, 6.0, 20)
        assert half.kinematic_error.slope(angle) == pytest.approx(0.5 * SET.gear.kinematic_error.slope(angle))


def test_limits_are_the_last_factors_before_a_loss_and_a_failure() -> None:
    each = OverCompensation(
        "friction", np.array([1.25, 1.5, 2.0, 3.0]), np.array([4.0, 4.0, 4.0, 4.0]), np.array([1.0, 2.0, 5.0, np.nan])
    )
    assert (each.gains_up_to, each.stable_up_to) == (1.5, 2.0)
    worse = OverCompensation("friction", np.array([1.25, 1.5]), np.array([1.0, 1.0]), np.array([np.nan, 0.5]))
    assert (worse.gains_up_to, worse.stable_up_to) == (1.0, 1.0)


def test_too_much_torsion_in_the_model_gains_less_and_less(found: sw.tuning.Compensated) -> None:
    (torsion,) = [each for each in found.over_compensation if each.effect == "torsion"]
    assert torsion.chosen[0] < torsion.baseline[0]
    assert torsion.chosen[-1] > torsion.chosen[0]
    assert torsion.stable_up_to == 3.0


def test_both_controllers_are_judged_at_other_speeds_and_loads(found: sw.tuning.Compensated) -> None:
    names = [each.name for each in found.conditions]
    assert names[:4] == [
        "half the speed", "1.5 times the speed", "half the inertia of the load", "1.5 times the inertia of the load",
    ]  # fmt: skip
    faster, heavier = found.conditions[1], found.conditions[3]
    assert faster.baseline.candidate == heavier.baseline.candidate == found.baseline.candidate
    assert faster.chosen.median("tracking error") != found.chosen.median("tracking error")
    assert heavier.chosen.median("tracking error") != found.chosen.median("tracking error")


def test_a_gear_whose_friction_falls_with_temperature_is_judged_cold_and_warm() -> None:
    friction = sw.friction.Coulomb(coulomb=0.05, viscous=1e-3)
    plain, law = sw.Gear(friction_input=friction), sw.friction.Thermal(law=friction, viscous_fall=0.025)
    load = sw.loads.Inertia(inertia=0.1)
    assert depends_on_temperature(sw.Drive(gear=plain.replace(friction_input=law), load=load))
    assert not depends_on_temperature(sw.Drive(gear=plain, load=load))


@pytest.mark.slow("tuning")
def test_a_gear_that_heats_up_is_cold_and_warm_from_the_begin() -> None:
    """In a motion of seconds it hardly warms up: its figures are those of a gear that keeps the temperature around it."""
    joint = sw.GearSet.read("space-pointing-joint")
    plant, draws = Plant.read(joint, 1e-3, 0.0), drawn_gears(joint, 3)
    goal, cascade = position(0.02, 0.1, plant.effort_unit), baseline(plant, Setting(0.5, "input", 0.5))
    both = (judged(cascade, goal, draws, plant),) * 2
    *_, cold, warm = (each.baseline for each in conditions(both, lambda pace: goal, draws, plant))
    assert warm.median("tracking error") != pytest.approx(cold.median("tracking error"), rel=0.01)
    kept = replace(cascade, drive=cascade.drive.replace(thermal=sw.thermal.Isothermal()))
    for found, temperature in zip((cold, warm), OTHER_TEMPERATURES.values(), strict=True):
        expected = judged(kept, goal, draws, plant, temperature=temperature).figures["tracking error"]
        assert found.figures["tracking error"] == pytest.approx(expected, rel=2e-3)
