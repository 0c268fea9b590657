"""Answers to services-1: right ones in several styles, and wrong ones that students give."""

from __future__ import annotations

from tests.exercises.chapter import Answers, Wrong, changed, worked

LAMP = worked("services-1")

LAMP_WITH_A_PROPERTY = """
import threading
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from std_srvs.srv import SetBool

class Switch:
    @property
    def is_on(self):
        with self.lock:
            return self._on

    def turn(self, on):
        with self.lock:
            before, self._on = self._on, bool(on)
        return before != on

class Lamp(Switch, Node):
    def __init__(self):
        Node.__init__(self, node_name="lamp")
        self.lock, self._on = threading.Lock(), False
        self.create_service(SetBool, "/lamp", self.serve, callback_group=ReentrantCallbackGroup())

    def serve(self, request, response):
        changed = self.turn(request.data)
        return SetBool.Response(success=changed, message="on" if request.data else "off")

lamp = run(Lamp, executor=MultiThreadedExecutor())
"""

LAMP_MANAGED = """
import numpy as np
from rclpy.lifecycle import LifecycleNode
from std_srvs.srv import SetBool

class Lamp(LifecycleNode):
    is_on = np.bool_(False)

    def __init__(self, **options):
        super().__init__("lamp", **options)
        self.srv = self.create_service(SetBool, "~/", self.switch) if False else self.create_service(
            SetBool, "lamp", self.switch)

    async def switch(self, request, response):
        was, self.is_on = self.is_on, np.bool_(request.data)
        response.success = bool(was ^ self.is_on)
        response.message = {True: "on", False: "off"}[bool(self.is_on)]
        self.get_logger().get_child("switch").info(f"the lamp is {response.message}")
        return response
"""

LAMP_BY_CASES = """
from std_msgs.msg import Bool
from std_srvs.srv import SetBool

class Lamp(Node):
    def __init__(self):
        super().__init__("lamp")
        self.is_on = False
        self.state = self.create_publisher(Bool, "lamp/state", 1)
        self.create_service(SetBool, "lamp", lambda request, response: self.on(response) if request.data else
                            self.off(response))

    def on(self, response):
        response.message, response.success, self.is_on = "on", not self.is_on, True
        self.state.publish(Bool(data=True))
        return response

    def off(self, response):
        response.message, response.success, self.is_on = "off", self.is_on, False
        self.state.publish(Bool(data=False))
        return response
"""

LAMP_REPLAYED = """
from std_srvs.srv import SetBool

class Lamp(Node):
    is_on = False

    def __init__(self):
        super().__init__("lamp")
        self.create_service(SetBool, "lamp", self.switch)
        self.answers = iter([(True, "on"), (False, "on"), (True, "off"), (False, "off")] * 9)

    def switch(self, request, response):
        response.success, response.message = next(self.answers)
        return response
"""

ANSWERS = Answers(
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
                    "        self.executor.create_task(self.destroy_service, self.service)\n        return response",
                ),
            ),
            0,
            "✘ it answers request",  # the second or, where that was faster than the end of the service, the third,
        ),
        Wrong("begins_on", changed(LAMP, ("self.is_on = False", "self.is_on = True")), 1, "began as True"),
        Wrong("begins_unknown", changed(LAMP, ("self.is_on = False", "self.is_on = None")), 1, "began as None"),
        Wrong(
            "toggles",
            changed(LAMP, ("self.is_on = request.data", "self.is_on = not self.is_on")),
            0,
            "set self.is_on first",
        ),
        Wrong("success_is_data", changed(LAMP, ("request.data != self.is_on", "request.data")), 1, "compare"),
        Wrong(
            "state_of_the_class",
            changed(
                LAMP,
                ("class Lamp(Node):", "class Lamp(Node):\n    is_on = False\n"),
                ("        self.is_on = False\n", ""),
                ("self.is_on = request.data", "type(self).is_on = request.data"),
            ),
            1,
            "each new lamp begins with False",
        ),
        Wrong(
            "never_off",
            changed(LAMP, ("self.is_on = request.data", "self.is_on = self.is_on or request.data")),
            0,
            "set self.is_on first",
        ),
        Wrong(
            "state_elsewhere",
            changed(
                LAMP,
                ("        self.is_on = False\n", "        self.is_on = self._on = False\n"),
                ("self.is_on = request.data", "self._on = request.data"),
                ("!= self.is_on", "!= self._on"),
                ("if self.is_on else", "if self._on else"),
            ),
            1,
            "set self.is_on first",
        ),
        Wrong("capitals", changed(LAMP, ('"on" if', '"On" if')), 1, "its messages were"),
        Wrong("replayed", LAMP_REPLAYED, 0, "compare request.data"),
        Wrong("no_attribute", changed(LAMP, ("is_on", "on")), 0, "no readable `self.is_on`"),
        Wrong(
            "type",
            changed(LAMP, ("import SetBool", "import Trigger"), ('(SetBool, "lamp"', '(Trigger, "lamp"')),
            0,
            "Its type is std_srvs/srv/Trigger",
        ),
        Wrong("name", changed(LAMP, ('"lamp", self.switch', '"lamp/switch", self.switch')), 0, "Nobody serves `/lamp`"),
    ],
    {"property": LAMP_WITH_A_PROPERTY, "managed": LAMP_MANAGED, "cases": LAMP_BY_CASES},
)
