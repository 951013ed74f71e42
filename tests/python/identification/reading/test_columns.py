"""Columns that a person or their names state: one channel each, in its unit."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from strainwave.identification.reading.mapping import FileMapping
from strainwave.identification.reading.recognise import recognise


def test_a_column_named_as_a_torque_and_as_one_of_a_side_is_one_channel(tmp_path: Path) -> None:
    time = np.arange(0.0, 4.0, 0.01)
    rows = np.column_stack([time, np.sin(time), np.cos(time), np.sign(np.cos(time))])
    np.savetxt(tmp_path / "log.csv", rows, "%.6f", ",", header="time [s],q [rad],dq [rad/s],X [N.m]", comments="")
    named = {"torque": "X", "joint_torque": "X"}
    found = recognise(tmp_path / "log.csv", FileMapping(columns=named))
    assert {name for name, column in found.columns.items() if column == "X"} == {"joint_torque"}


@pytest.mark.parametrize("pattern", ["{0}{1}", "state.{0}[{1}]"])
def test_columns_of_libfranka_have_its_units(tmp_path: Path, pattern: str) -> None:
    """Of two joints, of which the second rests."""
    time = np.arange(0.0, 4.0, 0.01)
    motion = np.sin(time), np.cos(time), np.sign(np.cos(time))
    columns = [part for each in motion for part in (each, np.zeros_like(each))]
    header = ",".join(["time", *(pattern.format(each, joint) for each in ("q", "dq", "tau_J") for joint in (0, 1))])
    np.savetxt(tmp_path / "log.csv", np.column_stack([time, *columns]), "%.6f", ",", header=header, comments="")
    found = recognise(tmp_path / "log.csv", FileMapping(joint="0"))
    assert {found.units[each] for each in ("output_angle", "output_speed", "joint_torque")} == {"rad", "rad/s", "N.m"}
    assert set(found.units_assumed) <= {"time"}
