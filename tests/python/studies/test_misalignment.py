"""The study of document A's misalignment against closed forms, the numbers of its geometry, and laws."""

from __future__ import annotations

from dataclasses import replace
from math import log, pi, radians, tan

import numpy as np
import pytest
import strainwave as sw
from strainwave.diagnose.actuator_ramp import ASSUMED, ERROR, INPUT, OUTPUT, ActuatorRamp, geometry, in_series, noises
from strainwave.diagnose.inversion import displaced, harmonics
from strainwave.native import kernels
from strainwave.studies import misalignment as study
from strainwave.studies.misalignment import SweepLevels, passed, recovered, share_by_ideal_loop, swept

SHORT = radians(60.0), 3.0  # stroke and time of the ramps of these tests
PER_METRE = tan(radians(20.0)) / 25e-3  # rad at the output per metre of displacement, of the assumed dimensions


@pytest.fixture(scope="module")
def ramp() -> ActuatorRamp:
    ramp = ActuatorRamp.of(sw.load("tilt-actuator-lumped"), *SHORT).closed_on(OUTPUT)
    kernels.load(ramp.drive, "simulate_many", compile_it=True)  # these tests take a million steps of it
    return ramp


@pytest.fixture(scope="module")
def levels(ramp: ActuatorRamp) -> dict[str, SweepLevels]:
    """All sweeps with the assumed dimensions."""
    law = ASSUMED.replace(offset=4e-3)
    return {combine: swept(ramp, law.replace(combine=combine)) for combine in ("single", "mean", "max")}


# The error that goes in


@pytest.mark.slow("papers")
def test_the_levels_have_the_amplitudes_of_the_geometry(levels: dict[str, SweepLevels]) -> None:
    """20 um off centre, a = 25.3 mm, b = 24.7 mm: 1.001 arcmin once a turn; 8.492 um twice and 1.698 um four times."""
    row = study.SWEEPS["e1"][1].index(20e-6)
    arcmin = 60.0 * 180.0 / pi
    assert arcmin * levels["single"].column("e1", "error_1")[row] == pytest.approx(1.001, abs=5e-4)
    assert arcmin * levels["single"].column("e1", "error_swing")[row] == pytest.approx(1.001, abs=5e-4)
    outer = levels["max"]  # the outer lobe carries, so that the error lies between 0 and 1.001 arcmin
    assert arcmin * outer.column("e1", "error_swing")[row] == pytest.approx(1.001 / 2.0, abs=5e-4)
    assert outer.column("e1", "error_2")[row] == pytest.approx(8.492e-6 * PER_METRE, rel=2e-4)
    assert outer.column("e1", "error_4")[row] == pytest.approx(1.698e-6 * PER_METRE, rel=1e-3)
    assert arcmin * outer.column("e1", "error_2")[row] == pytest.approx(0.425, abs=5e-4)
    second = 20e-6**2 * 25.3e-3 / (4.0 * 24.7e-3**2)
    assert levels["mean"].column("e1", "error_2")[row] == pytest.approx(second * PER_METRE, rel=1e-3)


@pytest.mark.slow("papers")
def test_a_misalignment_on_the_shaft_alone_is_a_constant(levels: dict[str, SweepLevels]) -> None:
    for each in levels.values():
        for sweep in study.SILENT:
            assert each.column(sweep, "error_swing").max() < 1e-15, sweep
            assert np.all(each.column(sweep, "current_peak") == pytest.approx(1.0, abs=1e-6))
    alone, housing = (levels["max"].column(sweep, "current_swing") for sweep in ("e2", "e1"))
    assert np.all(alone < 1e-3 * housing), "what is left of a constant is the start of the ramp"


@pytest.mark.slow("papers")
def test_without_an_offset_a_tilt_acts_in_second_order_alone(levels: dict[str, SweepLevels]) -> None:
    """The tilted section of a cylinder is longer by the tilt squared: a beta^2 / 4 at order 2 (erratum E-A8)."""
    without = levels["single"].column("h", "error_2")[0]
    assert without == pytest.approx(25.3e-3 * study.SHOWN_TILT**2 / 4.0 * PER_METRE, rel=1e-2)
    assert levels["single"].column("h", "error_1")[0] < 1e-6 * PER_METRE * 1e-3


# What it does


