"""Orders in measurements of others: a joint simulated by another program, and a robot whose log is too slow.

The joint is brute force in C, with files as people make them; it shares nothing with this package. The robot is a UR3 (UCI 963,
CC BY 4.0), whose currents were logged once a second.
"""

from __future__ import annotations

import json
import os
import shutil
from math import radians, tau
from pathlib import Path

import numpy as np
import pytest
from strainwave.identification.reading.mapping import FileMapping
from strainwave.identification.reading.recognise import recognise
from strainwave.orders.measured import OrdersFound, orders_found
from strainwave.orders.torque_ripple import Ripple

from tests.evidence.rig import RIG, measured
from tests.support.samples import sample

SHARED = Path(__file__).parents[3] / "shared"
ROBOT = Path(os.environ.get("STRAINWAVE_DATA", SHARED / "data")) / "cobot-temperature" / "dataset_02052023.csv"
ARMS = Path(os.environ.get("STRAINWAVE_DATA", SHARED / "data")) / "arms"
ZERO = 2971.3  # of its motor's encoder in degrees

joint_is_here = pytest.mark.skipif(
    not (RIG / "measure.py").is_file() or shutil.which("cc") is None,
    reason=f"no independent joint: {RIG} (set STRAINWAVE_RIG), or no cc",
)
robot_is_here = pytest.mark.skipif(not ROBOT.is_file(), reason=f"measured data not found: {ROBOT} (set STRAINWAVE_DATA)")
arms_are_here = pytest.mark.skipif(not ARMS.is_dir(), reason=f"measured data not found: {ARMS} (set STRAINWAVE_DATA)")


@pytest.fixture(scope="module")
def folder() -> Path:
    return measured(3)


def told(path: Path) -> OrdersFound:
    return orders_found(recognise(path).recording, path.name)


@pytest.mark.slow("orders")
@joint_is_here
@pytest.mark.parametrize("name", ["log_full.csv", "two_loads/light.csv", "two_loads/middle.csv", "two_loads/heavy.csv"])
def test_two_encoders_tell_the_error_of_an_independent_joint(folder: Path, name: str) -> None:
    truth = json.loads((folder / "truth.json").read_text())
    found = told(folder / name).transmission
    assert found is not None
    assert found.ratio.used == -truth["N"]
    assert {each.order for each in found.orders if each.significant} == {2.0, 4.0}
    orders = {each.order: each for each in found.orders}
    for order, amplitude, phase in ((2.0, truth["e2"], 0.0), (4.0, truth["e4"], 0.8)):
        each = orders[order]
        expected = phase - order * radians(ZERO)
        amounts = [1e6 * value for value in (each.amplitude, each.amplitude_sigma, amplitude)]
        print("\n{}: order {:g}: {:.2f} ± {:.2f} µrad, truth {:.2f}".format(name, order, *amounts))
        assert abs(each.amplitude - amplitude) < 3.0 * each.amplitude_sigma
        assert each.amplitude_sigma < 0.1 * amplitude
        assert abs((each.phase - expected + np.pi) % tau - np.pi) < 3.5 * each.phase_sigma


@joint_is_here
@pytest.mark.parametrize("name", ["log_link.csv", "log_torque_sign.csv"])
def test_the_ratio_of_the_joint_is_found_in_its_torque_at_100_hertz(folder: Path, name: str) -> None:
    found = told(folder / name).ripple
    assert found is not None
    lines = [line for line in found.lines if line.kind == "order"]
    print(f"\n{name}: {[(line.order, line.amplitude) for line in found.lines]}, {found.candidates[:3]}")
    assert abs(lines[0].order - 160.0) < 0.5
    assert found.candidates[0].ratio == 80


@joint_is_here
@pytest.mark.parametrize("name", ["log.csv", "log_outliers.csv"])
def test_orders_of_the_wave_generator_are_in_the_current_over_the_angle_of_the_motor(folder: Path, name: str) -> None:
    found = told(folder / name).ripple
    assert found is not None
    assert found.side == "input"
    assert any(abs(line.order - 2.0) < 0.02 for line in found.lines)
    assert all(min(abs(line.order - true) for true in (2.0, 4.0)) < 0.02 for line in found.lines[:2])


@robot_is_here
def test_a_log_of_one_sample_per_second_is_refused_with_the_reason() -> None:
    read = recognise(ROBOT, FileMapping(joint="3"))
    with pytest.raises(ValueError, match=r"samples per second show orders up to .* 60 per revolution .* record faster"):
        orders_found(read.recording, ROBOT.name, side="output")


def ripple_of(path: Path, mapping: FileMapping) -> Ripple:
    read = recognise(path, mapping)
    found = orders_found(read.recording, path.name, side="output", other_angles=read.neighbours).ripple
    assert found is not None
    return found


