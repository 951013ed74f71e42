"""Detection limit: the closed form of a signature, Monte Carlo on catalogue drives, and runs that show nothing."""

from __future__ import annotations

from functools import cache
from math import sqrt

import numpy as np
import pytest
import strainwave as sw
from strainwave.diagnose.current_orders import order_lines
from strainwave.diagnose.detection import needed_signal_to_noise
from strainwave.diagnose.smallest_error import CURRENT_COLUMN, DetectionLimit, detection_limit
from strainwave.files.typical_gear import RAD_PER_ARCMIN

from tests.evidence.detection_limits import (
    Case,
    PrintedLimit,
    bound_ratio,
    cases,
    measured_limit,
    printed_limits,
    signature_drive,
)

RECORD = {"speed": 10.0, "duration": 10.0, "sample_rate": 500.0, "noise": 0.05, "order": 2.0}


@cache
def planned(load_torque: float = 20.0, **changes: float) -> DetectionLimit:
    return detection_limit(signature_drive(), load_torque=load_torque, **(RECORD | changes))


def test_the_limit_is_that_of_the_closed_form() -> None:
    found = planned()
    s = 20.0j
    loop = (4.0 + 100.0 / s) * 0.05 / (1.5e-4 * s)
    inert = 0.05 * s**2 * (8000.0 + 2.0 * s) / (0.05 * s**2 + 8000.0 + 2.0 * s) / 100.0
    gain = abs((inert + 2.0j * 20.0) / 0.05 * loop / (1.0 + loop))
    sigma = 0.05 * sqrt(2.0 / found.samples)
    needed = needed_signal_to_noise(0.9, 1e-3, found.freedom)
    assert abs(found.gain) == pytest.approx(gain, rel=5e-3)
    assert found.sigma == pytest.approx(sigma, rel=0.01)
    assert found.amplitude == pytest.approx(sigma * needed / gain, rel=0.015)
    assert found.arcminutes == pytest.approx(found.amplitude / RAD_PER_ARCMIN)


@pytest.mark.slow("diagnose")
def test_the_limit_falls_with_load_time_and_a_quieter_sensor() -> None:
    base = planned()
    assert planned(40.0).amplitude == pytest.approx(0.5 * base.amplitude, rel=0.01)
    assert planned(noise=0.025).amplitude == pytest.approx(0.5 * base.amplitude, rel=0.01)
    assert planned(duration=20.0).sigma == pytest.approx(sqrt(0.5) * base.sigma, rel=0.03)
    assert planned(duration=20.0).amplitude < sqrt(0.5) * base.amplitude  # there are more lines around the order as well
    assert planned(sample_rate=1000.0).amplitude == pytest.approx(sqrt(0.5) * base.amplitude, rel=0.02)
    assert planned(false_alarm=1e-2).amplitude < base.amplitude < planned(tests=10).amplitude  # type: ignore[arg-type]


def test_an_unloaded_slow_run_is_insensitive_and_a_loaded_one_is_not() -> None:
    unloaded, loaded = planned(0.0), planned()
    assert unloaded.insensitive
    assert "No alarm means nothing" in unloaded.remarks[0]
    assert not loaded.insensitive
    assert unloaded.amplitude > 100.0 * loaded.amplitude


def test_a_load_that_turns_the_drive_back_is_refused() -> None:
    with pytest.raises(
        ValueError, match=r"turns its input by -.* rad in 10 s, loaded with 1e\+06 N.m; speed = 10 rad/s makes 100"
    ):
        planned(1e6)


def test_the_page_has_the_tables_of_load_speed_and_duration() -> None:
    varied = [each.varied for each in printed_limits()]
    assert [varied.count(name) for name in ("load_torque", "speed", "duration")] == [5, 10, 4]


@pytest.mark.slow("diagnose")
@pytest.mark.parametrize(
    "printed",  # those that take the least time; `python -m tests.evidence.detection_limits` computes all
    [
        each
        for each in printed_limits()
        if (each.varied, each.value) in (("load_torque", 0.0), ("load_torque", 40.0), ("speed", 50.0), ("duration", 5.0))
    ],
    ids=lambda each: f"{each.varied} {each.value:g}, {each.load_torque:g} N.m",
)
def test_a_limit_is_the_one_that_the_page_prints(printed: PrintedLimit) -> None:
    found = printed.computed()
    assert printed.is_met_by(found), found.arcminutes


@pytest.mark.slow("diagnose")
@pytest.mark.parametrize("name", ["space-pointing-joint", "position-drive", "two-inertia-gear, PI"])
def test_the_planned_limit_is_met(name: str) -> None:
    case = next(each for each in cases() if each.name == name)
    limit = case.limit
    measured, shares = measured_limit(case, limit, 1000)
    assert measured == pytest.approx(limit.amplitude, rel=0.2)
    assert shares[1] == pytest.approx(0.9, abs=3.0 * sqrt(0.09 / 1000) + 0.01)


@pytest.mark.slow("diagnose")
def test_order_lines_detects_what_was_planned() -> None:
    """The recordings that a user has, each with its noise, through the function that a user calls."""
    case = Case("signature", signature_drive(), 10.0, 20.0, 0.05)
    limit = case.limit
    record = case.record(limit.amplitude)
    random, draws, found = np.random.default_rng(8), 150, 0
    for _ in range(draws):
        noisy = record.with_column(CURRENT_COLUMN, record[CURRENT_COLUMN] + random.normal(0.0, case.noise, len(record)), "A")
        found += order_lines(noisy, CURRENT_COLUMN, [2.0])[0].detected
    assert found / draws == pytest.approx(0.9, abs=3.0 * sqrt(0.09 / draws))


@pytest.mark.slow("diagnose")
def test_the_bound_of_amplitudes_is_reached_on_a_catalogue_drive() -> None:
    spread, reported = bound_ratio(next(each for each in cases() if each.name == "position-drive"), 1000)
    assert spread == pytest.approx(1.0, abs=0.2)
    assert reported == pytest.approx(1.0, abs=0.2)


@pytest.mark.slow("diagnose")
def test_a_cogging_line_at_the_order_asks_for_a_baseline() -> None:
    limit = detection_limit(
        sw.load("robot-joint"), speed=50.0, load_torque=40.0, duration=5.0, sample_rate=1000.0, noise=0.01, order=6.0
    )
    assert limit.offset > limit.current
    assert any("compare it with healthy runs" in each for each in limit.remarks)


def test_runs_that_cannot_be_planned_are_refused() -> None:
    with pytest.raises(ValueError, match=r"duration = 1 s is 1\.59 revolutions"):
        planned(duration=1.0)
    with pytest.raises(ValueError, match="has less than 5 samples in a period"):
        planned(sample_rate=8.0)
    with pytest.raises(ValueError, match="records no current"):
        detection_limit(sw.load("two-inertia-gear"), load_torque=5.0, **RECORD)
    with pytest.raises(ValueError, match="turns its input by"):
        detection_limit(sw.load("space-pointing-joint"), load_torque=5.0, **(RECORD | {"speed": 200.0}))
