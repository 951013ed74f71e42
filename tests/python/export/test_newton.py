"""Actuators of Newton: in Newton, against the simulation of their drives."""

import importlib
import json
import sys

import numpy as np
import pytest
import strainwave as sw
from strainwave.commands.export import export
from strainwave.export.newton import build
from strainwave.native import nvrtc
from typer.testing import CliRunner

from tests.evidence.newton_agreement import JOINT_STEP, Follower

NAME = "position-drive"  # whose code Warp compiles in a few seconds
PACKAGE = "reference_drive_of_a_test"
COUNT = 4096
STEP = 1e-3  # s, of Newton


@pytest.fixture(scope="module")
def exported():
    pytest.importorskip("warp")
    pytest.importorskip("newton")
    return sw.export.newton(sw.GearSet.read(NAME), gpu=False)


@pytest.fixture(scope="module")
def package(exported, tmp_path_factory):
    """The exported package, imported as a user does."""
    folder = tmp_path_factory.mktemp("packages")
    for path, content in exported.files.items():
        target = folder / PACKAGE / path
        target.parent.mkdir(exist_ok=True)
        target.write_text(content)
    sys.path.insert(0, str(folder))
    yield importlib.import_module(PACKAGE)
    sys.path.remove(str(folder))


class Joints:
    """Actuators of a package at joints whose angle, speed and target are the same for all, or one for each."""

    def __init__(self, package, count):
        import warp as wp
        from newton.actuators import Actuator

        indices = wp.array(np.arange(count), dtype=wp.uint32, device="cpu")
        self.actuator = Actuator(indices=indices, drive=package.DriveStrainWave())
        self.state, self.control = self.actuator.sim_state(), self.actuator.sim_control()
        arrays = [wp.zeros(count, dtype=wp.float32, device="cpu") for _ in range(5)]
        self.state.joint_q, self.state.joint_qd, *targets, self.control.joint_f = arrays
        self.control.joint_target_q, self.control.joint_target_qd = targets
        self.here, self.there = self.actuator.state(), self.actuator.state()

    def step(self, angle, speed, target):
        given = (self.state.joint_q, angle), (self.state.joint_qd, speed), (self.control.joint_target_q, target)
        for array, value in given:
            array.numpy()[:] = value
        self.control.joint_f.zero_()
        self.actuator.step(self.state, self.control, self.here, self.there, dt=STEP)
        self.here, self.there = self.there, self.here
        return self.control.joint_f.numpy().copy()

    def swing(self, steps):
        """The torques after a swing from rest."""
        for k in range(steps):
            phase = 2.0 * np.pi * 2.0 * k * STEP
            torque = self.step(0.02 * (1.0 - np.cos(phase)), 0.02 * 2.0 * np.pi * 2.0 * np.sin(phase), 0.05 * k * STEP)
        return torque


@pytest.mark.slow("export")
def test_it_moves_as_the_simulation(exported):
    assert {loss.quantity for loss in exported.losses} == {"torque", "load_torque", "twist", "input_speed", "current"}
    for loss in exported.losses:
        assert loss.size > 0.0
        assert loss.largest_share < 1e-6, loss.quantity  # Newton hands angles on in single precision


@pytest.mark.slow("export")
def test_thousands_of_gears_move_as_one(package):
    many, one = Joints(package, COUNT), Joints(package, 1)
    torque, alone = many.swing(20), one.swing(20)
    assert abs(alone[0]) > 1e-3
    np.testing.assert_array_equal(torque, np.full(COUNT, alone[0]))
    outputs = many.here.drive_state.outputs.numpy()
    np.testing.assert_array_equal(outputs[package.OUTPUTS.index("load_torque")], torque)


def test_a_target_without_rate_moves_in_a_line(package):
    """The motion is one with rates that are constant between calls."""
    torques = []
    for rate in (0.0, 0.05):
        joints = Joints(package, 1)
        for k in range(20):
            joints.control.joint_target_qd.fill_(rate)
            torque = joints.step(0.0, 0.0, 0.05 * k * STEP)
        torques.append(float(torque[0]))
    assert abs(torques[0]) > 1e-3
    assert torques[0] == pytest.approx(torques[1], rel=1e-4)


def test_each_gear_has_its_own_numbers(package):
    joints = Joints(package, 3)
    damping = package.PARAMETERS["gear.damping"]["value"]
    joints.actuator.drive.set({"gear.damping": [damping, damping + 1.0, damping]})
    first, second, third = joints.swing(20)
    assert first == third == Joints(package, 1).swing(20)[0]
    assert first != second


def test_a_masked_gear_begins_anew_at_its_joint(package):
    import warp as wp

    joints = Joints(package, 2)
    joints.swing(20)
    joints.here.drive_state.reset(wp.array([True, False], dtype=wp.bool, device="cpu"))
    torque = joints.step(1.0, 0.0, 1.0)
    assert torque[0] == pytest.approx(0.0, abs=1e-6)
    assert abs(torque[1]) > 1.0  # it was moved by a radian in one step


