"""The motion of a shaft from its angle: the filter beside SciPy's, delays and derivatives beside closed forms."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from scipy import signal
from strainwave.identification.experiments.motion import PASS_BAND_SHARE, Motion, motion_of
from strainwave.identification.experiments.motion_log import late

STEP = 2e-3
TIME = STEP * np.arange(5000)


def moving(every: int, cutoff: float) -> Motion:
    """A shaft that is at rest from 3 s to 4 s."""
    known = ~((TIME > 3.0) & (TIME < 4.0))
    known[: 5 * every] = known[-5 * every :] = False
    nothing = np.zeros_like(TIME)
    return Motion(TIME, nothing, nothing, nothing, known, ~np.ones_like(known), ~known, every, cutoff)


@pytest.mark.parametrize("cutoff", [5.0, 20.0, 50.0])
def test_the_filter_is_that_of_butterworth_forward_and_backward(cutoff: float) -> None:
    motion = moving(max(1, round(1.0 / (STEP * 2.0 * PASS_BAND_SHARE * cutoff))), cutoff)
    series = np.random.default_rng(0).normal(size=(3, len(TIME))) + np.sign(np.sin(TIME))
    low_pass = signal.butter(4, PASS_BAND_SHARE * cutoff, fs=1.0 / STEP, output="sos")
    padded = np.pad(np.where(motion.known, series, 0.0), ((0, 0), (2000, 2000)))
    expected = signal.sosfiltfilt(low_pass, padded, axis=-1)[:, 2000:-2000][:, motion.rows]
    assert motion.filtered(series) == pytest.approx(expected, abs=1e-8)
    assert motion.filtered(series[0]) == pytest.approx(expected[0], abs=1e-8)


def test_a_vibration_slower_than_the_record_leaves_nothing_to_compare() -> None:
    """Its filter would be 10^9 samples long."""
    with pytest.raises(ValueError, match="about as fast as a vibration of 1e-07 Hz"):
        moving(2, 20.0).below(1e-7)


@pytest.mark.slow("identification")
@settings(max_examples=30, deadline=None)
@given(delay=st.floats(-0.05, 0.05), frequency=st.floats(0.5, 10.0))
def test_a_delayed_sine_is_a_sine_and_changes_with_the_delay_as_it_does(delay: float, frequency: float) -> None:
    turning = 2.0 * np.pi * frequency
    delayed, change = late(np.stack([np.sin(turning * TIME), np.cos(turning * TIME)]), delay, STEP)
    inside = slice(30, -30)
    phase = turning * (TIME - delay)
    error = (turning * STEP) ** 3  # of the cubic of Catmull and Rom, which is exact up to the square
    assert delayed[0, inside] == pytest.approx(np.sin(phase)[inside], abs=error)
    assert delayed[1, inside] == pytest.approx(np.cos(phase)[inside], abs=error)
    assert change[inside] == pytest.approx(-turning * np.cos(phase)[inside], abs=error / STEP)


def test_a_delay_longer_than_the_record_leaves_its_ends() -> None:
    series = np.cos(TIME)[np.newaxis]
    for delay, end in ((1e9, 0), (-1e9, -1)):
        delayed, change = late(series, delay, STEP)
        assert delayed[0] == pytest.approx(np.full_like(TIME, series[0, end]), rel=1e-6)
        assert not np.abs(change).max() > 1e-6 / STEP


@pytest.mark.parametrize("samples", [25, 50, 100])
def test_speed_and_acceleration_of_a_sine_hold_with_few_samples_a_period(samples: int) -> None:
    """Differences of second order would lose 1 % of the speed where a period has 25 samples."""
    time = 1e-2 * np.arange(3000)
    turning = 2.0 * np.pi / (samples * 1e-2)
    angle = np.sin(turning * time) + 5e-6 * np.random.default_rng(0).normal(size=len(time))
    motion = motion_of(time, angle, 10.0)
    inside = slice(200, -200)
    assert motion.speed[inside] == pytest.approx(turning * np.cos(turning * time)[inside], abs=2e-3 * turning)
    gain = (1.0 + (np.tan(np.pi / samples) / np.tan(np.pi * 10.0 * 1e-2)) ** 8) ** -1  # Butterworth's, forward and backward
    expected = -gain * turning**2 * np.sin(turning * time)
    assert motion.acceleration[inside] == pytest.approx(expected[inside], abs=2e-3 * turning**2 + 2e-5 / 1e-4)


def test_no_series_at_all_is_filtered_to_none() -> None:
    """As of joints whose torque no combination of terms shows: it once ended in an error of array shapes."""
    time = np.arange(0.0, 10.0, 0.004)
    motion = motion_of(time, np.sin(time), None, 0.1)
    assert motion.filtered(np.zeros((0, len(motion.time)))).shape == (0, len(motion.rows))


def test_noise_does_not_hide_the_acceleration_that_no_gravity_makes_up() -> None:
    """Nearly one sine: the angle makes up 99.7 % of the acceleration, and inertia rests on what is left."""
    time = np.arange(0.0, 40.0, 0.002)
    waves = [(0.6, 2.9), (0.25, 2.6)]
    angle = sum(size * np.sin(w * time) for size, w in waves)
    torque = sum(-size * w**2 * np.sin(w * time) for size, w in waves) + 10.0 * np.asarray(angle)
    motion = motion_of(time, angle + 1e-5 * np.random.default_rng(0).standard_normal(len(time)))
    rows = motion.known
    columns = np.stack([motion.acceleration, motion.angle], axis=1)[rows]
    (inertia, gravity), *_ = np.linalg.lstsq(columns, torque[rows], rcond=None)
    assert motion.cutoff < 30.0  # the sampling rate allows 50 Hz
    assert (inertia, gravity) == pytest.approx((1.0, 10.0), rel=0.03)
