"""An mcap file that has no end: its whole records, and what is whole of the chunk in which it ends. Pure: no ROS.

Its form is documented: https://mcap.dev/spec
"""

from __future__ import annotations

import io
import os
import struct
from collections.abc import Iterator
from pathlib import Path
from typing import Any, BinaryIO

MAGIC = b"\x89MCAP0\r\n"
FOOTER, CHUNK = 0x02, 0x06  # kinds of records: after the first the data has ended, the other one holds messages
Record = tuple[int, int, int]  # kind, first byte, one after the last
HEAD = struct.Struct("<BQ")  # of a record: kind, bytes that follow
CHUNK_HEAD = struct.Struct("<BQQQQIIQ")  # kind, bytes, first and last time, size, checksum, no compression, size


def has_end(file: Path) -> bool:
    """Return True if the file was closed by who wrote it."""
    with open(file, "rb") as stream:
        size = stream.seek(0, os.SEEK_END)
        stream.seek(max(0, size - len(MAGIC)))
        return size > 2 * len(MAGIC) and stream.read() == MAGIC


def whole_records(file: Path) -> tuple[list[Record], BinaryIO] | None:
    """The records up to the data's end, from the file's header on, and the open stream to read them from.

    In the stream a last chunk that was cut ends with its last whole message, if it is not compressed. None where there
    is no mcap file, or nothing of one yet.
    """
    with open(file, "rb") as stream:
        if stream.read(len(MAGIC)) != MAGIC:
            return None
        records = list(_records(stream, len(MAGIC), os.fstat(stream.fileno()).st_size))
        begin = records[-1][2] if records else len(MAGIC)
        stream.seek(begin)
        head = stream.read(CHUNK_HEAD.size)
        if len(head) < CHUNK_HEAD.size or head[0] != CHUNK:
            return records, open(file, "rb")
        kind, _, first, last, _, _, compression, _ = CHUNK_HEAD.unpack(head)
        *_, end = (0, 0, 0), *_records(stream, begin + len(head), os.fstat(stream.fileno()).st_size)
    if compression or not end[2]:
        return records, open(file, "rb")
    size = end[2] - begin - len(head)
    mended = CHUNK_HEAD.pack(kind, end[2] - begin - HEAD.size, first, last, size, 0, 0, size)
    return [*records, (CHUNK, begin, end[2])], io.BufferedReader(_Mended(file, begin, mended))


def _records(stream: BinaryIO, begin: int, size: int) -> Iterator[Record]:
    while begin + HEAD.size <= size:
        stream.seek(begin)
        kind, length = HEAD.unpack(stream.read(HEAD.size))
        end = begin + HEAD.size + length
        if kind in (0, FOOTER) or end > size:
            return
        yield kind, begin, end
        begin = end


class _Mended(io.FileIO):
    """A file that is read with other bytes at one place."""

    def __init__(self, file: Path, place: int, instead: bytes) -> None:
        super().__init__(file, "rb")
        self._place, self._instead = place, instead

    def readinto(self, buffer: Any) -> int:
        """Read into the buffer; the number of bytes."""
        at = self.tell()
        count = super().readinto(buffer) or 0
        begin, end = max(at, self._place), min(at + count, self._place + len(self._instead))
        if begin < end:
            buffer[begin - at : end - at] = self._instead[begin - self._place : end - self._place]
        return count
