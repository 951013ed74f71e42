"""Orders in measurements of others: a joint simulated by another program, and a robot whose log is too slow.

The joint is brute force in C, with files as people make them; it shares nothing with this package. The robot is a UR3 (UCI 963,
CC BY 4.0), whose currents were logged once a second.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from math import radians, tau
from pathlib import Path

import numpy as np
import pytest
from strainwave.identification.reading.mapping import FileMapping
from strainwave.identification.reading.recognise import recognise
from strainwave.orders.measured import OrdersFound, orders_found

SHARED = Path(__file__).parents[3] / "shared"
JOINT = Path(os.environ.get("STRAINWAVE_RIG", SHARED / "independent-rig")) / "measure.py"
ROBOT = Path(os.environ.get("STRAINWAVE_DATA", SHARED / "data")) / "cobot-temperature" / "dataset_02052023.csv"
ZERO = 2971.3  # of its motor's encoder in degrees

joint_is_here = pytest.mark.skipif(
    not JOINT.is_file() or shutil.which("cc") is None, reason=f"no independent joint: {JOINT} (set STRAINWAVE_RIG), or no cc"
)
robot_is_here = pytest.mark.skipif(not ROBOT.is_file(), reason=f"measured data not found: {ROBOT} (set STRAINWAVE_DATA)")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("joint")
    subprocess.run([sys.executable, str(JOINT), str(out), "seed=11"], check=True, timeout=120)
    return out


def told(path: Path) -> OrdersFound:
    return orders_found(recognise(path).recording, path.name)


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
    assert abs(found.lines[0].order - 2.0) < 0.02


@robot_is_here
def test_a_log_of_one_sample_per_second_is_refused_with_the_reason() -> None:
    read = recognise(ROBOT, FileMapping(joint="3"))
    with pytest.raises(ValueError, match=r"samples per second show orders up to .* 60 per revolution .* record faster"):
        orders_found(read.recording, ROBOT.name, side="output")
