"""`ros2 bag record`: topics into a bag, until Ctrl-C, SIGTERM or --duration, which all close it well."""

from __future__ import annotations

import os
import signal
import time
from argparse import ArgumentParser, Namespace
from queue import Empty
from typing import TYPE_CHECKING, Any

from course_kit.ros2.bag.options import (
    STORAGES,
    add_unsupported,
    check_patterns,
    qos_overrides,
    readable_file,
    refuse_unsupported,
    show,
)
from course_kit.ros2.completion import names_of
from course_kit.ros2.session import Session
from course_kit.ros2.verbs import CommandError, Verb, add_duration_argument

if TYPE_CHECKING:
    from course_kit.bags.recorder import Recorder
    from course_kit.bags.selection import Selection

DEFAULT_NAME = "rosbag2_%Y_%m_%d-%H_%M_%S"
SMALLEST_SPLIT = {"mcap": 1024, "sqlite3": 86016}  # bytes
UNSUPPORTED: dict[str, dict[str, Any]] = {
    "--services": {"nargs": "+", "metavar": "ServiceName"},
    "--all-services": {"action": "store_true"},
    "--exclude-services": {"nargs": "+", "metavar": "ServiceName"},
    "--use-sim-time": {"action": "store_true"},
    "--snapshot-mode": {"action": "store_true"},
    "--storage-config-file": {},
    "--storage-preset-profile": {},
    "--serialization-format": {},
    "--compression-mode": {"choices": ["none", "file", "message"]},
    "--compression-format": {},
}
NEEDS_WIDE = "argument requires either --all, --all-topics, --topic-types or --regex"


def _arguments(parser: ArgumentParser) -> None:
    parser.add_argument(
        "-o",
        "--output",
        help="Destination of the bagfile to create, defaults to a timestamped folder in the current directory.",
    )
    parser.add_argument(
        "-s",
        "--storage",
        default="mcap",
        choices=STORAGES,
        help="Storage identifier to be used, defaults to '%(default)s'.",
    )
    group = parser.add_mutually_exclusive_group()
    positional = group.add_argument(
        "topics_positional",
        default=[],
        metavar="[Topic ...]",
        nargs="*",
        help="Space-delimited list of topics to record. (deprecated)",
    )
    named = group.add_argument(
        "--topics", default=[], metavar="Topic", nargs="+", help="Space-delimited list of topics to record."
    )
    positional.completer = named.completer = names_of("topic")  # type: ignore[attr-defined]
    add = parser.add_argument
    add(
        "--topic-types",
        nargs="+",
        default=[],
        metavar="TopicType",
        help="Space-delimited list of topic types to record.",
    )
    add("-a", "--all", action="store_true", help="Record all topics and services (Exclude hidden topic).")
    add("--all-topics", action="store_true", help="Record all topics (Exclude hidden topic).")
    add(
        "-e",
        "--regex",
        default="",
        help="Record only topics and services containing provided regular expression. "
        "Note:  --all, --all-topics or --all-services will override --regex.",
    )
    add("--exclude-regex", "-x", default="", help="Exclude topics containing provided regular expression.")
    add("--exclude-topic-types", nargs="+", default=[], metavar="ExcludeTopicTypes", help="Topic types not to record.")
    add("--exclude-topics", nargs="+", default=[], metavar="Topic", help="Topics not to record.")
    add("--include-unpublished-topics", action="store_true", help="Discover and record topics which have no publisher.")
    add("--include-hidden-topics", action="store_true", help="Discover and record hidden topics as well.")
    add("--no-discovery", action="store_true", help="Only topics present at startup will be recorded.")
    add(
        "-p",
        "--polling-interval",
        type=int,
        default=100,
        help="Time in ms to wait between querying available topics for recording.",
    )
    add("--ignore-leaf-topics", action="store_true", help="Ignore topics without a subscription.")
    add(
        "--qos-profile-overrides-path",
        type=readable_file,
        help="Path to a yaml file defining overrides of the QoS profile for specific topics.",
    )
    add("-b", "--max-bag-size", type=int, default=0, help="Maximum size in bytes before the bagfile will be split.")
    add(
        "-d",
        "--max-bag-duration",
        type=int,
        default=0,
        help="Maximum duration in seconds before the bagfile will be split.",
    )
    add("--max-cache-size", type=int, default=0, help="Accepted and ignored: what waits to be written has room.")
    add("--disable-keyboard-controls", action="store_true", help="disables keyboard controls for recorder")
    add("--start-paused", action="store_true", help="Start the recorder in a paused state.")
    add("--node-name", default="rosbag2_recorder", help="Specify the recorder node name. Default is %(default)s.")
    add("--custom-data", metavar="KEY=VALUE", nargs="*", default=[], help="Key=value pairs to store in the metadata.")
    add("--log-level", default="info", choices=["debug", "info", "warn", "error", "fatal"], help="Logging level.")
    add_duration_argument(parser)
    add_unsupported(parser, UNSUPPORTED)


