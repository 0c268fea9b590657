"""Hand-ins of students, as learning systems export them; handin_names.py knows their names. Pure: no ROS.

A folder or zip for each student, Moodle's and Canvas' downloads, nbgrader's `submitted`, and all of it mixed.
"""

from __future__ import annotations

import contextlib
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from course_kit.classroom.collect.handin_files import Entry, File, Folder, LeftOut, Unread, on_disk, reason
from course_kit.classroom.collect.handin_names import (
    CANVAS,
    MOODLE,
    NOTEBOOK,
    ZIP,
    Sender,
    is_noise,
    is_workspace,
    notebook_of,
    printable,
    sender_of,
    stem_of,
    suffix_of,
)
from course_kit.classroom.collect.handin_search import MAX_NESTED, MAX_ZIPS, Search
from course_kit.classroom.collect.handin_zips import unpacked

EXPECTED = "expected a folder for each student, or what Moodle, Canvas or nbgrader export, as a folder or as a zip"
SUBMITTED = "submitted"
# What nbgrader keeps beside it.
NBGRADER = ("source", "release", "autograded", "feedback", "solution", "downloaded", "exchange")


@dataclass(frozen=True)
class HandIn:
    """The hand-in that counts of one student."""

    student: str
    notebooks: Mapping[str, bytes]  # by name of the file, such as "03_topics.ipynb"
    workspace: Mapping[str, bytes] = field(default_factory=dict)  # what lies in ros2_ws/src, by path below it
    notes: tuple[str, ...] = ()  # what must be told: earlier hand-ins, files that were left out and why
    ids: Mapping[str, str] = field(default_factory=dict)  # "canvas", "moodle", "name", "email": what the export tells
    late: bool = False


def find(submissions: Path, names: Sequence[str]) -> list[HandIn]:
    """What each student handed in of the notebooks of these names. FileNotFoundError or ValueError if nobody did."""
    top = _top(submissions)
    sender = sender_of(top.name)
    if (isinstance(top, File) and suffix_of(top.name) == NOTEBOOK) or (sender and sender.system == MOODLE):
        return [find_own(submissions, names)]  # what one student handed in, out of an export
    with contextlib.ExitStack() as stack:
        zips = 0
        try:
            if isinstance(top, File):
                folder, zips = stack.enter_context(unpacked(top, MAX_ZIPS)), 1
                folder = Folder(stem_of(folder.name), folder.listed)
            else:
                folder = top
            everything = [(entry, zips) for entry in _without_wrapping(folder, names)]
        except Unread as unread:
            raise ValueError(f"{_shown(submissions)}: {unread}; {EXPECTED}") from None
        if _is_own([entry for entry, _ in everything], names):
            return [_hand_in(printable(folder.name), everything, names)]
        students: dict[tuple[str, str], _Student] = {}
        everything = list(_without_exports(everything, stack))
        accidental = _accidental([entry for entry, _ in everything])
        for entry, depth in everything:
            sender = None if entry.name in accidental else sender_of(entry.name)
            if (student := _student_of(entry, sender, folder.name)) is not None:
                students.setdefault(student.key, student).entries.append((entry, depth))
        if not students:
            raise ValueError(f"nobody has handed in anything in {_shown(submissions)}: {EXPECTED}")
        found = [_hand_in(label, s.entries, names, s.ids, s.notes) for label, s in _labelled(list(students.values()))]
        return sorted(found, key=lambda hand_in: hand_in.student)


def find_own(folder: Path, names: Sequence[str]) -> HandIn:
    """What lies in one student's folder, notebook or zip. FileNotFoundError or ValueError if there is none."""
    top = _top(folder)
    sender = sender_of(top.name)
    if sender and sender.system == CANVAS and isinstance(top, Folder):  # it makes none
        sender = None
    if isinstance(top, Folder):
        student = top.name
    elif suffix_of(top.name) == ZIP:
        student = stem_of(top.name)
    else:
        student = folder.resolve().parent.name
    return _hand_in(printable(sender.name if sender else student), [(top, 0)], names, _ids(sender))


def _top(path: Path) -> File | Folder:
    """What lies there; a link is followed, for whoever grades has named it."""
    try:
        top = on_disk(path.resolve())
    except FileNotFoundError:
        raise FileNotFoundError(f"there is no {_shown(path)}: {EXPECTED}") from None
    except (OSError, ValueError, RuntimeError) as error:
        raise ValueError(f"{_shown(path)} cannot be read ({reason(error)}): {EXPECTED}") from None
    if isinstance(top, LeftOut) or (isinstance(top, File) and suffix_of(top.name) not in (NOTEBOOK, ZIP)):
        raise ValueError(f"{_shown(path)} is no folder, no zip and no notebook: {EXPECTED}")
    return top


def _shown(path: Path) -> str:
    return printable(str(path), 300)


def _visible(folder: Folder) -> list[Entry]:
    return [entry for entry in folder.entries() if not is_noise(entry.name)]


