"""The names that learning systems, browsers and file managers give to what is handed in. Pure: no ROS.

Canvas (lib/content_zipper.rb): doejane_12345_678901_03_topics-1.ipynb: name, LATE if so, user, file, the student's own;
without names anon_AbC12_678901_03_topics.ipynb. The eighth of one name has a UUID for its number.
Moodle (mod/assign/classes/downloader.php): Full Name_1234567_assignsubmission_file/03_topics.ipynb, before 4.x with one
more _ behind it, or all in one folder: Full Name_1234567_assignsubmission_file_03_topics.ipynb.
nbgrader: submitted/STUDENT/ASSIGNMENT/03_topics.ipynb with a timestamp.txt beside it.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime, timezone
from zoneinfo import ZoneInfo

CANVAS, MOODLE = "canvas", "moodle"
NOTEBOOK, ZIP = ".ipynb", ".zip"
OTHER_ARCHIVES = (".7z", ".bz2", ".gz", ".rar", ".tar", ".tgz", ".xz")
WORKSPACE = "ros2_ws"
MAX_NAME = 255  # of what is looked at: no file system has longer ones, but a zip may
LAST = 1_000_000  # stands for a UUID, which follows the numbers

_UUID = r"-[0-9a-f]{8}(?:-[0-9a-f]{4}){3}-[0-9a-f]{12}"
_CANVAS = re.compile(
    r"(?:(?P<late_too>LATE_)?(?P<anonymous>anon_[A-Za-z0-9]+)|(?P<name>.+?)_(?P<late>LATE_)?(?P<id>[1-9][0-9]*))"
    r"_(?P<file>[1-9][0-9]*)_(?P<own>.+)",
    re.DOTALL,
)
_MOODLE = re.compile(r"(?P<name>.+?)(?:_(?P<id>[0-9]+))?_assignsubmission_(?P<kind>[a-z]+)(?:_(?P<own>.*))?", re.DOTALL)
_NUMBER = re.compile(rf"(?:-(?P<number>[0-9]{{1,4}})|(?P<uuid>{_UUID}))\Z")
# What is added to the name of a copy: by Canvas and JupyterLab, browsers, Windows, macOS; some of them are translated.
_COPY = re.compile(
    rf"(?:-[0-9]{{1,4}}|{_UUID}|[ _]?\([0-9]{{1,4}}\)| [0-9]{{1,2}}"
    r"|[ _-]{1,3}(?:copy|kopie|copie|copia)[0-9]{0,4})\Z",
    re.IGNORECASE,
)
_TIME = re.compile(r"\s*([0-9]{4}-[0-9]{2}-[0-9]{2})[ T]([0-9]{2}:[0-9]{2}:[0-9]{2})(?:\.[0-9]+)?\s*(\S*)")


@dataclass(frozen=True)
class Sender:
    """Who handed a file in, as the name tells that a learning system gave to it."""

    system: str
    name: str
    id: str  # empty where the system does not tell it
    own: str  # what the student called the file; empty for a folder of Moodle's
    late: bool = False
    file: int = 0  # Canvas numbers the files as they come
    is_text: bool = False  # typed in on the site: no file


def sender_of(name: str) -> Sender | None:
    """Who handed in what has this name; None if no learning system named it."""
    if len(name) > MAX_NAME:
        return None
    if found := _MOODLE.fullmatch(name):
        return Sender(MOODLE, found["name"], found["id"] or "", found["own"] or "", is_text=found["kind"] != "file")
    if found := _CANVAS.fullmatch(name):
        late = bool(found["late"] or found["late_too"])
        return Sender(
            CANVAS, found["name"] or found["anonymous"], found["id"] or "", found["own"], late, int(found["file"])
        )
    return None


def own_name(name: str) -> str:
    """What the student called the file."""
    sender = sender_of(name)
    return sender.own if sender and sender.own else name


def suffix_of(name: str) -> str:
    """The end of a name from the last dot on, in small letters."""
    dot = name.rfind(".")
    return name[dot:].lower() if dot > 0 else ""


def stem_of(name: str) -> str:
    """A name without that end."""
    return name[: len(name) - len(suffix_of(name))]


def number_of(name: str) -> int:
    """Which one of its name Canvas says that a file is: 0, 1, ..."""
    found = _NUMBER.search(stem_of(own_name(name))[-MAX_NAME:])
    return 0 if not found else LAST if found["uuid"] else int(found["number"])


def notebook_of(name: str, names: Sequence[str]) -> str | None:
    """Which of the course's notebooks has this name, or a copy of it; None for another file."""
    if suffix_of(name) != NOTEBOOK or len(name) > MAX_NAME:
        return None
    by_stem = {stem_of(each).lower(): each for each in names}
    return by_stem.get(_original(stem_of(own_name(name)), by_stem)) or by_stem.get(_original(stem_of(name), by_stem))


def is_workspace(name: str) -> bool:
    """Return True if a folder or zip of this name may be a ROS workspace of the course."""
    stem = own_name(name)
    return _original(stem_of(stem) if suffix_of(stem) == ZIP else stem, (WORKSPACE,)) == WORKSPACE


def _original(stem: str, wanted: Sequence[str] | dict[str, str]) -> str:
    """The name of which this is a copy, if it is one of those that are wanted; in small letters."""
    stem = stem[:MAX_NAME].lower().removeprefix("copy of ").strip()
    while stem not in wanted and (shorter := _COPY.sub("", stem).rstrip()) != stem:
        stem = shorter
    return stem


def is_noise(name: str) -> bool:
    """Return True if no student made it: hidden files, what macOS and Python leave behind."""
    return (name.startswith(".") and not name.startswith("..")) or name in ("__MACOSX", "__pycache__")


def printable(text: str, most: int = 100) -> str:
    """Text in one line of bounded length that can be shown and encoded."""
    text = unicodedata.normalize("NFC", text[: 2 * most])
    shown = "".join(
        c if c.isprintable() else " " if unicodedata.category(c) == "Zs" else "\ufffd" for c in text
    ).strip()
    return (shown if len(shown) <= most else shown[: most - 1] + "…") or "without a name"


def seconds_of(timestamp: str) -> float | None:
    """The moment that nbgrader wrote down, such as `2026-03-01 10:00:00.123456 UTC`; None for other text."""
    found = _TIME.match(timestamp)
    if not found:
        return None
    try:
        moment = datetime.fromisoformat(f"{found[1]} {found[2]}")
        try:
            return moment.replace(tzinfo=_zone(found[3])).timestamp()
        except (ValueError, LookupError, OSError):  # a zone that is not known here: the others are its student's too
            return moment.replace(tzinfo=timezone.utc).timestamp()
    except (ValueError, OverflowError):
        return None


def _zone(name: str) -> timezone | ZoneInfo:
    if re.fullmatch(r"[+-][0-9]{2}:?[0-9]{2}", name):
        parsed = datetime.strptime(name, "%z").tzinfo
        assert isinstance(parsed, timezone)
        return parsed
    if not re.fullmatch(r"[A-Za-z0-9_+-]{1,30}(?:/[A-Za-z0-9_+-]{1,30}){0,2}", name):  # it becomes a path
        return timezone.utc
    return ZoneInfo(name)
