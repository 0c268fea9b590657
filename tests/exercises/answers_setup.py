"""Answers to chapter 1's exercises: one that is right, and wrong ones that students give."""

from __future__ import annotations

from tests.exercises.answers_topics import changed
from tests.exercises.chapter import Answers, Wrong

REPORT = """
stop()
domain = int(os.environ["ROS_DOMAIN_ID"])
discovery_range = "LOCALHOST"
"""

GREETER = """
stop()

class Greeter(Node):
    def __init__(self):
        super().__init__("greeter")
        self.get_logger().info("Nice to meet you, Ada")

greeter = run(Greeter)
"""

SILENT = """
import time; time.sleep(0.5)

class Greeter(Node):
    def __init__(self):
        super().__init__("greeter")

greeter = run(Greeter)
"""

CORNERS = """
import math
from geometry_msgs.msg import Twist
from turtlesim.msg import Pose

stop()

class Tour(Node):
    goals = [(10.0, 1.0), (10.0, 10.0), (1.0, 10.0), (1.0, 1.0)]

    def __init__(self):
        super().__init__("tour")
        self.left = list(self.goals)
        self.publisher = self.create_publisher(Twist, "turtle1/cmd_vel", 10)
        self.create_subscription(Pose, "turtle1/pose", self.steer, 1)

    def steer(self, pose):
        twist = Twist()
        if self.left:
            dx, dy = self.left[0][0] - pose.x, self.left[0][1] - pose.y
            turn = math.remainder(math.atan2(dy, dx) - pose.theta, math.tau)
            twist.linear.x, twist.angular.z = 8.0 * max(0.0, math.cos(turn)), 8.0 * turn
            if math.hypot(dx, dy) < 0.4:
                self.left.pop(0)
        self.publisher.publish(twist)

turtlesim = run(TurtleSim)
corners = record("/turtle1/pose")
tour = run(Tour)
wait_for(lambda: not tour.left, timeout=30)
wait_for(lambda: corners.messages[-1].linear_velocity == 0.0)
"""

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

TWO = """
stop()
turtlesim = run(TurtleSim)
second = run(TurtleSim, namespace="/robot2")
new_topics = {"/robot2/turtle1/cmd_vel", "/robot2/turtle1/pose", "/robot2/turtle1/color_sensor"}
with record("/robot2/turtle1/pose") as seen:
    panel = drive(namespace="/robot2")
    panel.press("up")
    wait_for(lambda: seen.messages and seen.messages[-1].x > 7.0)
panel.close()
"""

ANSWERS = [
    Answers(
        "setup-1",
        1,
        REPORT,
        [
            Wrong(
                "text",
                changed(REPORT, ('int(os.environ["ROS_DOMAIN_ID"])', 'os.environ["ROS_DOMAIN_ID"]')),
                0,
                "a number, without quotes",
            ),
            Wrong("zero", changed(REPORT, ('int(os.environ["ROS_DOMAIN_ID"])', "0")), 0, "You gave 0."),
            Wrong("subnet", changed(REPORT, ('"LOCALHOST"', '"SUBNET"')), 0, "You gave 'SUBNET'"),
            Wrong("half", changed(REPORT, ('"LOCALHOST"', "None")), 0, "one word in capitals"),
        ],
    ),
    Answers(
        "setup-2",
        2,
        GREETER,
        [
            Wrong("print", changed(GREETER, ("self.get_logger().info(", "print(")), 1, "print() goes to nobody else"),
            Wrong("no_name", changed(GREETER, ("you, Ada", "you, <your name>")), 1, "Nice to meet you, <your name>"),
            Wrong("level", changed(GREETER, ("info(", "warning(")), 1, "the level is not INFO"),
            Wrong("node_name", changed(GREETER, ('__init__("greeter")', '__init__("hello")')), 0, "Running: /hello"),
            Wrong("not_run", changed(GREETER, ("greeter = run(Greeter)\n", "")), 0, "Start it with `run(Greeter"),
            Wrong("text", changed(GREETER, ("Nice to meet you, Ada", "Hello, Ada")), 1, "It logged 'Hello, Ada'"),
            Wrong("right_before", GREETER + SILENT, 1, "It logged nothing"),
        ],
    ),
    Answers(
        "setup-3",
        3,
        CORNERS,
        [
            Wrong("two_corners", changed(CORNERS, (", (1.0, 10.0), (1.0, 1.0)]", "]")), 1, "2 m is near"),
            Wrong("three_corners", changed(CORNERS, (", (1.0, 1.0)]", "]")), 2, "m of the left one"),
            Wrong("teleport", TELEPORT, 2, "do not teleport"),
            Wrong("not_driven", "stop()\nturtlesim = run(TurtleSim)\n", 0, "It saw no movement"),
        ],
    ),
    Answers(
        "setup-4",
        4,
        TWO,
        [
            Wrong(
                "relative_names",
                changed(
                    TWO,
                    (
                        '"/robot2/turtle1/cmd_vel", "/robot2/turtle1/pose", "/robot2/turtle1/color_sensor"',
                        '"turtle1/cmd_vel", "turtle1/pose", "turtle1/color_sensor"',
                    ),
                ),
                2,
                "with full names",
            ),
            Wrong(
                "first_driven",
                changed(
                    TWO,
                    ('drive(namespace="/robot2")', "drive()"),
                    ('record("/robot2/turtle1/pose")', 'record("/turtle1/pose")'),
                ),
                3,
                "The second drove 0.0 m",
            ),
            Wrong(
                "no_second",
                'stop()\nturtlesim = run(TurtleSim)\nnew_topics = {"/robot2/turtle1/pose"}\n',
                0,
                "Start it with `run(TurtleSim",
            ),
            Wrong(
                "not_driven",
                changed(TWO, ('    panel.press("up")\n', ""), ("> 7.0", "> 5.0")),
                3,
                "The second drove 0.0 m",
            ),
        ],
    ),
]
