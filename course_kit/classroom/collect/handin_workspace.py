"""The ROS workspace of a hand-in: the sources in ros2_ws/src, without what colcon built. Pure: no ROS."""

from __future__ import annotations

from course_kit.classroom.collect.handin_files import Folder, LeftOut, Unread
from course_kit.classroom.collect.handin_notes import Notes, size_text

BUILT = ("build", "install", "log")  # by colcon
NO_SOURCES = (*BUILT, "__pycache__", ".git", ".ipynb_checkpoints", ".DS_Store", "__MACOSX")
MAX_FILES = 2_000
MAX_SIZE = 1_000_000  # of a file
MAX_TOTAL = 20_000_000
MAX_PATH = 1_000
MAX_FOLDERS = 5_000


def sources(src: Folder, shown: str, notes: Notes) -> dict[str, bytes]:
    """The files below src, by path; `shown` is what notes call src."""
    files: dict[str, bytes] = {}
    total, folders, full = 0, 0, False
    ahead: list[tuple[Folder, str]] = [(src, "")]
    while ahead and not full:
        folder, path = ahead.pop()
        folders += 1
        below = []
        try:
            entries = folder.entries()
        except Unread as unread:
            notes.leave_out(f"{shown}/{path}".rstrip("/"), str(unread))
            continue
        for entry in entries:
            name = path + entry.name
            if entry.name in NO_SOURCES or entry.name.startswith("._"):
                if path and entry.name in BUILT:  # in a package it could be meant
                    notes.leave_out(f"{shown}/{name}", "a folder of this name is taken for what colcon built")
            elif isinstance(entry, LeftOut):
                notes.leave_out(f"{shown}/{name}", entry.why)
            elif not name.isprintable() or "\\" in name or len(name.encode()) > MAX_PATH:
                notes.leave_out(f"{shown}/{name}", "its name cannot be the one of a source")
            elif isinstance(entry, Folder):
                below.append((entry, f"{name}/"))
            elif len(files) == MAX_FILES or folders > MAX_FOLDERS:
                notes.add(f"{shown} holds more than {MAX_FILES:,} files; from {name} on they were left out")
                full = True
                break
            else:
                try:
                    data = entry.read(MAX_SIZE)
                except Unread as unread:
                    notes.leave_out(f"{shown}/{name}", str(unread))
                    continue
                if total + len(data) > MAX_TOTAL:
                    notes.leave_out(f"{shown}/{name}", f"all files of {shown} have more than {size_text(MAX_TOTAL)}")
                else:
                    files[name] = data
                    total += len(data)
        ahead += reversed(below)
        if folders > MAX_FOLDERS:
            notes.add(f"{shown} holds more than {MAX_FOLDERS:,} folders; the others were left out")
            full = True
    return files
