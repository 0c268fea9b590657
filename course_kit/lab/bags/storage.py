"""Opens one storage file of a bag for reading: mcap or sqlite3, closed by its recorder or left as it was killed."""

from __future__ import annotations

import contextlib
import sqlite3
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

from course_kit.lab.bags import cut_mcap, cut_sqlite

if TYPE_CHECKING:
    from rosbags.rosbag2 import Reader

NO_TIME = (1 << 63) - 1  # the starting time of a bag without messages, as rosbag2 has it


class BagError(Exception):
    """A path holds no bag that can be read; the text says why in one line, which is what a notebook shows."""

    def _render_traceback_(self) -> list[str]:
        return [str(self)]


def open_storage(file: Path) -> tuple[Reader, bool]:
    """The open reader of one storage file, and whether it is as who wrote it has closed it. Raises NotAsExpected."""
    from rosbags.rosbag2 import Reader

    from course_kit.ros.private_api.rosbags_parts import add_type_hashes, unfinished_mcap

    is_mcap = file.suffix != ".db3"
    if not is_mcap and cut_sqlite.is_cut(file):
        with tempfile.TemporaryDirectory(prefix="course-kit-bag-") as folder:  # may go as soon as its file is open
            reader = Reader(cut_sqlite.salvage(file, Path(folder, file.name)))
            reader.open()
        return reader, False
    was_closed = cut_mcap.has_end(file) if is_mcap else _roll_back(file)
    if is_mcap and not was_closed:
        found = cut_mcap.whole_records(file)
        if found is None:
            raise BagError(f"'{file}' is no mcap file, or one of which nothing was written yet")
        reader = unfinished_mcap(file, *found)
    else:
        reader = Reader(file)
        reader.open()
    if is_mcap:
        add_type_hashes(reader)
    return reader, was_closed


def is_cut(file: Path) -> bool:
    """Return True if the end is missing of a storage file that was closed."""
    return not cut_mcap.has_end(file) if file.suffix != ".db3" else cut_sqlite.is_cut(file)


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
