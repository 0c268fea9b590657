"""The log files of nodes: where they are, which process wrote each, and their lines.

Every process with nodes writes one file, named after the program, its process id and its start. `ros2 launch` makes a
folder a launch, with launch.log in it. The notebook writes none: what its nodes log is in logs(). Files are written in
blocks of 4 kB, so the newest lines of a process that runs may not be there yet.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from datetime import datetime
from pathlib import Path

from course_kit.base.arguments import COUNT, NODE, TEXT, Rule, takes
from course_kit.base.text import table
from course_kit.lab.node_logs.rosout import NUMBERS, LogLine, LogLines, is_of, level_number
from course_kit.ros.log_folder import log_folder

PROGRAM = Rule("a part of a log file's name, or the id of a process", "'talker'", (str, int), lambda _: True)
NUMBERS_IN_FILES = NUMBERS | {"CRITICAL": 50}  # a launch has Python's words
NAME = re.compile(r"(?P<program>.+)_(?P<pid>\d+)_(?P<start>\d{13})\.log")
# "[INFO] [1795257602.544754480] [talker]: text" of a node, "1795257602.5447 [INFO] [launch]: text" of a launch.
OF_NODE = re.compile(r"\[(?P<level>[A-Z]+)\] \[(?P<when>\d+\.\d+)\] \[(?P<name>[^\]]*)\]: (?P<text>.*)")
OF_LAUNCH = re.compile(r"(?P<when>\d+\.\d+) \[(?P<level>[A-Z]+)\] \[(?P<name>[^\]]*)\]: (?P<text>.*)")


@dataclass(frozen=True)
class LogFile:
    """One log file and who wrote it."""

    path: Path
    program: str
    pid: int | None  # None of a launch
    start: float  # seconds since the epoch
    size: int  # bytes

    @takes(node=NODE | None, level=TEXT, last=COUNT | None)
    def lines(self, node: str | None = None, level: str = "DEBUG", last: int | None = None) -> LogLines:
        """Its lines from the lowest `level` on, of all nodes or of one; a message of several lines counts as one."""
        lowest = level_number(level)
        found: list[LogLine] = []
        for text in self.path.read_text(encoding="utf-8", errors="replace").splitlines():
            line = parse(text)
            if line is not None:
                found.append(line)
            elif found:
                found[-1] = replace(found[-1], text=f"{found[-1].text}\n{text}")
        chosen = [one for one in found if one.level >= lowest and (node is None or is_of(one, node))]
        return LogLines(chosen if last is None else chosen[-last:])

    @property
    def is_running(self) -> bool:
        """True if the process that wrote it still runs."""
        return self.pid is not None and Path(f"/proc/{self.pid}").exists()


def parse(text: str) -> LogLine | None:
    """One line of a log file; None for what does not begin one."""
    found = OF_NODE.match(text) or OF_LAUNCH.match(text)
    if found is None or found["level"] not in NUMBERS_IN_FILES:
        return None
    level = NUMBERS_IN_FILES[found["level"]]
    return LogLine(float(found["when"]), level, "/" + found["name"].replace(".", "/"), found["text"])


class LogFiles(list[LogFile]):
    """Log files, the newest first, shown as a table."""

    def __init__(self, files: list[LogFile], folder: Path) -> None:
        super().__init__(files)
        self.folder = folder

    def __repr__(self) -> str:
        if not self:
            return f"(no log files in {_short(self.folder)})"
        rows: list[tuple[str, ...]] = [("file", "started", "size", "process")]
        for one in self:
            start = datetime.fromtimestamp(one.start).strftime("%Y-%m-%d %H:%M:%S")
            process = "launch" if one.pid is None else f"{one.pid}, {'runs' if one.is_running else 'ended'}"
            rows.append((str(one.path.relative_to(self.folder)), start, f"{one.size:,} B", process))
        return f"{_short(self.folder)}:\n{table(rows, left=2)}"


def _short(folder: Path) -> str:
    home = Path.home()
    return f"~/{folder.relative_to(home)}" if folder.is_relative_to(home) else str(folder)


@takes(program=PROGRAM, last=COUNT)
def log_files(program: str | int = "", with_empty: bool = False, last: int = 20) -> LogFiles:
    """The newest log files of this user; `log_files()[0].lines()` reads one.

    `program` is a part of the file's name, or the id of a process, such as that of start(). Files without a line are
    left out unless `with_empty`: every process makes one.
    """
    folder = log_folder()
    if not folder.is_dir():
        return LogFiles([], folder)
    found = []
    for path in [*folder.glob("*.log"), *folder.glob("*/launch.log")]:
        try:
            one = _read_name(path)
        except OSError:  # went away meanwhile
            continue
        wanted = one.pid == program if isinstance(program, int) else program in str(path.relative_to(folder))
        if wanted and (one.size or with_empty):
            found.append(one)
    return LogFiles(sorted(found, key=lambda one: one.start, reverse=True)[:last], folder)


def _read_name(path: Path) -> LogFile:
    known = path.stat()
    named = NAME.fullmatch(path.name)
    if named is not None:
        return LogFile(path, named["program"], int(named["pid"]), int(named["start"]) * 1e-3, known.st_size)
    program = path.parent.name if path.name == "launch.log" else path.stem
    return LogFile(path, program, None, known.st_mtime, known.st_size)
