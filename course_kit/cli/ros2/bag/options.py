"""The options that verbs of `ros2 bag` share, and how they fail."""

from __future__ import annotations

import os
import sys
from argparse import ArgumentTypeError, FileType, Namespace
from collections.abc import Callable, Mapping, Sequence
from contextlib import AbstractContextManager
from typing import IO, TYPE_CHECKING, Any

from course_kit.cli.ros2.session import Session, log_text
from course_kit.cli.ros2.verbs import Arguments, CommandError, all_of, argument, compiled, failing, flag, refuse_device

if TYPE_CHECKING:
    from rclpy.qos import QoSProfile

    from course_kit.lab.bags.files import BagInfo, OpenBag
    from course_kit.lab.bags.recorder import BagLogLine
    from course_kit.lab.bags.selection import Selection

STORAGES = ("mcap", "sqlite3")
LEVELS = ("debug", "info", "warn", "error", "fatal")
ERROR = "[ERROR] [ros2bag]: {}"


def _existing_path(text: str) -> str:
    if not os.path.exists(text):
        raise ArgumentTypeError(f"Bag path '{text}' does not exist!")
    return text


def _bag(**settings: Any) -> Arguments:
    return all_of(
        argument("bag_path", "the bag: its folder, or one of its files", type=_existing_path, **settings),
        argument("-s --storage", "ignored: the storage is detected", default="", choices=STORAGES),
    )


BAG = _bag()
BAGS = all_of(
    _bag(nargs="?"),
    argument("-i --input", "a bag; repeat the option for several bags", nargs="+", action="append", metavar="URI"),
)
REGEX = argument("-e --regex", "include topics that match this regular expression", default="")
EXCLUDE_REGEX = argument("-x --exclude-regex", "exclude topics that match this regular expression", default="")
SHARED = all_of(
    argument("--qos-profile-overrides-path", "a YAML file with QoS policies by topic", type=FileType(encoding="utf-8")),
    flag("--disable-keyboard-controls", "take no keys from the terminal"),
    argument("--log-level", "the lowest level that is logged (default: info)", default="info", choices=LEVELS),
)


def failed(text: str) -> CommandError:
    """A failure in rosbag2's words."""
    return CommandError(ERROR.format(text))


def failing_with(*kinds: type[Exception], say: Callable[[Any], str] = str) -> AbstractContextManager[None]:
    """Exceptions of these kinds are failures in rosbag2's words."""
    return failing(*kinds, say=lambda error: ERROR.format(say(error)))


def bag_paths(args: Namespace) -> list[str]:
    """The bags that are named, by their place or by --input. CommandError for what is no bag's path and storage."""
    if args.bag_path is not None and args.input:
        raise failed(
            "do not mix the [bag_path] positional argument and the -i,--input option; for multiple input bags, use "
            "-i,--input multiple times"
        )
    if args.bag_path is not None:
        return [args.bag_path]
    for path, *storage in args.input or ():
        with failing_with(ArgumentTypeError):
            _existing_path(path)
        if len(storage) > 1:
            raise failed(f"-i takes a bag and the storage of its files, not also {' '.join(storage[1:])}")
        if storage and storage[0] not in STORAGES:
            raise failed(f"Unknown storage ID '{storage[0]}', options are: {', '.join(STORAGES)}")
    if not args.input:
        raise CommandError("ros2 bag play: error: bag_path or --input is required", status=2)
    return [path for path, *_ in args.input]


def say_what_is_left(bag: BagInfo | OpenBag, session: Session) -> None:
    """Say what can be had of a bag that is not complete."""
    if bag.notice:
        session.warn(f"[WARN] [ros2bag]: {bag.notice}")


def qos_overrides(file: IO[str] | None) -> dict[str, QoSProfile]:
    """{topic: profile} from a YAML file; none without one. CommandError for what is no such file."""
    if file is None:
        return {}
    from course_kit.cli.ros2.messages.values import NotYaml, parse
    from course_kit.lab.bags import qos as bag_qos

    with (
        failing_with(OSError, ValueError),
        failing_with(NotYaml, say=lambda error: f"'{file.name}' is no YAML: {error}"),
        file,
    ):
        refuse_device(file.name)
        return bag_qos.overrides(parse(file.read()) or {})


def selection(args: Namespace, names: Sequence[str], every: bool, **more: Any) -> Selection:
    """The topics that the command line asks for. CommandError for what is no name or no regular expression."""
    from course_kit.lab.bags.selection import Selection
    from course_kit.ros.subscriptions import topics

    for pattern in (args.regex, args.exclude_regex):
        compiled(pattern, ERROR.format("'{}' is no regular expression: {}"))
    with failing_with(ValueError):
        return Selection(
            [topics.absolute(name) for name in names],
            regex=args.regex,
            every=every,
            services=[topics.absolute(name) for name in args.services],
            exclude_names=[topics.absolute(name) for name in args.exclude_topics],
            exclude_services=[topics.absolute(name) for name in args.exclude_services],
            exclude_regex=args.exclude_regex,
            **more,
        )


def unsupported(options: Mapping[str, Mapping[str, Any]]) -> Arguments:
    """Options of rosbag2 that are not made here, known so that they can be refused in clear words."""
    return all_of(*(argument(name, "not supported here", **settings) for name, settings in options.items()))


def refuse_unsupported(args: Namespace, options: Mapping[str, Mapping[str, Any]]) -> None:
    """CommandError if one of these options was given."""
    for name in options:
        value = getattr(args, name.lstrip("-").replace("-", "_"))
        if value and value != "none":
            raise failed(f"{name} is not supported here: it needs the ros2 of an installed ROS 2.")


def show(line: BagLogLine, session: Session, log_level: str) -> None:
    """Write a log line to stderr, as ROS does; in a notebook it is a plain line of the cell's output."""
    if LEVELS.index(line.level.lower()) >= LEVELS.index(log_level):
        print(log_text(*line), file=sys.stdout if session.in_notebook else sys.stderr, flush=True)
