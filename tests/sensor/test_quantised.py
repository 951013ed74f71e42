"""A sensor whose reading goes in steps."""

from __future__ import annotations

from math import tau

import numpy as np
import pytest
import strainwave as sw

from tests.sensor.probe import shown

STEP = 0.05
MOTION = sw.scenario.sine(1.0, 3.0, 1.0) + sw.scenario.ramp(0.3, 1.0)


@pytest.mark.parametrize(
    "law",
    [
        sw.sensor.Ideal(),
        sw.sensor.Gain(gain=1.1, offset=0.02),
        sw.sensor.FirstOrder(time_constant=0.02),
        sw.sensor.SecondOrder(natural_frequency=200.0),
        sw.sensor.Delayed(law=sw.sensor.FirstOrder(time_constant=0.01), delay=0.01),
        sw.sensor.Noisy(law=sw.sensor.Delayed(delay=0.01), amplitude=0.1, bandwidth=50.0, seed=3),
    ],
    ids=lambda law: law.name,
)
@pytest.mark.parametrize("quantity", ["output_angle", "output_speed"])
def test_it_reads_the_nearest_step_of_what_its_law_shows(law: object, quantity: str) -> None:
    _, exact = shown(law, MOTION, 1e-3, quantity)
    _, read = shown(sw.sensor.Quantised(law=law, resolution=STEP), MOTION, 1e-3, quantity)
    assert read == pytest.approx(STEP * np.rint(exact / STEP), abs=1e-12)
    assert len(np.unique(np.rint(read / STEP))) > 10


def test_what_changes_much_errs_by_a_step_over_the_root_of_twelve() -> None:
    time, read = shown(sw.sensor.Quantised(resolution=1e-3), sw.scenario.ramp(1.0, 20.0), 1.7e-3)
    assert np.sqrt(np.mean((read - time) ** 2)) == pytest.approx(1e-3 / np.sqrt(12.0), rel=0.01)


def test_of_an_angle_it_is_an_encoder() -> None:
    time, read = shown(sw.sensor.Quantised(resolution=tau / 500), MOTION, 1e-3)
    assert np.array_equal(read, shown(sw.sensor.Encoder(counts=500), MOTION, 1e-3)[1])
    assert len(time) == 1001
