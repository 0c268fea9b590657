"""Writes rosbag2's files: storage by rosbags, with the names, metadata and hashes that Jazzy's rosbag2 gives them.

Every flush() leaves all messages so far readable, also after kill -9; what is missing then is metadata.yaml and, in
an mcap file, the index at its end (see bag_files).
"""

from __future__ import annotations

import contextlib
import fcntl
import os
import sqlite3
import threading
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rosbags.interfaces import Connection, ConnectionExtRosbag2, MessageDefinition, MessageDefinitionFormat
from rosbags.rosbag2 import CompressionMode
from rosbags.rosbag2.metadata import dump_qos_v9
from rosbags.rosbag2.storage_mcap import Channel, McapWriter, write_channel
from rosbags.rosbag2.storage_sqlite3 import Sqlite3Writer

from course_kit.bags.metadata import DISTRO, VERSION, as_yaml, metadata_of, write_metadata
from course_kit.bags.storage import NO_TIME
from course_kit.bags.types import definition, type_hash

if TYPE_CHECKING:
    from rosbags.interfaces import Qos


class McapFile(McapWriter):
    """An mcap file whose channels tell the types' hashes, as rosbag2's do."""

    ENDING = ".mcap"

    def __init__(self, path: Path) -> None:
        super().__init__(path.parent, CompressionMode.NONE)  # names the file like the folder
        self.path = self.path.rename(path)
        self.bio.flush()  # an mcap file from the first moment on

    def add_connection(self, connection: Connection, offered_qos_profiles: str) -> None:
        """Make a topic known, with its type's hash."""
        pairs = {"offered_qos_profiles": offered_qos_profiles, "topic_type_hash": connection.digest}
        words = [word.encode() for pair in pairs.items() for word in pair]
        metadata = b"".join(len(word).to_bytes(4, "little") + word for word in words)
        self.channels.append(Channel(connection.id, connection.msgtype, connection.topic, "cdr", metadata))
        self.channel_stats[connection.id] = 0
        write_channel(self.chunk.bio, self.channels[-1], self.schemas)

    @property
    def size(self) -> int:
        """Bytes so far, with those that are not written out yet."""
        return int(self.bio.tell() + self.chunk.bio.tell())

    def flush(self) -> None:
        """Hand everything to the operating system."""
        if self.chunk.msgs:
            self.close_chunk()
        self.bio.flush()

    def close(self, version: int, metadata: str) -> None:
        """Write the index and close the file."""
        if not self.chunk.msgs:  # the format wants 0 where there is no message
            self.chunk.message_start_time = 0
        if not any(self.channel_stats.values()):
            self.message_start_time = 0
        super().close(version, metadata)


class Sqlite3File(Sqlite3Writer):
    """An sqlite3 file that several threads may write to, one at a time."""

    ENDING = ".db3"

    def __init__(self, path: Path) -> None:
        super().__init__(path.parent, CompressionMode.NONE)
        # Opened anew under its own name, by which SQLite finds what to undo after a crash.
        self.conn.close()
        self.path = self.path.rename(path)
        self.conn = sqlite3.connect(self.path, check_same_thread=False)
        self.cursor = self.conn.cursor()
        self.cursor.execute("UPDATE schema SET ros_distro = ?", (DISTRO,))
        self.conn.commit()
        self.size = 0

    def write(self, connection: Connection, timestamp: int, data: bytes | memoryview) -> None:
        """Add a message; `timestamp` in ns."""
        self.size += len(data)
        super().write(connection, timestamp, data)

    def flush(self) -> None:
        """Commit everything."""
        self.conn.commit()


FILES: Mapping[str, type[McapFile | Sqlite3File]] = {"mcap": McapFile, "sqlite3": Sqlite3File}


@dataclass
class _Span:
    """One storage file: its name, and from when to when its messages are."""

    name: str
    start: int = NO_TIME
    end: int = 0
    count: int = 0

    def add(self, nanoseconds: int) -> None:
        self.start, self.end = min(self.start, nanoseconds), max(self.end, nanoseconds)
        self.count += 1

    @property
    def duration(self) -> int:
        return self.end - self.start if self.count else 0


