#!/usr/bin/env python3
"""map_server: puts scans into a map, twice a second, hands it out over /get_map, and says once how fast to drive."""

import time

import rclpy
from nav_msgs.msg import OccupancyGrid
from nav_msgs.srv import GetMap
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rclpy.qos_overriding_options import QoSOverridingOptions
from sensor_msgs.msg import LaserScan
from std_msgs.msg import Float32, Int32

CELLS = 22  # both ways


class MapServer(Node):
    """Puts scans into a map, and gives it to who asks."""

    def __init__(self):
        super().__init__("map_server")
        self.declare_parameter("update_time", 0.4)  # seconds of work for each update of the map
        self.waiting = 0
        self.in_map = 0
        self.create_subscription(
            LaserScan,
            "scan",
            self.on_scan,
            QoSProfile(depth=20, reliability=ReliabilityPolicy.BEST_EFFORT),
            qos_overriding_options=QoSOverridingOptions.with_default_policies(),
        )
        self.publisher = self.create_publisher(Int32, "map_scans", 10)
        self.create_service(GetMap, "get_map", self.on_get_map)
        self.create_timer(0.5, self.update)
        kept = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)  # for those who come later
        self.create_publisher(Float32, "speed_limit", kept).publish(Float32(data=1.0))
        self.get_logger().info("the map is open")

    def on_scan(self, scan):
        """Note a scan."""
        self.waiting += 1

    def update(self):
        """Put what has come into the map."""
        time.sleep(self.get_parameter("update_time").value)  # stands for the work; meanwhile scans queue up
        self.in_map += self.waiting
        self.waiting = 0
        self.publisher.publish(Int32(data=self.in_map))

    def on_get_map(self, request, response):
        """Answer with the map."""
        response.map = OccupancyGrid(data=[0] * CELLS**2)
        response.map.header.frame_id = "map"
        response.map.info.width = response.map.info.height = CELLS
        response.map.info.resolution = 0.5
        return response


def main():
    """Run the node until the program is ended."""
    rclpy.init()
    node = MapServer()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
