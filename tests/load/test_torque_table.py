"""A torque over the output angle as a table, and over time besides."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
import strainwave as sw
from hypothesis import given, strategies as st

from tests.load.free import free, placed, run_of
from tests.support.geared import outputs

TABLE = sw.loads.TorqueTable(inertia=0.5, angle=[-1.0, 0.0, 0.5, 2.0], held_torque=[-3.0, 1.0, 5.0, -4.0])


def torque(load: sw.loads.TorqueTable, angle: float, push: float = 0.0) -> float:
    drive = free(load)
    return outputs(drive, placed(drive, angle), 0.0, push)["load_torque"]


@st.composite
def tables(draw: st.DrawFn) -> sw.loads.TorqueTable:
    widths = draw(st.lists(st.floats(1e-3, 2.0), min_size=0, max_size=31))
    angles = draw(st.floats(-5.0, 5.0)) + np.array([0.0, *itertools.accumulate(widths)])
    torques = draw(st.lists(st.floats(-100.0, 100.0), min_size=len(angles), max_size=len(angles)))
    return sw.loads.TorqueTable(inertia=0.5, angle=angles.tolist(), held_torque=torques)


@given(tables())
def test_at_its_angles_it_gives_its_torques(load: sw.loads.TorqueTable) -> None:
    """To the rounding of the sum of its increments."""
    for angle, wanted in zip(load.angle, load.held_torque, strict=True):
        assert torque(load, angle) == pytest.approx(wanted, rel=1e-12, abs=1e-11)


@given(tables(), st.floats(-10.0, 80.0), st.floats(-20.0, 20.0))
def test_between_and_beyond_it_is_the_line_and_the_last_value(load: sw.loads.TorqueTable, angle: float, push: float) -> None:
    wanted = np.interp(angle, load.angle, load.held_torque)
    assert torque(load, angle, push) == pytest.approx(wanted + push, rel=1e-9, abs=1e-9)


@pytest.mark.parametrize(
    ("angle", "held"), [(-5.0, -3.0), (-1.0, -3.0), (-0.5, -1.0), (0.0, 1.0), (0.25, 3.0), (0.5, 5.0), (1.5, -1.0), (9.0, -4.0)]
)
def test_numbers_by_hand(angle: float, held: float) -> None:
    assert torque(TABLE, angle) == pytest.approx(held, rel=1e-15)


def test_a_table_without_or_with_one_angle_is_a_constant() -> None:
    assert torque(sw.loads.TorqueTable(inertia=0.5), 0.3) == 0.0
    assert torque(sw.loads.TorqueTable(inertia=0.5, angle=[1.0], held_torque=[2.5]), -7.0) == 2.5


def test_a_table_over_time_adds_to_it() -> None:
    times, pushes = [0.0, 0.1, 0.3, 0.5], [0.0, 2.0, -1.0, -1.0]
    drive = free(TABLE.replace(inertia=1e6))
    run = run_of(drive, 0.5, 1e-3, placed(drive, 0.25), load_torque=sw.scenario.table(times, pushes))
    assert run["load_torque"] == pytest.approx(3.0 + np.interp(run.time, times, pushes), abs=1e-5)


def test_a_body_on_a_table_keeps_its_energy() -> None:
    """Over both corners of a notch, to the error of the steps that cross them."""
    notch = TABLE.replace(angle=[-1.0, 0.0, 1.0], held_torque=[-4.0, 0.0, 2.0])
    drive = free(notch)
    run = run_of(drive, 4.0, 1e-4, placed(drive, 1.8), sample=1e-2)
    angle = run["output_angle"]
    assert angle.min() < -1.0
    corners = np.array([-3.0, -1.0, 0.0, 1.0, 3.0])
    by_hand = np.array([10.0, 2.0, 0.0, 1.0, 5.0])  # work from 0 to each corner

    def potential(at: float) -> float:
        left = np.searchsorted(corners, at) - 1
        wide = at - corners[left]
        start, end = (np.interp(x, notch.angle, notch.held_torque) for x in (corners[left], at))
        return float(by_hand[left] + 0.5 * wide * (start + end))

    energy = 0.25 * run["output_speed"] ** 2 + [potential(at) for at in angle]
    assert energy == pytest.approx(potential(1.8), abs=1e-6)
    assert run["energy_load"] == pytest.approx(-0.25 * run["output_speed"] ** 2, abs=1e-6)


@pytest.mark.parametrize(
    ("numbers", "message"),
    [
        ({"angle": [0.0, 1.0], "held_torque": [1.0]}, "angle and held_torque must have equally many elements"),
        ({"angle": [0.0, 0.0], "held_torque": [1.0, 2.0]}, "angle must increase"),
        ({"angle": [1.0, 0.0], "held_torque": [1.0, 2.0]}, "angle must increase"),
        ({"angle": [float(n) for n in range(33)], "held_torque": [0.0] * 33}, "32"),
    ],
)
def test_what_is_no_table_is_refused(numbers: dict[str, list[float]], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        sw.loads.TorqueTable(inertia=0.5, **numbers)
