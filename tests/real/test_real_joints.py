"""Real joints beside plain least squares of another program; `python -m tests.evidence.real_joints` measures all of them."""

from __future__ import annotations

import pytest

from tests.evidence import real_joints

pytestmark = pytest.mark.skipif(
    not real_joints.ARMS.is_dir() or not real_joints.YARDSTICK.is_file(),
    reason=f"measured data or yardstick not found: {real_joints.ARMS}, {real_joints.YARDSTICK} (set STRAINWAVE_DATA)",
)
CHOSEN = (
    "ur10e/ur-20_01_22-joint_2.csv", "ur10e/ur-20_01_22-joint_5.csv", "kinova-gen3/joint_4_trapez.csv",
    "icub/left-hip-pitch/idle.mat",
)  # fmt: skip
TRIALS = [trial for trial in real_joints.trials() if trial.file in CHOSEN]


@pytest.mark.slow("identification")
@pytest.mark.parametrize("trial", TRIALS, ids=lambda trial: trial.file)
def test_a_joint_that_moves_alone_is_predicted_better_than_by_plain_least_squares(trial: real_joints.Trial) -> None:
    found = real_joints.outcome(trial)
    assert found.share < real_joints.MAX_MEDIAN_SHARE, real_joints.line(found)
    assert found.failed == ()


def test_a_record_one_way_at_one_speed_determines_the_friction_there() -> None:
    """A joint without gravity, whose friction drifts by more than it varies: no log that inertia and friction explain."""
    (trial,) = (each for each in real_joints.trials() if each.file == "kinova-gen3/joint_1_trapez.csv")
    found = real_joints.identified(trial)
    (friction,) = (each.estimate for each in found.parameters if each.estimate.path == "steady_friction")
    assert friction.law == "at 0.415 rad/s of the output"
    assert friction.value == pytest.approx(4.25, abs=0.2)
    assert not found.failed


@pytest.mark.slow("identification")
def test_halves_of_a_record_determine_the_same_numbers() -> None:
    (trial,) = (each for each in real_joints.trials() if each.file == "ur10e/ur-20_01_22-joint_2.csv")
    pairs = list(real_joints.halves(trial))
    assert len(pairs) >= 5
    assert sum(pair.apart < real_joints.MAX_DISTANCE for pair in pairs) >= real_joints.MIN_WITHIN * len(pairs)


@pytest.mark.slow("identification")
def test_one_speed_beside_other_joints_that_move_is_no_friction() -> None:
    """The torque of a joint that holds an arm up is not its friction: 13 N.m, and a gear written."""
    (trial,) = (each for each in real_joints.trials() if each.name == "kinova-gen3/RunTrajectory1.csv 2")
    found = real_joints.identified(trial)
    assert not any(each.estimate.path == "steady_friction" for each in found.parameters)
    assert found.failed


@pytest.mark.slow("identification")
def test_a_shape_that_moves_no_written_number_is_no_failure() -> None:
    """Numbers of 70 % of the record predict the rest with an error that looked like a shape of 27 % of the signal."""
    (trial,) = (each for each in real_joints.trials() if each.name == "kinova-gen3-split/*_3.csv 7")
    found = real_joints.identified(trial)
    assert not found.failed
    assert any("the residual has a shape over the angle of the output" in each for each in found.files[0].remarks)


@pytest.mark.slow("identification")
def test_the_start_set_is_no_prior_where_the_record_contradicts_it() -> None:
    """The friction of a small gear pulled that of a heavy robot to a fortieth, and the error to five times as much."""
    (trial,) = (each for each in real_joints.trials() if each.name == "kuka-kr300/FF_A.mat 2")
    found = real_joints.outcome(trial)
    assert found.share < real_joints.MAX_SHARE, real_joints.line(found)
    assert found.failed == ()
