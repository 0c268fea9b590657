#!/usr/bin/env python3
"""scanner: the laser of the turtle. Measures from its pose to the walls, and publishes /scan."""

import math

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import LaserScan
from turtlesim.msg import Pose

WALLS = 11.09  # metres, both ways


class Scanner(Node):
    """Measures the walls around the turtle, as a laser scanner would."""

    def __init__(self):
        super().__init__("scanner")
        self.declare_parameter("rate", 10.0)  # Hz
        self.declare_parameter("beams", 36)
        self.pose = None
        self.create_subscription(Pose, "turtle1/pose", self.on_pose, 10)
        self.publisher = self.create_publisher(LaserScan, "scan", qos_profile_sensor_data)
        self.create_timer(1.0 / self.get_parameter("rate").value, self.measure)
        self.get_logger().info("the laser is on")

    def on_pose(self, pose):
        """Take over where the turtle is."""
        self.pose = pose

    def measure(self):
        """Publish a scan from there."""
        if self.pose is None:
            return
        beams = self.get_parameter("beams").value
        step = 2 * math.pi / max(beams, 1)
        scan = LaserScan(angle_min=-math.pi, angle_increment=step, range_max=2 * WALLS)
        scan.header.frame_id = "turtle1"
        scan.header.stamp = self.get_clock().now().to_msg()
        scan.ranges = [self.distance(-math.pi + beam * step) for beam in range(beams)]
        self.publisher.publish(scan)

    def distance(self, angle):
        """Metres from the turtle to the first wall in a direction, 0 is ahead."""
        x, y = math.cos(self.pose.theta + angle), math.sin(self.pose.theta + angle)
        to_side = (WALLS - self.pose.x) / x if x > 0 else -self.pose.x / x if x < 0 else math.inf
        to_end = (WALLS - self.pose.y) / y if y > 0 else -self.pose.y / y if y < 0 else math.inf
        return min(to_side, to_end)


def main():
    """Run the node until the program is ended."""
    rclpy.init()
    node = Scanner()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
