"""tf2_monitor: how late transforms come and how often: `ros2 run tf2_ros tf2_monitor`, or with two frames."""

from __future__ import annotations

import sys
from functools import partial
from typing import Any

import yaml
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import QoSProfile
from rclpy.time import Time
from tf2_msgs.msg import TFMessage
from tf2_ros import Buffer, TransformException, TransformListener

from course_kit.lab.tf_tools.delays import ChainDelay, Delays, results
from course_kit.lab.tf_tools.waiting import wait_for_transform
from course_kit.robots.tf.broadcasters import TF, TF_STATIC, kept_qos
from course_kit.robots.tf.chain import chain_between
from course_kit.ros.program import own_words, program, spin_for

NAME = "tf2_monitor"
LOOK, LOOKS = 0.5, 21  # seconds between two looks at the chain, looks for each report
DEPTH = 100


def main(args: list[str] | None = None) -> None:
    """Report every ten seconds until Ctrl-C or SIGTERM; exit status 0."""
    words = own_words(NAME, args)
    if len(words) not in (0, 2):
        print("TF_Monitor: usage: tf2_monitor framea frameb")
        sys.exit(255)
    with program(NAME, lambda: Node("tf2_monitor_main"), args) as (node, executor, asked):
        _monitor((words[0], words[1]) if words else None, node, executor, asked)


def _monitor(frames: tuple[str, str] | None, node: Node, executor: SingleThreadedExecutor, asked: list[int]) -> None:
    buffer, delays, of_chain = Buffer(), Delays(), ChainDelay()
    listener = TransformListener(buffer, node)
    if frames is not None:
        wait_for_transform(buffer, frames, Time(), node, executor, asked, LOOK)
    _subscribe(node, delays)
    said = "all frames" if frames is None else f"{frames[0]} -> {frames[1]}"
    print(f"Gathering data on {said} for 10 seconds...", flush=True)
    looks = 0
    while not asked:
        if frames is not None:
            _look(frames, node, buffer, of_chain)
        spin_for(executor, asked, LOOK)
        looks += 1
        if looks == LOOKS:
            looks = 0
            chain = [] if frames is None else chain_between(*frames, partial(_parent, buffer))
            print("\n".join(results(delays, frames, chain, of_chain)), flush=True)
    listener.unregister()


def _subscribe(node: Node, delays: Delays) -> None:
    def take(message: Any) -> None:
        stamps = [
            (one.child_frame_id, Time.from_msg(one.header.stamp).nanoseconds * 1e-9) for one in message.transforms
        ]
        delays.take(stamps, _now(node))

    node.create_subscription(TFMessage, TF, take, QoSProfile(depth=DEPTH))
    node.create_subscription(TFMessage, TF_STATIC, take, kept_qos(DEPTH))


def _look(frames: tuple[str, str], node: Node, buffer: Buffer, of_chain: ChainDelay) -> None:
    try:
        stamp = buffer.lookup_transform(*frames, Time()).header.stamp
    except TransformException as error:  # the real one ends at that
        node.get_logger().warning(f"Transform Exception {error}")
        return
    of_chain.take(_now(node) - Time.from_msg(stamp).nanoseconds * 1e-9)


def _now(node: Node) -> float:
    return float(node.get_clock().now().nanoseconds * 1e-9)


def _parent(buffer: Buffer, frame: str) -> str | None:
    known = yaml.safe_load(buffer.all_frames_as_yaml()) or {}
    return known[frame]["parent"] if frame in known else None


if __name__ == "__main__":
    main()
