"""Learning order by order: the rate that averaging predicts, growth beyond 90 degrees, and where it stands still."""

from __future__ import annotations

import numpy as np
import pytest
import strainwave as sw
from hypothesis import given, strategies as st
from strainwave.compensation import AdaptiveFourier

from tests.compensation.ideal import DAMPING, STIFFNESS, Course, followed, following, state

ORDER, GAIN = 2.0, 1.0
ERROR = sw.kinematic_error.Fourier(order=[ORDER], amplitude=[1e-4], phase=[0.7])
LAGS = [0.0, 0.002, 0.02, 0.03, 0.045, 0.06]  # s: at 40 rad/s up to 137 degrees from what the loop has


def learning(**changed: object) -> AdaptiveFourier:
    return AdaptiveFourier(**({"order": [ORDER], "gain": GAIN, "max_frequency": 1e3, "min_speed": 1.0, "limit": 1.0} | changed))  # type: ignore[arg-type]


@pytest.mark.parametrize("speed", [-20.0, 20.0, -10.0])
@pytest.mark.parametrize("lag", LAGS)
def test_an_error_decays_and_grows_at_the_rate_of_averaging(speed: float, lag: float) -> None:
    """gamma / 2 |P| cos(Delta), to a share of gamma over the frequency."""
    times, waves = Course.at(following(ERROR, learning(lag=lag)), speed, 4.0).waves(ORDER)
    frequency = ORDER * abs(speed)
    wanted = -0.5 * GAIN * (followed(frequency) * np.exp(1j * frequency * lag)).real
    rate = np.polyfit(times[2:], np.log(np.abs(waves[2:])), 1)[0]
    assert rate == pytest.approx(wanted, abs=0.5 * GAIN * GAIN / frequency + 0.003)


def test_beyond_ninety_degrees_some_of_these_lags_make_it_grow() -> None:
    signs = [np.cos(np.angle(followed(40.0)) + 40.0 * lag) > 0.0 for lag in LAGS]
    assert signs == [True] * 4 + [False] * 2


@pytest.mark.slow("physics")
def test_it_leaves_nothing_of_an_error_of_four_orders() -> None:
    """Orders 2 and 2.02 drift apart at 0.4 rad/s: no gain above that learns them faster. So small waves do not make others."""
    orders = [1.0, 2.0, 2.02, 4.0]
    error = sw.kinematic_error.Fourier(order=orders, amplitude=[5e-6, 1e-5, 2.5e-6, 2.5e-6], phase=[0.1, 0.7, -2.0, 1.3])
    course = Course.at(following(error, learning(order=orders, gain=0.4)), -20.0, 60.0)
    (first, *_, last) = (np.abs(course.error[at]).max() for at in course.turns())
    assert last < 1e-2 * first
    found = state(course.run.end, "learning")
    waves = np.array([found[f"sine[{n}]"] + 1j * found[f"cosine[{n}]"] for n in range(4)])
    wanted = np.array(error.amplitude) * np.exp(1j * np.array(error.phase))
    turned = np.conj([followed(20.0 * n) for n in orders])  # the input turns backwards
    assert np.abs(waves * turned - wanted).max() < 1e-2 * np.abs(wanted).max()


@pytest.mark.parametrize(
    ("changed", "learns"),
    [
        ({"max_frequency": 39.0}, False),
        ({"max_frequency": 41.0}, True),
        ({"min_speed": 20.5}, False),
        ({"min_speed": 19.5}, True),
        ({"gain": 0.0}, False),
    ],
)
def test_it_learns_between_min_speed_and_max_frequency_only(changed: dict[str, float], learns: bool) -> None:
    """At 20 rad/s waves of order 2 have 40 rad/s."""
    found = state(Course.at(following(ERROR, learning(**changed)), -20.0, 0.5).run.end, "learning")
    assert any(found.values()) == learns


@given(st.floats(1e-6, 2e-4), st.floats(0.0, 0.2), st.floats(0.0, 200.0))
def test_no_amplitude_exceeds_its_limit(limit: float, lag: float, gain: float) -> None:
    """Not even one that grows."""
    drive = following(ERROR, learning(limit=limit, lag=lag, gain=gain))
    found = state(Course.at(drive, -20.0, 0.5).run.end, "learning")
    assert max(map(abs, found.values())) <= limit


def test_after_a_million_turns_it_learns_as_after_none() -> None:
    """The angle of an order that no turn repeats is kept whole: no digit of it is lost in the number of turns."""
    error = sw.kinematic_error.Fourier(order=[2.0], amplitude=[1e-4], phase=[0.7])
    found = []
    for turns in (0, 1_000_000):
        angle = -2.0 * np.pi * turns
        start = {"input_angle": angle, "input_speed": -20.0, "output_angle": angle / -100.0, "output_speed": 0.2}
        command = sw.scenario.ramp(0.2, 1.0) + sw.scenario.constant(angle / -100.0, 1.0)
        run = sw.simulate(following(error, learning(gain=10.0)), command, sample=1e-3, initial=start)
        found.append([*state(run.end, "learning").values()])
    assert found[1] == pytest.approx(found[0], abs=1e-8)


def test_order_zero_is_an_integral_of_the_error() -> None:
    """A load twists the gear by a constant. It decays as exp(s t) with s (s + 100)^2 + gamma 100^2 = 0, at rest, too."""
    drive = following(sw.kinematic_error.Fourier(), learning(order=[0.0], gain=2.0, min_speed=0.0))
    run = sw.simulate(drive, sw.scenario.constant(0.0, 3.0), load_torque=10.0, sample=1e-3)
    late = run.time > 0.5
    rate = np.polyfit(run.time[late], np.log(np.abs(run["command"] - run["output_angle"])[late]), 1)[0]
    slowest = max(np.roots([1.0, DAMPING, STIFFNESS, 2.0 * STIFFNESS]).real)
    assert rate == pytest.approx(slowest, rel=2e-3)


def test_what_is_wrong_is_refused() -> None:
    with pytest.raises(ValueError, match=r"adaptive_fourier\.order\[0\] = -1 must lie in"):
        AdaptiveFourier(order=[-1.0])
    with pytest.raises(ValueError, match="4"):
        AdaptiveFourier(order=[1.0, 2.0, 3.0, 4.0, 5.0])
