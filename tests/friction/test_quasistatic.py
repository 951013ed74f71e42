"""Friction along a path of displacement, infinitely slow: each law against its closed form."""

from __future__ import annotations

from functools import partial
from math import exp, pi
from typing import Any

import numpy as np
import pytest
from hypothesis import given, strategies as st
from strainwave import friction, hysteresis

from tests.laws.test_friction import in_bounds, laws
from tests.support.strategies import log_uniform, made, models, signed

paths = st.lists(st.just(0.0) | signed(log_uniform(1e-6, 1e2)), min_size=1, max_size=8)
there_and_back = [0.0, 0.0, 0.5, 0.5, -0.5, 1.0]
sense = np.array([0.0, 0.0, 1.0, 1.0, -1.0, 1.0])


def test_viscous_friction_vanishes() -> None:
    assert friction.Viscous(viscous=3.0).quasistatic(there_and_back).tolist() == [0.0] * 6


@pytest.mark.parametrize("law", [friction.Coulomb, partial(friction.Stribeck, stribeck_speed=2.0)])
def test_a_law_that_sticks_shows_its_breakaway_in_the_sense_of_the_last_motion(law: Any) -> None:
    torque = law(coulomb=0.25, breakaway=0.5, viscous=4.0).quasistatic(there_and_back)
    assert torque.tolist() == (0.5 * sense).tolist()


def test_position_dependent_friction_shows_the_breakaway_of_its_place() -> None:
    law = friction.PositionDependent(
        quadratic=1.0, linear=2.0, constant=3.0, static_ratio=2.0, speed_factor=0.0, domain_start=-1.0, domain_end=4.0
    )
    angle = 2.0 + np.array(there_and_back)
    torque = law.quasistatic(there_and_back, angle=2.0)
    assert torque == pytest.approx(sense * 2.0 * (angle**2 + 2.0 * angle + 3.0), rel=1e-15)
    with pytest.raises(ValueError, match=r"position_dependent: angle = 5 rad lies outside of \[-1, 4\] rad"):
        law.quasistatic([0.0, 5.0])


def test_load_dependent_friction_follows_the_load_of_each_point_and_its_quadrant() -> None:
    law = friction.LoadDependent(driving_forward=0.5, driving_reverse=0.25, backdriving_forward=0.125, backdriving_reverse=0.75)
    load = [4.0, 4.0, 4.0, -4.0, 4.0, -4.0]
    assert law.quasistatic(there_and_back, load=load).tolist() == [0.0, 0.0, 2.0, 0.5, -3.0, 0.5]


@given(log_uniform(1e-3, 1.0), log_uniform(1.0, 1e4), paths)
def test_lugre_is_a_fading_memory(breakaway: float, stiffness: float, path: list[float]) -> None:
    law = made(
        friction.LuGre,
        coulomb=0.5 * breakaway,
        breakaway=breakaway,
        bristle_stiffness=stiffness,
        bristle_damping=0.0,
        viscous=0.0,
    )
    memory = hysteresis.FadingMemory(stiffness=stiffness, forgetting=stiffness / breakaway)
    assert law.quasistatic(path) == pytest.approx(memory.trace(path), rel=1e-9, abs=1e-12 * breakaway)


def test_lugre_by_hand() -> None:
    law = made(friction.LuGre, coulomb=0.25, breakaway=0.5, bristle_stiffness=50.0, bristle_damping=1e-3, viscous=0.5)
    there = 0.5 * (1.0 - exp(-50.0 / 0.5 * 0.02))
    back = -0.5 + (there + 0.5) * exp(-50.0 / 0.5 * 0.01)
    assert law.quasistatic([0.0, 0.02, 0.02, 0.01]) == pytest.approx([0.0, there, there, back], rel=1e-15)


@given(log_uniform(1e-3, 1.0), paths)
def test_maxwell_slip_friction_is_maxwell_slip_with_its_shares_of_the_breakaway(breakaway: float, path: list[float]) -> None:
    stiffness = [60.0, 30.0, 10.0]
    law = made(
        friction.MaxwellSlipFriction,
        stiffness=stiffness,
        share=[1.0, 1.0, 2.0],
        coulomb=0.5 * breakaway,
        breakaway=breakaway,
        attraction=1e-3,
        viscous=3.0,
    )
    elements = hysteresis.MaxwellSlip(stiffness=stiffness, breakaway=[0.25 * breakaway, 0.25 * breakaway, 0.5 * breakaway])
    assert law.quasistatic(path) == pytest.approx(elements.trace(path), rel=1e-9, abs=1e-12 * breakaway)


