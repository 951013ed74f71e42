"""What is measured of a motion, of errors that are known."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from strainwave.simulation.ensemble import Ensemble
from strainwave.tuning import goals


def ensemble(time: Any, **columns: Any) -> Ensemble:
    return Ensemble(time, columns, dict.fromkeys(columns, "1"), {}, {})


def test_errors_of_a_position() -> None:
    goal = goals.position(0.2, 0.1, "A")
    time = np.linspace(0.0, goal.command.duration, 20001)
    wanted = goal.command.value(time)
    assert np.ptp(wanted) == pytest.approx(0.2)
    assert np.abs(goal.command.rate(time)).max() == pytest.approx(0.1)
    error = np.stack([np.full_like(time, 3e-4), 2e-4 * np.sin(50.0 * time)])
    found = goal.figures(ensemble(time, output_angle=wanted - error, current=np.full((2, len(time)), 1.5)), goal.command)
    assert found["tracking error"] == pytest.approx([3e-4, 2e-4 / np.sqrt(2.0)], rel=0.02)
    assert found["largest error"] == pytest.approx([3e-4, 2e-4], rel=1e-3)
    assert found["effort of the motor"] == pytest.approx(1.5)


def test_an_error_at_reversals_is_found_there_alone() -> None:
    goal = goals.position(0.2, 0.1, "A")
    time = np.linspace(0.0, goal.command.duration, 20001)
    period = 0.5 * goal.command.duration
    error = np.stack([np.abs(time - 1.5 * period) < 0.01 * period, np.abs(time - 1.25 * period) < 0.01 * period]) * 1e-3
    runs = ensemble(time, output_angle=goal.command.value(time) - error, current=np.zeros((2, len(time))))
    assert goal.figures(runs, goal.command)["error at reversals"] == pytest.approx([1e-3, 0.0])


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
