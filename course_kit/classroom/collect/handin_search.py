"""Finds the notebooks and the workspace in what one student handed in, and which of them count. Pure: no ROS."""

from __future__ import annotations

import contextlib
import math
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass, replace

from course_kit.classroom.collect.handin_files import Entry, File, Folder, LeftOut, Unread
from course_kit.classroom.collect.handin_names import (
    CANVAS,
    NOTEBOOK,
    OTHER_ARCHIVES,
    ZIP,
    is_noise,
    is_workspace,
    notebook_of,
    number_of,
    printable,
    seconds_of,
    sender_of,
    suffix_of,
)
from course_kit.classroom.collect.handin_notes import Notes, size_text
from course_kit.classroom.collect.handin_workspace import BUILT, sources
from course_kit.classroom.collect.handin_zips import unpacked
from course_kit.setup.environment.checks.notebook import START

MAX_NOTEBOOK = 20_000_000
MAX_ZIPS = 100_000_000  # bytes of zips within zips, which are held in memory
MAX_OPEN = 50  # zips
MAX_NESTED = 2  # a zip in a zip
MAX_ENTRIES = 20_000
MAX_DEPTH = 30
TIMESTAMP = "timestamp.txt"
CLONE = ("notebooks", "course_kit")  # folders of a clone of the course; students work in the first one


@dataclass(frozen=True)
class _Way:
    """How something was come upon."""

    path: tuple[str, ...] = ()
    resent: tuple[int, int] = (0, 0)  # Canvas' number in its name, Canvas' number of the file
    handed_in: float = -math.inf  # as nbgrader wrote down
    late: bool = False
    zips: int = 0  # around it

    @property
    def shown(self) -> str:
        return printable("/".join(self.path), 200) if self.path else "the folder"


@dataclass(frozen=True)
class _Found:
    """A file or folder that may count, and how it was come upon."""

    entry: File | Folder
    way: _Way

    @property
    def order(self) -> tuple[tuple[int, int], float, float, tuple[str, ...]]:
        """The last one counts."""
        time = self.entry.time if isinstance(self.entry, File) else 0.0
        return self.way.resent, self.way.handed_in, time, self.way.path


