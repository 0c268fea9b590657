"""This process in the graph before it has a node there: it hears of others while the rest of ROS is imported.

That takes as long as others need to tell of themselves. The node that the middleware wants for it is no node of
rclpy's, is hidden, and goes when the first one is there.
"""

from __future__ import annotations

import os
from typing import Any

import rclpy

from course_kit.ros.private_api import NotAsExpected, expect, going_on_without
from course_kit.ros.private_api.fastdds_parts import participants_listening
from course_kit.ros.private_api.rtps_parts import ask_all_to_announce
from course_kit.ros.spinning import context

_joining: Any = None


def begin() -> None:
    """Start ROS, join the graph and ask who is there; nothing if ROS runs already."""
    global _joining
    if rclpy.ok():
        return
    context.start()
    context.before_stop(end)
    with going_on_without("each `ros2` command takes a little longer"):
        _joining = _plain_node(f"_ros2cli_{os.getpid()}_joining")
        ask_all_to_announce(participants_listening(rclpy.get_default_context().get_domain_id()) or {})


def end() -> None:
    """Have what was begun end, for there is a node now, or ROS ends."""
    global _joining
    ending, _joining = _joining, None
    if ending is not None:
        ending.destroy_when_not_in_use()


def _plain_node(name: str) -> Any:
    """A node of rcl, which rclpy's are made of. Raises NotAsExpected."""
    try:
        from rclpy.impl.implementation_singleton import rclpy_implementation as cpp
    except ImportError:
        raise NotAsExpected("rclpy has no impl.implementation_singleton here") from None
    expect("rclpy", cpp, "Node")
    expect("rclpy", cpp.Node, "destroy_when_not_in_use")
    handle: Any = rclpy.get_default_context().handle
    with handle:
        try:
            return cpp.Node(name, "", handle, [], False, False)
        except TypeError:
            raise NotAsExpected("rclpy's C++ Node() takes other arguments here") from None
