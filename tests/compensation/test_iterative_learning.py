"""Learning over the output angle for each sense of motion: its rate per pass, the lost motion that it learns, its bounds."""

from __future__ import annotations

import numpy as np
import pytest
import strainwave as sw
from hypothesis import given, strategies as st
from numpy.typing import NDArray
from strainwave.compensation import IterativeLearning, NoLearning

from tests.compensation.ideal import DAMPING, KINEMATICS, PERIOD, STIFFNESS, state

Array = NDArray[np.float64]

CELLS, END, SPEED = 32, 0.1, 0.2  # cells, rad, rad/s of the output
WIDTH = 2.0 * END / (CELLS - 1)
BRAKE = 20.0  # N.m of friction at the output
SPRING = sw.stiffness.Linear(k=2e4)
LOOP = sw.hysteresis.MaxwellSlip(stiffness=[8e3, 4e3], breakaway=[4.0, 6.0])


def learner(**changed: float) -> IterativeLearning:
    return IterativeLearning(**({"low": -END, "high": END, "gain": 2.0, "limit": 1.0, "reach": 1e-4} | changed))


def drive(learning: IterativeLearning | NoLearning, **parts: object) -> sw.Drive:
    """A drive whose input follows its command, and whose output drags a friction through a soft gear."""
    friction = sw.friction.Coulomb(coulomb=BRAKE, breakaway=BRAKE)
    gear = sw.Gear(**({"kinematics": KINEMATICS, "stiffness": SPRING, "damping": 30.0, "friction_output": friction} | parts))  # type: ignore[arg-type]
    law = sw.control.PID(proportional=STIFFNESS, derivative=DAMPING, limit=1e9)
    control = sw.control.Sampled(law=law, period=PERIOD, compensation=sw.Compensation(learning=learning))
    return sw.Drive(gear=gear, motor=sw.motor.AccelerationSource(), load=sw.loads.Inertia(inertia=1e-2), control=control)


def passes(count: int, way: float = END + 0.02) -> sw.scenario.Scenario:
    """From the middle to one end and to and fro between both, at constant speed; beyond the tables it turns back."""
    corners = np.array([0.0] + [way if number % 2 == 0 else -way for number in range(count + 1)])
    return sw.scenario.table(np.append(0.0, np.cumsum(np.abs(np.diff(corners))) / SPEED), corners)


def tables(end: sw.State) -> tuple[Array, Array]:
    found = state(end, "learning")
    forward, backward = (np.array([found[f"{name}[{j}]"] for j in range(CELLS)]) for name in ("forward", "backward"))
    return forward, backward


def widths(end: sw.State) -> Array:
    """Lead of forward over that of backward motion, at each angle [rad]."""
    forward, backward = tables(end)
    return forward - backward


INNER = slice(4, CELLS - 4)  # after a reversal the loop of the gear is closed there


@pytest.mark.slow("physics")
@pytest.mark.parametrize("gain", [0.5, 1.0, 2.0])
def test_a_constant_lost_motion_is_learnt_at_its_rate_per_pass(gain: float) -> None:
    """Each pass over a cell of width h at speed v leaves 1 - gamma h / v, to the second order."""
    lost = 2.0 * BRAKE / 2e4
    left = [1.0]
    for count in range(1, 7):
        run = sw.simulate(drive(learner(gain=gain)), passes(2 * count), sample=0.01)
        left.append(float(np.mean(1.0 - widths(run.end)[INNER] / lost)))
    share = gain * WIDTH / SPEED
    factors = np.array(left[1:]) / np.array(left[:-1])
    assert factors[1:] == pytest.approx(1.0 - share, abs=share**2)


def test_it_learns_the_lost_motion_that_the_loop_of_the_gear_has() -> None:
    """A gear with hysteresis, dragged by friction: both branches of the loop between both torques, at every angle."""
    one = drive(learner(gain=20.0), hysteresis=LOOP)
    lost = sw.tuning.lost_motion(one.gear)
    found = widths(sw.simulate(one, passes(24), sample=0.01).end)[INNER]
    assert found == pytest.approx(lost.extent, rel=0.01)
    rigid = 2.0 * BRAKE / 2e4
    assert abs(lost.extent / rigid - 1.0) > 0.05  # the loop counts