@pytest.mark.slow("papers")
def test_the_effect_grows_with_the_level_as_the_sharing_has_it(levels: dict[str, SweepLevels]) -> None:
    assert study.power_of_level(levels["single"], "e1", "current_swing") == pytest.approx(1.0, abs=0.02)
    assert study.power_of_level(levels["max"], "e1", "current_swing") == pytest.approx(1.0, abs=0.05)
    assert study.power_of_level(levels["mean"], "e1", "current_swing") == pytest.approx(2.0, abs=0.05)


def test_a_tilt_acts_as_the_eccentricity_that_it_makes_at_the_offset(ramp: ActuatorRamp) -> None:
    law = geometry(ramp.drive)[0].replace(combine="single")
    tilt = radians(0.1)
    tilted, shifted = (
        ramp.without_noise().with_error(each).run()
        for each in (law.replace(housing_tilt_x=tilt), law.replace(housing_eccentricity=law.offset * tan(tilt)))
    )
    swing = study.swing(ramp.settled(shifted)["current"])
    assert np.abs(tilted["current"] - shifted["current"]).max() < 0.01 * swing


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


@pytest.mark.slow("papers")
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
    seen = sw.order_amplitudes(sw.Recording(columns, dict.fromkeys(columns, "rad")), "output", [2.0, 4.0]).amplitude
    speed = SHORT[0] / SHORT[1]
    expected = [share(gain, order, speed, side=side) for order in (2.0, 4.0)]
    assert seen / [3e-5, 1e-5] == pytest.approx(expected, rel=0.02)


def test_an_ideal_loop_lets_pass_what_is_faster_than_itself() -> None:
    assert share_by_ideal_loop(10.0 / (2.0 * pi), 10.0) == pytest.approx(0.5**0.5)
    assert share_by_ideal_loop([1e-9, 1e9], 10.0) == pytest.approx([0.0, 1.0], abs=1e-6)


