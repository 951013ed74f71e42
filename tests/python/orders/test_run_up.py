"""Vibration in a run-up: orders of the shaft, the resonance that they pass, and fixed frequencies, by independent sums."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from strainwave.identification.identify import identify
from strainwave.identification.reading.recognise import recognise
from strainwave.orders.measured import OrdersFound, orders_found

TIME = np.arange(0.0, 20.0, 0.002)
FORCES = {1.0: 0.02, 3.0: 0.05}  # m/s² of each order, far above the resonance


def vibration(frequency: float, damping: float, fastest: float, seed: int) -> np.ndarray:
    """Return time, speed [rpm] and the answer of an accelerometer to orders of a shaft, to mains and to noise."""
    speed = np.linspace(2.0, fastest, len(TIME))  # revolutions per second
    angle = 2.0 * np.pi * np.concatenate([[0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]) * np.diff(TIME))])
    answer = 0.03 * np.cos(2.0 * np.pi * 50.0 * TIME) + np.random.default_rng(seed).normal(0.0, 0.02, len(TIME))
    for order, force in FORCES.items():
        r = order * speed / frequency
        answer += force * np.real(r**2 / (1.0 - r**2 + 2j * damping * r) * np.exp(1j * order * angle))
    return np.column_stack([TIME, 60.0 * speed, answer])


def found_in(folder: Path, rows: np.ndarray) -> OrdersFound:
    path = folder / "run.csv"
    np.savetxt(path, rows, "%.8g", ",", header="time [s],motor speed [rpm],acceleration [m/s²]", comments="")
    read = recognise(path)
    assert read.kind == "vibration"
    return orders_found(read.recording)


@pytest.mark.slow("orders")
@pytest.mark.parametrize("seed", [1, 2])
def test_orders_resonance_and_mains_are_told_apart(tmp_path: Path, seed: int) -> None:
    found = found_in(tmp_path, vibration(27.0, 0.04, 35.0, seed))
    assert found.ripple is not None
    orders = [line for line in found.ripple.lines if line.kind == "order"]
    assert [round(line.order) for line in orders] == [3, 1]
    assert all(abs(line.order - round(line.order)) < 2.0 * line.order_sigma < 0.1 for line in orders)
    passing = found.run_up
    assert passing is not None
    assert [each.order for each in passing.orders] == [3.0, 1.0]
    assert passing.frequency == pytest.approx(27.0, abs=3.0 * passing.frequency_sigma)
    assert passing.damping == pytest.approx(0.04, abs=3.0 * passing.damping_sigma)
    assert passing.frequency_sigma < 0.5
    assert passing.damping_sigma < 0.01
    ((frequency, size, _),) = passing.lines
    assert frequency == pytest.approx(50.0, abs=0.02)
    assert size == pytest.approx(0.03, abs=0.002)


@pytest.mark.slow("orders")
def test_damping_of_an_accelerometer_s_answer_is_unbiased(tmp_path: Path) -> None:
    """r² H is −1 + (1 + 2jζr) H: with H alone, the damping ratio is half a percent low."""
    rows = vibration(30.0, 0.09, 35.0, 5)
    rows[:, 2] -= np.random.default_rng(5).normal(0.0, 0.02, len(TIME)) * 0.98  # nearly without noise
    passing = found_in(tmp_path, rows).run_up
    assert passing is not None
    assert passing.damping == pytest.approx(0.09, rel=2e-3)


@pytest.mark.slow("orders")
def test_a_resonance_beyond_the_run_up_is_not_stated(tmp_path: Path) -> None:
    passing = found_in(tmp_path, vibration(200.0, 0.04, 35.0, 3)).run_up
    assert passing is not None
    assert np.isnan(passing.frequency)
    assert passing.remarks[0].startswith("no resonance is determined")


def test_at_one_speed_no_run_up_is_stated(tmp_path: Path) -> None:
    rows = vibration(27.0, 0.04, 2.0, 4)
    assert found_in(tmp_path, rows[:2000]).run_up is None
    with pytest.raises(ValueError, match="vibration determines no parameter of a gear: strainwave orders FILE"):
        identify("csg-20-100", [tmp_path / "run.csv"])


def test_an_accelerometer_may_count_in_g(tmp_path: Path) -> None:
    rows = vibration(27.0, 0.04, 2.0, 4)[:2000]
    np.savetxt(tmp_path / "g.csv", rows, "%.8g", ",", header="time [s],motor speed [rpm],acc_z [g]", comments="")
    read = recognise(tmp_path / "g.csv")
    assert read.kind == "vibration"
    assert read.recording["vibration"] == pytest.approx(9.80665 * rows[:, 2], rel=1e-6)
