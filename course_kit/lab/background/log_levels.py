"""The log level of a node at run time: of a node in the notebook at once, of one in another process by its services.

A node in another process has these services if it was made with Node(..., enable_logger_service=True), as
`ros2 service list` shows: <node>/get_logger_levels and <node>/set_logger_levels.
"""

from __future__ import annotations

from typing import Any

from rcl_interfaces.msg import LoggerLevel
from rcl_interfaces.srv import GetLoggerLevels, SetLoggerLevels
from rclpy.logging import LoggingSeverity
from rclpy.node import Node

from course_kit.base.arguments import NODE, TEXT, WAIT, takes
from course_kit.base.polling import wait_until
from course_kit.lab.background import running
from course_kit.lab.node_logs.rosout import LEVELS, level_number
from course_kit.ros.graph import graph
from course_kit.ros.spinning import executors
from course_kit.ros.subscriptions import clients, observer_node

DEFAULT = "INFO"  # where no level was set


@takes(timeout=WAIT)
def log_level(node: Node | str, timeout: float = 5.0) -> str:
    """The lowest level that a node logs: DEBUG, INFO, WARN, ERROR or FATAL.

    Raises ValueError for a node that is not there, RuntimeError for one in another process without logger services.
    """
    own = _own(node)
    if own is not None:
        return LEVELS.get(own.get_logger().get_effective_level(), DEFAULT)
    name = _wait_for_node(node, timeout)
    # The empty name is the logger above all others, whose level counts where a node has none.
    request = GetLoggerLevels.Request(names=[_logger(name), ""])
    levels = _call(GetLoggerLevels, name, "get_logger_levels", request, timeout).levels
    return next((LEVELS.get(level.level, DEFAULT) for level in levels if level.level), DEFAULT)


@takes(level=TEXT, timeout=WAIT)
def set_log_level(node: Node | str, level: str, timeout: float = 5.0) -> None:
    """Let a node log this level and those above until it ends: 'DEBUG', 'INFO', 'WARN', 'ERROR' or 'FATAL'.

    Stands for the logger services that `ros2 service call` reaches too. Raises as log_level().
    """
    number = level_number(level)
    own = _own(node)
    if own is not None:
        own.get_logger().set_level(LoggingSeverity(number))
        return
    name = _wait_for_node(node, timeout)
    request = SetLoggerLevels.Request(levels=[LoggerLevel(name=_logger(name), level=number)])
    (result,) = _call(SetLoggerLevels, name, "set_logger_levels", request, timeout).results
    if not result.successful:
        raise RuntimeError(f"{name} refused the level {level}: {result.reason}")


def _own(node: Node | str) -> Node | None:
    """The node itself if it lives in this process."""
    if isinstance(node, Node):
        return node
    if not isinstance(node, str):
        raise TypeError(f"give a node or the name of one, not {type(node).__name__}")
    NODE.check("the node", node)
    name = "/" + node.strip("/")
    return next((one for one in running.nodes() if one.get_fully_qualified_name() == name), None)


def _logger(node: str) -> str:
    """The name of a node's logger: namespaces are separated by dots."""
    return node.strip("/").replace("/", ".")


def _wait_for_node(node: Node | str, timeout: float) -> str:
    name = "/" + str(node).strip("/")

    def names() -> list[str]:
        return [one.full_name for one in graph.nodes(observer_node.node(), with_hidden=True)]

    if not wait_until(lambda: name in names(), timeout):
        there = ", ".join(one for one in names() if not graph.is_hidden(one)) or "none"
        raise ValueError(f"there is no node {name} (waited {timeout:g} s). Nodes: {there}.")
    return name


def _call(service_type: Any, node: str, service: str, request: Any, timeout: float) -> Any:
    executors.refuse_in_callback("a logger service")
    try:
        return clients.call(service_type, f"{node}/{service}", request, min(timeout, 2.0), timeout)
    except LookupError:
        raise RuntimeError(
            f"{node} has no service {node}/{service}, so its level cannot be changed from outside. Make the node "
            f"with super().__init__('{node.rsplit('/', 1)[-1]}', enable_logger_service=True), or start it with "
            f"--ros-args --log-level {_logger(node)}:=debug"
        ) from None
