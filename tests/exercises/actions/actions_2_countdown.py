"""Answers to actions-2: right ones in several styles, and wrong ones that students give."""

from __future__ import annotations

from tests.exercises.chapter import Answers, Wrong, changed, worked

COUNTDOWN = worked("actions-2")

COUNTDOWN_STYLES = {
    "blocking_in_threads": """
import time
from rclpy.action import GoalResponse
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor

class CountdownServer(Node):
    def __init__(self):
        super().__init__("countdown_server")
        self.server = ActionServer(
            self, Fibonacci, "/countdown", execute_callback=self.execute, callback_group=ReentrantCallbackGroup(),
            goal_callback=self.on_goal, cancel_callback=lambda handle: CancelResponse.ACCEPT)

    def on_goal(self, request):
        return GoalResponse.ACCEPT if request.order >= 0 else GoalResponse.REJECT

    def execute(self, handle):
        result = Fibonacci.Result()
        for left in reversed(range(handle.request.order + 1)):
            if handle.is_cancel_requested:
                handle.canceled()
                return result
            result.sequence.append(left)
            feedback = Fibonacci.Feedback()
            feedback.sequence = [left]
            handle.publish_feedback(feedback)
            time.sleep(0.1)
        handle.succeed()
        return result

countdown_server = run(CountdownServer, executor=MultiThreadedExecutor(num_threads=3))
""",
    "delayed_at_first_as_by_a_busy_machine": changed(
        COUNTDOWN,
        ("        counted = []", "        counted = []\n        self.late_goals -= 1"),
        ("    sleep =", "    late_goals = 5\n    sleep ="),
        ("sleep(0.1)", "sleep(0.1 if self.late_goals < 0 else 0.18)"),
    ),
    "blocking_as_it_is": """
import threading
import numpy as np
from rclpy.action import GoalResponse

class CountdownServer(Node):
    def __init__(self):
        super().__init__("countdown_server")
        self.lock, self.pause = threading.Lock(), threading.Event()
        ActionServer(self, Fibonacci, "countdown", self.run_goal, goal_callback=self.check,
                     cancel_callback=self.on_cancel)

    def check(self, goal):
        self.get_logger().get_child("door").info(f"{goal.order} asked for")
        return GoalResponse.REJECT if goal.order < 0 else GoalResponse.ACCEPT

    def on_cancel(self, handle):
        self.get_logger().info("to be cancelled")
        return CancelResponse.ACCEPT

    def run_goal(self, handle):
        with self.lock:  # one after another
            whole = np.arange(handle.request.order, -1, -1, dtype=np.int32)
            for number in whole:
                self.pause.wait(0.1)
                if handle.is_cancel_requested:
                    handle.canceled()
                    return Fibonacci.Result()
                handle.publish_feedback(Fibonacci.Feedback(sequence=np.array([number], dtype=np.int32)))
            handle.succeed()
            return Fibonacci.Result(sequence=whole)
""",
    "ticks_of_a_timer": """
from rclpy.action import GoalResponse

class CountdownServer(Node):
    def __init__(self):
        super().__init__("countdown_server")
        self.jobs = {}
        self.server = ActionServer(self, Fibonacci, "countdown", self.execute, goal_callback=self.on_goal,
                                   cancel_callback=lambda _: CancelResponse.ACCEPT)
        self.create_timer(0.1, self.tick)

    def on_goal(self, goal):
        busy = bool(self.jobs)  # one at a time: another is rejected
        return GoalResponse.REJECT if goal.order < 0 or busy else GoalResponse.ACCEPT

    def tick(self):
        for key, (handle, counted, done) in list(self.jobs.items()):
            if handle.is_cancel_requested:
                handle.canceled()
            elif not counted or counted[-1] > 0:
                counted.append(counted[-1] - 1 if counted else handle.request.order)
                handle.publish_feedback(Fibonacci.Feedback(sequence=counted[-1:]))
                continue
            else:
                handle.succeed()
            del self.jobs[key]
            done.set_result(Fibonacci.Result(sequence=counted))

    async def execute(self, handle):
        done = Future()
        self.jobs[bytes(handle.goal_id.uuid)] = handle, [], done
        return await done
""",
    "rate_in_threads": """
from rclpy.action import GoalResponse
from rclpy.executors import MultiThreadedExecutor

class CountdownServer(Node):
    def __init__(self):
        super().__init__("countdown_server")
        choices = {"goal_callback": self.on_goal, "cancel_callback": self.on_cancel}
        self.server = ActionServer(self, Fibonacci, "countdown", self.execute, **choices)
        self.rate = self.create_rate(10.0)

    def on_goal(self, goal):
        return GoalResponse.ACCEPT if not goal.order < 0 else GoalResponse.REJECT

    def on_cancel(self, _):
        return CancelResponse.ACCEPT

    def execute(self, handle):
        sequence, number = [], handle.request.order
        while number >= 0 and not handle.is_cancel_requested:
            handle.publish_feedback(Fibonacci.Feedback(sequence=[number]))
            sequence += [number]
            number -= 1
            self.rate.sleep()
        handle.canceled() if number >= 0 else handle.succeed()
        return Fibonacci.Result(sequence=sequence)

node = run(CountdownServer, executor=MultiThreadedExecutor())
""",
}

ANSWERS = Answers(
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
        Wrong("stops_at_one", changed(COUNTDOWN, ("order, -1, -1", "order, 0, -1")), 1, "is succeeded, with"),
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
        Wrong("rejects_zero", changed(COUNTDOWN, ("order < 0", "order <= 0")), 1, "The order 0 is rejected"),
        Wrong("one_negative", changed(COUNTDOWN, ("order < 0", "order == -1")), 2, "was accepted"),
        Wrong(
            "never_emptied",
            changed(
                COUNTDOWN,
                ("        counted = []", "        counted = self.counted"),
                ("    sleep =", "    counted = []\n    sleep ="),
            ),
            2,
            "each goal has a sequence of its own",
        ),
        Wrong("too_fast", changed(COUNTDOWN, ("sleep(0.1)", "sleep(0.05)")), 2, "all came 0.0"),
        Wrong("too_slow", changed(COUNTDOWN, ("sleep(0.1)", "sleep(0.2)")), 2, "all came 0.2"),
        Wrong("uneven", changed(COUNTDOWN, ("sleep(0.1)", "sleep(0.05 + 0.2 * (number % 2))")), 2, "all came 0.1"),
        Wrong(
            "order_by_heart",
            changed(COUNTDOWN, ("goal_handle.request.order, -1", "0, -1")),
            0,
            "each is a sequence of one",
        ),
        Wrong(
            "rejects_above_46",
            changed(COUNTDOWN, ("goal.order < 0", "not 0 <= goal.order <= 46")),
            2,
            "is rejected",
        ),
        Wrong(
            "looks_at_the_end",
            changed(
                COUNTDOWN,
                ("            if goal_handle.is_cancel_requested", "            if False"),
                (
                    "        goal_handle.succeed()",
                    "        goal_handle.canceled() if goal_handle.is_cancel_requested else goal_handle.succeed()",
                ),
            ),
            2,
            "was to be cancelled after",
        ),
        Wrong(
            "no_such_name",
            changed(COUNTDOWN, (' "countdown"', ' "count_down"')),
            0,
            "Did you mean `/count_down`",
        ),
    ],
    COUNTDOWN_STYLES,
)
