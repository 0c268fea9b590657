"""A small console under the cell that started a process: its state and its last lines."""

from __future__ import annotations

import html

from course_kit.live.console import Shown, current_cell, refresh
from course_kit.programs import processes
from course_kit.programs.child_process import Process

LAST_LINES = 12
SIGNS = {"running": "▶", "stopped": "■", "ended": "■", "failed": "✘"}


class ProcessConsole(Shown):
    """What is shown for one process."""

    def __init__(self, process: Process, cell: str) -> None:
        self.process = process
        self.cell = cell
        super().__init__()

    def bundle(self) -> dict[str, str]:
        """The console as plain text and as HTML."""
        state = self.process.state
        head = f"{SIGNS[state.split()[0]]} {self.process.name} {state}"
        lines = [f"  {line}" for line in self.process.lines[-LAST_LINES:]]
        shown = f"<b>{html.escape(head)}</b>\n" + "".join(f"{html.escape(line)}\n" for line in lines)
        return {
            "text/plain": "\n".join([head, *lines]),
            "text/html": f"<pre class='course-kit-console' style='margin:0'>{shown}</pre>",
        }


_consoles: dict[str, ProcessConsole] = {}


def attach() -> None:
    """Show a console for each process that is started from now on."""
    processes.listen(_on_start, _on_change)


def _on_start(process: Process) -> None:
    cell, earlier = current_cell(), _consoles.get(process.name)
    if earlier is None or earlier.cell != cell:
        _consoles[process.name] = ProcessConsole(process, cell)
    else:  # started again by the same cell, in a loop for instance
        earlier.process = process
        refresh(earlier)


def _on_change(process: Process) -> None:
    console = _consoles.get(process.name)
    if console is not None and console.process is process:
        refresh(console)
