"""An sqlite3 file of a bag that was cut: the rows in the pages that are still there, as a whole file. Pure: no ROS.

SQLite refuses such a file, and what it reads of one that is filled up ends at the first missing inner page of a tree,
hundreds of messages early. The rows lie in the leaf pages, in a form that is documented: https://sqlite.org/fileformat2.html
"""

from __future__ import annotations

import contextlib
import os
import sqlite3
from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO

MAGIC = b"SQLite format 3\0"
LEAF = 0x0D  # the first byte of a page with rows of a table; other pages begin with another one
LEAST_PAGE = 512  # bytes
INTEGER_SIZES = (0, 1, 2, 3, 4, 6, 8)  # bytes, by serial type
Row = list[int | bytes | str | None]


def is_cut(file: Path) -> bool:
    """Return True if an sqlite3 file is shorter than its header says, and nobody writes to it or was killed then."""
    with file.open("rb") as stream:
        header = stream.read(100)
    # The number of pages counts if it was written by who changed the file last: two counters are the same.
    if header[:16] != MAGIC or len(header) < 100 or header[24:28] != header[92:96]:
        return False
    if _page_size(header) < LEAST_PAGE:  # damaged otherwise
        return False
    is_short = file.stat().st_size < int.from_bytes(header[28:32], "big") * _page_size(header)
    return is_short and not file.with_name(f"{file.name}-journal").exists()


def salvage(file: Path, whole: Path) -> Path:
    """Write what a cut file holds into a new one, which is returned.

    Raises sqlite3.Error if it ends before its first message, or there is no room for the new one.
    """
    with file.open("rb") as stream, contextlib.closing(sqlite3.connect(whole)) as database:
        pages = _Pages(stream)
        database.execute("PRAGMA synchronous = OFF")  # it is read and thrown away
        for _, (_, name, *_, command) in pages.rows(first=1, last=1):  # what the tables are is on the first page
            if not str(name).startswith("sqlite_"):
                database.execute(str(command))
        columns: dict[int, str] = {}  # the tables of a bag differ by their number of columns
        for (table,) in database.execute("SELECT name FROM sqlite_master WHERE type = 'table'").fetchall():
            columns[len(database.execute(f"PRAGMA table_info({table})").fetchall())] = table
        if "messages" not in columns.values():
            raise sqlite3.DatabaseError("it is cut before its first message")
        for number, (key, *values) in pages.rows(first=2):
            if key is None and (table := columns.get(len(values) + 1)):  # the first column is the row's number
                marks = ", ".join("?" * (len(values) + 1))
                database.execute(f"INSERT OR IGNORE INTO {table} VALUES ({marks})", (number, *values))
        database.commit()
    return whole


class _Pages:
    """The pages of a file that are whole, counted from 1."""

    def __init__(self, stream: BinaryIO) -> None:
        self._stream = stream
        header = stream.read(100)
        self._size = _page_size(header)
        self._usable = self._size - header[20]
        self._longest = os.fstat(stream.fileno()).st_size

    def _page(self, number: int) -> bytes:
        self._stream.seek((number - 1) * self._size)
        page = self._stream.read(self._size)
        return page if len(page) == self._size else b""

    def rows(self, first: int, last: int = 1 << 32) -> Iterator[tuple[int, Row]]:
        """Number and columns of the rows of all tables, as they lie in the pages from `first` to `last`."""
        for number in range(first, last + 1):
            if not (page := self._page(number)):
                return
            begin = 100 if number == 1 else 0
            if page[begin] == LEAF:
                count = int.from_bytes(page[begin + 3 : begin + 5], "big")
                for place in range(begin + 8, begin + 8 + 2 * count, 2):
                    size, cell = _varint(page, int.from_bytes(page[place : place + 2], "big"))
                    row, cell = _varint(page, cell)
                    if (payload := self._payload(page, cell, size)) is not None:
                        yield row, _columns(payload)

    def _payload(self, page: bytes, begin: int, size: int) -> bytes | None:
        """A row's bytes; None if some were in pages that are gone. Long ones go on in pages of their own."""
        if size > self._longest:  # damaged; pages may follow each other in a circle
            return None
        here = size
        if size > self._usable - 35:
            least = (self._usable - 12) * 32 // 255 - 23
            here = least + (size - least) % (self._usable - 4)
            here = here if here <= self._usable - 35 else least
        parts, left = [page[begin : begin + here]], size - here
        following = int.from_bytes(page[begin + here : begin + here + 4], "big")
        while left > 0:
            if not (following and (page := self._page(following))):
                return None
            parts.append(page[4 : 4 + min(left, self._usable - 4)])
            left -= len(parts[-1])
            following = int.from_bytes(page[:4], "big")
        return b"".join(parts)


def _page_size(header: bytes) -> int:
    size = int.from_bytes(header[16:18], "big")
    return 65536 if size == 1 else size


def _varint(data: bytes, place: int) -> tuple[int, int]:
    """An integer of one to nine bytes, and the place after it."""
    value = 0
    for end in range(place, place + 8):
        value = value << 7 | data[end] & 0x7F
        if data[end] < 0x80:
            return value, end + 1
    return value << 8 | data[place + 8], place + 9


def _columns(record: bytes) -> Row:
    """The values of a record: its header has their types, its body their bytes."""
    body, place = _varint(record, 0)
    values: Row = []
    end = body
    while place < body:
        kind, place = _varint(record, place)
        begin = end
        if kind >= 12:
            end += (kind - 12) // 2
            values.append(record[begin:end].decode(errors="replace") if kind % 2 else record[begin:end])
        elif kind in (8, 9):
            values.append(kind - 8)
        elif kind < len(INTEGER_SIZES):
            end += INTEGER_SIZES[kind]
            values.append(int.from_bytes(record[begin:end], "big", signed=True) if kind else None)
        else:
            raise sqlite3.DatabaseError("it holds what no bag does")
    return values
