"""Friction over the speed, by which gears with different laws of friction are compared."""

from __future__ import annotations

import numpy as np
import pytest
import strainwave as sw
from strainwave.analysis.friction_curve import friction_sigma
from strainwave.files.entries import Entry
from strainwave.files.identified_tables import Covariance, Validation
from strainwave.report.listing import difference_table

SET = sw.GearSet.read("csg-25-100")
MEASURED = Validation("a.csv", "log", "torque", "N.m", 0.1, 9.0, 0.1, 9.0, measured={"input_speed": (-80.0, 100.0)})
LINE = ["coulomb", "viscous"]
SIGMA = {"coulomb": 2e-3, "breakaway": 2e-3, "viscous": 3e-5}


def measured(cyclic: bool, coulomb: float) -> sw.GearSet:
    """Return a gear with a measured law of friction, with or without a wave of unknown size over the angle."""
    law = sw.friction.Coulomb(coulomb=coulomb, breakaway=coulomb, viscous=5e-4)
    wave = sw.friction.Cyclic(law=law, order=[2.0], amplitude=[0.1], phase=[0.0])
    part = "gear.friction_input.law." if cyclic else "gear.friction_input."
    sources = {f"{part}{name}": Entry("log", uncertainty=sigma) for name, sigma in SIGMA.items()}
    gear = SET.gear.replace(friction_input=wave if cyclic else law)
    return sw.GearSet.of(gear, name="joint", source="log", sources=sources).replace(validation=(MEASURED,))


def test_gears_of_different_laws_are_compared_by_their_friction_over_the_speed() -> None:
    first, *curve = sw.compare(measured(False, 0.09), measured(True, 0.1))
    assert (first.path, first.first, first.second) == ("gear.friction_input", "coulomb", "cyclic")
    assert [each.path for each in curve] == [f"friction at {rpm} rpm" for rpm in ("10", "100", "954.9")]
    speeds = np.array([10.0 * np.pi / 30.0, 100.0 * np.pi / 30.0, 100.0])
    for each, speed in zip(curve, speeds, strict=True):
        assert (each.first, each.second) == pytest.approx((0.09 + 5e-4 * speed, 0.1 + 5e-4 * speed))
        assert each.sigma == pytest.approx(np.sqrt(2.0) * np.hypot(2e-3, 3e-5 * speed), rel=1e-6)


def test_the_covariance_of_the_numbers_counts() -> None:
    matrix = np.array([[4e-6, -0.9 * 6e-8], [-0.9 * 6e-8, 9e-10]])
    covariance = Covariance.of([f"gear.friction_input.{name}" for name in LINE], matrix)
    sigma = friction_sigma(measured(False, 0.09).replace(covariance=covariance), [50.0])
    assert sigma == pytest.approx([np.sqrt(matrix[0, 0] + 2.0 * 50.0 * matrix[0, 1] + 2500.0 * matrix[1, 1])], rel=1e-6)


def test_a_curve_of_a_number_without_standard_deviation_has_none() -> None:
    joint = measured(True, 0.1)
    without = {path: Entry("log") if path.endswith(".viscous") else entry for path, entry in joint.sources.items()}
    assert friction_sigma(joint.replace(sources=without), [50.0]) is None


def test_scatter_of_the_catalogue_that_both_sets_have_makes_no_standard_deviation() -> None:
    path = "gear.stiffness.k1"
    other = SET.replace(gear=SET.gear.replace({"stiffness.k1": 1.2 * SET.gear.stiffness.k1}))
    assert SET.sources[path].spread is not None
    assert sw.compare(SET, other)[0].sigma is None
    known = other.replace(sources={**other.sources, path: Entry("log", uncertainty=100.0)})
    expected = np.hypot(SET.sources[path].spread * SET.gear.stiffness.k1, 100.0)
    assert sw.compare(SET, known)[0].sigma == pytest.approx(expected)


def test_a_wide_table_has_long_names_on_lines_of_their_own() -> None:
    path = "gear.friction_input.law.law.stribeck_velocity_of_a_long_name"
    lines = difference_table([sw.analysis.Difference(path, 0.0123456, 0.0234567, "N.m.s/rad", 1e-4)]).splitlines()
    assert lines[1] == path
    assert lines[2].split() == ["0.0123456", "0.0234567", "N.m.s/rad", "+90", "%", "111.1"]
    assert max(map(len, lines)) <= 80