class BagWriter:
    """A new bag in a new folder; safe to use from several threads.

    With `max_size` (bytes) or `max_seconds` it goes on in a further file when one has reached either. Raises
    FileExistsError if the folder is there, OSError or sqlite3.Error when writing fails.
    """

    def __init__(
        self,
        folder: str | os.PathLike[str],
        storage: str = "mcap",
        max_size: int = 0,
        max_seconds: float = 0,
        custom_data: Mapping[str, str] | None = None,
    ) -> None:
        self.folder = Path(os.path.abspath(folder))
        self.storage = storage
        self._max_size, self._max_ns = max_size, int(max_seconds * 1e9)
        self._custom_data = dict(custom_data or {})
        self._connections: dict[str, Connection] = {}
        self._counts: dict[str, int] = {}
        self._spans: list[_Span] = []
        self._thread_lock = threading.RLock()
        self.folder.mkdir(parents=True)
        self._folder_lock = os.open(self.folder, os.O_RDONLY)
        fcntl.flock(self._folder_lock, fcntl.LOCK_EX)
        self._file = self._open_next()

    @property
    def message_count(self) -> int:
        """Messages of all topics so far."""
        return sum(self._counts.values())

    def _open_next(self) -> McapFile | Sqlite3File:
        kind = FILES[self.storage]
        name = f"{self.folder.name}_{len(self._spans)}{kind.ENDING}"
        file = kind(self.folder / name)
        self._spans.append(_Span(name))
        types: set[str] = set()
        for connection in self._connections.values():
            _announce(file, connection, is_new_type=connection.msgtype not in types)
            types.add(connection.msgtype)
        return file

    def add_topic(
        self,
        topic: str,
        type_name: str,
        qos: Sequence[Qos] = (),
        text: str | None = None,
        digest: str | None = None,
    ) -> None:
        """Make a topic known, with the profiles of its publishers; definition and hash are looked up if not given."""
        connection = Connection(
            len(self._connections) + 1,
            topic,
            type_name,
            MessageDefinition(MessageDefinitionFormat.MSG, definition(type_name) if text is None else text),
            type_hash(type_name) if digest is None else digest,
            0,
            ConnectionExtRosbag2("cdr", list(qos)),
            self,
        )
        with self._thread_lock:
            is_new_type = all(other.msgtype != type_name for other in self._connections.values())
            self._connections[topic] = connection
            self._counts[topic] = 0
            _announce(self._file, connection, is_new_type)
            self._file.flush()

    def write(self, topic: str, nanoseconds: int, data: bytes) -> None:
        """Add a serialised message of a known topic, with the time at which it came."""
        with self._thread_lock:
            span = self._spans[-1]
            if span.count and (self._max_size or self._max_ns) and self._is_full(span, nanoseconds):
                self._file.close(VERSION, as_yaml(self._metadata()))
                self._file = self._open_next()
                span = self._spans[-1]
            self._file.write(self._connections[topic], nanoseconds, data)
            self._counts[topic] += 1
            span.add(nanoseconds)

    def _is_full(self, span: _Span, nanoseconds: int) -> bool:
        too_large = 0 < self._max_size <= self._file.size
        too_long = 0 < self._max_ns <= nanoseconds - span.start
        return too_large or too_long

    def flush(self) -> None:
        """Make all messages so far readable, whatever happens to this process."""
        with self._thread_lock:
            self._file.flush()

    def close(self) -> None:
        """Finish the storage file and write metadata.yaml."""
        with self._thread_lock:
            metadata = self._metadata()
            self._file.close(VERSION, as_yaml(metadata))
            write_metadata(self.folder, metadata)
            self._unlock()

    def abort(self) -> None:
        """Leave the files as they are, after an error."""
        with self._thread_lock:
            with contextlib.suppress(Exception):
                self._file.abort()
            self._unlock()

    def _unlock(self) -> None:
        if self._folder_lock >= 0:
            os.close(self._folder_lock)
            self._folder_lock = -1

    def _metadata(self) -> dict[str, Any]:
        return metadata_of(
            self.storage,
            [(span.name, span.start, span.duration, span.count) for span in self._spans],
            [(connection, self._counts[topic]) for topic, connection in self._connections.items()],
            self._custom_data,
        )


def _announce(file: McapFile | Sqlite3File, connection: Connection, is_new_type: bool) -> None:
    assert isinstance(connection.ext, ConnectionExtRosbag2)
    if is_new_type:
        file.add_msgtype(connection)
    profiles = dump_qos_v9(connection.ext.offered_qos_profiles)
    file.add_connection(connection, as_yaml(profiles) if profiles else "")
