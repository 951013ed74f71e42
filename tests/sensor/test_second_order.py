"""A sensor that follows like an oscillator."""

from __future__ import annotations

from math import tau

import numpy as np
import pytest
import strainwave as sw

from tests.sensor.probe import from_elsewhere, probe, shown

OWN = 300.0


def law(damping: float) -> sw.sensor.SecondOrder:
    return sw.sensor.SecondOrder(natural_frequency=OWN, damping_ratio=damping)


@pytest.mark.parametrize("damping", [0.0, 0.2, 0.7])
def test_a_step_is_answered_as_the_textbook_says(damping: float) -> None:
    """1 - e^(-zeta w t) (cos w_d t + zeta / sqrt(1 - zeta^2) sin w_d t), here turned round: from 1 to 0."""
    time, found = from_elsewhere(law(damping), {"shown": 1.0}, 0.1, 2e-5)
    damped = OWN * np.sqrt(1.0 - damping**2)
    swing = np.cos(damped * time) + damping * OWN / damped * np.sin(damped * time)
    assert found == pytest.approx(np.exp(-damping * OWN * time) * swing, abs=1e-9)


@pytest.mark.parametrize("damping", [1.5, 4.0])
def test_so_it_is_where_it_does_not_swing(damping: float) -> None:
    time, found = from_elsewhere(law(damping), {"shown": 1.0}, 0.1, 2e-5)
    slow, fast = OWN * (damping + np.array([-1.0, 1.0]) * np.sqrt(damping**2 - 1.0))
    assert found == pytest.approx((fast * np.exp(-slow * time) - slow * np.exp(-fast * time)) / (fast - slow), abs=1e-9)


def test_behind_a_steady_motion_it_stays_back_by_two_zeta_over_omega() -> None:
    time, found = shown(law(0.7), sw.scenario.ramp(2.0, 0.2), 1e-4)
    assert found[-1] == pytest.approx(2.0 * (time[-1] - 2.0 * 0.7 / OWN), rel=1e-9)


@pytest.mark.parametrize("damping", [0.3, 0.7, 1.0])
@pytest.mark.parametrize("frequency", [5.0, 47.0, 150.0])
def test_a_sine_passes_as_its_transfer_function_says(damping: float, frequency: float) -> None:
    w = tau * frequency
    time, found = shown(law(damping), sw.scenario.sine(1.0, frequency, 0.5), 2e-5)
    response = OWN**2 / (OWN**2 - w**2 + 2j * damping * OWN * w)
    late = time > 0.4
    assert found[late] == pytest.approx((response * np.exp(1j * w * time[late])).imag, abs=1e-7)


def test_it_adds_its_two_poles() -> None:
    plain = probe(sw.sensor.Ideal()).replace({"load": sw.loads.Inertia(inertia=0.05), "motor.inertia": 1e-4})
    drive = plain.replace({"control": sw.control.OpenLoop(), "sensors.output_speed": law(0.4)})
    found = sw.linearise(drive).poles
    for pole in OWN * np.array([-0.4 + 1j * np.sqrt(0.84), -0.4 - 1j * np.sqrt(0.84)]):
        assert np.abs(found - pole).min() < 1e-9 * OWN
