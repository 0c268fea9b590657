"""`ros2 bag play`: publishes a bag as it was recorded."""

from __future__ import annotations

import time
from argparse import ArgumentParser, ArgumentTypeError, Namespace
from functools import partial
from typing import TYPE_CHECKING, Any

from course_kit.ros2.bag.options import (
    add_bag_arguments,
    add_unsupported,
    check_patterns,
    qos_overrides,
    readable_file,
    refuse_unsupported,
    show,
    unfinished,
)
from course_kit.ros2.session import DurationOver, Session
from course_kit.ros2.verbs import CommandError, Verb, add_duration_argument

if TYPE_CHECKING:
    from course_kit.bags.files import OpenBag
    from course_kit.bags.player import Player, PlayOptions

CLOCK_RATE = 40.0  # Hz of --clock without a number
UNSUPPORTED: dict[str, dict[str, Any]] = {
    "--services": {"nargs": "+"},
    "--exclude-services": {"nargs": "+"},
    "--storage-config-file": {},
    "--clock-topics": {"nargs": "+"},
    "--clock-topics-all": {"action": "store_true"},
    "--publish-service-requests": {"action": "store_true"},
}
KEY_LINES = (
    "Adding keyboard callbacks.",
    "Press SPACE for Pause/Resume",
    "Press CURSOR_RIGHT for Play Next Message",
    "Press CURSOR_UP for Increase Rate 10%",
    "Press CURSOR_DOWN for Decrease Rate 10%",
)


def _positive(text: str) -> float:
    value = _number(text)
    if not value > 0:
        raise ArgumentTypeError(f"{text} is not in the valid range (> 0.0)")
    return value


def _not_negative(text: str) -> float:
    value = _number(text)
    if not value >= 0:
        raise ArgumentTypeError(f"Value {text} is less than zero.")
    return value


