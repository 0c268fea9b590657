"""A small console under the cell that started a node: its state, its last log lines, its callbacks' errors."""

from __future__ import annotations

import contextlib
import html
import math
import threading
import time
from collections import deque
from collections.abc import Iterable

from course_kit.base import inks, kernel
from course_kit.base.text import stands_still
from course_kit.lab.background import running
from course_kit.lab.node_logs import rosout
from course_kit.ros.causes import cause_of_line
from course_kit.ros.spinning import context, errors
from course_kit.views.live import tabs
from course_kit.views.live.shown import Bundle, Shown

LAST_LINES = 8
STYLE = "margin:0;white-space:pre-wrap;word-break:normal;overflow-wrap:break-word"  # sentences wrap between words
# Seconds between two updates of a console: a node may log a thousand times a second.
PERIOD = 0.25
LOOK = 1.0  # seconds between two looks at what is to be said of nodes that run
SIGNS = {"running": "▶", "stopped": "■", "ended": "■", "failed": "✘", "stuck": "✘"}


class Console:
    """What stands under the cell that has started something, and changes."""

    def __init__(self, earlier: Console | None) -> None:
        """It takes the place of an `earlier` one of the same cell, which runs it again, in a loop for instance."""
        self.cell = kernel.cell()
        if earlier is not None:
            _changed.discard(earlier)
        if earlier is not None and earlier.cell == self.cell:
            self._shown: Shown = earlier._shown
            refresh(self)
        else:
            if earlier is not None:  # what comes from now on stands here
                earlier._shown.end(earlier.bundle())
            self._shown = Shown("console", self.bundle())

    def bundle(self) -> Bundle:
        """It as plain text and as HTML."""
        raise NotImplementedError

    def update(self) -> None:
        """Show the present state in the cell where it stands."""
        try:
            self._shown.update(self.bundle())
        except Exception as error:  # there is no other place where it could be seen
            self._shown.update({"text/plain": stands_still("This", error)})


def bundle(name: str, state: str, lines: Iterable[tuple[str, str]]) -> Bundle:
    """A console: what it is of, how that goes, and lines, each as text and as HTML."""
    head = f"{SIGNS[state.split()[0]]} {name} {state}"
    text, page = zip((head, f"<b class='course-kit-state'>{html.escape(head)}</b>\n"), *lines, strict=True)
    return {
        "text/plain": "\n".join(text),
        "text/html": f"<pre class='course-kit-console' style='{STYLE}'>{''.join(page)}</pre>",
    }


class NodeConsole(Console):
    """What is shown for one node."""

    def __init__(self, name: str, earlier: NodeConsole | None) -> None:
        self.name = name
        self.state = "running"
        self.ended = math.inf  # when, in seconds since the epoch
        self.lines: deque[rosout.LogLine] = deque(maxlen=LAST_LINES)
        self.remarks: list[str] = []
        self._next_look = 0.0
        super().__init__(earlier)

    def bundle(self) -> Bundle:
        """The last lines that it has logged, what its callbacks have raised, and what else is to be said."""
        lines = [(f"  {line}", rosout.html_line(line)) for line in self.lines]
        raised = errors.errors(self.name)[-2:]
        if not raised and (cause := next(filter(None, (cause_of_line(line.text) for line in self.lines)), "")):
            lines.append((f"  → {cause}", f"  → {html.escape(cause)}\n"))
        for error in raised:
            lines.append((f"✘ {error}", f"<span style='color:{inks.BAD}'>✘ {html.escape(str(error))}</span>\n"))
        remarks = self.remarks if self.is_looked_after else []
        lines += [(f"⚠ {remark}", f"⚠ {html.escape(remark)}\n") for remark in remarks]
        return bundle(self.name, self.state, lines)

    @property
    def is_looked_after(self) -> bool:
        """True if there may be something to be said of it."""
        return self.state.startswith(("running", "stuck"))

    def look(self) -> None:
        """Look at what is to be said of it now."""
        if time.monotonic() < self._next_look:
            return
        self._next_look = time.monotonic() + LOOK
        before = (self.state, self.remarks)
        self.remarks = running.remarks(self.name) if self.is_looked_after else []
        if self.state.startswith("stuck") and not self.remarks:
            self.state = "stopped"  # the callback has returned
        if (self.state, self.remarks) != before:
            _changed.add(self)


_consoles: dict[str, NodeConsole] = {}
_changed: set[Console] = set()
_wake = threading.Event()
_ending = threading.Event()
_updater: threading.Thread | None = None
_beginning = threading.Lock()  # a cell begins it, or a line of a log, and there is one


def attach() -> None:
    """Show a console for each node that runs from now on."""
    running.listeners.add(_on_event)
    errors.listeners.add(_on_error)
    rosout.listeners.add(_on_line)
    context.before_stop(_end)


def _on_event(event: str, name: str) -> None:
    if event == "starting":
        _consoles[name] = NodeConsole(name, _consoles.get(name))
    elif name in _consoles:
        _consoles[name].state = event
        _begin_updates()
        if event != "running":
            _consoles[name].ended = time.time()
            _mark(name)


def _on_error(error: errors.CallbackError) -> None:
    _mark(error.node)


def _on_line(line: rosout.LogLine) -> None:
    # What a child logger says, such as that of an action server, is its node's.
    console = _consoles.get(line.node) or _consoles.get(line.node.rpartition("/")[0])
    if console is not None and line.when <= console.ended:  # a later one is of another node of that name
        console.lines.append(line)
        _mark(console.name)


def _mark(name: str) -> None:
    if name in _consoles:
        refresh(_consoles[name])


def refresh(console: Console) -> None:
    """Have a console updated soon."""
    _changed.add(console)
    _begin_updates()


def _begin_updates() -> None:
    global _updater
    _wake.set()
    with _beginning:
        if _updater is None or not _updater.is_alive():
            _ending.clear()
            _updater = threading.Thread(target=_keep_updated, name="course_kit consoles", daemon=True)
            _updater.start()


def _keep_updated() -> None:
    while not _ending.is_set():
        _wake.wait(LOOK if any(one.is_looked_after for one in list(_consoles.values())) else None)
        _wake.clear()
        for console in list(_consoles.values()):
            with contextlib.suppress(Exception):  # ROS may end meanwhile
                console.look()
        while _changed and tabs.somebody_looks():
            _changed.pop().update()
        _ending.wait(PERIOD)
        if _changed:  # nobody looked
            _wake.set()


def _end() -> None:
    _ending.set()
    _wake.set()
    with _beginning:
        updater = _updater
    if updater is not None:
        updater.join(1.0)