def of_the_ur10e(joint: int, others: bool) -> FileMapping:
    """Columns of its files without header: time, six angles, six speeds, six currents."""
    columns = {"time": "1", "output_angle": str(joint + 1), "current": str(joint + 13)}
    if others:
        columns["other_angles"] = ",".join(str(each + 1) for each in range(1, 7) if each != joint)
    return FileMapping(columns=columns, units={"output_angle": "rad", "current": "A"})


@pytest.mark.slow("orders")
@arms_are_here
@pytest.mark.parametrize("joint", [1, 2, 4, 5])
def test_a_joint_of_the_ur10e_alone_has_its_ratio(joint: int) -> None:
    """Its gear of 101 has lines at 202, or at 200, as either spline sees the wave generator."""
    found = ripple_of(ARMS / "ur10e" / f"ur-20_01_22-joint_{joint}.csv", of_the_ur10e(joint, others=False))
    line = next(each for each in found.lines if each.kind == "order")
    print(f"\njoint {joint}: {line.order:.2f} ± {line.order_sigma:.2f}, {found.concluded}")
    assert 200.0 * (1.0 - 0.005) < line.order < 202.0 * (1.0 + 0.005)
    assert found.concluded
    assert set(found.concluded) <= {100, 101}


@pytest.mark.slow("orders")
@arms_are_here
@pytest.mark.parametrize("others", [True, False])
@pytest.mark.parametrize("name", ["01_17-ptp_10_points", "02_05-20sec_12harm", "02_19_14harm50secLoad"])
def test_no_joint_of_the_moving_ur10e_gets_a_ratio_of_another(name: str, others: bool) -> None:
    """Every other joint in the suite, all with the explore profile."""
    joints = range(1, 7, sample(2, 1))
    found = [ripple_of(ARMS / "ur10e" / f"ur-20_{name}.csv", of_the_ur10e(joint, others)) for joint in joints]
    print(f"\n{name}: {[each.concluded for each in found]}")
    assert all(set(each.concluded) <= {100, 101} for each in found)
    assert np.mean([bool(each.concluded) for each in found]) >= 4 / 6
    if others:
        assert any(each.kind == "joint" and abs(each.order - 201.0) < 3.0 for ripple in found for each in ripple.lines)


@pytest.mark.slow("orders")
@arms_are_here
@pytest.mark.parametrize("name", ["joint_{}_trapez.csv", "Trajectory1.csv", "RunTrajectory1.csv"])
def test_no_joint_of_the_kinova_gets_another_ratio_than_100(name: str) -> None:
    concluded = {}
    for joint in range(1, 8):
        path = ARMS / "kinova-gen3" / name.format(joint)
        if path.is_file():
            columns = {"current": f"Cur{joint}"}
            mapping = FileMapping(columns=columns, constants={"rate": 1000.0}, joint=str(joint), side="output")
            concluded[joint] = ripple_of(path, mapping).concluded
    print(f"\n{name}: {concluded}")
    assert set(concluded.values()) <= {(), (100,), (100, 101)}
    if name.startswith("joint"):
        assert concluded[5] == concluded[6] == (100,)


@arms_are_here
@pytest.mark.parametrize("axis", [1, 3])
def test_two_encoders_of_an_rv_gear_take_the_ratio_given(axis: int) -> None:
    """Its motor angle is exported in joint units."""
    ratio = {1: 1798.0 / 7.0, 3: 757.0 / 3.0}[axis]
    names = {"time": "rec.time_cont", "input_angle": "rec.act_pos_mot_deg_{}"}
    names |= {"output_angle": "rec.act_pos_se_deg_{}", "input_torque": "rec.act_torque_abs_nm_{}"}
    columns = {name: wanted.format(axis) for name, wanted in names.items()}
    units = {"input_angle": "deg", "output_angle": "deg", "input_torque": "N.m"}
    read = recognise(ARMS / "kuka-kr300" / "FF_A.mat", FileMapping(columns=columns, units=units))
    assert "reflected_angle" in read.recording
    found = orders_found(read.at_ratio(ratio).recording, side="output", ratio=ratio).transmission
    assert found is not None
    assert found.ratio.used == ratio
    assert not any("teeth" in each for each in found.remarks)


@arms_are_here
@pytest.mark.parametrize("name", ["left-hip-pitch/idle", "left-hip-pitch/ref", "right-ankle-roll/Idle", "right-knee/idle"])
def test_no_leg_joint_gets_a_ratio_from_its_hysteresis(name: str) -> None:
    """Gears of 100; a few periods in a motion of some 30 degrees are no ripple of a gear."""
    columns, units = {"output_angle": "out_1", "joint_torque": "out_3"}, {"output_angle": "deg", "joint_torque": "N.m"}
    found = ripple_of(ARMS / "icub" / f"{name}.mat", FileMapping(columns=columns, units=units))
    assert set(found.concluded) <= {100, 101}
