"""Logs of joints measured by others: delays, the pass band of a log in amperes, and outliers."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import strainwave as sw
from numpy.typing import NDArray
from strainwave.files.recording import Recording
from strainwave.identification.candidates.plain import MAX_DELAY_SAMPLES
from strainwave.identification.checks.logs import ratio_by_orders
from strainwave.identification.experiments.motion_log import spoilt
from strainwave.identification.identify import identify
from strainwave.identification.reading.mapping import FileMapping
from strainwave.identification.reading.recognise import recognise
from strainwave.identification.results.file_result import FileResult

Array = NDArray[np.float64]

DATA = Path(os.environ.get("STRAINWAVE_DATA", Path(__file__).parents[3] / "shared" / "data")) / "arms"
MAX_OUTLIERS = 0.01  # of the samples of a channel without any

pytestmark = pytest.mark.skipif(not DATA.is_dir(), reason=f"measured data not found: {DATA} (set STRAINWAVE_DATA)")


@pytest.mark.slow("identification")
@pytest.mark.parametrize("joint", ["left-hip-pitch", "right-knee"])
def test_the_delay_of_a_joint_turned_by_hand_is_bounded(joint: str) -> None:
    """Without a bound the torque of the hand comes 3.8 s, or 1.2 s, before the motion that it makes."""
    columns = {"output_angle": "out_1", "output_speed": "out_2", "joint_torque": "out_3"}
    said = FileMapping(kind="log", columns=columns)
    (file,) = identify("csg-20-100", [DATA / "icub" / joint / "idle.mat"], mapping=said, accept=True).files
    assert file.fit is not None
    assert file.recognised is not None
    step = float(np.median(np.diff(file.recognised.recording.time)))
    delays = [each.value for each in file.fit.estimates if each.path == "delay"]
    assert all(abs(delay) < MAX_DELAY_SAMPLES * step for delay in delays)


@pytest.mark.slow("identification")
def test_friction_in_amperes_without_a_torque_constant_is_that_of_the_joint() -> None:
    """By stiffness in N.m/rad over inertia in A.s2/rad the pass band ends at 1.5 Hz: 0.55 A, where 1.8 A are right."""
    columns = {"time": "1", "output_angle": "2", "output_speed": "8", "current": "14"}
    said = FileMapping(columns=columns, constants={"ratio": 101.0})
    (file,) = identify("csg-20-100", [DATA / "ur10e" / "ur-20_01_22-joint_1.csv"], mapping=said).files
    coulomb = next(each for each in file.estimates if each.path.endswith("coulomb"))
    assert coulomb.unit == "A"
    assert abs(coulomb.value - 1.8) < 2.0 * coulomb.sigma < 0.4  # with what slow samples and other laws move


@pytest.mark.parametrize("axis", [1, 2, 3, 4, 5, 6])
def test_ripple_that_grows_with_the_speed_has_no_outliers(axis: int) -> None:
    """A threshold from the whole record took 7 to 14 % of these torques for outliers."""
    columns = {"time": "rec.time_cont", "output_angle": "rec.act_pos_se_deg_{}", "input_torque": "rec.act_torque_abs_nm_{}"}
    said = {name: column.format(axis) for name, column in columns.items()}
    units = {"output_angle": "deg", "input_torque": "N.m"}
    found = recognise(DATA / "kuka-kr300" / "FF_A.mat", FileMapping(columns=said, units=units))
    assert np.mean(spoilt(found.recording["input_torque"])) < MAX_OUTLIERS


def universal_robot(joint: int, change: Callable[[Array], Array]) -> FileResult:
    """Return the result of a joint of an arm that moves alone, in amperes, of a table that was changed."""
    table = np.loadtxt(DATA / "ur10e" / f"ur-20_01_22-joint_{joint}.csv", delimiter=",")
    time, angle, speed, current = change(table[:, [0, joint, joint + 6, joint + 12]]).T
    columns = {"time": time, "output_angle": angle, "output_speed": speed, "current": current}
    record = Recording(columns, {"time": "s", "output_angle": "rad", "output_speed": "rad/s", "current": "A"})
    return identify("csg-20-100", {"log": record}, mapping=FileMapping(constants={"ratio": 101.0})).files[0]


def values(result: FileResult) -> dict[str, float]:
    """Return the estimates by the last part of their path."""
    return {each.path.rpartition(".")[2]: each.value for each in result.estimates}


@pytest.mark.slow("identification")
def test_a_delay_that_another_part_hides_is_found() -> None:
    """The pass band shows no delay of two samples without the loss under load, and no loss without the delay."""

    def late(table: Array) -> Array:
        return np.column_stack([table[2:, :3], table[:-2, 3]])

    as_recorded, delayed = (values(universal_robot(2, change)) for change in (lambda table: table, late))
    assert delayed["driving_forward"] == pytest.approx(as_recorded["driving_forward"], rel=0.1)
    assert delayed["gravity_torque"] == pytest.approx(as_recorded["gravity_torque"], rel=0.01)


@pytest.mark.slow("identification")
def test_a_gap_takes_no_part() -> None:
    """Rows invented across seven seconds made Coulomb's torque 1.43 A where 0.98 A are right, and the loss vanish."""

    def with_gap(table: Array) -> Array:
        return np.delete(table, slice(2600, 3330), axis=0)

    as_recorded, with_a_gap = (values(universal_robot(2, change)) for change in (lambda table: table, with_gap))
    for name in ("coulomb", "driving_forward", "gravity_torque"):
        assert with_a_gap[name] == pytest.approx(as_recorded[name], rel=0.03)


