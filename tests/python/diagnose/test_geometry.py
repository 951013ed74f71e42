"""Misalignment from the current: coverage on drawn drives, runs that show nothing, and what no record determines."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import strainwave as sw
from numpy.testing import assert_allclose
from strainwave.diagnose.actuator_ramp import ActuatorRamp, wave_generator
from strainwave.diagnose.detection import DETECTION_PROBABILITY, FALSE_ALARM, needed_signal_to_noise
from strainwave.diagnose.geometry import Geometry, misalignment_from_current, ramp_of
from strainwave.diagnose.inversion import displaced, tilted
from strainwave.diagnose.possible_drives import PossibleDrives, trend
from strainwave.files.gear_set import GearSet
from strainwave.files.recording import Recording

from tests.evidence.recovered_misalignment import NOISE, units
from tests.support.signature_drive import signature_ramp

SET = GearSet.read("tilt-actuator-lumped")
RAMP = ActuatorRamp.of(SET.drive, stroke=float(np.radians(60.0)), duration=3.0)
LAW, _ = wave_generator(SET.drive)
MEMBERS, UNITS = 32, 24
UNITS_INSIDE = 20  # of 24: fewer have a probability of 0.4 % if 95 % are inside


@pytest.fixture(scope="module")
def drives() -> PossibleDrives:
    return PossibleDrives.of(SET, RAMP, members=MEMBERS)


def record_of(ramp: ActuatorRamp, law: Any, noise: float = NOISE, seed: int = 0) -> Recording:
    run = ramp.with_error(law).run()
    current = run["current"] + noise * np.random.default_rng(seed).standard_normal(len(run))
    columns = {"time": run.time, "input_angle": run["input_angle"], "current": current}
    return Recording(columns, {"time": "s", "input_angle": "rad", "current": "A"})


def diagnosed(law: Any, drives: PossibleDrives, ramp: ActuatorRamp = RAMP) -> Geometry:
    return misalignment_from_current(record_of(ramp, law), SET, drives=drives)


@pytest.mark.slow("diagnose")
def test_the_interval_covers_drawn_drives_and_that_of_noise_alone_does_not(drives: PossibleDrives) -> None:
    found = list(units(SET, RAMP, UNITS, drives=drives))
    inside = np.array([unit.inside for unit in found]).sum(axis=0)
    assert (inside >= UNITS_INSIDE).all(), inside
    assert sum(unit.inside_by_noise for unit in found) < UNITS_INSIDE  # the test can fail: the model's share matters
    assert all(unit.result.estimate.combine in ("max", "single") for unit in found)  # c_x beyond m makes one lobe carry
    assert np.median([abs(unit.error[0]) for unit in found]) < 0.5e-6


@pytest.mark.slow("diagnose")
@pytest.mark.parametrize("combine", ["single", "max"])
def test_how_the_lobes_share_follows_from_the_orders(combine: str, drives: PossibleDrives) -> None:
    law = LAW.replace(combine=combine, housing_eccentricity=14e-6, housing_direction=0.5)
    found = diagnosed(law, drives)
    assert found.condition == "misaligned"
    assert found.estimate.combine == combine
    assert found.contains(law.eccentricity)
    assert not found.contains((1.2 * law.eccentricity[0], law.eccentricity[1]))


@pytest.mark.slow("diagnose")
def test_the_place_of_the_generator_on_its_shaft_is_reported_with_its_interval(drives: PossibleDrives) -> None:
    law = displaced(LAW.replace(combine="max"), (12e-6, 5e-6), 4e-6)
    found = diagnosed(law, drives)
    estimate = found.estimate
    sign = np.sign(np.dot(estimate.m, (12e-6, 5e-6)))  # -m and -c_x make the same orders
    half = estimate.interval_factor * estimate.c_x_sigma
    assert sign * estimate.c_x == pytest.approx(4e-6, abs=half)
    assert half < 1e-6
    assert "the generator is c_x = " in found.words()
    lone = diagnosed(LAW.replace(combine="single", housing_eccentricity=14e-6), drives)
    assert "c_x" not in lone.words()


@pytest.mark.slow("diagnose")
def test_a_tilt_is_told_as_the_eccentricity_that_it_is_equivalent_to(drives: PossibleDrives) -> None:
    law = tilted(LAW, (10e-6, -20e-6))
    assert_allclose(law.eccentricity, (10e-6, -20e-6), rtol=1e-4)
    found = diagnosed(law, drives)
    low, high = found.size_interval
    assert low < np.hypot(10e-6, 20e-6) < high
    assert found.tilt == pytest.approx(np.hypot(10e-6, 20e-6) / 4e-3, rel=0.05)
    words = found.words()
    for part in (
        "a housing eccentricity of",
        "or a tilt of the housing of 0.3",
        "at h = 4 mm",
        "or any sum of both equal to m",
    ):
        assert part in words
    assert "e2 and alpha alone change no harmonic and are not identifiable from this record" in words


@pytest.mark.slow("diagnose")
def test_the_generators_own_misalignment_changes_no_order(drives: PossibleDrives) -> None:
    law = LAW.replace(generator_eccentricity=30e-6, generator_tilt_x=5e-3)
    found = diagnosed(law, drives)
    assert found.condition == "no misalignment shown"
    assert "healthy" not in found.words()
    assert not found.detected


@pytest.mark.slow("diagnose")
def test_a_drive_outside_of_the_set_is_reported(drives: PossibleDrives) -> None:
    heavy = RAMP.drive.replace({"load.moment_slope": 0.64})
    ramp = ActuatorRamp.of(heavy, RAMP.stroke, RAMP.duration)
    found = diagnosed(LAW.replace(housing_eccentricity=14e-6), drives, ramp)
    assert any("contradicts the drives of this set" in doubt for doubt in found.contradictions)
    assert diagnosed(LAW.replace(housing_eccentricity=14e-6), drives).contradictions == ()


@pytest.mark.slow("diagnose")
def test_orders_that_no_misalignment_has_are_reported(drives: PossibleDrives) -> None:
    law = sw.kinematic_error.Fourier(order=[2.0, 3.0], amplitude=[2e-4, 2e-4], phase=[0.0, 1.0])
    assert any("do not have the ratios of a misalignment" in doubt for doubt in diagnosed(law, drives).contradictions)


@pytest.mark.slow("diagnose")
def test_an_unloaded_slow_run_is_insensitive_and_a_loaded_one_is_not() -> None:
    """Section 7.9 of the physics: about 1.2 mA without load, 240 mA with 20 N.m."""
    currents = {}
    for load in (0.0, 20.0):
        ramp = signature_ramp(load)
        found = misalignment_from_current(
            record_of(ramp, ramp.drive.gear.kinematic_error.replace(amplitude=[0.0, 0.0, 0.0])),
            ramp.drive,
            ramp=ramp,
            drives=PossibleDrives.of(ramp.drive, ramp, members=12),
            reference_error=3e-4,
        )
        currents[load] = 1e3 * found.sensitivity.current
        assert "healthy" not in found.words().replace("whether the gear is healthy", "")
        assert found.condition == ("no misalignment shown" if load else "insensitive")
        if not load:
            assert found.words().startswith("insensitive: an error of 1.03 arcmin at order 2 would make 1.19 mA")
            assert found.sensitivity.resolved > found.sensitivity.current
    assert currents[0.0] == pytest.approx(1.2, rel=0.1)
    assert currents[20.0] == pytest.approx(240.0, rel=0.05)


def test_the_least_amplitude_is_detected_as_often_as_stated() -> None:
    chance = np.random.default_rng(5)
    noise = chance.standard_normal((2, 200_000))
    threshold = np.sqrt(-2.0 * np.log(1e-3))
    assert np.mean(np.hypot(*noise) > threshold) == pytest.approx(1e-3, rel=0.25)
    least = needed_signal_to_noise(DETECTION_PROBABILITY, FALSE_ALARM, np.inf)
    assert np.mean(np.hypot(noise[0] + least, noise[1]) > threshold) == pytest.approx(0.9, abs=0.004)


def test_a_trend_is_not_changed_by_orders_and_its_deviation_is_that_of_noise() -> None:
    angle = np.linspace(0.3, 61.7, 4000)
    u = 2.0 * (angle - angle.min()) / np.ptp(angle) - 1.0
    chance = np.random.default_rng(2)
    values = 2.0 + 0.3 * u + 0.1 * (1.5 * u**2 - 0.5) + 0.5 * np.sin(angle + 1.0)
    found = []
    for _ in range(200):
        columns = {"input_angle": angle, "current": values + 0.02 * chance.standard_normal(len(angle))}
        terms, sigma = trend(Recording(columns, {"input_angle": "rad", "current": "A"}))
        found.append(terms)
    assert_allclose(np.mean(found, axis=0), [2.0, 0.3, 0.1], atol=5e-4)
    assert_allclose(np.std(found, axis=0), sigma, rtol=0.2)


def test_a_ramp_follows_from_a_record_and_one_backwards_is_refused() -> None:
    record = record_of(RAMP, LAW)
    ramp = ramp_of(record, SET.drive)
    assert (ramp.stroke, ramp.duration) == (pytest.approx(RAMP.stroke, rel=2e-3), pytest.approx(RAMP.duration, rel=1e-3))
    backwards = Recording(
        {"time": record.time, "input_angle": -record["input_angle"], "current": record["current"]},
        {"time": "s", "input_angle": "rad", "current": "A"},
    )
    with pytest.raises(ValueError, match="turn the signs of angle and current"):
        ramp_of(backwards, SET.drive)
