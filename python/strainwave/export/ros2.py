"""Macros and parameters of a joint for ros2_control, and a node that publishes the joint of a simulated drive."""

from __future__ import annotations

from importlib import resources
from pathlib import Path

from strainwave import Drive, Gear
from strainwave.export.elements import GearElements, remark_on_rotor
from strainwave.export.exported import Exported, Form, stating_origins
from strainwave.export.host import checked_name
from strainwave.export.joint_numbers import joint
from strainwave.files.gear_set import GearSet, gear_set_of


@stating_origins
def ros2(drive: GearSet | Drive | Gear | str | Path, *, max_torque: float | None = None, name: str = "joint") -> Exported:
    """Return a joint as macros of xacro, parameters of its controller, and a node that simulates its drive.

    `joint.xacro` has two macros for the URDF of a robot: the joint with its limits and friction, and its part in ros2_control
    with interfaces and transmission. `joint_controllers.yaml` has the viscous friction as feed-forward of a
    joint_trajectory_controller with effort interface. `drive_node.py` publishes joint states of a drive that it simulates.

    Args:
        drive: a gear, a drive or a set of one, or the name or path of a file
        max_torque: largest torque at the output [N.m]; by default the peak torque of the ratings
        name: of the joint, its files and macros

    Returns:
        The texts of the files by their path, and the numbers in them with their units.

    Raises:
        ValueError: neither a torque nor a rating is given, or the name is none of ROS

    >>> import strainwave as sw
    >>> sorted(ros2("csg-20-100", name="elbow").files)
    ['drive_node.py', 'elbow.xacro', 'elbow_controllers.yaml']
    """
    checked_name(name, "ROS")
    gear_set = gear_set_of(drive)
    found = joint(gear_set, max_torque=max_torque)
    elements = GearElements.of_set(gear_set, max_torque)
    numbers = {key: found.numbers[key] for key in ("frictionloss", "damping", "armature")}
    numbers |= {
        "max_effort": (elements.max_torque, "N.m"),
        "max_velocity": (elements.max_speed / abs(elements.ratio), "rad/s"),
        "mechanical_reduction": (elements.ratio, "1"),
    }
    values = {key: repr(value) for key, (value, _) in numbers.items()}
    files = {
        f"{name}.xacro": _macros(values, name),
        f"{name}_controllers.yaml": _controllers(values, name),
        "drive_node.py": resources.files("strainwave.export").joinpath("drive_node.py").read_text("utf-8"),
    }
    return Exported(
        "ros2",
        gear_set.name,
        files,
        numbers,
        found.losses,
        (*found.left_out, "dry friction: joint_trajectory_controller has no parameter for it; frictionloss is its size"),
        (
            "the macros were expanded by xacro and read by urdfdom, the YAML was parsed; neither was run in ros2_control",
            "max_velocity is that of the average input speed of the ratings; without one it is assumed",
            "drive_node.py needs rclpy, sensor_msgs and std_msgs: of ROS 2, or pip install ros-rclpy ros-rmw-fastrtps-cpp "
            "ros-sensor-msgs ros-std-msgs",
            *remark_on_rotor(gear_set, ", times the ratio squared"),
        ),
    )


def _macros(values: dict[str, str], name: str) -> str:
    """Return the macros of a joint for the URDF of a robot: ros2_control takes the limits of effort and velocity from there."""
    return f"""<?xml version="1.0"?>
<!-- In the URDF of your robot, which has the links:
  <xacro:include filename="{name}.xacro"/>
  <xacro:{name}_joint parent="upper_arm" child="forearm" lower="-2.6" upper="2.6"/>
  <xacro:{name}_ros2_control plugin="mock_components/GenericSystem"/>
-->
<robot xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:macro name="{name}_joint" params="parent child lower upper xyz:='0 0 0' rpy:='0 0 0' axis:='0 0 1'">
    <joint name="{name}" type="revolute">
      <parent link="${{parent}}"/>
      <child link="${{child}}"/>
      <origin xyz="${{xyz}}" rpy="${{rpy}}"/>
      <axis xyz="${{axis}}"/>
      <limit lower="${{lower}}" upper="${{upper}}" effort="{values["max_effort"]}" velocity="{values["max_velocity"]}"/>
      <dynamics damping="{values["damping"]}" friction="{values["frictionloss"]}"/>
    </joint>
  </xacro:macro>
  <xacro:macro name="{name}_ros2_control" params="plugin:=mock_components/GenericSystem">
    <ros2_control name="{name}_system" type="system">
      <hardware>
        <plugin>${{plugin}}</plugin>
      </hardware>
      <joint name="{name}">
        <command_interface name="effort"/>
        <state_interface name="position"/>
        <state_interface name="velocity"/>
        <state_interface name="effort"/>
      </joint>
      <transmission name="{name}_transmission">
        <plugin>transmission_interface/SimpleTransmission</plugin>
        <actuator name="{name}_motor" role="actuator1"/>
        <joint name="{name}" role="joint1">
          <mechanical_reduction>{values["mechanical_reduction"]}</mechanical_reduction>
        </joint>
      </transmission>
    </ros2_control>
  </xacro:macro>
</robot>
"""


def _controllers(values: dict[str, str], name: str) -> str:
    """Return parameters of the controller of a joint."""
    return f"""# Parameters of a controller of the joint {name} for ros2_control. Parsed as YAML; not run in ros2_control.
controller_manager:
  ros__parameters:
    joint_trajectory_controller:
      type: joint_trajectory_controller/JointTrajectoryController
joint_trajectory_controller:
  ros__parameters:
    joints: [{name}]
    command_interfaces: [effort]
    state_interfaces: [position, velocity]
    gains:
      {name}:
        ff_velocity_scale: {values["damping"]}  # N.m.s/rad: viscous friction; p, i and d depend on the load
# Dry friction of the joint is {values["frictionloss"]} N.m; this controller has no parameter for it.
"""


ROS2 = Form(ros2, "ROS 2", "macros of the joint for a URDF and `ros2_control`, and a node", "ros.md")
