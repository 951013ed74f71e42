"""A sensor that is late."""

from __future__ import annotations

from math import tau

import numpy as np
import pytest
import strainwave as sw
from scipy.optimize import brentq

from tests.control.discrete import TORQUE, drive as linear
from tests.control.test_delay_margin import LAW as POSITION, crossover
from tests.sensor.probe import from_elsewhere, probe, shown

DELAY = 4e-3
LAW = sw.sensor.Delayed(delay=DELAY)


def passed(frequency: float) -> complex:
    """Four sections of Pade's approximation at a frequency [rad/s]."""
    s = 1j * frequency * DELAY / 8.0
    return ((1.0 - s) / (1.0 + s)) ** 4


@pytest.mark.parametrize("frequency", [3.0, 40.0, 80.0, 300.0])
def test_a_sine_passes_as_four_sections_let_it(frequency: float) -> None:
    w = tau * frequency
    time, found = shown(LAW, sw.scenario.sine(1.0, frequency, 0.15), 1e-5)
    late = time > 0.1
    assert found[late] == pytest.approx((passed(w) * np.exp(1j * w * time[late])).imag, abs=1e-7)


@pytest.mark.parametrize(("share", "lacking"), [(1.0, 0.0052), (2.0, 0.0201)])
def test_its_phase_lacks_as_much_as_the_text_says(share: float, lacking: float) -> None:
    """Of a pure delay, at 1 and 2 over it and below; sizes are kept at all frequencies."""
    for part in (1.0, 0.7, 0.2):
        phase = -np.angle(passed(part * share / DELAY))
        error = 1.0 - phase / (part * share)
        assert error == pytest.approx(lacking, abs=5e-5) if part == 1.0 else 0.0 < error < lacking
        assert abs(passed(part * share / DELAY)) == pytest.approx(1.0, rel=1e-14)


def test_a_steady_motion_arrives_late_by_the_delay() -> None:
    time, found = shown(LAW, sw.scenario.ramp(3.0, 0.1), 1e-4)
    assert found[time > 0.05] == pytest.approx(3.0 * (time[time > 0.05] - DELAY), abs=1e-9)


def test_a_slow_motion_arrives_as_it_was() -> None:
    motion = sw.scenario.sine(1.0, 5.0, 0.5)
    time, found = shown(LAW, motion, 1e-4)
    late = time > 0.05
    assert found[late] == pytest.approx(motion.value(time[late] - DELAY), abs=2e-5)


def test_what_is_under_way_arrives() -> None:
    """Of what is only in the last section 2 e^(-8 t / delta) is seen."""
    time, found = from_elsewhere(LAW, {"section[3]": 1.0}, 0.03, 1e-5)
    assert found == pytest.approx(2.0 * np.exp(-8.0 * time / DELAY), abs=1e-8)


def test_the_loop_that_it_closes_is_stable_up_to_the_margin_of_the_loop() -> None:
    """Angle and speed late alike: phase margin over crossover, to the 1.2 percent that the phase lacks there."""
    frequency, margin = crossover()

    def fastest_growth(delay: float) -> float:
        late = sw.sensor.Delayed(delay=delay)
        drive = linear(POSITION, TORQUE, sensors=sw.Sensors(input_angle=late, input_speed=late))
        return float(sw.linearise(drive).poles.real.max())

    critical = brentq(fastest_growth, 1e-3, 12e-3, xtol=1e-9)
    lacking = 1.0 - 8.0 * np.arctan(critical * frequency / 8.0) / (critical * frequency)
    assert critical * (1.0 - lacking) == pytest.approx(margin / frequency, rel=1e-6)
    assert lacking == pytest.approx(0.012, abs=1e-3)


def test_it_delays_what_another_sensor_shows() -> None:
    lag = sw.sensor.FirstOrder(time_constant=0.01)
    late = sw.sensor.Delayed(law=lag, delay=DELAY)
    time, found = shown(late, sw.scenario.ramp(3.0, 0.25), 2e-5)
    assert found[-1] == pytest.approx(3.0 * (time[-1] - 0.01 - DELAY), rel=1e-9)
    assert set(probe(late).rest()) >= {f"sensors.output_angle.section[{i}]" for i in range(4)}


def test_a_steady_motion_is_late_by_the_delay_at_the_coarsest_steps() -> None:
    time, found = shown(LAW, sw.scenario.ramp(3.0, 0.1), DELAY / 8.0)
    assert found[time > 0.05] == pytest.approx(3.0 * (time[time > 0.05] - DELAY), abs=1e-9)


@pytest.mark.parametrize(
    ("sensor", "rate"),
    [
        (LAW, 8.0 / DELAY),
        (sw.sensor.SecondOrder(natural_frequency=5000.0), 5000.0),
        (sw.sensor.Delayed(law=sw.sensor.SecondOrder(natural_frequency=5000.0), delay=DELAY), 5000.0),
        (sw.sensor.Noisy(law=LAW, amplitude=1e-6), 8.0 / DELAY),
    ],
)
def test_steps_that_cannot_follow_a_sensor_are_refused(sensor: object, rate: float) -> None:
    """Their numbers would mean nothing and look as if they did: what the controller makes of them is limited."""
    motion = sw.scenario.ramp(3.0, 0.02)
    shown(sensor, motion, 0.99 / rate)
    with pytest.raises(FloatingPointError, match=rf"as fast as a vibration of {rate:.4g} rad/s"):
        shown(sensor, motion, 1.01 / rate)
    still, dampings, inputs = sw.scenario.constant(0.0, 0.02), {"gear.damping": [0.0, 1.0]}, {"output_angle": motion}
    with pytest.warns(sw.simulation.EnsembleWarning, match="2 of 2 members have no result"):
        sw.simulate_many(probe(sensor), still, dampings, 1.01 / rate, inputs=inputs)
