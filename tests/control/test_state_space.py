"""Any linear controller as matrices."""

from __future__ import annotations

import numpy as np
import pytest
import strainwave as sw
from scipy.linalg import expm

from tests.control import by_hand
from tests.control.discrete import DC, PROMPT, TIMES, TORQUE, check, drive

# Eight states, all inputs: random, and stable by a shift.
DRAWN = np.random.default_rng(7)
FULL = sw.control.StateSpace(
    A=(DRAWN.normal(size=(8, 8)) * 20.0 - 100.0 * np.eye(8)).ravel(),
    B=DRAWN.normal(size=64) * 3.0,
    C=DRAWN.normal(size=8) * 0.3,
    D=[0.5, 0.01, 2.0, 0.1, -0.2, -0.03, 0.1, 0.02],
    tracking=DRAWN.normal(size=8),
)
COMMAND = sw.scenario.sine(0.3, 4.0, 0.2)


@pytest.mark.parametrize(("period", "delay", "dt"), TIMES)
@pytest.mark.parametrize("limit", [48.0, 0.4], ids=["free", "limited"])
@pytest.mark.parametrize("motor", [DC, PROMPT], ids=["inductance", "none"])
def test_sampled_it_is_the_recursion(period: float, delay: float, dt: float, limit: float, motor: object) -> None:
    law = FULL.replace(limit=limit)
    wanted = check(law, by_hand.StateSpace(law, period), motor, period, delay, dt)
    assert (np.abs(wanted["actuation"]).max() == limit) == (limit < 1.0)


def test_without_states_it_is_a_state_feedback() -> None:
    gains = {"input_angle": 0.5, "input_speed": 0.01, "output_angle": 2.0, "output_speed": 0.1}
    one, other = sw.control.StateSpace(D=list(gains.values())), sw.control.StateFeedback(**gains)
    runs = [sw.simulate(drive(law, TORQUE), COMMAND, sample=1e-3)["output_angle"] for law in (one, other)]
    assert runs[0] == pytest.approx(runs[1], rel=1e-12, abs=1e-15)


def test_continuous_it_is_a_lead_lag() -> None:
    """k (1 + a_1 s)/(1 + b_1 s) (1 + a_2 s)/(1 + b_2 s) with the lags of the sections as states."""
    k, a1, b1, a2, b2 = 0.8, 0.03, 0.004, 0.1, 0.5
    jumps = a1 / b1, a2 / b2
    # lead = x1 + j1 (y - x1), u = k (x2 + j2 (lead - x2))
    one = sw.control.StateSpace(
        A=[-1.0 / b1, 0.0, (1.0 - jumps[0]) / b2, -1.0 / b2],
        B=[1.0 / b1, jumps[0] / b2],
        C=[k * jumps[1] * (1.0 - jumps[0]), k * (1.0 - jumps[1])],
        D=[k * jumps[0] * jumps[1]],
    )
    other = sw.control.LeadLag(gain=k, lead_numerator=a1, lead_denominator=b1, lag_numerator=a2, lag_denominator=b2)
    runs = [sw.simulate(drive(law), COMMAND, 2e-5, sample=1e-3)["output_angle"] for law in (one, other)]
    assert runs[0] == pytest.approx(runs[1], abs=1e-12 * np.abs(runs[1]).max())


def test_a_controller_of_discrete_time_is_exact() -> None:
    """As the text says: A = (A_d - 1)/T gives the powers of A_d, here of a turn by 0.3 rad and a lag of 5 ms."""
    period, turn = 1e-3, np.array([[np.cos(0.3), -np.sin(0.3)], [np.sin(0.3), np.cos(0.3)]])
    step = np.zeros((3, 3))
    step[:2, :2], step[2, 2] = turn, np.exp(-period / 5e-3)
    law = sw.control.StateSpace(
        A=((step - np.eye(3)) / period).ravel(),
        B=[2.0 / period, -1.0 / period, 1.0 / period],
        C=[1.0, 0.5, -1.0],
        D=[0.0],
        limit=1e3,
    )
    # so heavy that the motor does not move, and the input of the law is 20 times 0.05
    heavy = drive(sw.control.Sampled(law=law, period=period), sw.motor.TorqueSource(inertia=1e12))
    run = sw.simulate(heavy, sw.scenario.constant(0.05, 0.03), sample=period)
    x, wanted = np.zeros(3), [0.0]
    for _ in range(len(run.time) - 1):
        wanted.append(float(np.array([1.0, 0.5, -1.0]) @ x))
        x = step @ x + np.array([2.0, -1.0, 1.0])
    assert run["motor_torque"][1:] == pytest.approx(np.array(wanted[1:]), rel=1e-9, abs=1e-9)


