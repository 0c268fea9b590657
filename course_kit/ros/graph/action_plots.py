"""The hidden services and topics of an action, between its clients and its server, as a picture."""

from __future__ import annotations

from dataclasses import replace

from course_kit.base.arguments import TEXT, takes
from course_kit.base.figures import Plot
from course_kit.ros.graph.graph import is_hidden
from course_kit.ros.graph.plots import draw_graph, look, observer
from course_kit.ros.graph.snapshot import Channel, Snapshot


@takes(action=TEXT)
def plot_action(action: str) -> Plot:
    """Draw the three services and two topics of an action, as they run between its nodes now.

    Raises ValueError if no node offers or uses the action.
    """
    name = f"/{action.strip('/')}"
    whole = look(observer(), hidden=True, services=True)
    parts = [_without_tools(channel) for channel in whole.channels if channel.name.startswith(f"{name}/_action/")]
    ends = {end.node for channel in parts for end in channel.ends}
    if not ends:
        known = ", ".join(channel.name for channel in whole.actions) or "none"
        raise ValueError(f"no node offers or uses an action {name}; the actions are: {known}")
    nodes = tuple(node for node in whole.nodes if node.name in ends)
    return draw_graph(Snapshot(nodes, tuple(parts)))


def _without_tools(channel: Channel) -> Channel:
    """A channel without its ends in hidden nodes, such as a recording's."""
    sources, sinks = (
        tuple(end for end in side if not is_hidden(end.node)) for side in (channel.sources, channel.sinks)
    )
    return replace(channel, sources=sources, sinks=sinks)
