#!/usr/bin/env python3
"""planner: drives ahead while the laser sees room, else turns; stands still without scan, map and speed limit."""

import time

import rclpy
from geometry_msgs.msg import Twist, TwistStamped
from nav_msgs.srv import GetMap
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSPolicyKind, QoSProfile, qos_profile_sensor_data
from rclpy.qos_overriding_options import QoSOverridingOptions
from sensor_msgs.msg import LaserScan
from std_msgs.msg import Float32

ROOM = 1.5  # metres that must be free ahead
AHEAD = 0.7  # radians to both sides that count as ahead
SCAN_AGE, MAP_AGE = 1.0, 3.0  # seconds after which what came is too old to drive on


class Planner(Node):
    """Drives where the scan shows room, no faster than it was told."""

    def __init__(self):
        super().__init__("planner", enable_logger_service=True)
        self.declare_parameter("rate", 10.0)  # Hz of the commands
        self.declare_parameter("speed", 1.0)  # m/s
        self.declare_parameter("scan_topic", "scan")
        self.declare_parameter("planning_time", 0.0)  # seconds of work for each scan
        self.declare_parameter("stamped_cmd_vel", False)  # TwistStamped, as newer drivers want it, or Twist
        self.declare_parameter("synchronous", False)  # wait for the map with client.call()
        self.declare_parameter("own_loop", False)
        self.nearest = self.limit = None
        self.scan_came = self.map_came = self.asked = -1e9
        self.state = ""
        self.create_subscription(
            LaserScan,
            self.get_parameter("scan_topic").value,
            self.on_scan,
            qos_profile_sensor_data,
            qos_overriding_options=QoSOverridingOptions.with_default_policies(),
        )
        self.create_subscription(
            Float32,
            "speed_limit",
            self.on_limit,
            QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL),
            qos_overriding_options=QoSOverridingOptions([QoSPolicyKind.DURABILITY]),
        )
        self.client = self.create_client(GetMap, "get_map")
        self.stamped = self.get_parameter("stamped_cmd_vel").value
        self.publisher = self.create_publisher(TwistStamped if self.stamped else Twist, "cmd_vel", 10)
        if not self.get_parameter("own_loop").value:
            self.create_timer(1.0 / self.get_parameter("rate").value, self.step)
        self.get_logger().info("the planner is ready")

    def on_scan(self, scan):
        """Look ahead, and drive."""
        time.sleep(self.get_parameter("planning_time").value)  # stands for the work
        ahead = []
        for number, distance in enumerate(scan.ranges):
            angle = scan.angle_min + number * scan.angle_increment
            self.get_logger().debug(f"beam {number}: {distance:.2f} m at {angle:.2f} rad")
            if abs(angle) <= AHEAD:
                ahead.append(distance)
        self.nearest = min(ahead)
        self.scan_came = time.monotonic()

    def on_limit(self, limit):
        """Take over a new limit of the speed."""
        self.limit = limit.data

    def step(self):
        """One command."""
        now = time.monotonic()
        if now - self.asked > 1.0:
            self.ask_for_map(now)
        command = Twist()
        if now - self.map_came > MAP_AGE:
            self.tell("standing: no map from /get_map")
        elif now - self.scan_came > SCAN_AGE:
            self.tell("standing: no scan")
        elif self.limit is None:
            self.tell("standing: no speed limit from /speed_limit")
        else:
            self.tell("driving")
            is_free = self.nearest > ROOM
            speed = min(self.get_parameter("speed").value, self.limit)
            command.linear.x = speed if is_free else speed / 2
            command.angular.z = 0.0 if is_free else 2.0
        if self.stamped:
            command = TwistStamped(twist=command)
            command.header.stamp = self.get_clock().now().to_msg()
        self.publisher.publish(command)

    def ask_for_map(self, now):
        """Ask the map server, without waiting for the answer."""
        if not self.client.service_is_ready():
            return
        if self.asked < 0:
            self.get_logger().info("found /get_map")
        self.asked = now
        if self.get_parameter("synchronous").value:
            self.client.call(GetMap.Request())
            self.map_came = time.monotonic()
        else:
            self.client.call_async(GetMap.Request()).add_done_callback(self.on_map)

    def on_map(self, future):
        """Note that a map came."""
        self.map_came = time.monotonic()

    def tell(self, state):
        """Log the state if it is another one."""
        if state != self.state:
            self.get_logger().info(state)
        self.state = state


def main():
    """Run the node until the program is ended."""
    rclpy.init()
    node = Planner()
    try:
        if node.get_parameter("own_loop").value:
            while rclpy.ok():
                node.step()
                time.sleep(0.1)
        else:
            rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
