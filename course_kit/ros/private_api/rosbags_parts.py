"""The storage files of a bag one by one, below rosbags' public classes: written flush by flush, read without an end.

rosbags' writer makes a bag readable when it is closed, its reader reads what was closed, and neither has the types'
hashes of mcap files. What was closed is read through the public rosbags.rosbag2.Reader, whatever stands here.
"""

from __future__ import annotations

import contextlib
import os
import sqlite3
import struct
from collections.abc import Iterator, Sequence
from importlib.metadata import version
from operator import attrgetter
from pathlib import Path
from typing import Any, BinaryIO

from rosbags.interfaces import Connection
from rosbags.rosbag2 import CompressionMode, Reader

from course_kit.ros.private_api import NotAsExpected, going_on_without

DISTRO = os.environ.get("ROS_DISTRO") or "jazzy"
CHUNK = 0x06  # the kind of MCAP records that hold messages


@contextlib.contextmanager
def _known(what: str) -> Iterator[None]:
    """Raise NotAsExpected where rosbags has not what is used, or has it in another form."""
    try:
        yield
    except (ImportError, AttributeError, KeyError, TypeError) as error:
        raise NotAsExpected(f"rosbags {version('rosbags')} {what} in another way here ({error})") from None


class _NewFile:
    """A new storage file, to which topics and messages are added. Raises NotAsExpected."""

    def __init__(self, writer: Any) -> None:
        self._writer = writer
        self._types: set[str] = set()
        self.abort = writer.abort  # closes the file as it is

    def add(self, connection: Connection, profiles: str) -> None:
        """Make a topic known; `profiles` are those of its publishers, as YAML."""
        if connection.msgtype not in self._types:
            self._types.add(connection.msgtype)
            self._writer.add_msgtype(connection)
        self._add_connection(connection, profiles)

    def _add_connection(self, connection: Connection, profiles: str) -> None:
        self._writer.add_connection(connection, profiles)


class McapFile(_NewFile):
    """An mcap file whose channels tell the types' hashes, as rosbag2's do."""

    ENDING = ".mcap"

    def __init__(self, path: Path) -> None:
        with _known("writes mcap files"):
            from rosbags.rosbag2 import storage_mcap

            super().__init__(storage_mcap.McapWriter(path.parent, CompressionMode.NONE))
            self._writer.path.rename(path)  # rosbags names it like the folder
            attrgetter("channels", "schemas", "channel_stats", "message_start_time", "close_chunk")(self._writer)
            attrgetter("bio", "msgs", "message_start_time")(self._writer.chunk)
            self.write = self._writer.write  # with connection, nanoseconds and data of a message
            self._channel, self._write_channel = storage_mcap.Channel, storage_mcap.write_channel
            self._writer.bio.flush()  # an mcap file from the first moment on

    @property
    def size(self) -> int:
        """Bytes so far, with those that are not written out yet."""
        return int(self._writer.bio.tell() + self._writer.chunk.bio.tell())

    def _add_connection(self, connection: Connection, profiles: str) -> None:
        writer = self._writer
        pairs = {"offered_qos_profiles": profiles, "topic_type_hash": connection.digest}
        words = [word.encode() for pair in pairs.items() for word in pair]
        metadata = b"".join(len(word).to_bytes(4, "little") + word for word in words)
        writer.channels.append(self._channel(connection.id, connection.msgtype, connection.topic, "cdr", metadata))
        writer.channel_stats[connection.id] = 0
        self._write_channel(writer.chunk.bio, writer.channels[-1], writer.schemas)

    def flush(self) -> None:
        """Hand everything to the operating system, in a chunk of its own."""
        if self._writer.chunk.msgs:
            self._writer.close_chunk()
        self._writer.bio.flush()

    def close(self, metadata_version: int, metadata: str) -> None:
        """Write the bag's metadata and the index, and close the file."""
        if not self._writer.chunk.msgs:  # the format wants 0 where there is no message
            self._writer.chunk.message_start_time = 0
        if not any(self._writer.channel_stats.values()):
            self._writer.message_start_time = 0
        self._writer.close(metadata_version, metadata)


