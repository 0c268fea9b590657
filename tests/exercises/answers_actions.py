"""Answers to chapter 5's exercises: one that is right, and wrong ones that students give."""

from __future__ import annotations

from tests.exercises.answers_topics import changed
from tests.exercises.chapter import Answers, Wrong

CELLS = (
    "actions-what-parts",
    "actions-server-class",
    "actions-server-execute-method",
    "actions-server-destroy-method",
    "actions-client-class",
    "actions-cancel-class",
    "actions-polygon-provide",
    "actions-polygon-node",
    "actions-polygon-pose",
    "actions-polygon-corners",
    "actions-polygon-drive",
    "actions-polygon-execute",
)
PREPARE = """
import math

from rclpy.action import GoalResponse

from course_kit import wait_for

PolygonServer.drive, PolygonServer.execute = drive, execute
"""

FACE_WEST = """
import math
from turtlesim.action import RotateAbsolute

class FaceWest(Node):
    def __init__(self):
        super().__init__("face_west")
        self.remaining, self.delta = None, None
        self.action = ActionClient(self, RotateAbsolute, "turtle1/rotate_absolute")
        self.action.wait_for_server(timeout_sec=3.0)
        goal = RotateAbsolute.Goal(theta=math.pi)
        self.action.send_goal_async(goal, feedback_callback=self.on_feedback).add_done_callback(self.on_accepted)

    def on_feedback(self, message):
        self.remaining = message.feedback.remaining

    def on_accepted(self, future):
        future.result().get_result_async().add_done_callback(self.on_result)

    def on_result(self, future):
        self.delta = future.result().result.delta
"""

COUNTDOWN = """
from rclpy.action import GoalResponse

class CountdownServer(Node):
    def __init__(self):
        super().__init__("countdown_server")
        self.server = ActionServer(self, Fibonacci, "countdown", self.execute, goal_callback=self.on_goal,
                                   cancel_callback=lambda goal: CancelResponse.ACCEPT)

    sleep = FibonacciServer.sleep

    def on_goal(self, goal):
        return GoalResponse.REJECT if goal.order < 0 else GoalResponse.ACCEPT

    async def execute(self, goal_handle):
        counted = []
        for number in range(goal_handle.request.order, -1, -1):
            await self.sleep(0.1)
            if goal_handle.is_cancel_requested:
                goal_handle.canceled()
                return Fibonacci.Result(sequence=counted)
            counted.append(number)
            goal_handle.publish_feedback(Fibonacci.Feedback(sequence=[number]))
        goal_handle.succeed()
        return Fibonacci.Result(sequence=counted)
"""

IMPATIENT = """
class Impatient(Node):
    def __init__(self):
        super().__init__("impatient")
        self.status, self.goal_handle, self.seen = None, None, 0
        self.action = ActionClient(self, Fibonacci, "fibonacci")
        self.action.wait_for_server(timeout_sec=3.0)
        sent = self.action.send_goal_async(Fibonacci.Goal(order=40), feedback_callback=self.on_feedback)
        sent.add_done_callback(self.on_accepted)

    def on_feedback(self, message):
        self.seen += 1
        if self.seen == 5:
            self.goal_handle.cancel_goal_async()

    def on_accepted(self, future):
        self.goal_handle = future.result()
        self.goal_handle.get_result_async().add_done_callback(self.on_result)

    def on_result(self, future):
        self.status = future.result().status
"""

DEADLINE = """
class DeadlineServer(Node):
    def __init__(self):
        super().__init__("deadline_server")
        self.server = ActionServer(self, Fibonacci, "fibonacci_deadline", self.execute)

    sleep = FibonacciServer.sleep

    async def execute(self, goal_handle):
        began = self.get_clock().now()
        sequence = [0, 1]
        while len(sequence) <= goal_handle.request.order:
            await self.sleep(0.1)
            if (self.get_clock().now() - began).nanoseconds > 1e9:
                goal_handle.abort()
                return Fibonacci.Result(sequence=sequence)
            sequence.append(sum(sequence[-2:]))
            goal_handle.publish_feedback(Fibonacci.Feedback(sequence=sequence))
        goal_handle.succeed()
        return Fibonacci.Result(sequence=sequence)
"""

STAR = """
class StarServer(Node):
    def __init__(self):
        super().__init__("star_server")
        self.waiting, self.goal = [], None
        self.publisher = self.create_publisher(Twist, "turtle1/cmd_vel", 10)
        self.create_subscription(Pose, "turtle1/pose", self.on_pose, 1)
        self.server = ActionServer(self, Polygon, "drive_star", self.execute,
                                   cancel_callback=lambda goal: CancelResponse.ACCEPT)

    on_pose, next_pose = PolygonServer.on_pose, PolygonServer.next_pose

    async def to(self, goal_handle, x, y, lines, side, home=False):
        pose = await self.next_pose()
        while (distance := math.dist((pose.x, pose.y), (x, y))) >= 0.05:
            if self.goal is not goal_handle or (goal_handle.is_cancel_requested and not home):
                return False
            goal_handle.publish_feedback(Polygon.Feedback(distance_left=distance + side * lines))
            self.publisher.publish(steer(pose, x, y))
            pose = await self.next_pose()
        return True

    async def execute(self, goal_handle):
        earlier, self.goal = self.goal, goal_handle
        side, pose = goal_handle.request.side_length, await self.next_pose()
        start, x, y = (pose.x, pose.y), pose.x, pose.y
        for number in range(5):
            heading = pose.theta + number * 2 * math.tau / 5
            x, y = x + side * math.cos(heading), y + side * math.sin(heading)
            if not await self.to(goal_handle, x, y, 4 - number, side):
                break
        else:
            self.publisher.publish(Twist())
            goal_handle.succeed()
            return Polygon.Result(distance=5 * side)
        if self.goal is not goal_handle:
            goal_handle.abort()
            return Polygon.Result()
        await self.to(goal_handle, *start, 0, side, home=True)
        self.publisher.publish(Twist())
        goal_handle.canceled()
        return Polygon.Result()
"""

