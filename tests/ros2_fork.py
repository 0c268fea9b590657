"""A `ros2` command line in a fork of a process that has loaded rclpy: five times as quick as from Python's start.

That process has imported nothing of the course: that a command imports what it needs is tested as ever. It loads this
module once; each fork then calls run().
"""

from __future__ import annotations

import importlib
import os
import runpy
import sys
from collections.abc import Mapping, Sequence

# Loaded with what every node is made of: its parameter services, its log, its clock.
TYPES = ("builtin_interfaces.msg", "rcl_interfaces.msg", "rcl_interfaces.srv", "rosgraph_msgs.msg", "std_msgs.msg")


def load() -> None:
    """Import rclpy and load the libraries of common types, which take most of a command's start."""
    importlib.import_module("rclpy.node")
    for name in (*TYPES, "type_description_interfaces.srv"):
        for one in vars(importlib.import_module(name)).values():
            if isinstance(one, type) and hasattr(one, "__import_type_support__"):
                one.__import_type_support__()


def run(words: Sequence[str], environment: Mapping[str, str], out: str, err: str) -> None:
    """Be the command, with these variables, writing to these files."""
    for file, descriptor in ((out, 1), (err, 2)):
        os.dup2(os.open(file, os.O_WRONLY | os.O_APPEND), descriptor)
    os.environ.clear()
    os.environ.update(environment)
    sys.argv = ["ros2", *words]
    runpy.run_module("course_kit.cli.ros2.command", run_name="__main__", alter_sys=True)
