"""Logs whose names and numbers leave units or side open: read as their motion shows, else asked about."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from strainwave.identification.identify import Identified, identify
from strainwave.identification.reading.mapping import FileMapping
from strainwave.questions import Answer

from tests.evidence.drawn import readings
from tests.support.answers import answer_with, mapping_of

TURN = 2.0 * np.pi
RATIO, COULOMB, VISCOUS, INERTIA = 100.0, 0.06, 4e-4, 2.0  # at the input, but for the inertia


def log_of_joint(folder: Path, *, gravity: float, unit: float, names: tuple[str, str, str], pace: float = 1.0) -> Path:
    """A log of a joint with its torque at the output, its motion in numbers of `unit` [rad]."""
    time = np.arange(0.0, 24.0, 0.005) * pace
    angle = 1.2 * np.sin(0.9 * time) + 0.3 * np.sin(2.3 * time)
    speed = 1.08 * np.cos(0.9 * time) + 0.69 * np.cos(2.3 * time)
    acceleration = -0.972 * np.sin(0.9 * time) - 1.587 * np.sin(2.3 * time)
    time, speed, acceleration = time / pace, pace * speed, pace**2 * acceleration
    torque = RATIO * (COULOMB * np.sign(speed) + VISCOUS * RATIO * speed) + INERTIA * acceleration + gravity * np.sin(angle)
    torque += np.random.default_rng(3).normal(0.0, 0.1, len(time))
    path = folder / "log.csv"
    rows = np.column_stack([time, angle / unit, speed / unit, torque])
    np.savetxt(path, rows, delimiter=",", header=",".join(["time", *names]), comments="", fmt="%.9g")
    return path


def values(found: Identified) -> dict[str, float]:
    return {each.estimate.path: each.estimate.value for each in found.parameters}


def with_answer(path: Path, answer: Answer, **further: object) -> Identified:
    return identify("csg-20-100", [path], mapping=mapping_of(answer, **further))


@pytest.mark.slow("identification")
@pytest.mark.parametrize("names", [("position", "velocity", "torque"), ("q", "dq", "tau")])
def test_revolutions_without_a_unit_are_read_as_the_gravity_shows(tmp_path: Path, names: tuple[str, str, str]) -> None:
    path = log_of_joint(tmp_path, gravity=25.0, unit=TURN, names=names)
    found = identify("csg-20-100", [path])
    assert values(found)["load.gravity_torque"] == pytest.approx(25.0, rel=0.01)
    assert values(found)["gear.friction_input.coulomb"] == pytest.approx(COULOMB, rel=0.02)
    assert not found.failed
    assert any(each.startswith("read as rev, rev/s at the output, which leaves ") for each in found.files[0].remarks)
    assert any("rad, rad/s at the output: " in each for each in found.files[0].remarks)


@pytest.mark.slow("identification")
def test_radians_without_a_unit_stay_radians(tmp_path: Path) -> None:
    path = log_of_joint(tmp_path, gravity=25.0, unit=1.0, names=("q", "dq", "tau"))
    found = identify("csg-20-100", [path])
    assert values(found)["load.gravity_torque"] == pytest.approx(25.0, rel=0.01)
    assert found.files[0].recognised is not None
    assert found.files[0].recognised.units["output_angle"] == "rad"


@pytest.mark.slow("identification")
def test_what_no_reading_decides_is_asked_with_options_that_give_the_numbers(tmp_path: Path) -> None:
    path = log_of_joint(tmp_path, gravity=0.0, unit=TURN, names=("position", "velocity", "torque"))
    with pytest.raises(ValueError, match="the fit does not decide") as asked:
        identify("csg-20-100", [path])
    identified = with_answer(path, answer_with(asked.value, "rev, rev/s at the output"))
    found, of_gear = values(identified), identified.gear_set.gear.input_inertia * RATIO**2
    assert found["gear.friction_input.coulomb"] == pytest.approx(COULOMB, rel=0.02)
    assert found["gear.friction_input.viscous"] == pytest.approx(VISCOUS, rel=0.02)
    assert found["load.inertia"] + of_gear == pytest.approx(INERTIA, rel=0.02)
    assert not with_answer(path, answer_with(asked.value, "rad, rad/s at the output")).files[0].refused


@pytest.mark.slow("identification")
def test_a_unit_of_a_named_joint_that_no_reading_decides_is_asked(tmp_path: Path) -> None:
    """An upright joint: in revolutions or radians it leaves as little, and the side is in the names."""
    path = log_of_joint(tmp_path, gravity=0.0, unit=TURN, names=("joint_angle", "joint_speed", "joint_torque"))
    with pytest.raises(ValueError, match=r"no unit is stated, and several explain it equally well") as asked:
        identify("csg-20-100", [path])
    identified = with_answer(path, answer_with(asked.value, "rev, rev/s"))
    inertia = values(identified)["load.inertia"] + identified.gear_set.gear.input_inertia * RATIO**2
    assert inertia == pytest.approx(INERTIA, rel=0.02)


@pytest.mark.slow("identification")
def test_an_upright_joint_of_a_robot_is_in_radians(tmp_path: Path) -> None:
    path = log_of_joint(tmp_path, gravity=0.0, unit=1.0, names=("q", "dq", "tau"))
    (file,) = identify("csg-20-100", [path]).files
    assert "q in rad as is usual, dq in rad/s as it fits q" in " | ".join(file.remarks)


def test_a_reading_in_which_the_input_turns_too_fast_is_none(tmp_path: Path) -> None:
    path = log_of_joint(tmp_path, gravity=0.0, unit=1.0, names=("position", "velocity", "torque"), pace=2.5)
    with pytest.raises(ValueError, match="the fit does not decide") as asked:
        identify("csg-20-100", [path])
    assert "rad, rad/s at the output with " in str(asked.value)
    assert "rev, rev/s at the output with " not in str(asked.value)


@pytest.mark.slow("identification")
def test_a_usual_unit_that_explains_less_than_another_one_is_asked_about(tmp_path: Path) -> None:
    """Friction that plain least squares does not have hides most of what a small gravity shows of the unit."""
    path = log_of_joint(tmp_path, gravity=6.0, unit=TURN, names=("q", "dq", "tau"))
    rows = np.loadtxt(path, delimiter=",", skiprows=1)
    angle, speed = TURN * rows[:, 1], TURN * rows[:, 2]
    load = 6.0 * np.sin(angle) + INERTIA * np.gradient(speed, rows[:, 0])
    rows[:, 3] += 6.0 * (np.sin(angle + 0.5) - np.sin(angle))
    rows[:, 3] += 0.1 * np.abs(load) * np.sign(speed) + 0.5 * np.sin(2.0 * RATIO * angle)
    rows[:, 3] += RATIO * 0.02 * np.sign(speed) * (np.sqrt(0.5 * np.abs(speed)) - 0.5 * np.abs(speed))
    np.savetxt(path, rows, delimiter=",", header="time,q,dq,tau", comments="", fmt="%.9g")
    with pytest.raises(ValueError, match="no unit is stated, and another one than the usual explains more") as asked:
        identify("csg-20-100", [path])
    by_turns = with_answer(path, answer_with(asked.value, "rev, rev/s"))
    assert values(by_turns)["load.gravity_torque"] == pytest.approx(6.0, rel=0.03)


@pytest.mark.slow("identification")
def test_a_torque_that_may_be_of_the_other_side_is_asked_about(tmp_path: Path) -> None:
    path = log_of_joint(tmp_path, gravity=25.0, unit=1.0, names=("q", "dq", "tau"))
    rows = np.loadtxt(path, delimiter=",", skiprows=1)
    rows[:, 3] /= RATIO
    np.savetxt(path, rows, delimiter=",", header="time,q,dq,tau", comments="", fmt="%.9g")
    with pytest.raises(ValueError, match=r"tau may be a torque of the joint in N\.m, a torque of the motor in") as asked:
        identify("csg-20-100", [path])
    found = with_answer(path, answer_with(asked.value, "a torque of the motor in N.m"))
    assert not found.failed
    assert values(found)["load.gravity_torque"] == pytest.approx(25.0, rel=0.01)
    assert values(found)["gear.friction_input.coulomb"] == pytest.approx(COULOMB, rel=0.02)


@pytest.mark.slow("identification")
def test_each_file_may_have_a_ratio_of_its_own(tmp_path: Path) -> None:
    ratios = {"one": 256.857, "other": 267.429}
    for name in ratios:
        (tmp_path / name).mkdir()
    paths = [log_of_joint(tmp_path / name, gravity=25.0, unit=1.0, names=("q", "dq", "tau")) for name in ratios]
    found = identify("csg-20-100", paths, mapping=lambda path: FileMapping(constants={"ratio": ratios[path.parent.name]}))
    coulomb = [next(each for each in file.estimates if each.path.endswith("coulomb")).value for file in found.files]
    assert coulomb == pytest.approx([COULOMB * RATIO / ratio for ratio in ratios.values()], rel=0.02)


@pytest.mark.slow("identification")
def test_an_effort_without_a_unit_that_may_be_a_current_is_asked_about(tmp_path: Path) -> None:
    """An effort is a torque if its friction has the usual size, and may be a current of a 0.1 N·m/A motor at a tenth of it."""
    path = log_of_joint(tmp_path, gravity=25.0, unit=1.0, names=("joint_position", "joint_velocity", "joint_effort"))
    assert not identify("csg-20-100", [path]).failed
    time, angle, speed, effort = np.loadtxt(path, delimiter=",", skiprows=1).T
    rows = np.column_stack([time, angle, speed, effort / 9.85])
    np.savetxt(path, rows, delimiter=",", header="time,joint_position,joint_velocity,joint_effort", comments="")
    with pytest.raises(ValueError, match="joint_effort may be a current of the motor in A, a torque of the joint") as asked:
        identify("csg-20-100", [path])
    as_torque = with_answer(path, answer_with(asked.value, "a torque of the joint in N.m"))
    of_motor = answer_with(asked.value, "a current of the motor in A")
    as_current = with_answer(path, of_motor, constants={"torque_constant": 0.0985})
    assert values(as_torque)["load.gravity_torque"] == pytest.approx(25.0 / 9.85, rel=0.01)
    assert values(as_current)["load.gravity_torque"] == pytest.approx(25.0, rel=0.01)


@pytest.mark.slow("identification")
@pytest.mark.parametrize("seed", [0, 20, 25, 37, 71, 74])
def test_a_drawn_file_is_read_right_or_asked_about(seed: int) -> None:
    """Currents in mA without a unit, torques of either side, speeds and angles in rad, deg and rev, commands beside them."""
    found = readings.outcome(seed)
    assert found.verdict != "wrong", found.message
