"""`ros2 action send_goal`: one goal, its feedback and its result; an interrupt cancels the goal."""

from __future__ import annotations

import signal
import time
from argparse import ArgumentParser, Namespace
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from queue import SimpleQueue
from types import FrameType
from typing import TYPE_CHECKING, Any

from course_kit.ros2.completion import names_of, type_of
from course_kit.ros2.servers import outcome, wait_for_server
from course_kit.ros2.session import Session
from course_kit.ros2.verbs import CommandError, Verb, add_flag, add_offered

if TYPE_CHECKING:
    from rclpy.node import Node

SAME_INTERRUPT = 0.5  # seconds: a shell may pass one Ctrl-C on twice, to the process and to its group
STATUSES = {1: "ACCEPTED", 2: "EXECUTING", 3: "CANCELING", 4: "SUCCEEDED", 5: "CANCELED", 6: "ABORTED"}


def _arguments(parser: ArgumentParser) -> None:
    add_offered(parser, "action_name", names_of("action"), "Name of the ROS action (e.g. '/fibonacci')")
    add_offered(
        parser, "action_type", type_of("action"), "Type of the ROS action (e.g. 'example_interfaces/action/Fibonacci')"
    )
    group = parser.add_mutually_exclusive_group()
    group.add_argument("goal", nargs="?", default="{}", help="Goal request values in YAML format (e.g. '{order: 10}')")
    add_flag(group, "--stdin", "Read goal from standard input")
    add_flag(parser, "-f --feedback", "Echo feedback messages for the goal")


def _run(args: Namespace, session: Session) -> None:
    from rclpy.action import ActionClient

    from course_kit.ros2.messages.arguments import checked_name, filled, interface_class, parsed
    from course_kit.ros2.messages.values import stamp

    kind = interface_class(args.action_type, "action")
    goal = kind.Goal()
    times = filled(goal, parsed(args, args.goal), "Failed to populate message fields: {!r}")
    name = checked_name(args.action_name, "action")
    with _spun_node(session) as node:
        try:
            client = ActionClient(node, kind, name)
        except Exception as error:  # rclpy has several for what the middleware refuses
            raise CommandError(" ".join(str(error).split())) from None
        session.print("Waiting for an action server to become available...")
        full_name = "/" + args.action_name.removeprefix("/")
        wait_for_server(session, client.server_is_ready, full_name, args.action_type, _offered)
        stamp(times, *node.get_clock().now().seconds_nanoseconds())
        _Goal(session, client, args.action_name, args.feedback).send(goal)


@contextmanager
def _spun_node(session: Session) -> Iterator[Node]:
    """A node for one action client: the instruments' executor is none for them, see spinning.executor_for()."""
    from rclpy.executors import SingleThreadedExecutor

    from course_kit.spinning import action_answers, errors
    from course_kit.spinning.executors import SpinThread
    from course_kit.spinning.nodes import quiet_node

    action_answers.keep()  # sent from this thread, answered in another
    name = f"{session.node.get_name()}_goal"
    node = quiet_node(name, session.node.context)
    executor = SingleThreadedExecutor(context=node.context)
    thread = SpinThread(node, lambda error: errors.report(name, error), executor).start()
    try:
        yield node
    finally:
        thread.close()


def _offered(node: Node) -> dict[str, list[str]]:
    from course_kit.ros_graph import graph

    actions = graph.actions(node).items()
    return {name: types for name, types in actions if node.count_publishers(f"{name}/_action/status")}


class _Goal:
    """The way of one goal."""

    def __init__(self, session: Session, client: Any, action: str, with_feedback: bool) -> None:
        self._session = session
        self._client = client
        self._action = action
        self._with_feedback = with_feedback
        self._is_accepted = False
        self._feedback: SimpleQueue[Any] = SimpleQueue()

    def send(self, goal: Any) -> None:
        from course_kit.ros2.messages.yaml_text import to_yaml

        say = self._session.print
        say(f"Sending goal:\n     {to_yaml(goal)}")
        callback = self._feedback.put if self._with_feedback else None
        handle = self._outcome(self._client.send_goal_async(goal, callback), "sending goal")
        if not handle.accepted:
            say("Goal was rejected.")
            return
        coming = handle.get_result_async()
        with _Interrupt() as interrupt:
            self._is_accepted = True
            say(f"Goal accepted with ID: {bytes(handle.goal_id.uuid).hex()}\n")
            result = self._outcome(coming, "getting result", interrupt.has_come)
            if result is None:
                self._cancel(handle)
                result = self._outcome(coming, "getting result")
        say(f"Result:\n    {to_yaml(result.result)}")
        say(f"Goal finished with status: {STATUSES.get(result.status, 'UNKNOWN')}")

    def _cancel(self, handle: Any) -> None:
        self._session.print("Canceling goal...")
        response = self._outcome(handle.cancel_goal_async(), "canceling goal")
        if len(response.goals_canceling) == 0:
            raise CommandError("Failed to cancel goal")
        if len(response.goals_canceling) > 1:
            raise CommandError("More than one goal canceled")
        if response.goals_canceling[0].goal_id != handle.goal_id:
            raise CommandError("Canceled goal with incorrect goal ID")
        self._session.print("Goal canceled.")

    def _outcome(self, future: Any, doing: str, stops: Callable[[], bool] = lambda: False) -> Any:
        """What a future brings, with the feedback that comes meanwhile; None if it stops before."""
        from course_kit.ros2.messages.yaml_text import to_yaml

        def stops_after_feedback() -> bool:
            while self._is_accepted and not self._feedback.empty():
                self._session.print(f"Feedback:\n    {to_yaml(self._feedback.get().feedback)}")
            return stops()

        lost = f"the server of '{self._action}' ended"
        return outcome(self._session, future, self._client.server_is_ready, doing, lost, stops_after_feedback)


class _Interrupt:
    """Notes the first interrupt while the block runs; a later one is raised, unless it is the same once more."""

    def __init__(self) -> None:
        self._came: float | None = None

    def has_come(self) -> bool:
        return self._came is not None

    def _note(self, number: int, frame: FrameType | None) -> None:
        if self._came is None:
            self._came = time.monotonic()
        elif time.monotonic() - self._came > SAME_INTERRUPT:
            raise KeyboardInterrupt

    def __enter__(self) -> _Interrupt:
        self._before = signal.signal(signal.SIGINT, self._note)
        return self

    def __exit__(self, *_: object) -> None:
        signal.signal(signal.SIGINT, self._before)


SEND_GOAL = Verb("Send an action goal", _run, _arguments)
