"""Drawn gears: by what is known of each number."""

from __future__ import annotations

import numpy as np
import pytest
import strainwave as sw
from strainwave.files.entries import Entry
from strainwave.files.identified_tables import Covariance
from strainwave.tuning.drawn import ASSUMED_SPREAD, ASSUMED_SPREADS, drawn_gears

SET = sw.GearSet.read("robot-joint")
SIGMA = 0.002


def test_numbers_of_a_part_have_one_factor_within_its_spread() -> None:
    draws = drawn_gears(SET, 400)
    factors = {path: values / SET.gear.stiffness.k1 for path, values in draws.items() if path == "gear.stiffness.k1"}
    (k1,) = factors.values()
    assert draws["gear.stiffness.t2"] / SET.gear.stiffness.t2 == pytest.approx(k1, rel=1e-12)
    assert k1.max() <= 1.0 + ASSUMED_SPREAD
    assert k1.min() >= 1.0 / (1.0 + ASSUMED_SPREAD)
    assert np.median(k1) == pytest.approx(1.0, abs=0.05)
    friction = draws["gear.friction_input.law.coulomb"] / SET.gear.friction_input.law.coulomb
    assert not np.allclose(friction, k1)


def test_a_phase_that_is_assumed_may_be_any_and_one_that_is_known_is_none() -> None:
    phases = drawn_gears(SET, 400)["gear.kinematic_error.phase[0]"]
    assert abs(np.mean(np.exp(1j * phases))) < 0.15
    known = SET.replace(sources={**SET.sources, "gear.kinematic_error.phase[0]": Entry("measured")})
    assert "gear.kinematic_error.phase[0]" not in drawn_gears(known, 3)


def test_identified_numbers_are_drawn_from_their_covariance() -> None:
    paths = ("gear.friction_input.law.coulomb", "load.inertia")
    matrix = np.array([[SIGMA**2, 0.8 * SIGMA * 0.01], [0.8 * SIGMA * 0.01, 1e-4]])
    draws = drawn_gears(SET.replace(covariance=Covariance.of(paths, matrix)), 4000, seed=2)
    found = np.cov([draws[path] for path in paths])
    assert found == pytest.approx(matrix, rel=0.1)
    assert draws[paths[1]].mean() == pytest.approx(SET.load.inertia, abs=1e-3)


def test_the_same_seed_draws_the_same_gears() -> None:
    one, same, other = (drawn_gears(SET, 5, seed=seed) for seed in (1, 1, 2))
    assert all(np.array_equal(one[path], same[path]) for path in one)
    assert not np.array_equal(one["load.inertia"], other["load.inertia"])


def test_damping_and_torque_constant_are_drawn_within_their_own_spreads() -> None:
    """A motor's magnets scatter by some percent; nobody knows the damping of a gear."""
    ideal = sw.motor.CurrentSource(torque_constant=0.1, inertia=1e-4)
    draws = drawn_gears(SET.with_parts(motor=ideal, control=sw.control.OpenLoop(), source="stated"), 400)
    for path, value, spread in (
        ("gear.damping", SET.gear.damping, ASSUMED_SPREAD),
        ("motor.torque_constant", 0.1, ASSUMED_SPREADS["motor.torque_constant"]),
    ):
        factor = draws[path] / value
        assert factor.max() == pytest.approx(1.0 + spread, rel=0.01)
        assert factor.min() == pytest.approx(1.0 / (1.0 + spread), rel=0.01)
    assert "motor.inertia" not in draws
