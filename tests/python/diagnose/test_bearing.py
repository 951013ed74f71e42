"""Orders of a bearing by its geometry: those of the fault, named in table, verdict and cause; geometries that are refused."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import strainwave as sw
from strainwave.dataset.faults import changes_of, with_faults
from strainwave.diagnose.diagnosis import Question, diagnosed
from strainwave.diagnose.named_orders import bearing_orders, causes
from strainwave.diagnose.refusals import JointRecording, usable

from tests.python.command import refused, strainwave

BEARING = sw.fault.WaveGeneratorBearing(severity=0.6)
JOINT = sw.GearSet.read("csg-25-100").with_parts(
    motor=sw.motor.CurrentSource(torque_constant=0.2, inertia=1.5e-4),
    control=sw.control.PI(proportional=2.0, integral=40.0, limit=20.0),
    load=sw.loads.Pendulum(inertia=0.5, gravity_torque=40.0),
    source="a test",
)


def record(drive: sw.Drive, seed: int) -> sw.Recording:
    """A joint to and fro, with noise of the current."""
    motion = sw.scenario.sine(amplitude=0.4, frequency=0.05, duration=60.0)
    run = sw.simulate(drive, motion, sample=0.002, record=["input_angle", "current"])
    noise = np.random.default_rng(seed).normal(0.0, 0.01, len(run))
    return run.with_column("current", run["current"] + noise, "A")


def read(recording: sw.Recording, name: str) -> JointRecording:
    return usable(recording, name, ratio=100.0)


@pytest.fixture(scope="module")
def records() -> dict[str, sw.Recording]:
    drive = JOINT.drive
    path = "gear.friction_input.coulomb"
    friction = float(drive.gear.friction_input.coulomb)
    days = {f"day-{day}": drive.replace({path: (0.9 + 0.1 * day) * friction}) for day in range(3)}
    drives = {**days, "later": drive, "bearing": with_faults(drive, [BEARING])}
    return {name: record(each, seed) for seed, (name, each) in enumerate(drives.items())}


def test_the_orders_are_those_of_the_fault() -> None:
    orders = bearing_orders([BEARING], JOINT.gear.kinematics)
    assert list(orders) == ["bearing, outer ring", "bearing, inner ring", "bearing, ball", "bearing, cage"]
    for element, order in zip(("outer_ring", "inner_ring", "ball", "cage"), orders.values(), strict=True):
        assert order == changes_of(JOINT.drive, BEARING.replace(element=element))[0].order
    ratio = float(JOINT.gear.kinematics.ratio)
    known = sw.orders.bearing_orders(23, 4.763e-3, 46e-3, outer_speed=1.0 / ratio)  # the circular spline is fixed
    assert orders["bearing, outer ring"] == pytest.approx(known.outer_ring, rel=1e-12)
    two = bearing_orders([BEARING, BEARING], JOINT.gear.kinematics)
    assert "bearing 2, outer ring" in two


@pytest.mark.slow("diagnose")
def test_a_simulated_fault_of_a_bearing_is_named(records: dict[str, sw.Recording]) -> None:
    healthy = [read(records[name], name) for name in ("day-0", "day-1", "day-2")]
    question = Question(JOINT, ratio=100.0, bearings=(BEARING,))
    later, damaged = diagnosed(
        [read(records["later"], "later"), read(records["bearing"], "bearing")], question, baseline=healthy
    ).runs
    assert later.verdict == "no change found"
    assert damaged.verdict == "changed"
    assert "(bearing, outer ring)" in damaged.reason
    assert any("bearing, outer ring" in each for each in damaged.causes)
    names = {each.order.name: each for each in damaged.orders}
    assert names["bearing, outer ring"].detected
    assert not names["bearing, inner ring"].detected


@pytest.mark.slow("diagnose")
def test_the_command_names_the_element(records: dict[str, sw.Recording], tmp_path: Path) -> None:
    JOINT.save(tmp_path / "joint.toml")
    records["bearing"].to_csv(tmp_path / "bearing.csv")
    options = ("--gear", "joint.toml", "--bearing", "23,4.763,46", "--out", "out")
    done = strainwave("diagnose", "joint", "bearing.csv", *options, folder=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "(bearing, outer ring): above noise" in " ".join(done.stdout.split())
    (joint,) = json.loads((tmp_path / "out" / "results.json").read_text())["joints"]
    names = [each["order"]["name"] for each in joint["recordings"][0]["orders"]]
    assert "bearing, outer ring" in names


def test_a_multiple_of_a_bearing_that_is_no_whole_order_is_its_cause() -> None:
    order = bearing_orders([BEARING], JOINT.gear.kinematics)["bearing, outer ring"]
    (cause,) = causes([(2.0 * order, 0.01)], 1.0, JOINT.gear.kinematics, [BEARING])
    assert cause.endswith("of the input: bearing, outer ring")
    (other,) = causes([(2.0 * order, 0.01)], 1.0, JOINT.gear.kinematics, [])
    assert other.endswith("a bearing, the motor, or a resonance")


@pytest.mark.slow("diagnose")
@pytest.mark.parametrize(
    ("options", "reason"),
    [
        (("--gear", "csg-25-100", "--bearing", "23,4.763"), "--bearing 23,4.763 has 2 numbers; give balls"),
        (("--gear", "csg-25-100", "--bearing", "23.5,4.763,46"), "balls = 23.5 must be a whole number"),
        (("--gear", "csg-25-100", "--bearing", "23,9,46"), "the balls must fit on their circle"),
        (("--ratio", "100", "--bearing", "23,4.763,46"), "the orders of a bearing need a gear with teeth"),
    ],
)
def test_options_that_do_not_fit_are_refused_in_one_line(
    options: tuple[str, ...], reason: str, tmp_path: Path, records: dict[str, sw.Recording]
) -> None:
    records["later"].to_csv(tmp_path / "later.csv")
    refused(tmp_path, ("diagnose", "joint", "later.csv", *options), reason)