def test_torque_efficiency_engages_over_its_presliding_angle() -> None:
    law = friction.TorqueEfficiency(average_loss=0.25, difference_loss=0.125, presliding=0.1, viscous=3.0)
    there = 1.0 - exp(-0.2 / 0.1)
    back = -1.0 + (there + 1.0) * exp(-0.1 / 0.1)
    losses = [0.25 * z + 0.125 * z * z for z in (0.0, there, back)]
    assert law.quasistatic([0.0, 0.2, 0.1], load=4.0) == pytest.approx([4.0 * loss for loss in losses], rel=1e-15)


def test_cyclic_friction_scales_the_breakaway_at_the_angle_of_each_point() -> None:
    law = friction.Cyclic(law=friction.Coulomb(coulomb=0.25, breakaway=0.5), order=2.0, amplitude=0.5, phase=0.0)
    angle = 0.25 * pi + np.array([0.0, 0.25 * pi, 0.5 * pi, 0.25 * pi])
    expected = np.array([0.0, 1.0, 1.0, -1.0]) * 0.5 * (1.0 + 0.5 * np.sin(2.0 * angle))
    assert law.quasistatic(angle - 0.25 * pi, angle=0.25 * pi) == pytest.approx(expected, rel=1e-14)


def test_thermal_friction_scales_the_breakaway_at_the_temperature_of_each_point() -> None:
    law = friction.Thermal(law=friction.Coulomb(coulomb=0.25, breakaway=0.5), dry_fall=0.01, reference_temperature=300.0)
    torque = law.quasistatic([0.0, 1.0, 1.0], temperature=[300.0, 310.0, 290.0])
    assert torque == pytest.approx([0.0, 0.5 * exp(-0.1), 0.5 * exp(0.1)], rel=1e-14)


# A law that modulates another takes a step as it stands at its end: two halves of the step differ from the whole.
unmodulated = models("friction", "quasistatic").filter(lambda law: not hasattr(law, "law") and in_bounds(law))


@given(unmodulated, paths, st.floats(-1e2, 1e2))
def test_steps_may_be_split(law: Any, path: list[float], load: float) -> None:
    halves = np.interp(np.arange(2 * len(path) - 1) / 2.0, np.arange(len(path)), path)
    whole, split = law.quasistatic(path, load=load), law.quasistatic(halves, load=load)[::2]
    assert split == pytest.approx(whole, rel=1e-9, abs=1e-9 * np.abs(whole).max())


@given(laws.filter(in_bounds), paths, st.floats(-1e2, 1e2))
def test_rest_keeps_the_torque_and_none_is_before_the_first_motion(law: Any, path: list[float], load: float) -> None:
    assert law.quasistatic(2 * path[:1], load=load).tolist() == [0.0, 0.0]
    assert law.quasistatic([*path, path[-1]], load=load)[-2:].tolist() == 2 * [law.quasistatic(path, load=load)[-1]]


@pytest.mark.slow("physics")
@given(
    laws.filter(lambda law: not law.set_valued and not hasattr(law, "law")),
    signed(log_uniform(1e-3, 1e-1)),
    st.floats(-1e2, 1e2),
)
def test_it_is_the_trace_of_a_slow_motion(law: Any, displacement: float, load: float) -> None:
    slow = 1e-12
    trace = law.trace([0.0, abs(displacement) / slow], [np.sign(displacement) * slow] * 2, load=load)[-1]
    assert law.quasistatic([0.0, displacement], load=load)[-1] == pytest.approx(trace, rel=1e-6, abs=1e-9)


@pytest.mark.parametrize("argument", ["displacement", "load", "temperature"])
def test_what_is_not_finite_is_refused(argument: str) -> None:
    arguments = {"displacement": [0.0, 1.0], "load": 0.0, "temperature": 300.0} | {argument: [0.0, float("nan")]}
    with pytest.raises(ValueError, match=rf"{argument}\[1\] = nan is not finite"):
        friction.Coulomb(coulomb=1.0).quasistatic(**arguments)
