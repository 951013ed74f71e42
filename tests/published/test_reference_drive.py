"""The reference drive against its solution by an independent program, a classical Runge-Kutta method at 25 ns."""

from __future__ import annotations

import numpy as np
import pytest
import strainwave as sw
from reference import KNOWN

from tests.support.reference_drive import DRIVE, command

COLUMNS = ("input_angle", "input_speed", "output_angle", "output_speed", "torque")


def errors(dt: float) -> np.ndarray:
    """Difference from each known line, shape (4, 5)."""
    run = sw.simulate(DRIVE, command(5.0), dt=dt, sample=1e-3)
    rows = [round(time / 1e-3) for time in KNOWN]
    assert run["time"][rows] == pytest.approx(list(KNOWN), rel=1e-15)
    return np.stack([run[column][rows] for column in COLUMNS], axis=1) - list(KNOWN.values())


def test_at_a_fifth_of_a_millisecond_the_known_lines_are_met() -> None:
    _, _, angle, _, torque = np.abs(errors(2e-4)).max(axis=0)
    assert angle < 1e-7
    assert torque < 1e-3


def test_smaller_steps_come_closer_in_every_column() -> None:
    coarse, middle, fine = (np.abs(errors(dt)).max(axis=0) for dt in (5e-4, 1e-4, 2e-5))
    assert np.all(middle < coarse / 5.0)
    assert np.all(fine < middle / 5.0)
