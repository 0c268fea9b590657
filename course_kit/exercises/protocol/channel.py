"""JSON messages over a connection, both ways: what the notebook and the checker say to each other. Pure: no ROS."""

from __future__ import annotations

import json
import math
import os
import threading
from collections import deque
from collections.abc import Mapping, Sequence, Set, ValuesView
from multiprocessing.connection import Connection
from typing import Any

Message = dict[str, Any]
LONGEST = 10_000_000  # bytes of one message: a student's value, however big, must not fill the memory


class Closed(Exception):  # noqa: N818  (reads as what happened)
    """The other side has gone."""


class TooLong(ValueError):  # noqa: N818
    """A message is longer than the other side would take."""


class Channel:
    """One end of the connection. Any thread sends, one thread receives."""

    def __init__(self, end: Connection) -> None:
        self._end = end
        self._lock = threading.Lock()

    def send(self, message: Message) -> None:
        """Send one message. Raises Closed if nobody is there to receive it, TooLong for what nobody would take."""
        data = json.dumps(message).encode()
        if len(data) > LONGEST:
            raise TooLong(
                f"it is {len(data) / 1e6:.0f} MB long as text, and a check takes {LONGEST / 1e6:.0f} MB at most"
            )
        with self._lock:
            try:
                self._end.send_bytes(data)
            except OSError:
                raise Closed from None

    def receive(self, timeout: float | None = None) -> Message | None:
        """The next message; None if none has begun to come after `timeout` seconds. Raises Closed at the end."""
        try:
            if not self._end.poll(timeout):
                return None
            message = json.loads(self._end.recv_bytes(LONGEST))
        except (EOFError, OSError, ValueError):
            raise Closed from None
        return message if isinstance(message, dict) else {}

    def close(self) -> None:
        """End the connection; the other side's next receive() raises Closed."""
        self._end.close()


def as_json(value: Any) -> Any:
    """A student's value as JSON has it: sets become sorted lists, arrays lists, paths texts, messages their fields.

    Raises TypeError for what has no such form, with its type.
    """
    if hasattr(value, "tolist"):  # numpy's numbers, some of which are Python's too, and arrays; the standard library's
        value = value.tolist()
    if value is None or isinstance(value, bool):
        return value
    if isinstance(value, int | str):
        return str(value) if isinstance(value, str) else int(value)
    if isinstance(value, float):
        return float(value) if math.isfinite(value) else str(value)
    if isinstance(value, os.PathLike):
        return str(os.fspath(value))
    if isinstance(value, Mapping):
        return {str(key): as_json(each) for key, each in value.items()}
    if isinstance(value, Set):
        return sorted((as_json(each) for each in value), key=str)
    if isinstance(value, Sequence | ValuesView | deque) and not isinstance(value, bytes | bytearray | memoryview):
        return [as_json(each) for each in value]
    if hasattr(value, "get_fields_and_field_types"):
        return {name: as_json(getattr(value, name)) for name in value.get_fields_and_field_types()}
    raise TypeError(
        f"{type(value).__name__} is no plain value: give numbers, texts, lists, sets or dictionaries of them"
    )
