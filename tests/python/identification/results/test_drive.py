"""The drive that files determine: contents of its file, and other commands run it. Its joints are from tests.evidence.arms."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import strainwave as sw
from strainwave.files.gear_set import GearSet

from tests.evidence.arms import Joint, Recorder, fourier, rtde, run
from tests.python.command import strainwave

JOINT = Joint()
STATED = {"torque_constant": 0.12, "motor_inertia": 4e-5, "ratio": 100.0}
START = "csg-20-100"


def mapping(**constants: float) -> sw.FileMapping:
    return sw.FileMapping(joint="1", constants=constants)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Logs of one joint of an arm, and of the same joint with another load: the arm is stretched out."""
    place = tmp_path_factory.mktemp("joint")
    record = Recorder(rate=125.0)
    rtde(place / "joint.csv", record(run((JOINT,) * 3, fourier(30.0, (1,), 2))))
    stretched = fourier(30.0, (1,), 3)
    stretched[2] = 0.0
    rtde(place / "stretched.csv", record(run((JOINT,) * 3, stretched)))
    return place


@pytest.fixture(scope="module")
def found(folder: Path) -> GearSet:
    return sw.identify(START, [folder / "joint.csv"], mapping=mapping(**STATED)).gear_set


@pytest.mark.slow("identification")
def test_it_has_a_name_of_its_own_and_names_the_set_it_started_from(found: GearSet) -> None:
    assert found.name == "gear of joint 1 of joint"
    assert found.maker == ""
    assert "starting from CSG-20-100 of Harmonic Drive" in found.note


@pytest.mark.slow("identification")
def test_it_contains_load_and_motor_with_their_sources(found: GearSet) -> None:
    assert found.load.gravity_torque == pytest.approx(38.14, rel=0.02)
    assert found.sources["load.inertia"].source == "identified from joint.csv"
    assert found.sources["load.inertia"].uncertainty == pytest.approx(0.0, abs=0.1)
    assert found.motor.torque_constant == 0.12
    assert found.motor.inertia == 4e-5
    of_constant = found.sources["motor.torque_constant"].source
    assert of_constant.startswith("given with joint.csv; in joint.csv current is counted in the sense of the output, ")
    assert of_constant.endswith(", current of the log = -current of the model")
    assert isinstance(found.drive, sw.Drive)


@pytest.mark.slow("identification")
def test_bristles_are_saved_as_fitted_not_as_identified(found: GearSet) -> None:
    law = found.gear.friction_input
    assert isinstance(law, sw.friction.LuGre)
    assert law.coulomb / law.bristle_stiffness == pytest.approx(JOINT.bend, rel=0.7)
    source = found.sources["gear.friction_input.bristle_stiffness"]
    assert source.source == "fitted to reversals of joint.csv; a presliding loop determines it"
    assert source.uncertainty is None


@pytest.mark.slow("identification")
def test_the_covariance_has_the_standard_deviations_of_the_numbers(found: GearSet) -> None:
    assert found.covariance is not None
    assert {"gear.friction_input.coulomb", "load.inertia", "load.gravity_phase"} <= set(found.covariance.paths)
    sigma = np.sqrt(np.diag(found.covariance.array))
    np.testing.assert_allclose(sigma, [found.sources[path].uncertainty for path in found.covariance.paths], rtol=1e-6)
    assert found.covariance.correlation("gear.friction_input.coulomb", "gear.friction_input.viscous") < -0.2


@pytest.mark.slow("identification")
def test_the_errors_on_its_file_are_those_of_the_drive_as_saved(found: GearSet) -> None:
    (own,) = found.validation
    assert (own.file, own.channel, own.unit) == ("joint.csv", "current", "A")
    assert 0.02 < own.relative < 0.08  # 3 % are noise
    assert own.error == pytest.approx(own.held_out, rel=0.5)


@pytest.mark.slow("identification")
def test_it_is_read_back_equal_shown_and_simulated(found: GearSet, folder: Path) -> None:
    found.save(folder / "gear.toml")
    assert GearSet.read(folder / "gear.toml") == found
    assert sw.load(folder / "gear.toml") == found.drive
    shown = strainwave("show", "gear.toml", folder=folder).stdout
    assert "[covariance] of 6 numbers" in shown
    assert "[validation] root mean square errors" in shown
    command = 'duration = 0.2\n[command]\nkind = "step"\namplitude = { value = 2.0, unit = "A" }\n'
    (folder / "push.toml").write_text(command)
    result = strainwave("simulate", "gear.toml", "--scenario", "push.toml", folder=folder)
    assert result.returncode == 0, result.stderr
    assert "output_angle" in result.stdout