def _number(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise ArgumentTypeError(f"{text} is not the valid type (float)") from None


def _arguments(parser: ArgumentParser) -> None:
    add = parser.add_argument
    add_bag_arguments(parser)
    add("--read-ahead-queue-size", type=int, default=1000, help="size of message queue rosbag tries to hold in memory")
    add("-r", "--rate", type=_positive, default=1.0, help="rate at which to play back messages. Valid range > 0.0.")
    add("--topics", default=[], metavar="topic", nargs="+", help="Space-delimited list of topics to play.")
    add("-e", "--regex", default="", help="Play only topics and services matches with regular expression.")
    add("-x", "--exclude-regex", default="", help="regular expressions to exclude topics and services from replay.")
    add("--exclude-topics", default=[], metavar="topic", nargs="+", help="Space-delimited list of topics not to play.")
    add(
        "--qos-profile-overrides-path",
        type=readable_file,
        help="Path to a yaml file defining overrides of the QoS profile for specific topics.",
    )
    add(
        "-l",
        "--loop",
        action="store_true",
        help="enables loop playback when playing a bagfile: it starts back at the beginning on reaching the end and "
        "plays indefinitely.",
    )
    add(
        "--remap",
        "-m",
        default=[],
        nargs="+",
        help='list of topics to be remapped: in the form "old_topic1:=new_topic1 old_topic2:=new_topic2 etc." ',
    )
    add(
        "--clock",
        type=_positive,
        nargs="?",
        const=CLOCK_RATE,
        default=0,
        help="Publish to /clock at a specific frequency in Hz, to act as a ROS Time Source. Value must be positive. "
        "Defaults to not publishing.",
    )
    add(
        "-d",
        "--delay",
        type=_not_negative,
        default=0.0,
        help="Sleep duration before play (each loop), in seconds. Negative durations invalid.",
    )
    add(
        "--playback-duration",
        type=float,
        default=-1.0,
        help="Playback duration, in seconds. Negative durations mark an infinite playback. Default is %(default)d.",
    )
    add("--disable-keyboard-controls", action="store_true", help="disables keyboard controls for playback")
    add("-p", "--start-paused", action="store_true", help="Start the playback player in a paused state.")
    add(
        "--start-offset",
        type=_not_negative,
        default=0.0,
        help="Start the playback player this many seconds into the bag file.",
    )
    add(
        "--wait-for-all-acked",
        type=int,
        default=-1,
        metavar="TIMEOUT",
        help="Accepted: it always waits up to a second.",
    )
    add("--disable-loan-message", action="store_true", help="Accepted: messages are never loaned.")
    add("--log-level", default="info", choices=["debug", "info", "warn", "error", "fatal"], help="Logging level.")
    add_duration_argument(parser)
    add_unsupported(parser, UNSUPPORTED)


def _play(args: Namespace, session: Session) -> int:
    refuse_unsupported(args, UNSUPPORTED)
    options = _options(args)

    from rosbags.rosbag2 import ReaderError

    from course_kit.bags.files import opened
    from course_kit.bags.storage import BagError
    from course_kit.ros2.bag.keys import Keys

    has_keys = not (session.in_notebook or args.disable_keyboard_controls)
    try:
        with opened(args.bag_path) as bag, Keys(has_keys) as keys:
            if not bag.is_complete:
                session.warn(unfinished(args.bag_path, sum(c.msgcount for c in bag.connections)))
            return _run(bag, options, session, keys, has_keys, args.log_level)
    except (BagError, ReaderError) as error:
        raise CommandError(f"[ERROR] [ros2bag]: {error}") from None


def _run(bag: OpenBag, options: PlayOptions, session: Session, keys: Any, has_keys: bool, log_level: str) -> int:
    """Play until the end, or until something ends it."""
    from course_kit.bags.player import NODE, Player
    from course_kit.bags.recorder import BagLogLine
    from course_kit.watching import topics

    say = partial(show, session=session, log_level=log_level)
    try:
        player = Player(bag, options, say)
    except ValueError as error:
        raise CommandError(f"[ERROR] [ros2bag]: {error}") from None
    for text in KEY_LINES if has_keys else ():
        say(BagLogLine("INFO", NODE, text, time.time_ns()))

    def tick() -> None:
        session.check_time()
        if key := keys.pressed():
            _act(key, player)

    try:
        session.graph()  # who listens already gets the first message too
        session.until(lambda: player.is_matched, topics.MATCH_TIMEOUT)
        player.play(tick)
        return 0
    except (SystemExit, KeyboardInterrupt, DurationOver) as ending:
        say(BagLogLine("INFO", NODE, "Stopping playback.", time.time_ns()))
        if isinstance(ending, SystemExit):
            return 0
        raise
    finally:
        player.close()


def _act(key: str, player: Player) -> None:
    from course_kit.ros2.bag.keys import DOWN, RIGHT, SPACE, UP

    if key == SPACE:
        player.toggle_pause()
    elif key == RIGHT:
        player.play_next()
    elif key == UP:
        player.set_rate(player.clock.rate * 1.1)
    elif key == DOWN:
        player.set_rate(player.clock.rate * 0.9)


def _options(args: Namespace) -> PlayOptions:
    """What the command line asks for; CommandError for what cannot be."""
    from course_kit.bags.player import PlayOptions
    from course_kit.bags.selection import Selection
    from course_kit.watching import topics

    try:
        remap = {}
        for rule in args.remap:
            old, separator, new = rule.partition(":=")
            if not separator:
                raise ValueError(f"'{rule}' is no remapping: write it like '/old_topic:=/new_topic'")
            remap[topics.absolute(old)] = topics.absolute(new)
        check_patterns(args)
        return PlayOptions(
            rate=args.rate,
            loop=args.loop,
            delay=args.delay,
            start_offset=args.start_offset,
            duration=None if args.playback_duration < 0 else args.playback_duration,
            selection=Selection(
                [topics.absolute(name) for name in args.topics],
                regex=args.regex,
                every=not (args.topics or args.regex),
                exclude_names=[topics.absolute(name) for name in args.exclude_topics],
                exclude_regex=args.exclude_regex,
            ),
            remap=remap,
            overrides=qos_overrides(args.qos_profile_overrides_path),
            clock_rate=args.clock,
            read_ahead=args.read_ahead_queue_size,
            starts_paused=args.start_paused,
        )
    except ValueError as error:
        raise CommandError(f"[ERROR] [ros2bag]: {error}") from None


PLAY = Verb("Play back ROS data from a bag", _play, _arguments)
