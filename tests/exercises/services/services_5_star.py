"""Answers to services-5: right ones in several styles, and wrong ones that students give."""

from __future__ import annotations

from tests.exercises.chapter import Answers, Wrong, changed, worked

STAR = worked("services-5")

# No look at the pose but a pause for each line, from another corner on, with a client for each call.
PAUSES = """
import math, time
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from std_srvs.srv import Trigger
from turtlesim.srv import SetPen, TeleportAbsolute, TeleportRelative

class StarPainter(Node):
    def __init__(self):
        Node.__init__(self, "star_painter")
        self.group = ReentrantCallbackGroup()
        self.create_service(Trigger, "/draw_star", self.draw)

    def call(self, kind, name, **fields):
        client = self.create_client(kind, f"/turtle1/{name}", callback_group=self.group)
        try:
            if not client.wait_for_service(timeout_sec=1.0):
                return False
            return client.call(kind.Request(**fields), timeout_sec=5.0) is not None
        finally:
            self.destroy_client(client)

    def draw(self, request, response):
        if not self.call(SetPen, "set_pen", off=1):
            return Trigger.Response(success=False, message="where is it?")
        corner = math.radians(90 - 72)
        x, y = 5.544 + 4 * math.cos(corner), 5.544 + 4 * math.sin(corner)
        self.call(TeleportAbsolute, "teleport_absolute", x=x, y=y, theta=math.pi)
        time.sleep(0.05)
        self.call(SetPen, "set_pen", r=255, g=255, b=0, width=4, off=0)
        for _ in range(5):
            turn = 0.0 if _ == 0 else math.radians(144)
            self.call(TeleportRelative, "teleport_relative", linear=8 * math.sin(math.radians(72)), angular=turn)
            time.sleep(0.05)
        return Trigger.Response(success=True, message="5 lines")

painter = run(StarPainter, executor=MultiThreadedExecutor(num_threads=2))
"""

DRIVING = """
import math
from geometry_msgs.msg import Twist
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.task import Future
from std_srvs.srv import Trigger
from turtlesim.msg import Pose
from turtlesim.srv import SetPen

class StarPainter(Node):
    def __init__(self):
        super().__init__("star_painter")
        self.group = ReentrantCallbackGroup()
        self.pen = self.create_client(SetPen, "turtle1/set_pen", callback_group=self.group)
        self.drive = self.create_publisher(Twist, "turtle1/cmd_vel", 1)
        self.create_subscription(Pose, "turtle1/pose", self.on_pose, 1, callback_group=self.group)
        self.create_service(Trigger, "draw_star", self.draw, callback_group=self.group)
        self.next_pose = Future()
        self.pose = None

    def on_pose(self, pose):
        self.pose = pose
        arrived, self.next_pose = self.next_pose, Future()
        arrived.set_result(pose)

    def say(self, linear=0.0, angular=0.0):
        twist = Twist()
        twist.linear.x, twist.angular.z = linear, angular
        self.drive.publish(twist)

    async def go(self, x, y):
        while True:
            pose = await self.next_pose
            left = math.dist((x, y), (pose.x, pose.y))
            if left < 0.03:
                self.say()
                return
            wrong = math.remainder(math.atan2(y - pose.y, x - pose.x) - pose.theta, math.tau)
            self.say(min(6.0, 6 * left) if abs(wrong) < 0.01 or left < 0.3 and abs(wrong) < 0.3 else 0.0, 12 * wrong)

    async def draw(self, request, response):
        if not self.pen.wait_for_service(timeout_sec=1.0):
            return response
        angles = [math.pi / 2 - 2 * number * math.tau / 5 for number in range(6)]
        corners = [(5.54 + 4 * math.cos(a), 5.54 + 4 * math.sin(a)) for a in angles]
        await self.pen.call_async(SetPen.Request(off=1))
        await self.go(*corners[0])
        for number in range(3):
            await self.next_pose
        await self.pen.call_async(SetPen.Request(r=255, g=255, b=0, width=4))
        for corner in corners[1:]:
            await self.go(*corner)
        for number in range(3):
            await self.next_pose
        response.success, response.message = True, "5 lines"
        return response
"""

# It never waits for a tick but where it must, and all lines happen in one.
ONE_TICK = changed(
    STAR,
    ("await self.go(*corner)", "await self.jump.call_async(TeleportAbsolute.Request(x=corner[0], y=corner[1]))"),
    (
        "        response.success, response.message = True",
        "        await self.go(*corner)\n        response.success, response.message = True",
    ),
)
BY_STROKES = changed(
    STAR,
    (
        "for corner in corners[1:]:\n            await self.go(*corner)",
        "for number in (0, 2, 4, 1, 3):\n"
        "            await self.pen.call_async(SetPen.Request(off=1))\n"
        "            await self.go(*corners[number])\n"
        "            await self.pen.call_async(SetPen.Request(r=255, g=255, b=0, width=4))\n"
        "            await self.go(*corners[number + 1])",
    ),
)
CHECKED_ONCE = changed(
    STAR,
    (
        "if not self.jump.wait_for_service(timeout_sec=1.0):",
        "self.found = getattr(self, 'found', False) or "
        "self.jump.wait_for_service(timeout_sec=1.0)\n        if not self.found:",
    ),
)

