"""Private parts of rclpy's actions: the futures that a client awaits, and how goals are executed.

`rclpy.action` is loaded only where an action is already in use: it brings numpy, a tenth of a second of each start.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Any

from rclpy.node import Node
from rclpy.task import Future

from course_kit.ros.private_api import expect
from course_kit.ros.private_api.rclpy_parts import replace

if TYPE_CHECKING:
    from rclpy.action import ActionClient


def awaited_of(action: ActionClient) -> Iterator[tuple[Future, str, bytes]]:
    """What an action client waits for: each future, what it brings, and the id of the goal whose result that is."""
    requests = ("_pending_goal_requests", "_pending_cancel_requests", "_pending_result_requests")
    expect("rclpy", action, *requests, "_result_sequence_number_to_goal_id")
    goals, cancels, results = (dict(getattr(action, name)) for name in requests)
    yield from ((future, "the answer to the goal", b"") for future in goals.values())
    yield from ((future, "the answer to the cancel request", b"") for future in cancels.values())
    for number, future in results.items():
        goal = action._result_sequence_number_to_goal_id.get(number)
        yield future, "the result", b"" if goal is None else bytes(goal.uuid)


def blocks(action: Any) -> bool:
    """Return True if it is an action server that keeps a thread for as long as a goal runs."""
    execute = getattr(action, "_execute_callback", None)
    return execute is not None and not inspect.iscoroutinefunction(execute)


def report_executions(report: Callable[[Node, Exception], None]) -> None:
    """Have what an execute callback of an action server raises reported as that of other callbacks is.

    rclpy logs its text, and prints a traceback of its own frames; the text is logged all the same.
    """
    from rclpy.action import server as action_server

    def guard_of(plain: Callable[..., Any]) -> Callable[..., Any]:
        async def await_or_execute(callback: Callable[..., Any], *args: Any) -> Any:
            server = getattr(args[0], "_action_server", None) if args else None
            if server is None or callback != server._execute_callback:
                return await plain(callback, *args)
            try:
                return await plain(callback, *args)
            except Exception as error:
                report(server._node, error)
                server._logger.error(f"Error raised in execute callback: {error}")
                return server._action_type.Result()

        return await_or_execute

    expect("rclpy", action_server.ServerGoalHandle, "publish_feedback")
    replace(action_server, "await_or_execute", guard_of)
