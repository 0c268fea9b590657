"""The log lines of this domain as they arrive over /rosout, and the errors of callbacks among them."""

from __future__ import annotations

import html
import threading
import time
from collections import Counter, deque
from collections.abc import Callable
from dataclasses import dataclass
from datetime import datetime
from typing import Any

from rcl_interfaces.msg import Log
from rclpy.serialization import deserialize_message

from course_kit.base import inks
from course_kit.base.arguments import COUNT, NODE, SPAN, TEXT, takes
from course_kit.base.text import table
from course_kit.ros.spinning import errors
from course_kit.ros.subscriptions import observer_node

LEVELS = {10: "DEBUG", 20: "INFO", 30: "WARN", 40: "ERROR", 50: "FATAL"}
NUMBERS = {name: number for number, name in LEVELS.items()} | {"WARNING": 30}
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
        """DEBUG, INFO, WARN, ERROR or FATAL."""
        return LEVELS.get(self.level, str(self.level))

    def __str__(self) -> str:
        clock = datetime.fromtimestamp(self.when).strftime("%H:%M:%S.%f")[:-3]
        return f"{clock} [{self.level_name}] [{self.node}] {self.text}"


_lines: deque[LogLine] = deque(maxlen=KEPT)
listeners: set[Callable[[LogLine], None]] = set()  # called, in the instruments' thread, with each line
_lock = threading.Lock()
_subscription: Any = None


def collect() -> None:
    """Subscribe to /rosout, if that is not done yet: called before the first node starts, so no line is missed."""
    global _subscription
    if _subscription is None or _subscription.closed.is_set() or observer_node.present() is None:
        _subscription = observer_node.subscribe("/rosout", _receive, "rcl_interfaces/msg/Log")


def line_of(message: Log) -> LogLine:
    """The line in a message of /rosout."""
    when = message.stamp.sec + message.stamp.nanosec * 1e-9
    # A logger's name separates namespaces by dots; a child logger counts as its node's.
    return LogLine(when, message.level, "/" + message.name.replace(".", "/"), message.msg)


def _receive(serialised: bytes, _info: Any) -> None:
    line = line_of(deserialize_message(serialised, Log))
    if _repeats_an_error(line):
        return
    with _lock:
        _lines.append(line)
    for listener in list(listeners):
        listener(line)


def _repeats_an_error(line: LogLine) -> bool:
    """Return True if rclpy's EventsExecutor logs an exception here that is reported as a CallbackError already."""
    marks = {50: "Exception in '", 30: "Error occurred at:"}
    return line.node in errors.reporting and line.text.startswith(marks.get(line.level, "\0"))


class LogLines(list[LogLine]):
    """Log lines that show as text, and in a notebook in colour."""

    def __repr__(self) -> str:
        return "\n".join(map(str, self)) or "(no log lines)"

    def _repr_html_(self) -> str:
        return f"<pre class='course-kit-logs'>{''.join(html_line(line) for line in self) or '(no log lines)'}</pre>"


COLOURS = {"WARN": inks.CAUTION, "ERROR": inks.BAD, "FATAL": inks.BAD, "DEBUG": inks.FAINT}


def html_line(line: LogLine) -> str:
    """A log line as HTML, its colour readable on light and on dark ground."""
    colour = COLOURS.get(line.level_name)
    style = f" style='color:{colour}'" if colour else ""
    return f"<span{style}>{html.escape(str(line))}</span>\n"


def level_number(level: str) -> int:
    """The number of a level: 10 for DEBUG to 50 for FATAL. ValueError for another word."""
    word = str(level).upper()
    if word not in NUMBERS:
        raise ValueError(f"there is no log level {level!r}: a node logs DEBUG, INFO, WARN, ERROR or FATAL")
    return NUMBERS[word]


def is_of(line: LogLine, node: str) -> bool:
    """Return True if a line is of a node, given by its name, or of one in that namespace."""
    wanted = "/" + node.strip("/")
    return line.node == wanted or line.node.startswith(wanted.rstrip("/") + "/")


@takes(node=NODE | None, level=TEXT, last=COUNT, text=TEXT)
def logs(node: str | None = None, level: str = "INFO", last: int = 20, text: str = "") -> LogLines:
    """The last log lines of every node of this domain, or of one; errors of callbacks are among them.

    `level` is the lowest shown: DEBUG, INFO, WARN, ERROR or FATAL. Raises ValueError for another word. With `text`
    only lines that contain it, in small or capital letters.
    """
    lowest = level_number(level)
    collect()
    with _lock:
        lines = list(_lines)
    lines += [LogLine(e.when, 40, e.node, str(e)) for e in errors.errors()]
    lines = [line for line in lines if line.level >= lowest and text.lower() in line.text.lower()]
    if node is not None:
        lines = [line for line in lines if is_of(line, node)]
    return LogLines(sorted(lines, key=lambda one: one.when)[-last:])


class LogRates(dict[str, tuple[float, dict[str, int]]]):
    """Lines a second, and lines by level, of each node that logged: `log_rates()['/talker'][0]` is one number."""

    def rows(self) -> list[tuple[str, ...]]:
        """A table: headings, then a row a node."""
        rows: list[tuple[str, ...]] = [("node", "lines/s", *LEVELS.values())]
        for node, (rate, counts) in sorted(self.items(), key=lambda item: -item[1][0]):
            rows.append((node, f"{rate:.1f}", *(f"{counts.get(level, 0):,}" for level in LEVELS.values())))
        return rows

    def __repr__(self) -> str:
        return table(self.rows()) if self else "(no node has logged anything lately)"


@takes(seconds=SPAN)
def log_rates(seconds: float = 5.0) -> LogRates:
    """How much each node logged in the last `seconds`: lines a second, and how many of each level."""
    now = time.time()
    collect()
    with _lock:
        lines = list(_lines)
    if len(lines) == KEPT:  # what came before is not known any more
        seconds = min(seconds, max(now - lines[0].when, 1e-3))
    counts: dict[str, Counter[str]] = {}
    for line in lines:
        if now - seconds <= line.when <= now + seconds:
            counts.setdefault(line.node, Counter())[line.level_name] += 1
    return LogRates({node: (sum(found.values()) / seconds, dict(found)) for node, found in counts.items()})