def test_ramp_times_and_gains_are_those_asked_for(ramp: ActuatorRamp, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(study, "TIMES", (1.0,))
    monkeypatch.setattr(study, "GAINS", (1.0, 4.0))
    table = passed(ramp, geometry(ramp.drive)[0]).table
    assert table["position_gain"].tolist() == [16.0, 16.0, 64.0, 64.0]
    assert table["order"].tolist() == [2.0, 4.0, 2.0, 4.0]
    turns = SHORT[0] / (2.0 * pi) * 101.0
    assert table["frequency"] == pytest.approx(table["order"] * turns / SHORT[1])


# Recovery


@pytest.mark.slow("papers")
def test_what_was_put_in_comes_back_within_its_interval(ramp: ActuatorRamp, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of 24 records with 95 % confidence 19 must agree: fewer have a probability of 1e-3.

    The square of the distance of the truth over the covariance has the median 2 ln 2 in two dimensions.
    """
    monkeypatch.setattr(study, "NOISE_TRIALS", 24)
    expected = 15e-6 * np.exp(0.6j) + 4e-3 * (tan(radians(0.05)) + 1j * tan(radians(0.03)))  # e_1 at beta_1, and h beta
    distances = []
    for each in recovered(ramp, geometry(ramp.drive)[0]):
        assert complex(*each.m) == pytest.approx(expected, rel=1e-4)
        assert each.within >= 19, (each.column, each.law.combine)
        assert min(each.first, key=lambda combine: each.first[combine].misfit) == each.law.combine
        assert each.best.half_widths[0] < 0.1 * abs(expected), "the interval tells something"
        for trial in each.trials:
            gaps = [np.subtract(trial.m, sign * np.array(each.m)) for sign in (1.0, -1.0)]
            distances.append(min(gap @ np.linalg.solve(trial.covariance, gap) for gap in gaps))
    assert np.median(distances) == pytest.approx(2.0 * log(2.0), rel=0.3)


def test_a_place_of_the_shaft_is_the_vector_that_harmonics_tell() -> None:
    law = displaced(ASSUMED, (3e-6, -4e-6), c_x=-2e-6)
    assert law.eccentricity == pytest.approx((3e-6, -4e-6))
    assert harmonics(law)[0] == pytest.approx(PER_METRE * (-1j * 3e-6 + 4e-6), rel=1e-3)  # -(m_x cos + m_y sin)
    assert law.generator_eccentricity == 2e-6
    assert law.generator_direction == pi


# What is refused, and what is assumed


def test_a_drive_without_a_law_of_misalignment_gets_the_assumed_dimensions() -> None:
    law, assumed = geometry(sw.load("robot-joint"))
    assert assumed
    assert (law.major_radius, law.minor_radius, law.offset) == (25.3e-3, 24.7e-3, 4e-3)
    own, assumed = geometry(sw.load("tilt-actuator-lumped"))
    assert not assumed
    assert own.eccentricity == (0.0, 0.0)
    assert own.pressure_angle == pytest.approx(radians(30.0))


def test_stages_in_series_are_the_lumped_set() -> None:
    """Which has its spring and its damper from its own derivation."""
    staged = ActuatorRamp.of(sw.load("tilt-actuator"), *SHORT)
    lumped = sw.load("tilt-actuator-lumped").gear
    series = in_series(staged).drive.gear
    assert series.stiffness.k == pytest.approx(lumped.stiffness.k, rel=1e-4)
    assert series.damping == pytest.approx(lumped.damping, rel=5e-3)
    plain = ActuatorRamp.of(sw.load("tilt-actuator-lumped"), *SHORT)
    assert in_series(plain) is plain


def test_stages_in_series_swing_as_the_stages_do() -> None:
    """The slowest stage is a hundred times faster than the orders, so that its own swing is less by the square of that."""
    staged = ActuatorRamp.of(sw.load("tilt-actuator"), radians(20.0), 1.1)
    law = geometry(staged.drive)[0].replace(combine="single")
    swings = []
    for ramp in (staged, in_series(staged)):
        changes = [{f"{ERROR}.housing_eccentricity": size} for size in (0.0, 20e-6)]
        runs = ramp.without_noise().with_error(law).many(changes, ["torque", "current"])
        last = [runs.member(place).between(0.5, 1.1) for place in (0, 1)]
        swings.append([study.swing(last[1][name] - last[0][name]) for name in ("torque", "current")])
    assert swings[1] == pytest.approx(swings[0], rel=5e-3)


def test_noise_is_found_and_taken_away(ramp: ActuatorRamp) -> None:
    assert len(noises(ramp.drive, "amplitude")) == 3
    quiet = ramp.without_noise().drive.sensors
    assert {quiet.current.amplitude, quiet.input_speed.amplitude, quiet.output_angle.amplitude} == {0.0}


@pytest.mark.parametrize(
    ("name", "stroke", "time", "message"),
    [
        ("position-drive", 1.5, 5.0, 'the controller "pid" of the drive has no position_gain'),
        ("tilt-actuator-lumped", 0.1, 5.0, "1.6 turns of the input; take 11.9 deg or more"),
        ("tilt-actuator-lumped", -0.1, 5.0, "stroke = -5.7"),
        ("tilt-actuator-lumped", 1.5, 0.0, "time = 0.0 s"),
        ("tilt-actuator-lumped", 1.5, 1e-320, r"time = .* s must lie in \[1e-06, 600\]"),
    ],
)
def test_what_cannot_be_run_is_refused(name: str, stroke: float, time: float, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        ActuatorRamp.of(sw.load(name), stroke, time)


def test_an_output_that_is_moved_from_outside_is_refused() -> None:
    drive = sw.load("tilt-actuator-lumped").replace(load=sw.loads.Prescribed())
    with pytest.raises(ValueError, match=r'^the load "prescribed" of the drive moves its output from outside'):
        ActuatorRamp.of(drive, *SHORT)


def test_a_drive_that_does_not_follow_is_refused() -> None:
    weak = sw.load("tilt-actuator-lumped").replace({"motor.current_limit": 0.05})
    with pytest.raises(ValueError, match=r"^the drive does not follow a ramp of 60 deg in 3 s: its input turns by \S+ rad"):
        ActuatorRamp.of(weak, *SHORT).many([{f"{ERROR}.housing_tilt_x": tilt} for tilt in (0.0, 1e-3)], ["torque"])


def test_every_turn_of_the_input_has_rows_enough_for_its_orders() -> None:
    """Slow ramps have a row each millisecond; of 101 turns in a second, each has 64."""
    drive = sw.load("tilt-actuator-lumped")
    assert ActuatorRamp.of(drive, *SHORT).sample == 1e-3
    assert ActuatorRamp.of(drive, 2.0 * pi, 1.0).sample == pytest.approx(1.0 / (101.0 * 64.0), rel=1e-12)
