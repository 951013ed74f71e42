"""What a controller that samples sees of a vibration faster than it can follow."""

from __future__ import annotations

from math import tau

import numpy as np
import pytest
import strainwave as sw

from tests.control.discrete import ARM, RATIO, TORQUE, Array, drive

RATE = 200.0  # Hz, of the controller
PERIOD = 1.0 / RATE


def alias(frequency: float) -> float:
    """|f - k f_s| of the nearest k [Hz]."""
    return abs(frequency - RATE * round(frequency / RATE))


def lines(signal: Array) -> Array:
    """Amplitudes at 0, 1, 2 … Hz of samples over one second."""
    size = np.abs(np.fft.rfft(signal)) / len(signal)
    return np.append(size[:1], 2.0 * size[1:])


def turning(frequency: float, eccentricity: float, duration: float) -> tuple[sw.Drive, sw.scenario.Scenario]:
    """A drive whose output is turned at so many turns a second, under a controller that looks at an encoder off centre there.

    What the controller gives is the error of the encoder, and nothing else: command and angle are the same.
    """
    law = sw.control.StateFeedback(output_angle=1.0)
    sensors = sw.Sensors(output_angle=sw.sensor.Encoder(counts=1e9, eccentricity=eccentricity, eccentricity_phase=0.4))
    one = drive(sw.control.Sampled(law=law, period=PERIOD), sw.motor.TorqueSource(inertia=1e12), sensors=sensors)
    return one.replace(load=sw.loads.Prescribed()), sw.scenario.ramp(tau * frequency, duration)


@pytest.mark.parametrize("frequency", [30.0, 99.0, 130.0, 170.0, 230.0, 370.0, 563.0])
def test_the_error_of_an_encoder_shows_at_its_alias(frequency: float) -> None:
    """Once per turn it errs by a sin(x + phi); of that the controller has a line at |f - k f_s|, as high, and no other."""
    one, motion = turning(frequency, 1e-3, 1.0)
    run = sw.simulate(one, motion, PERIOD / 20.0, sample=PERIOD, inputs={"output_angle": motion})
    given = run["motor_torque"][1:]  # what the controller gave at 0, T, 2 T …
    instants = PERIOD * np.arange(len(given))
    assert given == pytest.approx(-1e-3 * np.sin(tau * frequency * instants + 0.4), abs=1e-8)
    found = lines(given)
    assert found[round(alias(frequency))] == pytest.approx(1e-3, rel=1e-4)
    assert np.delete(found, round(alias(frequency))).max() < 1e-7


def test_at_the_frequency_of_sampling_it_is_a_constant_error() -> None:
    """A turn each period: the encoder errs by the same each time, a sin(phi), and so does the drive that follows it."""
    a, phase = 2e-3, 0.7
    motor = sw.motor.TorqueSource(inertia=1e-4)
    law = sw.control.PID(proportional=0.05, derivative=2e-3, integral=0.2)
    sensors = sw.Sensors(input_angle=sw.sensor.Encoder(counts=1e9, eccentricity=a, eccentricity_phase=phase))
    one = drive(sw.control.Sampled(law=law, period=PERIOD), motor, sensors=sensors)
    speed = tau * RATE
    start = {"input_speed": speed, "output_speed": speed / RATIO}
    run = sw.simulate(one, sw.scenario.ramp(speed / RATIO, 8.0), sample=PERIOD, initial=start)
    lag = RATIO * run["command"] - run["input_angle"]
    # The rounds stay in step with the instants, but shifted by the lag: lag = a sin(phi - lag).
    wanted = 0.0
    for _ in range(20):
        wanted = a * np.sin(phase - wanted)
    assert lag[-1] == pytest.approx(wanted, rel=1e-5)


@pytest.mark.parametrize("stiffness", [2e3, 3e4, 7e4, 1.5e5])
def test_a_vibration_of_the_gear_shows_at_its_alias(stiffness: float) -> None:
    """A wound-up gear let go rings at its own frequency; a controller too weak to matter hears it at the alias."""
    gain = 1e-9
    law = sw.control.Sampled(law=sw.control.StateFeedback(input_angle=gain), period=PERIOD)
    one = drive(law, TORQUE).replace({"gear.stiffness.k": stiffness, "gear.damping": 0.0})
    own = np.sqrt(stiffness * (1.0 / ARM.inertia + 1.0 / (RATIO**2 * TORQUE.inertia))) / tau
    run = sw.simulate(
        one, sw.scenario.constant(0.0, 1.0), 1e-5, sample=PERIOD, initial={"input_angle": 0.1, "output_angle": 0.0}
    )
    heard = run["motor_torque"][1:] / gain
    instants = PERIOD * np.arange(len(heard))
    # Both shafts ring about their common rest: theta_in = mean + share cos(w t).
    basis = np.stack([np.ones_like(instants), np.cos(tau * alias(own) * instants), np.sin(tau * alias(own) * instants)], axis=1)
    fitted, residual, *_ = np.linalg.lstsq(basis, heard, rcond=None)
    share = 0.1 * ARM.inertia / (ARM.inertia + RATIO**2 * TORQUE.inertia)
    assert np.hypot(*fitted[1:]) == pytest.approx(share, rel=1e-4)
    assert (alias(own) == own) == (own < RATE / 2.0)
    assert np.sqrt(residual[0] / len(heard)) < 1e-4 * share
