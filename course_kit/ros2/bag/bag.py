"""`ros2 bag`: info and reindex here, record and play in modules of their own."""

from __future__ import annotations

import os
import time
from argparse import ArgumentParser, Namespace

from course_kit.ros2.bag.options import add_bag_arguments, unfinished
from course_kit.ros2.bag.play import PLAY
from course_kit.ros2.bag.record import RECORD
from course_kit.ros2.bag.text import SORTING
from course_kit.ros2.session import Session
from course_kit.ros2.verbs import CommandError, Verb, add_flag


def _info_arguments(parser: ArgumentParser) -> None:
    add_bag_arguments(parser)
    group = parser.add_mutually_exclusive_group()
    add_flag(group, "-t --topic-name", "Only display topic names.")
    add_flag(
        group,
        "-v --verbose",
        "Display request/response information for services and print size contribution of topics",
    )
    parser.add_argument(
        "--sort",
        default="name",
        choices=sorted(SORTING),
        help="Configuration for sorting of output. By default sorts by name",
    )


def _info(args: Namespace, session: Session) -> None:
    from course_kit.bags import files as bag_files
    from course_kit.bags.storage import BagError
    from course_kit.ros2.bag import text

    try:
        found = bag_files.info(args.bag_path)
        sizes = _message_sizes(args.bag_path) if args.verbose else None
    except BagError as error:
        raise CommandError(f"[ERROR] [ros2bag]: {error}") from None
    if not found.is_complete:
        session.warn(unfinished(args.bag_path, found.message_count))
    if args.topic_name:
        for name in text.topic_names(found, args.sort):
            session.print(name)
    else:
        session.print(text.info_text(found, args.sort, sizes))


def _message_sizes(path: str) -> dict[str, int]:
    """The bytes of all messages of each topic."""
    from course_kit.bags.files import opened

    sizes: dict[str, int] = {}
    with opened(path) as bag:
        for connection, _, data in bag.messages(bag.connections):
            sizes[connection.topic] = sizes.get(connection.topic, 0) + len(data)
    return sizes


def _reindex(args: Namespace, session: Session) -> None:
    from course_kit.bags.recorder import BagLogLine
    from course_kit.bags.repair import reindex
    from course_kit.bags.storage import BagError
    from course_kit.ros2.bag.text import log_text

    def say(text: str) -> None:
        session.warn(log_text(BagLogLine("INFO", "rosbag2_cpp", text, time.time_ns())))

    try:
        if not os.path.isdir(args.bag_path):
            raise BagError("Must specify a bag directory")
        say(f'Beginning reindexing bag in directory: "{args.bag_path}"')
        for name, count in reindex(args.bag_path).items():
            say(f"'{name}' was not closed by its recorder: {count} messages were found, and it is complete now.")
    except BagError as error:
        raise CommandError(f"[ERROR] [ros2bag]: {error}") from None
    say("Reindexing complete.")


VERBS = {
    "info": Verb("Print information about a bag to the screen", _info, _info_arguments),
    "play": PLAY,
    "record": RECORD,
    "reindex": Verb("Reconstruct metadata file for a bag", _reindex, add_bag_arguments),
}
