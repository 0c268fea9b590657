"""What the nodes of this domain log, as it arrives over /rosout, and the errors of callbacks among it."""

from __future__ import annotations

import html
import threading
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from datetime import datetime
from typing import Any

from rcl_interfaces.msg import Log
from rclpy.serialization import deserialize_message

from course_kit import errors, instruments

LEVELS = {10: "DEBUG", 20: "INFO", 30: "WARN", 40: "ERROR", 50: "FATAL"}
KEPT = 5000


@dataclass(frozen=True)
class LogLine:
    """One line that a node logged."""

    when: float  # seconds since the epoch, by the node's clock
    level: int
    node: str  # fully qualified
    text: str

    @property
    def level_name(self) -> str:
        return LEVELS.get(self.level, str(self.level))

    def __str__(self) -> str:
        time = datetime.fromtimestamp(self.when).strftime("%H:%M:%S.%f")[:-3]
        return f"{time} [{self.level_name}] [{self.node}] {self.text}"


_lines: deque[LogLine] = deque(maxlen=KEPT)
_listeners: list[Callable[[LogLine], None]] = []
_lock = threading.Lock()
_subscription: Any = None


def listen(listener: Callable[[LogLine], None]) -> None:
    """Have `listener` called, in the instruments' thread, for each line from now on."""
    if listener not in _listeners:
        _listeners.append(listener)


def collect() -> None:
    """Subscribe to /rosout, if that is not done yet: called before the first node starts, so no line is missed."""
    global _subscription
    if _subscription is None or _subscription.closed.is_set():
        _subscription = instruments.subscribe("/rosout", _receive, "rcl_interfaces/msg/Log")


def _receive(serialised: bytes, _info: Any) -> None:
    message = deserialize_message(serialised, Log)
    when = message.stamp.sec + message.stamp.nanosec * 1e-9
    # A logger's name separates namespaces by dots; a child logger counts as its node's.
    line = LogLine(when, message.level, "/" + message.name.replace(".", "/"), message.msg)
    if _repeats_an_error(line):
        return
    with _lock:
        _lines.append(line)
    for listener in list(_listeners):
        listener(line)


def _repeats_an_error(line: LogLine) -> bool:
    """Whether rclpy's EventsExecutor logs an exception here that is reported as a CallbackError already."""
    marks = {50: "Exception in '", 30: "Error occurred at:"}
    return line.node in errors.reporting and line.text.startswith(marks.get(line.level, "\0"))


class LogLines(list[LogLine]):
    """Log lines that show as text, and in a notebook in colour."""

    def __repr__(self) -> str:
        return "\n".join(map(str, self)) or "(no log lines)"

    def _repr_html_(self) -> str:
        return f"<pre class='course-kit-logs'>{''.join(html_line(line) for line in self) or '(no log lines)'}</pre>"


COLOURS = {"WARN": "#b58900", "ERROR": "#dc322f", "FATAL": "#dc322f", "DEBUG": "#808080"}


def html_line(line: LogLine) -> str:
    """A log line as HTML, its colour readable on light and on dark ground."""
    colour = COLOURS.get(line.level_name)
    style = f" style='color:{colour}'" if colour else ""
    return f"<span{style}>{html.escape(str(line))}</span>\n"


def logs(node: str | None = None, level: str = "INFO", last: int = 20) -> LogLines:
    """The last log lines of every node of this domain, or of one; errors of callbacks are among them.

    `level` is the lowest shown: DEBUG, INFO, WARN, ERROR or FATAL. Raises ValueError for another word.
    """
    lowest = {name: number for number, name in LEVELS.items()}.get(level.upper())
    if lowest is None:
        raise ValueError(f"there is no log level {level!r}: a node logs DEBUG, INFO, WARN, ERROR or FATAL")
    collect()
    with _lock:
        lines = list(_lines)
    lines += [LogLine(e.when, 40, e.node, str(e)) for e in errors.errors()]
    if node is not None:
        wanted = "/" + node.strip("/")
        lines = [line for line in lines if line.node == wanted or line.node.startswith(wanted + "/")]
    return LogLines([line for line in sorted(lines, key=lambda one: one.when) if line.level >= lowest][-last:])
