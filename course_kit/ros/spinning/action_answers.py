"""Has action clients keep an answer that comes before they have noted their request down, and tell of feedback."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Any

from rclpy.action import ActionClient

from course_kit.ros.private_api import going_on_without, rclpy_parts

# An action client sends a request first and notes it down then. Where a cell sends and another thread spins, the answer
# can come in between: it is dropped as unexpected, and the future stays open for ever. A Client has a lock against it.
_sends = threading.RLock()
# What is called with the id of a goal and its feedback, whether its client has a callback for it or not.
feedback_listeners: set[Callable[[bytes, Any], None]] = set()


def keep() -> None:
    """Have the action clients of this process lose no answer; once is enough. A kernel begins with it."""
    with going_on_without("an answer to an action client can be lost where a cell asks"):
        for request in ("send_goal_async", "_cancel_goal_async", "_get_result_async"):
            rclpy_parts.replace(ActionClient, request, _sending)
        rclpy_parts.replace(ActionClient, "execute", _after_sending)


def _sending(request: Callable[..., Any]) -> Callable[..., Any]:
    """A request of an action client, during which no answer is looked at."""

    def guarded(self: ActionClient, *args: Any, **kwargs: Any) -> Any:
        with _sends:
            return request(self, *args, **kwargs)

    return guarded


def _after_sending(execute: Callable[..., Any]) -> Callable[..., Any]:
    """ActionClient.execute(), after what is being sent; listeners hear of feedback."""

    async def guarded(self: ActionClient, taken_data: Any) -> None:
        with _sends:
            pass
        if feedback := taken_data.get("feedback"):
            for listener in list(feedback_listeners):
                listener(bytes(feedback.goal_id.uuid), feedback.feedback)
        await execute(self, taken_data)

    return guarded
