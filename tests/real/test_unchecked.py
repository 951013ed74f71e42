"""What recordings of others do not check is stated with their numbers, and counts as no result."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from strainwave.identification.identify import Identified, identify
from strainwave.identification.reading.mapping import FileMapping
from strainwave.report.first_screen import is_start_set, next_commands, next_lines
from strainwave.report.identify import identify_report
from strainwave.report.identify_files import identify_summary

SHARED = Path(__file__).parents[3] / "shared"
TRIALS = Path(os.environ.get("STRAINWAVE_TRIALS", SHARED / "trials")) / "turn4"
KUKA = Path(os.environ.get("STRAINWAVE_DATA", SHARED / "data")) / "arms" / "kuka-kr300" / "FF_A.mat"
SCALE = "viscous friction, inertia and gravity scale with it"
TORQUE = {"input_torque": "rec.act_torque_abs_nm"}

pytestmark = pytest.mark.skipif(not TRIALS.is_dir(), reason=f"trials not found: {TRIALS} (set STRAINWAVE_TRIALS)")


def terminal(found: Identified) -> str:
    return "\n".join(identify_summary(found))


@pytest.mark.slow("identification")
@pytest.mark.parametrize("ratio", [50, 100])
def test_a_torque_of_the_joint_does_not_check_the_ratio_and_determines_friction_at_the_output(ratio: int) -> None:
    """The joint has 6 N.m; at the input it is half as much with twice the ratio."""
    found = identify(f"csg-20-{ratio}", [TRIALS / "gravity_compensated.csv"])
    assert found.unchecked["ratio"].startswith(f"{ratio}, of the start set (friction at the input scales with it; ")
    assert float(found.unchecked["ratio"].split("output is ")[1].split()[0]) == pytest.approx(6.0, rel=2e-3)
    for text in (terminal(found), identify_report(found)):
        assert f"othing checks the ratio, {found.unchecked['ratio']}" in text


@pytest.mark.slow("identification")
def test_a_ratio_that_a_person_gives_is_not_that_of_the_start_set() -> None:
    path = TRIALS / "gravity_compensated.csv"
    found = identify("csg-20-100", [path], mapping=FileMapping(constants={"ratio": 50.0}))
    assert found.unchecked["ratio"].startswith("50 (friction")


@pytest.mark.slow("identification")
@pytest.mark.skipif(not KUKA.is_file(), reason=f"recording not found: {KUKA} (set STRAINWAVE_DATA)")
def test_a_motor_angle_divided_by_an_assumed_ratio_has_no_orders() -> None:
    """The ratio is 256.857, that of the start set 100."""
    assumed = identify("csg-20-100", [KUKA], mapping=FileMapping(joint="1", columns=TORQUE))
    assert not any("kinematic_error" in each.path for each in assumed.files[0].estimates)
    assert assumed.gear_set.gear.kinematic_error == assumed.start_set.gear.kinematic_error
    assert assumed.unchecked == {"ratio": f"100, of the start set ({SCALE})"}
    lines = terminal(assumed)
    said = "the kinematic error is not determined: rec.act_pos_mot_deg_1 was already divided by the ratio"
    assert any(said in each for each in assumed.files[0].remarks)
    assert "columns not used" not in lines
    lists = ("single numbers, not used: ", "columns not used: ", "of another length than ")
    last = [each for each in assumed.files[0].remarks if each.startswith(lists)]
    assert len(last) == len(lists)
    assert set(last) <= set(assumed.files[0].remarks[-4:])


@pytest.mark.slow("identification")
@pytest.mark.skipif(not KUKA.is_file(), reason=f"recording not found: {KUKA} (set STRAINWAVE_DATA)")
def test_a_motor_angle_divided_by_a_given_ratio_has_orders() -> None:
    mapping = FileMapping(joint="1", columns=TORQUE, constants={"ratio": 256.857})
    given = identify("csg-20-100", [KUKA], mapping=mapping)
    assert any("kinematic_error" in each.path for each in given.files[0].estimates)
    assert given.unchecked == {"ratio": f"256.857 ({SCALE})"}


@pytest.mark.slow("identification")
def test_a_stiffness_that_the_recorder_assumed_is_no_result() -> None:
    found = identify("csg-20-100", [TRIALS / "07-sea.csv"])
    assert not found.failed
    report = identify_report(found)
    assert "nothing checks the series stiffness, 130 N·m/rad, which the recorder assumed and did not measure" in report
    assert "series_stiffness 130 N.m/rad, 07-sea.csv: it is the stiffness that the recorder assumed" in terminal(found)
    assert "±" not in terminal(found).split("series_stiffness")[1]


@pytest.mark.parametrize("name", ["07-sea.csv", "dial.csv"])
@pytest.mark.slow("identification")
def test_a_start_set_that_nothing_changed_is_named_so(name: str, tmp_path: Path) -> None:
    found = identify("csg-20-100", [TRIALS / name])
    assert is_start_set(found)
    assert "gear.toml: the start set CSG-20-100 unchanged" in next_lines(found, tmp_path)
    assert [command.split()[1] for _, command in next_commands(found, tmp_path)] == ["show"]


@pytest.mark.slow("identification")
def test_a_current_that_was_used_is_not_listed_as_unused() -> None:
    constants = {"torque_constant": 0.1}
    mapping = FileMapping(side="input", units={"spd": "rev/s", "i_avr": "mA"}, constants=constants)
    found = identify("csg-20-100", [TRIALS / "erob_data.txt"], mapping=mapping)
    assert not any("not used" in each and "current" in each for each in found.files[0].remarks)
