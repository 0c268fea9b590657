"""Has action clients keep an answer that comes before they have noted their request down."""

from __future__ import annotations

import functools
import threading
from collections.abc import Callable
from typing import Any

from rclpy.action import ActionClient

# An action client sends a request first and notes it down then. Where a cell sends and another thread spins, the answer
# can come in between: it is dropped as unexpected, and the future stays open for ever. A Client has a lock against it.
_sends = threading.RLock()


def keep() -> None:
    """Have the action clients of this process lose no answer; once is enough. A kernel begins with it."""
    if ActionClient.execute is _execute:
        return
    for request in ("send_goal_async", "_cancel_goal_async", "_get_result_async"):
        setattr(ActionClient, request, _sending(getattr(ActionClient, request)))
    setattr(ActionClient, "execute", _execute)  # noqa: B010


def _sending(method: Callable[..., Any]) -> Callable[..., Any]:
    """A request of an action client, during which no answer is looked at."""

    @functools.wraps(method)
    def guarded(self: ActionClient, *args: Any, **kwargs: Any) -> Any:
        with _sends:
            return method(self, *args, **kwargs)

    return guarded


_plain_execute = ActionClient.execute


@functools.wraps(_plain_execute)
async def _execute(self: ActionClient, taken_data: Any) -> None:
    """ActionClient.execute(), after what is being sent."""
    with _sends:
        pass
    await _plain_execute(self, taken_data)
