"""Diagnosis of joints that others measured: ripple found blind, refusals with reasons, halves of one joint without an alarm.

No number is set for a joint: every recording is read with the names of its columns alone. A direct-drive arm is the negative
control, as it has no wave generator; ripple added to the second halves is the positive one, as a test without power is quiet.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from functools import cache, partial
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
import strainwave as sw
from strainwave.diagnose.baseline import BaselineComparison
from strainwave.diagnose.diagnosis import Diagnosis, Question, diagnosed
from strainwave.diagnose.refusals import JointRecording, usable
from strainwave.identification.reading.mapping import FileMapping
from strainwave.identification.reading.recognise import recognise

from tests.support.samples import sample

ARMS = Path(os.environ.get("STRAINWAVE_DATA", Path(__file__).parents[3] / "shared" / "data")) / "arms"
SHARE = 3  # every third joint in the suite
MIN_COMPARED = 20  # halves of all joints; 23 were compared when this was written
MIN_POWER = 0.9  # of the compared halves with added ripple

pytestmark = pytest.mark.skipif(not ARMS.is_dir(), reason=f"measured data not found: {ARMS} (set STRAINWAVE_DATA)")


class Joint(NamedTuple):
    name: str
    recording: sw.Recording
    others: dict[str, str]


def of_ur10e(name: str, joint: int) -> Joint:
    columns = {"time": "1", "output_angle": str(joint + 1), "current": str(joint + 13)}
    if not name.startswith("01_22"):
        columns["other_angles"] = ",".join(str(each + 1) for each in range(1, 7) if each != joint)
    mapping = FileMapping(columns=columns, units={"output_angle": "rad", "current": "A"})
    read = recognise(ARMS / "ur10e" / f"ur-20_{name}.csv", mapping)
    return Joint(f"UR10e {name}, joint {joint}", read.recording, dict(read.neighbours))


def of_kinova(path: Path, joint: int) -> Joint:
    mapping = FileMapping(columns={"current": f"Cur{joint}"}, constants={"rate": 1000.0}, joint=str(joint), side="output")
    read = recognise(path, mapping)
    return Joint(f"Kinova {path.stem}, joint {joint}", read.recording, dict(read.neighbours))


def of_icub(path: Path) -> Joint:
    columns, units = {"output_angle": "out_1", "joint_torque": "out_3"}, {"output_angle": "deg", "joint_torque": "N.m"}
    read = recognise(path, FileMapping(columns=columns, units=units))
    return Joint(f"iCub {path.parent.name} {path.stem}", read.recording, {})


def of_kuka(axis: int) -> Joint:
    columns = {"time": "rec.time_cont", "output_angle": f"rec.act_pos_mot_deg_{axis}"}
    columns |= {"input_torque": f"rec.act_torque_abs_nm_{axis}"}
    mapping = FileMapping(columns=columns, units={"output_angle": "deg", "input_torque": "N.m"})
    return Joint(f"KUKA axis {axis}", recognise(ARMS / "kuka-kr300" / "FF_A.mat", mapping).recording, {})


@cache
def direct_drives() -> tuple[Joint, ...]:
    found = []
    for path in sorted((ARMS / "direct-drive").glob("*_pos1_*")):
        time, angle = np.loadtxt(path).T
        torque = np.loadtxt(str(path).replace("pos1", "tau1"))[:, 1]
        columns = {"time": time, "output_angle": np.radians(angle), "joint_torque": torque}
        recording = sw.Recording(columns, {"time": "s", "output_angle": "rad", "joint_torque": "N.m"})
        found.append(Joint(f"direct drive {path.stem}", recording, {}))
    return tuple(found)


def joints() -> list[Callable[[], Joint]]:
    """Readers of every joint of every recording, every third of them in the suite."""

    def readers() -> Iterator[Callable[[], Joint]]:
        yield from (partial(of_ur10e, f"01_22-joint_{joint}", joint) for joint in (1, 2, 4, 5))
        for name in ("01_17-ptp_10_points", "02_05-20sec_12harm", "02_19_14harm50secLoad"):
            yield from (partial(of_ur10e, name, joint) for joint in range(1, 7))
        for joint in range(1, 8):
            for name in (f"joint_{joint}_trapez.csv", "Trajectory1.csv", "RunTrajectory1.csv"):
                if (path := ARMS / "kinova-gen3" / name).is_file():
                    yield partial(of_kinova, path, joint)
        yield from (partial(of_icub, path) for path in sorted((ARMS / "icub").rglob("*.mat")))
        yield from (partial(of_kuka, axis) for axis in range(1, 7))
        yield from (partial(direct_drives().__getitem__, place) for place in range(len(direct_drives())))

    return list(readers())[:: sample(SHARE, 1)]


def as_run(joint: Joint, recording: sw.Recording, name: str) -> JointRecording:
    rate = None if "time" in recording else 1000.0
    return usable(recording, name, side="output", rate=rate, other_angles=joint.others)


def half(recording: sw.Recording, is_second: bool) -> sw.Recording:
    middle = len(recording) // 2
    part = slice(middle, None) if is_second else slice(0, middle)
    return sw.Recording({name: recording[name][part] for name in recording.names}, dict(recording.units))


def halves(joint: Joint) -> tuple[JointRecording, JointRecording]:
    return tuple(as_run(joint, half(joint.recording, is_second), f"half {1 + is_second}") for is_second in (False, True))  # type: ignore[return-value]


def of_halves(first: JointRecording, second: JointRecording) -> BaselineComparison | None:
    return diagnosed([second], Question(), baseline=[first]).runs[0].comparison


def blind(joint: Joint) -> Diagnosis:
    return diagnosed([as_run(joint, joint.recording, joint.name)], Question())


@pytest.mark.slow("diagnose")
@pytest.mark.parametrize("joint", [1, 2, 4, 5])
def test_the_ripple_of_a_ur10e_joint_is_found_blind_with_amplitudes_by_direction_and_load(joint: int) -> None:
    """Its gear of 101 has lines at 202, or at 200, as either spline sees the wave generator."""
    (run,) = blind(of_ur10e(f"01_22-joint_{joint}", joint)).runs
    assert run.wave is not None
    print(f"\njoint {joint}: {run.wave.order:.2f} ± {run.wave.sigma:.2f}, ratios {run.wave.ratios}")
    for cell in run.wave.cells:
        size = f"{1e3 * cell.amplitude:.1f} ± {1e3 * cell.sigma:.1f} mA"
        print(f"  {cell.direction}, load {cell.low:.2f} to {cell.high:.2f} A: {size}")
    assert 200.0 * (1.0 - 0.005) < run.wave.order < 202.0 * (1.0 + 0.005)
    assert {each.direction for each in run.wave.cells} == {"forward", "backward"}
    assert max(each.amplitude / each.sigma for each in run.wave.cells) > 4.0


@pytest.mark.slow("diagnose")
@pytest.mark.parametrize("joint", [5, 6])
def test_a_kinova_joint_at_constant_speed_has_its_ratio_blind_and_its_ripple_at_that_ratio(joint: int) -> None:
    (run,) = blind(of_kinova(ARMS / "kinova-gen3" / f"joint_{joint}_trapez.csv", joint)).runs
    print(f"\njoint {joint}: {run.ripple.concluded}, {run.wave}")
    assert run.ripple.concluded == (100,)
    if run.wave is not None:  # at constant speed its line may be one of time
        assert 199.0 < run.wave.order < 203.0
    known = usable(run.run.recording, "known", ratio=100.0, side="output")
    (again,) = diagnosed([known], Question(ratio=100.0)).runs
    assert again.wave is not None
    assert 199.0 < again.wave.order < 203.0


def test_no_wave_generator_is_found_in_a_direct_drive() -> None:
    examined = 0
    for joint in direct_drives():
        try:
            (run,) = blind(joint).runs
        except ValueError:
            continue
        examined += 1
        assert run.wave is None, joint.name
    print(f"\n{examined} of {len(direct_drives())} recordings of a direct drive move enough")
    assert examined >= 3


@pytest.mark.slow("diagnose")
def test_halves_of_one_healthy_joint_give_no_alarm_and_added_ripple_does() -> None:
    """Most recordings are too short, or move otherwise in their second half, and say so."""
    counts = {"compared": 0, "alarm": 0, "not comparable": 0, "added ripple found": 0}
    reasons, smallest = list[str](), list[float]()
    readers = joints()
    for read in readers:
        joint = read()
        try:
            first, second = halves(joint)
            comparison = of_halves(first, second)
        except ValueError as error:
            reasons.append(str(error))
            continue
        if comparison is None or not comparison.changes:
            counts["not comparable"] += 1
            continue
        counts["compared"] += 1
        if comparison.alarms:
            counts["alarm"] += 1
            print(joint.name, comparison.alarms[0])
        smallest.append(min(each.limit / each.baseline for each in comparison.changes))
        least = min(comparison.changes, key=lambda each: each.limit + each.baseline)
        angle = second.recording.values(second.angle, "rad")
        added = (2.0 * least.amplitude + 2.0 * least.limit) * np.cos(least.order * angle)
        raised = second.recording.with_column(second.column, second.recording[second.column] + added, second.unit)
        again = of_halves(first, as_run(joint, raised, "with added ripple"))
        counts["added ripple found"] += again is not None and bool(again.alarms)
    counts["refused"] = len(reasons)
    print(f"\n{len(readers)} recordings: {counts}")
    low, middle, high = np.quantile(smallest, [0.0, 0.5, 1.0])
    print(f"smallest change that is an alarm, over the ripple: {low:.2g} to {high:.2g}, median {middle:.2g}")
    assert all(any(word in each for word in ("too short", "at rest", "no order to compare", "aliased")) for each in reasons)
    assert counts["alarm"] == 0
    assert counts["compared"] >= MIN_COMPARED // sample(SHARE, 1)
    assert counts["added ripple found"] >= MIN_POWER * counts["compared"]


def test_recordings_that_cannot_be_used_are_refused_with_the_reason() -> None:
    joint = of_ur10e("01_22-joint_1", 1)
    slow = sw.Recording(
        {name: joint.recording[name][::20] for name in ("time", "output_angle", "current")},
        {"time": "s", "output_angle": "rad", "current": "A"},
    )
    turned = np.abs(joint.recording["output_angle"] - joint.recording["output_angle"][0]) * 101.0 / (2.0 * np.pi)
    first = int(np.argmax(turned > 2.0))  # the first sample that is two revolutions of the input away
    short = sw.Recording({name: joint.recording[name][:first] for name in slow.names}, dict(slow.units))
    still = next(each for each in direct_drives() if "sig0" in each.name)
    bare = joint.recording.select(["time", "output_angle"])
    for recording, reason in (
        (slow, r"aliased: order 2 of the wave generator passes at .* Hz .* the limit is 1\.872 Hz, 0\.8 of half"),
        (short, r"too short: the input turns .* revolutions .* needs 3 or more"),
        (still.recording, r"at rest|too short"),
        (bare, r"without current or torque: its columns are time, output_angle"),
    ):
        with pytest.raises(ValueError, match=reason):
            usable(recording, "log", ratio=101.0, side="output")
