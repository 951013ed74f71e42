"""Uncertainty budgets against draws of what they are made of."""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.typing import NDArray
from strainwave.rig.bench.setup import Masses, Rig, Value
from strainwave.rig.bench.steps import Step
from strainwave.rig.torque.budget import Budget, Contribution, angle_budget, stiffness_budget, torque_budget

Array = NDArray[np.float64]
DRAWS = 20_000
RIG = Rig(
    "bench",
    "input",
    Value(0.1, 2e-4),
    gravity=Value(9.81, 0.02),
    masses=(Masses(0.025, 16, 5e-5),),
    cord="fixed point",
    cord_tangent=Value(math.radians(-40.0), math.radians(0.3)),
    pulley_share=Value(0.0, 0.002),
    compliance=Value(0.012, 8e-4),
)
STEPS = [Step(n, mass_positive=0.025 * n) for n in range(1, 13)]


def drawn(random: np.random.Generator, number: Value) -> Array:
    return number.value + number.sigma * random.standard_normal(DRAWS)


def drawn_torques(random: np.random.Generator, angle: float) -> Array:
    """Torques of the steps, each row with another rig that is as the file of the rig says, shape (draws, steps)."""
    radius, gravity, tangent, share = (
        drawn(random, each) for each in (RIG.disk_radius, RIG.gravity, RIG.cord_tangent, RIG.pulley_share)
    )
    counts = np.arange(1, len(STEPS) + 1)
    masses = 0.025 * counts + 5e-5 * np.sqrt(counts) * random.standard_normal((DRAWS, len(STEPS)))
    return masses * (gravity * radius * np.cos(angle - tangent) * (1.0 - share))[:, None]


def assert_as_drawn(budget: Budget, values: Array) -> None:
    """The budget's deviation is that of the draws, whose own one is known to 1/sqrt(2 n)."""
    assert budget.sigma == pytest.approx(values.std(), rel=4.0 / math.sqrt(2.0 * DRAWS))


def test_the_budget_of_a_torque_is_what_draws_of_its_numbers_show() -> None:
    angle = math.radians(15.0)
    torques = drawn_torques(np.random.default_rng(1), angle)
    for row in (0, 11):
        budget = torque_budget(RIG, STEPS[row], angle)
        assert_as_drawn(budget, torques[:, row])
        assert budget.value == pytest.approx(0.025 * (row + 1) * 0.981 * math.cos(math.radians(55.0)), rel=1e-12)


def test_the_budget_of_an_angle_is_what_draws_of_its_numbers_show() -> None:
    random = np.random.default_rng(2)
    torque = drawn_torques(random, 0.0)[:, -1]
    seen = 0.1 * (1.0 + 1e-3 * random.standard_normal(DRAWS)) + 2e-4 * random.standard_normal(DRAWS)
    budget = angle_budget(RIG, 0.1, 2e-4, torque_budget(RIG, STEPS[-1]), 1e-3)
    assert_as_drawn(budget, seen - drawn(random, RIG.compliance) * torque)


def test_the_budget_of_a_stiffness_is_what_regressions_over_draws_show() -> None:
    """The gear has 4.5 N.m/rad; each row is evaluated with the rig's file, while the torques are those of another rig."""
    random, angle, stiffness, sigma = np.random.default_rng(3), math.radians(-10.0), 4.5, 3e-4
    true = drawn_torques(random, angle)
    seen = true * (1.0 / stiffness + drawn(random, RIG.compliance))[:, None] + sigma * random.standard_normal(true.shape)
    seen = seen * (1.0 + 2e-3 * random.standard_normal(DRAWS))[:, None]
    nominal = np.array([torque_budget(RIG, step, angle).value for step in STEPS])
    own = seen - RIG.compliance.value * nominal
    centred = nominal - nominal.mean()
    found = 1.0 / (own @ centred / (centred @ centred))
    budget = stiffness_budget(RIG, stiffness, STEPS, angle, sigma, 2e-3)
    assert_as_drawn(budget, found)


def test_contributions_add_up_as_squares_and_nothing_is_listed_that_is_nothing() -> None:
    parts = [Contribution("a", 3.0, "random"), Contribution("b", 0.0, "common"), Contribution("c", 4.0, "common")]
    budget = Budget.of("angle", 0.0, "rad", parts)
    assert [each.name for each in budget.contributions] == ["c", "a"]
    assert (budget.sigma, budget.of_kind("random"), budget.of_kind("by direction")) == (5.0, 3.0, 0.0)
    assert sum(map(budget.share, budget.contributions)) == 1.0


@pytest.mark.parametrize("steps", [[], STEPS[:1], [Step(1, 0.1), Step(2, 0.1)]])
def test_one_torque_tells_no_stiffness(steps: list[Step]) -> None:
    with pytest.raises(ValueError, match="steps: the stiffness of a regime needs two steps or more"):
        stiffness_budget(RIG, 4.5, steps)


@pytest.mark.parametrize(("angle", "sigma"), [(math.nan, 1e-4), (0.1, -1e-4)])
def test_an_angle_is_finite_and_its_error_is_not_negative(angle: float, sigma: float) -> None:
    with pytest.raises(ValueError, match=r"angle = nan|sigma = -0\.0001"):
        angle_budget(RIG, angle, sigma, torque_budget(RIG, STEPS[-1]))
