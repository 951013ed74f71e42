"""Settling times against closed forms."""

from __future__ import annotations

from math import atan2, exp, inf, log, pi, sqrt

import numpy as np
import pytest
import strainwave as sw
from hypothesis import assume, given, strategies as st
from scipy.optimize import brentq
from scipy.special import lambertw
from strainwave.analysis.settling import settling_time


def recorded(time: np.ndarray, angle: np.ndarray) -> sw.Recording:
    return sw.Recording({"time": time, "output_angle": angle}, {"time": "s", "output_angle": "rad"})


def overshooting(time: np.ndarray | float, rate: float, ratio: float) -> np.ndarray:
    """The unit step response of a second-order system with a damping ratio below 1."""
    damped = rate * sqrt(1.0 - ratio**2)
    decay = np.exp(-ratio * rate * np.asarray(time)) / sqrt(1.0 - ratio**2)
    return 1.0 - decay * np.sin(damped * np.asarray(time) + atan2(sqrt(1.0 - ratio**2), ratio))


def overshooting_settles(rate: float, ratio: float, band: float) -> float:
    """When it settles: its extremes e^(-zeta omega t) lie at t = k pi / omega_d; after the last beyond the band it enters."""
    half = pi / (rate * sqrt(1.0 - ratio**2))
    last = max(k for k in range(1000) if k == 0 or exp(-ratio * rate * k * half) > band)
    side = 1.0 if last % 2 else -1.0
    return float(brentq(lambda t: side * (float(overshooting(t, rate, ratio)) - 1.0) - band, last * half, (last + 1) * half))


@pytest.mark.parametrize("band", [0.01, 0.02, 0.05])
def test_a_first_order_lag_settles_after_its_time_constant_times_a_logarithm(band: float) -> None:
    time = np.linspace(0.0, 2.0, 20_001)
    found = settling_time(recorded(time, 1.0 - np.exp(-time / 0.1)), band=band, final=1.0)
    assert found == pytest.approx(-0.1 * log(band), abs=1e-7)


def test_a_critically_damped_system_settles_where_lambert_says() -> None:
    """(1 + w t) e^(-w t) = b at w t = -1 - W(-b / e), lower branch; the textbooks' 5.834 for b = 0.02."""
    time = np.linspace(0.0, 2.0, 20_001)
    found = settling_time(recorded(time, 1.0 - (1.0 + 20.0 * time) * np.exp(-20.0 * time)), final=1.0)
    exact = -1.0 - float(lambertw(-0.02 / np.e, -1).real)
    assert exact == pytest.approx(5.834, abs=5e-4)
    assert 20.0 * found == pytest.approx(exact, abs=1e-5)


@given(rate=st.floats(2.0, 50.0), ratio=st.floats(0.05, 0.95), band=st.floats(0.01, 0.2), size=st.floats(-5.0, 5.0))
def test_an_underdamped_system_settles_behind_its_last_extreme_beyond_the_band(
    rate: float, ratio: float, band: float, size: float
) -> None:
    assume(abs(size) > 1e-3)
    extreme = log(band) / (-pi * ratio / sqrt(1.0 - ratio**2))
    assume(abs(extreme - round(extreme)) > 1e-3)  # one on the very edge of the band may fall to either side
    time = np.linspace(0.0, 12.0 / (ratio * rate), 20_001)
    exact = overshooting_settles(rate, ratio, band)
    found = settling_time(recorded(time, size * overshooting(time, rate, ratio)), band=band, final=size)
    assert found == pytest.approx(exact, abs=2e-3 / rate)


def test_a_drive_settles_as_the_second_order_system_that_it_is() -> None:
    """J v' + (k_d K_m + K_m K_b) / R v + k_p K_m / R (q - q_c) = 0, a rigid motor on a command that steps."""
    drive = sw.Drive(
        motor=sw.motor.DC(resistance=2.0, inductance=0.0, torque_constant=0.05, back_emf=0.05, inertia=1.2e-3),
        control=sw.control.PID(proportional=20.0, derivative=0.4, limit=1e6),
        load=sw.loads.Inertia(inertia=0.05),
        gear=sw.Gear(stiffness=sw.stiffness.Linear(k=1e4)),
    )
    run = sw.simulate(drive, sw.scenario.constant(1e-3, duration=2.0), dt=1e-4)
    inertia = 1.2e-3 + 0.05 / 100.0**2
    rate = sqrt(20.0 * 0.05 / 2.0 / inertia)
    ratio = (0.4 * 0.05 + 0.05**2) / 2.0 / inertia / (2.0 * rate)
    assert 0.1 < ratio < 0.4
    reached = 1e-3 * drive.gear.kinematics.ratio
    assert settling_time(run, "input_angle", final=reached) == pytest.approx(overshooting_settles(rate, ratio, 0.02), rel=1e-4)


def test_the_start_of_a_change_and_the_end_of_a_recording_count() -> None:
    time = np.linspace(0.0, 1.0, 101)
    delayed = recorded(time, np.where(time < 0.3, 0.0, 1.0 - np.exp(-(time - 0.3) / 0.02)))
    assert settling_time(delayed, start=0.3, final=1.0) == pytest.approx(0.02 * log(50.0), abs=1e-3)
    assert settling_time(delayed, final=1.0) == pytest.approx(0.3 + 0.02 * log(50.0), abs=1e-3)
    assert settling_time(recorded(time, time), final=2.0) == inf
    assert settling_time(recorded(time, time)) == pytest.approx(0.98)
    straight = recorded(np.array([0.0, 1.0]), np.array([0.0, 1.0]))
    assert settling_time(straight, band=0.25) == pytest.approx(0.75), "between its samples it is a straight line"
    assert settling_time(recorded(time[:3], np.array([1.0, 0.0, -0.01])), final=0.0) == pytest.approx(0.0098)


@pytest.mark.parametrize("size", [5e-324, 1e-300, 1.0, 1e308])
def test_the_size_of_a_change_does_not_matter(size: float) -> None:
    there_and_back = recorded(np.array([0.0, 1.0, 2.0]), size * np.array([1.0, -1.0, -1.0]))
    assert settling_time(there_and_back, band=0.25) == pytest.approx(0.75)


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"band": 0.0}, r"band = 0\.0 must lie in \(0, 1\)"),
        ({"band": 1.0}, r"band = 1\.0 must lie in \(0, 1\)"),
        ({"start": 2.0}, r"start = 2\.0 s must lie in \[0, 1\]"),
        ({"name": "speed"}, 'no column "speed"'),
        ({"final": float("nan")}, r"final = nan rad must be finite"),
        ({"final": 0.0}, r"output_angle = 0 rad at 0 s is its final value already; give the start of a change"),
    ],
)
def test_what_cannot_settle_is_refused(changed: dict[str, object], message: str) -> None:
    time = np.linspace(0.0, 1.0, 11)
    with pytest.raises(ValueError, match=message):
        settling_time(recorded(time, time), **changed)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="response must be a Recording"):
        settling_time(time)  # type: ignore[arg-type]
