"""The notebook's process as the checker sees it: it gets orders, and answers each, or does not in time."""

from __future__ import annotations

import contextlib
import itertools
import queue
import time
from typing import Any

from course_kit.exercises.protocol.channel import Channel, Message

SPARE = 1.0  # seconds: the notebook answers in time even if the student's code, which it runs, does not return


class Notebook:
    """The other end of a channel. One thread gives orders, another passes the answers on that it receives."""

    def __init__(self, channel: Channel) -> None:
        self._channel = channel
        self._answers: queue.Queue[Message] = queue.Queue()
        self._numbers = itertools.count(1)

    def take(self, answer: Message) -> None:
        """Pass an answer on to the thread that waits for it."""
        self._answers.put(answer)

    def order(self, do: str, domain: int, timeout: float, **details: Any) -> dict[str, Any]:
        """Have the notebook do something in a domain; return its answer, which has a `value` or an `error`.

        It has `timeout` seconds for that. Raises Closed if it has gone.
        """
        number = next(self._numbers)
        self._channel.send({"order": number, "do": do, "domain": domain, "timeout": timeout, **details})
        deadline = time.monotonic() + timeout + SPARE
        while (left := deadline - time.monotonic()) > 0:
            with contextlib.suppress(queue.Empty):
                answer = self._answers.get(timeout=left)
                if answer["answer"] == number:
                    return answer
        return {"error": "it did not return in time"}
