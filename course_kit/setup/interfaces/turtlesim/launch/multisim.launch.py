"""Two simulators at once, each in a namespace of its own: turtlesim1 and turtlesim2."""

from launch import LaunchDescription
from launch_ros.actions import Node


def generate_launch_description() -> LaunchDescription:
    """What is to be launched."""
    return LaunchDescription(
        [
            Node(package="turtlesim", executable="turtlesim_node", namespace=namespace, output="screen")
            for namespace in ("turtlesim1", "turtlesim2")
        ]
    )
