"""Torque by other joints: terms of the energy and sums of angles against arms in closed form, and what a log shows."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from strainwave.identification.candidates.coupling import Chain, Sum, _Arm, best_chain, in_order, named
from strainwave.identification.experiments.motion import Motion
from strainwave.identification.identify import identify
from strainwave.identification.reading.mapping import FileMapping
from strainwave.statistics.linear_fit import solved

from tests.evidence import arms
from tests.support.samples import sample

Array = NDArray[np.float64]
ACROSS = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])  # a quarter of a turn about x


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
@pytest.mark.parametrize("seed", range(1, 1 + sample(1, 2)))
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


def rotation(angle: Array) -> Array:
    """Return rotations about z, shape (n, 3, 3)."""
    zero, one = np.zeros_like(angle), np.ones_like(angle)
    cosine, sine = np.cos(angle), np.sin(angle)
    return np.stack([cosine, -sine, zero, sine, cosine, zero, zero, zero, one], axis=1).reshape(-1, 3, 3)


def gravity_torques(q: Array, relations: tuple[int, ...], upright: bool, seed: int) -> Array:
    """Return the gravity torque of each joint of a chain of random links by moments of their weights, shape (joints, n).

    Axes are z of frames in a row; `relations` as those of a `Chain`. The first axis is upright, or lies.
    """
    random = np.random.default_rng(seed)
    count, samples = q.shape
    down = np.array([0.0, 0.0, -1.0]) if upright else np.array([0.0, -1.0, 0.0])
    turn, place = np.broadcast_to(np.eye(3), (samples, 3, 3)), np.zeros((samples, 3))
    axes, origins, centres = [], [], []
    for joint in range(count):
        relation = relations[joint - 1] if joint else 1
        turn = (
            turn
            @ {0: ACROSS, 1: np.eye(3), -1: np.diag([1.0, -1.0, -1.0])}[relation]
            @ rotation(q[joint] + random.uniform(-3, 3))
        )
        axes.append(turn[:, :, 2])
        origins.append(place)
        centres.append(place + turn @ random.normal(size=3))
        place = place + turn @ random.normal(size=3)
    masses = random.uniform(1.0, 5.0, count)
    return np.array([
        sum(masses[k] * np.sum(axes[j] * np.cross(centres[k] - origins[j], down), axis=1) for k in range(j, count))
        for j in range(count)
    ])  # fmt: skip


UNIVERSAL = (0, 1, 1, 0, 0)  # upright, three parallel, two across: arms of Universal Robots


@pytest.mark.parametrize(
    ("relations", "upright"), [(UNIVERSAL, True), ((0, -1, 0, 0, 0), True), ((0, 0, 0, 0, 0, 0), True), ((1, 0, 1, 0), False)]
)
def test_sums_of_angles_make_up_the_gravity_of_any_chain(relations: tuple[int, ...], upright: bool) -> None:
    """Whatever lengths, masses and zeros of the angles: least squares on the sums leaves nothing."""
    q = np.random.default_rng(1).uniform(-3.0, 3.0, (len(relations) + 1, 800))
    torques = gravity_torques(q, relations, upright, seed=2)
    first = int(upright)
    for joint in range(first, len(q)):
        sums = Chain(joint, first, relations[first:]).sums()
        angles = [sum(sense * q[place] for place, sense in each) for each in sums]
        columns = np.stack([wave(angle) for angle in angles for wave in (np.sin, np.cos)], axis=1)
        if columns.shape[1] < 400:
            assert columns @ solved(columns, torques[joint]) == pytest.approx(torques[joint], abs=1e-8)


@pytest.mark.parametrize("joint", [2, 3, 4])
def test_relations_of_axes_are_found_from_the_torque(joint: int) -> None:
    """A minute of a Fourier series, with friction and noise: what the sums found predict is the gravity."""
    random, time = np.random.default_rng(5), np.arange(3000) * 0.02
    q = np.array([
        sum(random.normal() * np.sin(0.4 * (k + 1) * time + random.uniform(0, 6.0)) for k in range(5)) for _ in range(6)
    ])  # fmt: skip
    gravity = gravity_torques(q, UNIVERSAL, upright=True, seed=6)[joint]
    sign = np.sign(np.gradient(q[joint]))
    size = float(np.std(gravity))
    torque = gravity + size * (0.5 * sign + 0.02 * random.normal(size=3000))

    def wave(each: Sum) -> Array:
        angle = sum(sense * q[place] for place, sense in each)
        return np.stack([np.sin(angle), np.cos(angle)], axis=1)

    base = np.stack([np.ones(3000), sign], axis=1)
    found = best_chain(torque[:2100], base[:2100], lambda each: wave(each)[:2100], joint, 6)
    assert found is not None
    columns = np.column_stack([base, *(wave(each) for each in found.sums())])
    left = torque - columns @ solved(columns[:2100], torque[:2100])
    print(f"\n{found}: {np.std(left[2100:]) / size:.3f} of the gravity is left")
    assert np.std(left[2100:]) < 0.1 * size


def test_without_gravity_no_chain_is_found() -> None:
    random = np.random.default_rng(7)
    q = np.cumsum(random.normal(size=(3, 900)), axis=1) * 0.05
    torque, base = random.normal(size=900), np.ones((900, 1))
    wave = lambda each: np.stack([f(sum(s * q[p] for p, s in each)) for f in (np.sin, np.cos)], axis=1)  # noqa: E731
    assert best_chain(torque, base, wave, 1, 3) is None


def test_sums_are_named_by_their_joints() -> None:
    assert named([((0, -1), (2, 1)), ((1, 1),)], ["1", "2", "elbow"]) == ["-q1+qelbow", "q2"]
