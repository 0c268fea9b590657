"""The browser tabs that a notebook is open in: what this kernel still shows, and whether anybody looks.

JupyterLab's side is the course's extension (environment/prefix/share/jupyter/labextensions). Each tab opens a comm: it
is told which displays are live, and says from time to time that it is seen. Other front ends say nothing, and are
taken to look.
"""

from __future__ import annotations

import math
import threading
import time
from typing import Any

TARGET = "course_kit.views"
SILENT = 15.0  # seconds after which a tab that has said nothing is asleep or gone; one that looks speaks every 5

_lock = threading.Lock()
_live: set[str] = set()  # the displays that this kernel keeps up to date, by id
_looking: dict[Any, float] = {}  # by comm: until when its tab is taken to look, on the clock of time.monotonic()
_runs_cell = threading.Event()  # a kernel hears no tab while a cell runs


def attach(shell: Any) -> None:
    """Answer the tabs of this kernel's notebook from now on."""
    shell.kernel.comm_manager.register_target(TARGET, _on_open)
    shell.events.register("pre_run_cell", lambda *_: _runs_cell.set())
    shell.events.register("post_run_cell", lambda *_: _on_cell_end())


def begins(display: str) -> None:
    """A display is kept up to date from now on."""
    with _lock:
        _live.add(display)


def ends(display: str) -> None:
    """A display stays as it is from now on."""
    with _lock:
        _live.discard(display)


def somebody_looks() -> bool:
    """Return True if an update would be seen: not if each tab is hidden, closed, or asleep."""
    with _lock:
        now = -math.inf if _runs_cell.is_set() else time.monotonic()
        return not _looking or any(until > now for until in _looking.values())


def _on_open(comm: Any, message: Any) -> None:
    comm.on_msg(lambda said: _on_said(comm, said))
    comm.on_close(lambda _: _forget(comm))
    _on_said(comm, message)


def _on_said(comm: Any, message: Any) -> None:
    said = message["content"]["data"]
    with _lock:
        _looking[comm] = time.monotonic() + SILENT if said.get("looks", True) else -math.inf
        live = sorted(_live)
    if said.get("asks"):
        comm.send({"live": live})


def _forget(comm: Any) -> None:
    with _lock:
        _looking[comm] = -math.inf  # not removed: where a tab has been, nobody looks until one opens


def _on_cell_end() -> None:
    """Wait anew for what tabs have said meanwhile."""
    with _lock:
        for comm, until in _looking.items():
            _looking[comm] = max(until, time.monotonic() + SILENT) if until > -math.inf else until
    _runs_cell.clear()
