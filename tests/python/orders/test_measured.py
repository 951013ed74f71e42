"""What a recording tells depends on what it holds; a simulated drive of the package is taken apart again."""

from __future__ import annotations

import numpy as np
import pytest
import strainwave as sw
from strainwave.orders.measured import orders_found

UNITS = {"time": "s", "input_angle": "rad", "output_angle": "rad", "current": "A"}


@pytest.fixture(scope="module")
def driven() -> sw.Recording:
    """A position drive with known kinematic error, spring and friction, moved to and fro, seen through encoders."""
    drive = sw.load("position-drive")
    error = sw.kinematic_error.Fourier(order=[2.0, 4.0], amplitude=[3e-4, 8e-5], phase=[0.4, -1.0])
    stiff = sw.stiffness.Linear(k=8000.0)
    drive = drive.replace(gear=drive.gear.replace(kinematic_error=error, stiffness=stiff))
    command = sw.scenario.sine(amplitude=0.6, frequency=0.1, duration=20.0)
    run = sw.simulate(drive, command, dt=2e-4, sample=2e-3, record=["input_angle", "output_angle", "current"])
    rng = np.random.default_rng(5)
    noise = {"input_angle": 1e-4, "output_angle": 5e-6, "current": 0.02}
    columns = {name: run[name] + rng.normal(0.0, scatter, len(run)) for name, scatter in noise.items()}
    return sw.Recording({"time": run.time, **columns}, UNITS)


@pytest.mark.slow("orders")
def test_the_error_of_a_simulated_drive_is_that_of_its_gear(driven: sw.Recording) -> None:
    found = orders_found(driven, "driven")
    assert found.transmission is not None
    assert found.transmission.ratio.used == 100.0
    told = {each.order: each for each in found.transmission.orders if each.significant}
    assert set(told) == {2.0, 4.0}
    for order, amplitude, phase in ((2.0, 3e-4, 0.4), (4.0, 8e-5, -1.0)):
        assert abs(told[order].amplitude - amplitude) < 3.0 * told[order].amplitude_sigma
        assert abs(told[order].phase - phase) < 3.0 * told[order].phase_sigma
        assert told[order].amplitude_sigma < 0.1 * amplitude


def test_orders_of_two_encoders_are_looked_for_as_far_as_is_said(driven: sw.Recording) -> None:
    found = orders_found(driven, "driven", highest=3.0)
    assert found.ripple is not None
    assert found.ripple.highest == 3.0


@pytest.mark.slow("orders")
def test_the_same_drive_is_seen_in_its_current(driven: sw.Recording) -> None:
    joint = driven.select(["time", "output_angle", "current"])
    blind = orders_found(joint, "blind")
    assert blind.transmission is None
    assert blind.ripple is not None
    assert any(line.kind in ("order", "either") and abs(line.order - 200.0) < 2.0 for line in blind.ripple.lines)
    assert 100 in blind.ripple.concluded


def test_a_speed_is_summed_up_where_there_is_no_angle() -> None:
    time = np.arange(0.0, 30.0, 0.004)
    q = 1.2 * np.sin(0.5 * time) + 0.3 * np.sin(1.3 * time)
    torque = 3.0 * np.sign(np.gradient(q)) + 0.2 * np.cos(160.0 * q) + np.random.default_rng(0).normal(0.0, 0.3, len(time))
    columns = {"time": time, "output_speed": np.gradient(q, time), "joint_torque": torque}
    found = orders_found(sw.Recording(columns, {"time": "s", "output_speed": "rad/s", "joint_torque": "N.m"}))
    assert found.ripple is not None
    assert found.ripple.lines[0].order == pytest.approx(160.0, abs=0.5)
    assert any("summed up" in each for each in found.ripple.remarks)


def test_what_is_missing_is_named() -> None:
    t = np.arange(100.0)
    with pytest.raises(ValueError, match="or one angle and a torque or current; there are time, output_angle"):
        orders_found(sw.Recording({"time": t, "output_angle": t}, {"time": "s", "output_angle": "rad"}))
    with pytest.raises(ValueError, match=r"--side output .* or of the motor with --side input"):
        orders_found(sw.Recording({"angle": t, "torque": np.sin(t)}, {"angle": "rad", "torque": "N.m"}))
    with pytest.raises(ValueError, match=r"only over time: .* --constant rate=NUMBER"):
        orders_found(sw.Recording({"input_speed": t, "torque": np.sin(t)}, {"input_speed": "rad/s", "torque": "N.m"}))
    with pytest.raises(ValueError, match="need an angle, or a speed over time"):
        orders_found(sw.Recording({"time": t, "torque": np.sin(t)}, {"time": "s", "torque": "N.m"}))
