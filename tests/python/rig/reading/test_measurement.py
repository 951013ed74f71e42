"""From steps and angles to loops: what is taken out, what is left out and told, and what a folder holds."""

from __future__ import annotations

import dataclasses
import hashlib
import math
import os
import re
import shutil
from pathlib import Path

import numpy as np
import pytest
import strainwave as sw
from numpy.typing import NDArray
from strainwave.rig.bench.rig_file import load, write_rig
from strainwave.rig.bench.setup import Masses, Rig, Value
from strainwave.rig.bench.steps import Step, read_steps, write_steps
from strainwave.rig.loop import Loop
from strainwave.rig.reading.measurement import couple, loops, read_test
from strainwave.rig.reading.recorded import loop_of, read_loop, scatter
from strainwave.rig.running.plan import plan
from strainwave.rig.virtual.loading import load_by_steps
from strainwave.rig.virtual.render import Scene
from strainwave.rig.virtual.test import simulate_test

Array = NDArray[np.float64]
RIG = Rig("bench", "input", Value(0.1), gravity=Value(9.81), masses=(Masses(0.025, 16),))
STIFFNESS = 4.5
MASSES = [0.05 * abs(n) - 0.35 for n in range(14, -15, -1)]


def of_spring(masses: list[float], **members: object) -> list[Step]:
    """Steps on a linear spring, each with its angle."""
    return [
        Step(n, max(m, 0.0), max(-m, 0.0), angle=m * 0.981 / STIFFNESS, **members)  # type: ignore[arg-type]
        for n, m in enumerate(masses, start=1)
    ]


def stiffness_of(loop: Loop) -> float:
    return float(np.polyfit(loop.angle, loop.torque, 1)[0])


def test_a_loop_has_what_the_steps_and_the_rig_say() -> None:
    rig = dataclasses.replace(RIG, disk_radius=Value(0.1, 1e-4), compliance=Value(0.0, 2e-4), pulley_torque=Value(0.0, 3e-4))
    steps = of_spring(MASSES, position=1.0, unit="A", temperature=293.0)
    steps = [dataclasses.replace(step, time=60.0 * step.number) for step in steps]
    (loop,) = loops(steps, rig)
    assert (loop.side, loop.position, loop.unit, loop.remarks) == ("input", 1.0, "A", ())
    assert loop.name == "unit A, flexspline at 57.2958 degrees"
    np.testing.assert_allclose(loop.torque, np.array(MASSES) * 0.981, rtol=1e-14, atol=1e-16)
    assert loop.torque_scale == pytest.approx(math.hypot(1e-3, 0.0), rel=1e-12)
    assert (loop.compliance_sigma, loop.friction_sigma) == (2e-4, 3e-4)
    assert loop.time is not None
    assert loop.time[-1] == 60.0 * 29
    assert loop.temperature is not None


def test_each_position_unit_and_cycle_is_a_loop_of_its_own() -> None:
    twice = MASSES + MASSES[1:]
    steps = [step for unit in "AB" for position in (0.0, 1.0) for step in of_spring(twice, unit=unit, position=position)]
    steps = [dataclasses.replace(step, number=n) for n, step in enumerate(steps, start=1)]
    found = loops(steps, RIG)
    assert [(loop.unit, loop.position) for loop in found] == [(u, p) for u in "AB" for p in (0.0, 0.0, 1.0, 1.0)]
    assert {len(loop) for loop in found} == {29}


def test_what_leads_up_to_the_first_peak_is_told_and_left_out() -> None:
    (loop, other) = loops(of_spring([0.05 * n for n in range(7)] + MASSES + MASSES[1:]), RIG)
    assert len(loop) == len(other) == 29
    assert loop.remarks == ("7 of 64 points belong to no complete cycle and are left out",)


