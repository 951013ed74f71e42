"""Parameters of ros2_control, and the node, which runs here without ROS."""

import sys
from types import MappingProxyType, ModuleType, SimpleNamespace
from xml.etree import ElementTree

import numpy as np
import pytest
import strainwave as sw
import yaml
from typer.testing import CliRunner


def test_parameters_have_the_numbers_of_the_joint():
    gear_set = sw.GearSet.read("csg-20-100")
    found = sw.export.ros2(gear_set, name="elbow")
    damping = sw.export.joint(gear_set).numbers["damping"][0]
    content = yaml.safe_load(found.files["elbow_limits.yaml"])
    gains = content["joint_trajectory_controller"]["ros__parameters"]["gains"]["elbow"]
    limits = content["controller_manager"]["ros__parameters"]["joint_limits"]["elbow"]
    assert gains == {"ff_velocity_scale": damping}
    assert limits["max_effort"] == pytest.approx(gear_set.ratings["peak_torque"].value)
    assert limits["max_velocity"] * abs(gear_set.gear.kinematics.ratio) == pytest.approx(366.5, abs=0.1)
    root = ElementTree.fromstring(found.files["elbow.ros2_control.xml"])
    assert float(root.findtext("transmission/joint/mechanical_reduction")) == gear_set.gear.kinematics.ratio
    assert {each.get("name") for each in root.iter("joint")} == {"elbow"}


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
        "joint_limits.yaml",
        "joint.ros2_control.xml",
        "drive_node.py",
        "export.json",
    }
