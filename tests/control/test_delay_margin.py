"""How late a computer may be until its loop is no longer stable."""

from __future__ import annotations

import numpy as np
import pytest
import strainwave as sw
from scipy.optimize import brentq

from tests.control.discrete import RATIO, TORQUE, Array, Plant, drive

LAW = sw.control.PID(proportional=0.35, derivative=0.018)  # crosses over where the gear is stiff
GAINS = np.array([LAW.proportional, LAW.derivative, 0.0, 0.0])  # of input angle, input speed, output angle, output speed


def loop(period: float, delay: float) -> Array:
    """One period of the sampled loop: the motion, and the output that is still to come."""
    plant = Plant(TORQUE)
    (late, late_input), (rest, rest_input) = plant.over(delay), plant.over(period - delay)
    late, rest, late_input, rest_input = late[1:, 1:], rest[1:, 1:], late_input[1:], rest_input[1:]
    # x' = rest (late x + late_input u_old) + rest_input u_new, u_new = -K x
    whole = np.zeros((5, 5))
    whole[:4, :4] = rest @ late - np.outer(rest_input, GAINS)
    whole[:4, 4] = rest @ late_input
    whole[4, :4] = -GAINS
    return whole


def radius(period: float, delay: float) -> float:
    """Of the eigenvalues: below 1 the loop is stable."""
    return float(np.abs(np.linalg.eigvals(loop(period, delay))).max())


def critical(period: float) -> float:
    """The delay from which on the loop is not stable [s]."""
    return float(brentq(lambda delay: radius(period, delay) - 1.0, 0.0, period, xtol=1e-12))


def growth(period: float, delay: float) -> float:
    """By how much a disturbance grows from one sample to the next in a run of the package, once its slowest part prevails."""
    one = drive(sw.control.Sampled(law=LAW, period=period, delay=delay), TORQUE)
    still = sw.scenario.constant(0.0, 400.0 * period)
    run = sw.simulate(one, still, period / 40.0, sample=period, initial={"input_angle": 1e-3})
    # A vibration goes on as y'' = a y' - b y, with b the square of its growth.
    before, now, after = (run["input_angle"][200 + k : 398 + k] for k in range(3))
    _, b = np.linalg.lstsq(np.stack([now, -before], axis=1), after, rcond=None)[0]
    return float(np.sqrt(b))


@pytest.mark.parametrize("period", [5.1e-3, 6e-3, 8e-3])
@pytest.mark.parametrize("share", [0.98, 0.999, 1.001, 1.02])
def test_a_loop_is_stable_up_to_its_critical_delay_and_no_further(period: float, share: float) -> None:
    """Critical by the eigenvalues of the sampled loop, which exact matrices by hand have; so fast it grows or decays."""
    delay = share * critical(period)
    found = growth(period, delay)
    assert (found < 1.0) == (share < 1.0)
    assert found == pytest.approx(radius(period, delay), abs=1e-6)


def crossover() -> tuple[float, float]:
    """Of the continuous loop: the highest frequency at which its gain is 1 [rad/s], and the phase margin there [rad]."""
    a, b = Plant(TORQUE).matrices

    def opened(frequency: float) -> complex:
        return complex(GAINS @ np.linalg.solve(1j * frequency * np.eye(4) - a[1:, 1:], b[1:]))

    frequency = float(brentq(lambda w: abs(opened(w)) - 1.0, 150.0, 1000.0, xtol=1e-10))
    return frequency, float(np.pi + np.angle(opened(frequency)))


@pytest.mark.parametrize("period", [5.1e-3, 5.5e-3, 6e-3])
def test_the_critical_delay_is_phase_margin_over_crossover_less_half_a_period(period: float) -> None:
    """A held output is late by T / 2 in the mean. That is a rule of thumb: here for six periods in a turn of the crossover."""
    frequency, margin = crossover()
    assert critical(period) + 0.5 * period == pytest.approx(margin / frequency, rel=0.03)


def test_the_crossover_is_that_of_the_package() -> None:
    """Gain and phase of the loop by its linear view: closed over opened."""
    frequency, margin = crossover()
    linear = sw.linearise(drive(LAW, TORQUE))
    closed = complex(linear.response(frequency / (2.0 * np.pi), output="input_angle")) / RATIO
    opened = closed / (1.0 - closed)
    assert abs(opened) == pytest.approx(1.0, rel=1e-9)
    assert np.pi + np.angle(opened) == pytest.approx(margin, rel=1e-9)
