"""A bias of a sensor adds to its offset, wherever in the sensor that stands."""

from __future__ import annotations

import pytest
import strainwave as sw


@pytest.mark.parametrize("quantity", ["current", "torque", "input_speed", "output_speed"])
def test_an_ideal_sensor_shows_the_bias(quantity: str) -> None:
    sensors = sw.dataset.with_faults(sw.Drive(), [sw.fault.SensorBias(quantity=quantity, offset=0.4, severity=0.5)]).sensors
    assert getattr(sensors, quantity) == sw.sensor.Gain(gain=1.0, offset=0.2)
    others = {"current", "torque", "input_speed", "output_speed"} - {quantity}
    assert all(getattr(sensors, other) == sw.sensor.Ideal() for other in others)


def test_the_bias_of_a_noisy_sensor_stands_within_its_noise() -> None:
    sensor = sw.dataset.with_faults(sw.load("tilt-actuator-lumped"), [sw.fault.SensorBias(offset=0.4)]).sensors.current
    assert (sensor.law.offset, sensor.amplitude) == (0.4, 0.02)
