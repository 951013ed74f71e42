"""Profiles: on linear models the interval of the estimate, else what refitting finds, and open where nothing is determined."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import strainwave as sw
from hypothesis import given, settings, strategies as st
from strainwave.identification.experiments.torsion_loop import TorsionLoop
from strainwave.identification.fitting.profile import profile

LAW = sw.friction.Coulomb(coulomb=0.03, breakaway=0.03, viscous=4e-4)
FREE = ["friction_input.coulomb", "friction_input.viscous"]
SPEED = np.linspace(1.0, 60.0, 40)


def table(seed: int, law: Any = LAW) -> sw.Recording:
    torque = law.steady(SPEED) + 1e-3 * np.random.default_rng(seed).normal(size=len(SPEED))
    return sw.Recording({"speed": SPEED, "torque": torque}, {"speed": "rad/s", "torque": "N.m"})


@given(st.integers(0, 10**6), st.sampled_from(FREE), st.sampled_from([0.5, 0.9, 0.99]))
@settings(max_examples=10, deadline=None)
def test_of_a_linear_model_it_is_the_interval_of_the_estimate(seed: int, path: str, confidence: float) -> None:
    found = sw.fit(sw.Gear(friction_input=LAW), table(seed), FREE)
    estimate = found.estimates[FREE.index(path)]
    drawn = profile(found, path, confidence=confidence)
    width = 2.0 * estimate.sigma
    assert drawn.interval == pytest.approx(estimate.interval(confidence), abs=0.02 * width)
    distance = ((drawn.values - estimate.value) / estimate.sigma) ** 2
    assert drawn.cost == pytest.approx(distance, rel=0.01, abs=1e-6)
    assert not drawn.open_below
    assert not drawn.open_above


def test_a_prior_bounds_what_the_data_do_not() -> None:
    gear = sw.Gear(friction_input=LAW, damping=3.0)
    drawn = profile(sw.fit(gear, table(0), [*FREE, "damping"], priors={"damping": (3.0, 0.5)}), "damping")
    assert drawn.interval == pytest.approx((3.0 - 1.96 * 0.5, 3.0 + 1.96 * 0.5), abs=0.02)


def test_what_the_data_do_not_touch_is_open_to_both_sides() -> None:
    drawn = profile(sw.fit(sw.Gear(friction_input=LAW, damping=3.0), table(0), [*FREE, "damping"]), "damping")
    assert (drawn.open_below, drawn.open_above, drawn.interval) == (True, True, (0.0, np.inf))
    assert drawn.to_dict()["summary"] == "damping is not determined: the data bound it to neither side"


def test_a_slip_that_the_twist_never_reaches_is_open_above() -> None:
    """Of an element that has not slipped the breakaway is at least what it carried; how much more, nothing tells."""
    twist = np.concatenate((np.linspace(0.0, 1e-3, 60), np.linspace(1e-3, -1e-3, 120), np.linspace(-1e-3, 1e-3, 120)))
    truth = sw.Gear(
        stiffness=sw.stiffness.Linear(k=1e4), hysteresis=sw.hysteresis.MaxwellSlip(stiffness=[5e3], breakaway=[2.0])
    )
    torque = truth.trace(twist) + 0.05 * np.random.default_rng(0).normal(size=len(twist))
    loop = TorsionLoop(twist, torque, history="virgin", twist_zero=0.0)
    reached = profile(sw.fit(truth, loop, ["hysteresis.breakaway", "stiffness.k"]), "hysteresis.breakaway[0]")
    assert not reached.open_above
    assert reached.interval[0] < 2.0 < reached.interval[1]
    stuck = truth.replace(hysteresis=sw.hysteresis.MaxwellSlip(stiffness=[5e3], breakaway=[30.0]))
    torque = stuck.trace(twist) + 0.05 * np.random.default_rng(0).normal(size=len(twist))
    loop = TorsionLoop(twist, torque, history="virgin", twist_zero=0.0)
    never = profile(sw.fit(stuck, loop, ["hysteresis.breakaway", "stiffness.k"]), "hysteresis.breakaway[0]")
    assert never.open_above
    assert not never.open_below
    assert 4.0 < never.interval[0] < 11.0  # it carries up to 10 N.m along this path, without slip
    assert "the data do not determine how large it is" in never.to_dict()["summary"]


def test_an_unknown_that_the_fit_does_not_have_is_refused() -> None:
    found = sw.fit(sw.Gear(friction_input=LAW), table(0), FREE)
    with pytest.raises(ValueError, match=r'^the fit has no unknown "damping"; it has friction_input.coulomb, '):
        profile(found, "damping")


@pytest.mark.parametrize(
    "verb", [lambda x: sw.identification.profile(x, "damping"), sw.identification.bootstrap, sw.identification.combinations]
)
@pytest.mark.parametrize("other", [np.zeros(3), sw.Gear(), None], ids=["array", "gear", "nothing"])
def test_what_is_no_fit_is_refused(verb: Any, other: Any) -> None:
    with pytest.raises(TypeError, match=r"^found must be a Fit, which sw\.fit returns, not "):
        verb(other)
