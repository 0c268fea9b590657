"""Answers to actions-1: right ones in several styles, and wrong ones that students give."""

from __future__ import annotations

from tests.exercises.chapter import Answers, Wrong, changed, worked

FACE_WEST = worked("actions-1")

FACE_WEST_STYLES = {
    "timer_and_late_attributes": """
from turtlesim.action import RotateAbsolute

class FaceWest(Node):
    def __init__(self):
        Node.__init__(self, "face_west")
        self.compass = ActionClient(self, RotateAbsolute, "/turtle1/rotate_absolute")
        self.looking = self.create_timer(0.1, self.look)

    def look(self):
        if self.compass.server_is_ready():
            self.looking.cancel()
            sent = self.compass.send_goal_async(RotateAbsolute.Goal(theta=-math.pi), self.on_feedback)
            sent.add_done_callback(lambda f: f.result().get_result_async().add_done_callback(self.on_result))

    def on_feedback(self, message):
        self.remaining = message.feedback.remaining

    def on_result(self, future):
        self.delta = abs(future.result().result.delta)

face_west = run(FaceWest)
""",
    "await_in_a_lifecycle_node": """
import numpy as np
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.lifecycle import LifecycleNode
from turtlesim.action import RotateAbsolute

class Remembers:
    delta = None
    remaining = np.nan

    def remember(self, message):
        self.remaining = np.float32(message.feedback.remaining)

class FaceWest(Remembers, LifecycleNode):
    def __init__(self):
        super().__init__("face_west")
        group = ReentrantCallbackGroup()
        self.client = ActionClient(self, RotateAbsolute, "turtle1/rotate_absolute", callback_group=group)
        self.once = self.create_timer(0.0, self.turn, callback_group=group)

    async def turn(self):
        self.once.cancel()
        self.client.wait_for_server(timeout_sec=3.0)
        handle = await self.client.send_goal_async(RotateAbsolute.Goal(theta=math.pi), feedback_callback=self.remember)
        response = await handle.get_result_async()
        self.delta = np.float64(response.result.delta)
""",
    "helper_node_with_its_own_executor": """
import threading
from rclpy.executors import SingleThreadedExecutor
from turtlesim.action import RotateAbsolute

class FaceWest(Node):
    def __init__(self):
        super().__init__("face_west")
        self.helper = Node("compass")
        self.helper.get_logger().get_child("needle").info("made")
        executor = SingleThreadedExecutor()
        executor.add_node(self.helper)
        threading.Thread(target=executor.spin, daemon=True).start()
        client = ActionClient(self.helper, RotateAbsolute, "turtle1/rotate_absolute")
        client.wait_for_server(3.0)
        self.feedbacks, self.result = [], None
        goal = RotateAbsolute.Goal()
        goal.theta = 3.1416
        client.send_goal_async(goal, feedback_callback=self.feedbacks.append).add_done_callback(self.accepted)

    def accepted(self, future):
        future.result().get_result_async().add_done_callback(self.finished)

    def finished(self, future):
        self.result = future.result().result

    @property
    def remaining(self):
        return self.feedbacks[-1].feedback.remaining if self.feedbacks else None

    @property
    def delta(self):
        return self.result and self.result.delta

    def destroy_node(self):
        self.helper.destroy_node()
        super().destroy_node()
""",
}

TELEPORTS = """
from turtlesim.srv import TeleportAbsolute

class FaceWest(Node):
    def __init__(self):
        super().__init__("face_west")
        self.client = self.create_client(TeleportAbsolute, "turtle1/teleport_absolute")
        self.client.wait_for_service(timeout_sec=3.0)
        self.client.call_async(TeleportAbsolute.Request(x=5.5, y=5.5, theta=math.pi))
        self.remaining, self.delta = 0.0, math.pi
"""

DRIVES = """
class FaceWest(Node):
    def __init__(self):
        super().__init__("face_west")
        self.publisher = self.create_publisher(Twist, "turtle1/cmd_vel", 10)
        self.create_subscription(Pose, "turtle1/pose", self.on_pose, 1)
        self.remaining, self.delta = 0.0, 0.0

    def on_pose(self, pose):
        self.remaining = math.remainder(math.pi - pose.theta, math.tau)
        twist = Twist()
        twist.angular.z = 2.0 * self.remaining
        self.publisher.publish(twist)
"""

ANSWERS = Answers(
    "actions-1",
    2,
    FACE_WEST,
    [
        Wrong("degrees", changed(FACE_WEST, ("theta=math.pi", "theta=180.0")), 1, "`theta` is in radians"),
        Wrong(
            "no_result",
            changed(FACE_WEST, ("future.result().get_result_async().add_done_callback(self.on_result)", "pass")),
            1,
            "the result comes to the done callback",
        ),
        Wrong(
            "no_feedback",
            changed(FACE_WEST, (", feedback_callback=self.on_feedback", "")),
            1,
            "`self.remaining` is None",
        ),
        Wrong("name", changed(FACE_WEST, ("turtle1/rotate_absolute", "rotate_absolute")), 0, "No goal came on"),
        Wrong(
            "waits",
            changed(
                FACE_WEST,
                (
                    "self.action.wait_for_server(timeout_sec=3.0)",
                    "wait_for(self.create_client(SetPen, 'no_such').call_async(SetPen.Request()), timeout=60)",
                ),
                ("import math", "import math\nfrom turtlesim.srv import SetPen"),
            ),
            0,
            "did not return",
        ),
        Wrong("north", changed(FACE_WEST, ("theta=math.pi", "theta=math.pi / 2")), 1, "west is math.pi"),
        Wrong(
            "twice",
            changed(
                FACE_WEST,
                ("        self.action.send", "        self.action.send_goal_async(goal)\n        self.action.send"),
            ),
            1,
            "It sends one when it is made",
        ),
        Wrong(
            "half_a_turn_by_heart",
            changed(FACE_WEST, ("self.delta = future.result().result.delta", "self.delta = math.pi")),
            1,
            "after the turn `self.delta` is 3.14",
        ),
        Wrong(
            "first_feedback",
            changed(FACE_WEST, ("self.remaining = message", "self.remaining = self.remaining or message")),
            1,
            "and after the turn `self.remaining` is",
        ),
        Wrong(
            "nothing_remains",
            changed(
                FACE_WEST,
                ("        self.delta = future", "        self.remaining = 0.0\n        self.delta = future"),
            ),
            1,
            "and after the turn `self.remaining` is 0.0",
        ),
        Wrong("teleports", TELEPORTS, 0, "No goal came on"),
        Wrong("drives", DRIVES, 0, "No goal came on"),
    ],
    FACE_WEST_STYLES,
)
