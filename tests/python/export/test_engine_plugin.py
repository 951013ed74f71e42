"""Plugins of MuJoCo, run by MuJoCo itself, against the simulation of their drives."""

import copy
import re
import shutil
import subprocess
import sys
from functools import cache
from importlib import resources
from pathlib import Path
from tempfile import mkdtemp

import numpy as np
import pytest
import strainwave as sw
from strainwave.export import engine_plugin as export
from strainwave.export.coupled import CoupledDrive
from strainwave.native.compilers import NoCompilerError
from typer.testing import CliRunner

mujoco = pytest.importorskip("mujoco")
pytestmark = pytest.mark.usefixtures("kept_builds")

DRIVES = ("position-drive", "robot-joint")  # a compilation of each takes some seconds
AMPLITUDE, FREQUENCY, DURATION = 0.2, 0.5, 2.0  # rad, Hz, s
SAMPLE = 1e-2  # s
ARM = """<mujoco><option timestep="0.0005" integrator="implicitfast" gravity="0 0 0"/><worldbody><body>
  <joint name="shoulder" axis="0 1 0"/><inertial pos="0 0 0" mass="1" diaginertia="4 4 4"/>
  <body pos="0 0 -.3"><joint name="elbow" axis="0 1 0" frictionloss="0.1"/><joint name="rail" type="slide"/>
  <inertial pos="0 0 0" mass="0.1" diaginertia=".005 .005 .005"/></body></body></worldbody>
  <actuator><motor joint="elbow" name="old"/></actuator></mujoco>"""


@cache
def folder():
    return Path(mkdtemp())


@cache
def exported(name):
    """A drive with an inertia as its load; its plugin is registered for all tests."""
    gear_set = sw.GearSet.read(name)
    found = sw.export.mujoco_plugin(gear_set, name=name)
    library = folder() / f"{name}.so"
    library.write_bytes(found.files[f"{name}.so"])
    mujoco.mj_loadPluginLibrary(str(library))
    return found


def model_of(name, timestep):
    model = mujoco.MjModel.from_xml_string(exported(name).files["gear.xml"])
    model.opt.timestep = timestep
    model.dof_solref[:, 0] = np.where(model.dof_solref[:, 0] > 0.0, 2.0 * timestep, model.dof_solref[:, 0])
    return model


def driven(model, data, steps):
    """Output angles under a sine, one for each step."""
    angles = []
    for _ in range(steps):
        data.ctrl[0] = AMPLITUDE * np.sin(2.0 * np.pi * FREQUENCY * data.time)
        mujoco.mj_step(model, data)
        angles.append(data.qpos[0])
    return np.array(angles)


@pytest.mark.slow("export")
@pytest.mark.parametrize("name", DRIVES)
def test_error_is_of_first_order_in_the_timestep(name):
    drive = sw.GearSet.read(name).drive
    drive = drive.replace(load=sw.loads.Inertia(inertia=drive.load.inertia))
    motion = sw.scenario.sine(amplitude=AMPLITUDE, frequency=FREQUENCY, duration=DURATION)
    wanted = sw.simulate(drive, motion, 1e-4, sample=SAMPLE)["output_angle"]
    errors = []
    for timestep in (1e-3, 5e-4):
        model = model_of(name, timestep)
        data, every = mujoco.MjData(model), round(SAMPLE / timestep)
        data.qpos[0] = wanted[0]
        found = driven(model, data, round(DURATION / timestep))[every - 1 :: every]
        errors.append(np.abs(found - wanted[1:]).max() / np.ptp(wanted))
    assert errors[0] < 3e-3
    assert errors[1] < 0.6 * errors[0]


@pytest.mark.parametrize("name", DRIVES)
def test_stated_loss_falls_to_the_simulation(name):
    for loss in exported(name).losses:
        assert loss.quantity == "output_angle"
        assert loss.size > 0.05
        assert loss.rms_share < 2e-4


def test_state_is_copied_stored_and_reset_with_the_data():
    model = model_of("robot-joint", 1e-3)
    data, other = mujoco.MjData(model), mujoco.MjData(model)
    whole = driven(model, data, 400)
    mujoco.mj_resetData(model, data)
    first = driven(model, data, 200)
    made = copy.copy(data)
    mujoco.mj_copyData(other, model, data)
    content = mujoco.mjtState.mjSTATE_INTEGRATION
    stored = np.empty(mujoco.mj_stateSize(model, content))
    mujoco.mj_getState(model, data, stored, content)
    rests = [driven(model, each, 200) for each in (data, made, other)]
    driven(model, other, 50)
    mujoco.mj_setState(model, other, stored, content)
    rests.append(driven(model, other, 200))
    for rest in rests:
        np.testing.assert_array_equal(np.concatenate([first, rest]), whole)


def test_runge_and_kutta_see_the_drive_move_within_a_step():
    model = model_of("robot-joint", 1e-3)
    coarse = driven(model, mujoco.MjData(model), 1000)[-1]
    model.opt.integrator = mujoco.mjtIntegrator.mjINT_RK4
    assert driven(model, mujoco.MjData(model), 1000)[-1] == pytest.approx(coarse, rel=5e-3)


