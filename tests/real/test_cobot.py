"""Friction current of joint 3 of a UR3 over a warm-up (UCI 963, CC BY 4.0), 1 Hz, a task that repeats itself.

Told of these data: its friction current falls from 0.46 A at 33 degrees to 0.35 A at 42. Run with `-s` to read the numbers.
"""

from __future__ import annotations

import csv
import os
from pathlib import Path

import numpy as np
import pytest
import strainwave as sw
from strainwave.identification.candidates.steady_friction import Warming, friction_over_temperature
from strainwave.identification.reading.mapping import FileMapping

FOLDER = Path(os.environ.get("STRAINWAVE_DATA", Path(__file__).parents[3] / "shared" / "data")) / "cobot-temperature"
COLUMNS = {"Current_J3": "current", "Temperature_J3": "temperature", "Speed_J3": "speed"}
UNITS = {"current": "A", "temperature": "degC", "speed": "rad/s"}
COLD, WARM = 33.0, 42.0  # degrees
TOLD = (0.46, 0.35)  # A

pytestmark = pytest.mark.skipif(not FOLDER.is_dir(), reason=f"measured data not found: {FOLDER} (set STRAINWAVE_DATA)")


@pytest.fixture(scope="module")
def joint() -> sw.Recording:
    """The rows that have all numbers; 54 have none."""
    (path,) = FOLDER.glob("*.csv")
    with path.open(encoding="utf-8-sig") as file:
        rows = [row for row in csv.DictReader(file, delimiter=";") if all((row[name] or "").strip() for name in COLUMNS)]
    return sw.Recording({short: [float(row[name].replace(",", ".")) for row in rows] for name, short in COLUMNS.items()}, UNITS)


def at(found: Warming, temperature: float) -> float:
    return found.friction.value + found.slope.value * (temperature + 273.15 - found.reference_temperature)


def test_its_friction_falls_as_it_warms_up_and_the_interval_holds_what_is_told(joint: sw.Recording) -> None:
    found = friction_over_temperature(joint)
    low, high = found.slope.interval(0.95)
    print(f"\n{found.samples} samples in motion, {found.together} of them together")
    print(f"slope {1e3 * found.slope.value:.1f} mA/K, 95 % from {1e3 * low:.1f} to {1e3 * high:.1f}")
    print(f"{at(found, COLD):.3f} A at {COLD:g} degrees, {at(found, WARM):.3f} A at {WARM:g}")
    print(f"fall {100.0 * found.fall.value:.2f} +- {100.0 * found.fall.sigma:.2f} percent a kelvin")
    assert high < 0.0  # it does fall
    assert low < (TOLD[1] - TOLD[0]) / (WARM - COLD) < high


def test_the_level_is_that_which_is_told_within_its_interval(joint: sw.Recording) -> None:
    found = friction_over_temperature(joint)
    middle = 0.5 * (COLD + WARM) + 273.15
    told = 0.5 * sum(TOLD)
    off = told - (found.friction.value + found.slope.value * (middle - found.reference_temperature))
    spread = np.hypot(found.friction.sigma, found.slope.sigma * (found.reference_temperature - middle))
    assert abs(off) < 2.0 * spread


@pytest.mark.parametrize("slowest", [0.02, 0.1, 0.2])
def test_what_counts_as_motion_changes_the_slope_by_less_than_its_interval(joint: sw.Recording, slowest: float) -> None:
    usual, other = friction_over_temperature(joint), friction_over_temperature(joint, slowest=slowest)
    assert abs(other.slope.value - usual.slope.value) < 2.0 * usual.slope.sigma


@pytest.mark.slow("identification")
def test_a_record_of_seconds_apart_is_refused_in_words() -> None:
    """It was refused with "need at least one array to concatenate"."""
    (path,) = FOLDER.glob("*.csv")
    mapping = FileMapping(joint="3", constants={"torque_constant": 0.1})
    with pytest.raises(ValueError, match="nothing moves at a constant speed: all stretches are at rest"):
        sw.identify("csg-20-100", [path], mapping=mapping)
