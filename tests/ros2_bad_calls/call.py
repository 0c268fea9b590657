"""What a command line that makes no sense is, and what its words in <> stand for: odd texts, and files."""

from __future__ import annotations

import shlex
from typing import NamedTuple


class Bad(NamedTuple):
    """A command line, a regular expression for what it prints, its exit status (1: the verb; 2: the command line)."""

    line: str
    says: str
    status: int = 1

    def words(self, more: dict[str, str]) -> list[str]:
        """Its words, with what stands for those in <>."""
        words = shlex.split(self.line)
        for sign, meant in {**WORDS, **more}.items():
            words = [word.replace(sign, meant) for word in words]
        return words


LONG = 100_000  # characters
WORDS = {
    "<long>": "x" * LONG,
    "<long_path>": "/x" * (LONG // 2),
    "<deep>": "[" * 1000,
    "<surrogate>": "caf\udce9",  # what Python makes of a byte of Latin-1 on the command line
    "<nul>": "a\0b",  # only %ros2 can have it
    "<1e23>": "1" + "0" * 23,
    "<bomb>": "[" + ", ".join(["&a0 [x]", *(f"&a{n} [{', '.join([f'*a{n - 1}'] * 9)}]" for n in range(1, 10))]) + "]",
}
METADATA = """rosbag2_bagfile_information:
  {version: 9, compression_format: '', compression_mode: '', message_count: 0,
   starting_time: {nanoseconds_since_epoch: %s}, duration: {nanoseconds: %s},
   storage_identifier: mcap, relative_file_paths: [], topics_with_message_count: []}
"""
BAGS = {f"<{name}_bag>": f"{name}_bag" for name in ("bad", "late", "endless", "tagged")}
FOLDERS = {"<folder>": "empty", "<no_file>": "no/such/file", **BAGS}
FILES = {  # by sign: name and text
    "<text>": ("text.txt", "no YAML: [\n"),
    "<number>": ("number.yaml", "5\n"),
    "<empty>": ("empty.yaml", ""),
    "<latin>": ("latin.yaml", "caf\udce9"),
    "<too_large>": ("large.yaml", "/turtlesim: {ros__parameters: {background_r: 100000000000000000000000}}\n"),
    "<everywhere>": ("everywhere.yaml", "/**: {ros__parameters: {background_r: 1}}\n"),
    "<list>": ("list.yaml", "/turtlesim: {ros__parameters: [1, 2]}\n"),
    "<no_parameters>": ("none.yaml", "/turtlesim: {a: 1}\n"),
    "<depth>": ("depth.yaml", "/turtle1/pose: {depth: -1}\n"),
    "<great_depth>": ("great.yaml", "/turtle1/pose: {depth: 100000000000000000000000}\n"),
    "<policy>": ("policy.yaml", "/turtle1/pose: {reliability: maybe}\n"),
    "<deadline>": ("deadline.yaml", "/turtle1/pose: {deadline: {sec: .nan, nsec: 0}}\n"),
    "<broken.mcap>": ("broken.mcap", "no mcap"),
    "<broken.db3>": ("broken.db3", "no sqlite"),
    "<broken_launch>": ("broken.launch.py", "def generate_launch_description(:\n"),
    "<broken_xml>": ("broken.launch.xml", "<launch><node></launch>"),
    "<broken_yaml>": ("broken.launch.yaml", "launch: [node: {]"),
    "<empty_launch>": ("empty.launch.py", ""),
    "<raising_launch>": ("raising.launch.py", "def generate_launch_description():\n    return 1 / 0\n"),
    "<metadata>": ("bad_bag/metadata.yaml", "rosbag2_bagfile_information: {version: .inf}\n"),
    "<late>": ("late_bag/metadata.yaml", METADATA % ("100000000000000000000000", "0")),
    "<endless>": ("endless_bag/metadata.yaml", METADATA % ("0", ".inf")),
    "<tagged>": ("tagged_bag/metadata.yaml", METADATA % ("0", "!!int ''")),
}

TWIST = "topic pub /turtle1/cmd_vel geometry_msgs/msg/Twist"
NO_TEXT = "is no text of ROS, whose names and strings are UTF-8 without NUL"
NO_TYPE = r"The passed {} type is invalid"
STRING = "topic pub /talk std_msgs/msg/String"
COLOR = "param set /turtlesim background_r"
ROTATE = "action send_goal /turtle1/rotate_absolute turtlesim/action/RotateAbsolute"
SPAWN = "service call /spawn turtlesim/srv/Spawn"
