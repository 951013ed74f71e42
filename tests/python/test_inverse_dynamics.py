"""Inverse dynamics against motion whose torque is known exactly. Measured data: tests/real/test_emps.py."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from inverse_dynamics import Regression, RigidDrive, regression, rigid_drive
from numpy.typing import NDArray
from scipy import signal

from tests.support.samples import sample

Array = NDArray[np.float64]
TRUTH = np.array([0.02, 0.05, 0.3, -0.1])  # kg.m2, N.m.s/rad, N.m, N.m
STEP = 1e-3


def moves(dwell: float = 0.0) -> Array:
    """Trapezoidal moves forth and back: rows of duration [s] and constant acceleration [rad/s2]."""
    generator = np.random.default_rng(7)
    pieces = []
    for size in (40.0, 90.0, 150.0, 60.0) * 14:
        for acceleration in (size, -size):
            ramp, cruise = generator.uniform(0.04, 0.12), generator.uniform(0.05, 0.2)
            pieces += [(ramp, acceleration), (cruise, 0.0), (ramp, -acceleration), (dwell, 0.0)]
    return np.array(pieces)


def travel(time: Array, pieces: Array) -> tuple[Array, Array, Array]:
    """Position, speed and acceleration at these instants, in closed form from rest."""
    duration, acceleration = pieces.T
    start = np.concatenate([[0.0], np.cumsum(duration)])
    position, speed = [0.0], [0.0]
    for length, rate in pieces:
        position.append(position[-1] + speed[-1] * length + rate * length**2 / 2)
        speed.append(speed[-1] + rate * length)
    piece = np.searchsorted(start, time, side="right") - 1
    since, rate = time - start[piece], acceleration[piece]
    initial = np.array(speed)[piece]
    return np.array(position)[piece] + initial * since + rate * since**2 / 2, initial + rate * since, rate


def needed_torque(speed: Array, acceleration: Array, parameters: Array = TRUTH) -> Array:
    inertia, viscous, coulomb, offset = parameters
    return inertia * acceleration + viscous * speed + coulomb * np.sign(speed) + offset


def record(samples: int, dwell: float = 0.0) -> tuple[Array, Array, Array]:
    time = np.arange(samples) * STEP
    position, speed, acceleration = travel(time, moves(dwell))
    return position, needed_torque(speed, acceleration), time


def in_deviations(drive: RigidDrive) -> Array:
    return (drive.parameters - TRUTH) / drive.standard_deviation


def coloured(generator: np.random.Generator, samples: int, deviation: float, memory: float) -> Array:
    """First-order autoregressive noise; memory 0 is white."""
    white = generator.normal(scale=deviation * math.sqrt(1 - memory**2), size=samples)
    return np.asarray(signal.lfilter([1.0], [1.0, -memory], white))


# --- exact laws


@pytest.mark.parametrize("delay", [0.0, 2e-3, -2e-3])
@pytest.mark.parametrize("frequency", [1.0, 4.0])
def test_sine_without_coulomb_friction_has_the_closed_form_of_a_delayed_torque(frequency: float, delay: float) -> None:
    """Torque late by d turns inertia into viscous friction; central differences see a sine smaller by a known gain."""
    inertia, viscous, offset = 0.02, 0.05, -0.1
    omega, time = math.tau * frequency, np.arange(8000) * STEP
    late = time - delay
    torque = -inertia * omega**2 * np.sin(omega * late) + viscous * omega * np.cos(omega * late) + offset
    drive = rigid_drive(np.sin(omega * time), torque, time)

    phase = omega * delay
    seen_speed, seen_acceleration = np.sinc(omega * STEP / math.pi), np.sinc(omega * STEP / math.tau) ** 2
    assert drive.inertia == pytest.approx(
        (inertia * math.cos(phase) - viscous * math.sin(phase) / omega) / seen_acceleration, rel=1e-6
    )
    assert drive.viscous == pytest.approx(
        (viscous * math.cos(phase) + inertia * omega * math.sin(phase)) / seen_speed, rel=1e-6
    )
    assert drive.coulomb == pytest.approx(0.0, abs=1e-6)
    assert drive.offset == pytest.approx(offset, rel=1e-6)


@given(factor=st.floats(-10.0, 10.0), other=st.tuples(*[st.floats(-1.0, 1.0)] * 4))
@settings(max_examples=20, deadline=None)
def test_the_estimate_is_linear_in_the_torque(factor: float, other: tuple[float, ...]) -> None:
    position, torque, time = record(3000)
    _, speed, acceleration = travel(time, moves())
    second = needed_torque(speed, acceleration, np.array(other))
    together = rigid_drive(position, factor * torque + second, time).parameters
    apart = factor * rigid_drive(position, torque, time).parameters + rigid_drive(position, second, time).parameters
    assert together == pytest.approx(apart, rel=1e-9, abs=1e-12)


@given(scale=st.floats(1e-3, 1e3), start=st.floats(-100.0, 100.0))
@settings(max_examples=20, deadline=None)
def test_another_unit_of_position_rescales_inertia_and_viscous_friction_alone(scale: float, start: float) -> None:
    position, torque, time = record(3000)
    drive, scaled = rigid_drive(position, torque, time), rigid_drive(scale * position, torque, start + time)
    per_unit = np.array([1 / scale, 1 / scale, 1.0, 1.0])
    assert scaled.parameters == pytest.approx(drive.parameters * per_unit, rel=1e-6)
    assert scaled.standard_deviation == pytest.approx(drive.standard_deviation * per_unit, rel=1e-5)


def test_mirrored_motion_and_torque_change_the_sign_of_the_offset_alone() -> None:
    position, torque, time = record(3000)
    mirrored = rigid_drive(-position, -torque, time).parameters
    assert mirrored == pytest.approx(rigid_drive(position, torque, time).parameters * [1, 1, 1, -1], rel=1e-9)


@pytest.mark.parametrize("cutoff", [None, 50.0])
def test_neither_torque_at_rest_nor_the_filters_answer_to_a_stop_reach_the_fit(cutoff: float | None) -> None:
    position, torque, time = record(8000, dwell=0.15)
    resting = travel(time, moves(dwell=0.15))[1] == 0.0
    assert resting.mean() > 0.25
    fits = [
        rigid_drive(position, np.where(resting, held, torque), time, cutoff=cutoff).parameters
        for held in (0.0, -0.35, 0.2, 5.0)
    ]
    for parameters in fits[1:]:
        assert parameters == pytest.approx(fits[0], rel=1e-12)
    assert fits[0] == pytest.approx(TRUTH, rel=0.01)
    assert fits[0][0] == pytest.approx(TRUTH[0], rel=1e-3)


# --- statistics: seeds are fixed, so every run is the same


@pytest.mark.slow("physics")
@pytest.mark.parametrize("dwell", [0.0, 0.15])
@pytest.mark.parametrize(("position_noise", "torque_noise"), [(2e-5, 0.05), (2e-5, 0.3), (1e-3, 0.05)])
def test_truth_lies_within_three_deviations(dwell: float, position_noise: float, torque_noise: float) -> None:
    """All four at once, in 95 % of the records; the noise is white, of position [rad] and torque [N.m]."""
    position, torque, time = record(6000, dwell)
    inside = []
    for seed in range(sample(60, 200)):
        generator = np.random.default_rng(seed)
        noisy = position + generator.normal(scale=position_noise, size=len(time))
        drive = rigid_drive(noisy, torque + generator.normal(scale=torque_noise, size=len(time)), time)
        inside.append(np.all(np.abs(in_deviations(drive)) < 3))
    assert np.mean(inside) >= 0.95


@pytest.mark.slow("physics")
def test_deviation_is_the_scatter_of_the_estimates() -> None:
    """Neither too small nor generous: 200 estimates scatter by 0.85 to 1.15 of what each record predicts."""
    position, torque, time = record(6000)
    errors = []
    for seed in range(200):
        generator = np.random.default_rng(seed)
        noise = generator.normal(scale=0.3, size=len(time))
        errors.append(in_deviations(rigid_drive(position, torque + noise, time)))
    scatter = np.std(errors, axis=0)
    assert np.all((scatter > 0.85) & (scatter < 1.15)), scatter


def textbook_deviation(rows: Regression, parameters: Array) -> Array:
    residual = rows.torque - rows.matrix @ parameters
    variance = residual @ residual / (len(residual) - 4)
    return np.sqrt(variance * np.diag(np.linalg.inv(rows.matrix.T @ rows.matrix)))


@pytest.mark.slow("physics")
def test_correlated_residuals_are_covered_where_the_textbook_covariance_is_not() -> None:
    position, torque, time = record(10_000)
    inside, textbook = [], []
    for seed in range(200):
        disturbed = torque + coloured(np.random.default_rng(seed), len(time), deviation=0.2, memory=0.95)
        drive, rows = rigid_drive(position, disturbed, time), regression(position, disturbed, time)
        inside.append(np.all(np.abs(in_deviations(drive)) < 3))
        error = (drive.parameters - TRUTH) / textbook_deviation(rows, drive.parameters)
        textbook.append(np.all(np.abs(error) < 3))
    assert np.mean(inside) >= 0.95
    assert np.mean(textbook) < 0.75


def advance(position: float, speed: float, torque: float, step: float) -> tuple[float, float]:
    """One step of the true drive at constant torque, in closed form, with its reversals and its sticking."""
    inertia, viscous, coulomb, offset = TRUTH.tolist()
    push, rate = torque - offset, viscous / inertia
    while step > 0:
        if speed == 0 and abs(push) <= coulomb:
            return position, 0.0
        side = math.copysign(1.0, speed or push)
        final = (push - side * coulomb) / viscous
        stop = math.log1p(-speed / final) / rate if final * side < 0 else math.inf
        elapsed = min(step, stop)
        decay = math.exp(-rate * elapsed)
        position += final * elapsed + (speed - final) * (1 - decay) / rate
        speed = 0.0 if stop < step else final + (speed - final) * decay
        step -= elapsed
    return position, speed


def closed_loop(seed: int, samples: int = 6000) -> tuple[Array, Array, Array]:
    """A cascaded controller follows the moves on a noisy encoder, against a random load of 0.05 N.m."""
    generator = np.random.default_rng(seed)
    time = np.arange(samples) * STEP
    reference = travel(time, moves())[0]
    encoder, sensor, load = generator.normal(size=(3, samples)) * [[2e-5], [0.02], [0.05]]
    measured, command = np.empty(samples), np.empty(samples)
    position = speed = before = 0.0
    for k in range(samples):
        measured[k] = position + encoder[k]
        command[k] = 1.5 * (60.0 * (reference[k] - measured[k]) - (measured[k] - before) / STEP)
        before = measured[k]
        position, speed = advance(position, speed, float(command[k] + load[k]), STEP)
    applied = (command + np.concatenate([command[:1], command[:-1]])) / 2  # around the instant, not after it
    return measured, applied + sensor, time


@pytest.mark.slow("physics")
def test_closed_loop_does_not_bias_the_estimate() -> None:
    errors = np.array([in_deviations(rigid_drive(*closed_loop(seed))) for seed in range(40)])
    assert np.mean(np.all(np.abs(errors) < 3, axis=1)) >= 0.95
    assert np.all(np.abs(errors.mean(axis=0)) < 0.5)


def passed_noise(deviation: float, cutoff: float) -> float:
    """Power that white noise of the position leaves in the decimated acceleration, from the filters' responses."""
    decimation = round(1 / (STEP * cutoff))
    frequency, smoothing = signal.freqz_sos(signal.butter(4, cutoff, fs=1 / STEP, output="sos"), 20_000, fs=1 / STEP)
    _, lowpass = signal.freqz_sos(signal.cheby1(8, 0.05, 0.8 / decimation, output="sos"), 20_000)
    difference = (2 * np.sin(math.pi * frequency * STEP) / STEP) ** 2
    density = 2 * STEP * deviation**2 * np.abs(smoothing * lowpass) ** 4 * difference**2
    return float(np.trapezoid(density, frequency))


