"""Answers to chapter 4's exercises: one that is right, and wrong ones that students give."""

from __future__ import annotations

from tests.exercises.answers_topics import changed
from tests.exercises.chapter import Answers, Wrong

CELLS = ()  # of the chapter that are run: what they import is below
PREPARE = """
from example_interfaces.srv import AddTwoInts
from rclpy.node import Node

from course_kit import run, wait_for
"""

LAMP = """
from std_srvs.srv import SetBool, Trigger

class Lamp(Node):
    def __init__(self):
        super().__init__("lamp")
        self.is_on = False
        self.service = self.create_service(SetBool, "lamp", self.switch)

    def switch(self, request, response):
        response.success = request.data != self.is_on
        self.is_on = request.data
        response.message = "on" if self.is_on else "off"
        return response

lamp = run(Lamp)
"""

SAFE_CLIENT = """
import time

class SafeClient(Node):
    def __init__(self):
        super().__init__("safe_client")
        self.client = self.create_client(AddTwoInts, "add_two_ints")

    def add(self, a, b, timeout):
        end = time.monotonic() + timeout
        if not self.client.wait_for_service(timeout_sec=timeout):
            return None
        future = self.client.call_async(AddTwoInts.Request(a=a, b=b))
        try:
            return wait_for(future, timeout=end - time.monotonic()).sum
        except TimeoutError:
            self.client.remove_pending_request(future)
            return None
"""

ADD_THREE_TIMES = """
from rclpy.callback_groups import ReentrantCallbackGroup

class AddThreeTimes(Node):
    def __init__(self):
        super().__init__("add_three_times")
        self.client = self.create_client(AddTwoInts, "add_two_ints", callback_group=ReentrantCallbackGroup())
        self.service = self.create_service(AddTwoInts, "add_three_times", self.serve)

    async def ask(self, a, b):
        return (await self.client.call_async(AddTwoInts.Request(a=a, b=b))).sum

    async def serve(self, request, response):
        once = await self.ask(request.a, request.b)
        twice = await self.ask(once, once)
        response.sum = await self.ask(twice, once)
        return response
"""

PARALLEL = """
import time
from rclpy.callback_groups import ReentrantCallbackGroup

class ParallelServer(Node):
    def __init__(self):
        super().__init__("add_two_ints_server")
        group = ReentrantCallbackGroup()
        self.service = self.create_service(AddTwoInts, "add_two_ints", self.add, callback_group=group)

    def add(self, request, response):
        time.sleep(0.3)
        response.sum = request.a + request.b
        return response
"""

STAR = """
import math
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.task import Future
from std_srvs.srv import Trigger
from turtlesim.msg import Pose
from turtlesim.srv import SetPen, TeleportAbsolute

class StarPainter(Node):
    def __init__(self):
        super().__init__("star_painter")
        group = ReentrantCallbackGroup()
        self.pen = self.create_client(SetPen, "turtle1/set_pen", callback_group=group)
        self.jump = self.create_client(TeleportAbsolute, "turtle1/teleport_absolute", callback_group=group)
        self.create_subscription(Pose, "turtle1/pose", self.on_pose, 1, callback_group=group)
        self.create_service(Trigger, "draw_star", self.draw)
        self.waiting = []

    def on_pose(self, pose):
        for x, y, future in list(self.waiting):
            if math.dist((pose.x, pose.y), (x, y)) < 0.02:
                self.waiting.remove((x, y, future))
                future.set_result(None)

    async def go(self, x, y):
        await self.jump.call_async(TeleportAbsolute.Request(x=x, y=y))
        future = Future()
        self.waiting.append((x, y, future))
        await future

    async def draw(self, request, response):
        if not self.jump.wait_for_service(timeout_sec=1.0):
            response.message = "no turtle"
            return response
        angles = [math.pi / 2 + 2 * number * math.tau / 5 for number in range(6)]
        corners = [(5.54 + 4 * math.cos(a), 5.54 + 4 * math.sin(a)) for a in angles]
        await self.pen.call_async(SetPen.Request(off=1))
        await self.go(*corners[0])
        await self.pen.call_async(SetPen.Request(r=255, g=255, b=0, width=4))
        for corner in corners[1:]:
            await self.go(*corner)
        response.success, response.message = True, "5 lines"
        return response
"""

