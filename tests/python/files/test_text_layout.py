"""Text of pairs of a name and a number, as drives, printf and `ros2 topic echo` write it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from strainwave.files import text_layout
from strainwave.files.tables import open_table

BLOCK = """header:
  stamp:
    sec: {0}
    nanosec: 500000000
  frame_id: ''
name:
- elbow
- wrist
position:
- 0.{0}
- -1.0
velocity: [0.25, 1e-3]
effort: []
---
"""
ROWS = range(3)
TEXTS = {
    "counted": ("{0}, spd:0.{0}, i avr: -1.5 mA, mode: run\n", {"spd": [0.0, 0.1, 0.2], "i avr [mA]": [-1.5] * 3}),
    "clock": ("[12:00:0{0}.500] INFO motor: speed = 1{0} rad/s torque = .5\n",
              {"time": [0.0, 1.0, 2.0], "speed [rad/s]": [10.0, 11.0, 12.0], "torque": [0.5] * 3}),
    "stamped": ("170000000{0}.25: q=0.{0}; i=1,5\n", {"time": [0.0, 1.0, 2.0], "q": [0.0, 0.1, 0.2], "i": [1.5] * 3}),
    "one a line": ("speed: {0}\ntorque: nan\n", {"speed": [0.0, 1.0, 2.0], "torque": [np.nan] * 3}),
    "json": ('{{"q": 0.{0}, "tau": 2}}\n', {"q": [0.0, 0.1, 0.2], "tau": [2.0] * 3}),
    "blocks": (BLOCK, {"header.stamp.sec": [0.0, 1.0, 2.0], "header.stamp.nanosec": [5e8] * 3,
                       "position_1": [0.0, 0.1, 0.2], "position_2": [-1.0] * 3,
                       "velocity_1": [0.25] * 3, "velocity_2": [1e-3] * 3}),
}  # fmt: skip


@pytest.mark.parametrize("name", TEXTS)
def test_pairs_become_columns(tmp_path: Path, name: str) -> None:
    form, columns = TEXTS[name]
    path = tmp_path / "drive.txt"
    path.write_text("".join(form.format(row) for row in ROWS))
    table = open_table(path)
    assert [label.text for label in table.labels] == list(columns)
    numbers = table.columns  # type: ignore[attr-defined]
    np.testing.assert_allclose(np.array(numbers), np.array(list(columns.values())))


def test_what_is_left_out_is_stated(tmp_path: Path) -> None:
    path = tmp_path / "drive.log"
    path.write_text("boot\n" + "a: 1\n" * 9 + "b: 2\n")
    assert open_table(path).left_out == (
        ["it contains pairs of a name and a number: 9 records", "1 of its lines contain none, and are left out",
         "in less than half of the records, and left out: b"]
    )  # fmt: skip


def test_a_table_below_settings_stays_a_table(tmp_path: Path) -> None:
    path = tmp_path / "scope.txt"
    path.write_text("Recorder: X\nRate: 1000\n" + "time,torque\n" + "".join(f"{row},1\n" for row in range(9)))
    assert [label.name for label in open_table(path).labels] == ["time", "torque"]


def test_files_beyond_the_limit_are_no_pairs(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(text_layout, "MAX_PAIRS_BYTES", 10)
    assert text_layout.pairs_table("drive.log", b"a: 1\na: 2\na: 3\n") is None