@pytest.mark.parametrize("deviation", [1.5e-3, 3e-3])
def test_noise_attenuates_inertia_by_its_share_in_the_acceleration(deviation: float) -> None:
    """The law behind the choice of the cut-off, which keeps this share below 0.1 %, with the filters' skirts 0.13 %."""
    position, torque, time = record(6000)
    lost, shares, lost_by_default = [], [], []
    for seed in range(20):
        noisy = position + np.random.default_rng(seed).normal(scale=deviation, size=len(time))
        acceleration = regression(noisy, torque, time, cutoff=100.0).matrix[:, 0]
        shares.append(passed_noise(deviation, cutoff=100.0) / np.mean(acceleration**2))
        lost.append(1 - rigid_drive(noisy, torque, time, cutoff=100.0).inertia / TRUTH[0])
        lost_by_default.append(1 - rigid_drive(noisy, torque, time).inertia / TRUTH[0])
    assert np.mean(lost) == pytest.approx(np.mean(shares), rel=0.1)
    assert np.mean(lost_by_default) < 1.3e-3 + 3 * np.std(lost_by_default) / math.sqrt(len(lost_by_default))


# --- the choice of the cut-off


def test_quiet_position_takes_a_tenth_of_the_sampling_rate() -> None:
    assert rigid_drive(*record(3000)).cutoff == pytest.approx(100.0)


