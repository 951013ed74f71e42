"""Arms as people record them: what identify holds out is told better than by least squares of a specialist's script."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from strainwave.identification.identify import identify
from strainwave.identification.reading.mapping import FileMapping

from tests.evidence import arms

FAST = {"rtde.csv": 10.0, "hand.mat": 20.0, "headerless_all.csv": 25.0}  # s; `python -m tests.evidence.arms` tries all


@pytest.mark.slow("identification")
@pytest.mark.parametrize("sort", [sort for sort in arms.SORTS if sort.name in FAST], ids=lambda sort: sort.name)
def test_the_error_held_out_is_no_worse_than_that_of_least_squares(tmp_path: Path, sort: arms.Sort) -> None:
    ours, simple, with_model = arms.compared(sort, tmp_path, FAST[sort.name])
    print(f"\n{sort.name}: {ours:.2%}, least squares {simple:.2%}, with a model of the arm {with_model:.2%}")
    assert ours < min(simple, with_model)


@pytest.mark.parametrize("names", ["J2_{:g}deg_s.txt", "{:g}dps run.txt"])
def test_names_of_files_tell_the_speeds_of_currents_without_anything_beside_them(tmp_path: Path, names: str) -> None:
    joint, light = arms.Joint(loss=0.0), arms.Links(masses=(0.0, 0.0))
    for speed in (5.0, 10.0, 20.0, 40.0, -5.0, -10.0, -20.0, -40.0):
        command = arms.resting(2.0)
        command[1] += np.radians(speed) * np.arange(command.shape[1]) / arms.FINE
        seen = arms.Recorder(rate=500.0)(arms.run((joint,) * 3, command, light))
        np.savetxt(tmp_path / names.format(speed), seen["current"][1], "%.6f")
    said = FileMapping(columns={"current": "1"}, side="output", constants={"torque_constant": joint.torque_constant})
    found = identify("hfuc-25-100", [tmp_path], mapping=lambda path: said)
    told = {each.estimate.path.rpartition(".")[2]: each.estimate.value for each in found.parameters}
    assert told["coulomb"] == pytest.approx(joint.coulomb, rel=0.02)
    assert told["viscous"] == pytest.approx(joint.viscous, rel=0.05)


@pytest.mark.slow("identification")
def test_currents_at_constant_speeds_of_a_joint_tell_friction_at_the_motor(tmp_path: Path) -> None:
    """Ten files without time: joint-side speed and the current of the motor, counted where each was measured."""
    joint, light = arms.Joint(loss=0.0), arms.Links(masses=(0.0, 0.0))
    for speed in (0.05, 0.1, 0.2, 0.4, 0.8, -0.05, -0.1, -0.2, -0.4, -0.8):
        command = arms.resting(3.0)
        command[1] += speed * np.arange(command.shape[1]) / arms.FINE
        seen = arms.Recorder(rate=500.0, speed_noise=2e-4)(arms.run((joint,) * 3, command, light))
        rows = np.column_stack([seen["q"][1], seen["dq"][1], seen["current"][1]])
        np.savetxt(tmp_path / f"{speed:g}.csv", rows, "%.6f", ",", header="q,dq,current", comments="")
    said = FileMapping(constants={"torque_constant": joint.torque_constant})
    found = identify("hfuc-25-100", sorted(tmp_path.glob("*.csv")), mapping=lambda path: said)
    told = {each.estimate.path.rpartition(".")[2]: each.estimate.value for each in found.parameters}
    assert told["coulomb"] == pytest.approx(joint.coulomb, rel=0.02)
    assert told["viscous"] == pytest.approx(joint.viscous, rel=0.05)
    assert told["stribeck_speed"] == pytest.approx(joint.stribeck_speed, rel=0.15)
