"""A terminal in the test domain in which the student's workspace is sourced; its `ros2` is the course's own, or apt's.

No script of the workspace is run for that, and none of its modules can take the place of those that `ros2` consists of.
"""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Sequence
from pathlib import Path

from course_kit.base.programs import processes
from course_kit.exercises.checker.examination import current
from course_kit.exercises.notebook_folder import WORKSPACE
from course_kit.ros.spinning.context import RANGE
from course_kit.setup.colcon import overlay
from course_kit.setup.colcon.built import module_paths
from course_kit.setup.environment.activation import sourced_ros

# Isolated, so that PYTHONPATH is not heeded; launch files import what they find there, but behind all that is ours.
OWN_ROS2 = """
import os, sys
sys.path += [entry for entry in os.environ.get("PYTHONPATH", "").split(os.pathsep) if entry]
from course_kit.cli.ros2.command import main
main()
"""
CONFINED = "COURSE_KIT_CONFINED"
OURS = ("course_kit", "rclpy", "sitecustomize", "usercustomize")  # modules that no workspace has


def folder() -> Path:
    """The student's workspace."""
    return current().folder / WORKSPACE


def environment() -> dict[str, str]:
    """What programs get that are started there."""
    environ = processes.without_kernel(os.environ)
    for name in ("ROS_LOCALHOST_ONLY", "ROS_STATIC_PEERS", "ROS_NAMESPACE"):
        environ.pop(name, None)
    ros = sourced_ros(os.environ)
    if ros is not None:  # the checker has no PYTHONPATH: what apt's programs need of it is in its sys.path
        environ["PYTHONPATH"] = os.pathsep.join(path for path in sys.path if Path(path).is_relative_to(ros.prefix))
    environ = overlay.over(environ, folder())
    return {
        **environ,
        **processes.PLAIN_TERMINAL,
        "ROS_DOMAIN_ID": str(current().test_domain.domain),
        RANGE: "LOCALHOST",
    }


def command(words: Sequence[str]) -> list[str]:
    """What is started for a command line: `ros2` is not looked for on PATH."""
    if words[0] != "ros2":
        return list(words)
    ros = sourced_ros(os.environ)
    apts = Path(ros.prefix, "bin/ros2") if ros is not None else None
    own = [sys.executable, "-I", "-c", OWN_ROS2]
    return [*([str(apts)] if apts is not None and os.access(apts, os.X_OK) else own), *words[1:]]


def confined() -> list[str]:
    """What a command is put behind that runs a student's program apart: a grader says it."""
    return list(json.loads(os.environ.get(CONFINED, "[]")))


def in_the_way() -> list[str]:
    """The modules of the workspace that would be loaded in place of the course's own by programs started there."""
    places = [folder(), *module_paths(folder())]
    found = [path for place in places for name in OURS for path in (place / name, place / f"{name}.py")]
    return [str(path.relative_to(folder())) for path in found if path.exists()]
