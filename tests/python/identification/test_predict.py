"""Later recordings against a saved drive: what did not change is as saved, and what changed is found, on independent truth."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import strainwave as sw
from strainwave.files.gear_set import GearSet
from strainwave.files.identified_tables import Covariance, Validation
from strainwave.identification.results.prediction import PartChange
from strainwave.report.predict import predict_summary, verdict_sentence

from tests.evidence.arms import Joint, Recorder, fourier, rtde, run
from tests.evidence.rig import RIG, measured
from tests.python.command import refused, strainwave
from tests.support.samples import sample
from tests.support.thinned import thin

JOINT = Joint()
STATED = sw.FileMapping(joint="1", constants={"torque_constant": 0.12, "motor_inertia": 4e-5, "ratio": 100.0})
WORN = replace(JOINT, coulomb=1.3 * JOINT.coulomb, breakaway=1.3 * JOINT.breakaway, loss=1.3 * JOINT.loss)
SPEED = np.geomspace(2.0, 200.0, 12)


def record(path: Path, joint: Joint, seed: int, turned: float = 1.0, way: float = 1.0) -> None:
    seen = Recorder(rate=125.0, seed=seed)(run((joint,) * 3, fourier(30.0, (1,), seed)))
    rtde(path, seen | {"current": turned * seen["current"], "q": way * seen["q"], "dq": way * seen["dq"]})


def record_shifted(path: Path, angle: float = 0.0, current: float = 0.0, delay: float = 0.0, joint: Joint = JOINT) -> None:
    """Write a log with another zero of the angle and of the current; the latter is counted against the motion."""
    seen = Recorder(rate=250.0, seed=12, delay=delay)(run((joint,) * 3, fourier(30.0, (1,), 12)))
    rtde(path, seen | {"q": seen["q"] + angle, "current": seen["current"] + current})


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A saved joint, and later logs of it by other motions: as it was, worn, and with another zero of the current."""
    place = tmp_path_factory.mktemp("joint")
    record(place / "first.csv", JOINT, 2)
    record(place / "same.csv", JOINT, 12)
    record(place / "worn.csv", WORN, 12)
    record(place / "thick.csv", replace(JOINT, viscous=1.5 * JOINT.viscous), 12)
    sw.identify("csg-20-100", [place / "first.csv"], mapping=STATED).gear_set.save(place / "gear.toml")
    return place


def predicted(folder: Path, name: str) -> sw.identification.Prediction:
    (found,) = sw.predict(folder / "gear.toml", [folder / name], mapping=STATED)
    return found


def change(found: sw.identification.Prediction, name: str) -> PartChange:
    found_changes: tuple[PartChange, ...] = found.changes
    return next(each for each in found_changes if each.name == name)


@pytest.mark.slow("identification")
def test_an_unchanged_joint_is_unchanged(folder: Path) -> None:
    found = predicted(folder, "same.csv")
    assert not found.contradicts
    assert found.changed == ()
    assert found.relative < 0.06  # 3 % are noise
    assert found.error < found.plain < found.varies
    assert {each.name for each in found.changes} >= {"dry friction", "viscous friction", "zero", "gravity of the load"}


@pytest.mark.slow("identification")
def test_friction_scaled_by_1_3_is_reported_as_that_and_contradicts(folder: Path) -> None:
    found = predicted(folder, "worn.csv")
    dry = change(found, "dry friction")
    assert found.contradicts
    assert dry.significant
    assert abs(dry.value - 1.3) < min(3.0 * dry.sigma, 0.05)
    assert [each.name for each in found.changed] == ["dry friction"]
    assert found.error_with_changes < 0.4 * found.error


@pytest.mark.slow("identification")
def test_viscous_friction_scaled_by_1_5_is_found_within_what_the_result_allows(folder: Path) -> None:
    found = predicted(folder, "thick.csv")
    viscous = change(found, "viscous friction")
    assert found.verdict == "differs"
    assert "differs from gear of joint 1 of first, within the allowed error: viscous friction is 1." in verdict_sentence(found)
    assert [each.name for each in found.changed] == ["viscous friction"]
    assert viscous.value == pytest.approx(1.5, abs=0.1)


@pytest.mark.slow("identification")
def test_another_torque_constant_is_told_from_another_joint(folder: Path) -> None:
    record(folder / "scaled.csv", JOINT, 12, turned=1.15)
    found = predicted(folder, "scaled.csv")
    assert found.common_scale is not None
    saved = sw.GearSet.read(folder / "gear.toml")
    gravity = saved.sources["load.gravity_torque"].uncertainty / saved.load.gravity_torque
    assert found.common_scale[0] == pytest.approx(1.15, rel=3.0 * gravity)
    assert gravity < 0.02
    assert "all torques are 1.1" in verdict_sentence(found)
    assert predicted(folder, "worn.csv").common_scale is None


