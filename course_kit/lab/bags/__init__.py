"""Bags in notebooks: record topics into a real rosbag2 folder, look into one, read its messages, play it.

    with bags.record("drive", "/turtle1/pose", "/turtle1/cmd_vel"):
        ...
    bags.info("drive").message_count
    for topic, nanoseconds, pose in bags.read("drive", "/turtle1/pose"): ...

What is recorded here `ros2 bag info` and `ros2 bag play` of every ROS 2 Jazzy read, and the other way round.
"""

from __future__ import annotations

import contextlib
import os
import shutil
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from course_kit.base.arguments import PATH, RATE, TEXT, takes
from course_kit.base.atomic_files import writing
from course_kit.base.polling import wait_until
from course_kit.lab.bags.files import BagInfo, BagTopic, OpenBag, info, is_being_recorded, opened, storage_files
from course_kit.lab.bags.repair import reindex
from course_kit.lab.bags.storage import BagError
from course_kit.ros.subscriptions import topics

__all__ = ["BagError", "BagInfo", "BagRecording", "BagTopic", "info", "play", "read", "record", "reindex"]


class BagRecording:
    """A recording that goes on in the background until stop() or the end of its `with` block."""

    def __init__(self, recorder: Any) -> None:
        self._recorder = recorder
        self.path = recorder.writer.folder

    def __repr__(self) -> str:
        state = "recording" if self.is_running else "stopped"
        return f"<bag {self.path.name}, {state}: {self.message_count:,} messages of {len(self.topics)} topics>"

    @property
    def is_running(self) -> bool:
        """True if messages are still recorded."""
        return bool(self._recorder.is_running)

    @property
    def topics(self) -> list[str]:
        """The topics that are recorded; one that nobody publishes yet comes later."""
        return list(self._recorder.topics)

    @property
    def message_count(self) -> int:
        """Messages that are written."""
        return int(self._recorder.writer.message_count)

    @property
    def lost(self) -> int:
        """Messages that did not arrive, or could not be written in time."""
        return int(self._recorder.lost + self._recorder.dropped)

    def stop(self) -> None:
        """End the recording and close the bag. Raises BagError if writing failed. Safe to call twice."""
        self._recorder.stop()
        if self._recorder.error:
            raise BagError(self._recorder.error)

    def __enter__(self) -> BagRecording:
        return self

    def __exit__(self, *_: object) -> None:
        self.stop()


def refuse_what_is_there(path: str | os.PathLike[str], overwrite: bool) -> Path:
    """The path of a bag that is to be written. Raises FileExistsError if it is there, unless a bag and `overwrite`."""
    folder = Path(path)
    if folder.exists() and not (overwrite and folder.is_dir() and storage_files(folder)):
        raise FileExistsError(f"Output folder '{path}' already exists.")
    return folder


@takes(path=PATH, names=TEXT, storage=TEXT)
def record(path: str | os.PathLike[str], *names: str, storage: str = "mcap", overwrite: bool = False) -> BagRecording:
    """Record topics, all of them if none is named, into a new bag from now on; also topics that appear later.

    `storage` is mcap or sqlite3. Raises FileExistsError if the folder is there, unless `overwrite` and it is a bag;
    NotWritten if nothing can be written there.
    """
    from course_kit.lab.bags.recorder import Recorder
    from course_kit.lab.bags.selection import Selection
    from course_kit.lab.bags.writer import FILES, BagWriter

    if storage not in FILES:
        raise ValueError(f"storage is one of {', '.join(FILES)}, not {storage!r}")
    wanted = [topics.absolute(name) for name in names]
    folder = refuse_what_is_there(path, overwrite)
    if folder.exists():
        with writing(folder):
            shutil.rmtree(folder)
    selection = Selection(names=wanted, every=not wanted)
    recorder = Recorder(BagWriter(folder, storage), selection)
    try:
        recorder.start()
        wait_until(lambda: recorder.is_matched, topics.MATCH_TIMEOUT)
    except BaseException:
        recorder.stop()
        raise
    return BagRecording(recorder)


@contextlib.contextmanager
def told(path: str | os.PathLike[str]) -> Iterator[OpenBag]:
    """A bag that is open for reading, as opened() gives it; one line says what is left of one that is not complete."""
    with opened(path) as bag:
        if bag.notice and not is_being_recorded(bag.path):
            print(f"bags: {bag.notice}", file=sys.stderr)
        yield bag


@takes(path=PATH, names=TEXT)
def read(path: str | os.PathLike[str], *names: str) -> Iterator[tuple[str, int, Any]]:
    """(topic, time of receipt in ns, message) of a bag, of the topics named or of all, read as they are asked for.

    Of a bag that was cut it gives what is left, and says so. Raises BagError if there is no such bag or topic,
    ModuleNotFoundError if the package of a type is not installed.
    """
    from rclpy.serialization import deserialize_message

    with told(path) as bag:
        there = {connection.topic for connection in bag.connections}
        wanted = {topics.absolute(name) for name in names} or there
        if missing := sorted(wanted - there):
            raise BagError(f"'{path}' has no topic {', '.join(missing)}. It has: {', '.join(sorted(there))}.")
        connections = [connection for connection in bag.connections if connection.topic in wanted]
        classes = {connection.topic: topics.message_class(connection.msgtype) for connection in connections}
        for connection, nanoseconds, data in bag.messages(connections):
            yield connection.topic, nanoseconds, deserialize_message(bytes(data), classes[connection.topic])


@takes(path=PATH, names=TEXT, rate=RATE)
def play(path: str | os.PathLike[str], *names: str, rate: float = 1.0, tick: Callable[[], None] | None = None) -> None:
    """Publish the messages of a bag as they were recorded, `rate` times as fast; returns when the last one is out."""
    from course_kit.lab.bags.player import Player, PlayOptions
    from course_kit.lab.bags.selection import Selection

    options = PlayOptions(rate, selection=Selection([topics.absolute(name) for name in names], every=not names))
    with told(path) as bag:
        player = Player(bag, options, lambda line: None)
        try:
            wait_until(lambda: player.is_matched, topics.MATCH_TIMEOUT)
            player.play(tick or (lambda: None))
        finally:
            player.close()
