"""Answers to robot-9: right ones with other nodes of one's own, and wrong ones that students give."""

from __future__ import annotations

from tests.exercises.chapter import Answers, Wrong, changed, worked

EXPLORER = worked("robot-9")
PROGRAMS = '{"mapper": "course_navigation", "planner": "explorer", "navigator": "course_navigation"}'
ENTRY = '"planner = explorer.planner:main"'


def with_own(name: str, source: str) -> str:
    """The package with one program in the place of the planner: a given node by a line of one's own."""
    cells = EXPLORER[: EXPLORER.index("get_ipython().run_cell_magic('writefile'")]
    rest = EXPLORER[EXPLORER.index("get_ipython().run_cell_magic('writefile', 'ros2_ws/src/explorer/launch") :]
    path = f"ros2_ws/src/explorer/explorer/{name}.py"
    programs = PROGRAMS.replace('"explorer"', '"course_navigation"')
    programs = programs.replace(f'"{name}": "course_navigation"', f'"{name}": "explorer"')
    return (
        cells
        + f"get_ipython().run_cell_magic('writefile', {path!r}, {source!r})\n"
        + changed(rest, (PROGRAMS, programs), (ENTRY, f'"{name} = explorer.{name}:main"'))
    )


OWN_MAPPER = """
import rclpy
from course_kit.navigation import Mapper


class FineMapper(Mapper):
    def publish(self):
        if self.slam is not None and self.count_subscribers("map"):
            super().publish()


def main():
    rclpy.init()
    try:
        rclpy.spin(FineMapper())
    except KeyboardInterrupt:
        pass
"""
OWN_NAVIGATOR = """
import sys
import rclpy
from course_kit.navigation import Navigator


def main():
    rclpy.init(args=sys.argv)
    node = Navigator()
    node.get_logger().info("mine")
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, rclpy.executors.ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()
"""
AT_ONCE = """
import rclpy
from geometry_msgs.msg import TwistStamped
from nav2_msgs.action import NavigateToPose
from rclpy.action import ActionServer
from rclpy.node import Node


class Optimist(Node):
    def __init__(self):
        super().__init__("navigator")
        self.commands = self.create_publisher(TwistStamped, "cmd_vel", 10)
        self.server = ActionServer(self, NavigateToPose, "navigate_to_pose", self.execute)

    def execute(self, handle):
        handle.succeed()
        return NavigateToPose.Result()


def main():
    rclpy.init()
    rclpy.spin(Optimist())
"""

ANSWERS = Answers(
    "robot-9",
    6,
    EXPLORER,
    [
        Wrong(
            "given_alone",
            changed(EXPLORER, ('"planner": "explorer"', '"planner": "course_navigation"')),
            5,
            "are the given programs",
        ),
        Wrong(
            "pose_by_heart",
            changed(
                EXPLORER,
                (
                    'LaunchConfiguration("use_sim_time")}]',
                    'LaunchConfiguration("use_sim_time"), "initial_pose": [1.2, 1.2, 0.0]}]',
                ),
            ),
            1,
            "no `initial_pose`",
        ),
        Wrong(
            "machine_time",
            changed(EXPLORER, ("executable=name, parameters=parameters", "executable=name")),
            1,
            "hand `use_sim_time` on",
        ),
        Wrong("at_once", with_own("navigator", AT_ONCE), 1, "Succeed when tf says"),
        Wrong(
            "not_installed",
            changed(EXPLORER, ('        ("share/explorer/launch", ["launch/explorer.launch.py"]),\\n', "")),
            0,
            "`data_files` in setup.py",
        ),
    ],
    {"own_mapper": with_own("mapper", OWN_MAPPER), "own_navigator": with_own("navigator", OWN_NAVIGATOR)},
)
