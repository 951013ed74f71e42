"""The fit of lines of resonance to amplitudes of orders, and their answers in a run-up."""

from __future__ import annotations

from math import tau

import numpy as np
import pytest
from strainwave.orders.mode_fit import Line, ModeProblem
from strainwave.orders.orders_over_speed import OrdersOverSpeed, Turning, orders_over_speed, uneven_orders

ORDERS = np.array([2.0, 4.0])
BOTH = (True, True, True, True)


def receptance(frequency: np.ndarray, natural: float, damping: float) -> np.ndarray:
    ratio = frequency / natural
    return 1.0 / (1.0 - ratio**2 + 2j * damping * ratio)


def spectrum(natural: float, damping: float, waves: float) -> OrdersOverSpeed:
    """Return amplitudes of two orders at 60 constant speeds, of a mode and of an error that does not vibrate."""
    speed = tau * np.linspace(4.0, 40.0, 60)
    noise = np.random.default_rng(2).normal(0.0, 1e-8, (2, 2, len(speed)))
    answer = sum(receptance(np.outer(ORDERS + sign * waves, speed), natural, damping) for sign in (1.0, -1.0))
    amplitude = 1e-5 + np.array([[2e-6], [1e-6j]]) * answer + noise[0] + 1j * noise[1]
    stretches = np.zeros((len(speed), 3), int)
    return OrdersOverSpeed(ORDERS, speed, amplitude, np.full(len(speed), 1e-8), np.zeros(len(speed)), stretches, (), ())


@pytest.mark.parametrize("waves", [0.0, 2.0, 1.4])
def test_a_fit_recovers_frequency_damping_and_slope(waves: float) -> None:
    natural, damping = tau * (120.0 if waves else 60.0), 0.03
    problem = ModeProblem(spectrum(natural, damping, waves), stands=False)
    start = Line(1.01 * natural, 0.02, waves + 0.05, BOTH if waves else (True, True, False, False))
    fit = problem.fit([start], np.full(2, 2e-8), np.ones(2))
    sigma = np.sqrt(np.diag(fit.covariance))
    assert abs(np.log(fit.lines[0].frequency / natural)) < max(4.0 * sigma[0], 1e-4)
    assert fit.lines[0].damping == pytest.approx(damping, rel=0.01)
    assert fit.lines[0].slope == pytest.approx(waves, abs=0.01)
    assert fit.noise == pytest.approx(np.sqrt(2.0) * 1e-8, rel=0.3)


def test_the_evidence_of_a_mode_is_larger_than_that_of_none_and_of_a_wrong_slope() -> None:
    natural = tau * 120.0
    problem = ModeProblem(spectrum(natural, 0.03, 2.0), stands=False)
    right, none, wrong = (
        problem.fit(lines, np.full(2, 2e-8), np.ones(2), free=()).evidence
        for lines in ([Line(natural, 0.03, 2.0, BOTH)], [], [Line(0.5 * natural, 0.03, 0.0, (True, True, False, False))])
    )
    assert right > none + 100.0
    assert right > wrong + 100.0


def test_amplitudes_of_a_stretch_are_those_of_its_orders_whatever_the_ratio() -> None:
    time = np.arange(0.0, 4.0, 2e-3)
    angle = 30.0 * time + 2.0 * time**2
    wave = angle / 71.0 + 3e-5 * np.cos(2.0 * angle) - 1e-5 * np.sin(4.0 * angle)
    found = orders_over_speed([Turning(time, angle, 30.0 + 4.0 * time, wave, 0.0, ())], [2.0, 4.0])
    assert np.abs(found.amplitude - np.array([[3e-5], [1e-5j]])).max() < 1e-9


def test_in_a_run_up_a_resonance_answers_as_the_equation_of_motion_integrated() -> None:
    """The mode's own equation, by a fine Runge-Kutta method, demodulated; without transients the peak is 8 % too large."""
    natural, damping, order = 300.0, 0.02, 3.0
    time = np.arange(0.0, 3.0, 1e-3)
    angle, speed = 60.0 * time + 15.0 * time**2, 60.0 + 30.0 * time
    answer = integrated(natural, damping, order)
    found = orders_over_speed([Turning(time, angle, speed, answer, 0.0, ())], [order])
    problem = ModeProblem(found, stands=False)
    fitted = problem.fit([Line(natural, damping, 0.0, (True, False))], np.full(1, 1e-3), np.ones(1), free=())
    peak = float(np.abs(found.amplitude).max())
    assert np.abs(fitted.amplitude - found.amplitude).max() < 0.01 * peak
    assert peak < 0.95 / (2.0 * damping)


def integrated(natural: float, damping: float, order: float) -> np.ndarray:
    step = 5e-4
    at = np.arange(0.0, 3.0, 0.5 * step)
    force = natural**2 * np.cos(order * (60.0 * at + 15.0 * at**2))
    first = receptance(np.array([order * 60.0]), natural, damping)[0]
    state = np.array([first.real, (1j * order * 60.0 * first).real])
    matrix = np.array([[0.0, 1.0], [-(natural**2), -2.0 * damping * natural]])
    path = []
    for k in range(0, len(at) - 2, 2):
        path.append(state[0])
        one = matrix @ state + [0.0, force[k]]
        two = matrix @ (state + 0.5 * step * one) + [0.0, force[k + 1]]
        three = matrix @ (state + 0.5 * step * two) + [0.0, force[k + 1]]
        four = matrix @ (state + step * three) + [0.0, force[k + 2]]
        state = state + step / 6.0 * (one + 2.0 * two + 2.0 * three + four)
    path.append(state[0])
    return np.array(path)[::2][:3000]


def test_an_encoder_may_repeat_and_turn_back_by_a_count() -> None:
    time = np.arange(0.0, 30.0, 2e-3)
    count = tau / 4096.0
    jitter = np.random.default_rng(3).integers(-1, 2, len(time))
    angle = count * (np.round(12.0 * time / count) + jitter)
    wave = np.sin(7.37 * 12.0 * time) + np.random.default_rng(4).normal(0.0, 0.1, len(time))
    (line,) = uneven_orders([Turning(time, angle, np.full(len(time), 12.0), wave, 0.0, ())])
    assert line.order == pytest.approx(7.37, abs=2.0 * line.sigma)
