"""Sweeps of a misalignment and ramps of an actuator against the numbers of the geometry and laws; ramps that are refused."""

from __future__ import annotations

from math import pi, radians, tan

import numpy as np
import pytest
import strainwave as sw
from strainwave.diagnose.actuator_ramp import (
    ASSUMED_MISALIGNMENT,
    ERROR_PATH,
    OUTPUT,
    ActuatorRamp,
    in_series,
    noises,
    wave_generator,
)
from strainwave.diagnose.inversion import displaced, harmonics
from strainwave.diagnose.misalignment_sweep import SHOWN_TILT, SWEEPS, SweepLevels, sweep_misalignment, swing
from strainwave.native import kernels

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
    law = ASSUMED_MISALIGNMENT.replace(offset=4e-3)
    return {combine: sweep_misalignment(ramp, law.replace(combine=combine)) for combine in ("single", "mean", "max")}


# The error that goes in


@pytest.mark.slow("diagnose")
def test_the_levels_have_the_amplitudes_of_the_geometry(levels: dict[str, SweepLevels]) -> None:
    """20 um off centre, a = 25.3 mm, b = 24.7 mm: 1.001 arcmin once a turn; 8.492 um twice and 1.698 um four times."""
    row = SWEEPS["e1"][1].index(20e-6)
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


@pytest.mark.slow("diagnose")
def test_a_misalignment_on_the_shaft_alone_is_a_constant(levels: dict[str, SweepLevels]) -> None:
    for each in levels.values():
        for sweep in ("e2", "alpha"):
            assert each.column(sweep, "error_swing").max() < 1e-15, sweep
            assert np.all(each.column(sweep, "current_peak") == pytest.approx(1.0, abs=1e-6))
    alone, housing = (levels["max"].column(sweep, "current_swing") for sweep in ("e2", "e1"))
    assert np.all(alone < 1e-3 * housing), "what is left of a constant is the start of the ramp"


@pytest.mark.slow("diagnose")
def test_without_an_offset_a_tilt_acts_in_second_order_alone(levels: dict[str, SweepLevels]) -> None:
    """The tilted section of a cylinder is longer by the tilt squared: a beta^2 / 4 at order 2 (erratum E-A8)."""
    without = levels["single"].column("h", "error_2")[0]
    assert without == pytest.approx(25.3e-3 * SHOWN_TILT**2 / 4.0 * PER_METRE, rel=1e-2)
    assert levels["single"].column("h", "error_1")[0] < 1e-6 * PER_METRE * 1e-3


# What it does


def test_a_tilt_acts_as_the_eccentricity_that_it_makes_at_the_offset(ramp: ActuatorRamp) -> None:
    law = wave_generator(ramp.drive)[0].replace(combine="single")
    tilt = radians(0.1)
    tilted, shifted = (
        ramp.without_noise().with_error(each).run()
        for each in (law.replace(housing_tilt_x=tilt), law.replace(housing_eccentricity=law.offset * tan(tilt)))
    )
    moved = swing(ramp.settled(shifted)["current"])
    assert np.abs(tilted["current"] - shifted["current"]).max() < 0.01 * moved


def test_a_place_of_the_shaft_is_the_vector_that_harmonics_tell() -> None:
    law = displaced(ASSUMED_MISALIGNMENT, (3e-6, -4e-6), c_x=-2e-6)
    assert law.eccentricity == pytest.approx((3e-6, -4e-6))
    assert harmonics(law)[0] == pytest.approx(PER_METRE * (-1j * 3e-6 + 4e-6), rel=1e-3)  # -(m_x cos + m_y sin)
    assert law.generator_eccentricity == 2e-6
    assert law.generator_direction == pi


# What is refused, and what is assumed


def test_a_drive_without_a_law_of_misalignment_gets_the_assumed_dimensions() -> None:
    law, assumed = wave_generator(sw.load("robot-joint"))
    assert assumed
    assert (law.major_radius, law.minor_radius, law.offset) == (25.3e-3, 24.7e-3, 4e-3)
    own, assumed = wave_generator(sw.load("tilt-actuator-lumped"))
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
    law = wave_generator(staged.drive)[0].replace(combine="single")
    swings = []
    for ramp in (staged, in_series(staged)):
        changes = [{f"{ERROR_PATH}.housing_eccentricity": size} for size in (0.0, 20e-6)]
        runs = ramp.without_noise().with_error(law).many(changes, ["torque", "current"])
        last = [runs.member(place).between(0.5, 1.1) for place in (0, 1)]
        swings.append([swing(last[1][name] - last[0][name]) for name in ("torque", "current")])
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
        ActuatorRamp.of(weak, *SHORT).many([{f"{ERROR_PATH}.housing_tilt_x": tilt} for tilt in (0.0, 1e-3)], ["torque"])


def test_every_turn_of_the_input_has_rows_enough_for_its_orders() -> None:
    """Slow ramps have a row each millisecond; of 101 turns in a second, each has 64."""
    drive = sw.load("tilt-actuator-lumped")
    assert ActuatorRamp.of(drive, *SHORT).sample == 1e-3
    assert ActuatorRamp.of(drive, 2.0 * pi, 1.0).sample == pytest.approx(1.0 / (101.0 * 64.0), rel=1e-12)
