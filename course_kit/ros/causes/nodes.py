"""Causes in the making, spinning and ending of nodes, and in their loggers."""

from __future__ import annotations

import re
from typing import Any

from course_kit.ros.causes.raised import Raised, Rule, nearest


def _is_node(value: Any) -> bool:
    return any(_is_of_rclpy(one) and one.__name__ == "Node" for one in type(value).__mro__)


def _is_of_rclpy(kind: type) -> bool:
    return kind.__module__.partition(".")[0] == "rclpy"


def _unmade(raised: Raised, _: re.Match[str]) -> str:
    node = getattr(raised.error, "obj", None)
    if not _is_node(node) or "_Node__node" in vars(node):
        return ""
    name = re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", type(node).__name__).lower()
    return (
        f"The constructor of {type(node).__name__} has not called Node's: write super().__init__('{name}') as the "
        f"first line of __init__"
    )


def _no_such_attribute(raised: Raised, found: re.Match[str]) -> str:
    node = getattr(raised.error, "obj", None)
    if not _is_node(node):
        return ""
    own = {*vars(node), *(name for one in type(node).__mro__ if not _is_of_rclpy(one) for name in vars(one))}
    methods = {name for name in dir(type(node)) if not name.startswith("_") and callable(getattr(type(node), name))}
    meant = nearest(found[1], {name for name in own if not name.startswith("_")}) or nearest(
        found[1], methods, cutoff=0.8
    )
    hint = f"did you mean self.{meant}?" if meant else f"set self.{found[1]} in __init__, before anything uses it"
    return f"{type(node).__name__} has no {found[1]}: {hint}"


def _uncalled(raised: Raised, found: re.Match[str]) -> str:
    if "get_logger." not in raised.line:
        return ""
    return f"get_logger is a method, which gives the logger when it is called: write get_logger().{found[1]}(…)"


def _of_the_node(raised: Raised, found: re.Match[str]) -> str:
    node = raised.named("self")
    if not _is_node(node) or not hasattr(node, found[1]):
        return ""
    return f"{found[1]} belongs to the node, and Python does not look there by itself: write self.{found[1]}"


RULES: tuple[Rule, ...] = (
    (
        "NotInitializedException",
        r"",
        "ROS has not been started in this kernel: hand the class to run(), which starts it, as in run(Talker) without "
        "parentheses behind Talker, or call rclpy.init() before",
    ),
    ("AttributeError", r"", _unmade),
    (
        "TypeError",
        r"Node\.__init__\(\) missing 1 required positional argument: 'node_name'",
        "A node needs a name: write super().__init__('talker')",
    ),
    (
        "TypeError",
        r"Node\.__init__\(\) takes 2 positional arguments but",
        "super() hands the object over by itself, and a node's name is all that is given by place: write "
        "super().__init__('talker')",
    ),
    (
        "TypeError",
        r"RcutilsLogger\.(\w+)\(\) takes 2 positional arguments",
        r"A logger takes one text, unlike print(): put the values into it, as in \1(f'x is {x}')",
    ),
    (
        "TypeError",
        r"rclpy_logging_rcutils_log\(\): incompatible",
        "A logger takes text and nothing else: write info(str(value)) or info(f'{value}')",
    ),
    ("AttributeError", r"'(?:function|method)' object has no attribute '(\w+)'", _uncalled),
    ("NameError", r"name '(\w+)' is not defined", _of_the_node),
    (
        "InvalidHandle",
        r"destruction was requested",
        "Its node has been destroyed, by stop(), destroy_node() or a later run(): run the node again, and use the one "
        "that run() returns",
    ),
    (
        "RuntimeError",
        r"Context must be initialized before it can be shutdown|rcl_shutdown already called",
        "ROS does not run in this kernel any more, so there is nothing to shut down: leave this shutdown() out",
    ),
    ("AttributeError", r"object has no attribute '(\w+)'", _no_such_attribute),
)
