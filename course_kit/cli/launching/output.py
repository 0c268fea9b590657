"""The output of a launch: the screen, launch.log, and log files of single processes."""

from __future__ import annotations

import contextlib
import datetime
import logging
import os
import signal
import socket
import sys
import time
from collections.abc import Iterable, Mapping
from functools import cache
from pathlib import Path
from typing import IO

from course_kit.base.atomic_files import reason_of
from course_kit.base.shutdown.signals import write_nowhere
from course_kit.ros.log_folder import log_folder

DESTINATIONS = {"screen", "log", "own_log"}
# What the words for `output` stand for: source -> destinations.
WORDS: dict[str, dict[str, set[str]]] = {
    "screen": {"both": {"screen"}},
    "log": {"both": {"log"}, "stderr": {"screen"}},
    "both": {"both": {"log", "screen"}},
    "own_log": {"both": {"own_log"}, "stdout": {"own_log"}, "stderr": {"own_log"}},
    "full": {"both": {"screen", "log", "own_log"}, "stdout": {"own_log"}, "stderr": {"own_log"}},
}


@cache
def launch_folder() -> Path:
    """The folder of this launch's log files, made when the first one is needed."""
    stamp = datetime.datetime.now().strftime("%Y-%m-%d-%H-%M-%S-%f")
    folder = log_folder() / f"{stamp}-{socket.gethostname()}-{os.getpid()}"
    link = folder.parent / "latest"
    # A folder that cannot be written to must not keep nodes from running; or another launch was quicker with the link.
    with contextlib.suppress(OSError):
        folder.mkdir(parents=True, exist_ok=True)
        if link.is_symlink():
            link.unlink()
        if not link.exists():
            link.symlink_to(folder, target_is_directory=True)
    return folder


@cache
def _log_file(name: str) -> IO[str] | None:
    try:
        return open(launch_folder() / name, "a", encoding="utf-8", errors="replace", buffering=1)
    except OSError as error:
        print(f"cannot write {name}: {reason_of(error)}", file=sys.stderr, flush=True)
        return None


_given_up: set[str] = set()  # log files that could not be written


def _log(name: str, line: str) -> None:
    if name not in _given_up and (file := _log_file(name)):
        try:
            file.write(line + "\n")
        except OSError as error:  # a full disk must not keep nodes from running either
            _given_up.add(name)
            print(f"cannot write {name} any more: {reason_of(error)}", file=sys.stderr, flush=True)


def screen(line: str) -> None:
    """Write a line to the screen, at once. A reader that went away interrupts the launch."""
    try:
        print(line, flush=True)
    except UnicodeEncodeError:
        encoding = sys.stdout.encoding or "ascii"
        print(line.encode(encoding, "replace").decode(encoding), flush=True)
    except BrokenPipeError:  # as in `ros2 launch ... | head`
        write_nowhere(1)
        os.kill(os.getpid(), signal.SIGINT)


class _Handler(logging.Handler):
    """Writes messages of the launch itself or of a launch file to the screen and to launch.log."""

    def emit(self, record: logging.LogRecord) -> None:
        line = self.format(record)
        screen(line)
        _log("launch.log", f"{record.created:.7f} {line}")


_handler = _Handler()
_handler.setFormatter(logging.Formatter("[%(levelname)s] [%(name)s]: %(message)s"))


show_from = _handler.setLevel  # the lowest level that is shown, by its name


@cache
def get_logger(name: str | None = None) -> logging.Logger:
    """The logger of that name."""
    logger = logging.Logger(name or "root")
    logger.addHandler(_handler)
    return logger


def write_line(process_name: str, destinations: Mapping[str, set[str]], source: str, line: str) -> None:
    """Write a line of a process, which came from `source`, stdout or stderr."""
    own, both = destinations.get(source, set()), destinations.get("both", set())
    if "screen" in own | both:
        screen(line)
    if "log" in own | both:
        _log("launch.log", f"{time.time():.7f} {line}")
    if "own_log" in own:
        _log(f"{process_name}-{source}.log", line)
    if "own_log" in both:
        _log(f"{process_name}.log", line)


def destinations_of(config: str | Mapping[str, str | Iterable[str]]) -> dict[str, set[str]]:
    """Where the lines of a process go by what its `output` says: source -> destinations. ValueError if it is wrong."""
    if isinstance(config, str):
        if config not in WORDS:
            raise ValueError(f"output is screen, log, both, own_log or full, not {config}")
        return WORDS[config]
    if not isinstance(config, Mapping):
        raise ValueError(f"output is a word, or a dictionary of them by stream, not {config!r}")
    found: dict[str, set[str]] = {}
    for source, wanted in config.items():
        if source not in ("stdout", "stderr", "both"):
            raise ValueError(f"a stream is stdout, stderr or both, not {source}")
        found[source] = {wanted} if isinstance(wanted, str) else set(wanted)
        for destination in found[source] - DESTINATIONS:
            raise ValueError(f"a stream goes to screen, log or own_log, not {destination}")
    return found
