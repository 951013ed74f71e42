"""Torque by other joints: terms of the energy against an arm in closed form, and what is found in its log."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from strainwave.identification.dynamics.chain import Chain
from strainwave.identification.dynamics.coupling import _Arm, in_order
from strainwave.identification.experiments.motion import Motion
from strainwave.identification.identify import identify
from strainwave.identification.reading.mapping import FileMapping
from strainwave.statistics.linear_fit import solved

from tests.evidence import arms


@pytest.mark.parametrize("joint", ["1", "2", "3"])
@pytest.mark.parametrize("named", [False, True])
def test_terms_of_the_energy_make_up_the_torque_of_an_arm(joint: str, named: bool) -> None:
    """By Lagrange's equations in closed form (tests.evidence.arms); names without order allow more terms, and the same sum."""
    random = np.random.default_rng(int(joint))
    q, dq, ddq = random.uniform(-2.0, 2.0, (3, 3, 500))  # at any state: no motion is needed
    names = {"1": "a", "2": "b", "3": "c"} if named else {each: each for each in "123"}
    known = np.ones(500, bool)
    moving = {
        names[str(place + 1)]: Motion(np.arange(500.0), q[place], dq[place], ddq[place], known, ~known, ~known, 1, 1.0)
        for place in range(3)
    }
    arm = _Arm(names[joint], moving)
    own = moving[names[joint]]
    gravity = (
        Chain(int(joint) - 1, 1, (1,)).sums() if joint != "1" else ()
    )  # the first axis is upright, the others are parallel
    angles = [sum(sense * q[place] for place, sense in each) for each in gravity]
    rigid = [own.acceleration, *(wave(angle) for angle in angles for wave in (np.sin, np.cos))]
    columns = np.stack([*rigid, *(term.torque(arm) for term in arm.terms())], axis=1)
    torque = arms.Links().torques(q, dq, ddq)[int(joint) - 1]
    assert columns @ solved(columns, torque) == pytest.approx(torque, abs=1e-6)


@pytest.mark.slow("identification")
def test_friction_of_a_joint_of_an_arm_that_moves_as_a_whole(tmp_path: Path) -> None:
    joint = arms.Joint()
    done = arms.run((joint,) * 3, arms.fourier(40.0, (0, 1, 2), seed=3))
    arms.mat(tmp_path / "arm.mat", arms.Recorder(rate=250.0)(done))
    found = identify("hfuc-25-100", [tmp_path / "arm.mat"], mapping=lambda path: FileMapping(joint="2"))
    (finding,) = found.files
    assert finding.held_out is not None
    assert finding.held_out.in_band < 0.03  # 9 % without the terms
    assert finding.held_out.error < 0.5 * finding.held_out.plain
    (said,) = (remark for remark in finding.remarks if "move too" in remark)
    assert said.startswith("joints 1, 3 move too: ")
    told = {each.path.rpartition(".")[2]: each.value for each in finding.estimates}
    print(f"\n{told}, truth {joint}, error held out {finding.held_out.relative:.3g}")
    assert told["coulomb"] == pytest.approx(joint.coulomb, rel=0.05)
    assert told["viscous"] == pytest.approx(joint.viscous, rel=0.05)


def test_joints_without_numbers_are_in_alphabetical_order() -> None:
    assert in_order(["10", "9", "1"]) == ["1", "9", "10"]
    assert in_order(["shoulder", "elbow"]) == ["elbow", "shoulder"]


@pytest.mark.slow("identification")
def test_a_log_of_one_joint_has_no_terms_of_others(tmp_path: Path) -> None:
    done = arms.run((arms.Joint(),) * 3, arms.fourier(12.0, (1,), seed=4))
    arms.mat(tmp_path / "arm.mat", arms.Recorder(rate=250.0)(done))
    found = identify("hfuc-25-100", [tmp_path / "arm.mat"], mapping=lambda path: FileMapping(joint="2"))
    assert not any("move too" in remark for remark in found.files[0].remarks)


@pytest.mark.slow("identification")
def test_angles_of_other_joints_are_named_where_no_name_tells_them(tmp_path: Path) -> None:
    done = arms.run((arms.Joint(),) * 3, arms.fourier(12.0, (1, 2), seed=5))
    arms.headerless(tmp_path / "arm.csv", arms.Recorder(rate=200.0, step=1e-4)(done))
    columns = {"time": "1", "output_angle": "3", "output_speed": "9", "current": "15"}
    alone = identify("hfuc-25-100", [tmp_path / "arm.csv"], mapping=lambda path: FileMapping(columns=columns))
    said = FileMapping(columns={**columns, "other_angles": "4"})
    together = identify("hfuc-25-100", [tmp_path / "arm.csv"], mapping=lambda path: said)
    of_all, of_one = (each.files[0].held_out for each in (together, alone))
    assert of_all is not None
    assert of_one is not None
    assert of_all.in_band < 0.5 * of_one.in_band


@pytest.mark.slow("identification")
@pytest.mark.parametrize("seed", [1, 2])
def test_twenty_seconds_of_an_arm_are_predicted_better_than_with_a_model_of_it(seed: int, tmp_path: Path) -> None:
    joint = arms.Joint(ripple={2.0: 0.006, 4.0: 0.002})
    recorder = arms.Recorder(rate=95.0, jitter=1e-3, step=1e-4, seed=seed)
    seen = recorder(arms.run((joint,) * 3, arms.fourier(20.0, (0, 1, 2), seed)))
    path = tmp_path / "arm.csv"
    arms.rtde(path, seen)
    (finding,) = identify("hfuc-25-100", [path], mapping=lambda _: FileMapping(joint="1")).files
    specialist = arms.least_squares(seen, 1, "current", links=True)
    assert finding.held_out is not None
    print(f"\n{finding.held_out.in_band:.2%}, by least squares with a model of the arm {specialist:.2%}")
    assert finding.held_out.in_band < specialist