class Search:
    """One student's files, searched; zips stay open until the end of the `with`."""

    def __init__(self, entries: Sequence[tuple[Entry, int]], names: Sequence[str]) -> None:
        """Search these, each within so many zips, for notebooks of these names."""
        self.notes = Notes()
        self.late = False
        self._names = names
        self._found: dict[str, list[_Found]] = {name: [] for name in names}
        self._workspaces: list[_Found] = []
        self._others: list[str] = []
        self._open = contextlib.ExitStack()
        self._opened, self._in_memory, self._seen = 0, 0, 0
        self._ahead: deque[tuple[Entry, _Way]] = deque()
        for entry, zips in entries:
            self._come_upon(
                entry, _Way(zips=zips), is_root=isinstance(entry, Folder) and suffix_of(entry.name) != NOTEBOOK
            )

    def __enter__(self) -> Search:
        while self._ahead:  # level by level: what lies deep is not what a limit must spare
            self._look(*self._ahead.popleft())
        return self

    def __exit__(self, *_: object) -> None:
        self._open.close()

    @property
    def has_notebooks(self) -> bool:
        """True if there is any of the course."""
        return any(self._found.values())

    def notebooks(self) -> dict[str, bytes]:
        """The ones that count, by the names that were asked for; notes tell of the others."""
        counting: dict[str, tuple[_Found, bytes]] = {}
        for name, found in self._found.items():
            for each in sorted(found, key=lambda each: each.order, reverse=True):
                assert isinstance(each.entry, File)
                try:
                    counting[name] = each, each.entry.read(MAX_NOTEBOOK)
                    break
                except Unread as unread:
                    self.notes.leave_out(each.way.shown, str(unread))
            if len(found) > 1 and name in counting:
                shown = counting[name][0].way.shown
                self.notes.add(f"{name} was handed in {len(found)} times; the last counts ({shown})")
        if not counting:
            others = ", ".join(self._others[:3]) + (" and more" if len(self._others) > 3 else "")
            self.notes.add(f"none of the course's notebooks is here{f', but {others}' if others else ''}")
        self._counting = [found for found, _ in counting.values()]
        if counting:
            self.late = any(found.way.late for found in self._counting)
        return {name: data for name, (_, data) in counting.items()}

    def workspace(self) -> dict[str, bytes]:
        """The sources of the workspace that lies beside the notebooks that count; call notebooks() before."""
        if not self._workspaces:
            return {}
        beside = [found.way.path[:-1] for found in self._counting]
        folder_of = [each.way.path[:-2] for each in self._workspaces]
        chosen = max(
            range(len(self._workspaces)),
            key=lambda n: (beside.count(folder_of[n]), self._workspaces[n].order[:2], -len(folder_of[n]), -n),
        )
        src, way = self._workspaces[chosen].entry, self._workspaces[chosen].way
        if len(self._workspaces) > 1:
            self.notes.add(f"there are {len(self._workspaces)} workspaces; {way.shown} counts")
        assert isinstance(src, Folder)
        return sources(src, way.shown, self.notes)

    def _come_upon(self, entry: Entry, way: _Way, is_root: bool = False) -> None:
        """Look at this later on, by a way on which a learning system may have left its marks."""
        if not is_root:
            way = replace(way, path=(*way.path, entry.name))
        if (sender := sender_of(entry.name)) and sender.system == CANVAS:
            way = replace(way, resent=(number_of(entry.name), sender.file), late=sender.late)
            self.late = self.late or sender.late
        self._ahead.append((entry, way))

    def _look(self, entry: Entry, way: _Way) -> None:
        suffix = suffix_of(entry.name)
        if isinstance(entry, LeftOut):
            self.notes.leave_out(way.shown, entry.why)
        elif isinstance(entry, Folder):
            if suffix == NOTEBOOK and way.path:
                self.notes.leave_out(way.shown, "it is a folder")
            else:
                self._look_into(entry, way)
        elif suffix == NOTEBOOK:
            if notebook := notebook_of(entry.name, self._names):
                self._found[notebook].append(_Found(entry, way))
            elif not notebook_of(entry.name, (START,)):  # which has nothing to be graded
                self.notes.say_of(way.shown, "none of the course's notebooks")
        elif suffix == ZIP:
            self._unpack(entry, way)
        else:
            if suffix in OTHER_ARCHIVES:
                self.notes.leave_out(way.shown, "of archives only zips are read")
            self._others.append(way.shown)

    def _look_into(self, folder: Folder, way: _Way) -> None:
        try:
            entries = [entry for entry in folder.entries() if not is_noise(entry.name)]
        except Unread as unread:
            self.notes.leave_out(way.shown, str(unread))
            return
        self._seen += len(entries)
        if self._seen > MAX_ENTRIES or len(way.path) > MAX_DEPTH:
            why = f"there are more than {MAX_ENTRIES:,} files" if self._seen > MAX_ENTRIES else "it lies too deep"
            self._seen -= len(entries)
            self.notes.leave_out(way.shown, why)
            return
        by_name = {entry.name: entry for entry in entries}
        if "pyvenv.cfg" in by_name:  # an environment of Python's
            return
        if all(isinstance(by_name.get(name), Folder) for name in CLONE):  # its tests may have left notebooks anywhere
            entries = [e for e in entries if not isinstance(e, Folder) or e.name == CLONE[0] or is_workspace(e.name)]
        if isinstance(stamp := by_name.get(TIMESTAMP), File):
            with contextlib.suppress(Unread):
                seconds = seconds_of(stamp.read(1000).decode("utf-8", "replace"))
                way = way if seconds is None else replace(way, handed_in=seconds)
        if is_workspace(folder.name) and isinstance(src := by_name.get("src"), Folder):
            self._workspaces.append(_Found(src, replace(way, path=(*way.path, "src"))))
            entries = [entry for entry in entries if entry.name not in ("src", *BUILT)]
        for entry in entries:
            if entry.name != TIMESTAMP:
                self._come_upon(entry, way)

    def _unpack(self, file: File, way: _Way) -> None:
        try:
            if way.zips >= MAX_NESTED:
                raise Unread("zips are nested too deep")
            if not file.is_on_disk and self._in_memory + file.size > MAX_ZIPS:
                raise Unread(f"the zips in zips have more than {size_text(MAX_ZIPS)}")
            if self._opened == MAX_OPEN:
                raise Unread(f"at most {MAX_OPEN} zips are read")
            folder = self._open.enter_context(unpacked(file, MAX_ZIPS))
        except Unread as unread:
            self.notes.leave_out(way.shown, str(unread))
            return
        self._opened += 1
        self._in_memory += 0 if file.is_on_disk else file.size
        self._look_into(folder, replace(way, zips=way.zips + 1))
