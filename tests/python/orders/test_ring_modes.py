"""Peaks of orders and modes from sums in closed form: u = Re(f / 2 [H((q + n) Ω) + H((q - n) Ω)] e^(j q θ))."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import tau

import numpy as np
import pytest
import strainwave as sw
from scipy.integrate import cumulative_trapezoid
from scipy.signal import lfilter
from strainwave.orders.order_peaks import OrderPeak, peaks_of
from strainwave.orders.orders_over_speed import OrdersOverSpeed, Turning
from strainwave.orders.ring_modes import modes_of_peaks

UNITS = {"time": "s", "input_angle": "rad", "output_angle": "rad"}
Mode = tuple[float, float, int, Mapping[float, complex]]  # frequency [Hz], damping, waves, force of each order


def receptance(passes: float, speed: float, frequency: float, damping: float) -> complex:
    ratio = passes * speed / (tau * frequency)
    return 1.0 / (1.0 - ratio**2 + 2j * damping * ratio)


def at_constant_speeds(
    modes: Sequence[Mode], fastest: float, count: int = 60, column: str = "output_angle", noise: float = 1e-7
) -> list[sw.Recording]:
    """Return recordings of eight revolutions each, with order 2 and 4 of an error that does not vibrate."""
    random = np.random.default_rng(count)
    recordings = []
    for speed in tau * np.linspace(0.1 * fastest, fastest, count):
        angle = np.linspace(0.0, 8.0 * tau, 240)
        error = 2e-5 * np.cos(2.0 * angle) + 1e-5 * np.sin(4.0 * angle) + random.normal(0.0, noise, len(angle))
        for frequency, damping, waves, forces in modes:
            for order, force in forces.items():
                both = sum(receptance(passes, speed, frequency, damping) for passes in (order + waves, order - waves))
                error += np.real(0.5 * force * both * np.exp(1j * order * angle))
        columns = {"time": angle / speed, "input_angle": angle, column: error + (angle / 80.0 if column in UNITS else 0.0)}
        recordings.append(sw.Recording(columns, {name: UNITS.get(name, "m/s2") for name in columns}))
    return recordings


def near(mode: sw.orders.RingMode, frequency: float, damping: float) -> bool:
    """True if a mode has these numbers within two standard deviations, and determines them."""
    return (
        abs(mode.frequency / tau - frequency) < 2.0 * mode.frequency_sigma / tau < 0.02 * frequency
        and abs(mode.damping - damping) < 2.0 * mode.damping_sigma < 0.2 * damping
    )


def test_three_peaks_of_two_orders_determine_frequency_and_waves() -> None:
    found = sw.orders.ring_modes(
        at_constant_speeds([(120.0, 0.03, 2, {3.0: 4e-6, 5.0: 3e-6j})], 50.0), "output_angle", orders=[3.0, 5.0]
    )
    (mode,) = found.modes
    assert mode.waves == 2
    assert near(mode, 120.0, 0.03)
    assert sorted((peak.order, round(peak.speed / tau)) for peak in mode.peaks) == [(3.0, 24), (5.0, 17), (5.0, 40)]
    assert len(found.plot().axes) == 2


def test_one_order_alone_states_nothing() -> None:
    recordings = at_constant_speeds([(60.0, 0.03, 0, {2.0: 4e-6})], 40.0)
    found = sw.orders.ring_modes(recordings, "output_angle", orders=[2.0, 4.0])
    assert found.modes == ()
    assert any(remark.startswith("order 2 may pass a mode: no other order confirms it") for remark in found.remarks)


def test_two_peaks_of_two_modes_are_no_line_of_both() -> None:
    """2 waves at 551 rad/s and none at 412 rad/s: one line through a peak of each has the slope -1.5."""
    modes: list[Mode] = [(551.0 / tau, 0.03, 2, {4.0: 3e-6}), (412.0 / tau, 0.03, 0, {3.0: 3e-6})]
    found = sw.orders.ring_modes(at_constant_speeds(modes, 33.0), "output_angle", orders=[3.0, 4.0])
    assert all(mode.waves in (0, 2) for mode in found.modes)
    assert all(
        min(abs(mode.frequency - 551.0), abs(mode.frequency - 412.0)) < 2.0 * mode.frequency_sigma for mode in found.modes
    )


def test_without_a_mode_nothing_is_stated() -> None:
    found = sw.orders.ring_modes(at_constant_speeds([], 40.0), "output_angle", orders=[2.0, 4.0])
    assert found.modes == ()
    assert not any("may pass a mode" in remark for remark in found.remarks)


def test_a_sensor_that_stands_states_frequencies_without_slope() -> None:
    recordings = at_constant_speeds([(60.0, 0.03, 0, {2.0: 4e-3, 4.0: 3e-3})], 40.0, column="vibration", noise=1e-4)
    (mode,) = sw.orders.ring_modes(recordings, "vibration", orders=[2.0, 4.0]).modes
    assert near(mode, 60.0, 0.03)
    assert np.isnan(mode.slope)
    assert mode.waves is None


def test_unrelated_peaks_of_one_damping_are_seldom_a_mode() -> None:
    random, stated = np.random.default_rng(1), 0
    for _ in range(60):
        speeds, orders = random.uniform(60.0, 300.0, 8), random.integers(1, 9, 8)
        dampings = 0.02 * (1.0 + 0.03 * random.standard_normal(8))
        peaks = [
            OrderPeak(float(order), 0.0, float(speed), 1e-3 * float(speed), float(damping), 6e-4, 1.0)
            for order, speed, damping in zip(orders, speeds, dampings, strict=True)
        ]
        stated += bool(modes_of_peaks(peaks, 240.0, False))
    assert stated <= 6  # MAX_CHANCE of 60 is 3


def in_a_run_up(duration: float) -> sw.Recording:
    """A run-up to 40 revolutions per second past a mode at 90 Hz, damping 0.02, which answers in time."""
    step, frequency, damping = 5e-4, 90.0, 0.02
    time = np.arange(0.0, duration, step)
    speed = tau * (4.0 + 36.0 * time / duration)
    angle = cumulative_trapezoid(speed, time, initial=0.0)
    pole = np.exp((-damping + 1j * np.sqrt(1.0 - damping**2)) * tau * frequency * step)
    force = 1e-5 * (np.cos(3.0 * angle) + np.cos(4.0 * angle) + np.cos(5.0 * angle))
    answer = lfilter([abs(1.0 - pole) ** 2], [1.0, -2.0 * pole.real, abs(pole) ** 2], force)
    noise = np.random.default_rng(5).normal(0.0, 1e-7, len(time))
    return sw.Recording({"time": time, "input_angle": angle, "output_angle": angle / 80.0 + answer + noise}, UNITS)


@pytest.mark.slow("orders")
def test_a_slow_run_up_determines_a_mode_and_a_fast_one_says_that_it_is_too_fast() -> None:
    (mode,) = sw.orders.ring_modes(in_a_run_up(60.0), "output_angle", orders=[3.0, 4.0, 5.0]).modes
    assert mode.waves == 0
    assert near(mode, 90.0, 0.02)
    fast = sw.orders.ring_modes(in_a_run_up(3.0), "output_angle", orders=[3.0, 4.0, 5.0])
    assert fast.modes == ()
    assert any("too fast" in remark or "stretches determine no mode" in remark for remark in fast.remarks)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_peak_of_an_order_is_that_of_its_receptance(sign: float) -> None:
    """Exactly, without noise: of both senses in which a wave may go round."""
    speed = np.linspace(10.0, 60.0, 40)
    ratio = speed / 31.0
    amplitude = 2.0 + 0.01 * speed + (0.3 - 0.2j) / (1.0 - ratio**2 + 2j * sign * 0.04 * ratio)
    stretches = np.stack([np.zeros(40, int), np.full(40, 2), np.zeros(40, int)], axis=1)
    series = np.arange(3.0)
    turning = Turning(series, series, np.ones(3), series, 0.0, ())
    spectrum = OrdersOverSpeed(
        np.array([3.0]), speed, amplitude[None], np.full(40, 1e-9), np.zeros(40), stretches, (turning,), ()
    )
    ((peak,), curve, remarks) = peaks_of(spectrum, 0)
    assert peak.speed == pytest.approx(31.0, rel=1e-6)
    assert peak.damping == pytest.approx(0.04, rel=1e-4)
    assert np.abs(curve - amplitude).max() < 1e-6
    assert remarks == []
