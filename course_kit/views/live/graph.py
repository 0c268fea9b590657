"""The graph live in a notebook: a picture that follows what nodes come, go and connect to."""

from __future__ import annotations

import base64
import math
import time
from typing import Any

from rclpy.exceptions import InvalidHandle
from rclpy.node import Node

from course_kit.ros.graph.plots import check_part, draw_graph, look, observer
from course_kit.ros.graph.snapshot import Snapshot
from course_kit.views.live.life import stop_all
from course_kit.views.live.shown import Bundle
from course_kit.views.live.view import View, as_text

PERIOD = 0.2  # seconds between two looks at the graph; one takes 10 ms for 60 nodes
PARAMETERS = 1.0  # where each look asks all nodes for their parameters
REST = 1.0  # how long it rests after drawing, as a multiple of how long that took: cells and nodes want time too


class GraphView(View):
    """A live picture of the graph, until stop(), the same view again, the next run of its cell or the end of ROS."""

    kind = "graph"

    def __init__(self, watching: Node, first: Snapshot, wanted: dict[str, Any]) -> None:
        self._watching, self.wanted = watching, wanted
        self._period = PARAMETERS if wanted["parameters"] else PERIOD
        self.seen: Snapshot | None = None
        self.drawn = 0  # pictures so far
        self._draw(first)
        self._open(self._period, math.inf)

    def still(self) -> Bundle:
        """The last picture, with the graph in words."""
        return self._picture

    def _show(self) -> float:
        start = time.monotonic()
        try:
            self._draw(look(self._watching, **self.wanted))
        except ValueError as error:  # the node that was asked for has gone; it may come back
            self.seen, self._picture = None, as_text(f"{error}. It is drawn when it is there again.")
        self._keep(0.0)
        return max(self._period, REST * (time.monotonic() - start))

    def _draw(self, now: Snapshot) -> None:
        """Draw if anything that can be seen has changed."""
        if now == self.seen:
            return
        plot = draw_graph(now)
        picture, look = plot._repr_png_()
        self._picture = {
            "image/png": base64.b64encode(picture).decode(),
            "text/plain": repr(plot),
            "metadata": {"image/png": look},
        }
        self.seen, self.drawn = now, self.drawn + 1

    def _end(self, error: Exception | None) -> None:
        is_over = isinstance(error, InvalidHandle) or not self._watching.context.ok()
        super()._end(None if is_over else error)  # ROS was shut down: the last picture stays


def show_graph(
    node: Any = None,
    namespace: str | None = None,
    hidden: bool = False,
    services: bool = False,
    actions: bool = True,
    parameters: bool = False,
) -> GraphView:
    """Show the graph live: it follows nodes, connections and mismatches as they come and go.

    Takes what plot_graph() takes. It ends with .stop(), with the next run of its cell, or when the same is shown
    again. Stands for rqt_graph.
    """
    wanted = {
        "node": node,
        "namespace": namespace,
        "hidden": hidden,
        "services": services,
        "actions": actions,
        "parameters": parameters,
    }
    check_part(node, namespace)
    stop_all(lambda other: isinstance(other, GraphView) and str(other.wanted) == str(wanted))
    # Asked for once: it would start ROS again, in the view's thread, where a student has shut it down.
    watching = observer()
    return GraphView(watching, look(watching, **wanted), wanted)
