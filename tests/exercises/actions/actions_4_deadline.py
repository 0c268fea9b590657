"""Answers to actions-4: right ones in several styles, and wrong ones that students give."""

from __future__ import annotations

from tests.exercises.chapter import Answers, Wrong, changed, worked

DEADLINE = worked("actions-4")

DEADLINE_STYLES = {
    "inherits_from_the_chapter": """
import time

class DeadlineServer(CountingServer):
    def __init__(self):
        Node.__init__(self, "deadline_server")
        self.due = []
        self.server = ActionServer(self, Fibonacci, "fibonacci_deadline", self.execute, cancel_callback=self.on_cancel)

    async def sleep(self, seconds):
        await super().sleep(seconds)
        for handle, due in self.due:
            if time.monotonic() > due and handle.is_active:
                handle.abort()

    async def execute(self, goal_handle):
        self.due.append((goal_handle, time.monotonic() + 1.0))
        return await super().execute(goal_handle)
""",
    "blocking": """
import time

class DeadlineServer(Node):
    deadline = 1.0

    def __init__(self):
        super().__init__("deadline_server")
        self.server = ActionServer(self, Fibonacci, "fibonacci_deadline", self.execute,
                                   cancel_callback=lambda handle: CancelResponse.ACCEPT)

    def execute(self, handle):
        until = time.perf_counter() + self.deadline
        numbers = [0, 1]
        for number in range(2, handle.request.order + 1):
            time.sleep(0.1)
            if time.perf_counter() > until:
                handle.abort()
                break
            if handle.is_cancel_requested:
                handle.canceled()
                break
            numbers.append(numbers[-2] + numbers[-1])
            handle.publish_feedback(Fibonacci.Feedback(sequence=numbers))
        else:
            handle.succeed()
        return Fibonacci.Result(sequence=numbers)
""",
    "timer_that_aborts": """
from rclpy.lifecycle import LifecycleNode

class DeadlineServer(LifecycleNode):
    def __init__(self):
        super().__init__("deadline_server")
        self.server = ActionServer(self, Fibonacci, "fibonacci_deadline", self.execute,
                                   cancel_callback=lambda handle: CancelResponse.ACCEPT)

    sleep = FibonacciServer.sleep

    async def execute(self, handle):
        alarm = self.create_timer(1.0, handle.abort)
        numbers = [0, 1]
        while handle.is_active and len(numbers) <= handle.request.order:
            await self.sleep(0.1)
            if handle.is_cancel_requested:
                handle.canceled()
            elif handle.is_active:
                numbers.append(numbers[-1] + numbers[-2])
                handle.publish_feedback(Fibonacci.Feedback(sequence=numbers))
        self.destroy_timer(alarm)
        if handle.is_active:
            handle.succeed()
        return Fibonacci.Result(sequence=numbers)
""",
}

ANSWERS = Answers(
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
            "is succeeded after",
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
        Wrong(
            "no_cancel",
            changed(DEADLINE, ("CancelResponse.ACCEPT", "CancelResponse.REJECT")),
            2,
            "a cancel_callback",
        ),
        Wrong(
            "counts_numbers",
            changed(DEADLINE, ("(self.get_clock().now() - began).nanoseconds > 1e9", "len(sequence) > 11")),
            2,
            "A count of numbers is no clock",
        ),
        Wrong(
            "by_the_order",
            changed(DEADLINE, ("(self.get_clock().now() - began).nanoseconds > 1e9", "goal_handle.request.order > 11")),
            1,
            "is aborted after 0.",
        ),
        Wrong(
            "since_it_was_made",
            changed(
                DEADLINE,
                ("        began = self", "        began = self.began = getattr(self, 'began', None) or self"),
            ),
            0,
            "is aborted, with",
        ),
        Wrong("two_seconds", changed(DEADLINE, ("> 1e9", "> 2e9")), 2, "is aborted after 2."),
        Wrong("half_a_second", changed(DEADLINE, ("> 1e9", "> 4.5e8")), 1, "is aborted after 0."),
        Wrong(
            "rejects_what_is_long",
            changed(
                DEADLINE,
                (
                    "self.execute,",
                    "self.execute,\ngoal_callback=lambda goal: list(GoalResponse)[goal.order < 11],\n",
                ),
            ),
            1,
            "is rejected: ",
        ),
        Wrong("no_feedback", changed(DEADLINE, ("goal_handle.publish_feedback", "str")), 2, "not the numbers so far"),
        Wrong(
            "one_too_few",
            changed(DEADLINE, ("<= goal_handle.request", "< goal_handle.request")),
            2,
            "is succeeded, with",
        ),
        Wrong(
            "rejects_above_29",
            changed(
                DEADLINE,
                ("self.execute,", "self.execute,\ngoal_callback=lambda goal: list(GoalResponse)[goal.order < 30],\n"),
            ),
            1,
            "is rejected",
        ),
        Wrong(
            "tells_the_last_number",
            changed(DEADLINE, ("Feedback(sequence=sequence)", "Feedback(sequence=sequence[-1:])")),
            2,
            "and not the numbers so far",
        ),
        Wrong("slow", changed(DEADLINE, ("sleep(0.1)", "sleep(0.2)")), 2, "count as CountingServer does"),
    ],
    DEADLINE_STYLES,
)