def test_pulleys_and_compliance_are_taken_out() -> None:
    true = dataclasses.replace(RIG, pulley_torque=Value(0.004), compliance=Value(0.01))
    shaft = loops([dataclasses.replace(step, angle=0.0) for step in of_spring(MASSES)], true)[0].torque
    seen = shaft * (1.0 / STIFFNESS + 0.01)
    steps = [dataclasses.replace(step, angle=float(each)) for step, each in zip(of_spring(MASSES), seen, strict=True)]
    (loop,) = loops(steps, true)
    np.testing.assert_allclose(loop.angle, loop.torque / STIFFNESS, rtol=0.0, atol=1e-15)
    (raw,) = loops(steps, RIG)
    assert stiffness_of(raw) < 0.97 * STIFFNESS


def test_a_cord_from_a_fixed_point_gives_less_torque_than_one_on_the_rim() -> None:
    fixed = dataclasses.replace(RIG, cord="fixed point")
    steps = [Step(1, 0.35, angle=0.0), Step(2, angle=-0.5), Step(3, mass_negative=0.35, angle=math.radians(-59.3))]
    (loop,) = loops(steps, fixed)
    assert loop.torque[2] == pytest.approx(-0.35 * 0.981 * math.cos(math.radians(59.3)), rel=1e-12)
    with pytest.raises(ValueError, match="the disk turned 91 degrees from cord_tangent"):
        loops([*steps, Step(4, mass_negative=0.4, angle=math.radians(-91.0))], fixed)


def test_steps_without_an_angle_are_told_and_left_out() -> None:
    steps = of_spring(MASSES)
    steps[4] = dataclasses.replace(steps[4], angle=None)
    steps[5] = dataclasses.replace(steps[5], angle=None, image="006.png")
    (loop,) = loops(steps, RIG)
    assert len(loop) == 27
    assert loop.remarks == (
        "step 5 is left out: no angle and no photograph",
        "step 6 is left out: 006.png: the photograph gives no angle",
    )


@pytest.mark.parametrize(
    ("change", "remark"),
    [
        ({7: {"number": 9}}, "between steps 7 and 9 the numbers leave 1 out"),
        ({3: {"mass_negative": 0.1}}, "step 4 has masses on both pairs of pans; their difference counts"),
        (
            {3: {"torque": 0.2}},
            "the torque was measured, and steps.csv contains no error of it: intervals leave out those of the sensor",
        ),
        ({3: {"time": 5.0}}, "28 of 29 steps have no time; that of the others is left out"),
    ],
)
def test_what_a_reader_must_know_stands_in_the_remarks(change: dict[int, dict[str, object]], remark: str) -> None:
    steps = of_spring(MASSES)
    for row, members in change.items():
        steps[row] = dataclasses.replace(steps[row], **members)  # type: ignore[arg-type]
    shift = steps[7].number - 8
    steps[8:] = [dataclasses.replace(step, number=step.number + shift) for step in steps[8:]]
    assert remark in loops(steps, RIG)[0].remarks


def test_a_measured_torque_has_no_pulleys_before_it_on_either_rig() -> None:
    """Masses and a sensor tell the same loop: what the virtual rig holds of the masses, the evaluation takes off."""
    rig = dataclasses.replace(RIG, pulley_torque=Value(0.01), pulley_share=Value(0.03))
    gear = sw.Gear(stiffness=sw.stiffness.Linear(k=1e4), friction_input=sw.friction.Coulomb(coulomb=0.05))
    by_masses = [Step(n, max(m, 0.0), max(-m, 0.0)) for n, m in enumerate(MASSES, start=1)]
    loading = load_by_steps(gear, rig, by_masses)
    by_sensor = [Step(step.number, torque=float(torque)) for step, torque in zip(by_masses, loading.shaft, strict=True)]
    np.testing.assert_allclose(load_by_steps(gear, rig, by_sensor).angle, loading.angle, atol=1e-9)
    made = []
    for steps in (by_masses, by_sensor):
        seen = [dataclasses.replace(step, angle=float(angle)) for step, angle in zip(steps, loading.angle, strict=True)]
        made.append(loops(seen, rig)[0].torque[1:])  # of the first step, reached from rest, only the sensor knows all
    np.testing.assert_allclose(made[0], made[1], atol=1e-9)


