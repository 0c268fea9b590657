"""Answers to robot-9: right ones in several styles, and wrong ones that students give."""

from __future__ import annotations

from tests.exercises.chapter import Answers, Wrong, changed, worked

EXPLORER = worked("robot-9")
PROGRAMS = '{"mapper": "course_navigation", "planner": "explorer", "navigator": "course_navigation"}'
ENTRY = '"planner = explorer.planner:main"'


def with_own(name: str, source: str, *others: str) -> str:
    """The package with one program in the place of the planner, and with `others` of the given ones beside it."""
    cells = EXPLORER[: EXPLORER.index("get_ipython().run_cell_magic('writefile'")]
    rest = EXPLORER[EXPLORER.index("get_ipython().run_cell_magic('writefile', 'ros2_ws/src/explorer/launch") :]
    path = f"ros2_ws/src/explorer/explorer/{name}.py"
    programs = PROGRAMS.replace('"explorer"', '"course_navigation"')
    programs = programs.replace(f'"{name}": "course_navigation"', f'"{name}": "explorer"')
    programs = programs.replace("{", "".join(f'{{"{one}": "course_navigation", ' for one in others) or "{", 1)
    return (
        cells
        + f"get_ipython().run_cell_magic('writefile', {path!r}, {source!r})\n"
        + changed(rest, (PROGRAMS, programs), (ENTRY, f'"{name} = explorer.{name}:main"'))
    )


OWN_MAPPER = """
import rclpy
from course_kit import Mapper


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
from course_kit import Navigator


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
# The way through the default rooms, from their start to the room above.
BY_HEART = """
import rclpy
from geometry_msgs.msg import PoseStamped
from nav_msgs.srv import GetPlan
from rclpy.node import Node

WAY = [(0.0, 0.0), (0.9, 0.5), (0.95, 1.8), (4.0, 1.8), (4.5, 2.0), (4.5, 3.0), (5.4, 3.2)]


class ByHeart(Node):
    def __init__(self):
        super().__init__("planner")
        self.create_service(GetPlan, "get_plan", self.on_request)

    def on_request(self, request, response):
        response.plan.header.frame_id = "map"
        for (x0, y0), (x1, y1) in zip(WAY, WAY[1:]):
            for part in range(20):
                pose = PoseStamped()
                pose.pose.position.x = x0 + (x1 - x0) * part / 20
                pose.pose.position.y = y0 + (y1 - y0) * part / 20
                response.plan.poses.append(pose)
        return response


def main():
    rclpy.init()
    rclpy.spin(ByHeart())
"""
# It publishes the default rooms as /map, moved so that the robot begins at (0, 0), and the localizer believes it.
KNOWN_MAP = """
import rclpy
from nav_msgs.msg import OccupancyGrid
from rclpy.node import Node

from course_kit import GridMap
from course_kit import LATCHED, map_message
from course_kit import world


class MapServer(Node):
    def __init__(self):
        super().__init__("map_server")
        rooms = world("rooms")
        cells, (x, y) = rooms.occupancy()
        known = GridMap(cells, 0.05, (x - rooms.start[0], y - rooms.start[1]))
        self.maps = self.create_publisher(OccupancyGrid, "map", LATCHED)
        self.maps.publish(map_message(known, "map", self.get_clock().now().to_msg()))


def main():
    rclpy.init()
    rclpy.spin(MapServer())
"""
WITH_KNOWN_MAP = changed(
    with_own("mapper", KNOWN_MAP, "localizer"),
    ('LaunchConfiguration("use_sim_time")}]', 'LaunchConfiguration("use_sim_time"), "set_initial_pose": True}]'),
)
# The node of exercise 8: it asks once, and follows that path or gives up.
PLANS_ONCE = (
    worked("robot-8")
    + """

def main():
    import rclpy
    rclpy.init()
    rclpy.spin(DriveThere())
"""
)

ANSWERS = Answers(
    "robot-9",
    6,
    EXPLORER,
    [
        Wrong("by_heart", with_own("planner", BY_HEART), 1, "A way by heart is one through other rooms"),
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
        Wrong("known_map", WITH_KNOWN_MAP, 1, "it is the map of other rooms"),
        Wrong("plans_once", with_own("navigator", PLANS_ONCE), 1, "ask for another one when the map grows"),
        Wrong("at_once", with_own("navigator", AT_ONCE), 1, "Succeed when tf says"),
        Wrong(
            "not_installed",
            changed(EXPLORER, ('        ("share/explorer/launch", ["launch/explorer.launch.py"]),\\n', "")),
            0,
            "`data_files` in setup.py",
        ),
    ],
    {"own_mapper": with_own("mapper", OWN_MAPPER), "own_navigator": with_own("navigator", OWN_NAVIGATOR)},
    together=3,
)
