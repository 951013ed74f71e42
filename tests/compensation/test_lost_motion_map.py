"""A map of lost motion: its lines, its ends, and how the lead goes over from one to the other after a reversal."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, strategies as st
from numpy.typing import NDArray
from strainwave.compensation import LostMotionMap

Array = NDArray[np.float64]

RATIO, PERIOD = -100.0, 1e-3
MAP = LostMotionMap(angle=[-0.5, 0.0, 1.0], forward=[3e-4, 1e-4, 2e-4], backward=[-1e-4, -2e-4, 2e-4], reach=1e-3)


def leads(law: LostMotionMap, angle: Array, ratio: float = RATIO) -> Array:
    """Lead at the output [rad]."""
    lead, _, torque, friction = law.requests(angle, np.zeros(angle.size), ratio, PERIOD)
    assert not torque.any()
    assert not friction.any()
    return lead / ratio


@given(st.lists(st.floats(-2.0, 2.0), min_size=1, max_size=50), st.sampled_from([-100.0, 101.0]))
def test_far_beyond_its_reach_it_is_the_line_of_the_sense_of_motion(path: list[float], ratio: float) -> None:
    """Interpolated, and constant beyond the ends; in the middle of both before the first motion."""
    angle = np.array(path)
    angle = angle[np.append(True, np.abs(np.diff(angle)) > 0.05)]
    found = leads(MAP, angle, ratio)
    forward, backward = (np.interp(angle, MAP.angle, line) for line in (MAP.forward, MAP.backward))
    wanted = np.where(np.diff(angle, prepend=angle[0]) > 0.0, forward, backward)
    wanted[0] = 0.5 * (forward[0] + backward[0])
    assert found == pytest.approx(wanted, abs=1e-15)


@pytest.mark.parametrize("step", [1e-5, 1e-4, 3e-3])
def test_after_a_reversal_the_lost_motion_is_taken_up_over_the_reach(step: float) -> None:
    """s = -1 + 2 exp(-x / r_0), whatever the steps, of two lines that do not vary."""
    law = LostMotionMap(angle=[0.0], forward=[2e-4], backward=[-3e-4], reach=1e-3)
    back = step * np.arange(1, 40)
    found = leads(law, np.concatenate([[0.0, 0.5], 0.5 - back]))
    sense = -1.0 + 2.0 * np.exp(-back / 1e-3)
    assert found[2:] == pytest.approx(-0.5e-4 + 2.5e-4 * sense, abs=1e-15)


@given(st.lists(st.floats(-1e-3, 1e-3), min_size=1, max_size=30), st.integers(2, 7))
def test_steps_of_a_motion_do_not_matter(turns: list[float], parts: int) -> None:
    """Where the lines do not vary, only the way matters; standing still changes nothing."""
    law = LostMotionMap(angle=[0.0], forward=[2e-4], backward=[-3e-4], reach=1e-3)
    angle = np.append(0.0, turns)
    fine = np.interp(np.arange((angle.size - 1) * parts + 1) / parts, np.arange(angle.size), angle)
    still = np.repeat(angle, 2)
    assert leads(law, fine)[::parts] == pytest.approx(leads(law, angle), abs=1e-12)
    assert np.array_equal(leads(law, still)[1::2], leads(law, angle))


def test_the_rate_of_the_lead_is_its_difference() -> None:
    angle = 0.3 * np.sin(0.05 * np.arange(200))
    lead, rate, _, _ = MAP.requests(angle, np.zeros(200), RATIO, PERIOD)
    assert rate == pytest.approx(np.append(0.0, np.diff(lead) / PERIOD), abs=1e-9)


def test_an_empty_map_asks_for_nothing() -> None:
    assert not leads(LostMotionMap(), np.linspace(-1.0, 1.0, 20)).any()


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"forward": [0.0, 1e-4]}, "angle, forward and backward must have equally many elements"),
        ({"angle": [0.0, 0.0, 1.0]}, "angle must increase"),
        ({"angle": [0.0, 2.0, 1.0]}, "angle must increase"),
        ({"reach": 0.0}, r"lost_motion_map\.reach = 0 rad must lie in \(0, inf\)"),
        ({"angle": [*range(33)], "forward": [0.0] * 33, "backward": [0.0] * 33}, "32"),
    ],
)
def test_what_is_wrong_is_refused(changed: dict[str, object], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        MAP.replace(**changed)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("angle", "speed", "ratio", "period", "words"),
    [
        ([0.0, 1.0], [0.0], RATIO, PERIOD, "angle and speed must have the same length"),
        ([0.0], [0.0], 0.0, PERIOD, r"lost_motion_map: ratio = 0 lies outside of \[1e-06, 1000000\]; it may have either sign"),
        ([0.0], [0.0], RATIO, 0.0, r"lost_motion_map: period = 0 s lies outside of \[1e-09, 1000000\] s"),
    ],
)
def test_a_motion_that_cannot_be_is_refused(
    angle: list[float], speed: list[float], ratio: float, period: float, words: str
) -> None:
    with pytest.raises(ValueError, match=words):
        MAP.requests(angle, speed, ratio, period)
