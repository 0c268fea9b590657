"""A verb of `ros2` in the background of a notebook: a process, its last lines, and a button that ends it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from ipywidgets import HTML, Button, Layout, VBox

from course_kit.base.programs import processes
from course_kit.cli.ros2.children import PROGRAM
from course_kit.views.live.life import Life
from course_kit.views.live.process_console import console_of
from course_kit.views.live.shown import Bundle
from course_kit.views.live.view import View

PERIOD = 0.25  # seconds between two looks: a verb may print a thousand lines a second


class BackgroundVerb(View):
    """What `%ros2 … --background` shows. It ends with its process, and its process with it."""

    kind = "ros2"

    def __init__(self, words: Sequence[str], name: str) -> None:
        """`words` follow `ros2`, `name` is the whole as it was typed. OSError if it cannot be started."""
        self._replace()  # before: two recorders would write the same bag
        self.process = processes.begin([*PROGRAM, *words], name)
        self.button = Button(
            description="stop", icon="stop", tooltip="end it as Ctrl-C does", layout=Layout(width="90px")
        )
        self.button.on_click(self._on_stop)
        self._console = HTML(console_of(self.process)["text/html"])
        self._open(PERIOD, math.inf, VBox([self.button, self._console]))

    def still(self) -> Bundle:
        """Its state and its last lines."""
        return console_of(self.process)

    def stop(self) -> None:
        """End it as Ctrl-C does, with all that it started; what was shown last stays. Safe to call twice."""
        self.process.stop()
        super().stop()

    close = stop

    def _replaces(self, other: Life) -> bool:
        # Some front ends do not tell which cell runs: there the same command line replaces its process.
        return bool(self._cell) and super()._replaces(other)

    def _on_stop(self, _: Any) -> None:
        self._ending.set()  # a launch may take seconds to end: not in the kernel's thread

    def _show(self) -> float:
        self._console.value = self.still()["text/html"]
        self._keep()
        return self._unseen()

    def _unseen(self) -> float:
        if not self.process.is_running:
            self._ending.set()
        return PERIOD

    def _end(self, error: Exception | None) -> None:
        self.process.stop()
        super()._end(error)