ANSWERS = [
    Answers(
        "services-1",
        2,
        LAMP,
        [
            Wrong("always_success", changed(LAMP, ("request.data != self.is_on", "True")), 1, "compare request.data"),
            Wrong("before", changed(LAMP, ("if self.is_on else", "if not self.is_on else")), 1, "set self.is_on first"),
            Wrong(
                "no_return",
                changed(LAMP, ("        return response\n", "")),
                0,
                "Does the callback return the response",
            ),
            Wrong(
                "one_request",
                changed(
                    LAMP,
                    (
                        "        return response",
                        "        self.executor.create_task(self.destroy_service, self.service)\n"
                        "        return response",
                    ),
                ),
                0,
                "✘ it answers request",  # the second or, where that was faster than the end of the service, the third,
            ),
            Wrong(
                "type", changed(LAMP, ('(SetBool, "lamp"', '(Trigger, "lamp"')), 0, "Its type is std_srvs/srv/Trigger"
            ),
            Wrong(
                "name", changed(LAMP, ('"lamp", self.switch', '"lamp/switch", self.switch')), 0, "Nobody serves `/lamp`"
            ),
        ],
    ),
    Answers(
        "services-2",
        2,
        SAFE_CLIENT,
        [
            Wrong("raises", changed(SAFE_CLIENT, ("except TimeoutError:", "except ValueError:")), 1, "TimeoutError"),
            Wrong("hangs", changed(SAFE_CLIENT, ("timeout_sec=timeout", "")), 0, "did not return within 4 s"),
            Wrong(
                "no_wait_for_service",
                changed(
                    SAFE_CLIENT,
                    ("if not self.client.wait_for_service(timeout_sec=timeout):", "if False:"),
                    ("            self.client.remove_pending_request(future)\n", ""),
                ),
                1,
                "futures still wait in the client",
            ),
            Wrong(
                "leaves_future",
                changed(SAFE_CLIENT, ("            self.client.remove_pending_request(future)\n", "")),
                1,
                "1 futures still wait",
            ),
            Wrong(
                "fixed_timeout",
                changed(SAFE_CLIENT, ("timeout_sec=timeout", "timeout_sec=2.0"), ("end - time.monotonic()", "2.0")),
                1,
                "`timeout` is for both waits together",
            ),
            Wrong(
                "zero",
                changed(
                    SAFE_CLIENT, ("            return None\n        future", "            return 0\n        future")
                ),
                1,
                "It returned 0 without a server",
            ),
            Wrong(
                "future",
                changed(SAFE_CLIENT, ("wait_for(future, timeout=end - time.monotonic()).sum", "future")),
                0,
                "is no plain value",
            ),
        ],
    ),
    Answers(
        "services-3",
        3,
        ADD_THREE_TIMES,
        [
            Wrong(
                "deadlock",
                changed(ADD_THREE_TIMES, ("await self.client.call_async(", "self.client.call(")),
                0,
                "client.call() inside a callback",
            ),
            Wrong(
                "same_group",
                changed(ADD_THREE_TIMES, (", callback_group=ReentrantCallbackGroup()", "")),
                0,
                "a callback group of its own",
            ),
            Wrong(
                "adds_itself",
                changed(ADD_THREE_TIMES, ("await self.ask(twice, once)", "twice + once")),
                1,
                "It asked 2 times",
            ),
            Wrong(
                "sums_three",
                changed(
                    ADD_THREE_TIMES,
                    ("await self.ask(once, once)", "once + await self.ask(request.a, request.b)"),
                    ("await self.ask(twice, once)", "twice + await self.ask(request.a, request.b)"),
                ),
                2,
                "let the server add the sums",
            ),
            Wrong(
                "future_as_sum",
                changed(
                    ADD_THREE_TIMES,
                    (
                        "(await self.client.call_async(AddTwoInts.Request(a=a, b=b))).sum",
                        "self.client.call_async(AddTwoInts.Request(a=a, b=b)).sum",
                    ),
                ),
                0,
                "AttributeError",
            ),
        ],
    ),
    Answers(
        "services-4",
        3,
        PARALLEL,
        [
            Wrong("one_group", changed(PARALLEL, (", callback_group=group", "")), 2, "MutuallyExclusiveCallbackGroup"),
            Wrong("no_work", changed(PARALLEL, ("        time.sleep(0.3)\n", "")), 2, "keeps the time.sleep(0.3)"),
            Wrong("wrong_sum", changed(PARALLEL, ("request.a + request.b", "request.a")), 2, "1 + 2 gave 1"),
            Wrong(
                "shared_state",
                changed(
                    PARALLEL,
                    (
                        "        time.sleep(0.3)\n        response.sum = request.a + request.b",
                        "        self.last = request.a + request.b\n        time.sleep(0.3)\n        response.sum = "
                        "self.last",
                    ),
                ),
                2,
                "0 + 10, 1 + 10, 2 + 10 gave",
            ),
            Wrong(
                "name",
                changed(PARALLEL, ('__init__("add_two_ints_server")', '__init__("parallel_server")')),
                0,
                "Your node is called /parallel_server",
            ),
        ],
    ),
    Answers(
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
                2,
                "0 of the 5 lines are there in yellow",
            ),
            Wrong(
                "no_turtle_hangs",
                changed(STAR, ("self.jump.wait_for_service(timeout_sec=1.0)", "True")),
                4,
                "No response came",
            ),
            Wrong("message", changed(STAR, ("5 lines", "done")), 4, "It said success=True, 'done'"),
        ],
    ),
]
