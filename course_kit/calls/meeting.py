"""A new action client and its server, until the server has found the client: before, its answers are lost."""

from __future__ import annotations

import os
from collections.abc import Callable
from typing import Any

from rclpy.action.client import ClientGoalHandle
from unique_identifier_msgs.msg import UUID  # type: ignore[import-untyped]

MEET_TIMEOUT = 2.0  # seconds after which a server counts as busy
PERIOD = 0.5  # seconds from one request to the next while no answer comes


def meet_server(client: Any, until: Callable[[Callable[[], Any], float], Any]) -> bool:
    """Ask for the result of a goal that nobody has sent, until it is answered; False if the server is too busy for it.

    The server answers at once that it does not know the goal, and what a process makes is announced in order: so it
    knows what answers to a goal come to as well. `until(condition, timeout)` waits in seconds, and tells whether it
    holds. The client is ready, and spins elsewhere.
    """
    unknown = ClientGoalHandle(client, UUID(uuid=list(os.urandom(16))), None)
    answers: list[Any] = []
    for _ in range(round(MEET_TIMEOUT / PERIOD)):
        unknown.get_result_async().add_done_callback(answers.append)
        if until(lambda: answers, PERIOD):
            return True
    return False