@pytest.mark.slow("identification")
def test_temperature_is_a_cause_if_it_was_recorded(folder: Path) -> None:
    seen = Recorder(rate=125.0, seed=5)(run((JOINT,) * 3, fourier(30.0, (1,), 12)))
    speed = np.gradient(seen["q"][1], seen["time"])
    kelvin = np.linspace(0.0, 20.0, len(speed))
    lost = -0.01 * kelvin * (JOINT.coulomb / 0.12) * np.tanh(speed / 0.02)
    columns = {
        "time": seen["time"],
        "output_angle": seen["q"][1],
        "current": seen["current"][1] + lost,
        "temperature": 20.0 + kelvin,
    }
    log = sw.Recording(columns, {"time": "s", "output_angle": "rad", "current": "A", "temperature": "degC"})
    constants = sw.FileMapping(constants=dict(STATED.constants))
    (found,) = sw.predict(folder / "gear.toml", {"log": log}, mapping=constants)
    warm = change(found, "friction over temperature")
    assert warm.unit == "1/K"
    assert warm.significant
    assert -0.015 < warm.value < -0.004  # Coulomb's part falls by 1 %/K, of which it is some two thirds


def test_a_table_of_friction_is_predicted_by_the_gear_alone() -> None:
    gear = sw.Gear(friction_input=sw.friction.Coulomb(coulomb=0.05, breakaway=0.05, viscous=3e-4))
    torque = 1.3 * 0.05 + 3e-4 * SPEED + 1e-4 * np.cos(np.arange(12.0))
    table = sw.Recording({"speed": SPEED, "torque": torque}, {"speed": "rad/s", "torque": "N.m"})
    (found,) = sw.predict(gear, {"friction": table})
    assert change(found, "dry friction").value == pytest.approx(1.3, abs=0.01)
    assert [each.name for each in found.changed] == ["dry friction"]


def test_the_recording_that_the_gear_came_from_is_no_evidence(tmp_path: Path) -> None:
    for name, seed in (("first", 0), ("later", 1)):
        torque = 0.05 + 3e-4 * SPEED + 1e-4 * np.random.default_rng(seed).standard_normal(len(SPEED))
        sw.Recording({"speed": SPEED, "torque": torque}, {"speed": "rad/s", "torque": "N.m"}).to_csv(tmp_path / f"{name}.csv")
    sw.identify("csg-20-100", [tmp_path / "first.csv"]).gear_set.save(tmp_path / "gear.toml")
    shutil.copy(tmp_path / "first.csv", tmp_path / "copy.csv")
    names = [tmp_path / f"{name}.csv" for name in ("copy", "later")]
    copy, later = sw.predict(tmp_path / "gear.toml", names)
    assert (copy.verdict, copy.same_as) == ("no evidence", "first.csv")
    assert verdict_sentence(copy).startswith("copy.csv is no evidence: ")
    assert "was identified from this recording as first.csv; " in verdict_sentence(copy)
    assert (later.verdict, later.same_as) == ("agrees", "")
    (unknown,) = sw.predict(sw.GearSet.read(tmp_path / "gear.toml").gear, names[:1])  # a gear that names no files
    assert (unknown.verdict, unknown.same_as) == ("agrees", "")


def test_the_uncertainty_of_the_saved_numbers_is_part_of_that_of_a_change() -> None:
    gear = sw.Gear(friction_input=sw.friction.Coulomb(coulomb=0.05, breakaway=0.05, viscous=3e-4))
    sure = GearSet.of(gear, name="joint", source="measured")
    spread = sw.files.Entry("measured", uncertainty=5e-3)
    unsure = sure.replace(
        sources={**sure.sources, "gear.friction_input.coulomb": spread},
        covariance=Covariance(("gear.friction_input.coulomb",), ((2.5e-5,),)),
    )
    torque = 0.05 + 3e-4 * SPEED + 1e-4 * np.cos(np.arange(12.0))
    table = sw.Recording({"speed": SPEED, "torque": torque}, {"speed": "rad/s", "torque": "N.m"})
    sigmas = [change(sw.predict(each, {"friction": table})[0], "dry friction").sigma for each in (sure, unsure)]
    assert sigmas[0] < 0.01
    assert sigmas[1] == pytest.approx(0.1, rel=0.1)


