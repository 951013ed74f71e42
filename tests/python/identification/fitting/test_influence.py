"""How far estimates move with what was kept: against fits that keep something else."""

from __future__ import annotations

import numpy as np
import pytest
import strainwave as sw
from strainwave.files.entries import Entry
from strainwave.identification.experiments.torsion_loop import TorsionLoop
from strainwave.identification.fitting.fit import fit
from strainwave.identification.fitting.influence import InfluenceOfKept, influence, uncertainty
from strainwave.parameters import Parameter

ELEMENTS = sw.hysteresis.MaxwellSlip(stiffness=[8e3, 4e3], breakaway=[0.8, 1.2])
GEAR = sw.Gear(stiffness=sw.stiffness.Cubic(a1=1.5e4, a3=6e9), hysteresis=ELEMENTS)
FREE = ["stiffness.a1", "stiffness.a3"]


def loop() -> TorsionLoop:
    quarter = np.linspace(0.0, 1.5e-3, 100)
    twist = np.concatenate((quarter[::-1], -quarter[1:], -quarter[-2::-1], quarter[1:]))
    torque = GEAR.trace(np.concatenate((twist, twist)))[-len(twist) :]
    return TorsionLoop(twist, torque + 0.05 * np.random.default_rng(0).normal(size=len(twist)))


def kept(breakaway: float) -> sw.Gear:
    return GEAR.replace(hysteresis=ELEMENTS.replace(breakaway=[0.8, breakaway]))


def test_estimates_move_as_a_fit_with_another_kept_value_finds() -> None:
    step = 0.01
    found = influence(fit(kept(1.2), loop(), FREE))
    place = [each.path for each in found.kept].index("hysteresis.breakaway[1]")
    ends = [[e.value for e in fit(kept(1.2 + sign * step), loop(), FREE).estimates] for sign in (-1.0, 1.0)]
    slope = (np.array(ends[1]) - np.array(ends[0])) / (2.0 * step)
    assert found.slopes[:, place] == pytest.approx(slope, rel=0.02, abs=1e-3 * np.abs(slope).max())


def test_a_wrong_kept_value_is_pulled_to_the_true_one() -> None:
    found = influence(fit(kept(1.6), loop(), FREE))
    place = [each.path for each in found.kept].index("hysteresis.breakaway[1]")
    assert 1.6 + found.shift_if_free[place] == pytest.approx(1.2, abs=0.1)
    assert found.explained_share[place] > 0.8
    assert place in found.suspects({"hysteresis.breakaway[1]": Entry("guessed", uncertainty=0.1)})
    assert found.suspects({each.path: Entry("guessed", spread=1.0) for each in found.kept}) == []


def test_only_a_value_that_a_parameter_may_have_is_suspected_least_certain_first() -> None:
    kept = tuple(
        Parameter(n, name, "kg.m2", 1.0, 0.0, np.inf) for n, name in enumerate(("impossible", "sure", "unsure", "idle"))
    )
    found = InfluenceOfKept(
        kept, np.ones((1, 4)), np.ones(4), np.array([-1.5, -0.5, -0.6, -0.5]), np.array([0.9, 0.7, 0.6, 0.4])
    )
    known = {
        name: Entry("measured", uncertainty=sigma) for name, sigma in {"impossible": 0.1, "sure": 0.01, "unsure": 0.3}.items()
    }
    assert [kept[place].path for place in found.suspects(known)] == ["unsure", "sure"]


def test_right_kept_values_are_suspected_of_nothing() -> None:
    found = influence(fit(kept(1.2), loop(), FREE))
    assert found.suspects({}) == []
    assert InfluenceOfKept.none(2).suspects({}) == []
    assert InfluenceOfKept.none(2).shifts(0, {}) == {}


def test_the_measurement_bounds_the_shift_by_a_kept_parameter() -> None:
    found = influence(fit(kept(1.2), loop(), FREE))
    place = [each.path for each in found.kept].index("hysteresis.breakaway[1]")
    loose = found.shifts(0, {"hysteresis.breakaway[1]": Entry("guessed", uncertainty=1e6)})["hysteresis.breakaway[1]"]
    assert loose == pytest.approx(abs(found.slopes[0, place]) * found.bounds[place], rel=1e-6)
    exact = found.shifts(0, {"hysteresis.breakaway[1]": Entry("measured", uncertainty=0.0)})["hysteresis.breakaway[1]"]
    assert exact == 0.0


def test_a_kept_value_without_uncertainty_is_known_to_10_percent_and_an_assumed_one_to_50() -> None:
    assert uncertainty(-5.0, None) == uncertainty(-5.0, Entry("somebody")) == 0.5
    assert uncertainty(-5.0, Entry("assumed: a guess")) == 2.5
    assert uncertainty(5.0, Entry("catalogue", spread=0.3, uncertainty=2.0)) == pytest.approx(2.5)
