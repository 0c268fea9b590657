"""Commands of the real `ros2` that are not made here: what each is for, and what it needs."""

from __future__ import annotations

from collections.abc import Sequence

NEEDS = {
    ("bag", "convert"): "it writes bags anew, and needs an installed ROS 2 with ros-jazzy-rosbag2",
    ("component",): "it loads nodes of C++ into a running process, and needs an installed ROS 2 with "
    "ros-jazzy-ros2component",
    ("multicast",): "it tries the network between machines, and needs an installed ROS 2 with ros-jazzy-ros2multicast; "
    "`ros2 doctor hello` tries it too, and is here",
    ("security",): "it makes keys for encrypted topics, and needs an installed ROS 2 with ros-jazzy-sros2 and a "
    "middleware that can encrypt",
}


def refusal(words: Sequence[str]) -> str:
    """The sentence that refuses a command line; empty if it is none of these."""
    named = tuple(word for word in words if not word.startswith("-"))
    found = (name for name in NEEDS if named[: len(name)] == name)
    return "".join(f"ros2 {' '.join(name)} is not in the course: {NEEDS[name]}." for name in found)
