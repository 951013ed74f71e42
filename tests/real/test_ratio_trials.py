"""Two encoders of a joint with a pulley of 1.5 before its gear of 100 contradict the ratio of the gear."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
import strainwave as sw
from strainwave.identification.checks.logs import ratio_of_encoders
from strainwave.identification.reading.recognise import recognise
from strainwave.orders.two_encoders import transmission_error

TRIALS = Path(os.environ.get("STRAINWAVE_TRIALS", Path(__file__).parents[3] / "shared" / "trials"))
FILE = TRIALS / "belt150" / "log.csv"

pytestmark = pytest.mark.skipif(not FILE.is_file(), reason=f"trials not found: {FILE} (set STRAINWAVE_TRIALS)")


def test_a_belt_before_the_gear_fails_the_check_of_the_ratio_with_that_of_both() -> None:
    """Gravity would be 12.2 N.m, where 25 N.m are right."""
    whole = recognise(FILE).recording
    slower = sw.Recording({name: whole[name][::4] for name in whole.names}, {name: whole.unit(name) for name in whole.names})
    errors = transmission_error(slower)
    drive = sw.Drive(gear=sw.load("csg-20-100"), motor=sw.motor.TorqueSource(inertia=0.0), load=sw.loads.Inertia(inertia=1.2))
    (check,) = ratio_of_encoders(errors.ratio, drive, FILE.name)
    assert check.failed
    assert "--constant ratio=150;" in check.remedy
