"""Torsion loop of spring and hysteresis, by which gears are compared in place of elements, which are not unique."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import strainwave as sw
from strainwave.analysis.torsion_loop import loop_sigma, measured_torque, torsion_loop
from strainwave.files.identified_tables import Covariance, Validation

SET = sw.GearSet.read("csg-25-100")
MEASURED = Validation("a.csv", "torsion", "torque", "N.m", 0.1, 9.0, 0.1, 9.0, measured={"output_torque": (-30.0, 40.0)})
SIGMAS = {"gear.stiffness.k": 100.0, "gear.hysteresis.stiffness[0]": 60.0, "gear.hysteresis.breakaway[0]": 0.05}


def with_slips(stiffness: list[float], breakaway: list[float], k: float = 2e4, **changes: Any) -> sw.GearSet:
    slips = sw.hysteresis.MaxwellSlip(stiffness=stiffness, breakaway=breakaway)
    gear = SET.gear.replace(stiffness=sw.stiffness.Linear(k=k), hysteresis=slips)
    known = {path: sw.files.Entry("log", uncertainty=sigma) for path, sigma in SIGMAS.items()}
    return sw.GearSet.of(gear, name="joint", source="log", sources=known).replace(validation=(MEASURED,), **changes)


def test_two_sets_of_elements_that_make_one_loop_are_equal_in_it() -> None:
    found = sw.compare(with_slips([4e3], [1.0]), with_slips([3e3, 1e3], [0.75, 0.25]))
    assert not any("hysteresis" in each.path for each in found)
    loop = [each for each in found if each.path.startswith("loop to 40 N.m: ")]
    assert len(loop) == 5
    for each in loop:
        assert each.second == pytest.approx(each.first, rel=1e-9)


def test_another_loop_differs_in_standard_deviations() -> None:
    one, other = with_slips([4e3], [1.0]), with_slips([4e3], [1.3])
    loss = next(each for each in sw.compare(one, other) if each.path == "loop to 40 N.m: loss")
    closed = [4.0 * slip * ((40.0 - slip) / 2e4 - slip / 4e3) for slip in (1.0, 1.3)]  # four times slip torque by slid twist
    assert (loss.first, loss.second) == pytest.approx(closed, rel=1e-3)
    slopes = [4.0 * ((40.0 - 2.0 * slip) / 2e4 - 2.0 * slip / 4e3) for slip in (1.0, 1.3)]
    assert loss.deviations == pytest.approx((closed[1] - closed[0]) / (0.05 * np.hypot(*slopes)), rel=0.02)


def test_its_standard_deviation_is_that_of_drawn_gears() -> None:
    matrix = np.diag([100.0**2, 60.0**2, 0.05**2])
    matrix[0, 1] = matrix[1, 0] = -0.8 * 100.0 * 60.0
    one = with_slips([4e3], [1.0], covariance=Covariance.of(list(SIGMAS), matrix))
    draws = np.random.default_rng(0).multivariate_normal([2e4, 4e3, 1.0], matrix, size=120)
    loops = [torsion_loop(with_slips([stiffness], [breakaway], k=k).gear, 40.0) for k, stiffness, breakaway in draws]
    np.testing.assert_allclose(
        loop_sigma(one, 40.0), np.std(loops, axis=0), rtol=0.25
    )  # four standard deviations of that of 120 draws


def test_without_a_stated_deviation_the_loop_has_none() -> None:
    assert loop_sigma(SET, 40.0) is None
    assert all(each.sigma is None for each in sw.compare(SET, with_slips([4e3], [1.0])) if each.path.startswith("loop"))


@pytest.mark.parametrize(("peak", "sure"), [(79.0, True), (81.0, False)])
def test_a_loop_far_below_what_one_was_measured_to_has_no_deviation(peak: float, sure: bool) -> None:
    """A loop to 67 N.m determines nothing at 2.7 N.m: there two records of one joint differed by 34 standard deviations."""
    far = replace(MEASURED, measured={"output_torque": (-10.0, peak)})
    found = sw.compare(with_slips([4e3], [1.0]), with_slips([4e3], [1.3]).replace(validation=(far,)))
    loop = [each for each in found if each.path.startswith("loop to 40 N.m: ")]
    assert {each.sigma is None for each in loop} == {not sure}
    reached = [(each.first, each.second) for each in loop if each.path.endswith(": was measured to")]
    assert reached == ([] if sure else [(40.0, peak)])


def test_a_torque_counts_that_determines_the_loop() -> None:
    log = Validation("b.csv", "log", "current", "A", 0.1, 9.0, 0.1, 9.0, measured={"output_torque": (-3.0, 50.0)})
    one = with_slips([4e3], [1.0])
    assert measured_torque(one.replace(validation=(MEASURED, log))) == 40.0
    assert measured_torque(one.replace(validation=(log,))) is None
    spring = {"gear.stiffness.k": sw.files.Entry("identified from b.csv", uncertainty=100.0)}
    assert measured_torque(one.replace(validation=(MEASURED, log), sources={**one.sources, **spring})) == 50.0


def test_a_loop_without_slip_is_a_line_to_the_last_digit() -> None:
    assert torsion_loop(with_slips([4e3], [9.0]).gear, 5.0)[2:].tolist() == [0.0, pytest.approx(-2.5 / 2.4e4), 0.0]
