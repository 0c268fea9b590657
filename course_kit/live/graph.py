"""The graph live in a notebook: a picture that follows what nodes come, go and connect to."""

from __future__ import annotations

import html
import time
from typing import Any

from ipywidgets import HTML, Button, HBox, Image, Layout, VBox
from rclpy.exceptions import InvalidHandle
from rclpy.node import Node

from course_kit.live.life import Life, stop_all
from course_kit.ros_graph.graph_data import Snapshot
from course_kit.ros_graph.graph_plots import draw_graph, look, observer
from course_kit.text import stands_still

PERIOD = 0.2  # seconds between two looks at the graph; one takes 10 ms for 60 nodes
PARAMETERS = 1.0  # where each look asks all nodes for their parameters
REST = 1.0  # how long it rests after drawing, as a multiple of how long that took: cells and nodes want time too


class GraphView(Life, VBox):
    """A live picture of the graph, until its stop button, close(), the same view again or the end of ROS."""

    def __init__(self, watching: Node, first: Snapshot, wanted: dict[str, Any]) -> None:
        self._watching, self.wanted = watching, wanted
        self._period = PARAMETERS if wanted["parameters"] else PERIOD
        self._shown: Snapshot | None = None
        self.drawn = 0  # pictures so far
        self._image = Image(format="png", layout=Layout(max_width="100%", object_fit="contain"))
        self._line = HTML()
        self._button = Button(description="Stop", icon="stop", layout=Layout(width="90px"))
        self._button.on_click(lambda _: self._ending.set())
        super().__init__([self._image, HBox([self._button, self._line])])
        self._update(first)
        self._begin("course_kit graph view", self._period)

    def _show(self) -> float:
        start = time.monotonic()
        try:
            self._update(look(self._watching, **self.wanted))
        except ValueError as error:  # the node that was asked for has gone; it may come back
            self._say(str(error).partition(";")[0])
        return max(self._period, REST * (time.monotonic() - start))

    def _end(self, error: Exception | None) -> None:
        self._button.disabled = True
        if error is None:
            self._say("stopped")
        else:
            gone = isinstance(error, InvalidHandle) or not self._watching.context.ok()
            self._say("stopped: ROS was shut down" if gone else stands_still("The picture", error))

    def _update(self, now: Snapshot) -> None:
        """Draw if anything that can be seen has changed."""
        if now != self._shown:
            picture, size = draw_graph(now)._repr_png_()
            with self._image.hold_trait_notifications():
                self._image.value, self._image.width = picture, str(size["width"])
            self._shown, self.drawn = now, self.drawn + 1
        self._say("")

    def _say(self, text: str) -> None:
        said = f"<span style='opacity:0.75'>{html.escape(text)}</span>"
        if self._line.value != said:
            self._line.value = said


def show_graph(
    node: Any = None,
    namespace: str | None = None,
    hidden: bool = False,
    services: bool = False,
    actions: bool = True,
    parameters: bool = False,
) -> GraphView:
    """Show the graph live: it follows nodes, connections and mismatches as they come and go.

    Takes what plot_graph() takes. The stop button ends it, and so does showing the same again. Stands for rqt_graph.
    """
    wanted = {
        "node": node,
        "namespace": namespace,
        "hidden": hidden,
        "services": services,
        "actions": actions,
        "parameters": parameters,
    }
    stop_all(lambda other: isinstance(other, GraphView) and str(other.wanted) == str(wanted))
    # Asked for once: it would start ROS again, in the view's thread, where a student has shut it down.
    watching = observer()
    return GraphView(watching, look(watching, **wanted), wanted)