def test_a_step_that_the_pulleys_hold_is_told() -> None:
    rig = dataclasses.replace(RIG, pulley_torque=Value(0.03))
    remarks = loops(of_spring(MASSES), rig)[0].remarks
    first = "the pulleys hold more than the change of torque at step 2, 16"
    assert remarks[0] == f"{first}: the torque on the shaft is less than that of the masses"


def test_one_step_of_a_position_is_no_loop() -> None:
    assert loops([Step(1, 0.1, angle=0.0)], RIG) == []
    (loop,) = loops([Step(1, 0.1, angle=0.0), Step(2, 0.0, angle=-0.1)], RIG)
    assert "2 points are no loop" in loop.remarks[0]


# Scatter


def test_scatter_is_the_noise_and_not_the_shape_of_the_curve() -> None:
    """A closed loop of two stiffnesses with corners, 0.001 rad of noise."""
    random = np.random.default_rng(5)
    torque = np.tile(np.concatenate([np.linspace(0.36, -0.36, 40), np.linspace(-0.36, 0.36, 40)[1:]]), 20)
    angle = np.where(np.abs(torque) < 0.2, torque / 0.3, torque / 4.5 + np.sign(torque) * 0.2 * (1.0 / 0.3 - 1.0 / 4.5))
    found = scatter(angle + 1e-3 * random.standard_normal(len(torque)), torque)
    assert found == pytest.approx(1e-3, rel=3.0 * 1.17 / math.sqrt(len(torque)) + 0.03)  # 0.03: the corners
    assert scatter(angle, torque) == pytest.approx(0.0, abs=1e-15)


def test_loops_of_others_are_read(tmp_path: Path) -> None:
    path = Path(sw.__file__).parent / "published" / "torsional-stiffness-loop.csv"
    loop = read_loop(path)
    assert loop.side == "input"
    area = 0.5 * abs(float(np.sum(loop.torque * np.roll(loop.angle, -1) - np.roll(loop.torque, -1) * loop.angle)))
    rounding = 2 * 5e-7 * 0.5 * 0.95  # of the torque at two corners, 0.95 rad from the next one
    assert area == pytest.approx(0.3063483432, abs=rounding)
    assert loop.recording() == loop_of(loop.recording()).recording()
    both = loop.recording().with_column("twist", loop.angle, "rad").with_column("torque", loop.torque, "N.m")
    both.to_parquet(tmp_path / "both.parquet")
    assert read_loop(tmp_path / "both.parquet", side="output").side == "output"
    with pytest.raises(
        ValueError, match=re.escape("both.parquet: it has the angle and torque of both shafts: of the joint with --side output")
    ):
        read_loop(tmp_path / "both.parquet")
    with pytest.raises(ValueError, match="has no columns twist and torque; it has input_angle, input_torque"):
        loop_of(loop.recording(), side="output")


# A folder


SCENE = Scene(size=(320, 240), radius=16.0, distance=140.0, blur=1.0, noise=0.01)


