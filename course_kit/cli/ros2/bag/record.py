"""`ros2 bag record`: topics into a bag, until Ctrl-C, SIGTERM or --duration, which all close it well."""

from __future__ import annotations

import os
import signal
import time
from argparse import Namespace
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

from course_kit.base.shutdown import watchdog
from course_kit.cli.ros2.bag import options
from course_kit.cli.ros2.bag.options import EXCLUDE_REGEX, REGEX, SHARED, failed, failing_with
from course_kit.cli.ros2.completion import names_of
from course_kit.cli.ros2.session import Session, handling
from course_kit.cli.ros2.verbs import LONGEST, Arguments, Verb, argument, duration, flag, number, one_of, whole

if TYPE_CHECKING:
    from course_kit.lab.bags.recorder import Recorder
    from course_kit.lab.bags.selection import Selection

CLOSE_TIMEOUT = 120.0  # seconds from a further signal to the end, if the middleware holds a recording that is ended
DEFAULT_NAME = "rosbag2_%Y_%m_%d-%H_%M_%S"
SMALLEST_SPLIT = {"mcap": 1024, "sqlite3": 86016}  # bytes
UNSUPPORTED: dict[str, dict[str, Any]] = {
    "--use-sim-time": {"action": "store_true"},
    "--snapshot-mode": {"action": "store_true"},
    "--storage-config-file": {},
    "--storage-preset-profile": {},
    "--serialization-format": {},
    "--compression-mode": {"choices": ["none", "file", "message"]},
    "--compression-format": {},
    "--compression-queue-size": {},
    "--compression-threads": {},
    "--compression-threads-priority": {},
}


def _record(args: Namespace, session: Session) -> int:
    if args.topics_positional:
        session.print(
            '[WARN] [ros2bag]: Positional "topics" argument deprecated. '
            'Please use optional "--topics" argument instead.'
        )
    folder = args.output or time.strftime(DEFAULT_NAME)
    selection = _selection(args, session, folder)
    options.refuse_unsupported(args, UNSUPPORTED)
    overrides = options.qos_overrides(args.qos_profile_overrides_path)

    custom = _custom_data(args.custom_data)

    from course_kit.base.atomic_files import reason_of
    from course_kit.cli.ros2.bag.keys import keys
    from course_kit.cli.ros2.messages.arguments import checked_node_name
    from course_kit.lab.bags.recorder import Recorder
    from course_kit.lab.bags.storage import BagError
    from course_kit.lab.bags.writer import BagWriter

    node_name = checked_node_name(args.node_name)

    if args.no_discovery:
        session.graph()  # what is there is all that will be recorded
    has_keys = not (session.in_notebook or args.disable_keyboard_controls)
    with keys(has_keys) as pressed:
        with (
            failing_with(BagError),
            failing_with(OSError, say=lambda error: f"Could not create bag folder '{folder}': {reason_of(error)}"),
        ):
            writer = BagWriter(folder, args.storage, args.max_bag_size, args.max_bag_duration, custom)
        period, looks_on = max(0.01, args.polling_interval / 1000), not args.no_discovery
        recorder = Recorder(writer, selection, overrides, node_name, period, looks_on, args.start_paused)
        if has_keys:
            recorder.say("Press SPACE for pausing/resuming")
        return _run(recorder, pressed, session, args.log_level)


def _custom_data(pairs: Sequence[str]) -> dict[str, str]:
    for pair in pairs:
        if not pair.partition("=")[0] or "=" not in pair:
            raise failed(f"'{pair}' is no custom data: write it like key=value")
    return dict(pair.partition("=")[::2] for pair in pairs)


def _run(recorder: Recorder, pressed: Callable[[], str | None], session: Session, log_level: str) -> int:
    """Let it record, and say what it says, until something ends it."""
    try:
        recorder.start()
        while recorder.is_running:
            if pressed() == " ":
                recorder.pause(not recorder.is_paused)
            for line in session.items(recorder.log, timeout=0.0):
                options.show(line, session, log_level)
    except SystemExit:  # SIGTERM is a good way to end a recording
        pass
    finally:
        watchdog.heed_no_signals()  # a bag is closed whole, however long its disk takes
        watchdog.end_after_signals(CLOSE_TIMEOUT, again=True)
        with handling(signal.SIGINT, lambda *_: None):  # a second Ctrl-C does not keep the bag from being closed
            recorder.stop()
        while not recorder.log.empty():
            options.show(recorder.log.get(), session, log_level)
    if recorder.error:
        raise failed(recorder.error)
    return 0


