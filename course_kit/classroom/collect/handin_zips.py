"""Zips that students handed in, as folders: nothing is unpacked to the disk, bombs are left out. Pure: no ROS."""

from __future__ import annotations

import calendar
import contextlib
import io
import re
import stat
import zipfile
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import IO, Any

from course_kit.classroom.collect.handin_files import Entry, File, Folder, LeftOut, Unread, reason
from course_kit.classroom.collect.handin_names import MAX_NAME, printable
from course_kit.classroom.collect.handin_notes import size_text

MAX_MEMBERS = 200_000
MAX_DEPTH = 30
MAX_READ = 50_000_000  # bytes at once: the table of contents, which zipfile reads as a whole
BOMB_SIZE, BOMB_RATIO = 5_000_000, 200  # what is larger and packed more than this many times
READ_METHODS = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)  # of the others zipfile unpacks without a limit


@contextlib.contextmanager
def unpacked(file: File, most: int) -> Iterator[Folder]:
    """What a zip holds, while it is open. One within a zip is read into memory, if it has at most so many bytes."""
    with contextlib.ExitStack() as stack:
        try:
            source = stack.enter_context(file.opened()) if file.is_on_disk else io.BytesIO(file.read(most))
            bounded: Any = _Bounded(source)  # all of a file that zipfile uses
            folder = _tree(stack.enter_context(zipfile.ZipFile(bounded)), file.name)
        except Unread:
            raise
        except Exception as error:  # what is damaged in a zip raises nearly anything
            raise Unread(f"it is no zip that can be read ({reason(error)})") from None
        yield folder


class _Bounded:
    """A file that refuses to read much at once."""

    def __init__(self, file: IO[bytes]) -> None:
        self._file = file
        self.seek, self.tell, self.seekable, self.close = file.seek, file.tell, file.seekable, file.close
        self._size = file.seek(0, io.SEEK_END)
        file.seek(0)

    def read(self, size: int = -1) -> bytes:
        left = max(0, self._size - self._file.tell())
        if (left if size < 0 else min(size, left)) > MAX_READ:
            raise Unread("its table of contents is too long")
        return self._file.read(size)


@dataclass
class _Level:
    """A folder of a zip, while it is put together."""

    folders: dict[str, _Level] = field(default_factory=dict)
    files: dict[str, File | LeftOut] = field(default_factory=dict)
    left_out: list[LeftOut] = field(default_factory=list)

    def entries(self) -> Iterator[Entry]:
        yield from self.left_out
        for name, level in self.folders.items():
            yield Folder(name, level.entries)
        for name, file in self.files.items():
            # Whoever writes this to a disk could not make both.
            yield LeftOut(name, "there is a folder of this name too") if name in self.folders else file


def _tree(archive: zipfile.ZipFile, name: str) -> Folder:
    members = archive.infolist()
    if len(members) > MAX_MEMBERS:
        raise Unread(f"it holds more than {MAX_MEMBERS:,} files")
    root = _Level()
    for member in members:
        *parents, last = member.orig_filename.split("/")
        why = _unsafe(member.orig_filename)
        level = root
        for part in parents[:MAX_DEPTH] if not _is_absolute(member.orig_filename) else ():
            if not _is_safe(part):  # the note is told of the student up to whose folder it is safe
                break
            if part not in ("", "."):
                level = level.folders.setdefault(part, _Level())
        if why:
            level.left_out.append(LeftOut(printable(member.orig_filename, 200), why))
        elif last not in ("", "."):
            if last in level.files:
                level.left_out.append(LeftOut(last, "it is in its zip more than once, and the last one counts"))
            level.files[last] = _file(archive, member, last)
    return Folder(name, root.entries)


def _is_absolute(name: str) -> bool:
    return re.match(r"[/\\]|[A-Za-z]:", name) is not None


def _is_safe(part: str) -> bool:
    return part != ".." and not re.search(r"[\\\0]|^[A-Za-z]:", part) and len(part) <= MAX_NAME


def _unsafe(name: str) -> str:
    """Why a name in a zip is not taken for what it says; nothing if it is one of a file below."""
    if _is_absolute(name):
        return "its name in the zip is an absolute one"
    if ".." in re.split(r"[/\\]", name):
        return "its name in the zip leads out of it"
    if "\\" in name:
        return "its name in the zip has backslashes"
    if not all(map(_is_safe, name.split("/"))):
        return "its name in the zip is none of a file"
    return "it lies too deep in its zip" if name.count("/") >= MAX_DEPTH else ""


def _file(archive: zipfile.ZipFile, member: zipfile.ZipInfo, name: str) -> File | LeftOut:
    kind = stat.S_IFMT(member.external_attr >> 16)
    if kind == stat.S_IFLNK:
        return LeftOut(name, "links are not followed")
    if kind not in (0, stat.S_IFREG):
        return LeftOut(name, "it is no regular file")
    if member.flag_bits & 0x1:
        return LeftOut(name, "it is encrypted")
    if member.compress_type not in READ_METHODS:
        method = zipfile.compressor_names.get(member.compress_type, "unknown")  # type: ignore[attr-defined]
        return LeftOut(name, f"its way of packing is not read ({method})")
    if member.file_size > BOMB_SIZE and member.file_size > BOMB_RATIO * member.compress_size:
        packed = f"{size_text(member.file_size)} in {size_text(member.compress_size)}"
        return LeftOut(name, f"it is packed like a zip bomb ({packed})")
    try:
        time = float(calendar.timegm((*member.date_time, 0, 0, 0)))
    except ValueError:  # a month of 0
        time = 0.0
    return File(name, member.file_size, time, lambda: archive.open(member), is_on_disk=False)
