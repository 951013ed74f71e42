"""The study of the actuator paper's misalignment against closed forms, the numbers of its geometry, and laws."""

from __future__ import annotations

from dataclasses import replace
from math import log, pi, radians, tan

import misalignment as study
import numpy as np
import pytest
import strainwave as sw
from misalignment import INPUT, OUTPUT, passed, power_of_level, recovered, share_by_ideal_loop
from strainwave.diagnose import ActuatorRamp, SweepLevels, sweep_misalignment, wave_generator
from strainwave.native import kernels

pytestmark = pytest.mark.slow("papers")  # an article's study runs for seconds

SHORT = radians(60.0), 3.0  # stroke and time of the ramps of these tests
PER_METRE = tan(radians(20.0)) / 25e-3  # rad at the output per metre of displacement, of the assumed dimensions


@pytest.fixture(scope="module")
def ramp() -> ActuatorRamp:
    ramp = ActuatorRamp.of(sw.load("tilt-actuator-lumped"), *SHORT).closed_on(OUTPUT)
    kernels.load(ramp.drive, "simulate_many", compile_it=True)  # these tests take a million steps of it
    return ramp


@pytest.fixture(scope="module")
def levels(ramp: ActuatorRamp) -> dict[str, SweepLevels]:
    """All sweeps with the wave generator of the drive."""
    law, _ = wave_generator(ramp.drive)
    return {combine: sweep_misalignment(ramp, law.replace(combine=combine)) for combine in ("single", "mean", "max")}


# What it does


def test_the_effect_grows_with_the_level_as_the_sharing_has_it(levels: dict[str, SweepLevels]) -> None:
    assert power_of_level(levels["single"], "e1", "current_swing") == pytest.approx(1.0, abs=0.02)
    assert power_of_level(levels["max"], "e1", "current_swing") == pytest.approx(1.0, abs=0.05)
    assert power_of_level(levels["mean"], "e1", "current_swing") == pytest.approx(2.0, abs=0.05)


def share(gain: float, order: float, speed: float, *, side: str) -> float:
    """The share of an error that the output has, by hand: two inertias, a spring, speed and position loop, constant torque.

    In output radians, p = j n w: the motor has A = J_m p^2 + C p, C = i^2 K_t (k_p + k_i / p), the load L = J p^2 + b p on the
    spring k + c p; the reaction of the error on the motor is i n T e. A loop on the output asks for -K times the output angle,
    a loop on the motor for -K times the motor's.
    """
    ratio, constant, spring, damping, load_inertia, viscous, torque = 101.0, 0.0919, 1.1488e4, 1.22, 0.6, 2.0, 20.0
    motor_inertia = ratio**2 * (8e-6 + 1.7e-5)
    p = 1j * order * speed * ratio
    loop = ratio**2 * constant * (0.0885 + 0.885 / p)
    motor, load = motor_inertia * p**2 + loop * p, load_inertia * p**2 + viscous * p
    reaction = 1j * order * ratio * (torque + viscous * speed)
    stretch = 1.0 + load / (spring + damping * p)
    if side == INPUT:
        motor, position = motor + loop * gain, 0.0
    else:
        position = loop * gain
    return float(abs((reaction - motor) / (motor * stretch + position + load)))


@pytest.mark.parametrize("side", [OUTPUT, INPUT])
@pytest.mark.parametrize("gain", [8.0, 64.0])
def test_what_reaches_the_output_is_what_the_linear_drive_lets_pass(gain: float, side: str) -> None:
    """Constant load, so that the average over the ramp is the answer at one point of work."""
    drive = sw.load("tilt-actuator-lumped").replace(
        {
            "gear.friction_output": sw.friction.Coulomb(coulomb=20.0, viscous=2.0),
            "gear.damping": 1.22,
            "gear.kinematic_error": sw.kinematic_error.Fourier(order=[2, 4], amplitude=[3e-5, 1e-5], phase=[0.0, 0.0]),
            "load": sw.loads.Inertia(inertia=0.6),
            "sensors": sw.Sensors(),
            "control.position_gain": gain,
            "control.current_proportional": 9.0,  # a current loop so fast that it does not count
            "control.current_integral": 5680.0,
        }
    )
    ramp = replace(ActuatorRamp.of(drive, *SHORT).closed_on(side), dt=2e-5)
    runs = (ramp, ramp.with_error(sw.kinematic_error.Fourier()))
    run, straight = (each.run().between(0.5 * ramp.duration, ramp.duration) for each in runs)  # the start has died away
    columns = {"input_angle": run["input_angle"], "output": run["output_angle"] - straight["output_angle"]}
    seen = sw.orders.order_amplitudes(sw.Recording(columns, dict.fromkeys(columns, "rad")), "output", [2.0, 4.0]).amplitude
    speed = SHORT[0] / SHORT[1]
    expected = [share(gain, order, speed, side=side) for order in (2.0, 4.0)]
    assert seen / [3e-5, 1e-5] == pytest.approx(expected, rel=0.02)


def test_an_ideal_loop_lets_pass_what_is_faster_than_itself() -> None:
    assert share_by_ideal_loop(10.0 / (2.0 * pi), 10.0) == pytest.approx(0.5**0.5)
    assert share_by_ideal_loop([1e-9, 1e9], 10.0) == pytest.approx([0.0, 1.0], abs=1e-6)


def test_ramp_times_and_gains_are_those_asked_for(ramp: ActuatorRamp, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(study, "TIMES", (1.0,))
    monkeypatch.setattr(study, "GAINS", (1.0, 4.0))
    table = passed(ramp, wave_generator(ramp.drive)[0]).table
    assert table["position_gain"].tolist() == [16.0, 16.0, 64.0, 64.0]
    assert table["order"].tolist() == [2.0, 4.0, 2.0, 4.0]
    turns = SHORT[0] / (2.0 * pi) * 101.0
    assert table["frequency"] == pytest.approx(table["order"] * turns / SHORT[1])


# Recovery


def test_what_was_put_in_comes_back_within_its_interval(ramp: ActuatorRamp, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of 24 records with 95 % confidence 19 must agree: fewer have a probability of 1e-3.

    The square of the distance of the truth over the covariance has the median 2 ln 2 in two dimensions.
    """
    monkeypatch.setattr(study, "NOISE_TRIALS", 24)
    expected = 15e-6 * np.exp(0.6j) + 4e-3 * (tan(radians(0.05)) + 1j * tan(radians(0.03)))  # e_1 at beta_1, and h beta
    distances = []
    for each in recovered(ramp, wave_generator(ramp.drive)[0]):
        assert complex(*each.m) == pytest.approx(expected, rel=1e-4)
        assert each.within >= 19, (each.column, each.law.combine)
        assert min(each.first, key=lambda combine: each.first[combine].misfit) == each.law.combine
        assert each.best.half_widths[0] < 0.1 * abs(expected), "the interval determines the vector"
        for trial in each.trials:
            gaps = [np.subtract(trial.m, sign * np.array(each.m)) for sign in (1.0, -1.0)]
            distances.append(min(gap @ np.linalg.solve(trial.covariance, gap) for gap in gaps))
    assert np.median(distances) == pytest.approx(2.0 * log(2.0), rel=0.3)
