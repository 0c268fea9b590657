"""What `ros2 bag record` and `play` have in common: files of QoS overrides, options they do not have, their log."""

from __future__ import annotations

import os
import re
import sys
from argparse import ArgumentParser, ArgumentTypeError, Namespace
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from course_kit.ros2.session import Session
from course_kit.ros2.verbs import CommandError

if TYPE_CHECKING:
    from rclpy.qos import QoSProfile

    from course_kit.bags.recorder import BagLogLine

STORAGES = ("mcap", "sqlite3")
LEVELS = ("debug", "info", "warn", "error", "fatal")


def add_bag_arguments(parser: ArgumentParser) -> None:
    """The arguments of verbs that read one bag."""
    parser.add_argument("bag_path", type=_existing_path, help="Bag to open.")
    parser.add_argument(
        "-s",
        "--storage",
        default="",
        choices=STORAGES,
        help="Storage implementation of bag. "
        "By default attempts to detect automatically - use this argument to override.",
    )


def _existing_path(text: str) -> str:
    if not os.path.exists(text):
        raise ArgumentTypeError(f"Bag path '{text}' does not exist!")
    return text


def unfinished(path: str, count: int) -> str:
    """The line that says what can be had of a bag that its recorder has not closed."""
    from course_kit.bags.files import is_being_recorded

    folder = path if Path(path).is_dir() else str(Path(path).parent)
    if is_being_recorded(Path(folder)):
        return f"[WARN] [ros2bag]: '{path}' is still being recorded: {count} messages can be read by now."
    return (
        f"[WARN] [ros2bag]: '{path}' was not closed by its recorder: {count} messages can be read. "
        f"'ros2 bag reindex {folder}' completes it."
    )


def readable_file(path: str) -> str:
    """An argument that must be the path of a file that can be read."""
    try:
        with open(path, encoding="utf-8"):
            return path
    except OSError as error:
        raise ArgumentTypeError(f"can't open '{path}': {error}") from None


def qos_overrides(path: str | None) -> dict[str, QoSProfile]:
    """{topic: profile} from a YAML file; none without a path. CommandError for what is no such file."""
    if path is None:
        return {}
    import yaml

    from course_kit.bags import qos as bag_qos

    try:
        with open(path, encoding="utf-8") as file:
            return bag_qos.overrides(yaml.safe_load(file) or {})
    except yaml.YAMLError as error:
        reason = " ".join(str(error).split())
        raise CommandError(f"[ERROR] [ros2bag]: '{path}' is no YAML: {reason}") from None
    except (OSError, UnicodeDecodeError, ValueError) as error:
        raise CommandError(f"[ERROR] [ros2bag]: {error}") from None


def check_patterns(args: Namespace) -> None:
    """CommandError if --regex or --exclude-regex is no regular expression."""
    for pattern in (args.regex, args.exclude_regex):
        try:
            re.compile(pattern)
        except re.error as error:
            raise CommandError(f"[ERROR] [ros2bag]: '{pattern}' is no regular expression: {error}") from None


def add_unsupported(parser: ArgumentParser, options: Mapping[str, Mapping[str, Any]]) -> None:
    """Have the parser know options of rosbag2 that are not made here, so that they can be refused in clear words."""
    for name, settings in options.items():
        parser.add_argument(name, help="Not supported here.", **settings)


def refuse_unsupported(args: Namespace, options: Mapping[str, Mapping[str, Any]]) -> None:
    """CommandError if one of these options was given."""
    for name in options:
        value = getattr(args, name.lstrip("-").replace("-", "_"))
        if value and value != "none":
            raise CommandError(
                f"[ERROR] [ros2bag]: {name} is not supported here: it needs the ros2 of an installed ROS 2."
            )


def show(line: BagLogLine, session: Session, log_level: str) -> None:
    """Write a log line to stderr, as ROS does; in a notebook it is a plain line of the cell's output."""
    from course_kit.ros2.bag.text import log_text

    if LEVELS.index(line.level.lower()) < LEVELS.index(log_level):
        return
    if session.in_notebook:
        session.print(log_text(line))
    else:
        print(log_text(line), file=sys.stderr, flush=True)
