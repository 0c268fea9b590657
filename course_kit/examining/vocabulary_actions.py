"""What checks say about actions: who offers one, how its goals go and end; and a server of the checker's own."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from example_interfaces.action import Fibonacci
from rclpy.action import ActionClient, ActionServer, CancelResponse
from rclpy.node import Node
from rclpy.task import Future

from course_kit.examining.examination import current
from course_kit.examining.introduction import meet
from course_kit.examining.station import Heard
from course_kit.examining.vocabulary import arrival_timeout, expect_type, nearest, nobody_else, require, wait
from course_kit.examining.vocabulary_services import ANSWER_TIMEOUT, CONNECT_TIMEOUT
from course_kit.internals.rmw_parts import action_topics

# By the numbers of action_msgs/msg/GoalStatus.
STATUSES = ("unknown", "accepted", "executing", "canceling", "succeeded", "canceled", "aborted")


def _actions() -> dict[str, list[str]]:
    return {name: types for node in current().stage.offered() for name, types in node.action_servers.items()}


def expect_action(name: str, action_type: Any) -> Client:
    """The answer offers an action of this type; a client of it."""
    wait(lambda: name in _actions(), arrival_timeout())
    actions = _actions()
    hint = f"Nobody offers the action `{name}`. {nearest(name, list(actions))}"
    hint += f"Your node offers {', '.join(actions)}. " if actions else "Your node offers none. "
    require(f"it offers the action `{name}`", name in actions, f"{hint}`%ros2 action list -t` shows them.")
    expect_type(name, actions[name], action_type)
    return Client(name, action_type)


@dataclass
class Goal:
    """A goal that was sent, and what became of it so far."""

    heard: Heard  # the action's feedback topic
    accepted: bool | None = None  # None: no answer came
    status: int | None = None
    result: Any = None
    handle: Any = None

    @property
    def word(self) -> str:
        """The status in a word."""
        return "without an end" if self.status is None else STATUSES[self.status]

    def _is_mine(self, message: Any) -> bool:
        return self.handle is not None and bytes(message.goal_id.uuid) == bytes(self.handle.goal_id.uuid)

    @property
    def feedback(self) -> list[Any]:
        """The feedback that came, also what came after the end."""
        return [message.feedback for message in self.heard.messages if self._is_mine(message)]

    @property
    def period(self) -> float:
        """Seconds between two feedbacks; 0 below two."""
        times = [when for when, message in self.heard.arrivals if self._is_mine(message)]
        return (times[-1] - times[0]) * 1e-9 / (len(times) - 1) if len(times) > 1 else 0.0

    def note_result(self, future: Any) -> None:
        """Keep the result and the status of a goal; the done callback of its result's future."""
        answer = future.result()
        self.result, self.status = answer.result, answer.status

    def wait(self, timeout: float) -> bool:
        """Wait for the result."""
        return wait(lambda: self.status is not None, timeout, "the result of the goal")

    def cancel(self, timeout: float) -> None:
        """If it was accepted, ask the server to cancel it, and wait for what it says to that and for the result."""
        if self.accepted:
            wait(self.handle.cancel_goal_async().done, ANSWER_TIMEOUT, "the answer to a request to cancel")
            self.wait(timeout)


class Client:
    """An action client of the checker's on the stage."""

    def __init__(self, name: str, action_type: Any) -> None:
        self._type = action_type
        nobody_else(*action_topics(name))
        self._client = current().stage.on_own_node(lambda node: ActionClient(node, action_type, name))
        wait(self._client.server_is_ready, CONNECT_TIMEOUT, f"the action {name}")
        # Heard on its own: an ActionClient drops what comes after the result.
        self._heard = current().stage.listen(f"{name}/_action/feedback", action_type.Impl.FeedbackMessage)
        wait(lambda: self._heard.publisher_count, CONNECT_TIMEOUT, f"the feedback of {name}")
        meet(current().stage, name)

    def send(self, **fields: Any) -> Goal:
        """Send a goal and wait until it is accepted or rejected."""
        goal = Goal(self._heard)
        future = self._client.send_goal_async(self._type.Goal(**fields))
        if wait(future.done, ANSWER_TIMEOUT, "the answer to a goal"):
            goal.handle = future.result()
            goal.accepted = bool(goal.handle.accepted)
            if goal.accepted:
                goal.handle.get_result_async().add_done_callback(goal.note_result)
        return goal


class FibonacciServer:
    """The chapter's action `fibonacci`, ten numbers a second, on the stage: notes orders, cancels and feedback."""

    def __init__(self) -> None:
        self.orders: list[int] = []
        self.published = 0
        self.cancelled_after: int | None = None  # feedback messages
        self.ended: list[str] = []
        nobody_else(*action_topics("/fibonacci"))
        current().stage.on_own_node(self._prepare)

    def _prepare(self, node: Node) -> None:
        self._node = node
        ActionServer(node, Fibonacci, "fibonacci", self._execute, cancel_callback=self._on_cancel)

    def _on_cancel(self, _: Any) -> CancelResponse:
        if self.cancelled_after is None:
            self.cancelled_after = self.published
        return CancelResponse.ACCEPT

    async def _execute(self, goal: Any) -> Fibonacci.Result:
        self.orders.append(goal.request.order)
        sequence = [0, 1]
        while len(sequence) <= goal.request.order:
            pause = Future()
            timer = self._node.create_timer(0.1, lambda pause=pause: pause.set_result(None))
            await pause
            self._node.destroy_timer(timer)
            if goal.is_cancel_requested:
                goal.canceled()
                self.ended.append("canceled")
                return Fibonacci.Result(sequence=sequence)
            sequence.append(sequence[-1] + sequence[-2])
            self.published += 1
            goal.publish_feedback(Fibonacci.Feedback(sequence=sequence))
        goal.succeed()
        self.ended.append("succeeded")
        return Fibonacci.Result(sequence=sequence)
