"""Making and ending nodes: quiet ones of the course's own, and those of a student's class."""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Mapping, Sequence
from typing import Any

from rclpy.context import Context
from rclpy.node import Node
from rclpy.parameter import Parameter

# rclpy 7.1.6 loses 0.1 MB with every node that has this service.
WITHOUT_DESCRIPTIONS = [Parameter("start_type_description_service", value=False)]


def quiet_node(name: str, context: Context | None = None, with_rosout: bool = False, **parameters: Any) -> Node:
    """A node that brings nothing of its own into the graph: no services, and /rosout only if asked for."""
    settings = [Parameter(key, value=value) for key, value in parameters.items()]
    return Node(
        name,
        context=context,
        enable_rosout=with_rosout,
        start_parameter_services=False,
        parameter_overrides=[*WITHOUT_DESCRIPTIONS, *settings],
    )


def with_base(node_class: type[Node], base: type[Node], **attributes: Any) -> type[Node]:
    """A class of the same name with `base` between it and Node, whose constructor then decides how the node is made."""
    bases = (base,) if node_class is Node else (node_class, base)
    same = {"__module__": node_class.__module__, "__doc__": node_class.__doc__}
    return type(node_class.__name__, bases, {**same, **attributes})


def construct(node_class: type[Node], args: Sequence[Any], kwargs: Mapping[str, Any]) -> Node:
    """Make a node of a class; if its constructor fails, nothing of it stays in the graph.

    A half-made node lives on in the traceback. One of the same name in its context would be mixed up with it: the
    middleware goes by names, and announces the publishers of the one as the other's.
    """
    node = node_class.__new__(node_class, *args, **kwargs)
    try:
        node_class.__init__(node, *args, **kwargs)
    except BaseException:
        if hasattr(node, "handle"):  # rclpy had got as far as the graph
            destroy(node)
        raise
    return node


def destroy(node: Node) -> None:
    """Destroy a node that no executor spins any more, with its action servers and clients, which rclpy leaves."""
    try:
        node.destroy_node()  # first: the student's own may destroy an action server, which goes only once
    except Exception:  # the student's own fails, or has done it before
        with contextlib.suppress(Exception):
            Node.destroy_node(node)
    for one in actions_of(node):
        with contextlib.suppress(Exception):
            one.destroy()


def actions_of(node: Node) -> list[Any]:
    """The action clients and servers of a node."""
    action = sys.modules.get("rclpy.action")  # it takes numpy, 0.2 s: who has no actions need not import it
    if action is None:
        return []
    return [one for one in node.waitables if isinstance(one, action.ActionClient | action.ActionServer)]
