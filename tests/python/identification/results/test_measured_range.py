"""Range of speed, torque, angle and temperature over which a file was measured, in the identified gear."""

from __future__ import annotations

import numpy as np
import pytest
import strainwave as sw

SPEED = np.geomspace(2.0, 200.0, 12)


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