class Sqlite3File(_NewFile):
    """An sqlite3 file that several threads may write to, one at a time."""

    ENDING = ".db3"

    def __init__(self, path: Path) -> None:
        with _known("writes sqlite3 files"):
            from rosbags.rosbag2 import storage_sqlite3

            super().__init__(storage_sqlite3.Sqlite3Writer(path.parent, CompressionMode.NONE))
            # Opened anew under its own name, by which SQLite finds what to undo after a crash.
            self._writer.conn.close()
            self._writer.path.rename(path)
            self._writer.conn = sqlite3.connect(path, check_same_thread=False)
            self._writer.cursor = self._writer.conn.cursor()
            self._writer.cursor.execute("UPDATE schema SET ros_distro = ?", (DISTRO,))
            self.close = self._writer.close  # with the bag's metadata version and metadata
            self.size = 0  # bytes of messages so far, with those that are not written out yet
            self.flush()

    def write(self, connection: Connection, timestamp: int, data: bytes) -> None:
        """Add a message; `timestamp` in ns."""
        self.size += len(data)
        self._writer.write(connection, timestamp, data)

    def flush(self) -> None:
        """Commit everything."""
        self._writer.conn.commit()


StorageFile = McapFile | Sqlite3File
FILES: dict[str, type[StorageFile]] = {"mcap": McapFile, "sqlite3": Sqlite3File}


def unfinished_mcap(file: Path, records: Sequence[tuple[int, int, int]], stream: BinaryIO) -> Reader:
    """The open reader of an mcap file that has no end, from its whole records: kind, first byte, one after the last.

    They are read from `stream`, which ends with the reader. Raises NotAsExpected.
    """
    with contextlib.ExitStack() as stack, _known("reads mcap files"):
        from rosbags.rosbag2 import storage_mcap

        stack.callback(stream.close)
        reader = Reader(file)
        storage: Any = reader.storage
        storage.bio = stream
        if records:
            storage.data_start, storage.data_end = records[0][2], records[-1][2]
        storage.meta_scan()
        found: Any = storage.statistics
        counts = found.channel_message_counts
        storage.connections = [c._replace(msgcount=counts.get(c.id, 0)) for c in storage.connections]
        if found.message_count:
            storage.metadata = storage.metadata._replace(
                duration=found.end_time - found.start_time + 1,
                start_time=found.start_time,
                end_time=found.end_time + 1,
                message_count=found.message_count,
            )
        everywhere = dict.fromkeys((c.id for c in storage.connections), 1)
        for kind, begin, end in records:
            if kind == CHUNK:
                storage.bio.seek(begin + 9)
                first, last, size, _, letters = struct.unpack("<QQQII", storage.bio.read(32))
                compression = storage.bio.read(letters).decode()
                compressed = int.from_bytes(storage.bio.read(8), "little")
                where = first, last, begin, end - begin
                storage.chunks.append(storage_mcap.ChunkInfo(*where, {}, 0, compression, compressed, size, everywhere))
        reader.is_open = True
        stack.pop_all()
        return reader


def add_type_hashes(reader: Reader) -> None:
    """Give the connections of an open mcap file the type hashes that its channels tell, which rosbags leaves out."""
    without = "bags without metadata.yaml are read without the hashes of their types"
    with going_on_without(without), _known("keeps an mcap file's channels"):
        storage: Any = reader.storage
        storage.connections = [
            c._replace(digest=_words(storage.channels[c.id].metadata).get("topic_type_hash", ""))
            for c in storage.connections
        ]


def _words(data: bytes) -> dict[str, str]:
    """The names and values of an MCAP map of strings."""
    words, place = [], 0
    while place + 4 <= len(data):
        end = place + 4 + int.from_bytes(data[place : place + 4], "little")
        words.append(data[place + 4 : end].decode(errors="replace"))
        place = end
    return dict(zip(words[::2], words[1::2], strict=False))
