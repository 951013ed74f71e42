"""Profiles: the motion of each, against its closed form at chosen instants."""

from __future__ import annotations

import numpy as np
import pytest
from strainwave.dataset.profiles import PROFILES, command_of, peak_speed

NUMBERS = {
    "constant_speed": {"speed": 0.5},
    "ramp": {"stroke": 1.0, "rise": 0.4},
    "flight": {"stroke": 1.5, "correction": 0.0, "frequency": 1.0},
    "pick_and_place": {"stroke": 0.3, "period": 0.5, "dwell": 0.2},
    "random": {"amplitude": 0.1, "bandwidth": 3.0},
}


@pytest.mark.parametrize("kind", PROFILES)
def test_each_profile_begins_at_angle_zero_and_has_its_duration(kind: str) -> None:
    command = command_of(kind, NUMBERS[kind], 1.2, 3)
    assert command.duration == 1.2
    assert command.value(0.0) == pytest.approx(0.0, abs=1e-12)


def test_a_ramp_reaches_its_stroke_and_stays() -> None:
    command = command_of("ramp", NUMBERS["ramp"], 1.0, 0)
    np.testing.assert_allclose(command.value([0.2, 0.4, 1.0]), [0.5, 1.0, 1.0])
    assert peak_speed(command, 1e-3) == pytest.approx(2.5)


def test_a_ramp_longer_than_the_run_is_cut() -> None:
    command = command_of("ramp", {"stroke": 1.0, "rise": 4.0}, 1.0, 0)
    assert command.value(1.0) == pytest.approx(0.25)


def test_a_flight_goes_out_and_back() -> None:
    command = command_of("flight", NUMBERS["flight"], 3.0, 0)
    np.testing.assert_allclose(command.value([1.0, 1.5, 2.0, 3.0]), [1.5, 1.5, 1.5, 0.0], atol=1e-12)


def test_a_pick_and_place_cycle_is_cycloidal_with_pauses() -> None:
    command = command_of("pick_and_place", NUMBERS["pick_and_place"], 1.0, 0)
    move = 0.8 * 0.25  # of half a period, without its pause
    np.testing.assert_allclose(
        command.value([0.5 * move, move, 0.25, 0.25 + 0.5 * move, 0.5, 1.0]), [0.15, 0.3, 0.3, 0.15, 0.0, 0.0], atol=1e-12
    )
    assert peak_speed(command, 1e-3) == pytest.approx(2.0 * 0.3 / move, rel=0.01)  # of a cycloid: twice the mean


def test_a_random_motion_has_its_amplitude_and_seeds_differ() -> None:
    command = command_of("random", NUMBERS["random"], 60.0, 1)
    values = command.value(np.linspace(0.0, 60.0, 6001))
    assert values.std() == pytest.approx(0.1, rel=0.1)
    other = command_of("random", NUMBERS["random"], 60.0, 2)
    assert not np.allclose(values, other.value(np.linspace(0.0, 60.0, 6001)))
