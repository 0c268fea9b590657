"""A node that prints as JSON how it was started, then spins until it is interrupted; exit status 0."""

from __future__ import annotations

import contextlib
import json
import os
import sys

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.utilities import remove_ros_args


def main() -> None:
    """Run it."""
    rclpy.init()
    node = Node("launched", automatically_declare_parameters_from_overrides=True)
    parameters = {name: p.value for name, p in node._parameters.items()}
    report = {
        "name": node.get_fully_qualified_name(),
        "parameters": {name: list(v) if hasattr(v, "tolist") else v for name, v in parameters.items()},
        "chatter": node.resolve_topic_name("chatter"),
        "arguments": remove_ros_args(sys.argv)[1:],
        "colour": os.environ.get("COLOUR"),
        "folder": os.getcwd(),
        "tty": sys.stdout.isatty(),
    }
    print(json.dumps(report), flush=True)
    with contextlib.suppress(KeyboardInterrupt, ExternalShutdownException):
        rclpy.spin(node)
    node.destroy_node()
    rclpy.try_shutdown()
    print("ended well", flush=True)


if __name__ == "__main__":
    main()
