"""A sensor that counts."""

from __future__ import annotations

from math import tau

import numpy as np
import pytest
import strainwave as sw
from hypothesis import given, strategies as st
from strainwave import _core

from tests.sensor.probe import Array, probe, shown

ROOM = 293.15  # K


def seen(law: sw.sensor.Encoder, angles: Array) -> Array:
    """What it shows of angles [rad], each by itself."""
    drive = probe(law)
    rest = drive.rest()
    found = [_core.measured(drive, rest.numbers, np.array([0.0, 0.0, angle, 0.0, ROOM, 0.0]))[2] for angle in angles]
    return np.array(found)


@given(
    st.integers(1, 2**20),
    st.floats(-7.0, 7.0),
    st.floats(0.0, 0.1),
    st.floats(-3.0, 3.0),
    st.lists(st.floats(-50.0, 50.0), max_size=8),
)
def test_it_shows_the_nearest_count_of_what_its_disc_marks(
    counts: int, offset: float, eccentricity: float, phase: float, angles: list[float]
) -> None:
    law = sw.sensor.Encoder(counts=counts, offset=offset, eccentricity=eccentricity, eccentricity_phase=phase)
    x = np.array(angles)
    marked = x + offset + eccentricity * np.sin(x + phase)
    count = tau / counts
    found = seen(law, x)
    assert np.abs(found - marked).max(initial=0.0) <= 0.5 * count + 1e-12
    assert found / count == pytest.approx(np.rint(found / count), abs=1e-9 * counts + 1e-9)


def test_its_steps_are_as_wide_as_a_count_and_lie_halfway_between() -> None:
    law = sw.sensor.Encoder(counts=100)
    angles = np.linspace(0.0, tau, 100 * 20 + 1) + 1e-4
    found = seen(law, angles)
    assert set(np.round(np.diff(found) / (tau / 100), 9)) == {0.0, 1.0}
    jumps = 0.5 * (angles[1:] + angles[:-1])[np.diff(found) > 0.0]
    assert jumps == pytest.approx(tau / 100 * (np.arange(100) + 0.5), abs=tau / 2000)


def test_a_turn_further_it_shows_a_turn_more() -> None:
    law = sw.sensor.Encoder(counts=4096, offset=0.3, eccentricity=1e-3, eccentricity_phase=1.0)
    angles = np.linspace(-3.0, 3.0, 50)
    assert seen(law, angles + 3.0 * tau) - seen(law, angles) == pytest.approx(np.full(50, 3.0 * tau), abs=1.01 * tau / 4096)


def test_its_error_of_rounding_is_as_large_as_that_of_a_uniform_one() -> None:
    """Root mean square q / sqrt(12), along a motion that has nothing to do with its counts."""
    law = sw.sensor.Encoder(counts=1024)
    time, found = shown(law, sw.scenario.ramp(1.0, 20.0), 1.7e-3)
    count = tau / 1024
    assert np.sqrt(np.mean((found - time) ** 2)) == pytest.approx(count / np.sqrt(12.0), rel=0.01)


def test_its_error_of_centre_comes_once_per_turn() -> None:
    law = sw.sensor.Encoder(counts=1e9, offset=0.01, eccentricity=2e-3, eccentricity_phase=0.5)
    time, found = shown(law, sw.scenario.ramp(tau, 4.0), 1e-3)
    assert found - tau * time == pytest.approx(0.01 + 2e-3 * np.sin(tau * time + 0.5), abs=1e-8)


def test_a_coarse_one_makes_a_loop_hunt_within_a_count() -> None:
    """Position control with an integral, sampled: where the drive rests lies between two counts, so it goes to and fro."""
    counts = 200
    law = sw.control.Sampled(law=sw.control.PID(proportional=0.05, derivative=3e-3, integral=0.2), period=1e-3)
    drive = sw.Drive(
        gear=probe(sw.sensor.Ideal()).gear,
        motor=sw.motor.TorqueSource(inertia=1e-4),
        control=law,
        load=sw.loads.Inertia(inertia=0.05),
        sensors=sw.Sensors(input_angle=sw.sensor.Encoder(counts=counts)),
    )
    drive = drive.replace({"gear.friction_input": sw.friction.Viscous(viscous=2e-3)})
    command = sw.scenario.constant(5.3 * tau / counts / 20.0, 20.0)
    late = sw.simulate(drive, command, sample=1e-2).between(10.0, 20.0)["input_angle"] * counts / tau
    assert 4.3 < late.min() < late.max() < 6.3
