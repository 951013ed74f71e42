"""Friction proportional to the torque transmitted: four quadrants, and the efficiencies they stand for."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, strategies as st
from strainwave.friction import LoadDependent

LAW = LoadDependent(driving_forward=0.25, driving_reverse=0.375, backdriving_forward=0.5, backdriving_reverse=0.625)

ratios = st.floats(0.0, 3.0)
laws = st.builds(
    LoadDependent,
    driving_forward=ratios,
    driving_reverse=ratios,
    backdriving_forward=ratios,
    backdriving_reverse=ratios,
)
loads = st.floats(-1e3, 1e3)
speeds = st.floats(1e-3, 1e3)


@pytest.mark.parametrize(
    ("speed", "load", "torque"),
    [(2.0, 8.0, 2.0), (-2.0, -8.0, -3.0), (2.0, -8.0, 4.0), (-2.0, 8.0, -5.0), (2.0, 0.0, 0.0), (0.0, 8.0, 0.0)],
)
def test_each_quadrant_has_its_own_loss(speed: float, load: float, torque: float) -> None:
    assert LAW.steady(speed, load=load) == torque


@pytest.mark.parametrize(("sense", "load", "torque"), [(1.0, 8.0, 2.0), (-1.0, -8.0, 3.0), (1.0, -8.0, 4.0), (-1.0, 8.0, 5.0)])
def test_at_rest_it_holds_what_the_motion_about_to_begin_would_lose(sense: float, load: float, torque: float) -> None:
    assert LAW.hold(sense, load=load) == torque


@given(laws, loads, speeds, st.floats(1.0, 1e3))
def test_the_loss_is_proportional_to_the_load_and_independent_of_the_speed(
    law: LoadDependent, load: float, speed: float, factor: float
) -> None:
    once = law.steady(speed, load=load)
    assert law.steady(speed, load=factor * load) == pytest.approx(factor * once, rel=1e-14)
    assert law.steady(speed * factor, load=load) == once


@given(laws, speeds, loads.filter(lambda load: abs(load) > 1e-6))
def test_the_ratios_are_efficiencies(law: LoadDependent, speed: float, load: float) -> None:
    """Power out over power in: 1/(1+mu) when driving, 1-mu when back-driven."""
    for velocity, driving, backdriving in (
        (speed, law.driving_forward, law.backdriving_forward),
        (-speed, law.driving_reverse, law.backdriving_reverse),
    ):
        at_output = load * velocity
        at_input = (load + law.steady(velocity, load=load)) * velocity
        if at_output > 0.0:
            assert at_output / at_input == pytest.approx(1.0 / (1.0 + driving), rel=1e-13)
        else:
            assert at_input / at_output == pytest.approx(1.0 - backdriving, rel=1e-13, abs=1e-13)


def test_a_stiffness_times_an_efficiency_creates_energy_when_back_driven() -> None:
    """The shortcut lets the output exert eta K delta while the input feels K delta, whoever drives."""
    ratio, wound_up, speed = 0.25, 4.0, 10.0  # wound_up = K delta [N.m]
    law = LoadDependent(driving_forward=ratio, backdriving_reverse=ratio)
    efficiency = 1.0 / (1.0 + ratio)
    arrives = efficiency * wound_up

    needed = arrives + law.steady(speed, load=arrives)
    assert needed == pytest.approx(wound_up, rel=1e-15)  # driving, both agree

    given_by_output, left_by_shortcut = arrives * speed, wound_up * speed
    assert left_by_shortcut > given_by_output  # more comes out than went in
    left_by_law = (arrives + law.steady(-speed, load=arrives)) * speed
    assert left_by_law == pytest.approx((1.0 - ratio) * given_by_output, rel=1e-15)


@given(st.floats(0.0, 3.0), st.floats(1e-3, 1e3))
def test_a_gear_locks_itself_from_a_loss_of_one_on(ratio: float, load: float) -> None:
    """The load alone turns the input back only if it exceeds what is held."""
    law = LoadDependent(backdriving_reverse=ratio)
    assert (load > law.hold(-1.0, load=load)) == (ratio * load < load)


def test_by_default_nothing_is_lost() -> None:
    assert LoadDependent().steady([-1.0, 1.0], load=5.0).tolist() == [0.0, 0.0]
    assert LoadDependent().hold(load=5.0) == 0.0


def test_a_loss_below_zero_is_refused() -> None:
    with pytest.raises(ValueError, match="driving_forward"):
        LoadDependent(driving_forward=-0.1)


@given(laws, st.lists(st.tuples(st.floats(-1e3, 1e3), loads), min_size=1, max_size=8))
def test_no_quadrant_gives_power(law: LoadDependent, points: list[tuple[float, float]]) -> None:
    speed, load = np.array(points).T
    assert (law.steady(speed, load=load) * speed >= 0.0).all()
