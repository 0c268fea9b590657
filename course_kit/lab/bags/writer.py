"""Writes rosbag2's files: storage by rosbags, with the names, metadata and hashes that Jazzy's rosbag2 gives them.

Every flush() leaves all messages so far readable, also after kill -9; what is missing then is metadata.yaml and, in
an mcap file, the index at its end (see files.py).
"""

from __future__ import annotations

import contextlib
import errno
import os
import shutil
import sqlite3
import threading
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rosbags.interfaces import Connection, ConnectionExtRosbag2, MessageDefinition, MessageDefinitionFormat

from course_kit.base.atomic_files import NotWritten, writing
from course_kit.base.file_locks import acquire
from course_kit.base.polling import wait_until
from course_kit.lab.bags.metadata import VERSION, Span, as_yaml, metadata_of, profiles_of, write_metadata
from course_kit.lab.bags.storage import BagError
from course_kit.lab.bags.types import definition, type_hash
from course_kit.ros.private_api import NotAsExpected
from course_kit.ros.private_api.rosbags_parts import FILES, StorageFile

if TYPE_CHECKING:
    from rosbags.interfaces import Qos


LOCK_TIMEOUT = 5.0  # seconds; who looks whether it is being recorded has it for a moment


class BagWriter:
    """A new bag in a new folder; safe to use from several threads.

    With `max_size` (bytes) or `max_seconds` it goes on in a further file when one has reached either. Raises
    FileExistsError if the folder is there, NotWritten if nothing can be written there, BagError if no files of this
    kind can be, OSError or sqlite3.Error when writing fails later.
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
        self._spans: list[Span] = []
        self._thread_lock = threading.RLock()
        if os.path.lexists(self.folder):
            raise FileExistsError(errno.EEXIST, os.strerror(errno.EEXIST), os.fspath(folder))
        with writing(folder):
            self.folder.mkdir(parents=True)
        self._folder_lock = os.open(self.folder, os.O_RDONLY)
        try:
            if not wait_until(lambda: acquire(self._folder_lock), LOCK_TIMEOUT):
                raise BagError(f"'{folder}' is new, and another program keeps it locked: choose another name")
            with writing(folder):
                self._file = self._open_next()
        except BaseException as error:
            self._unlock()
            shutil.rmtree(self.folder, ignore_errors=True)
            if isinstance(error, NotAsExpected):
                raise BagError(f"No bag of {storage} can be written: {error}") from None
            if isinstance(error, sqlite3.Error):  # which has no numbers of the system's
                full = OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
                raise NotWritten(full if "full" in str(error) else OSError(errno.EIO, str(error)), folder) from None
            raise

    @property
    def message_count(self) -> int:
        """Messages of all topics so far."""
        return sum(self._counts.values())

    def _open_next(self) -> StorageFile:
        kind = FILES[self.storage]
        name = f"{self.folder.name}_{len(self._spans)}{kind.ENDING}"
        file = kind(self.folder / name)
        self._spans.append(Span(name))
        for connection in self._connections.values():
            announce(file, connection)
        return file

    def add_topic(self, topic: str, type_name: str, qos: Sequence[Qos] = (), digest: str | None = None) -> None:
        """Make a topic known, with the profiles of its publishers; its type's hash is looked up if not given."""
        connection = Connection(
            len(self._connections) + 1,
            topic,
            type_name,
            MessageDefinition(MessageDefinitionFormat.MSG, definition(type_name)),
            type_hash(type_name) if digest is None else digest,
            0,
            ConnectionExtRosbag2("cdr", list(qos)),
            self,
        )
        with self._thread_lock:
            self._connections[topic] = connection
            self._counts[topic] = 0
            announce(self._file, connection)
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
            span.start, span.end = min(span.start, nanoseconds), max(span.end, nanoseconds)
            span.count += 1

    def _is_full(self, span: Span, nanoseconds: int) -> bool:
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
        topics = [connection._replace(msgcount=self._counts[topic]) for topic, connection in self._connections.items()]
        return metadata_of(self.storage, self._spans, topics, self._custom_data)


def announce(file: StorageFile, connection: Connection) -> None:
    """Make a topic known to a storage file, with the profiles of its publishers."""
    profiles = profiles_of(connection)
    file.add(connection, as_yaml(profiles) if profiles else "")
