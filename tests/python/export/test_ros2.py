"""Parameters of ros2_control, and the node, which runs here without ROS."""

import sys
from types import MappingProxyType, ModuleType, SimpleNamespace
from xml.etree import ElementTree

import numpy as np
import pytest
import strainwave as sw
import yaml
from typer.testing import CliRunner

ROBOT = """<robot name="arm" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:include filename="{folder}/elbow.xacro"/>
  <link name="upper_arm"/>
  <link name="forearm"><inertial><mass value="2"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
  <xacro:elbow_joint parent="upper_arm" child="forearm" lower="-2.6" upper="2.6" xyz="0 0 0.3"/>
  <xacro:elbow_ros2_control plugin="mine/System"/>
</robot>"""


def test_parameters_have_the_numbers_of_the_joint():
    gear_set = sw.GearSet.read("csg-20-100")
    found = sw.export.ros2(gear_set, name="elbow")
    damping = sw.export.joint(gear_set).numbers["damping"][0]
    content = yaml.safe_load(found.files["elbow_controllers.yaml"])
    assert content["joint_trajectory_controller"]["ros__parameters"]["gains"]["elbow"] == {"ff_velocity_scale": damping}


def test_macros_make_a_joint_of_a_robot(tmp_path):
    """By xacro and MuJoCo's reader of robots, as a robot's description includes the file."""
    xacro, mujoco = pytest.importorskip("xacro"), pytest.importorskip("mujoco")
    gear_set = sw.GearSet.read("csg-20-100")
    found = sw.export.ros2(gear_set, name="elbow")
    (tmp_path / "elbow.xacro").write_text(found.files["elbow.xacro"])
    (tmp_path / "arm.xacro").write_text(ROBOT.format(folder=tmp_path))
    text = xacro.process_file(str(tmp_path / "arm.xacro")).toxml()
    model = mujoco.MjModel.from_xml_string(text)
    joint, forearm = model.joint("elbow"), model.body("forearm")
    assert joint.bodyid == forearm.id
    assert forearm.pos.tolist() == [0.0, 0.0, 0.3]
    assert joint.range.tolist() == [-2.6, 2.6]
    peak_torque = gear_set.ratings["peak_torque"].value
    assert model.jnt_actfrcrange[joint.id] == pytest.approx([-peak_torque, peak_torque])
    assert model.dof_frictionloss[joint.dofadr] == found.numbers["frictionloss"][0]
    robot = ElementTree.fromstring(text)
    speed = float(robot.find("joint/limit").get("velocity")) * abs(gear_set.gear.kinematics.ratio)
    assert speed == pytest.approx(3500.0 * np.pi / 30.0)  # average input speed of the ratings
    (system,) = robot.findall("ros2_control")
    assert (system.get("type"), system.findtext("hardware/plugin")) == ("system", "mine/System")
    assert float(system.findtext("transmission/joint/mechanical_reduction")) == gear_set.gear.kinematics.ratio
    assert {each.get("name") for each in system.iter("joint")} == {"elbow"}


class FakeNode:
    """Stand-in for the node class of rclpy, with the messages that were published."""

    settings = MappingProxyType({"drive": "robot-joint", "joint": "elbow", "rate": 100.0})

    def __init__(self, name):
        self.messages = []

    def declare_parameter(self, name, value):
        return SimpleNamespace(value=self.settings.get(name, value))

    def create_publisher(self, kind, topic, depth):
        return SimpleNamespace(publish=self.messages.append)

    def create_subscription(self, kind, topic, callback, depth):
        assert topic == "elbow/command"

    def create_timer(self, period, callback):
        assert period == 0.01

    def get_clock(self):
        return SimpleNamespace(now=lambda: SimpleNamespace(to_msg=lambda: 0))


def test_node_publishes_the_simulation(monkeypatch):
    members = {
        "rclpy": {"ok": lambda: True},
        "rclpy.node": {"Node": FakeNode},
        "rclpy.executors": {"ExternalShutdownException": RuntimeError},
        "sensor_msgs.msg": {"JointState": lambda: SimpleNamespace(header=SimpleNamespace())},
        "std_msgs.msg": {"Float64": float},
    }
    for name, content in members.items():
        module = ModuleType(name)
        module.__dict__.update(content)
        monkeypatch.setitem(sys.modules, name, module)
    space = {"__name__": "drive_node"}
    exec(sw.export.ros2(sw.GearSet.read("robot-joint"), max_torque=100.0).files["drive_node.py"], space)
    node = space["DriveNode"]()
    node.take(SimpleNamespace(data=0.1))
    for _ in range(50):
        node.advance()
    run = sw.simulate(sw.GearSet.read("robot-joint").drive, sw.scenario.constant(0.1, 0.5), 2e-4, sample=0.01)
    found = np.array([message.position[0] for message in node.messages])
    np.testing.assert_allclose(found, run["output_angle"][1:], rtol=1e-9)
    assert node.messages[-1].name == ["elbow"]


def test_a_name_that_ros_does_not_take_is_refused():
    with pytest.raises(ValueError, match="must be a name in ROS"):
        sw.export.ros2(sw.GearSet.read("csg-20-100"), name="left elbow")


def test_command_writes_the_files(tmp_path):
    from strainwave.commands.export import export

    result = CliRunner().invoke(export, ["ros2", "csg-20-100", "--out", str(tmp_path)])
    assert result.exit_code == 0, result.output
    assert {path.name for path in tmp_path.iterdir()} == {
        "joint.xacro",
        "joint_controllers.yaml",
        "drive_node.py",
        "export.json",
    }