def _without_wrapping(folder: Folder, names: Sequence[str]) -> list[Entry]:
    """What lies in it, or in the one folder that programs and nbgrader put around it. Raises Unread."""
    entries = _visible(folder)
    for _ in range(2):  # unpacking adds one more
        match entries:
            case [Folder(name=inner) as only] if not sender_of(inner):
                below = _visible(only)
                if not (inner.lower() in (SUBMITTED, "submissions") or _looks_exported(below)):
                    several = sum(isinstance(each, Folder) or suffix_of(each.name) == ZIP for each in below) > 1
                    if inner != folder.name or not several or _is_own(below, names):
                        break
                entries = below
    submitted = next((e for e in entries if isinstance(e, Folder) and e.name == SUBMITTED), None)
    if submitted is None:
        return entries
    beside = [e for e in entries if e is not submitted and e.name not in NBGRADER]
    return [*_visible(submitted), *(e for e in beside if not isinstance(e, Folder) or _holds(e, names))]


def _looks_exported(entries: Sequence[Entry]) -> bool:
    return any(sender_of(e.name) or (isinstance(e, Folder) and e.name == SUBMITTED) for e in entries)


def _holds(entry: Entry, names: Sequence[str]) -> bool:
    with Search([(entry, 0)], names) as search:
        return search.has_notebooks


def _is_own(entries: Sequence[Entry], names: Sequence[str]) -> bool:
    """Return True if this is one student's folder: a clone of the course, or notebooks without a folder of anybody."""
    if _looks_exported(entries):
        return False
    for entry in entries:
        if isinstance(entry, Folder) and entry.name == "notebooks":
            with contextlib.suppress(Unread):
                if any(isinstance(e, File) and notebook_of(e.name, names) for e in entry.entries()):
                    return True
    others = [e for e in entries if isinstance(e, Folder) or suffix_of(e.name) == ZIP]
    return any(isinstance(e, File) and notebook_of(e.name, names) for e in entries) and not any(
        _holds(other, names) for other in others if not is_workspace(other.name)
    )


def _without_exports(entries: Sequence[tuple[Entry, int]], stack: contextlib.ExitStack) -> Iterator[tuple[Entry, int]]:
    """The same, with what zips hold in place of those that are no student's, but an export."""
    for entry, zips in entries:
        exported: list[Entry] = []
        if isinstance(entry, File) and suffix_of(entry.name) == ZIP and not sender_of(entry.name) and zips < MAX_NESTED:
            with contextlib.suppress(Unread), contextlib.ExitStack() as inner:
                folder = inner.enter_context(unpacked(entry, MAX_ZIPS))
                if _looks_exported(_visible(folder)):
                    exported = _without_wrapping(folder, ())
                    stack.push(inner.pop_all())  # stays open
        yield from [(each, zips + 1) for each in exported] or [(entry, zips)]


@dataclass
class _Student:
    """Somebody who handed in, and what."""

    key: tuple[str, str]  # by which she is told from all others
    name: str
    ids: Mapping[str, str]
    notes: tuple[str, ...] = ()
    entries: list[tuple[Entry, int]] = field(default_factory=list)


def _accidental(entries: Sequence[Entry]) -> set[str]:
    """Names that look like Canvas' and are not: its number of a file is no other file's (ws_2024_25_alice.zip)."""
    files: dict[tuple[str, int], dict[str, set[str]]] = {}
    for name in (entry.name for entry in entries):
        if (sender := sender_of(name)) and sender.system == CANVAS:
            files.setdefault((sender.id, sender.file), {}).setdefault(stem_of(sender.own), set()).add(name)
    return {name for owns in files.values() if len(owns) > 1 for names in owns.values() for name in names}


def _student_of(entry: Entry, sender: Sender | None, folder: str) -> _Student | None:
    """Whose this is; None for what no student handed in, such as a list of marks."""
    suffix = suffix_of(entry.name)
    if sender:
        key = (sender.system, sender.id) if sender.id else (f"{sender.system} without a number", sender.name)
        return None if sender.is_text else _Student(key, sender.name, _ids(sender))
    if suffix == NOTEBOOK or (isinstance(entry, LeftOut) and not {"/", "\\"}.isdisjoint(entry.name)):
        note = "these files lie beside those of the students, and their names tell nobody's"
        return _Student(("nobody", ""), folder, {}, (note,))
    if suffix == ZIP and not isinstance(entry, Folder):
        return _Student(("folder", stem_of(entry.name)), stem_of(entry.name), {})
    return None if isinstance(entry, File) else _Student(("folder", entry.name), entry.name, {})


def _ids(sender: Sender | None) -> dict[str, str]:
    if sender is None:
        return {}
    ids = {sender.system: sender.id} if sender.id else {}
    return {**ids, "name": printable(sender.name)} if sender.system == MOODLE else ids


def _labelled(students: Sequence[_Student]) -> Iterator[tuple[str, _Student]]:
    """The students, each with a name that no other one has."""
    ordered = sorted(students, key=lambda student: student.key)
    shown = [printable(student.name) for student in ordered]
    count = Counter(shown)
    taken = {name for name in shown if count[name] == 1}
    for name, student in zip(shown, ordered, strict=True):
        label = name
        if count[name] > 1:
            base = label = f"{name} {student.ids.get(student.key[0], '')}".strip()
            number = 1
            while label in taken:
                number += 1
                label = f"{base} ({number})"
            taken.add(label)
        yield label, student


def _hand_in(
    student: str,
    entries: Sequence[tuple[Entry, int]],
    names: Sequence[str],
    ids: Mapping[str, str] | None = None,
    notes: tuple[str, ...] = (),
) -> HandIn:
    with Search(entries, names) as search:
        for note in notes:
            search.notes.add(note)
        notebooks, workspace = search.notebooks(), search.workspace()
        return HandIn(student, notebooks, workspace, search.notes.lines(), ids or {}, search.late)
