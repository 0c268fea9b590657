"""A bar under the cell that runs, while what it works on or waits for takes long.

It is no output: the course's extension of JupyterLab draws it below the cell from what a comm tells. So nothing of it
is saved, nothing is compared by nbval, and where there is no such extension nothing is shown.
"""

from __future__ import annotations

import threading
import time
from contextlib import suppress
from typing import Any

from comm import create_comm

from course_kit.base import kernel, long_tasks
from course_kit.base.long_tasks import LongTask

TARGET = "course_kit.progress"  # the comm's; progress_bar.js of the extension has it too
PATIENCE = 1.5  # seconds that a task may take without a bar
PERIOD = 0.5  # seconds between two looks

_lock = threading.Lock()
_tasks: list[LongTask] = []  # those of the cell that runs, the outermost first
_cell = ""
_comm: Any = None  # open while there is a bar
_watcher: threading.Thread | None = None


def attach() -> None:
    """Show bars from now on."""
    long_tasks.listeners.add(_on_change)


def _on_change(task: LongTask) -> None:
    global _cell, _watcher
    if threading.current_thread() is not threading.main_thread():
        return  # no cell waits for it
    with _lock:
        if task.is_over:
            if task in _tasks:
                _tasks.remove(task)
            if not _tasks:
                _close()
            return
        if not _tasks:
            _cell = kernel.cell()[0]
        _tasks.append(task)
        if _watcher is None:
            _watcher = threading.Thread(target=_keep_shown, name="course_kit progress bar", daemon=True)
            _watcher.start()


def _keep_shown() -> None:
    """Show what goes on; ends when nothing does."""
    global _watcher
    shown: dict[str, Any] = {}
    while True:
        time.sleep(PERIOD)
        with _lock:
            if not _tasks:
                _watcher = None
                return
            if _tasks[0].seconds >= PATIENCE or _comm is not None:
                with suppress(Exception):  # a node that is to be named may be destroyed meanwhile
                    shown = _show(shown)


def _show(before: dict[str, Any]) -> dict[str, Any]:
    """Show the outermost task whose length is known, or else the outermost, unless that is what is shown."""
    global _comm
    states = [{**task.state(), "cell": _cell} for task in _tasks]
    now = next((state for state in states if state["fraction"] is not None), states[0])
    if _comm is None:
        _comm = create_comm(target_name=TARGET, data=now)
    elif now != before:
        _comm.send(now)
    return now


def _close() -> None:
    global _comm
    if _comm is not None:
        _comm.close()
    _comm = None
