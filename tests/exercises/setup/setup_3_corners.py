"""Answers to setup-3: right ones in several styles, and wrong ones that students give."""

from __future__ import annotations

from tests.exercises.chapter import Answers, Wrong, changed
from tests.exercises.setup.driving import STYLES, TOUR

TELEPORT = """
from turtlesim.srv import TeleportAbsolute

stop()
turtlesim = run(TurtleSim)
node = run(Node, "jumper")
jump = node.create_client(TeleportAbsolute, "turtle1/teleport_absolute")
jump.wait_for_service(timeout_sec=5.0)
corners = record("/turtle1/pose")
wait_for(lambda: len(corners) > 60)
for x, y in [(1.0, 1.0), (10.0, 1.0), (10.0, 10.0), (1.0, 10.0)]:
    wait_for(jump.call_async(TeleportAbsolute.Request(x=x, y=y)))
    wait_for(lambda: abs(corners.messages[-1].x - x) + abs(corners.messages[-1].y - y) < 0.1)
"""

# Two corners driven to, the other two not.
HALF_TELEPORT = (
    changed(
        TOUR,
        (", (1.0, 10.0), (1.0, 1.0)]", "]"),
        ("wait_for(lambda: corners.messages[-1].linear_velocity == 0.0)\n", ""),
    )
    + """
from turtlesim.srv import TeleportAbsolute

jump = tour.create_client(TeleportAbsolute, "turtle1/teleport_absolute")
for x, y in [(1.0, 10.0), (1.0, 1.0)]:
    wait_for(jump.call_async(TeleportAbsolute.Request(x=x, y=y)))
    wait_for(lambda: abs(corners.messages[-1].x - x) + abs(corners.messages[-1].y - y) < 0.5)
"""
)

# In steps of 0.3 m, at rest.
SMALL_TELEPORTS = """
import time
from turtlesim.srv import TeleportAbsolute

stop()
turtlesim = run(TurtleSim)
node = run(Node, "jumper")
jump = node.create_client(TeleportAbsolute, "turtle1/teleport_absolute")
jump.wait_for_service(timeout_sec=5.0)
x = y = 5.5
for to_x, to_y in [(1.0, 1.0), (10.0, 1.0), (10.0, 10.0), (1.0, 10.0)]:
    count = int(np.hypot(to_x - x, to_y - y) / 0.3) + 1
    for part in np.linspace(0.0, 1.0, count + 1)[1:]:
        request = TeleportAbsolute.Request(x=float(x + part * (to_x - x)), y=float(y + part * (to_y - y)))
        wait_for(jump.call_async(request))
        time.sleep(0.04)
    x, y = to_x, to_y
"""

# The same, while it drives at 1 m/s against the wall.
TELEPORTS_BESIDE_DRIVING = changed(
    SMALL_TELEPORTS,
    (
        "x = y = 5.5\n",
        """x = y = 5.5
from geometry_msgs.msg import Twist
publisher = node.create_publisher(Twist, "turtle1/cmd_vel", 10)
twist = Twist()
twist.linear.x = 1.0
node.create_timer(0.1, lambda: publisher.publish(twist))
time.sleep(3)
""",
    ),
)

