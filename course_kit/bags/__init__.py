"""Bags in notebooks: record topics into a real rosbag2 folder, look into one, read its messages, play it.

    with bags.record("drive", "/turtle1/pose", "/turtle1/cmd_vel"):
        ...
    bags.info("drive").message_count
    for topic, nanoseconds, pose in bags.read("drive", "/turtle1/pose"): ...

What is recorded here `ros2 bag info` and `ros2 bag play` of every ROS 2 Jazzy read, and the other way round.
"""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from course_kit.bags.files import BagInfo, BagTopic, info, opened, storage_files
from course_kit.bags.repair import reindex
from course_kit.bags.storage import BagError
from course_kit.polling import wait_until
from course_kit.watching import topics

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
        """Whether messages are still recorded."""
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


def new_folder(path: str | os.PathLike[str], overwrite: bool) -> Path:
    """The path of a bag that is to be written; one that is there is removed if `overwrite`.

    Raises FileExistsError otherwise, and for a folder that is no bag.
    """
    folder = Path(path)
    if folder.exists():
        if not (overwrite and folder.is_dir() and storage_files(folder)):
            raise FileExistsError(f"Output folder '{path}' already exists.")
        shutil.rmtree(folder)
    return folder


def record(path: str | os.PathLike[str], *names: str, storage: str = "mcap", overwrite: bool = False) -> BagRecording:
    """Record topics, all of them if none is named, into a new bag from now on; also topics that appear later.

    `storage` is mcap or sqlite3. Raises FileExistsError if the folder is there, unless `overwrite` and it is a bag.
    """
    from course_kit.bags.recorder import Recorder
    from course_kit.bags.selection import Selection
    from course_kit.bags.writer import FILES, BagWriter

    if storage not in FILES:
        raise ValueError(f"storage is one of {', '.join(FILES)}, not {storage!r}")
    wanted = [topics.absolute(name) for name in names]
    folder = new_folder(path, overwrite)
    selection = Selection(names=wanted, every=not wanted)
    recorder = Recorder(BagWriter(folder, storage), selection)
    try:
        recorder.start()
        wait_until(lambda: recorder.is_matched, topics.MATCH_TIMEOUT)
    except BaseException:
        recorder.stop()
        raise
    return BagRecording(recorder)


def read(path: str | os.PathLike[str], *names: str) -> Iterator[tuple[str, int, Any]]:
    """(topic, time of receipt in ns, message) of a bag, of the topics named or of all, read as they are asked for.

    Raises BagError if there is no such bag or topic, ModuleNotFoundError if the package of a type is not installed.
    """
    from rclpy.serialization import deserialize_message

    with opened(path) as bag:
        there = {connection.topic for connection in bag.connections}
        wanted = {topics.absolute(name) for name in names} or there
        if missing := sorted(wanted - there):
            raise BagError(f"'{path}' has no topic {', '.join(missing)}. It has: {', '.join(sorted(there))}.")
        connections = [connection for connection in bag.connections if connection.topic in wanted]
        classes = {connection.topic: topics.message_class(connection.msgtype) for connection in connections}
        for connection, nanoseconds, data in bag.messages(connections):
            yield connection.topic, nanoseconds, deserialize_message(bytes(data), classes[connection.topic])


def play(path: str | os.PathLike[str], *names: str, rate: float = 1.0, tick: Callable[[], None] | None = None) -> None:
    """Publish the messages of a bag as they were recorded, `rate` times as fast; returns when the last one is out."""
    from course_kit.bags.player import Player, PlayOptions
    from course_kit.bags.selection import Selection

    if rate <= 0:
        raise ValueError(f"a bag plays at a rate above 0, not {rate:g}")
    options = PlayOptions(rate, selection=Selection([topics.absolute(name) for name in names], every=not names))
    with opened(path) as bag:
        player = Player(bag, options, lambda line: None)
        try:
            wait_until(lambda: player.is_matched, topics.MATCH_TIMEOUT)
            player.play(tick or (lambda: None))
        finally:
            player.close()
