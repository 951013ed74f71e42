"""Eccentricities of an encoder add as vectors."""

from __future__ import annotations

import math

import pytest
import strainwave as sw


@pytest.mark.parametrize(("shaft", "healthy"), [("input", 0.0), ("output", 2e-5)])
def test_it_adds_as_a_vector_to_that_of_the_encoder(shaft: str, healthy: float) -> None:
    fault = sw.fault.EncoderEccentricity(shaft=shaft, eccentricity=1e-4, phase=math.pi / 2, severity=0.3)
    sensor = getattr(sw.dataset.with_faults(sw.load("robot-joint"), [fault]).sensors, f"{shaft}_angle")
    assert sensor.eccentricity == pytest.approx(math.hypot(healthy, 3e-5), rel=1e-12)
    assert sensor.eccentricity_phase == pytest.approx(math.atan2(3e-5, healthy), rel=1e-12)


def test_an_ideal_sensor_has_no_disc() -> None:
    with pytest.raises(ValueError, match=r"needs a law encoder at sensors\.output_angle, where ideal is"):
        sw.dataset.with_faults(sw.Drive(), [sw.fault.EncoderEccentricity()])
