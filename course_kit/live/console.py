"""A small console under the cell that started a node: its state, its last log lines, its callbacks' errors."""

from __future__ import annotations

import html
import threading
from collections import deque
from collections.abc import Iterable

from course_kit import kernel
from course_kit.background import running
from course_kit.live.life import Shown
from course_kit.node_logs import rosout
from course_kit.spinning import context, errors
from course_kit.text import stands_still

LAST_LINES = 8
# Seconds between two updates of a console: a node may log a thousand times a second.
PERIOD = 0.25
SIGNS = {"running": "▶", "stopped": "■", "ended": "■", "failed": "✘"}


class Console:
    """What stands under the cell that has started something, and changes."""

    def __init__(self, earlier: Console | None) -> None:
        """It takes the place of an `earlier` one of the same cell, which runs it again, in a loop for instance."""
        self.cell = kernel.cell()
        if earlier is not None and earlier.cell == self.cell:
            _changed.discard(earlier)
            self._shown: Shown = earlier._shown
            refresh(self)
        else:
            self._shown = Shown(self.bundle())

    def bundle(self) -> dict[str, str]:
        """It as plain text and as HTML."""
        raise NotImplementedError

    def update(self) -> None:
        """Show the present state in the cell where it stands."""
        try:
            self._shown.update(self.bundle())
        except Exception as error:  # there is no other place where it could be seen
            self._shown.update({"text/plain": stands_still("This", error)})


def bundle(name: str, state: str, lines: Iterable[tuple[str, str]]) -> dict[str, str]:
    """A console: what it is of, how that goes, and lines, each as text and as HTML."""
    head = f"{SIGNS[state.split()[0]]} {name} {state}"
    text, page = zip((head, f"<b>{html.escape(head)}</b>\n"), *lines, strict=True)
    return {
        "text/plain": "\n".join(text),
        "text/html": f"<pre class='course-kit-console' style='margin:0'>{''.join(page)}</pre>",
    }


class NodeConsole(Console):
    """What is shown for one node."""

    def __init__(self, name: str, earlier: NodeConsole | None) -> None:
        self.name = name
        self.state = "running"
        self.lines: deque[rosout.LogLine] = deque(maxlen=LAST_LINES)
        super().__init__(earlier)

    def bundle(self) -> dict[str, str]:
        """The last lines that it has logged, and what its callbacks have raised."""
        lines = [(f"  {line}", rosout.html_line(line)) for line in self.lines]
        for error in errors.errors(self.name)[-2:]:
            lines.append((f"✘ {error}", f"<span style='color:#dc322f'>✘ {html.escape(str(error))}</span>\n"))
        return bundle(self.name, self.state, lines)


_consoles: dict[str, NodeConsole] = {}
_changed: set[Console] = set()
_wake = threading.Event()
_ending = threading.Event()
_updater: threading.Thread | None = None


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
        if event != "running":
            _mark(name)


def _on_error(error: errors.CallbackError) -> None:
    _mark(error.node)


def _on_line(line: rosout.LogLine) -> None:
    if line.node in _consoles:
        _consoles[line.node].lines.append(line)
        _mark(line.node)


def _mark(name: str) -> None:
    if name in _consoles:
        refresh(_consoles[name])


def refresh(console: Console) -> None:
    """Have a console updated soon."""
    global _updater
    _changed.add(console)
    _wake.set()
    if _updater is None or not _updater.is_alive():
        _ending.clear()
        _updater = threading.Thread(target=_keep_updated, name="course_kit consoles", daemon=True)
        _updater.start()


def _keep_updated() -> None:
    while not _ending.is_set():
        _wake.wait()
        _wake.clear()
        while _changed:
            _changed.pop().update()
        _ending.wait(PERIOD)


def _end() -> None:
    _ending.set()
    _wake.set()
    if _updater is not None:
        _updater.join(1.0)