def _record(args: Namespace, session: Session) -> int:
    if args.topics_positional:
        session.print(
            '[WARN] [ros2bag]: Positional "topics" argument deprecated. '
            'Please use optional "--topics" argument instead.'
        )
    folder = args.output or time.strftime(DEFAULT_NAME)
    selection = _selection(args, session, folder)
    refuse_unsupported(args, UNSUPPORTED)
    overrides = qos_overrides(args.qos_profile_overrides_path)

    from course_kit.bags.recorder import BagLogLine, Recorder
    from course_kit.bags.storage import BagError
    from course_kit.bags.writer import BagWriter
    from course_kit.ros2.bag.keys import Keys

    if args.no_discovery:
        session.graph()  # what is there is all that will be recorded
    with Keys(are_wanted=not (session.in_notebook or args.disable_keyboard_controls)) as keys:
        try:
            custom = dict(pair.partition("=")[::2] for pair in args.custom_data)
            writer = BagWriter(folder, args.storage, args.max_bag_size, args.max_bag_duration, custom)
        except OSError as error:
            raise _error(f"Could not create bag folder '{folder}': {error.strerror}") from None
        except BagError as error:
            raise _error(str(error)) from None
        recorder = Recorder(
            writer,
            selection,
            overrides,
            args.node_name,
            max(0.01, args.polling_interval / 1000),
            looks_on=not args.no_discovery,
            is_paused=args.start_paused,
        )
        if not (session.in_notebook or args.disable_keyboard_controls):
            recorder.log.put(BagLogLine("INFO", args.node_name, "Press SPACE for pausing/resuming", time.time_ns()))
        return _run(recorder, keys, session, args.log_level)


def _run(recorder: Recorder, keys: Any, session: Session, log_level: str) -> int:
    """Let it record, and say what it says, until something ends it."""
    try:
        recorder.start()
        while recorder.is_running:
            session.check_time()
            if keys.pressed():
                recorder.pause(not recorder.is_paused)
            _show(recorder, session, log_level, timeout=0.05)
    except SystemExit:  # SIGTERM is a good way to end a recording
        pass
    finally:
        _close(recorder)
        _show(recorder, session, log_level)
    if recorder.error:
        raise CommandError(f"[ERROR] [ros2bag]: {recorder.error}")
    return 0


def _close(recorder: Recorder) -> None:
    """End it; a second Ctrl-C must not keep the bag from being closed."""
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        recorder.stop()
    finally:
        if before is not None:
            signal.signal(signal.SIGINT, before)


def _show(recorder: Recorder, session: Session, log_level: str, timeout: float = 0.0) -> None:
    try:
        show(recorder.log.get(timeout=timeout) if timeout else recorder.log.get_nowait(), session, log_level)
        while True:
            show(recorder.log.get_nowait(), session, log_level)
    except Empty:
        pass


def _selection(args: Namespace, session: Session, folder: str) -> Selection:
    """What to record; CommandError for what contradicts itself, with rosbag2's words."""
    from course_kit.bags.selection import Selection
    from course_kit.watching import topics

    names = args.topics_positional or args.topics
    every = args.all or args.all_topics
    wide = every or args.topic_types or args.regex
    if not (wide or names):
        raise _error(
            "Need to specify at least one option out of --all, --all-topics, --all-services, --services, --topics, "
            "--topic-types or --regex"
        )
    if args.exclude_regex and not wide:
        raise _error(
            "--exclude-regex argument requires either --all, --all-topics, --topic-types, --all-services or --regex"
        )
    if args.exclude_topics and not wide:
        raise _error(f"--exclude-topics {NEEDS_WIDE}")
    if args.exclude_topic_types and not wide:
        raise _error("--exclude-topic-types argument requires either --all, --all-topics or --regex")
    if every and names:
        session.print("[WARN] [ros2bag]: --all or --all-topics will override --topics")
    if every and args.regex:
        session.print("[WARN] [ros2bag]: --all, --all-topics or --all-services will override --regex")
    if os.path.isdir(folder):
        raise _error(f"Output folder '{folder}' already exists.")
    smallest = SMALLEST_SPLIT[args.storage]
    if 0 < args.max_bag_size < smallest:
        raise _error(
            f"Invalid bag splitting size given. Please provide a value greater than {smallest}. "
            f"Specified value of {args.max_bag_size}"
        )
    check_patterns(args)
    try:
        return Selection(
            [topics.absolute(name) for name in names],
            args.topic_types,
            args.regex,
            every,
            [topics.absolute(name) for name in args.exclude_topics],
            args.exclude_topic_types,
            args.exclude_regex,
            args.include_hidden_topics,
            args.include_unpublished_topics,
            args.ignore_leaf_topics,
        )
    except ValueError as error:
        raise _error(str(error)) from None


def _error(text: str) -> CommandError:
    return CommandError(f"[ERROR] [ros2bag]: {text}")


RECORD = Verb("Record ROS data to a bag", _record, _arguments)
