"""Reads the content of a bag from its files: also of one that was never closed, as far as it was written.

A bag is a folder with metadata.yaml and storage files (mcap or sqlite3), or one such file. Its recorder writes
metadata.yaml and the index of an mcap file when it ends. Where it was killed instead, everything up to its last flush
is there, and is found by going through the file.
"""

from __future__ import annotations

import contextlib
import fcntl
import os
import re
import sqlite3
from collections.abc import Iterator, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from course_kit.base.arguments import PATH, takes
from course_kit.lab.bags.storage import BagError, is_cut, open_storage

METADATA = "metadata.yaml"
LATEST = 2**63 - 1  # nanoseconds, as rosbag2 holds them
STORAGES = {".mcap": "mcap", ".db3": "sqlite3"}


@dataclass(frozen=True)
class BagTopic:
    """A topic of a bag and how many of its messages are there."""

    name: str
    type: str
    count: int = 0
    serialization_format: str = "cdr"
    type_hash: str = ""


@dataclass(frozen=True)
class BagInfo:
    """What a bag says of itself; times in nanoseconds since the epoch, sizes in bytes."""

    path: Path
    files: list[str]
    size: int
    storage: str
    distro: str
    start: int
    duration: int
    message_count: int
    topics: list[BagTopic] = field(default_factory=list)
    is_complete: bool = True
    notice: str = ""  # one line that says what is left of a bag that is not complete

    @property
    def end(self) -> int:
        """When the last message came."""
        return self.start + self.duration

    @property
    def seconds(self) -> float:
        """How long the recording is, from its first message to its last."""
        return self.duration * 1e-9


@dataclass(frozen=True)
class OpenBag:
    """The topics (rosbags' connections) and messages of a bag while it is open."""

    path: Path
    connections: list[Any]
    start: int
    is_complete: bool
    readers: Sequence[Any]  # rosbags', one for the bag or one for each storage file
    notice: str = ""

    @property
    def end(self) -> int:
        """When its last message was received; its start, if it has none."""
        return max((reader.end_time - 1 for reader in self.readers if reader.message_count), default=self.start)

    def messages(self, connections: Sequence[Any], start: int | None = None) -> Iterator[tuple[Any, int, bytes]]:
        """(connection, time of receipt, serialised message), in the order of time, from `start` on."""
        if not connections:
            return
        for reader in self.readers:
            wanted = {c.id: own for c in reader.connections for own in connections if _key(c) == _key(own)}
            there = [c for c in reader.connections if c.id in wanted]
            with _telling(self.path):
                for connection, nanoseconds, data in reader.messages(there, start=start) if there else ():
                    yield wanted[connection.id], nanoseconds, data


def _key(connection: Any) -> tuple[str, str]:
    return connection.topic, connection.msgtype


def storage_files(folder: Path) -> list[Path]:
    """The storage files of a bag, in the order in which they were recorded."""

    def number(file: Path) -> tuple[int, str]:
        found = re.search(r"_(\d+)$", file.stem)
        return (int(found[1]) if found else 0), file.name

    return sorted((f for f in folder.iterdir() if f.suffix in STORAGES), key=number)


def is_being_recorded(folder: Path) -> bool:
    """Return True if a recorder of ours is still writing to a bag; it keeps the folder locked."""
    with contextlib.suppress(OSError):
        handle = os.open(folder, os.O_RDONLY)
        try:
            fcntl.flock(handle, fcntl.LOCK_SH | fcntl.LOCK_NB)
        except OSError:
            return True
        finally:
            os.close(handle)
    return False


@takes(path=PATH)
def info(path: str | os.PathLike[str]) -> BagInfo:
    """What a bag holds, from its metadata.yaml or, where it has none or is cut, from its files. Raises BagError."""
    place = Path(path)
    if _is_whole(place):
        return _from_metadata(place)
    with opened(place) as bag:
        counts = [
            BagTopic(c.topic, c.msgtype, c.msgcount, c.ext.serialization_format, c.digest) for c in bag.connections
        ]
        files = storage_files(place) if place.is_dir() else [place]
        return BagInfo(
            place,
            [file.name if place.is_dir() else str(path) for file in files],
            _size(place),
            STORAGES[files[0].suffix],
            _distro(files[0]),
            bag.start,
            bag.end - bag.start,
            sum(topic.count for topic in counts),
            counts,
            bag.is_complete,
            bag.notice,
        )


def _is_whole(place: Path) -> bool:
    """Return True if it is a bag with metadata.yaml, and no file of it is cut."""
    with _telling(place):
        return (place / METADATA).is_file() and not any(map(is_cut, storage_files(place)))


