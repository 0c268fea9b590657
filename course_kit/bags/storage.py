"""Opens one storage file of a bag for reading: mcap or sqlite3, closed by its recorder or left as it was killed."""

from __future__ import annotations

import contextlib
import os
import sqlite3
import struct
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rosbags.rosbag2 import Reader

NO_TIME = (1 << 63) - 1  # the starting time of a bag without messages, as rosbag2 has it
MAGIC = b"\x89MCAP0\r\n"
FOOTER = 0x02  # the kind of MCAP record with which the data has ended


class BagError(Exception):
    """A path holds no bag that can be read; the text says why in one line."""


def open_storage(file: Path) -> tuple[Reader, bool]:
    """The open reader of one storage file, and whether the file was closed by who wrote it. Raises NotAsExpected."""
    from rosbags.rosbag2 import Reader

    from course_kit.internals.rosbags_parts import add_type_hashes, unfinished_mcap

    is_mcap = file.suffix != ".db3"
    was_closed = _ends_with_footer(file) if is_mcap else _roll_back(file)
    if is_mcap and not was_closed:
        reader = unfinished_mcap(file, list(_records(file)))
    else:
        reader = Reader(file)
        reader.open()
    if is_mcap:
        add_type_hashes(reader)
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


def _records(file: Path) -> Iterator[tuple[int, int, int]]:
    """Kind, beginning and end of the whole records of an mcap file up to its data's end, from its header on."""
    with open(file, "rb") as stream:
        if stream.read(len(MAGIC)) != MAGIC:
            raise BagError(f"'{file}' is no mcap file, or one of which nothing was written yet")
        size, begin = os.fstat(stream.fileno()).st_size, len(MAGIC)
        while begin + 9 <= size:
            stream.seek(begin)
            kind, length = struct.unpack("<BQ", stream.read(9))
            end = begin + 9 + length
            if kind in (0, FOOTER) or end > size:
                return
            yield kind, begin, end
            begin = end
