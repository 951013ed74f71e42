"""Kinematic error over the temperature: simulated records of a gear whose error changes, and of one whose error does not."""

from __future__ import annotations

import numpy as np
import pytest
import strainwave as sw
from strainwave.orders import error_over_temperature
from strainwave.orders.two_encoders import TransmissionError

MEAN, DEGREES = 303.15, [283.15, 303.15, 323.15]  # K
AMPLITUDE, PHASE = np.array([3e-4, 1e-4]), np.array([0.3, -1.0])  # of orders 2 and 4, at the mean temperature
RISE, TURN = np.array([2e-6, 0.0]), np.array([0.0, 4e-3])  # rad/K


def measured(temperature: float, seed: int, *, changing: bool = True, zero: float = 0.0) -> TransmissionError:
    """Two encoders on a gear whose amplitude of order 2 grows, and whose phase of order 4 turns; with a zero of the input."""
    warmer, theta = (temperature - MEAN) * changing, 30.0 * np.sin(np.linspace(0.0, 6.0, 1000))
    error = sum(
        (size + rise * warmer) * np.sin(order * theta + phase + turn * warmer)
        for order, size, phase, rise, turn in zip((2, 4), AMPLITUDE, PHASE, RISE, TURN, strict=True)
    )
    output = -theta / 100.0 - error + np.random.default_rng(seed).normal(0.0, 1e-5, len(theta))
    columns = {"input_angle": theta + zero, "output_angle": output}
    return sw.transmission_error(sw.Recording(columns, dict.fromkeys(columns, "rad")))


def test_amplitude_and_phase_come_back_within_their_standard_deviations() -> None:
    found = error_over_temperature([measured(degree, seed) for seed, degree in enumerate(DEGREES)], DEGREES)
    assert [each.order for each in found.orders] == [2.0, 4.0]
    for each, rise, turn in zip(found.orders, RISE, TURN, strict=True):
        assert each.significant
        assert abs(each.amplitude_rate - rise) < 3.5 * each.amplitude_rate_sigma + 2e-8  # of the bend of a turning phase
        assert abs(each.phase_rate - turn) < 3.5 * each.phase_rate_sigma


def test_the_law_predicts_the_error_at_each_temperature() -> None:
    found = error_over_temperature([measured(degree, seed) for seed, degree in enumerate(DEGREES)], DEGREES)
    angle = np.linspace(0.0, 2.0 * np.pi, 200)
    for degree in DEGREES:
        warmer = degree - MEAN
        waves = (AMPLITUDE + RISE * warmer)[:, None] * np.sin(
            np.array([[2.0], [4.0]]) * angle + (PHASE + TURN * warmer)[:, None]
        )
        law = found.law.replace(temperature=degree)
        assert np.abs(law.error(angle) - waves.sum(axis=0)).max() < 4e-6


def test_a_constant_error_has_no_significant_change() -> None:
    """The rate of false alarms is 1 % for both orders together."""
    alarms = 0
    for first in range(0, 24, 3):
        errors = [measured(degree, first + i, changing=False) for i, degree in enumerate(DEGREES)]
        alarms += any(each.significant for each in error_over_temperature(errors, DEGREES).orders)
    assert alarms <= 1


def test_one_temperature_does_not_separate_the_change() -> None:
    errors = [measured(293.15, seed) for seed in (1, 2)]
    with pytest.raises(ValueError, match="not separable; add a record at another one"):
        error_over_temperature(errors, [293.15, 293.15])
    with pytest.raises(ValueError, match="3 temperatures are given for 2 records"):
        error_over_temperature(errors, DEGREES)


def test_two_records_are_remarked_not_to_test_the_line() -> None:
    found = error_over_temperature([measured(283.15, 1), measured(323.15, 2)], [283.15, 323.15])
    assert any("do not test the line" in each for each in found.remarks)
    assert [each.phase_rate_sigma for each in found.orders] == [np.inf, np.inf]


@pytest.mark.parametrize("degrees", [DEGREES, [283.15, 323.15]])
def test_another_zero_of_the_encoder_is_no_change_of_the_gear(degrees: list[float]) -> None:
    """The input counts from anywhere in each record: amplitudes are still those of the gear, and phases are not compared."""
    errors = [measured(degree, seed, zero=1.3 * seed) for seed, degree in enumerate(degrees)]
    second, fourth = error_over_temperature(errors, degrees).orders
    assert (second.phase_rate, second.phase_rate_sigma) == (0.0, np.inf)
    assert abs(second.amplitude - AMPLITUDE[0]) < 3.5 * second.amplitude_sigma
    assert abs(second.amplitude_rate - RISE[0]) < 3.5 * second.amplitude_rate_sigma
    assert (second.significant, fourth.significant) == (True, False)
