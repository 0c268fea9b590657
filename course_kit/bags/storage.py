"""Opens one storage file of a bag for reading: mcap or sqlite3, closed by its recorder or left as it was killed."""

from __future__ import annotations

import contextlib
import os
import sqlite3
import struct
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

NO_TIME = (1 << 63) - 1  # the starting time of a bag without messages, as rosbag2 has it
MAGIC = b"\x89MCAP0\r\n"
FOOTER, CHUNK = 0x02, 0x06  # kinds of MCAP records


class BagError(Exception):
    """A path holds no bag that can be read; the text says why in one line."""


def open_storage(file: Path) -> tuple[Any, bool]:
    """The open reader of one storage file, and whether the file was closed by who wrote it."""
    if file.suffix == ".db3":
        from rosbags.rosbag2.storage_sqlite3 import Sqlite3Reader

        was_closed = _roll_back(file)
        database = Sqlite3Reader(file)
        database.open()
        return database, was_closed
    was_closed = _ends_with_footer(file)
    if was_closed:
        from rosbags.rosbag2.storage_mcap import McapReader

        reader = McapReader(file)
    else:
        reader = _unfinished_reader(file)
    reader.open()
    _read_hashes(reader)
    return reader, was_closed


def _roll_back(file: Path) -> bool:
    """Have SQLite undo what a killed recorder had not committed; return whether the recorder had ended well."""
    try:
        with contextlib.closing(sqlite3.connect(file)) as database:
            database.execute("SELECT count(*) FROM topics").fetchone()
            return bool(database.execute("SELECT count(*) FROM metadata").fetchone()[0])
    except sqlite3.OperationalError:  # a bag of an earlier ROS, without this table, or one that is being written
        return True
    except sqlite3.DatabaseError as error:
        raise BagError(f"'{file}' cannot be read: {error}") from None


def _ends_with_footer(file: Path) -> bool:
    with open(file, "rb") as stream:
        size = stream.seek(0, os.SEEK_END)
        stream.seek(max(0, size - len(MAGIC)))
        return size > 2 * len(MAGIC) and stream.read() == MAGIC


def _unfinished_reader(file: Path) -> Any:
    """A reader of an mcap file without its end: it finds the chunks itself."""
    from rosbags.rosbag2.storage_mcap import ChunkInfo, McapReader, ReaderMetadata

    class UnfinishedMcapReader(McapReader):
        def _open(self) -> None:
            assert self.bio is not None
            records = list(_records(self.bio, file))
            self.data_start = records[0].end if records else self.bio.tell()
            self.data_end = records[-1].end if records else self.data_start
            self.meta_scan()
            assert self.statistics is not None
            found = self.statistics
            counts = found.channel_message_counts
            self.connections = [c._replace(msgcount=counts.get(c.id, 0)) for c in self.connections]
            if found.message_count:
                span = (found.end_time - found.start_time + 1, found.start_time, found.end_time + 1)
            else:
                span = (0, NO_TIME, 0)
            self.metadata = ReaderMetadata(*span, found.message_count, None, None, None, None)
            everywhere = dict.fromkeys((c.id for c in self.connections), 1)
            for record in records:
                if record.kind == CHUNK:
                    self.bio.seek(record.begin + 9)
                    first, last, size, _ = struct.unpack("<QQQI", self.bio.read(28))
                    compression = self.bio.read(int.from_bytes(self.bio.read(4), "little")).decode()
                    compressed = int.from_bytes(self.bio.read(8), "little")
                    length = record.end - record.begin
                    self.chunks.append(
                        ChunkInfo(first, last, record.begin, length, {}, 0, compression, compressed, size, everywhere)
                    )

    return UnfinishedMcapReader(file)


@dataclass(frozen=True)
class _Record:
    kind: int
    begin: int
    end: int


def _records(stream: Any, file: Path) -> Iterator[_Record]:
    """The whole records of an mcap file up to its data's end, from its header on."""
    size = stream.seek(0, os.SEEK_END)
    stream.seek(0)
    if stream.read(len(MAGIC)) != MAGIC:
        raise BagError(f"'{file}' is no mcap file, or one of which nothing was written yet")
    begin = len(MAGIC)
    while begin + 9 <= size:
        stream.seek(begin)
        kind, length = struct.unpack("<BQ", stream.read(9))
        if kind in (0, FOOTER) or begin + 9 + length > size:
            return
        yield _Record(kind, begin, begin + 9 + length)
        begin += 9 + length


def _read_hashes(reader: Any) -> None:
    """Give the connections of an mcap file the type hashes that its channels tell, which rosbags leaves out."""
    reader.connections = [
        c._replace(digest=c.digest or channel_words(reader, c.id).get("topic_type_hash", ""))
        for c in reader.connections
    ]


def channel_words(reader: Any, channel: int) -> dict[str, str]:
    """What a channel of an open mcap file says of its topic: offered_qos_profiles, topic_type_hash."""
    return _pairs(reader.channels[channel].metadata)


def _pairs(data: bytes) -> dict[str, str]:
    """The names and values of an MCAP map of strings."""
    words, place = [], 0
    while place + 4 <= len(data):
        end = place + 4 + int.from_bytes(data[place : place + 4], "little")
        words.append(data[place + 4 : end].decode(errors="replace"))
        place = end
    return dict(zip(words[::2], words[1::2], strict=False))
