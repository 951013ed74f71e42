"""ROS 2 node: the joint of a simulated drive.

It takes the command of the drive from /JOINT/command (std_msgs/Float64) and publishes angle, speed and torque of the output on
/joint_states (sensor_msgs/JointState), in simulated time as fast as the clock.

    python3 drive_node.py --ros-args -p drive:=robot-joint -p joint:=elbow -p rate:=100.0
"""

from __future__ import annotations

from typing import Any

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64

import strainwave as sw

OUTPUTS = ("output_angle", "output_speed", "torque")
INTERNAL_STEP = 2e-4  # s, at most


class DriveNode(Node):  # type: ignore[misc] # rclpy has no types
    """The joint of a simulated drive."""

    def __init__(self) -> None:
        super().__init__("strainwave_drive")
        drive = self.declare_parameter("drive", "robot-joint").value  # a set by name, or a file
        self.joint = self.declare_parameter("joint", "joint").value
        self.period = 1.0 / self.declare_parameter("rate", 100.0).value  # s
        self.drive = sw.GearSet.read(drive).drive
        self.command, self.state = 0.0, self.drive.rest()
        self.publisher = self.create_publisher(JointState, "joint_states", 10)
        self.create_subscription(Float64, f"{self.joint}/command", self.take, 10)
        self.create_timer(self.period, self.advance)

    def take(self, message: Any) -> None:
        """Take a command, in the unit of the controller of the drive."""
        self.command = float(message.data)

    def advance(self) -> None:
        """Simulate a period and publish its end."""
        motion = sw.scenario.constant(self.command, self.period)
        step = self.period / max(1, round(self.period / INTERNAL_STEP))
        run = sw.simulate(self.drive, motion, step, sample=self.period, initial=self.state, record=list(OUTPUTS))
        self.state = run.end
        message = JointState()
        message.header.stamp = self.get_clock().now().to_msg()
        message.name = [self.joint]
        message.position, message.velocity, message.effort = ([float(run[name][-1])] for name in OUTPUTS)
        if rclpy.ok():  # else the node is being ended
            self.publisher.publish(message)


def main() -> None:
    """Run the node until it is interrupted."""
    rclpy.init()
    node = DriveNode()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
