"""What is measured of a motion, of errors that are known."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from strainwave.simulation.ensemble import Ensemble
from strainwave.tuning import goals


def ensemble(time: Any, **columns: Any) -> Ensemble:
    return Ensemble(time, columns, dict.fromkeys(columns, "1"), {}, {})


def test_a_position_goes_to_and_fro_twice_and_rests_at_the_other_end() -> None:
    goal = goals.position(0.2, 0.1, "A")
    time = 1e-3 * np.arange(int(1e3 * goal.command.duration))
    wanted, rate = goal.command.value(time), goal.command.rate(time)
    period = 2.0 * np.pi / goal.pace
    assert period == pytest.approx(np.pi * 0.2 / 0.1, abs=2e-3)
    assert np.ptp(wanted) == pytest.approx(0.2)
    assert np.abs(rate).max() == pytest.approx(0.1, rel=1e-3)
    assert wanted[: int(1e3 * period)] == pytest.approx(wanted[int(1e3 * period) : 2 * int(1e3 * period)], abs=1e-4)
    assert (wanted[time > 2.5 * period] == 0.2).all()
    assert (rate[time > 2.5 * period] == 0.0).all()


def test_set_points_have_value_and_rate_of_a_sine() -> None:
    """Between two of them the line leaves the sine by half its acceleration times the square of a period, at most."""
    goal = goals.position(0.2, 0.1, "A", sample=4e-3)
    period = 2.0 * np.pi / goal.pace
    time = np.linspace(0.0, 2.0 * period, 5000)
    sine = 0.1 * (1.0 - np.cos(goal.pace * time))
    assert goal.command.value(time) == pytest.approx(sine, abs=0.5 * 0.1 * goal.pace**2 * 4e-3**2)
    samples = 4e-3 * np.arange(100)
    assert goal.command.rate(samples) == pytest.approx(0.1 * goal.pace * np.sin(goal.pace * samples), abs=1e-12)


def test_errors_of_a_position() -> None:
    goal = goals.position(0.2, 0.1, "A")
    time = np.linspace(0.0, goal.command.duration, 20001)
    wanted = goal.command.value(time)
    error = np.stack([np.full_like(time, 3e-4), 2e-4 * np.sin(50.0 * time)])
    found = goal.figures(ensemble(time, output_angle=wanted - error, current=np.full((2, len(time)), 1.5)), goal.command)
    assert found["tracking error"] == pytest.approx([3e-4, 2e-4 / np.sqrt(2.0)], rel=0.02)
    assert found["largest error"] == pytest.approx([3e-4, 2e-4], rel=1e-3)
    assert found["effort of the motor"] == pytest.approx(1.5)


def test_an_error_at_reversals_is_found_there_alone() -> None:
    goal = goals.position(0.2, 0.1, "A")
    time = np.linspace(0.0, goal.command.duration, 20001)
    period = 2.0 * np.pi / goal.pace
    error = np.stack([np.abs(time - 1.5 * period) < 0.01 * period, np.abs(time - 1.25 * period) < 0.01 * period]) * 1e-3
    runs = ensemble(time, output_angle=goal.command.value(time) - error, current=np.zeros((2, len(time))))
    assert goal.figures(runs, goal.command)["error at reversals"] == pytest.approx([1e-3, 0.0])


def test_a_settling_time_is_that_of_a_recording_and_infinite_if_the_error_stays() -> None:
    """An error a exp(-t / tau) enters the band after tau log(a / band)."""
    goal = goals.position(0.2, 0.1, "A")
    end = 2.5 * 2.0 * np.pi / goal.pace
    time = 1e-4 * np.arange(int(1e4 * goal.command.duration))
    band = goals.SETTLING_BAND_SHARE * 0.2
    decays = np.where(time < end, 0.0, 10.0 * band * np.exp(-(time - end) / 0.05))
    error = np.stack([decays, np.full_like(time, 0.9 * band), np.full_like(time, 1.1 * band), np.full_like(time, np.nan)])
    runs = ensemble(time, output_angle=goal.command.value(time) - error, current=np.zeros((4, len(time))))
    found = goal.figures(runs, goal.command)["settling time"]
    assert found[0] == pytest.approx(0.05 * np.log(10.0), abs=1e-4)
    assert list(found[1:3]) == [0.0, np.inf]
    assert np.isnan(found[3])


def test_a_torque_goes_to_and_fro_against_a_stop_in_its_unit() -> None:
    goal = goals.torque(30.0, 1e4, 0.02, "A")
    assert goal.command.value(goal.command.duration) == pytest.approx(30.0 / 1e4)
    time = np.linspace(0.0, goal.command.duration, 20001)
    runs = ensemble(time, output_angle=goal.command.value(time)[np.newaxis] - 1e-4, current=np.zeros((1, len(time))))
    found = goal.figures(runs, goal.command)
    assert found["torque error"] == pytest.approx(1.0)
    assert goal.units["torque error"] == "N.m"


def test_ripple_and_rest() -> None:
    goal = goals.smooth(0.01, 2.0, "N.m")
    time = np.linspace(0.0, 2.0, 20001)
    speed = np.stack([0.01 * (1.0 + 0.1 * np.sin(100.0 * time)), np.where(np.arange(20001) % 4 < 3, 0.0, 0.04)])
    runs = ensemble(time, output_angle=np.stack([0.01 * time] * 2), output_speed=speed, motor_torque=np.zeros((2, 20001)))
    found = goal.figures(runs, goal.command)
    assert found["speed ripple"] == pytest.approx([0.1 / np.sqrt(2.0), np.sqrt(0.75 + 0.25 * 9.0)], rel=0.01)
    assert found["time at rest"] == pytest.approx([0.0, 0.75], abs=1e-3)
    assert found["position error"] == pytest.approx(0.0, abs=1e-15)


def test_an_output_that_does_not_move_does_not_count_as_smooth() -> None:
    """Its ripple would be 1, less than that of an output that slips now and then."""
    goal = goals.smooth(0.01, 2.0, "N.m")
    time = np.linspace(0.0, 2.0, 2001)
    speed = np.stack([np.zeros(2001), np.where(np.arange(2001) % 4 < 3, 0.0, 0.04)])
    found = goal.figures(ensemble(time, output_angle=speed, output_speed=speed, motor_torque=speed), goal.command)
    assert {name: list(np.isnan(values)) for name, values in found.items()} == {name: [True, False] for name in goal.units}