def test_an_arm_gets_two_drives_in_one_call(monkeypatch):
    monkeypatch.setattr(export, "compiled", lambda sources, include: b"library")
    monkeypatch.setattr(export, "losses", lambda *_: ())
    joint, other = (sw.GearSet.read(name) for name in ("robot-joint", "position-drive"))
    found = sw.export.mujoco_plugin(
        joint, into=ARM, joint={"elbow": other, "all": joint}, max_torque=100.0, keep="frictionloss"
    )
    assert list(found.files) == ["gear.so", "gear_2.so", "gear.xml"]
    assert found.remarks[0] == "the actuator old still acts on elbow, behind the gear; let elbow_gear_motor take its place"
    text = found.files["gear.xml"].replace("strainwave.gear_2", "strainwave.position-drive")
    text = text.replace('"strainwave.gear"', '"strainwave.robot-joint"')  # libraries that other tests have loaded
    for name in DRIVES:
        exported(name)
    model = mujoco.MjModel.from_xml_string(text)
    assert model.joint("elbow").frictionloss[0] == pytest.approx(0.1 + CoupledDrive.of(other.drive, 100.0).hold)
    data = mujoco.MjData(model)
    data.ctrl[[data.actuator(f"{name}_gear_motor").id for name in ("shoulder", "elbow")]] = 0.05, -0.1
    mujoco.mj_step(model, data, nstep=4000)
    assert data.joint("shoulder").qpos[0] == pytest.approx(0.05, abs=2e-3)
    assert data.joint("elbow").qpos[0] == pytest.approx(-0.1, abs=5e-3)


def test_joints_of_one_drive_share_a_library(monkeypatch):
    monkeypatch.setattr(export, "compiled", lambda sources, include: b"library")
    monkeypatch.setattr(export, "losses", lambda *_: ())
    found = sw.export.mujoco_plugin(sw.GearSet.read("robot-joint"), into=ARM, joint="all")
    assert list(found.files) == ["gear.so", "gear.xml"]
    assert found.files["gear.xml"].count('plugin="strainwave.gear"') == 3  # the extension, and two actuators


def test_an_unstable_timestep_is_refused_with_the_longest():
    longest = exported("position-drive").numbers["longest_timestep"][0]
    text = re.sub(r'timestep="[^"]+"', f'timestep="{1.01 * longest}"', exported("position-drive").files["gear.xml"])
    with pytest.raises(ValueError, match=r"is unstable for a gear of 150 N\.m/rad .* set .* s or less") as caught:
        mujoco.MjModel.from_xml_string(text)
    stated = float(str(caught.value).rpartition(" set ")[2].split()[0])
    assert 0.9 * longest < stated <= longest


@pytest.mark.slow("export")
def test_another_version_of_mujoco_is_refused_in_one_line(tmp_path):
    """The library is compiled against headers of a version that is not the installed one."""
    include, _ = export.installed_mujoco()
    shutil.copytree(include, tmp_path / "include")
    header = tmp_path / "include/mujoco/mujoco.h"
    header.write_text(re.sub(r"(#define mjVERSION_HEADER) \d+", r"\1 4099001", header.read_text()))
    sources = CoupledDrive.of(sw.Drive(), 0.0).sources("strainwave.other", 2e-4, "mujoco_plugin.cpp")
    (tmp_path / "other.so").write_bytes(export.compiled(sources, tmp_path / "include"))
    words = "import mujoco; mujoco.mj_loadPluginLibrary('./other.so')"
    done = subprocess.run([sys.executable, "-c", words], cwd=tmp_path, capture_output=True, text=True)
    lines = [line for line in (done.stdout + done.stderr).splitlines() if "strainwave.other" in line]
    versions = f"compiled for MuJoCo 4.99.1, and loaded by {mujoco.mj_versionString()}"
    assert lines == [f"strainwave.other: {versions}; export it again with that version installed"]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"name": "a b"}, "must be a name in MuJoCo"),
        ({"command": "hold"}, "held"),
        ({"into": ARM}, "into and joint belong together"),
        ({"into": ARM, "joint": "rail"}, "a gear turns a hinge"),
        ({"load_inertia": -1.0}, "load_inertia = -1"),
    ],
)
def test_wrong_arguments_are_refused_in_one_line(arguments, message, monkeypatch):
    monkeypatch.setattr(export, "compiled", lambda sources, include: pytest.fail("compiled"))
    with pytest.raises(ValueError, match=message):
        sw.export.mujoco_plugin(sw.GearSet.read("position-drive"), **arguments)


def test_old_or_missing_mujoco_and_a_missing_compiler_are_named(monkeypatch):
    def none():
        raise NoCompilerError("there is no C++20 compiler")

    with monkeypatch.context() as change:
        change.setattr("strainwave.export.coupled.drive.find_compiler", none)
        with pytest.raises(NoCompilerError, match=r"there is no C\+\+20 compiler"):
            sw.export.mujoco_plugin(sw.GearSet.read("position-drive"))
    with monkeypatch.context() as change:
        change.setattr(mujoco, "mj_version", lambda: 3_007_000)
        with pytest.raises(ImportError, match=r"a plugin needs 4\.0 or later"):
            sw.export.mujoco_plugin(sw.GearSet.read("position-drive"))
    with monkeypatch.context() as change:
        change.setitem(sys.modules, "mujoco", None)
        with pytest.raises(ImportError, match="which is not installed"):
            sw.export.mujoco_plugin(sw.GearSet.read("position-drive"))


def test_command_writes_the_files(tmp_path, monkeypatch):
    from strainwave.commands.export import export as verb

    monkeypatch.setattr(export, "compiled", lambda sources, include: b"library")
    monkeypatch.setattr(export, "losses", lambda *_: ())
    result = CliRunner().invoke(verb, ["mujoco-plugin", "robot-joint", "--out", str(tmp_path)])
    assert result.exit_code == 0, result.output
    assert {path.name for path in tmp_path.iterdir()} >= {"gear.xml", "export.json"}
    assert "longest_timestep" in result.output
    assert (resources.files("strainwave.export.coupled") / "mujoco_plugin.cpp").is_file()