@pytest.mark.slow("identification")
def test_rounding_of_the_time_decides_nothing() -> None:
    """Soundness of an instant between samples flipped with 1e-13 s, and with it the model."""

    def from_zero(table: Array) -> Array:
        return np.column_stack([table[:, 0] - table[0, 0], table[:, 1:]])

    as_recorded, shifted = (universal_robot(2, change).held_out for change in (lambda table: table, from_zero))
    assert as_recorded is not None
    assert shifted is not None
    assert shifted.error == pytest.approx(as_recorded.error, rel=1e-3)


def test_spikes_of_a_torque_without_noise_are_outliers() -> None:
    """Values that repeat have no noise by which a spike could be measured."""
    from scipy.io import loadmat

    torque = loadmat(DATA / "icub" / "right-knee" / "ref.mat")["out"][:, 2].copy()
    places = np.random.default_rng(1).choice(len(torque), 30, replace=False)
    torque[places] += 20.0 * np.std(torque)
    found = spoilt(torque)
    assert found[places].all()
    assert np.mean(found) < MAX_OUTLIERS


def test_a_motor_beside_a_joint_without_an_encoder_is_counted_at_the_joint() -> None:
    """Channels of the joint are zero: as the motor's own angle, its inertia at the output was 57000 kg.m2."""
    said = FileMapping(joint="6", columns={"input_torque": "rec.act_torque_abs_nm"}, constants={"ratio": 154.323})
    found = recognise(DATA / "kuka-kr300" / "FF_A.mat", said)
    assert {"reflected_angle", "reflected_speed"} <= set(found.columns)
    assert not any(name.startswith("output_") for name in found.columns)


@pytest.mark.slow("identification")
def test_a_log_of_a_speed_alone_determines_what_its_angle_would() -> None:
    """The angle is summed up from the speed; only the phase of gravity counts from another zero."""
    table = np.loadtxt(DATA / "ur10e" / "ur-20_01_22-joint_2.csv", delimiter=",")
    columns = {"time": table[:, 0], "output_speed": table[:, 8], "current": table[:, 14]}
    record = Recording(columns, {"time": "s", "output_speed": "rad/s", "current": "A"})
    (result,) = identify("csg-20-100", {"log": record}, mapping=FileMapping(constants={"ratio": 101.0})).files
    found, expected = values(result), values(universal_robot(2, lambda table: table))
    for name in ("coulomb", "driving_forward", "gravity_torque"):
        assert found[name] == pytest.approx(expected[name], rel=0.02)


@pytest.mark.parametrize("joint", [4, 5])
def test_the_ripple_over_the_output_is_held_against_the_ratio(joint: int) -> None:
    time, angle, current = np.loadtxt(DATA / "ur10e" / "ur-20_02_05-20sec_12harm.csv", delimiter=",")[
        :, [0, joint, joint + 12]
    ].T
    columns = {"time": time, "output_angle": angle, "current": current}
    record = Recording(columns, {"time": "s", "output_angle": "rad", "current": "A"})
    for ratio, is_wrong in ((101.0, False), (161.6, True)):
        gear = sw.Gear(kinematics=sw.kinematics.PlainRatio(reduction=ratio))
        (check,) = ratio_by_orders(sw.Drive(gear=gear), record, "log")
        assert check.failed == is_wrong
        assert "a ratio of 100 or 101" in check.message
        assert f"{ratio:g}" in check.message
