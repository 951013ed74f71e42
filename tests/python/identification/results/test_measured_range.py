"""Range of speed, torque, angle and temperature over which a file was measured, in the identified gear."""

from __future__ import annotations

import numpy as np
import pytest
import strainwave as sw

SPEED = np.geomspace(2.0, 200.0, 12)
UNITS = {"time": "s", "output_angle": "rad", "joint_torque": "N.m"}


def test_a_table_of_the_output_counts_at_the_input_of_the_gear() -> None:
    torque = 5.0 + 3.0 * SPEED / 100.0
    columns = {"speed": SPEED / 100.0, "torque": torque, "temperature": np.linspace(20.0, 30.0, 12)}
    table = sw.Recording(columns, {"speed": "rad/s", "torque": "N.m", "temperature": "degC"})
    found = sw.identify("csg-20-100", {"friction": table}, mapping=sw.FileMapping(side="output"), accept=True)
    (validation,) = found.gear_set.validation
    assert validation.measured == {
        "input_speed": pytest.approx((2.0, 200.0)), "temperature": pytest.approx((293.15, 303.15)),
    }  # fmt: skip


def test_a_torsion_loop_has_the_range_of_its_torque() -> None:
    half = np.linspace(-40.0, 40.0, 60)
    torque = np.concatenate([half, half[::-1], half, half[::-1]])
    twist = torque / 1.6e4 + 1e-6 * np.random.default_rng(1).standard_normal(len(torque))
    loop = sw.Recording({"twist": twist, "torque": torque}, {"twist": "rad", "torque": "N.m"})
    (validation,) = sw.identify("csg-20-100", {"torsion": loop}, accept=True).gear_set.validation
    assert validation.measured == {"output_torque": (-40.0, 40.0)}


@pytest.mark.parametrize("gravity", [0.0, 12.0])
def test_a_log_that_determines_neither_gravity_nor_inertia_has_no_range_of_torque(gravity: float) -> None:
    """It was stated as 2e-10 N.m either way."""
    time = np.arange(0.0, 12.0, 0.01)
    angle = 0.9 * np.sin(time) + 0.3 * np.sin(2.1 * time)
    speed = np.gradient(angle, time)
    torque = (
        6.0 * np.sign(speed)
        + 4.0 * speed
        + gravity * np.sin(angle)
        + 0.05 * np.random.default_rng(1).standard_normal(len(time))
    )
    log = sw.Recording({"time": time, "output_angle": angle, "joint_torque": torque}, UNITS)
    (validation,) = sw.identify("csg-20-100", {"log": log}, accept=True).gear_set.validation
    assert ("output_torque" in validation.measured) == (gravity > 0.0)
    assert validation.measured.keys() >= {"input_speed", "output_angle"}
