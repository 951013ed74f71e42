"""Parameters of a joint for ros2_control, and a node that publishes the joint of a simulated drive."""

from __future__ import annotations

from importlib import resources
from pathlib import Path
from xml.sax.saxutils import quoteattr

from strainwave import Drive, Gear
from strainwave.export.elements import GearElements
from strainwave.export.exported import Exported, Form, stating_origins
from strainwave.export.joint_numbers import joint, remark_on_rotor
from strainwave.export.names import checked_name
from strainwave.files.gear_set import GearSet, gear_set_of


@stating_origins
def ros2(drive: GearSet | Drive | Gear | str | Path, *, max_torque: float | None = None, name: str = "joint") -> Exported:
    """Return parameters of a joint for ros2_control, and a node that simulates its drive.

    `joint_limits.yaml` has limits, and the viscous friction as feed-forward of a joint_trajectory_controller with effort
    interface. `joint.ros2_control.xml` has interfaces and transmission. `drive_node.py` publishes joint states of a drive that
    it simulates.

    Args:
        drive: a gear, a drive or a set of one, or the name or path of a file
        max_torque: largest torque at the output [N.m]; by default the peak torque of the ratings
        name: of the joint

    Returns:
        The texts of the files by their path, and the numbers in them with their units.

    Raises:
        ValueError: neither a torque nor a rating is given, or the name is none of ROS

    >>> import strainwave as sw
    >>> sorted(ros2("csg-20-100", name="elbow").files)
    ['drive_node.py', 'elbow.ros2_control.xml', 'elbow_limits.yaml']
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
    files = {
        f"{name}_limits.yaml": _limits(numbers, name),
        f"{name}.ros2_control.xml": _description(elements.ratio, name),
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
            "the YAML and the XML were parsed, not run in ros2_control",
            "max_velocity follows from the largest input speed of the ratings; without one it is assumed",
            "drive_node.py needs rclpy, sensor_msgs and std_msgs: of ROS 2, or pip install ros-rclpy ros-rmw-fastrtps-cpp "
            "ros-sensor-msgs ros-std-msgs",
            *remark_on_rotor(gear_set),
        ),
    )


def _limits(numbers: dict[str, tuple[float, str]], name: str) -> str:
    """Return limits of a joint, and gains of its controller, as parameters of ros2_control."""
    value = {key: repr(each) for key, (each, _) in numbers.items()}
    return f"""# Parameters of the joint {name} for ros2_control. Parsed as YAML; not run in ros2_control.
controller_manager:
  ros__parameters:
    joint_limits:
      {name}:
        has_velocity_limits: true
        max_velocity: {value["max_velocity"]}  # rad/s
        has_effort_limits: true
        max_effort: {value["max_effort"]}  # N.m
joint_trajectory_controller:
  ros__parameters:
    joints: [{name}]
    command_interfaces: [effort]
    state_interfaces: [position, velocity]
    gains:
      {name}:
        ff_velocity_scale: {value["damping"]}  # N.m.s/rad: viscous friction; p, i and d depend on the load
# Dry friction of the joint is {value["frictionloss"]} N.m; this controller has no parameter for it.
"""


def _description(ratio: float, name: str) -> str:
    """Return the element of a URDF that ros2_control reads."""
    return f"""<!-- For the robot of a URDF, with the plugin of its hardware. Parsed as XML; not run in ros2_control. -->
<ros2_control name={quoteattr(f"{name}_system")} type="system">
  <hardware>
    <plugin>mock_components/GenericSystem</plugin>
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
      <mechanical_reduction>{ratio!r}</mechanical_reduction>
    </joint>
  </transmission>
</ros2_control>
"""


ROS2 = Form(ros2, "ROS 2", "limits and friction for `ros2_control`, and a node", "ros.md")