def test_cutoff_falls_as_the_noise_to_the_power_two_fifths() -> None:
    """Noise power in the pass band grows with edge⁵ deviation²; ten times the noise costs a factor 10^0.4 = 2.5."""
    position, torque, time = record(20_000)
    noise = np.random.default_rng(1).normal(size=len(time))
    fine, coarse = (rigid_drive(position + size * noise, torque, time).cutoff for size in (1e-3, 1e-2))
    assert fine / coarse == pytest.approx(10**0.4, rel=0.1)


def test_given_cutoff_is_used() -> None:
    drive = rigid_drive(*record(3000), cutoff=50.0)
    assert drive.cutoff == 50.0
    assert drive.samples == pytest.approx(3000 / 20 - 10, abs=2)  # decimation 1000/50, five rows less at each end


# --- the result


def test_predicted_torque_is_the_sum_of_its_terms() -> None:
    drive = RigidDrive(2.0, 3.0, 5.0, 7.0, np.eye(4), residual_rms=0.0, cutoff=1.0, samples=10)
    assert drive.torque([1.0, -1.0, 0.0], [10.0, 0.0, 0.0]).tolist() == [35.0, -1.0, 7.0]


def test_correlation_and_deviation_are_those_of_the_covariance() -> None:
    drive = rigid_drive(*record(3000))
    assert np.diag(drive.correlation) == pytest.approx(1.0)
    assert np.all(np.abs(drive.correlation) <= 1 + 1e-12)
    assert drive.correlation[1, 2] * drive.standard_deviation[1] * drive.standard_deviation[2] == pytest.approx(
        drive.covariance[1, 2]
    )