ANSWERS = [
    Answers(
        "actions-1",
        2,
        FACE_WEST,
        [
            Wrong("degrees", changed(FACE_WEST, ("theta=math.pi", "theta=180.0")), 0, "`theta` is in radians"),
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
                "`self.remaining` None",
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
        ],
    ),
    Answers(
        "actions-2",
        3,
        COUNTDOWN,
        [
            Wrong(
                "whole_feedback",
                changed(COUNTDOWN, ("Feedback(sequence=[number])", "Feedback(sequence=counted)")),
                2,
                "each is a sequence of one number",
            ),
            Wrong(
                "no_succeed",
                changed(COUNTDOWN, ("        goal_handle.succeed()\n", "")),
                2,
                "without it a goal is aborted",
            ),
            Wrong(
                "no_cancel",
                changed(COUNTDOWN, ("CancelResponse.ACCEPT", "CancelResponse.REJECT")),
                2,
                "a cancel_callback that",
            ),
            Wrong("accepts_negative", changed(COUNTDOWN, ("goal.order < 0", "False")), 2, "The order -1 was accepted"),
            Wrong(
                "field",
                changed(COUNTDOWN, ("Feedback(sequence=", "Feedback(partial_sequence=")),
                0,
                "so it is when `execute` raises",
            ),
            Wrong("stops_at_one", changed(COUNTDOWN, ("order, -1, -1", "order, 0, -1")), 1, "[5, 4, 3, 2, 1]"),
            Wrong(
                "after_the_end",
                changed(
                    COUNTDOWN,
                    (
                        "        goal_handle.succeed()\n        return",
                        "        goal_handle.publish_feedback(Fibonacci.Feedback(sequence=[0]))\n        "
                        "goal_handle.succeed()\n        return",
                    ),
                ),
                2,
                "after the goal has ended there is none",
            ),
        ],
    ),
    Answers(
        "actions-3",
        3,
        IMPATIENT,
        [
            Wrong("at_once", changed(IMPATIENT, ("self.seen == 5", "self.seen == 1")), 2, "It asked to cancel after 1"),
            Wrong(
                "never",
                changed(IMPATIENT, ("self.goal_handle.cancel_goal_async()", "pass")),
                1,
                "No request to cancel came",
            ),
            Wrong("order", changed(IMPATIENT, ("order=40", "order=20")), 2, "The orders that came: [20]"),
            Wrong("no_status", changed(IMPATIENT, ("self.status = future", "status = future")), 2, "It is None"),
            Wrong(
                "name_of_rclpy",
                changed(IMPATIENT, ("self.goal_handle", "self.handle")),
                0,
                "handle cannot be modified after node creation, in line",
            ),
        ],
    ),
    Answers(
        "actions-4",
        3,
        DEADLINE,
        [
            Wrong("never_aborts", changed(DEADLINE, ("> 1e9", "> 1e12")), 1, "is over 1 s"),
            Wrong("seconds", changed(DEADLINE, ("> 1e9", "> 1.0")), 0, "look at the time on the way"),
            Wrong(
                "canceled",
                changed(DEADLINE, ("goal_handle.abort()", "goal_handle.succeed()")),
                2,
                "It is succeeded after",
            ),
            Wrong(
                "no_numbers",
                changed(
                    DEADLINE,
                    (
                        "                return Fibonacci.Result(sequence=sequence)",
                        "                return Fibonacci.Result()",
                    ),
                ),
                2,
                "return Fibonacci.Result(sequence=…) after abort()",
            ),
            Wrong(
                "blocks",
                changed(DEADLINE, ("await self.sleep(0.1)", "import time; time.sleep(100)")),
                0,
                "without an end",
            ),
        ],
    ),
    Answers(
        "actions-5",
        5,
        STAR,
        [
            Wrong(
                "pentagon",
                changed(STAR, ("number * 2 * math.tau", "number * math.tau")),
                4,
                "twice the angle of a pentagon",
            ),
            Wrong(
                "not_home",
                changed(STAR, ("        await self.to(goal_handle, *start, 0, side, home=True)\n", "")),
                4,
                "only after the way back",
            ),
            Wrong(
                "no_cancel",
                changed(STAR, ("CancelResponse.ACCEPT", "CancelResponse.REJECT")),
                4,
                "a cancel_callback that accepts",
            ),
            Wrong(
                "both_drive",
                changed(STAR, ("self.goal is not goal_handle or (goal_handle", "(goal_handle")),
                4,
                "abort the first",
            ),
            Wrong(
                "type",
                changed(STAR, ('Polygon, "drive_star"', 'Fibonacci, "drive_star"')),
                0,
                "Its type is example_interfaces/action/Fibonacci",
            ),
            Wrong("no_result", changed(STAR, ("(distance=5 * side)", "()")), 4, "with a distance of 0.0 m"),
            Wrong(
                "driven_not_left",
                changed(STAR, ("distance + side * lines", "side * (5 - lines) - distance")),
                4,
                "10 at the beginning",
            ),
        ],
    ),
]