# The node of the simulator's name, with all that one has, and no turtle.
FALSE = """
import math
from geometry_msgs.msg import Twist
from rclpy.action import ActionServer
from turtlesim.action import RotateAbsolute
from turtlesim.msg import Color, Pose
from turtlesim.srv import SetPen, TeleportAbsolute, TeleportRelative

stop()

class Pretender(Node):
    goals = [(5.5, 5.5), (1.0, 1.0), (10.0, 1.0), (10.0, 10.0), (1.0, 10.0)]

    def __init__(self):
        super().__init__("turtlesim")
        self.poses = self.create_publisher(Pose, "turtle1/pose", 7)
        self.path, self.heading = [], 0.0
        for (x, y), (to_x, to_y) in zip(self.goals, self.goals[1:]):
            count = int(math.hypot(to_x - x, to_y - y) / 0.08)
            self.path += [(x + (to_x - x) * n / count, y + (to_y - y) * n / count) for n in range(count)]
        self.create_timer(0.016, self.tick)
        self.have_the_rest()

    def have_the_rest(self):
        self.create_publisher(Color, "turtle1/color_sensor", 7)
        self.create_subscription(Twist, "turtle1/cmd_vel", lambda _: None, 7)
        kinds = {"set_pen": SetPen, "teleport_absolute": TeleportAbsolute, "teleport_relative": TeleportRelative}
        for name, kind in kinds.items():
            self.create_service(kind, f"turtle1/{name}", lambda request, response: response)
        ActionServer(self, RotateAbsolute, "turtle1/rotate_absolute", lambda goal: RotateAbsolute.Result())

    def tick(self):
        pose = Pose(linear_velocity=5.0)
        if len(self.path) > 1:
            pose.x, pose.y = self.path.pop(0)
        self.poses.publish(pose)

false = run(Pretender)
wait_for(lambda: len(false.path) == 1, timeout=60)
"""

FALSE_BESIDE_A_TURTLE = changed(
    FALSE, ('super().__init__("turtlesim")', 'super().__init__("poet")'), ("        self.have_the_rest()\n", "")
).replace("stop()\n", "stop()\nturtlesim = run(TurtleSim)\n", 1)

TWINS = """
from course_kit import start
start("ros2 run turtlesim turtlesim_node")
wait_for(lambda: tour.count_publishers("/turtle1/pose") == 2, timeout=20)
"""

IN_THE_WORLD = """
import time
stop()
turtlesim = run(TurtleSim)
turtle = turtlesim.world.turtles["turtle1"]
for forward, sideways in [(6, -6), (-12, 0), (0, 12), (12, 0)]:
    for _ in range(10):
        turtlesim.world.command("turtle1", float(forward), float(sideways), 0.0, time.monotonic_ns())
        time.sleep(0.11)
"""

ANSWERS = Answers(
    "setup-3",
    3,
    TOUR,
    [
        Wrong("two_corners", changed(TOUR, (", (1.0, 10.0), (1.0, 1.0)]", "]")), 1, "2 m is near"),
        Wrong("three_corners", changed(TOUR, (", (1.0, 1.0)]", "]")), 2, "m of the left one"),
        Wrong("too_far", changed(TOUR, ("(1.0, 10.0)", "(1.8, 9.3)")), 2, "came within 2."),
        Wrong("teleport", TELEPORT, 0, "do not teleport"),
        Wrong("half_teleport", HALF_TELEPORT, 2, "do not teleport"),
        Wrong("small_teleports", SMALL_TELEPORTS, 0, "do not teleport"),
        Wrong("teleports_beside_driving", TELEPORTS_BESIDE_DRIVING, 2, "do not teleport"),
        Wrong("not_driven", "stop()\nturtlesim = run(TurtleSim)\n", 0, "It saw no movement"),
        Wrong(
            "a_little",
            changed(
                TOUR,
                ("[(10.0, 1.0), (10.0, 10.0), (1.0, 10.0), (1.0, 1.0)]", "[(6.5, 5.5)]"),
                ("= 8.0 * max", "= 0.5 * max"),
            ),
            0,
            "m of movement",
        ),
        Wrong("run_again", TOUR + "\ntour = stop(tour)\nturtlesim = run(TurtleSim)\n", 0, "It saw no movement"),
        Wrong("false_poses", FALSE, 0, "no command on `/turtle1/cmd_vel`"),
        Wrong(
            "false_and_bare",
            changed(FALSE, ("        self.have_the_rest()\n", "")),
            0,
            "It has no /turtle1/color_sensor",
        ),
        Wrong("false_beside_a_turtle", FALSE_BESIDE_A_TURTLE, 0, "It saw no movement"),
        Wrong(
            "two_of_that_name",
            TOUR + TWINS,
            0,
            "2 of that name",
        ),
        Wrong("in_the_world", IN_THE_WORLD, 0, "no command on `/turtle1/cmd_vel`"),
    ],
    STYLES,
)
