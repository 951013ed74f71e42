"""Several torsion loops of one gear as files: what `identify` makes of them together."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import strainwave as sw
from strainwave.identification.kinds.torsion_loop import lossy_loop
from strainwave.identification.reading.recognise import recognise

from tests.support.loss_loops import GEAR, RATIO, loss_loop


def test_a_torque_of_the_motor_counted_at_the_output_is_a_loop_at_the_input(tmp_path: Path) -> None:
    measured = loss_loop(40.0, at_input=True)
    rows = np.column_stack([measured["input_angle"] / RATIO, measured["input_torque"] * RATIO])
    np.savetxt(
        tmp_path / "loop.csv", rows, delimiter=",", header="deflection [rad],motor_torque_output_side [N.m]", comments=""
    )
    found = lossy_loop(recognise(tmp_path / "loop.csv"), GEAR)
    assert found.names == measured.names
    for name in measured.names:
        assert found[name] == pytest.approx(measured[name], rel=1e-12)
    (tmp_path / "loop.csv").write_text((tmp_path / "loop.csv").read_text().replace("motor_torque_output_side", "torque"))
    assert lossy_loop(recognise(tmp_path / "loop.csv"), GEAR).names == ("twist", "torque")


@pytest.mark.slow("identification")
def test_identify_splits_the_loss_of_several_loops(tmp_path: Path) -> None:
    for name, reach, side in (("a", 40.0, True), ("b", 40.0, False), ("c", 20.0, False)):
        loss_loop(reach, at_input=side).to_csv(tmp_path / f"{name}.csv")
    found = sw.identify("hfuc-25-100", tmp_path, accept=True)
    together = next(each for each in found.files if each.name == "all torsion loops")
    assert together.title == "the loss of a cycle by its source"
    assert together.model.startswith(
        "bearing, dry 38 ± 2 %; gear, dry 25 ± 2 %; mesh, in proportion to the load 37 ± 2 %; flexspline"
    )
    assert together.remarks[0].startswith("12.8 mJ are lost in a cycle of the loop of ±")