@pytest.mark.whole_path("identification")
def test_the_command_writes_a_page_and_numbers_and_ends_in_3_if_a_recording_contradicts(folder: Path) -> None:
    options = ("--joint", "1", "--constant", "torque_constant=0.12", "--constant", "ratio=100")
    same = strainwave("predict", "gear.toml", "same.csv", *options, "--out", "same", folder=folder)
    assert same.returncode == 0, same.stderr
    assert "same.csv agrees with gear of joint 1 of first: RMS error " in same.stdout
    assert "nothing changed significantly." in same.stdout
    both = strainwave("predict", "gear.toml", "same.csv", "worn.csv", *options, "--out", "both", folder=folder)
    assert both.returncode == 3
    assert "worn.csv contradicts gear of joint 1 of first: RMS error " in both.stdout
    dry, sigma = map(float, re.findall(r"; dry friction is (\S+) ± (\S+) times that saved\.", both.stdout)[0])
    assert abs(dry - 1.3) < 3.0 * sigma < 0.05
    assert "plain least squares on this file" in both.stdout
    numbers = json.loads((folder / "both" / "results.json").read_text())["files"]
    assert [each["verdict"] for each in numbers] == ["agrees", "contradicts"]
    page = (folder / "both" / "report.html").read_text()
    assert page.count("<svg") == 2
    assert "contradicts" in page
    assert ">nan" not in page


@pytest.mark.slow("identification")
def test_what_cannot_be_predicted_states_why(folder: Path) -> None:
    arguments = ("predict", "csg-20-100", "same.csv", "--joint", "1", "--out", "none")
    refused(folder, arguments, "has no [load], without which no torque along a motion is predicted")
    twist = np.concatenate([np.linspace(0.0, 1e-3, 50), np.linspace(1e-3, -1e-3, 100), np.linspace(-1e-3, 1e-3, 100)])
    loop = sw.Recording({"twist": twist, "torque": 1e4 * twist}, {"twist": "rad", "torque": "N.m"})
    with pytest.raises(ValueError, match="only logs and tables of friction are predicted"):
        sw.predict("csg-20-100", {"torsion": loop})


@pytest.mark.slow("identification")
@pytest.mark.skipif(not RIG.is_dir(), reason=f"the independent joint was not found: {RIG} (set STRAINWAVE_RIG)")
@pytest.mark.parametrize("seed", range(3, 3 + sample(1, 2)))
def test_an_independent_joint_and_its_loads(tmp_path: Path, seed: int) -> None:
    """Friction scaled by 1.3 in another record, and the loads of two other logs: 0.85 to 0.3 kg.m2, 11 to 25 N.m."""
    first, more = shutil.copytree(measured(seed), tmp_path / "first"), (f"seed={seed + 20}", "Fc=0.0611", "Fs=0.0806")
    subprocess.run([sys.executable, RIG / "measure.py", tmp_path / "worn", *more], check=True)
    thin(tmp_path, every=2)
    stated = sw.FileMapping(constants={"torque_constant": 0.0755, "motor_inertia": 7.5e-5})
    saved = sw.identify("hfuc-20-80", [first / "log.csv"], mapping=stated).gear_set
    loads = [first / "two_loads" / f"{name}.csv" for name in ("heavy", "light", "middle")]
    logs = [tmp_path / "worn" / "log.csv", *loads]
    worn, heavy, light, middle = sw.predict(saved, logs, mapping=stated)
    dry = change(worn, "dry friction")
    assert [each.name for each in worn.changed] == ["dry friction"]
    assert abs(dry.value - 1.3) < 3.0 * dry.sigma < 0.1  # models that predict as well are part of it
    assert middle.changed == ()
    assert not middle.contradicts
    assert heavy.contradicts
    assert light.contradicts
    assert {each.name for each in (*heavy.changed, *light.changed)} == {"inertia of the load", "gravity of the load"}
    assert change(heavy, "gravity of the load").value == pytest.approx(25.0 / 11.0, rel=0.01)
    assert change(light, "gravity of the load").value == pytest.approx(0.0, abs=0.01)
    assert change(heavy, "inertia of the load").value == pytest.approx(1.6 / 0.85, rel=0.03)


@pytest.mark.slow("identification")
def test_an_angle_counted_the_other_way_is_named_and_nothing_changed(folder: Path) -> None:
    record(folder / "turned.csv", JOINT, 12, way=-1.0)
    found = predicted(folder, "turned.csv")
    assert not found.contradicts
    assert "the angle is counted in the other sense" in found.remarks[0]


