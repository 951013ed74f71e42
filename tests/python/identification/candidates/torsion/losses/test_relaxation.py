"""Loops at several rates of a material that relaxes, or does not."""

from __future__ import annotations

import numpy as np
import pytest
import strainwave as sw
from strainwave.identification import loss_shares
from strainwave.identification.candidates.torsion.losses.relaxation import Relaxation

from tests.evidence.drawn import relaxing_material
from tests.support.loss_loops import GEAR, STIFFNESS

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


def test_the_factor_is_the_loss_modulus_over_that_of_the_largest_loop() -> None:
    relaxation = Relaxation(reference=0.5, middle=0.2, spread=1.0)  # BRANCH relaxes in 1 / middle
    for frequency in (0.02, 0.5, 2.5):
        expected = BRANCH.loss(frequency) / BRANCH.loss(0.5)
        assert relaxation.factor(frequency, 0.0) == pytest.approx(expected, rel=1e-12)


@pytest.mark.slow("identification")
@pytest.mark.parametrize("seed", [0, 1, 5])  # the last one does not relax
def test_drawn_materials_that_relax_are_right_or_not_separable(seed: int) -> None:
    assert relaxing_material.outcome(seed).verdict == "right"