@pytest.mark.slow("export")
def test_the_bodies_within_a_gear_begin_at_the_speed_of_the_joint(tmp_path):
    """At rest at the begin, the wave generator of a staged gear twisted it by two thirds more than the whole motion does."""
    exported = build.newton(sw.GearSet.read("tilt-actuator"), gpu=False, compare=False)
    for path, content in exported.files.items():
        (tmp_path / path).write_text(content)
    about = json.loads(exported.files["drive.json"])
    drive = sw.GearSet.read("tilt-actuator").drive.replace(load=sw.loads.Prescribed(), meter=sw.meter.NoMeter())
    turning = sw.scenario.ramp(0.5, 0.1)
    run = sw.simulate(drive, turning, about["step"], sample=JOINT_STEP, inputs={"output_angle": turning})
    value, rate = turning.value(run["time"]), turning.rate(run["time"])
    joint = np.ascontiguousarray(np.array([value, rate, value, rate, np.zeros(len(run))]).T.astype(np.float32))
    outputs = Follower(drive, tmp_path, about, joint).by_compiler()
    for name in ("torque", "twist", "input_speed"):  # the simulation begins with the current that the command asks for
        assert np.abs(outputs[name] - run[name]).max() < 0.01 * np.abs(run[name]).max(), name


@pytest.mark.slow("export")
def test_a_builder_makes_actuators_of_joints(package):
    import newton

    builder = newton.ModelBuilder()
    for damping in (None, 3.0):
        link = builder.add_link(mass=1.0, inertia=((0.1, 0, 0), (0, 0.1, 0), (0, 0, 0.1)))
        joint = builder.add_joint_revolute(-1, link, axis=newton.Axis.Z)
        builder.add_articulation([joint])
        given = {} if damping is None else {"gear.damping": damping}
        builder.add_actuator(package.DriveStrainWave, index=builder.joint_qd_start[joint], **given)
    model = builder.finalize(device="cpu")
    (actuator,) = model.actuators
    state, control, here, there = model.state(), model.control(), actuator.state(), actuator.state()
    control.joint_target_q.fill_(0.1)
    for _ in range(20):
        control.joint_f.zero_()
        actuator.step(state, control, here, there, dt=STEP)
        here, there = there, here
    first, second = control.joint_f.numpy()
    assert first > 0.01  # towards the target
    assert first != second


@pytest.mark.parametrize(
    ("numbers", "message"),
    [
        ({"gear.damping": -1.0}, r"gear.damping = -1 N.m.s/rad must lie within \[0, inf\]"),
        ({"gear.dampin": 1.0}, "gear.dampin is no number of this drive"),
        ({"gear.damping": [1.0, 2.0, 3.0]}, "give one number, or one for each of 2 gears"),
        ({"motor.inertia": [1e-5, 0.0], "gear.input_inertia": 0.0}, "gear 1 contradict each other"),
    ],
)
def test_numbers_that_no_gear_has_are_refused(package, numbers, message):
    joints = Joints(package, 2)
    with pytest.raises(ValueError, match=message):
        joints.actuator.drive.set(numbers)
    assert joints.swing(20)[0] == Joints(package, 1).swing(20)[0]


@pytest.mark.slow("export")
def test_its_source_is_one_text_and_has_code_for_gpus(monkeypatch):
    if not nvrtc.is_installed():
        pytest.skip("the package nvidia-cuda-nvrtc is not installed")
    compiled = build.ptx
    monkeypatch.setattr(build, "ptx", lambda text: compiled(text, "--device-debug"))  # optimised it takes 20 s
    found = sw.export.newton(sw.Drive(), compare=False)
    assert "#include" not in found.files["drive.hpp"]
    for name in ("words", "prepare", "advance"):
        assert f".entry strainwave_{name}(" in found.files["drive.ptx"]


def test_command_draws_gears(tmp_path):
    folder = tmp_path / "drive"
    arguments = ["newton", "robot-joint", "--draws", "5", "--no-gpu", "--no-compare", "--out", str(folder)]
    result = CliRunner().invoke(export, arguments)
    assert result.exit_code == 0, result.output
    about = json.loads((folder / "drive.json").read_text())
    draws = json.loads((folder / "draws.json").read_text())
    assert set(draws) <= set(about["parameters"])
    assert all(len(values) == 5 for values in draws.values())
    assert len(draws) > 5


def test_a_gear_without_motor_is_one_line():
    with pytest.raises(ValueError, match="motor"):
        sw.export.newton(sw.GearSet.read("csg-20-100"))


def test_without_newton_it_is_not_compared_and_names_the_packages(tmp_path, monkeypatch):
    monkeypatch.setattr(build, "find_spec", lambda name: None)
    found = sw.export.newton(sw.Drive(), gpu=False)
    assert found.losses == ()
    assert any("newton and warp-lang are not installed" in each for each in found.remarks)
    for path, content in found.files.items():
        (tmp_path / path).write_text(content)
    monkeypatch.setitem(sys.modules, "warp", None)
    with pytest.raises(ImportError, match="needs the packages newton"):
        build.loaded(tmp_path)