@pytest.mark.slow("identification")
def test_a_later_identification_keeps_the_covariance_of_what_it_does_not_change(found: GearSet) -> None:
    speed = np.geomspace(2.0, 200.0, 12)
    torque = JOINT.coulomb + JOINT.viscous * speed + 1e-4 * np.cos(np.arange(12.0))
    table = sw.Recording({"speed": speed, "torque": torque}, {"speed": "rad/s", "torque": "N.m"})
    later = sw.identify(found, {"friction": table}, name="my joint").gear_set
    assert later.name == "my joint"
    assert later.load == found.load
    assert later.covariance is not None
    assert found.covariance is not None
    assert later.covariance.correlation("load.inertia", "load.gravity_torque") == pytest.approx(
        found.covariance.correlation("load.inertia", "load.gravity_torque")
    )
    assert later.sources["gear.friction_input.coulomb"].source != found.sources["gear.friction_input.coulomb"].source


@pytest.mark.slow("identification")
def test_other_loads_of_other_logs_are_stated(folder: Path) -> None:
    found = sw.identify(START, [folder / "joint.csv", folder / "stretched.csv"], mapping=mapping(**STATED)).gear_set
    assert found.name == "gear of joint 1 of joint and 1 more"
    assert "other logs carry other loads: " in found.note


@pytest.mark.slow("identification")
def test_numbers_in_current_are_not_written_and_this_is_stated(folder: Path) -> None:
    found = sw.identify(START, [folder / "joint.csv"], mapping=mapping(ratio=100.0)).gear_set
    lacking = "oad, friction measured in A, as the torque constant is not known: "
    assert found.load is None
    assert found.gear.friction_input == sw.load(START).friction_input
    assert f"L{lacking}" in found.note
    options = ("--joint", "1", "--constant", "ratio=100", "--out", "amperes")
    result = strainwave("identify", START, "joint.csv", *options, folder=folder)
    first = result.stdout.splitlines()[0]
    assert first.startswith(f"gear of joint 1 of joint: l{lacking}")
    assert first.endswith(", or the gear keeps friction of the start set")
    page = (folder / "amperes" / "report.html").read_text()
    assert "<h1>gear of joint 1 of joint</h1>" in page
    assert f'<p class="verdict">L{lacking}' in page


@pytest.mark.slow("identification")
def test_a_measured_torque_gives_a_motor_of_torque(folder: Path) -> None:
    recorded = Recorder(rate=125.0)(run((replace(JOINT),) * 3, fourier(30.0, (1,), 2)))
    columns = {"time": recorded["time"], "output_angle": recorded["q"][1], "joint_torque": recorded["motor_torque"][1]}
    log = sw.Recording(columns, {"time": "s", "output_angle": "rad", "joint_torque": "N.m"})
    found = sw.identify(START, {"log": log}, mapping=sw.FileMapping(constants={"ratio": 100.0})).gear_set
    assert isinstance(found.motor, sw.motor.TorqueSource)
    assert found.sources["motor.inertia"].assumed
    assert found.load is not None


def test_a_name_must_be_one_line() -> None:
    with pytest.raises(ValueError, match="name = 'a\\\\nb' must be one line of text"):
        sw.identify(START, ["joint.csv"], name="a\nb")


def test_an_inertia_that_a_log_does_not_determine_is_assumed_so_that_the_drive_runs(tmp_path: Path) -> None:
    """A slow motion against gravity and friction. Without an inertia of the load no step is short enough."""
    time = np.arange(0.0, 40.0, 0.02)
    angle = 1.2 * np.sin(0.3 * time)
    torque = 40.0 * np.sin(angle) + 6.0 * np.sign(np.cos(0.3 * time)) + 8.0 * 0.36 * np.cos(0.3 * time)
    torque += 0.1 * np.random.default_rng(0).standard_normal(len(time))
    units = {"t": "s", "q": "rad", "tau": "N.m"}
    sw.Recording({"t": time, "q": angle, "tau": torque}, units).to_csv(tmp_path / "slow.csv")
    slow = sw.identify("robot-joint", [tmp_path / "slow.csv"]).gear_set
    assert slow.load.gravity_torque == pytest.approx(40.0, rel=0.02)
    assert slow.load.inertia == sw.load("robot-joint").load.inertia
    assert slow.sources["load.inertia"].source == "assumed: that of the start set, as slow.csv does not determine it"
    sw.simulate(slow.drive, sw.scenario.constant(0.0, 1e-3))
