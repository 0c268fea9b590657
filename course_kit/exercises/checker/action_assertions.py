"""Assertions about actions: servers, goals and their ends; and servers and clients of the checker's own."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from action_msgs.msg import GoalStatus, GoalStatusArray
from example_interfaces.action import Fibonacci
from rcl_interfaces.msg import Parameter
from rcl_interfaces.srv import SetParametersAtomically
from rclpy.action import ActionClient, ActionServer, CancelResponse
from rclpy.node import Node
from rclpy.task import Future
from turtlesim.action import RotateAbsolute

from course_kit.exercises.checker.assertions import arrival_timeout, expect_type, nearest, nobody_else, require, wait
from course_kit.exercises.checker.examination import current
from course_kit.exercises.checker.service_assertions import ANSWER_TIMEOUT, CONNECT_TIMEOUT
from course_kit.exercises.checker.wait_for_discovery import meet
from course_kit.robots.turtlesim.node import TurtleSim
from course_kit.robots.turtlesim.turtle import Rotation
from course_kit.ros.observing.received_messages import ReceivedMessages
from course_kit.ros.private_api.rmw_parts import action_topics

ENDS = (GoalStatus.STATUS_SUCCEEDED, GoalStatus.STATUS_CANCELED, GoalStatus.STATUS_ABORTED)
ROTATE = "/turtle1/rotate_absolute"
ARRIVAL = 1.0  # seconds that an end may take to be found
LOOK = 0.02  # seconds from one look to the next of the checker's server
PATIENCE = 1.0  # seconds that it waits for a request to cancel
HASTE = 0.01  # seconds from number to number once it has refused, and goes on
REST = 3.0  # seconds that it waits to be told to go on
SAMPLE, MOST_WORK = 500, 60_000  # parameters: of what is measured, and in one request
LITTLE_WORK = 0.1  # seconds
# By the numbers of action_msgs/msg/GoalStatus.
STATUSES = ("unknown", "accepted", "executing", "canceling", "succeeded", "canceled", "aborted")


def _actions() -> dict[str, list[str]]:
    return {name: types for node in current().test_domain.offered() for name, types in node.action_servers.items()}


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

    heard: ReceivedMessages  # the action's feedback topic
    states: ReceivedMessages  # the action's status topic
    sent: float = field(default_factory=time.monotonic)
    accepted: bool | None = None  # None: no answer came
    status: int | None = None
    result: Any = None
    handle: Any = None
    ended: float | None = None  # when the result came; as `sent`, seconds of the monotonic clock

    @property
    def word(self) -> str:
        """What became of it, in a word."""
        if not self.accepted:
            return "without an answer" if self.accepted is None else "rejected"
        return "without an end" if self.status is None else STATUSES[self.status]

    def _is_mine(self, goal_id: Any) -> bool:
        return self.handle is not None and bytes(goal_id.uuid) == bytes(self.handle.goal_id.uuid)

    @property
    def told(self) -> list[tuple[int, Any]]:
        """When each feedback came (nanoseconds since the epoch), and the feedback, also what came after the end."""
        return [(when, said.feedback) for when, said in self.heard.arrivals if self._is_mine(said.goal_id)]

    @property
    def feedback(self) -> list[Any]:
        """The feedback that came."""
        return [feedback for _, feedback in self.told]

    @property
    def settled(self) -> int | None:
        """When the server said how it ended (nanoseconds since the epoch), which may be before the result came."""
        for when, message in self.states.arrivals:
            mine = [each.status for each in message.status_list if self._is_mine(each.goal_info.goal_id)]
            if any(status in ENDS for status in mine):
                return when
        return None

    def note_result(self, future: Any) -> None:
        """Keep the result and the status of a goal; the done callback of its result's future."""
        answer = future.result()
        self.ended = time.monotonic()
        self.result, self.status = answer.result, answer.status

    def wait(self, timeout: float) -> bool:
        """Wait for the result, if it was accepted."""
        return bool(self.accepted) and wait(lambda: self.status is not None, timeout, "the result of the goal")

    def cancel(self, timeout: float) -> float:
        """If it was accepted, ask the server to cancel it, and wait for its answer and the result; seconds it took."""
        began = time.monotonic()
        if self.accepted:
            wait(self.handle.cancel_goal_async().done, ANSWER_TIMEOUT, "the answer to a request to cancel")
            self.wait(timeout)
        return max(0.0, (self.ended or time.monotonic()) - began)


