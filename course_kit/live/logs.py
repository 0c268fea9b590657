"""The log console of a notebook: what all nodes log, live, with a choice of node, level and text."""

from __future__ import annotations

import html
from typing import Any

from ipywidgets import HTML, Dropdown, HBox, Layout, Text, ToggleButton, VBox

from course_kit.background import log_levels
from course_kit.live.life import Life, alive
from course_kit.node_logs import rosout
from course_kit.node_logs.rosout import LEVELS, LogLines
from course_kit.spinning import context
from course_kit.text import stands_still

PERIOD = 0.25  # seconds between two looks: nodes may log a thousand times a second
SHOWN = 200  # lines
HEIGHT = "260px"
ALL = "all nodes"
MOST = 4  # consoles that are live at once; the oldest of more ends
LEAVE = "set level …"


class LogPanel(Life, VBox):
    """A console with the last log lines of the nodes of this domain; its choices are attributes too."""

    def __init__(self, node: str | None, level: str) -> None:
        rosout.level_number(level)
        self.node = Dropdown(options=[ALL], value=ALL, layout=Layout(width="200px"))
        self.level = Dropdown(options=list(LEVELS.values()), value=level.upper(), layout=Layout(width="100px"))
        self.text = Text(placeholder="text in the line", layout=Layout(width="180px"))
        self.pause = ToggleButton(description="pause", icon="pause", layout=Layout(width="90px"))
        self.set_level = Dropdown(options=[LEAVE, *LEVELS.values()], value=LEAVE, layout=Layout(width="110px"))
        self._answer = HTML()
        self._lines = HTML(layout=Layout(height=HEIGHT, overflow="auto", border="1px solid #8888"))
        choices = HBox([self.node, self.level, self.text, self.pause, self.set_level, self._answer])
        super().__init__([choices, self._lines])
        if node is not None:
            self._offer("/" + node.strip("/"))
            self.node.value = "/" + node.strip("/")
        self._is_new = False  # whether there is anything to show
        for choice in (self.node, self.level, self.text, self.pause):
            choice.observe(self._on_change, names="value")
        self.set_level.observe(self._set_level, names="value")
        rosout.listeners.add(self._on_change)
        self.show_lines()
        self._begin("log console", PERIOD)

    def shown(self) -> LogLines:
        """The lines that the choices leave."""
        node = None if self.node.value == ALL else self.node.value
        return rosout.logs(node, self.level.value, SHOWN, self.text.value)

    def show_lines(self) -> None:
        """Show the present lines, the newest above."""
        lines = self.shown()
        for name in sorted({line.node for line in lines} - set(self.node.options)):
            self._offer(name)
        newest = "".join(rosout.html_line(line) for line in reversed(lines)) or "(no log lines)"
        self._lines.value = f"<pre class='course-kit-logs' style='margin:0;line-height:1.35'>{newest}</pre>"

    def _offer(self, name: str) -> None:
        self.node.options = [*self.node.options, name]

    def _on_change(self, _: Any) -> None:
        self._is_new = True

    def _show(self) -> float:
        if self._is_new and not self.pause.value:
            self._is_new = False
            self.show_lines()
        return PERIOD

    def _end(self, error: Exception | None) -> None:
        rosout.listeners.discard(self._on_change)
        if error is not None:
            self._say(stands_still("The console", error))

    def _set_level(self, change: dict[str, Any]) -> None:
        if change["new"] == LEAVE:
            return
        if self.node.value == ALL:
            self._say("choose a node first")
        else:
            try:
                log_levels.set_log_level(self.node.value, change["new"], timeout=2.0)
                self._say(f"{self.node.value} logs {change['new']} and above")
            except (ValueError, RuntimeError, TimeoutError) as error:
                self._say(str(error))
        self.set_level.value = LEAVE

    def _say(self, text: str) -> None:
        self._answer.value = f"<code>{html.escape(text)}</code>"


def watch_logs(node: str | None = None, level: str = "INFO") -> LogPanel:
    """Show what nodes log, live, with a choice of node, level and text: what rqt_console shows.

    `level` is the lowest shown at first. "set level" changes what the chosen node logs at all, as set_log_level().
    """
    context.start()
    panel = LogPanel(node, level)
    for old in [one for one in alive if isinstance(one, LogPanel)][:-MOST]:
        old.stop()
    return panel
