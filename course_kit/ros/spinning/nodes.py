"""Making and ending nodes: quiet ones of the course's own, and those of a student's class."""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextvars import ContextVar
from typing import Any

from rclpy.context import Context
from rclpy.node import Node
from rclpy.parameter import Parameter

from course_kit.ros.private_api.rclpy_parts import end_state_machine, replace

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


Making = Callable[[Node, Callable[..., None], str, dict[str, Any]], None]
_making: ContextVar[Making | None] = ContextVar("making", default=None)


@contextlib.contextmanager
def made_by(making: Making) -> Iterator[None]:
    """Have nodes whose making begins in the block made by `making(node, plain, name, options)`.

    That is called in the place of Node's constructor, whichever way a class gets to it, and calls
    `plain(node, name, **options)` itself. It holds for this thread, and for those that run in a copy of its context
    variables.
    """
    replace(Node, "__init__", _guard_of)
    token = _making.set(making)
    try:
        yield
    finally:
        _making.reset(token)


def _guard_of(plain: Callable[..., None]) -> Callable[..., None]:
    def make(self: Node, node_name: str, **options: Any) -> None:
        making = _making.get()
        if making is None:
            plain(self, node_name, **options)
        else:
            making(self, plain, node_name, options)

    return make


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
    """Destroy a node that no executor spins any more, with its actions and its state machine, which rclpy leaves."""
    try:
        node.destroy_node()  # first: the student's own may destroy an action server, which goes only once
    except Exception:  # the student's own fails, or has done it before
        with contextlib.suppress(Exception):
            Node.destroy_node(node)
    for one in actions_of(node):
        with contextlib.suppress(Exception):
            one.destroy()
    with contextlib.suppress(Exception):
        end_state_machine(node)


def actions_of(node: Node) -> list[Any]:
    """The action clients and servers of a node."""
    action = sys.modules.get("rclpy.action")  # it takes numpy, 0.2 s: who has no actions need not import it
    if action is None:
        return []
    return [one for one in node.waitables if isinstance(one, action.ActionClient | action.ActionServer)]