class Client:
    """An action client of the checker's in the test domain."""

    def __init__(self, name: str, action_type: Any) -> None:
        self._type = action_type
        nobody_else(*action_topics(name))
        self._client = current().test_domain.on_own_node(lambda node: ActionClient(node, action_type, name))
        wait(self._client.server_is_ready, CONNECT_TIMEOUT, f"the action {name}")
        # ReceivedMessages on its own: an ActionClient drops what comes after the result.
        self._heard = current().test_domain.listen(f"{name}/_action/feedback", action_type.Impl.FeedbackMessage)
        self._states = current().test_domain.listen(f"{name}/_action/status", GoalStatusArray)
        ends = self._heard, self._states
        wait(lambda: all(each.publisher_count for each in ends), CONNECT_TIMEOUT, f"the topics of {name}")
        meet(current().test_domain, name)

    def send(self, **fields: Any) -> Goal:
        """Send a goal and wait until it is accepted or rejected."""
        goal = Goal(self._heard, self._states)
        future = self._client.send_goal_async(self._type.Goal(**fields))
        if wait(future.done, ANSWER_TIMEOUT, "the answer to a goal"):
            goal.handle = future.result()
            goal.accepted = bool(goal.handle.accepted)
            if goal.accepted:
                goal.handle.get_result_async().add_done_callback(goal.note_result)
        return goal


class FibonacciServer:
    """The chapter's action `fibonacci` in the test domain: for each goal it can be told how, and it notes what came."""

    def __init__(self) -> None:
        nobody_else(*action_topics("/fibonacci"))
        self.begin()
        current().test_domain.on_own_node(self._prepare)

    def begin(
        self, period: float = 0.1, rest: tuple[int, float] = (0, 0.0), patient_after: int = 0, refuses: bool = False
    ) -> None:
        """Begin anew. `period`: seconds from number to number; `rest`: after which feedback it rests, for how long.

        After feedback number `patient_after` it waits for a request to cancel, PATIENCE seconds at most. If it
        `refuses` one, it waits for go_on(), REST seconds at most.
        """
        self._period, self._rest, self._patient_after, self._refuses = period, rest, patient_after, refuses
        self.orders: list[int] = []
        self.published = 0
        self.cancelled_after: int | None = None  # feedback messages
        self.hesitated = 0.0  # seconds from the last of them to the request to cancel
        self._last = 0.0
        self.ended: list[str] = []
        self._may_go_on = not refuses

    def go_on(self) -> None:
        """Let the goal that it refused to cancel come to its end."""
        self._may_go_on = True

    def _prepare(self, node: Node) -> None:
        self._node = node
        ActionServer(node, Fibonacci, "fibonacci", self._execute, cancel_callback=self._on_cancel)

    def _on_cancel(self, _: Any) -> CancelResponse:
        if self.cancelled_after is None:
            self.cancelled_after = self.published
            self.hesitated = time.monotonic() - self._last
        return CancelResponse.REJECT if self._refuses else CancelResponse.ACCEPT

    async def _sleep(self, seconds: float) -> None:
        done = Future()
        timer = self._node.create_timer(seconds, lambda: done.set_result(None))
        await done
        self._node.destroy_timer(timer)

    async def _wait(self, condition: Callable[[], Any], timeout: float) -> None:
        until = time.monotonic() + timeout
        while not condition() and time.monotonic() < until:
            await self._sleep(LOOK)

    async def _pause(self) -> None:
        """What passes before the next number."""
        after, seconds = self._rest
        if 0 < after == self.published:
            await self._sleep(seconds)
        if 0 < self._patient_after == self.published:
            await self._wait(lambda: self.cancelled_after is not None, PATIENCE)
        is_refused = self._refuses and self.cancelled_after is not None
        if is_refused and not self._may_go_on:
            await self._wait(lambda: self._may_go_on, REST)
            self._may_go_on = True
        await self._sleep(HASTE if is_refused else self._period)

    async def _execute(self, goal: Any) -> Fibonacci.Result:
        self.orders.append(goal.request.order)
        ended = self.ended
        # What is sent before the client is found is lost to it, and it could not count.
        await self._wait(lambda: self._node.count_subscribers("/fibonacci/_action/feedback"), ARRIVAL)
        sequence = [0, 1]
        while len(sequence) <= goal.request.order:
            await self._pause()
            if self.ended is not ended:  # it was begun anew: this goal is another node's
                goal.abort()
                return Fibonacci.Result()
            if goal.is_cancel_requested:
                goal.canceled()
                self.ended.append("canceled")
                return Fibonacci.Result(sequence=sequence)
            sequence.append(sequence[-1] + sequence[-2])
            self.published, self._last = self.published + 1, time.monotonic()
            goal.publish_feedback(Fibonacci.Feedback(sequence=sequence))
        goal.succeed()
        self.ended.append("succeeded")
        return Fibonacci.Result(sequence=sequence)


