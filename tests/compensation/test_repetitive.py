"""Learning over the angle of the wave generator: any shape is learnt, neighbours are evened out at a known rate."""

from __future__ import annotations

import numpy as np
import pytest
import strainwave as sw
from hypothesis import given, settings, strategies as st
from numpy.typing import NDArray
from strainwave.compensation import Repetitive

from tests.compensation.ideal import PERIOD, RATIO, Course, following, state
from tests.support.each import each
from tests.support.samples import sample

Array = NDArray[np.float64]

CELLS = 32
NONE = sw.kinematic_error.Fourier()


def learning(**changed: float) -> Repetitive:
    return Repetitive(**({"gain": 40.0, "max_speed": 100.0, "min_speed": 1.0, "limit": 1.0} | changed))


def peaks(course: Course) -> list[float]:
    """The largest error of each turn, without its mean [rad]."""
    return [float(np.abs(course.error[at] - course.error[at].mean()).max()) for at in course.turns()]


@pytest.mark.slow("physics")
@each("order", [1.0, 2.0, 3.0, 4.0])
def test_the_error_of_a_low_order_falls_by_nine_tenths(order: float) -> None:
    """Waves of the highest order have 40 rad/s; the loop follows those with a lag of some milliseconds."""
    error = sw.kinematic_error.Fourier(order=[order], amplitude=[1e-4], phase=[0.7])
    first, *_, last = peaks(Course.at(following(error, learning()), -10.0, 30.0))
    assert last < 0.1 * first


@pytest.mark.slow("physics")
@settings(max_examples=sample(4, 40))
@given(st.lists(st.tuples(st.floats(0.1, 1.0), st.floats(-3.1, 3.1)), min_size=4, max_size=4))
def test_any_shape_of_low_orders_is_learnt(drawn: list[tuple[float, float]]) -> None:
    amplitude, phase = zip(*drawn, strict=True)
    error = sw.kinematic_error.Fourier(
        order=[1.0, 2.0, 3.0, 4.0], amplitude=[1e-4 * each for each in amplitude], phase=list(phase)
    )
    first, *_, last = peaks(Course.at(following(error, learning()), 10.0, 30.0))
    assert last < 0.1 * first


def values(start: sw.State) -> Array:
    found = state(start, "learning")
    return np.array([found[f"value[{j}]"] for j in range(CELLS)])


@pytest.mark.slow("physics")
@each("mode", [0, 1, 4, 8, 16])
def test_smoothing_takes_a_wave_over_the_cells_away_at_its_rate(mode: int) -> None:
    """A cell fades to its neighbours while it is passed, a 32nd of a turn: sigma (1 - cos(2 pi m / 32)) / 32."""
    sigma, speed, duration = 2.0, 20.0, 10.0
    drive = following(NONE, learning(gain=0.0, smoothing=sigma))
    wave = 1e-4 * np.cos(2.0 * np.pi * mode * np.arange(CELLS) / CELLS)
    rest = drive.rest().replace({f"control.compensation.learning.value[{j}]": value for j, value in enumerate(wave)})
    rest = rest.replace(input_speed=speed, output_speed=speed / RATIO)
    after = values(Course.at(drive, speed, duration, initial=rest).run.end)
    rate = sigma * (1.0 - np.cos(2.0 * np.pi * mode / CELLS)) / CELLS
    assert after == pytest.approx(wave * np.exp(-rate * duration), abs=0.05e-4 * (mode > 0))


def test_what_it_holds_is_interpolated_between_the_cells() -> None:
    """The input leads by ratio times the hat functions: what a slow motion shows of its values."""
    drive = following(NONE, learning(gain=0.0))
    table = 1e-4 * np.random.default_rng(3).uniform(-1.0, 1.0, CELLS)
    start = drive.rest().replace({f"control.compensation.learning.value[{j}]": value for j, value in enumerate(table)})
    speed = -0.5
    run = sw.simulate(drive, sw.scenario.ramp(speed / RATIO, 15.0), sample=PERIOD, initial=start)
    place = np.mod(run["input_angle"] * CELLS / (2.0 * np.pi), CELLS)
    wanted = np.interp(place, np.arange(CELLS + 1), np.append(table, table[0]))
    lead = run["output_angle"] - run["command"]
    settled = run.time > 1.0
    assert lead[settled] == pytest.approx(wanted[settled], abs=1e-5)  # the corners are rounded as the loop lags
    assert np.corrcoef(lead[settled], wanted[settled])[0, 1] > 0.999


@pytest.mark.parametrize(
    ("changed", "learns"),
    [
        ({"max_speed": 9.9}, False),
        ({"min_speed": 10.1}, False),
        ({"gain": 0.0}, False),
        ({"min_speed": 9.9, "max_speed": 10.1}, True),
    ],
)
def test_it_learns_between_min_speed_and_max_speed_only(changed: dict[str, float], learns: bool) -> None:
    error = sw.kinematic_error.Fourier(order=[2.0], amplitude=[1e-4], phase=[0.7])
    found = values(Course.at(following(error, learning(**changed)), -10.0, 0.5).run.end)
    assert bool(found.any()) == learns


@pytest.mark.slow("physics")
@given(st.floats(1e-6, 2e-4), st.floats(0.0, 0.3), st.floats(0.0, 500.0), st.floats(0.0, 1e4))
def test_no_value_exceeds_its_limit(limit: float, lag: float, gain: float, smoothing: float) -> None:
    """Not even one that grows, as the lag may have it."""
    error = sw.kinematic_error.Fourier(order=[2.0], amplitude=[1e-4], phase=[0.7])
    drive = following(error, learning(limit=limit, lag=lag, gain=gain, smoothing=smoothing))
    assert np.abs(values(Course.at(drive, -10.0, 1.0).run.end)).max() <= limit
