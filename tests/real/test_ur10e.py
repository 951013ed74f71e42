"""One half of a record of a UR10e predicts the other: joints that moved alone (Mamedov, dynamic_calibration, 2020), 100 Hz.

The torque constant is not known, and a rough one is given: currents that are predicted do not depend on it. Run with `-s` to
read the numbers.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from functools import cache
from pathlib import Path

import pytest
import strainwave as sw
from strainwave.identification.candidates.friction import innermost

from tests.python.command import strainwave

FOLDER = Path(os.environ.get("STRAINWAVE_DATA", Path(__file__).parents[3] / "shared" / "data")) / "arms" / "ur10e"
TORQUE_CONSTANT = 0.1  # N.m/A, rough
MAX_CHANGE_SIGMA = 3.0  # standard deviations between halves of one record

pytestmark = pytest.mark.skipif(not FOLDER.is_dir(), reason=f"measured data not found: {FOLDER} (set STRAINWAVE_DATA)")


def mapping(joint: int, torque_constant: float) -> sw.FileMapping:
    columns = {"time": "1", "output_angle": str(1 + joint), "output_speed": str(7 + joint), "current": str(13 + joint)}
    units = {"output_angle": "rad", "output_speed": "rad/s"}
    return sw.FileMapping(columns=columns, units=units, constants={"ratio": 101.0, "torque_constant": torque_constant})


def halves(joint: int, folder: Path) -> tuple[Path, Path]:
    rows = (FOLDER / f"ur-20_01_22-joint_{joint}.csv").read_text().splitlines()
    paths = folder / "first.csv", folder / "second.csv"
    for path, part in zip(paths, (rows[: len(rows) // 2], rows[len(rows) // 2 :]), strict=True):
        path.write_text("\n".join(part) + "\n")
    return paths


@pytest.fixture(scope="module")
def predicted(tmp_path_factory: pytest.TempPathFactory) -> Callable[[int, float], sw.identification.Prediction]:
    """The second half of a joint, predicted by the gear of the first half with a torque constant."""

    @cache
    def by_the_first_half(joint: int, constant: float) -> sw.identification.Prediction:
        folder = tmp_path_factory.mktemp("halves")
        first, second = halves(joint, folder)
        found = sw.identify("csg-20-100", [first], mapping=mapping(joint, constant), accept=constant != TORQUE_CONSTANT)
        found.gear_set.save(folder / "gear.toml")
        (prediction,) = sw.predict(folder / "gear.toml", [second], mapping=mapping(joint, constant))
        return prediction

    return by_the_first_half


@pytest.mark.slow("identification")
@pytest.mark.parametrize("joint", [1, 2, 4, 5])
def test_the_first_half_predicts_the_second(
    joint: int, predicted: Callable[[int, float], sw.identification.Prediction]
) -> None:
    found = predicted(joint, TORQUE_CONSTANT)
    errors = f"error {found.error:.3f} A of {found.varies:.3f}, {found.allowed:.3f} allowed, plain {found.plain:.3f}"
    print(f"\njoint {joint}: {errors}")
    for each in found.changes:
        print(f"  {each.name} {each.value:.4g} ± {each.sigma:.2g} {each.unit}, {each.significance:.1f} standard deviations off")
    assert not found.contradicts
    assert found.changed == ()
    assert found.error < 1.05 * found.plain  # plain least squares is fitted to the second half itself
    assert all(each.significance < MAX_CHANGE_SIGMA for each in found.changes)
    assert any(each.kind in ("order", "either") and abs(each.order - 2.0) < 0.05 for each in found.lines)


@pytest.mark.slow("identification")
def test_currents_do_not_depend_on_the_torque_constant(predicted: Callable[[int, float], sw.identification.Prediction]) -> None:
    assert predicted(2, 4.0 * TORQUE_CONSTANT).error == pytest.approx(predicted(2, TORQUE_CONSTANT).error, rel=0.05)


@pytest.mark.slow("identification")
def test_the_friction_of_a_gear_of_two_joints_is_that_of_one_of_them(tmp_path: Path) -> None:
    """Joint 1 shows another friction at low speed, joint 2 a loss under load: it is fitted with that friction."""
    files = [tmp_path / name for name in ("a.csv", "b.csv")]
    for joint, file in zip((1, 2), files, strict=True):
        file.write_bytes((FOLDER / f"ur-20_01_22-joint_{joint}.csv").read_bytes())
    found = sw.identify("csg-20-100", files, mapping=lambda path: mapping(1 + files.index(path), TORQUE_CONSTANT))
    coulomb, mesh = innermost(found.gear_set.gear.friction_input).coulomb, found.gear_set.gear.friction_mesh
    fitted = [each.fit.gear for each in found.files if each.fit is not None]
    assert coulomb in [innermost(each.friction_input).coulomb for each in fitted]
    losses = [each.friction_mesh.driving_forward for each in fitted if hasattr(each.friction_mesh, "driving_forward")]
    assert not losses or mesh.driving_forward != losses[0]  # it was fitted anew with the friction of the other joint
    (check,) = (check for check in found.checks if check.name == "agreement of files")
    assert "steady_friction" in check.message


@pytest.mark.slow("identification")
def test_halves_of_a_joint_do_not_contradict_each_other(tmp_path: Path) -> None:
    for joint in (1, 2):
        (tmp_path / str(joint)).mkdir()
        found = sw.identify("csg-20-100", list(halves(joint, tmp_path / str(joint))), mapping=mapping(joint, TORQUE_CONSTANT))
        assert not any(check.failed for check in found.checks if check.name == "agreement of files")


@pytest.mark.slow("identification")
@pytest.mark.parametrize("joint", [3, 6])
@pytest.mark.parametrize(("ratio", "torque_constant"), [(101.0, 0.1), (161.6, 0.2)])
def test_the_verdict_names_what_one_encoder_does_not_check(
    tmp_path: Path, joint: int, ratio: float, torque_constant: float
) -> None:
    """Its ripple checks the ratio; nothing checks the torque constant."""
    columns = (f"output_angle={1 + joint}", f"output_speed={7 + joint}", f"current={13 + joint}", "time=1")
    constants = (f"ratio={ratio:g}", f"torque_constant={torque_constant:g}")
    result = strainwave(
        "identify", "csg-20-100", FOLDER / "ur-20_02_05-20sec_12harm.csv", *(f"--column={each}" for each in columns),
        "--unit=output_angle=rad", "--unit=output_speed=rad/s", *(f"--constant={each}" for each in constants), folder=tmp_path,
    )  # fmt: skip
    value = f"the torque constant, {torque_constant:g} N·m/A"
    assert f"it does not check {value}: friction, inertia and gravity scale with it" in result.stdout
    assert f"nothing checks {value}" in (tmp_path / "out" / "identify" / "report.html").read_text(encoding="utf-8")
    wrong = "a ratio of 100 or 101, the ratio of the gear is 161.6"
    assert (wrong in result.stdout) == (ratio > 101.0)
    assert ("--constant ratio=100 or --constant ratio=101" in result.stdout) == (ratio > 101.0)
