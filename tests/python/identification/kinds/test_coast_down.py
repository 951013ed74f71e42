"""Run-downs without the motor: they determine friction over inertia."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
import strainwave as sw
from strainwave.files.gear_set import GearSet
from strainwave.identification.identify import Identified, identify
from strainwave.identification.reading.mapping import FileMapping
from strainwave.identification.results.gear_so_far import ROTOR_SIGMA
from strainwave.questions import QuestionError

from tests.support.answers import options_of

COULOMB, VISCOUS = 0.06, 4e-4  # N.m, N.m.s/rad
ROTOR = 8e-5  # kg.m2
TIME = np.arange(0.0, 0.6, 0.001)


def run_down(speed_at_start: float = 300.0) -> sw.Recording:
    """A speed of J dw/dt = -(Tc + b w), and then rest."""
    inertia = ROTOR + sw.load("csg-20-100").input_inertia
    speed = (speed_at_start + COULOMB / VISCOUS) * np.exp(-VISCOUS / inertia * TIME) - COULOMB / VISCOUS
    speed = np.maximum(speed, 0.0) + 0.05 * np.random.default_rng(0).standard_normal(len(TIME))
    return sw.Recording({"time": TIME, "speed": speed}, {"time": "s", "speed": "rad/s"})


def found(**constants: float) -> Identified:
    return identify("csg-20-100", {"coast_down": run_down()}, mapping=FileMapping(constants=constants))


def test_without_an_inertia_it_determines_the_ratios_and_asks() -> None:
    with pytest.raises(QuestionError, match="determines friction over inertia alone") as asked:
        found()
    assert options_of(asked.value) == ["--constant motor_inertia=NUMBER"]
    dry, viscous = (float(each) for each in re.findall(r"(?:Coulomb|viscous) ([\d.]+)", asked.value.question))
    inertia = ROTOR + sw.load("csg-20-100").input_inertia
    assert dry == pytest.approx(COULOMB / inertia, rel=0.02)
    assert viscous == pytest.approx(VISCOUS / inertia, rel=0.03)


def test_with_the_inertia_of_the_rotor_it_is_a_table_of_friction() -> None:
    (result,) = found(motor_inertia=ROTOR).files
    estimates = {each.path: each for each in result.estimates if not each.why}
    for path, truth in (("coulomb", COULOMB), ("viscous", VISCOUS)):
        estimate = estimates[f"gear.friction_input.{path}"]
        assert estimate.value == pytest.approx(truth, rel=0.02)
    assert any("friction scales with them" in each for each in result.remarks)
    assert not result.failed


def test_friction_is_as_uncertain_as_the_inertia_of_the_wave_generator() -> None:
    start = sw.load("csg-20-100")
    entry = GearSet.read("csg-20-100").sources["gear.input_inertia"]
    sigma = entry.sigma(start.input_inertia) or ROTOR_SIGMA * start.input_inertia
    (result,) = found(motor_inertia=ROTOR).files
    (coulomb,) = (each for each in result.estimates if each.path == "gear.friction_input.coulomb")
    assert coulomb.common == pytest.approx(coulomb.value * sigma / (ROTOR + start.input_inertia))
    assert coulomb.sigma > coulomb.common > 0.0


def test_a_load_turns_with_it() -> None:
    """An inertia of the load counts by the square of the ratio."""
    as_rotor, as_load = found(motor_inertia=ROTOR + 2e-5), found(motor_inertia=ROTOR, load_inertia=0.2)
    values = [each.files[0].estimates[0].value for each in (as_rotor, as_load)]
    assert values[0] == pytest.approx(values[1])


def test_a_speed_that_rises_again_is_no_run_down(tmp_path: Path) -> None:
    speed = 100.0 + 50.0 * np.sin(20.0 * TIME)
    sw.Recording({"time": TIME, "speed": speed}, {"time": "s", "speed": "rad/s"}).to_csv(tmp_path / "log.csv")
    with pytest.raises(ValueError, match="time and a speed that falls for coast_down"):
        identify("csg-20-100", [tmp_path / "log.csv"])
