"""`ros2 action send_goal`: one goal, its feedback and its result; an interrupt cancels the goal."""

from __future__ import annotations

import signal
import time
from argparse import Namespace
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from queue import SimpleQueue
from types import FrameType
from typing import Any

from course_kit.base.shutdown import watchdog
from course_kit.cli.ros2.completion import fields_of
from course_kit.cli.ros2.named import ACTIONS
from course_kit.cli.ros2.servers import ANSWER_TIMEOUT, outcome, wait_for_server
from course_kit.cli.ros2.session import Session, handling
from course_kit.cli.ros2.verbs import CommandError, Verb, failing, flag, one_line, yaml_values
from course_kit.lab.calls.goals import STATES

SAME_INTERRUPT = 0.5  # seconds: a shell may pass one Ctrl-C on twice, to the process and to its group


def _run(args: Namespace, session: Session) -> None:
    session.join()
    from rclpy.action import ActionClient

    from course_kit.cli.ros2.messages.arguments import checked_name, filled, interface_class, parsed
    from course_kit.cli.ros2.messages.values import stamp
    from course_kit.ros.spinning import action_answers
    from course_kit.ros.subscriptions.clients import meet_server

    kind = interface_class(args.action_type, "action")
    goal = kind.Goal()
    times = filled(goal, parsed(args, args.goal), "Failed to populate message fields: {!r}")
    name = checked_name(args.action_name, "action")
    action_answers.keep()  # sent from this thread, answered in another
    with session.own_node(f"{session.node.get_name()}_goal") as node:

        def count_servers(action: str) -> int:
            return node.count_publishers(f"{action}/_action/status")

        with failing(Exception, say=one_line):  # rclpy has several for what the middleware refuses
            client = ActionClient(node, kind, name)
        session.print("Waiting for an action server to become available...")
        full_name = "/" + name.removeprefix("/")
        wait_for_server(session, "action", full_name, args.action_type, client.server_is_ready, count_servers)
        meet_server(client, session.until)
        stamp(times, *node.get_clock().now().seconds_nanoseconds())
        _follow(session, args, client, goal)


def _follow(session: Session, args: Namespace, client: Any, goal: Any) -> None:
    """Send a goal and follow it to its end."""
    from course_kit.cli.ros2.messages.yaml_text import to_yaml

    feedback: SimpleQueue[Any] = SimpleQueue()
    lost = f"the server of '{args.action_name}' ended"

    def outcome_of(future: Any, doing: str, stops: Callable[[], bool] = lambda: False) -> Any:
        """What a future brings, with the feedback that comes meanwhile; None if it stops before."""

        def stops_after_feedback() -> bool:
            while not feedback.empty():
                session.print(f"Feedback:\n    {to_yaml(feedback.get().feedback)}")
            return stops()

        return outcome(session, future, client.server_is_ready, doing, lost, stops_after_feedback)

    session.print(f"Sending goal:\n     {to_yaml(goal)}")
    sending = client.send_goal_async(goal, feedback.put if args.feedback else None)
    handle = outcome(session, sending, client.server_is_ready, "sending goal", lost, timeout=ANSWER_TIMEOUT)
    if not handle.accepted:
        session.print("Goal was rejected.")
        return
    coming = handle.get_result_async()
    with _interrupt() as has_come:
        session.print(f"Goal accepted with ID: {bytes(handle.goal_id.uuid).hex()}\n")
        result = outcome_of(coming, "getting result", has_come)
        if result is None:
            session.print("Canceling goal...")
            _check_cancelled(handle, outcome_of(handle.cancel_goal_async(), "canceling goal").goals_canceling)
            session.print("Goal canceled.")
            result = outcome_of(coming, "getting result")
    session.print(f"Result:\n    {to_yaml(result.result)}")
    session.print(f"Goal finished with status: {STATES[result.status]}")


def _check_cancelled(handle: Any, cancelled: Any) -> None:
    if len(cancelled) == 0:
        raise CommandError("Failed to cancel goal")
    if len(cancelled) > 1:
        raise CommandError("More than one goal canceled")
    if cancelled[0].goal_id != handle.goal_id:
        raise CommandError("Canceled goal with incorrect goal ID")


@contextmanager
def _interrupt() -> Iterator[Callable[[], bool]]:
    """Return True if an interrupt came while the block ran; a second one is raised, unless it is the same again."""
    came: list[float] = []

    def note(number: int, frame: FrameType | None) -> None:
        watchdog.let_live()  # nothing holds this process, and the server may take its time to cancel
        came.append(time.monotonic())
        if came[-1] - came[0] > SAME_INTERRUPT:
            raise KeyboardInterrupt

    with handling(signal.SIGINT, note):
        yield lambda: bool(came)


SEND_GOAL = Verb(
    "send a goal to an action, and wait for its result",
    _run,
    ACTIONS.name,
    ACTIONS.typed("action_type"),
    yaml_values("goal", "{order: 10}", fields_of("action", "action_type")),
    flag("-f --feedback", "print the feedback, too"),
)
