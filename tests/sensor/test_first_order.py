"""A sensor that lags."""

from __future__ import annotations

from math import tau

import numpy as np
import pytest
import strainwave as sw

from tests.sensor.probe import from_elsewhere, probe, shown

TIME = 0.02
LAW = sw.sensor.FirstOrder(time_constant=TIME)


@pytest.mark.parametrize("dt", [1e-4, 5e-3, 0.05])
def test_it_forgets_exponentially_at_any_step(dt: float) -> None:
    time, found = from_elsewhere(LAW, {"shown": 1.0}, 0.2, dt)
    assert found == pytest.approx(np.exp(-time / TIME), abs=1e-14)


def test_it_stays_behind_a_ramp_by_its_time_constant() -> None:
    time, found = shown(LAW, sw.scenario.ramp(3.0, 0.3), 1e-3)
    assert found == pytest.approx(3.0 * (time + TIME * np.expm1(-time / TIME)), abs=1e-9)


@pytest.mark.parametrize("frequency", [1.0, 8.0, 40.0])
def test_it_answers_a_sine_as_one_over_one_plus_tau_s(frequency: float) -> None:
    w = tau * frequency
    time, found = shown(LAW, sw.scenario.sine(1.0, frequency, 0.3), 1e-4)
    steady = (np.exp(1j * w * time) / (1.0 + 1j * w * TIME)).imag
    transient = w * TIME / (1.0 + (w * TIME) ** 2) * np.exp(-time / TIME)
    assert found == pytest.approx(steady + transient, abs=1e-8)


def test_it_adds_its_pole_and_its_response() -> None:
    """Closed over the drive without it: L / (1 + L) with L through 1 / (1 + tau s)."""
    plain = probe(sw.sensor.Ideal(), "input_speed").replace(
        {"load": sw.loads.Inertia(inertia=0.05), "motor.inertia": 1e-4, "control.input_speed": 0.02}
    )
    lagging = plain.replace({"sensors.input_speed": LAW})
    frequency = np.array([0.5, 3.0, 30.0])
    s = 1j * tau * frequency
    ideal = sw.linearise(plain).response(frequency, output="input_speed")
    loop = ideal / (20.0 * s - ideal)  # speed over commanded speed is L / (1 + L)
    late = loop / (1.0 + TIME * s)
    wanted = 20.0 * s * loop / (1.0 + late)
    assert sw.linearise(lagging).response(frequency, output="input_speed") == pytest.approx(wanted, rel=1e-9)
