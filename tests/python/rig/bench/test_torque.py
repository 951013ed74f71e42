"""Torque of masses on pans, and the budgets of uncertainty."""

from __future__ import annotations

import dataclasses
import math
import re

import numpy as np
import pytest
import strainwave as sw
from hypothesis import given, strategies as st
from numpy.typing import NDArray
from strainwave.rig.bench.rig_file import load
from strainwave.rig.bench.setup import Cord, Masses, Rig, Value
from strainwave.rig.bench.steps import Step
from strainwave.rig.bench.torque import (
    Budget,
    Contribution,
    angle_budget,
    arm,
    blank,
    mass_sigma,
    stiffness_budget,
    torque_budget,
    torque_of,
    without_compliance,
)
from strainwave.rig.loop import Loop
from strainwave.rig.virtual.loading import load_by_steps

from tests.support.samples import sample

RIG = Rig("bench", "input", Value(0.1), gravity=Value(9.81))
STEPS_OF_CYCLE = [0.05 * abs(n) - 0.35 for n in range(14, -15, -1)]
Array = NDArray[np.float64]
DRAWS = 20_000
WEIGHED_RIG = Rig(
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


def loaded(masses: list[float]) -> list[Step]:
    """Steps of these differences between the pairs of pans [kg]."""
    return [Step(n, max(mass, 0.0), max(-mass, 0.0)) for n, mass in enumerate(masses, start=1)]


def test_m_is_the_total_of_the_two_pans_of_a_pair() -> None:
    """Erratum E-T7: 183.5 g on each pan, 367 g on the pair, are 0.36 N.m; taken as the mass of each, half of that."""
    torque = torque_of(loaded([0.367, 0.1835]), RIG)
    assert torque.cords.round(3).tolist() == [0.36, 0.18]
    couple = 0.1835 * 9.81 * 2.0 * 0.1  # force on each pan, at the distance of the two cords
    assert torque.cords[0] == pytest.approx(couple, rel=1e-15)


def test_the_two_pairs_act_against_each_other() -> None:
    assert torque_of([Step(1, 0.3, 0.1)], RIG).cords[0] == pytest.approx(0.2 * 9.81 * 0.1, rel=1e-15)


def test_a_cord_from_a_fixed_point_loses_half_its_arm_at_the_turn_of_document_t() -> None:
    fixed = dataclasses.replace(RIG, cord="fixed point")
    assert float(arm(fixed, math.radians(59.3)).round(2)) == 0.51
    assert float(arm(fixed, math.radians(60.0)).round(12)) == 0.5  # cos 60 degrees
    assert arm(RIG, np.radians([0.0, 59.3, 200.0])).tolist() == [1.0, 1.0, 1.0]
    tangent = dataclasses.replace(fixed, cord_tangent=Value(math.radians(-30.0)))
    assert arm(tangent, np.radians([-30.0, 30.0])).round(12).tolist() == [1.0, 0.5]
    assert torque_of(loaded([0.1]), tangent, [math.radians(30.0)]).cords[0] == pytest.approx(0.5 * 0.0981, rel=1e-12)


def test_a_cord_beyond_its_last_arm_is_refused() -> None:
    fixed = dataclasses.replace(RIG, cord="fixed point", cord_tangent=Value(math.radians(10.0)))
    with pytest.raises(ValueError, match=re.escape("the disk turned 90.5 degrees from cord_tangent; ")):
        arm(fixed, np.radians([0.0, -80.5]))


def test_a_torque_that_was_measured_is_that_of_the_shaft() -> None:
    rig = dataclasses.replace(RIG, pulley_torque=Value(0.01, 0.001))
    torque = torque_of([Step(1, torque=0.36), Step(2, torque=-0.2)], rig)
    assert torque.shaft.tolist() == [0.36, -0.2]
    assert (torque.scale, torque.friction_sigma, torque.sigma.tolist()) == (0.0, 0.0, [0.0, 0.0])


def test_steps_without_an_angle_have_no_torque_where_the_arm_depends_on_it() -> None:
    rig = dataclasses.replace(RIG, cord="fixed point", pulley_torque=Value(0.001))
    found = torque_of(loaded([0.3, 0.2, 0.1]), rig, [0.0, math.nan, -0.1])
    assert np.isnan(found.shaft).tolist() == [False, True, False]
    assert found.shaft[2] == pytest.approx(0.0981 * math.cos(0.1) + 0.001, rel=1e-12)


# Pulleys


def test_the_pulleys_take_from_what_moves_with_the_torque_and_add_to_what_yields() -> None:
    rig = dataclasses.replace(RIG, pulley_torque=Value(0.002), pulley_share=Value(0.01))
    torque = torque_of(loaded(STEPS_OF_CYCLE), rig)
    held = 0.002 + 0.01 * np.abs(torque.cords)
    backward = np.diff(STEPS_OF_CYCLE, prepend=0.0) < 0.0
    np.testing.assert_allclose(torque.shaft, torque.cords + np.where(backward, held, -held), rtol=0.0, atol=1e-15)
    assert torque.sense.tolist() == np.where(backward, -1.0, 1.0).tolist()


def test_a_step_smaller_than_twice_the_friction_does_not_move_the_shaft() -> None:
    rig = dataclasses.replace(RIG, pulley_torque=Value(0.03))
    torque = torque_of(loaded([0.3, 0.25, 0.2]), rig)
    assert torque.sense.tolist() == [1.0, 0.0, -1.0]
    assert torque.shaft[1] == torque.shaft[0] == pytest.approx(0.3 * 0.981 - 0.03, rel=1e-12)
    assert torque.shaft[2] == pytest.approx(0.2 * 0.981 + 0.03, rel=1e-12)


@given(
    masses=st.lists(st.just(0.0) | st.floats(1e-30, 0.5) | st.floats(-0.5, -1e-30), min_size=1, max_size=30),
    constant=st.just(0.0) | st.floats(1e-30, 0.05),
    share=st.floats(0.0, 0.3),
)
def test_the_shaft_is_never_further_from_the_cords_than_the_pulleys_hold(
    masses: list[float], constant: float, share: float
) -> None:
    rig = dataclasses.replace(RIG, pulley_torque=Value(constant), pulley_share=Value(share))
    torque = torque_of(loaded(masses), rig)
    assert np.all(np.abs(torque.shaft - torque.cords) <= constant + share * np.abs(torque.cords) + 1e-12)


def loop_of_a_spring(rig: Rig, friction: float, stiffness: float, compliance: float = 0.0) -> Loop:
    """The loop of a linear spring on a rig whose pulleys hold so much, evaluated as a rig that is described by `rig`."""
    true = dataclasses.replace(rig, pulley_torque=Value(friction))
    steps = loaded(STEPS_OF_CYCLE)
    angle = torque_of(steps, true).shaft * (1.0 / stiffness + compliance)
    torque = torque_of(steps, rig).shaft
    return Loop(without_compliance(angle, torque, rig.compliance), torque, side="input", name="spring")


def width_at_zero(loop: Loop) -> float:
    """Angle of the loop at zero torque on the way up less that on the way down [rad]."""
    n = len(loop) // 2 + 1
    down, up = slice(0, n), slice(n - 1, None)
    there = np.interp(0.0, loop.torque[down][::-1], loop.angle[down][::-1])
    return float(there - np.interp(0.0, loop.torque[up], loop.angle[up]))


def test_friction_of_the_pulleys_left_in_widens_the_loop_and_taken_out_does_not() -> None:
    """Erratum E-T8: 1 % of 0.36 N.m at 0.3 N.m/rad are 1.38 degrees of width."""
    width = width_at_zero(loop_of_a_spring(RIG, friction=0.0036, stiffness=0.3))
    assert width == pytest.approx(2.0 * 0.0036 / 0.3, rel=1e-12)
    assert round(math.degrees(width), 2) == 1.38
    known = dataclasses.replace(RIG, pulley_torque=Value(0.0036))
    assert width_at_zero(loop_of_a_spring(known, friction=0.0036, stiffness=0.3)) == pytest.approx(0.0, abs=1e-14)


# Compliance


def test_compliance_of_the_rig_is_taken_out_of_the_angle() -> None:
    """A spring of 4.5 N.m/rad in series with a rig of 90 N.m/rad seems to have 4.286 N.m/rad."""
    seen = loop_of_a_spring(RIG, friction=0.0, stiffness=4.5, compliance=1.0 / 90.0)
    assert np.polyfit(seen.angle, seen.torque, 1)[0] == pytest.approx(4.5 * 90.0 / 94.5, rel=1e-12)
    known = dataclasses.replace(RIG, compliance=Value(1.0 / 90.0))
    alone = loop_of_a_spring(known, friction=0.0, stiffness=4.5, compliance=1.0 / 90.0)
    assert np.polyfit(alone.angle, alone.torque, 1)[0] == pytest.approx(4.5, rel=1e-12)


def blank_run(random: np.random.Generator, compliance: float, noise: float) -> Loop:
    torque = np.array(STEPS_OF_CYCLE) * 0.981
    return Loop(compliance * torque + noise * random.standard_normal(len(torque)), torque, side="input", name="dummy")


def test_a_blank_run_tells_the_compliance_as_often_as_its_interval_says() -> None:
    random = np.random.default_rng(19)
    found = [blank(blank_run(random, 0.011, 3e-5)) for _ in range(400)]
    deviations = np.array([(each.value - 0.011) / each.sigma for each in found])
    assert abs(deviations.mean()) < 3.0 / math.sqrt(400)
    within = np.mean(np.abs(deviations) < 2.0518)  # Student's t of 27 degrees of freedom, 95 %
    assert abs(within - 0.95) < 3.0 * math.sqrt(0.95 * 0.05 / 400)


def test_what_all_torques_share_stays_in_the_compliance() -> None:
    torque = np.array([-0.3, 0.0, 0.3])
    loop = Loop(0.01 * torque, torque, side="input", name="dummy", torque_scale=0.003, angle_scale=0.004)
    assert blank(loop).sigma == pytest.approx(0.01 * 0.005, rel=1e-12)


@pytest.mark.parametrize(
    ("angle", "torque", "message"),
    [
        ([0.0, 0.1], [0.0, 0.3], "dummy: a blank run needs three points or more at different torques; it has 2"),
        ([0.0, 0.1, 0.2], [0.3, 0.3, 0.3], "dummy: a blank run needs three points or more at different torques; it has 3"),
        ([0.3, 0.1, -0.1], [0.0, 0.1, 0.2], "dummy: the angle falls with the torque, by 2 rad/(N.m); a sign is wrong"),
    ],
)
def test_a_blank_run_that_tells_nothing_is_refused(angle: list[float], torque: list[float], message: str) -> None:
    with pytest.raises(ValueError, match=f"^{re.escape(message)}$"):
        blank(Loop(angle, torque, side="input", name="dummy"))


def test_a_dummy_that_does_not_yield_has_no_negative_compliance() -> None:
    torque = np.array([-0.3, -0.1, 0.1, 0.3])
    found = blank(Loop(-1e-6 * torque + np.array([1e-5, -2e-5, 2e-5, -1e-5]), torque, side="input", name="dummy"))
    assert found.value == 0.0
    assert found.sigma > 0.0


# Masses


def test_errors_of_masses_add_up_as_squares() -> None:
    sets = (Masses(0.025, 16, 3e-5), Masses(0.1, 2, 4e-5))
    assert mass_sigma(0.0, sets) == 0.0
    assert mass_sigma(0.325, sets) == pytest.approx(math.sqrt(2 * 4e-5**2 + 5 * 3e-5**2), rel=1e-12)
    assert mass_sigma(0.3, ()) == 0.0


def test_a_total_that_no_masses_make_is_as_well_known_as_the_worst() -> None:
    sets = (Masses(0.025, 2, 3e-5),)
    assert mass_sigma(0.367, sets) == pytest.approx(math.hypot(math.sqrt(2) * 3e-5, 0.317 * 3e-5 / 0.025), rel=1e-9)


def test_the_shared_error_of_the_rig_of_document_t() -> None:
    """0.05 mm of 100 mm, 0.02 of 9.80665 m/s2, and 1 % of friction."""
    torque = torque_of(loaded([0.35]), load("couple-rig"))
    assert torque.scale == pytest.approx(math.sqrt(5e-4**2 + (0.02 / 9.80665) ** 2 + 0.01**2), rel=1e-12)
    assert torque.friction_sigma == pytest.approx(0.01 * 0.35 * 9.80665 * 0.1, rel=1e-12)


def test_steps_are_needed() -> None:
    with pytest.raises(ValueError, match="steps: a test needs one step or more"):
        torque_of([], RIG)


def assert_positive(values: NDArray[np.float64]) -> None:
    assert np.all(values > 0.0)


def test_every_torque_of_weighed_masses_has_its_own_error() -> None:
    steps = loaded([0.35, 0.3, -0.05])
    assert_positive(torque_of(steps, load("couple-rig")).sigma)


# Against the virtual rig, which follows cords, pulleys and gear by another road


def random_rig(random: np.random.Generator, cord: Cord) -> Rig:
    return Rig(
        "bench",
        "input",
        Value(0.1),
        gravity=Value(9.81),
        cord=cord,
        cord_tangent=Value(random.uniform(-0.3, 0.1)),
        pulley_torque=Value(random.uniform(0.0, 0.03)),
        pulley_share=Value(random.uniform(0.0, 0.1)),
        compliance=Value(random.uniform(0.0, 0.05)),
    )


@pytest.mark.slow("rig")
@pytest.mark.parametrize("cord", ["wound", "fixed point"])
def test_the_torque_of_a_virtual_shaft_is_found_again(cord: Cord) -> None:
    """Equilibria of a gear behind pulleys, two cycles; the evaluation knows masses and angles only."""
    random = np.random.default_rng(7)
    for _ in range(6):
        rig = random_rig(random, cord)
        gear = sw.Gear(
            kinematics=sw.kinematics.PlainRatio(reduction=100.0),
            stiffness=sw.stiffness.Linear(k=random.uniform(8e3, 4e4)),
            hysteresis=sw.hysteresis.MaxwellSlip(stiffness=[2e4], breakaway=[8.0]),
        )
        steps = loaded(STEPS_OF_CYCLE + STEPS_OF_CYCLE[1:])
        truth = load_by_steps(gear, rig, steps)
        np.testing.assert_allclose(torque_of(steps, rig, truth.angle).shaft, truth.shaft, rtol=0.0, atol=1e-9)


@pytest.mark.slow("rig")
def test_the_stated_uncertainty_covers_width_and_stiffness() -> None:
    """Rigs as uncertain as the file says: deviations of the width at zero torque and of the soft stiffness, in their sigmas."""
    random = np.random.default_rng(11)
    said = dataclasses.replace(
        RIG, disk_radius=Value(0.1, 3e-4), pulley_torque=Value(0.003, 8e-4), compliance=Value(0.02, 3e-3)
    )
    gear = sw.Gear(
        kinematics=sw.kinematics.PlainRatio(reduction=100.0),
        stiffness=sw.stiffness.Linear(k=5e3),
        hysteresis=sw.hysteresis.MaxwellSlip(stiffness=[5e4], breakaway=[10.0]),
    )
    steps, deviations = loaded(STEPS_OF_CYCLE), []
    for _ in range(sample(25, 60)):
        drawn = {
            name: Value(number.value + number.sigma * random.standard_normal())
            for name in ("disk_radius", "pulley_torque", "compliance")
            for number in [getattr(said, name)]
        }
        true = dataclasses.replace(said, **drawn)  # type: ignore[arg-type]
        truth = load_by_steps(gear, true, steps)
        seen = torque_of(steps, said)
        own = without_compliance(truth.angle, seen.shaft, said.compliance)
        real = truth.angle - true.compliance.value * truth.shaft
        widths = [width_at_zero(Loop(a, t, side="input", name="")) for a, t in ((own, seen.shaft), (real, truth.shaft))]
        soft = [float(np.polyfit(a[9:15], t[9:15], 1)[0]) for a, t in ((own, seen.shaft), (real, truth.shaft))]
        of_width = 2.0 * seen.friction_sigma / soft[1]  # both branches cross zero torque where the gear is soft
        of_soft = soft[1] * math.hypot(seen.scale, soft[1] * said.compliance.sigma)
        deviations.append([(widths[0] - widths[1]) / of_width, (soft[0] - soft[1]) / of_soft])
    assert np.std(deviations, axis=0) == pytest.approx(1.0, abs=4.0 / math.sqrt(2.0 * len(deviations)))


def drawn(random: np.random.Generator, number: Value) -> Array:
    return number.value + number.sigma * random.standard_normal(DRAWS)


def drawn_torques(random: np.random.Generator, angle: float) -> Array:
    """Torques of the steps, each row with another rig that is as the file of the rig says, shape (draws, steps)."""
    radius, gravity, tangent, share = (
        drawn(random, each)
        for each in (WEIGHED_RIG.disk_radius, WEIGHED_RIG.gravity, WEIGHED_RIG.cord_tangent, WEIGHED_RIG.pulley_share)
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
        budget = torque_budget(WEIGHED_RIG, STEPS[row], angle)
        assert_as_drawn(budget, torques[:, row])
        assert budget.value == pytest.approx(0.025 * (row + 1) * 0.981 * math.cos(math.radians(55.0)), rel=1e-12)


def test_the_budget_of_an_angle_is_what_draws_of_its_numbers_show() -> None:
    random = np.random.default_rng(2)
    torque = drawn_torques(random, 0.0)[:, -1]
    seen = 0.1 * (1.0 + 1e-3 * random.standard_normal(DRAWS)) + 2e-4 * random.standard_normal(DRAWS)
    budget = angle_budget(WEIGHED_RIG, 0.1, 2e-4, torque_budget(WEIGHED_RIG, STEPS[-1]), 1e-3)
    assert_as_drawn(budget, seen - drawn(random, WEIGHED_RIG.compliance) * torque)


def test_the_budget_of_a_stiffness_is_what_regressions_over_draws_show() -> None:
    """The gear has 4.5 N.m/rad; each row is evaluated with the rig's file, while the torques are those of another rig."""
    random, angle, stiffness, sigma = np.random.default_rng(3), math.radians(-10.0), 4.5, 3e-4
    true = drawn_torques(random, angle)
    seen = true * (1.0 / stiffness + drawn(random, WEIGHED_RIG.compliance))[:, None] + sigma * random.standard_normal(
        true.shape
    )
    seen = seen * (1.0 + 2e-3 * random.standard_normal(DRAWS))[:, None]
    nominal = np.array([torque_budget(WEIGHED_RIG, step, angle).value for step in STEPS])
    own = seen - WEIGHED_RIG.compliance.value * nominal
    centred = nominal - nominal.mean()
    found = 1.0 / (own @ centred / (centred @ centred))
    budget = stiffness_budget(WEIGHED_RIG, stiffness, STEPS, angle, sigma, 2e-3)
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
        stiffness_budget(WEIGHED_RIG, 4.5, steps)


@pytest.mark.parametrize(("angle", "sigma"), [(math.nan, 1e-4), (0.1, -1e-4)])
def test_an_angle_is_finite_and_its_error_is_not_negative(angle: float, sigma: float) -> None:
    with pytest.raises(ValueError, match=r"angle = nan|sigma = -0\.0001"):
        angle_budget(WEIGHED_RIG, angle, sigma, torque_budget(WEIGHED_RIG, STEPS[-1]))
