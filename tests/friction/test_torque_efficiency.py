"""The Dahl-like efficiency law: how it turns round, what it equals in steady motion, and what energy it can return."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, strategies as st
from numpy.typing import NDArray
from scipy.integrate import cumulative_simpson
from strainwave.friction import LoadDependent, TorqueEfficiency

from tests.support.strategies import made

LAW = TorqueEfficiency(average_loss=0.3, difference_loss=0.1, presliding=0.01, viscous=0.0)
SPEED = 0.5  # rad/s

losses = st.tuples(st.floats(0.0, 2.0), st.floats(-1.0, 1.0)).map(lambda drawn: (drawn[0], drawn[0] * drawn[1]))
loads = st.floats(-100.0, 100.0)


def legs(law: TorqueEfficiency, turns: list[float], load: float, samples: int = 401) -> tuple[NDArray[np.float64], float]:
    """Torque [N.m] along a path in angle [rad] from rest at 0 through all turns, and the work [J] put in."""
    start = time = 0.0
    times, speeds = [], []
    for turn in turns:
        duration = abs(turn - start) / SPEED
        times.append(np.linspace(time + 1e-9 * duration, time + duration, samples))
        speeds.append(np.full(samples, math.copysign(SPEED, turn - start)))
        start, time = turn, time + duration
    torque = law.trace(np.concatenate(times), np.concatenate(speeds), load=load).reshape(len(turns), samples)
    work = sum(float(cumulative_simpson(row * v[0], x=t)[-1]) for row, v, t in zip(torque, speeds, times, strict=True))
    return torque, work


@pytest.mark.parametrize(("speed", "load"), [(3.0, 5.0), (-3.0, 5.0), (3.0, -5.0), (-3.0, -5.0)])
def test_steady_motion_loses_what_driving_and_back_driving_lose(speed: float, load: float) -> None:
    quadrants = LoadDependent(driving_forward=0.4, driving_reverse=0.4, backdriving_forward=0.2, backdriving_reverse=0.2)
    assert LAW.steady(speed, load=load) == pytest.approx(quadrants.steady(speed, load=load), rel=1e-14)


@given(losses, loads, st.floats(1e-3, 1e3))
def test_two_losses_and_their_mean_and_half_difference_are_the_same_thing(
    loss: tuple[float, float], load: float, speed: float
) -> None:
    law = made(TorqueEfficiency, average_loss=loss[0], difference_loss=loss[1])
    with_load, against_load = (abs(law.steady(math.copysign(1.0, load) * v, load=load)) for v in (speed, -speed))
    assert with_load + against_load == pytest.approx(2.0 * loss[0] * abs(load), rel=1e-13, abs=1e-300)
    assert with_load - against_load == pytest.approx(2.0 * loss[1] * abs(load), abs=1e-14 * loss[0] * abs(load) + 1e-300)


def test_the_loss_builds_up_over_the_presliding_angle() -> None:
    angle = np.array([0.0, 0.002, 0.01, 0.05])
    torque = LAW.trace(angle / SPEED, np.full(4, SPEED), load=5.0)
    z = 1.0 - np.exp(-angle / 0.01)
    np.testing.assert_allclose(torque, 1.5 * z + 0.5 * z**2, rtol=1e-13, atol=1e-16)


def test_the_loss_turns_round_over_the_presliding_angle() -> None:
    angle = np.array([0.0, 0.002, 0.01, 0.05])
    engaged = TorqueEfficiency.State(engagement=1.0)
    torque = LAW.trace(angle / SPEED, np.full(4, -SPEED), load=5.0, state=engaged)
    z = 2.0 * np.exp(-angle / 0.01) - 1.0
    np.testing.assert_allclose(torque, 1.5 * z + 0.5 * z**2, rtol=1e-12, atol=1e-15)


def test_how_fast_the_path_is_run_through_does_not_matter() -> None:
    speed = np.array([1.0, -2.0, 0.5, 3.0, -4.0])
    slow, fast = (LAW.trace(0.004 * np.arange(5) / pace, speed * pace, load=5.0) for pace in (1e-3, 1e3))
    np.testing.assert_allclose(slow, fast, rtol=1e-12)


@given(losses, loads, st.lists(st.integers(-30, 30).filter(bool), min_size=1, max_size=6, unique=True))
def test_under_constant_load_no_path_from_rest_yields_work(loss: tuple[float, float], load: float, turns: list[int]) -> None:
    law = LAW.replace(average_loss=loss[0], difference_loss=loss[1])
    path = [1e-3 * turn for turn in turns]
    torque, work = legs(law, path, load)
    travelled = float(np.abs(np.diff([0.0, *path])).sum())
    assert work >= -1e-7 * np.abs(torque).max() * travelled  # Simpson's rule, and the start of each leg left out


def test_a_load_put_on_before_the_way_back_is_paid_for_by_who_puts_it_on() -> None:
    """Engaged without load, then loaded at rest: the way back to z = 0 returns mu T h (1 - ln 2), less than what z stores."""
    law = TorqueEfficiency(average_loss=0.3, presliding=0.01, viscous=0.0)
    angle = np.linspace(0.0, 0.01 * math.log(2.0), 2001)
    engaged = TorqueEfficiency.State(engagement=1.0)
    torque = law.trace(angle / SPEED, np.full(2001, -SPEED), load=5.0, state=engaged)
    returned = float(cumulative_simpson(torque, x=angle)[-1])
    assert returned == pytest.approx(0.3 * 5.0 * 0.01 * (1.0 - math.log(2.0)), rel=1e-10)
    assert returned < 0.3 * 5.0 * 0.01 / 2.0


def test_a_loss_that_would_create_energy_in_steady_motion_is_refused() -> None:
    for difference in (0.31, -0.31):
        with pytest.raises(ValueError, match="average_loss"):
            made(TorqueEfficiency, average_loss=0.3, difference_loss=difference)
    made(TorqueEfficiency, average_loss=0.3, difference_loss=-0.3)


def test_viscous_friction_adds_to_it() -> None:
    assert LAW.replace(viscous=0.01).steady(-20.0) == pytest.approx(-0.2, rel=1e-15)
