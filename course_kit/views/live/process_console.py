"""A small console under the cell that started a process: its state and its last lines."""

from __future__ import annotations

import html

from course_kit.base.programs import processes
from course_kit.base.programs.child_process import Process
from course_kit.views.live.console import Console, bundle, refresh
from course_kit.views.live.shown import Bundle

LAST_LINES = 12


class ProcessConsole(Console):
    """What is shown for one process."""

    def __init__(self, process: Process, earlier: ProcessConsole | None) -> None:
        self.process = process
        super().__init__(earlier)

    def bundle(self) -> Bundle:
        """The last lines that it has printed."""
        return console_of(self.process)


def console_of(process: Process) -> Bundle:
    """A process's state and its last lines."""
    lines = [(f"  {line}", f"  {html.escape(line)}\n") for line in process.lines[-LAST_LINES:]]
    return bundle(process.name, process.state, lines)


_consoles: dict[str, ProcessConsole] = {}


def attach() -> None:
    """Show a console for each process that is started from now on."""
    processes.listeners.add((_on_start, _on_change))


def _on_start(process: Process) -> None:
    _consoles[process.name] = ProcessConsole(process, _consoles.get(process.name))


def _on_change(process: Process) -> None:
    if process.name in _consoles and _consoles[process.name].process is process:
        refresh(_consoles[process.name])
