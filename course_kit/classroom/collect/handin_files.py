"""Files and folders that students handed in, on the disk: links are not followed, nothing blocks. Pure: no ROS."""

from __future__ import annotations

import os
import stat
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import IO

from course_kit.classroom.collect.handin_notes import size_text
from course_kit.setup.colcon.regular_files import OPEN

MAX_LISTED = 50_000  # entries of one folder
CHUNK = 1 << 16


class Unread(Exception):  # noqa: N818  (reads as what happened)
    """Something cannot or must not be read; the text says why."""


@dataclass(frozen=True)
class LeftOut:
    """Something that is there and is not looked into."""

    name: str
    why: str


@dataclass(frozen=True)
class File:
    """A file, of which nothing is read yet."""

    name: str
    size: int  # as it is told; what is read is counted
    time: float
    opened: Callable[[], IO[bytes]]
    is_on_disk: bool = True

    def read(self, most: int) -> bytes:
        """What it holds. Raises Unread, also if that is more."""
        if self.size > most:
            raise Unread(too_big(self.size, most))
        data = bytearray()
        try:
            with self.opened() as stream:
                while len(data) <= most and (part := stream.read(min(CHUNK, most + 1 - len(data)))):
                    data += part
        except Unread:
            raise
        except Exception as error:  # what is damaged in a zip raises nearly anything
            raise Unread(f"it cannot be read ({reason(error)})") from None
        if len(data) > most:
            raise Unread(too_big(len(data), most))
        return bytes(data)


@dataclass(frozen=True)
class Folder:
    """A folder, not listed yet."""

    name: str
    listed: Callable[[], Iterable[Entry]]

    def entries(self) -> list[Entry]:
        """What lies in it, by name. Raises Unread."""
        return sorted(self.listed(), key=lambda entry: (entry.name, type(entry).__name__))


Entry = File | Folder | LeftOut


def too_big(size: int, most: int) -> str:
    """Why a file is not read."""
    return f"it has {size_text(size)}, and at most {size_text(most)} are read"


def reason(error: Exception) -> str:
    """What an error says, without the path."""
    return (isinstance(error, OSError) and error.strerror) or str(error) or type(error).__name__


def on_disk(path: Path) -> Entry:
    """What lies there. Raises OSError or ValueError where nothing can."""
    return _entry(os.fspath(path), path.name, os.lstat(path))


def _entry(path: str, name: str, status: os.stat_result) -> Entry:
    if stat.S_ISLNK(status.st_mode):
        return LeftOut(name, "links are not followed")
    if stat.S_ISDIR(status.st_mode):
        return Folder(name, lambda: _listed(path))
    if stat.S_ISREG(status.st_mode):
        return File(name, status.st_size, status.st_mtime, lambda: _opened(path))
    return LeftOut(name, "it is no regular file")


def _listed(path: str) -> list[Entry]:
    entries: list[Entry] = []
    try:
        with os.scandir(path) as found:
            for entry in found:
                if len(entries) == MAX_LISTED:  # the first ones would be others each time
                    raise Unread(f"it holds more than {MAX_LISTED:,} files")
                try:
                    entries.append(_entry(entry.path, entry.name, entry.stat(follow_symlinks=False)))
                except OSError as error:
                    entries.append(LeftOut(entry.name, f"it cannot be read ({reason(error)})"))
    except OSError as error:
        raise Unread(f"it cannot be read ({reason(error)})") from None
    return entries


def _opened(path: str) -> IO[bytes]:
    """The file, unless something else has taken its place meanwhile."""
    file = open(os.open(path, OPEN | os.O_NOFOLLOW), "rb")  # noqa: SIM115  (whoever asked for it closes it)
    if not stat.S_ISREG(os.fstat(file.fileno()).st_mode):
        file.close()
        raise Unread("it is no regular file")
    return file