class TurtlesRotations:
    """What turtle1 of a_turtle() is told by its action, and the feedback that it sends, since begin()."""

    def __init__(self, turtlesim: TurtleSim) -> None:
        nobody_else(*action_topics(ROTATE))
        self._world, self._rotate = turtlesim.world, turtlesim.world.rotate
        turtlesim.world.rotate = self._note  # type: ignore[method-assign]
        feedback = RotateAbsolute.Impl.FeedbackMessage
        self._heard = current().test_domain.listen(f"{ROTATE}/_action/feedback", feedback, own=True)
        self.begin()

    def begin(self) -> None:
        """Forget what was."""
        self.goals: list[Rotation] = []
        self._before = len(self._heard)

    def require_one_server(self) -> None:
        """The answer has no server of the turtle's action itself, which would answer the same goals."""
        require(
            "the turtle alone serves its action",
            not current().test_domain.is_published_by_the_answer(f"{ROTATE}/_action/status"),
            f"Your node has an ActionServer of `{ROTATE}` too: a goal goes to both, and either's answer comes first. "
            "It sends the goal to the turtle; end the server.",
        )

    def _note(self, name: str, goal: float) -> Rotation:
        rotation = self._rotate(name, goal)
        self.goals.append(rotation)
        return rotation

    @property
    def remaining(self) -> list[float]:
        """The radians of each feedback."""
        return [message.feedback.remaining for message in self._heard.messages[self._before :]]


class BusyWork:
    """Requests that take a node's only thread: to set very many parameters that it does not have, all or none.

    So nothing is set. A node that serves no parameters is left alone.
    """

    def __init__(self, node: str) -> None:
        name = f"{node}/set_parameters_atomically"
        self._client = current().test_domain.check_node.create_client(SetParametersAtomically, name)
        self._is_served = wait(self._client.service_is_ready, ARRIVAL)
        if self._is_served:
            meet(current().test_domain, name)
            self._seconds_each = min(self._take(SAMPLE) for _ in range(2)) / SAMPLE

    def take(self, seconds: float) -> None:
        """Give it work for about so long, and wait until it is done; more work if it was done sooner."""
        until = time.monotonic() + seconds
        while self._is_served and (left := until - time.monotonic()) > LITTLE_WORK:
            self._take(min(MOST_WORK, 1 + round(left / self._seconds_each)))

    def _take(self, count: int) -> float:
        began = time.monotonic()
        request = SetParametersAtomically.Request(parameters=[Parameter(name="_of_the_checker")] * count)
        wait(self._client.call_async(request).done, ANSWER_TIMEOUT, "an answer about parameters")
        return time.monotonic() - began
