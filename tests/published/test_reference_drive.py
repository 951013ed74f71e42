"""The reference drive against its solution by an independent program, a classical Runge-Kutta method at 25 ns."""

from __future__ import annotations

import numpy as np
import pytest
import strainwave as sw

from tests.reference_drive import DRIVE, command

# Time [s]: input angle [rad], input speed [rad/s], output angle [rad], output speed [rad/s], torque [N.m].
KNOWN = {
    0.01: (0.6141273030231038, 85.54005991885637, 0.002497814213612874, 0.8855815019873978, 103.71346401041895),
    0.1: (14.392587761524922, 143.65033435759096, 0.1444046414000202, 1.4304542780659235, -9.508663912887966),
    1.0: (21.095375263666458, 205.2593723418557, 0.2102066314860274, 2.0259423270991017, 7.54384223777401),
    5.0: (140.7869469886738, 205.59575000746915, 1.4063923224425494, 2.0287055041106963, 20.62009884513958),
}
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