ANSWERS = Answers(
    "services-5",
    5,
    STAR,
    [
        Wrong(
            "no_tick",
            changed(STAR, ("        self.waiting.append((x, y, future))\n        await future\n", "")),
            3,
            "A teleport happens at the next tick",
        ),
        Wrong("pentagon", changed(STAR, ("math.pi / 2 + 2 * number", "math.pi / 2 + number")), 2, "of the 5 lines"),
        Wrong("width", changed(STAR, ("width=4", "width=2")), 4, "`width=4`"),
        Wrong(
            "colour",
            changed(STAR, ("r=255, g=255, b=0", "r=255, g=165, b=0")),
            4,
            "0 of the 5 lines are there in yellow",
        ),
        Wrong(
            "no_turtle_hangs",
            changed(STAR, ("self.jump.wait_for_service(timeout_sec=1.0)", "True")),
            4,
            "No response came",
        ),
        Wrong("message", changed(STAR, ("5 lines", "done")), 4, "It said success=True, 'done'"),
        Wrong("looked_for_once", CHECKED_ONCE, 4, "after turtle1 was killed"),
        Wrong(
            "says_yes_without_a_turtle",
            changed(STAR, ('response.message = "no turtle"', "response.success = True")),
            4,
            "It said success=True after",
        ),
        Wrong(
            "late_without_a_turtle",
            changed(STAR, ("timeout_sec=1.0", "timeout_sec=4.0")),
            4,
            "No response came after",
        ),
        Wrong(
            "not_lifted",
            changed(STAR, ("        await self.pen.call_async(SetPen.Request(off=1))\n", "")),
            4,
            "lift the pen",
        ),
        Wrong("width_5", changed(STAR, ("width=4", "width=5")), 4, "`width=4`"),
        Wrong(
            "too_early",
            changed(
                STAR,
                ("for corner in corners[1:]:", "for corner in corners[1:-1]:"),
                (
                    "        response.success, response.message = True",
                    "        last = TeleportAbsolute.Request(x=corners[-1][0], y=corners[-1][1])\n"
                    "        await self.jump.call_async(last)\n"
                    "        response.success, response.message = True",
                ),
            ),
            4,
            "wait for its pose, then respond",
        ),
        Wrong("strokes", BY_STROKES, 4, "the pen stays down"),
        Wrong(
            "once",
            changed(
                STAR,
                (
                    "        angles =",
                    "        if hasattr(self, 'done'):\n"
                    "            response.success, response.message = True, '5 lines'\n"
                    "            return response\n"
                    "        self.done = True\n"
                    "        angles =",
                ),
            ),
            1,
            "In call 2",
        ),
        Wrong(
            "pen_once",
            changed(
                STAR,
                (
                    "        await self.pen.call_async(SetPen.Request(r=255, g=255, b=0, width=4))",
                    "        pen = SetPen.Request(off=0) if hasattr(self, 'pen_is_set') else "
                    "SetPen.Request(r=255, g=255, b=0, width=4)\n"
                    "        self.pen_is_set = True\n"
                    "        await self.pen.call_async(pen)",
                ),
            ),
            3,
            "In call 2",
        ),
        Wrong(
            "upside_down",
            changed(STAR, ("5.54 + 4 * math.sin(a)", "5.54 - 4 * math.sin(a)")),
            2,
            "corners 4 m from",
        ),
        Wrong("too_small", changed(STAR, ("4 * math", "3.5 * math")), 3, "corners 4 m from"),
        Wrong(
            "four_lines",
            changed(STAR, ("corners[1:]", "corners[1:5]")),
            4,
            "4 of the 5 lines are there in yellow",
        ),
        Wrong("six_lines", changed(STAR, ("range(6)", "range(7)")), 4, "7.6 m of it twice"),
        Wrong(
            "goes_home",
            changed(
                STAR,
                (
                    "        response.success, response.message = True",
                    "        await self.pen.call_async(SetPen.Request(off=1))\n"
                    "        await self.go(5.544, 5.544)\n"
                    "        response.success, response.message = True",
                ),
            ),
            4,
            "4.0 m from the end of the last line",
        ),
    ],
    {"pauses": PAUSES, "driving": DRIVING, "one_tick": ONE_TICK},
)