@pytest.fixture(scope="module")
def tested(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of a virtual test of a spring at the input: 0.3 rad each way, one photograph without a marker."""
    folder = tmp_path_factory.mktemp("test")
    gear = sw.Gear(kinematics=sw.kinematics.PlainRatio(reduction=100.0), stiffness=sw.stiffness.Linear(k=1.1e4))
    rig = dataclasses.replace(RIG, pulley_torque=Value(0.002), compliance=Value(0.02), markers_distance=Value(0.14))
    steps = plan(rig, step=0.09, positions=[0.0]).steps
    simulate_test(gear, rig, steps, folder=folder, scene=SCENE, faults={6: "marker missing"}, seed=3)
    return folder


@pytest.mark.slow("rig")
def test_photographs_and_masses_give_the_stiffness_of_the_gear(tested: Path) -> None:
    seen: list[str] = []
    test = read_test(tested, progress=lambda name, share: seen.append(name))
    (loop,) = test.loops
    assert seen == [step.image for step in test.steps]
    assert len(loop) == len(test.steps) - 1
    fit, covariance = np.polyfit(loop.torque, loop.angle, 1, cov=True)
    assert abs(fit[0] - 1e4 / 1.1e4) < 4.0 * math.sqrt(covariance[0, 0])  # 1.1 N.m/rad at the input
    assert loop.angle[0] == 0.0
    assert np.all(loop.angle_sigma < 2e-4)
    assert width(loop) < 4.0 * float(loop.angle_sigma.max())


def width(loop: Loop) -> float:
    """The largest distance of a point from the line through all of them, twice."""
    fit = np.polyfit(loop.torque, loop.angle, 1)
    return float(np.abs(loop.angle - np.polyval(fit, loop.torque)).max())


def test_a_photograph_without_a_marker_is_told_and_everything_else_remains(tested: Path) -> None:
    test = read_test(tested)
    assert len(test.steps) == len(test.hashes)
    (words,) = [remark for remark in test.remarks if remark.startswith("step-006.png: ")]
    assert "marker" in words
    assert any(remark.startswith("step 6 is left out: step-006.png: ") for remark in test.loops[0].remarks)


def test_photographs_may_lie_in_a_folder_of_their_own(tested: Path, tmp_path: Path) -> None:
    (tmp_path / "photos").mkdir()
    for path in tested.iterdir():
        shutil.copy(path, tmp_path / "photos" / path.name if path.suffix == ".png" else tmp_path / path.name)
    moved = [dataclasses.replace(step, image=f"photos/{step.image}") for step in read_steps(tested)]
    write_steps(moved, tmp_path / "steps.csv")
    (loop,), (wanted,) = read_test(tmp_path).loops, read_test(tested).loops
    np.testing.assert_array_equal(loop.angle, wanted.angle)


def test_the_record_is_held_against_the_plan_of_its_folder(tested: Path) -> None:
    steps = read_steps(tested)
    assert read_test(tested).deviations is None
    write_steps([*steps[:2], dataclasses.replace(steps[2], mass_positive=0.25), *steps[3:]], tested / "plan.csv")
    deviations = read_test(tested).deviations
    (tested / "plan.csv").unlink()
    assert deviations is not None
    assert deviations[0].startswith("step 3 has 200 g on the positive pans")


def test_photographs_stay_with_the_result_by_their_hashes(tested: Path) -> None:
    for name, digest in read_test(tested).hashes.items():
        assert digest == hashlib.sha256((tested / name).read_bytes()).hexdigest()


def test_another_reference_shifts_all_angles_alike(tested: Path) -> None:
    """Erratum E-T11."""
    peak, other = read_test(tested).loops[0], read_test(tested, reference="step-003.png").loops[0]
    assert other.angle[2] == 0.0
    np.testing.assert_allclose(peak.angle - other.angle, peak.angle[2], rtol=0.0, atol=1e-15)
    assert peak.torque.tolist() == other.torque.tolist()


@pytest.mark.parametrize(
    ("break_it", "message"),
    [
        (lambda folder: (folder / "rig.toml").unlink(), "rig.toml cannot be read: No such file or directory"),
        (lambda folder: (folder / "steps.csv").unlink(), "steps.csv cannot be read: No such file or directory"),
        (lambda folder: None, "no position has two steps with torque and angle; 1.png: cannot be read: No such file"),
    ],
)
def test_a_folder_without_what_is_needed_is_refused(tmp_path: Path, break_it: object, message: str) -> None:
    write_rig(load("couple-rig"), tmp_path / "rig.toml")
    write_steps([Step(1, 0.3, image="1.png"), Step(2, 0.2, image="2.png")], tmp_path)
    break_it(tmp_path)  # type: ignore[operator]
    with pytest.raises(ValueError, match=re.escape(message)) as refused:
        read_test(tmp_path)
    assert "\n" not in str(refused.value)


def test_more_mass_than_the_rig_has_is_refused(tmp_path: Path) -> None:
    write_rig(load("couple-rig"), tmp_path / "rig.toml")
    write_steps([Step(1, 0.3, angle=0.0), Step(2, 300.0, angle=0.1)], tmp_path)
    words = "steps.csv step 2: 300 kg lie on the pans, and all masses of the rig are 1.3 kg; state the unit in the header"
    with pytest.raises(ValueError, match=re.escape(words)):
        read_test(tmp_path)


def test_a_reference_that_is_no_photograph_is_refused(tested: Path) -> None:
    with pytest.raises(ValueError, match=re.escape('reference = "other.png" is no photograph of a step')):
        read_test(tested, reference="other.png")


def test_steps_of_a_folder_are_those_that_were_recorded(tested: Path) -> None:
    assert list(read_test(tested).steps) == read_steps(tested)


# The couple


def points(angle: Array, torque: Array, shift: float, seed: int) -> Array:
    """Where the point between the markers is seen, 0.01 px of noise, if the shaft goes up by `shift` per torque [px]."""
    noise = 0.01 * np.random.default_rng(seed).standard_normal((len(angle), 2))
    arm = 20.0 * np.stack([np.cos(angle + 0.4), np.sin(angle + 0.4)], axis=1)
    return arm + np.array([320.0, -240.0]) + np.outer(torque, [0.0, shift]) + noise


def test_a_shaft_that_shifts_under_load_was_not_turned_by_a_pure_couple() -> None:
    torque = np.array(MASSES) * 0.981
    backward = np.arange(29) < 15
    angle = torque / 4.5 + np.where(backward, -0.4, 0.4) * (1.0 - np.abs(torque) / 0.36)
    found = [couple(points(angle, torque, 0.0, seed), angle, torque) for seed in range(300)]
    shifts = np.array([each.shift for each in found]) / np.array([each.sigma for each in found])[:, None]
    assert shifts.std() == pytest.approx(1.0, rel=4.0 / math.sqrt(2.0 * shifts.size) + 0.05)  # Student's t of 52 degrees
    assert all(each.pure for each in found)
    pushed = couple(points(angle, torque, 0.5, 1), angle, torque, scale=1e-4)
    assert pushed.shift[1] == pytest.approx(0.5, abs=4.0 * pushed.sigma)
    assert str(pushed).startswith("the centre of rotation moves by 0.3")
    assert "um" in str(pushed)


def test_a_centre_that_cannot_be_told_is_not() -> None:
    with pytest.raises(ValueError, match="the centre of rotation needs 6 photographs or more, not 2"):
        couple(np.zeros((2, 2)), np.zeros(2), np.zeros(2))
    with pytest.raises(ValueError, match="torque and angle change together"):
        couple(np.zeros((6, 2)), np.zeros(6), np.arange(6.0))


@pytest.mark.parametrize("image", ["../secret.png", "/dev/zero", "link.png"])
def test_a_photograph_outside_of_the_folder_is_refused(tmp_path: Path, image: str) -> None:
    """Its digest would be in the report."""
    test = tmp_path / "test"
    test.mkdir()
    (tmp_path / "secret.png").write_bytes(b"secret")
    (test / "link.png").symlink_to("../secret.png")
    write_steps(of_spring(MASSES, image=image), test)
    write_rig(RIG, test / "rig.toml")
    message = f'{test}/steps.csv step 1 image: "{image}" does not lie in the folder {test}; copy it there'
    with pytest.raises(ValueError, match=re.escape(message)):
        read_test(test)


@pytest.mark.parametrize("name", ["rig.toml", "steps.csv", "plan.csv"])
def test_a_record_outside_of_the_folder_is_refused(tmp_path: Path, name: str) -> None:
    test = tmp_path / "test"
    test.mkdir()
    write_steps(of_spring(MASSES), test)
    write_steps(of_spring(MASSES), test / "plan.csv")
    write_rig(RIG, test / "rig.toml")
    (test / name).rename(tmp_path / name)
    (test / name).symlink_to(f"../{name}")
    with pytest.raises(ValueError, match=re.escape(f'"{name}" does not lie in the folder {test}; copy it there')):
        read_test(test)


def test_a_photograph_that_is_no_file_is_told(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "a.png")
    write_steps([*of_spring(MASSES), Step(30, image="a.png")], tmp_path)
    write_rig(RIG, tmp_path / "rig.toml")
    read = read_test(tmp_path)
    assert read.hashes == {"a.png": ""}
    assert any('cannot be read: "a.png" is not a regular file' in remark for remark in read.remarks)
