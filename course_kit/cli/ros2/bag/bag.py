"""`ros2 bag`: info and reindex here, record and play in modules of their own."""

from __future__ import annotations

import os
import time
from argparse import Namespace
from collections import Counter

from course_kit.cli.ros2.bag import text
from course_kit.cli.ros2.bag.options import BAG, failing_with, say_what_is_left
from course_kit.cli.ros2.session import Session, log_text
from course_kit.cli.ros2.verbs import Verb, argument, flag, one_of


def _info(args: Namespace, session: Session) -> None:
    from course_kit.lab.bags import files as bag_files
    from course_kit.lab.bags.storage import BagError

    with failing_with(BagError):
        found = bag_files.info(args.bag_path)
        sizes = _message_sizes(args.bag_path) if args.verbose else None
    say_what_is_left(found, session)
    if args.topic_name:
        for topic in text.topics_and_events(found, args.sort)[0]:
            session.print(topic.name)
    else:
        session.print(text.info_text(found, args.sort, sizes))


def _message_sizes(path: str) -> Counter[str]:
    """The bytes of all messages of each topic."""
    from course_kit.lab.bags.files import opened

    sizes: Counter[str] = Counter()
    with opened(path) as bag:
        for connection, _, data in bag.messages(bag.connections):
            sizes[connection.topic] += len(data)
    return sizes


def _reindex(args: Namespace, session: Session) -> None:
    from course_kit.lab.bags.repair import reindex
    from course_kit.lab.bags.storage import BagError

    def say(text: str) -> None:
        session.warn(log_text("INFO", "rosbag2_cpp", text, time.time_ns()))

    with failing_with(BagError):
        if not os.path.isdir(args.bag_path):
            raise BagError("Must specify a bag directory")
        say(f'Beginning reindexing bag in directory: "{args.bag_path}"')
        for name, made in reindex(args.bag_path).items():
            what = f"was cut and is kept as '{made.kept}'" if made.kept else "was not closed by its recorder"
            say(f"'{name}' {what}: {made.message_count} messages were found, and it is complete now.")
    say("Reindexing complete.")


VERBS: dict[str, Verb | str] = {
    "info": Verb(
        "show the contents of a bag",
        _info,
        BAG,
        one_of(
            flag("-t --topic-name", "print only the names of the topics"),
            flag("-v --verbose", "print the size of each topic's messages, too"),
        ),
        argument("--sort", "the order of the topics (default: name)", default="name", choices=text.SORTING),
    ),
    "play": "bag.play:PLAY",
    "record": "bag.record:RECORD",
    "reindex": Verb("complete a bag whose recorder was killed, or that has lost its metadata.yaml", _reindex, BAG),
}
