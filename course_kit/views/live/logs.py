"""The log console of a notebook: what all nodes log, live, with a choice of node, level and text."""

from __future__ import annotations

import html
import math
from typing import Any

from ipywidgets import HTML, Dropdown, HBox, Layout, Text, ToggleButton, VBox

from course_kit.base.arguments import NODE, TEXT, takes
from course_kit.lab.background import log_levels
from course_kit.lab.node_logs import rosout
from course_kit.lab.node_logs.rosout import LEVELS, LogLines
from course_kit.ros.spinning import context
from course_kit.views.live.life import alive
from course_kit.views.live.shown import Bundle
from course_kit.views.live.view import View

PERIOD = 0.25  # seconds between two looks: nodes may log a thousand times a second
SHOWN = 200  # lines
HEIGHT = "260px"
ALL = "all nodes"
MOST = 4  # consoles that are live at once; the oldest of more ends
LEAVE = "…"
NAMED = {"description_width": "initial"}  # a name takes the room that it needs
OF_A_STILL = 20  # lines


class LogPanel(View):
    """A console with the last log lines of the nodes of this domain; its choices are attributes too."""

    kind = "logs"

    def __init__(self, node: str | None, level: str) -> None:
        rosout.level_number(level)
        self.node = _choice("node", [ALL], ALL, 240)
        self.level = _choice("level", list(LEVELS.values()), level.upper(), 140)
        self.text = Text(description="text", placeholder="in the line", layout=Layout(width="210px"), style=NAMED)
        self.pause = ToggleButton(description="pause", icon="pause", layout=Layout(width="90px"))
        self.set_level = _choice("set level", [LEAVE, *LEVELS.values()], LEAVE, 170)
        self._answer = HTML()
        self._lines = HTML(layout=Layout(height=HEIGHT, overflow="auto", border="1px solid #8888"))
        if node is not None:
            self._offer("/" + node.strip("/"))
            self.node.value = "/" + node.strip("/")
        self._is_new = False  # whether there is anything to show
        choices = (self.node, self.level, self.text, self.pause)
        for choice in choices:
            choice.observe(self._on_change, names="value")
        self.set_level.observe(self._set_level, names="value")
        self.show_lines()
        rosout.listeners.add(self._on_change)
        above = HBox([*choices, self.set_level, self._answer], layout=Layout(flex_flow="row wrap"))
        self._open(PERIOD, math.inf, VBox([above, self._lines]))

    def still(self) -> Bundle:
        """The last lines, of what was chosen, the newest below as in a terminal."""
        of = f"with {self.text.value!r} " if self.text.value else ""
        head = f"Log lines of {self.node.value}, {of}{self.level.value} and above:"
        lines = LogLines(self._showing[-OF_A_STILL:])
        page = "".join(rosout.html_line(line) for line in lines) or "(no log lines)"
        css = f"margin:0;line-height:1.35;max-height:{HEIGHT};overflow:auto"
        return {
            "text/plain": f"{head}\n{lines!r}",
            "text/html": f"{html.escape(head)}<pre class='course-kit-logs' tabindex='0' style='{css}'>{page}</pre>",
        }

    def shown(self) -> LogLines:
        """The lines that the choices leave."""
        node = None if self.node.value == ALL else self.node.value
        return rosout.logs(node, self.level.value, SHOWN, self.text.value)

    def show_lines(self) -> None:
        """Show the present lines, the newest above."""
        self._showing = lines = self.shown()
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
        self._keep()
        return PERIOD

    def _close(self) -> None:
        rosout.listeners.discard(self._on_change)

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


def _choice(name: str, options: list[str], chosen: str, width: int) -> Dropdown:
    return Dropdown(description=name, options=options, value=chosen, layout=Layout(width=f"{width}px"), style=NAMED)


@takes(node=NODE | None, level=TEXT)
def watch_logs(node: str | None = None, level: str = "INFO") -> LogPanel:
    """Show what nodes log, live, with a choice of node, level and text: what rqt_console shows.

    `level` is the lowest shown at first. "set level" changes what the chosen node logs at all, as set_log_level().
    """
    context.start()
    panel = LogPanel(node, level)
    for old in [one for one in alive if isinstance(one, LogPanel)][:-MOST]:
        old.stop()
    return panel