def _selection(args: Namespace, session: Session, folder: str) -> Selection:
    """What to record; CommandError for what contradicts itself, with rosbag2's words."""
    names = args.topics_positional or args.topics
    every = args.all or args.all_topics
    every_service = args.all or args.all_services
    wide = every or every_service or args.topic_types or args.regex
    if not (wide or names or args.services):
        raise failed(
            "Need to specify at least one option out of --all, --all-topics, --all-services, --services, --topics, "
            "--topic-types or --regex"
        )
    for option, given, needed in (
        ("--exclude-regex", args.exclude_regex, "--all, --all-topics, --topic-types, --all-services or --regex"),
        ("--exclude-topics", args.exclude_topics, "--all, --all-topics, --topic-types or --regex"),
        ("--exclude-topic-types", args.exclude_topic_types, "--all, --all-topics or --regex"),
        ("--exclude-services", args.exclude_services, "--all, --all-services or --regex"),
    ):
        if given and not wide:
            raise failed(f"{option} argument requires either {needed}")
    if every and names:
        session.print("[WARN] [ros2bag]: --all or --all-topics will override --topics")
    if every_service and args.services:
        session.print("[WARN] [ros2bag]: --all or --all-services will override --services")
    if (every or every_service) and args.regex:
        session.print("[WARN] [ros2bag]: --all, --all-topics or --all-services will override --regex")
    if os.path.isdir(folder):
        raise failed(f"Output folder '{folder}' already exists.")
    smallest = SMALLEST_SPLIT[args.storage]
    if 0 < args.max_bag_size < smallest:
        raise failed(
            f"Invalid bag splitting size given. Please provide a value greater than {smallest}. "
            f"Specified value of {args.max_bag_size}"
        )
    return options.selection(
        args,
        names,
        every,
        types=args.topic_types,
        every_service=every_service,
        exclude_types=args.exclude_topic_types,
        with_hidden=args.include_hidden_topics,
        with_unpublished=args.include_unpublished_topics,
        without_leaves=args.ignore_leaf_topics,
    )


def _some(name: str, help: str, metavar: str, **settings: Any) -> Arguments:
    return argument(name, help, nargs="+", default=[], metavar=metavar, **settings)


_duration = number(int, lambda value: value >= 0, "invalid int value: {!r}: write whole seconds, 0 or more", LONGEST)
_interval = number(int, lambda value: value > 0, "invalid int value: {!r}: write milliseconds above 0", LONGEST)

RECORD = Verb(
    "record topics into a bag",
    _record,
    argument("-o --output", "the folder of the bag (default: a name with date and time)"),
    argument("-s --storage", "the storage format (default: mcap)", default="mcap", choices=options.STORAGES),
    one_of(
        argument("topics_positional", "as --topics", names_of("topic"), default=[], metavar="[Topic ...]", nargs="*"),
        _some("--topics", "record these topics", "Topic", offer=names_of("topic")),
    ),
    _some("--topic-types", "record topics of these types", "TopicType"),
    _some("--services", "record the calls of these services", "ServiceName", offer=names_of("service")),
    flag("-a --all", "record all topics, without hidden ones, and all services"),
    flag("--all-topics", "record all topics, without hidden ones"),
    flag("--all-services", "record all services whose calls are published, see configure_introspection()"),
    REGEX,
    EXCLUDE_REGEX,
    _some("--exclude-topic-types", "exclude topics of these types", "ExcludeTopicTypes"),
    _some("--exclude-topics", "exclude these topics", "Topic"),
    _some("--exclude-services", "none of these services", "ServiceName"),
    flag("--include-unpublished-topics", "include topics that nobody publishes yet"),
    flag("--include-hidden-topics", "include hidden topics, with an underscore in the name"),
    flag("--no-discovery", "record only the topics that exist at the start"),
    argument("-p --polling-interval", "look for topics every N ms (default: 100)", type=_interval, default=100),
    flag("--ignore-leaf-topics", "record only topics with a subscription"),
    SHARED,
    argument("-b --max-bag-size", "begin a new file after N bytes (0: never)", type=whole, default=0),
    argument("-d --max-bag-duration", "begin a new file after N seconds (0: never)", type=_duration, default=0),
    argument("--max-cache-size", "ignored: the queue to the disk has its own limit", type=whole, default=0),
    flag("--start-paused", "start paused; SPACE goes on"),
    argument("--node-name", "the name of the recorder's node (default: %(default)s)", default="rosbag2_recorder"),
    argument("--custom-data", "entries for metadata.yaml", metavar="KEY=VALUE", nargs="*", default=[]),
    duration,
    options.unsupported(UNSUPPORTED),
)