def test_tracking_ends_the_windup_of_an_integral() -> None:
    """At its limit the integral of a PI stops where the unlimited output exceeds the limit by error / tracking."""
    gain, integral, limit, tracking = 0.5, 3.0, 0.4, 40.0
    plain = {"A": [0.0], "B": [1.0], "C": [integral], "D": [gain], "limit": limit}
    heavy = sw.motor.TorqueSource(inertia=1e12)
    ends = []
    for law in (sw.control.StateSpace(**plain), sw.control.StateSpace(**plain, tracking=[tracking])):
        run = sw.simulate(drive(law, heavy), sw.scenario.constant(0.1, 2.0), sample=0.1)
        ends.append(run.end["control.value[0]"])
    error = 0.1 * 20.0
    assert ends[0] == pytest.approx(2.0 * error, rel=1e-6)
    # 0 = error + tracking (limit - gain error - integral x)
    assert ends[1] == pytest.approx((error / tracking + limit - gain * error) / integral, rel=1e-6)


def test_steps_follow_its_fastest_state() -> None:
    """The longest step follows from the eigenvalues, not from the elements: other coordinates change nothing."""
    slow = np.diag([-30.0, -40.0])
    turned = np.array([[1.0, 1e4], [0.0, 1.0]])
    skew = turned @ slow @ np.linalg.inv(turned)
    runs = [
        sw.simulate(drive(sw.control.StateSpace(A=matrix.ravel(), B=[0.0, 0.0], C=[0.0, 0.0], D=[0.1]), TORQUE), COMMAND, 5e-3)
        for matrix in (slow, skew)
    ]
    assert runs[0]["output_angle"] == pytest.approx(runs[1]["output_angle"], abs=1e-15)
    fast = sw.control.StateSpace(A=[-1e5], B=[0.0], C=[0.0], D=[0.1])
    with pytest.raises(FloatingPointError, match=r"take dt = 2\.5e-05 s or less"):
        sw.simulate(drive(fast, TORQUE), COMMAND, 5e-3)


def test_its_states_decay_as_the_exponential_of_its_matrix() -> None:
    a = np.array([[-3.0, 50.0], [-40.0, -6.0]])
    law = sw.control.StateSpace(A=a.ravel(), B=[1.0, 2.0], C=[0.0, 0.0], D=[0.0])
    run = sw.simulate(drive(law, TORQUE), sw.scenario.constant(0.05, 0.1), 1e-4, sample=0.1)
    whole = np.zeros((3, 3))
    whole[:2, :2], whole[:2, 2] = a, np.array([1.0, 2.0])
    assert [run.end[f"control.value[{k}]"] for k in range(2)] == pytest.approx(expm(whole * 0.1)[:2, 2], rel=1e-9)


@pytest.mark.parametrize(
    ("members", "words"),
    [
        ({"A": [1.0, 2.0], "B": [1.0], "C": [1.0], "D": [0.0]}, "A has 2 elements; with 1 states"),
        ({"A": [1.0], "B": [1.0, 2.0], "C": [1.0], "D": [0.0]}, "B has 2 elements .* 1"),
        ({"A": [1.0], "B": [1.0], "C": [1.0], "D": [0.0], "tracking": [1.0, 2.0]}, "tracking has 2 elements"),
        ({"C": [1.0] * 9}, "8"),
    ],
)
def test_sizes_that_do_not_agree_are_refused(members: dict[str, list[float]], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        sw.control.StateSpace(**members)