def _from_metadata(folder: Path) -> BagInfo:
    import yaml

    try:
        text = (folder / METADATA).read_text(encoding="utf-8")
        told = yaml.safe_load(text)["rosbag2_bagfile_information"]
        topics = [
            BagTopic(
                entry["topic_metadata"]["name"],
                entry["topic_metadata"]["type"],
                int(entry["message_count"]),
                entry["topic_metadata"]["serialization_format"],
                entry["topic_metadata"].get("type_description_hash", ""),
            )
            for entry in told["topics_with_message_count"]
        ]
        start, duration = told["starting_time"]["nanoseconds_since_epoch"], told["duration"]["nanoseconds"]
        if not -LATEST <= start <= start + duration <= LATEST:
            raise ValueError
        return BagInfo(
            folder,
            [Path(name).name for name in told["relative_file_paths"]],
            _size(folder),
            told["storage_identifier"],
            told.get("ros_distro") or "",
            int(start),
            int(duration),
            int(told["message_count"]),
            topics,
        )
    except OSError as error:
        raise BagError(f"'{folder / METADATA}' cannot be read: {error.strerror}") from None
    except (yaml.YAMLError, ArithmeticError, LookupError, TypeError, ValueError, AttributeError, RecursionError):
        raise BagError(f"'{folder / METADATA}' is no metadata of a bag. 'ros2 bag reindex' makes it anew.") from None


def _size(place: Path) -> int:
    files = place.iterdir() if place.is_dir() else [place]
    return sum(file.stat().st_size for file in files if file.is_file())


def _distro(file: Path) -> str:
    """Which ROS recorded a storage file that has no metadata beside it: only sqlite3 tells from its beginning on."""
    with contextlib.suppress(sqlite3.Error), contextlib.closing(sqlite3.connect(file)) as database:
        if file.suffix == ".db3":
            return str(database.execute("SELECT ros_distro FROM schema").fetchone()[0])
    return ""


@contextlib.contextmanager
def opened(path: str | os.PathLike[str], by_metadata: bool = True) -> Iterator[OpenBag]:
    """A bag, open for reading; not `by_metadata`, its files alone are asked.

    Raises BagError if there is none, or none that can be read.
    """
    from rosbags.rosbag2 import Reader

    place = Path(path)
    if not place.exists():
        raise BagError(f"Bag path '{path}' does not exist!")
    with ExitStack() as stack:
        with _telling(place):
            if by_metadata and _is_whole(place):
                _from_metadata(place)  # says what is wrong better than rosbags does
                reader = stack.enter_context(Reader(place))
                bag = OpenBag(place, list(reader.connections), reader.start_time, True, [reader])
            else:
                bag = _open_files(place, stack)
        yield bag


@contextlib.contextmanager
def _telling(place: Path) -> Iterator[None]:
    """Say in one line why a bag cannot be read: a damaged one makes rosbags raise whatever its bytes lead to."""
    try:
        yield
    except BagError:
        raise
    except OSError as error:
        raise BagError(f"'{place}' cannot be read: {error.strerror or error}") from None
    except Exception as error:
        raise BagError(f"'{place}' cannot be read as a bag: {error}") from None


def _open_files(place: Path, stack: ExitStack) -> OpenBag:
    """The storage files of a bag without metadata.yaml, or one storage file."""
    files = storage_files(place) if place.is_dir() else [place]
    if not files or files[0].suffix not in STORAGES:
        raise BagError(f"'{place}' holds no bag: neither {METADATA} nor a file *.mcap or *.db3")
    readers, is_complete = [], not place.is_dir()
    for file in files:
        reader, was_closed = open_storage(file)
        stack.callback(reader.close)
        readers.append(reader)
        is_complete = is_complete and was_closed
    merged: dict[tuple[str, str], Any] = {}
    for connection in (c for reader in readers for c in reader.connections):
        known = merged.get(_key(connection))
        count = connection.msgcount + (known.msgcount if known else 0)
        merged[_key(connection)] = (known or connection)._replace(msgcount=count)
    start = min(reader.start_time for reader in readers)
    notice = "" if is_complete else _notice(place, files, sum(reader.message_count for reader in readers))
    return OpenBag(place, list(merged.values()), start, is_complete, readers, notice)


def _notice(place: Path, files: Sequence[Path], count: int) -> str:
    """The line that says what can be had of a bag that its recorder has not closed, or that was cut."""
    folder = place if place.is_dir() else place.parent
    if is_being_recorded(folder):
        return f"'{place}' is still being recorded: {count} messages can be read by now."
    was_closed, told = (place / METADATA).is_file(), ""
    if was_closed or any(file.suffix == ".db3" and is_cut(file) for file in files):
        with contextlib.suppress(BagError):
            told = f" of its {_from_metadata(place).message_count}" if was_closed else ""
        return (
            f"'{place}' is cut: {count}{told} messages can be read. 'ros2 bag reindex {folder}' makes them a whole bag."
        )
    return (
        f"'{place}' was not closed by its recorder: {count} messages can be read. "
        f"'ros2 bag reindex {folder}' completes it."
    )
