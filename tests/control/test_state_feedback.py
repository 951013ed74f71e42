"""Feedback of all that is measured."""

from __future__ import annotations

import numpy as np
import pytest
import strainwave as sw
from scipy.linalg import solve_continuous_are
from scipy.signal import place_poles

from tests.control import by_hand
from tests.control.discrete import DAMPING, DC, PROMPT, RATIO, SPRING, TIMES, TORQUE, Plant, check, drive

LAW = sw.control.StateFeedback(
    input_angle=0.5, input_speed=0.01, output_angle=2.0, output_speed=0.1, current=0.2, torque=0.03, limit=48.0
)


@pytest.mark.parametrize(("period", "delay", "dt"), TIMES)
@pytest.mark.parametrize("limit", [48.0, 0.4], ids=["free", "limited"])
@pytest.mark.parametrize("motor", [DC, PROMPT], ids=["inductance", "none"])
def test_sampled_it_is_the_recursion(period: float, delay: float, dt: float, limit: float, motor: object) -> None:
    law = LAW.replace(limit=limit)
    wanted = check(law, by_hand.StateFeedback(law), motor, period, delay, dt)
    assert (np.abs(wanted["actuation"]).max() == limit) == (limit < 1.0)


PLACED = np.array([-30.0 + 40.0j, -30.0 - 40.0j, -60.0, -80.0])


def close(found: np.ndarray, wanted: np.ndarray) -> bool:
    """The same numbers in any order, to 1e-7 of the largest."""
    return all(np.abs(found - each).min() < 1e-7 * np.abs(wanted).max() for each in wanted) and len(found) == len(wanted)


def test_its_poles_are_where_they_were_placed() -> None:
    """Placed by SciPy for the matrices by hand."""
    a, b = Plant(TORQUE).matrices
    k = place_poles(a[1:, 1:], b[1:, None], PLACED).gain_matrix[0]
    law = sw.control.StateFeedback(input_angle=k[0], input_speed=k[1], output_angle=k[2], output_speed=k[3], limit=1e6)
    assert close(sw.linearise(drive(law, TORQUE)).poles, PLACED)


def test_so_they_are_with_the_current_of_a_winding() -> None:
    a, b = Plant(DC).matrices
    wanted = np.append(PLACED, -2000.0)
    k = place_poles(a, b[:, None], wanted).gain_matrix[0]
    law = sw.control.StateFeedback(
        current=k[0], input_angle=k[1], input_speed=k[2], output_angle=k[3], output_speed=k[4], limit=1e6
    )
    assert close(sw.linearise(drive(law)).poles, wanted)


def test_poles_of_an_inertia_alone_have_a_closed_form() -> None:
    """J s^2 + k_2 s + k_1 = 0: k_1 = J w^2, k_2 = 2 zeta w J."""
    inertia = TORQUE.inertia + 0.05 / RATIO**2
    width, ratio = 20.0, 0.6
    law = sw.control.StateFeedback(input_angle=inertia * width**2, input_speed=2.0 * ratio * width * inertia)
    stiff = drive(law, TORQUE).replace({"gear.stiffness.k": 1e9, "gear.damping": 0.0})
    found = sw.linearise(stiff).poles[:2]
    wanted = width * np.array([-ratio + 1j * np.sqrt(1.0 - ratio**2), -ratio - 1j * np.sqrt(1.0 - ratio**2)])
    for pole in wanted:
        assert np.abs(found - pole).min() < 1e-5 * width


def test_the_torque_it_takes_is_that_of_the_gear() -> None:
    """A gain of the torque is one of twist and twist rate."""
    by_torque = sw.control.StateFeedback(input_angle=0.4, input_speed=0.01, torque=0.05)
    by_motion = sw.control.StateFeedback(
        input_angle=0.4 + 0.05 * SPRING / RATIO,
        input_speed=0.01 + 0.05 * DAMPING / RATIO,
        output_angle=-0.05 * SPRING,
        output_speed=-0.05 * DAMPING,
    )
    one, other = (sw.linearise(drive(law, TORQUE)).poles for law in (by_torque, by_motion))
    assert close(one, other)


def test_a_regulator_designed_from_the_linear_view_has_its_poles() -> None:
    """As the text says: the matrices of `linearise`, a linear-quadratic regulator, the gains."""
    linear = sw.linearise(drive(sw.control.OpenLoop(), TORQUE))
    order = [linear.states.index(name) for name in ("input_angle", "input_speed", "transmission_error", "output_speed")]
    a, b = linear.A[np.ix_(order, order)], linear.B[order, :1]
    weight = np.diag([1.0, 1e-3, 1e3, 1.0])
    k = (b.T @ solve_continuous_are(a, b, weight, np.eye(1)))[0]
    # transmission error = theta_in / i - theta_out
    law = sw.control.StateFeedback(
        input_angle=k[0] + k[2] / RATIO, input_speed=k[1], output_angle=-k[2], output_speed=k[3], limit=1e6
    )
    assert close(sw.linearise(drive(law, TORQUE)).poles, np.linalg.eigvals(a - b @ k[None]))


def test_it_comes_to_rest_where_it_is_told_to() -> None:
    law = sw.control.StateFeedback(input_angle=0.02, input_speed=0.004, output_angle=0.1, output_speed=0.02)
    run = sw.simulate(drive(law, TORQUE), sw.scenario.constant(0.7, 5.0), sample=0.1)
    assert run["output_angle"][-1] == pytest.approx(0.7, rel=1e-6)
    assert run["motor_torque"][-1] == pytest.approx(0.0, abs=1e-8)