@pytest.mark.slow("physics")
def test_the_error_after_some_passes_is_a_hundredth() -> None:
    """Of a lost motion and a kinematic error of a period of the output, where it moves at constant speed."""
    error = sw.kinematic_error.Fourier(order=[0.1], amplitude=[2e-4], phase=[0.3])
    largest = []
    for learning in (NoLearning(), learner(gain=20.0)):
        run = sw.simulate(drive(learning, hysteresis=LOOP, kinematic_error=error), passes(24), sample=0.01)
        steady = (np.abs(run["command"]) < 0.9 * END) & (run.time > run.time[-1] - 1.0)
        largest.append(float(np.abs((run["command"] - run["output_angle"])[steady]).max()))
    assert largest[1] < 0.01 * largest[0]


@pytest.mark.parametrize(
    ("changed", "learns"),
    [
        ({"min_speed": 20.5}, False),
        ({"min_speed": 19.5}, True),
        ({"max_speed": 19.5}, False),
        ({"low": 0.13, "high": 0.2}, False),
        ({"gain": 0.0}, False),
    ],
)
def test_it_learns_between_its_speeds_and_ends_only(changed: dict[str, float], learns: bool) -> None:
    """At 20 rad/s of the input, up to 0.12 rad of the output."""
    run = sw.simulate(drive(learner(**changed)), passes(1), sample=0.01)
    assert any(table.any() for table in tables(run.end)) == learns


@pytest.mark.parametrize("mode", [0, 1, 5, 31])
def test_smoothing_takes_a_wave_over_the_cells_away_at_its_rate(mode: int) -> None:
    """A pass fades a wave by sigma h (1 - cos(pi m / 32)) / v, to the second order; an end is its own neighbour."""
    sigma, count = 0.5, 10
    one = drive(learner(gain=0.0, smoothing=sigma))
    wave = 1e-5 * np.cos(np.pi * mode * (np.arange(CELLS) + 0.5) / CELLS)
    start = one.rest().replace({f"control.compensation.learning.forward[{j}]": value for j, value in enumerate(wave)})
    run = sw.simulate(one, passes(2 * count, END), sample=0.01, initial=start)
    forward, _ = tables(run.end)
    rate = sigma * WIDTH / SPEED * (1.0 - np.cos(np.pi * mode / CELLS))
    assert forward[INNER] == pytest.approx(wave[INNER] * np.exp(-rate * count), abs=0.03e-5 * (mode > 0) + 1e-12)


@pytest.mark.slow("physics")
@given(st.floats(1e-6, 2e-4), st.floats(0.0, 0.3), st.floats(0.0, 500.0), st.floats(0.0, 1e3), st.floats(1e-6, 0.1))
def test_no_value_exceeds_its_limit(limit: float, lag: float, gain: float, smoothing: float, reach: float) -> None:
    """Not even one that grows, as the lag may have it."""
    one = drive(learner(limit=limit, lag=lag, gain=gain, smoothing=smoothing, reach=reach))
    assert max(np.abs(table).max() for table in tables(sw.simulate(one, passes(1), sample=0.01).end)) <= limit


@pytest.mark.parametrize("end", [END, 5e-4])
def test_no_pass_learns_more_than_the_whole_error(end: float) -> None:
    """Nor do cells that pass within less than a period, as those of a table of 1 mrad."""
    run = sw.simulate(drive(learner(gain=1e5, low=-end, high=end), hysteresis=LOOP), passes(0), sample=1e-3)
    largest = np.abs(run["command"] - run["output_angle"]).max()
    assert 0.1 * largest < max(np.abs(table).max() for table in tables(run.end)) <= 1.01 * largest


@pytest.mark.slow("physics")
def test_within_its_guard_it_does_not_diverge() -> None:
    """The cells pass at v / h = 31 Hz at most, where the loop of (s + 100)^2 lags by two times 45 degrees below 100 rad/s."""
    run = sw.simulate(drive(learner(gain=1e3, lag=0.0), hysteresis=LOOP), passes(60), sample=0.01)
    forward, backward = tables(run.end)
    extent = sw.tuning.lost_motion(drive(NoLearning(), hysteresis=LOOP).gear).extent
    assert max(np.abs(forward).max(), np.abs(backward).max()) < 1.5 * extent


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"low": 0.1}, "high must exceed low by 1e-6 rad or more"),
        ({"reach": 0.0}, r"iterative_learning\.reach = 0 rad must lie in"),
        ({"gain": -1.0}, r"iterative_learning\.gain = -1"),
    ],
)
def test_what_is_wrong_is_refused(changed: dict[str, float], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        learner(**changed)
