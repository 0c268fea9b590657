"""Waiting for a transform as tf2's programs do: until it is there, with a line that says why it is not yet."""

from __future__ import annotations

from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.time import Time
from tf2_ros import Buffer

from course_kit.ros.program import spin_for


def wait_for_transform(
    buffer: Buffer,
    frames: tuple[str, str],
    time: Time,
    node: Node,
    executor: SingleThreadedExecutor,
    asked: list[int],
    period: float,
) -> None:
    """Look every `period` seconds whether the second frame can be seen from the first, until it can or the end.

    The reason is logged once a second at most.
    """
    source, target = frames
    while not asked:
        can, reason = buffer.can_transform(source, target, time, return_debug_tuple=True)
        if can:
            return
        text = f"Waiting for transform {source} ->  {target}: {reason}"
        node.get_logger().info(text, throttle_duration_sec=1.0)
        spin_for(executor, asked, period)
