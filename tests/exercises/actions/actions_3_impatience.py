"""Answers to actions-3: right ones in several styles, and wrong ones that students give."""

from __future__ import annotations

from tests.exercises.chapter import Answers, Wrong, changed, worked

IMPATIENT = worked("actions-3")

IMPATIENT_STYLES = {
    "length_of_the_feedback": """
class Impatient(Node):
    def __init__(self):
        Node.__init__(self, "impatient")
        self.client = ActionClient(self, Fibonacci, "/fibonacci")
        self.goal = self.create_timer(0.05, self.begin)

    def begin(self):
        if self.client.server_is_ready():
            self.goal.cancel()
            self.client.send_goal_async(Fibonacci.Goal(order=40), self.hear).add_done_callback(self.accepted)

    def hear(self, message):
        if len(message.feedback.sequence) >= 2 + 5:  # each time again, until it ends
            self.handle_of_goal.cancel_goal_async()

    def accepted(self, future):
        self.handle_of_goal = future.result()
        self.handle_of_goal.get_result_async().add_done_callback(
            lambda future: setattr(self, "status", future.result().status))
""",
    "looks_by_a_timer": """
from action_msgs.msg import GoalStatus
from collections import deque

class Impatient(Node):
    def __init__(self):
        super().__init__("impatient")
        self.status = GoalStatus.STATUS_UNKNOWN
        self.feedbacks, self.accepted, self.result, self.asked = deque(), None, None, False
        self.client = ActionClient(self, Fibonacci, "fibonacci")
        self.client.wait_for_server(timeout_sec=5.0)
        self.sent = self.client.send_goal_async(Fibonacci.Goal(order=40), feedback_callback=self.feedbacks.append)
        self.create_timer(0.02, self.look)

    def look(self):
        if self.accepted is None and self.sent.done():
            self.accepted = self.sent.result()
            self.result = self.accepted.get_result_async()
        if len(self.feedbacks) >= 5 and not self.asked:
            self.asked = True
            self.accepted.cancel_goal_async()
        if self.result is not None and self.result.done():
            self.status = int(self.result.result().status)
""",
    "await_with_threads": """
import numpy as np
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor

class Impatient(Node):
    def __init__(self):
        super().__init__("impatient")
        group = ReentrantCallbackGroup()
        self.action = ActionClient(self, Fibonacci, "fibonacci", callback_group=group)
        self.fifth, self.count = Future(), 0
        self.timer = self.create_timer(0.01, self.work, callback_group=group)

    def on_feedback(self, _):
        self.count += 1
        if self.count == 5:
            self.fifth.set_result(True)

    async def work(self):
        self.timer.cancel()
        self.action.wait_for_server(timeout_sec=3.0)
        goal = await self.action.send_goal_async(Fibonacci.Goal(order=40), feedback_callback=self.on_feedback)
        ended = goal.get_result_async()
        await self.fifth
        await goal.cancel_goal_async()
        self.status = np.int8((await ended).status)

impatient = run(Impatient, executor=MultiThreadedExecutor(num_threads=2))
""",
}

ANSWERS = Answers(
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
        Wrong("no_status", changed(IMPATIENT, ("self.status = future", "status = future")), 2, "`self.status` is None"),
        Wrong(
            "name_of_rclpy",
            changed(IMPATIENT, ("self.goal_handle", "self.handle")),
            0,
            "handle cannot be modified after node creation, in line",
        ),
        Wrong("sixth", changed(IMPATIENT, ("self.seen == 5", "self.seen > 5")), 2, "It asked to cancel after 6"),
        Wrong(
            "by_time",
            changed(
                IMPATIENT,
                ("self.seen == 5", "self.seen == 1"),
                (
                    "self.goal_handle.cancel",
                    "self.create_timer(0.4, self.cancel)\n\n    def cancel(self):\n        self.goal_handle.cancel",
                ),
            ),
            2,
            "It asked to cancel after",
        ),
        Wrong(
            "status_of_the_class",
            changed(
                IMPATIENT,
                ("self.status, self.goal", "self.status, self.goal"),
                ("    def __init__", "    status = 5\n\n    def __init__"),
                (
                    "self.status, self.goal_handle, self.seen = None, None, 0",
                    "self.goal_handle, self.seen = None, 0",
                ),
                ("self.status = future", "status = future"),
            ),
            2,
            "`self.status` is 5, the goal succeeded",
        ),
        Wrong(
            "status_it_wished_for",
            changed(
                IMPATIENT,
                (
                    "self.goal_handle.cancel_goal_async()",
                    "self.goal_handle.cancel_goal_async()\n            self.status = 5",
                ),
                ("self.status = future", "status = future"),
            ),
            2,
            "`self.status` is 5, the goal succeeded",
        ),
        Wrong(
            "status_of_the_answer_to_cancel",
            changed(
                IMPATIENT,
                (
                    "self.goal_handle.cancel_goal_async()",
                    "self.goal_handle.cancel_goal_async().add_done_callback(self.on_answer)",
                ),
                (
                    "    def on_result",
                    "    def on_answer(self, future):\n"
                    "        self.status = 5 if future.result().goals_canceling else 4\n\n"
                    "    def on_result",
                ),
                ("self.status = future", "status = future"),
            ),
            2,
            "was 4 before its end",
        ),
        Wrong(
            "late",
            changed(
                IMPATIENT,
                (
                    "            self.goal_handle.cancel_goal_async()",
                    "            self.timer = self.create_timer(0.8, self.cancel)",
                ),
                (
                    "    def on_accepted",
                    "    def cancel(self):\n        self.timer.cancel()\n"
                    "        self.goal_handle.cancel_goal_async()\n\n"
                    "    def on_accepted",
                ),
            ),
            2,
            "s after the fifth",
        ),
        Wrong(
            "tries_again",
            changed(
                IMPATIENT,
                (
                    "future.result().status",
                    "future.result().status\n        if self.status == 4:\n"
                    "            self.action.send_goal_async(Fibonacci.Goal(order=40))",
                ),
            ),
            2,
            "The orders that came: [40, 40]",
        ),
        Wrong(
            "twice",
            changed(
                IMPATIENT,
                (
                    "        sent.add",
                    "        self.action.send_goal_async(Fibonacci.Goal(order=40))\n        sent.add",
                ),
            ),
            1,
            "The orders that came: [40, 40]",
        ),
    ],
    IMPATIENT_STYLES,
)