def test_a_table_is_judged_by_the_error_on_tables_not_by_that_on_torsion_loops() -> None:
    """The torque of a torsion loop has the same name, and is a thousand times as large."""
    gear = sw.Gear(friction_input=sw.friction.Coulomb(coulomb=0.05, breakaway=0.05, viscous=3e-4))
    errors = (
        Validation("loop.csv", "torsion", "torque", "N.m", 0.34, 40.0, 0.34, 40.0),
        Validation("table.csv", "friction", "torque", "N.m", 2e-3, 0.08, 2e-3, 0.08),
    )
    saved = GearSet.of(gear, name="joint", source="measured").replace(validation=errors)
    scatter = 1e-3 * np.cos(np.arange(12.0))
    for scale in (1.3, 4.0):
        table = sw.Recording(
            {"speed": SPEED, "torque": scale * (0.05 + 3e-4 * SPEED) + scatter}, {"speed": "rad/s", "torque": "N.m"}
        )
        (found,) = sw.predict(saved, {"friction": table})
        assert found.contradicts
        assert found.allowed == pytest.approx(2.0 * max(2e-3, 2e-3 / 0.08 * found.varies), rel=1e-6)
        assert {each.name for each in found.changed} == {"dry friction", "viscous friction"}
        assert all(abs(each.value - scale) < 3.0 * each.sigma for each in found.changed)
    (alone,) = sw.predict(saved.replace(validation=errors[:1]), {"friction": table})
    assert alone.allowed == pytest.approx(0.5 * alone.varies)  # the loop does not count


@pytest.mark.slow("identification")
@pytest.mark.parametrize("samples", [-2.0, 4.5])
def test_a_delay_of_the_current_is_a_change_of_its_own_and_none_of_friction(folder: Path, samples: float) -> None:
    record_shifted(folder / "late.csv", delay=samples / 250.0)
    found = predicted(folder, "late.csv")
    late = change(found, "delay")
    assert [each.name for each in found.changed] == ["delay"]
    assert late.value == pytest.approx(samples / 250.0, abs=1e-3)
    assert all(abs(each.value - 1.0) < 3.0 * each.sigma for each in found.changes if each.unit == "1")


@pytest.mark.slow("identification")
@pytest.mark.parametrize("angle", [-0.1, 2.5])
def test_an_angle_counted_from_another_zero_is_no_change_of_zero_or_gravity(folder: Path, angle: float) -> None:
    record_shifted(folder / "turned.csv", angle=angle)
    found = predicted(folder, "turned.csv")
    assert [each.name for each in found.changed] == ["zero of the angle"]
    assert change(found, "zero of the angle").value == pytest.approx(angle, abs=0.01)
    assert found.error_with_changes < 0.06 * found.varies
    assert f"zero of the angle is {'−' if angle < 0.0 else ''}" in verdict_sentence(found)


@pytest.mark.slow("identification")
def test_wear_a_delay_and_two_zeros_are_separated(folder: Path) -> None:
    record_shifted(folder / "all.csv", angle=0.4, current=0.1, delay=8e-3, joint=WORN)
    found = predicted(folder, "all.csv")
    truth = {"dry friction": 1.3, "zero": -0.1, "delay": 8e-3, "zero of the angle": 0.4}
    allowed = {"dry friction": 0.03, "zero": 0.02, "delay": 2e-3, "zero of the angle": 0.02}
    assert {each.name for each in found.changed} == truth.keys()
    assert {each.name for each in found.changed if abs(each.value - truth[each.name]) > allowed[each.name]} == set()


@pytest.mark.slow("identification")
def test_a_sure_but_small_change_states_the_limit_that_it_is_below(folder: Path) -> None:
    record_shifted(folder / "drifted.csv", current=0.022)
    found = predicted(folder, "drifted.csv")
    zero = change(found, "zero")
    assert zero.significance > 3.0
    assert not zero.significant
    assert "(no significant change: below 3 % of what the current varies)" in predict_summary([found])


@pytest.mark.slow("identification")
def test_changes_that_leave_the_error_explain_nothing(folder: Path) -> None:
    """The currents of another motion: scales fit a little of them, and one below zero is no torque constant."""
    motions = [Recorder(rate=125.0, seed=seed)(run((JOINT,) * 3, fourier(30.0, (1,), seed))) for seed in (12, 31)]
    rtde(folder / "other.csv", motions[0] | {"current": motions[1]["current"]})
    found = predicted(folder, "other.csv")
    assert found.contradicts
    assert found.error_with_changes > 0.5 * found.varies
    assert any(each.significant for each in found.changes)
    assert found.changed == ()
    assert found.common_scale is None
    assert "no change of friction, load, zero or delay explains it: " in verdict_sentence(found)
