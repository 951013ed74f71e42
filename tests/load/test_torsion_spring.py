"""Spring and pendulum: where they rest, and how they swing."""

from __future__ import annotations

import numpy as np
import pytest
import strainwave as sw
from hypothesis import given, strategies as st
from scipy.special import ellipj, ellipk

from tests.load.free import free, held, placed, run_of
from tests.support.geared import K, outputs

SPRING = sw.loads.TorsionSpring(inertia=0.05, stiffness=200.0, damping=0.0, rest_angle=0.3)
ARM = sw.loads.Pendulum(inertia=0.5, gravity_torque=15.0)


@given(angle=st.floats(-3.0, 3.0), speed=st.floats(-10.0, 10.0))
def test_the_torque_of_a_spring_is_that_of_its_turn_and_its_speed(angle: float, speed: float) -> None:
    drive = held(SPRING.replace(damping=0.7))
    shown = outputs(drive, placed(drive, angle, speed))
    assert shown["load_torque"] == pytest.approx(200.0 * (angle - 0.3) + 0.7 * speed, rel=1e-12, abs=1e-12)


@pytest.mark.parametrize("push", [-30.0, 0.0, 12.0])
def test_a_spring_rests_where_it_balances_the_gear_and_the_load_torque(push: float) -> None:
    """K (-theta) = k (theta - theta_0) + M, with the input at rest at 0."""
    drive = held(SPRING.replace(damping=50.0), damping=50.0)
    run = run_of(drive, 2.0, 1e-4, load_torque=push, sample=2.0)
    angle = (200.0 * 0.3 - push) / (K + 200.0)
    assert run["output_angle"][-1] == pytest.approx(angle, rel=1e-9)
    assert run["load_torque"][-1] == pytest.approx(200.0 * (angle - 0.3) + push, rel=1e-9)


def test_a_spring_in_the_output_vibrates_beside_that_of_the_gear() -> None:
    """J theta'' = -(K + k) theta about the equilibrium."""
    drive = held(SPRING)
    rest = 200.0 * 0.3 / (K + 200.0)
    run = run_of(drive, 0.2, 1e-5, placed(drive, rest + 0.01), sample=1e-4)
    w = np.sqrt((K + 200.0) / 0.05)
    assert run["output_angle"] == pytest.approx(rest + 0.01 * np.cos(w * run.time), abs=1e-8)


def test_a_spring_alone_vibrates_and_its_damper_stops_it() -> None:
    """Logarithmic decrement of a damping ratio c / (2 sqrt(k J)) = 0.05."""
    damping = 2.0 * 0.05 * np.sqrt(200.0 * 0.05)
    drive = free(SPRING.replace(damping=damping))
    run = run_of(drive, 0.5, 1e-4, placed(drive, 0.4))
    w = np.sqrt(200.0 / 0.05)
    damped, decay = w * np.sqrt(1.0 - 0.05**2), 0.05 * w
    wanted = 0.3 + 0.1 * np.exp(-decay * run.time) * (np.cos(damped * run.time) + decay / damped * np.sin(damped * run.time))
    assert run["output_angle"] == pytest.approx(wanted, abs=1e-7)


def test_what_a_spring_takes_it_holds_and_what_its_damper_takes_is_gone() -> None:
    damping = 1.5
    drive = free(SPRING.replace(damping=damping))
    run = run_of(drive, 0.2, 1e-4, placed(drive, 0.4))
    elastic = 100.0 * (run["output_angle"] - 0.3) ** 2
    dissipated = np.append(0.0, np.cumsum(damping * 0.5e-4 * (run["output_speed"][1:] ** 2 + run["output_speed"][:-1] ** 2)))
    assert run["energy_load"] == pytest.approx(elastic - elastic[0] + dissipated, abs=1e-4 * elastic[0])
    kinetic = 0.025 * run["output_speed"] ** 2
    assert kinetic + run["energy_load"] == pytest.approx(0.0, abs=1e-7 * elastic[0])


# Pendulum


@pytest.mark.parametrize("thrown", [0.1, 1.5, 3.0])
def test_a_pendulum_swings_as_the_elliptic_functions_say(thrown: float) -> None:
    """sin(theta/2) = k sn(w t + K(k), k), k = sin(thrown/2), w^2 = m g l / J: of small swings and large ones."""
    drive = free(ARM)
    run = run_of(drive, 2.0, 2e-4, placed(drive, thrown), sample=1e-2)
    m = np.sin(0.5 * thrown) ** 2
    sn, *_ = ellipj(np.sqrt(15.0 / 0.5) * run.time + ellipk(m), m)
    assert run["output_angle"] == pytest.approx(2.0 * np.arcsin(np.sqrt(m) * sn), abs=1e-7)


def test_a_pendulum_on_the_gear_rests_where_the_gear_holds_it() -> None:
    """K (theta_0 - theta) = m g l sin theta."""
    start = 1.2
    drive = held(ARM, damping=60.0)
    state = placed(drive, start).replace(input_angle=0.0)
    run = sw.simulate(drive, sw.scenario.constant(0.0, 1.0), 1e-4, initial=state, load_torque=0.0, sample=1.0)
    assert run["output_angle"][-1] == pytest.approx(0.0, abs=1e-9)
    pushed = run_of(drive, 1.0, 1e-4, load_torque=-5.0, sample=1.0)["output_angle"][-1]
    assert K * pushed + 15.0 * np.sin(pushed) == pytest.approx(5.0, rel=1e-9)


def test_small_swings_of_a_pendulum_on_the_gear_have_both_stiffnesses() -> None:
    drive = held(ARM)
    run = run_of(drive, 0.2, 1e-5, placed(drive, 1e-5), sample=1e-4)
    w = np.sqrt((K + 15.0) / 0.5)
    assert run["output_angle"] == pytest.approx(1e-5 * np.cos(w * run.time), abs=1e-11)