# --- refusals


def spoil(values: Array, place: int, value: float) -> Array:
    spoiled = values.copy()
    spoiled[place] = value
    return spoiled


Case = Callable[[Array, Array, Array], tuple[Any, Any, Any]]
REFUSED: dict[str, tuple[Case, str]] = {
    "not a number": (lambda q, u, t: (spoil(q, 5, math.nan), u, t), r"position\[5\] = nan must be finite"),
    "infinite": (lambda q, u, t: (q, spoil(u, 7, math.inf), t), r"torque\[7\] = inf must be finite"),
    "unequal length": (lambda q, u, t: (q, u[:-1], t), r"torque has shape \(2999,\), time \(3000,\)"),
    "two dimensions": (lambda q, u, t: (q[:, None], u, t), r"position has shape \(3000, 1\)"),
    "too short": (lambda q, u, t: (q[:29], u[:29], t[:29]), r"has 29 samples; at least 30"),
    "few rows": (lambda q, u, t: (q[:200], u[:200], t[:200]), r"forward in \d+ and backward in 0 samples"),
    "shuffled": (lambda q, u, t: (q, u, spoil(t, 10, t[8])), r"time\[10\] = 0.008 s must exceed time\[9\] = 0.009 s"),
    "jitter": (lambda q, u, t: (q, u, spoil(t, 10, 0.0102)), r"time\[10\] = 0.0102 s lies 0.2 steps of 0.001 s off"),
    "one direction": (lambda q, u, t: (t + 0.01 * np.sin(t), u, t), r"backward in 0 samples decimated at 100 Hz"),
    "standstill": (lambda q, u, t: (0.0 * q, u, t), r"forward in 0 and backward in 0"),
    "noise alone": (
        lambda q, u, t: (np.random.default_rng(0).normal(size=len(q)), u, t),
        r"the shaft does not move beyond the noise of its angle",
    ),
}


@pytest.mark.parametrize("case", REFUSED)
def test_refuses(case: str) -> None:
    change, message = REFUSED[case]
    with pytest.raises(ValueError, match=message):
        rigid_drive(*change(*record(3000)))


@pytest.mark.parametrize("cutoff", [0.0, -1.0, 5e-324, 0.3, 500.0, math.nan])
def test_refuses_a_cutoff_outside_the_band(cutoff: float) -> None:
    with pytest.raises(ValueError, match=r"cutoff = \S+ Hz must lie in \(0\.333444, 500\)$"):  # record: 2999 steps of 1 ms
        rigid_drive(*record(3000), cutoff=cutoff)


def identified_or_refused(samples: int, cutoff: float | None) -> RigidDrive | str:
    try:
        return rigid_drive(*record(samples), cutoff=cutoff)
    except ValueError as refusal:
        return str(refusal)


@given(samples=st.integers(30, 400), cutoff=st.none() | st.floats(0.01, 499.0))
@settings(max_examples=100, deadline=None)
def test_short_records_are_refused_by_name_or_give_finite_values(samples: int, cutoff: float | None) -> None:
    result = identified_or_refused(samples, cutoff)
    if isinstance(result, str):
        assert result.startswith(("position ", "cutoff = "))
    else:
        assert np.isfinite(result.parameters).all()
        assert np.isfinite(result.covariance).all()
