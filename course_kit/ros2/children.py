"""Programs that a verb starts: in a terminal they share it, in a notebook their lines stream into the cell."""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import threading
import time
from collections.abc import Sequence
from queue import Empty, SimpleQueue
from types import FrameType
from typing import IO, Any

from course_kit.programs.orphans import Watch, mark
from course_kit.ros2.session import DurationOver, Session
from course_kit.ros2.verbs import CommandError

END_TIMEOUT = 20.0  # seconds for a program to end once it was interrupted; a launch needs up to 10


def run_in_terminal(cmd: Sequence[str]) -> int:
    """Run a program on this terminal; return its exit status, negative for a signal.

    Ctrl-C reaches it by itself, as it shares the process group; SIGTERM, and a SIGINT for this process alone, are
    passed on.
    """
    watch = None if _is_in_foreground() else Watch()
    process = _started(cmd)

    def pass_on(number: int, _: FrameType | None) -> None:
        process.send_signal(number)  # does nothing once it has ended

    before = signal.signal(signal.SIGTERM, pass_on)
    try:
        while True:
            try:
                return process.wait()
            except KeyboardInterrupt:
                if watch is not None and not watch.whole_group_was_interrupted():
                    process.send_signal(signal.SIGINT)
    finally:
        signal.signal(signal.SIGTERM, before)
        if watch is not None:
            watch.dismiss()


def _is_in_foreground() -> bool:
    """Whether this process belongs to those that Ctrl-C in a terminal goes to."""
    try:
        terminal = os.open("/dev/tty", os.O_RDONLY | os.O_NOCTTY)
    except OSError:
        return False
    try:
        return os.tcgetpgrp(terminal) == os.getpgrp()
    except OSError:
        return False
    finally:
        os.close(terminal)


def run_in_notebook(cmd: Sequence[str], session: Session) -> int:
    """Run a program whose lines are written into the cell; return its exit status, negative for a signal.

    The interrupt button and the end of --duration send it SIGINT; a second interrupt kills it. If the kernel dies,
    it ends too, with all that it started.
    """
    watch = Watch(apart=True)
    environment = dict(os.environ)
    mark(environment, watch.token)
    try:
        return _streamed(cmd, session, environment)
    finally:
        watch.dismiss()


def _streamed(cmd: Sequence[str], session: Session, environment: dict[str, str]) -> int:
    process = _started(
        cmd,
        env=environment,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        errors="replace",
        start_new_session=True,  # an interrupt of the kernel's group is passed on by us, once
    )
    lines: SimpleQueue[tuple[bool, str] | None] = SimpleQueue()
    readers = [
        threading.Thread(target=_read, args=(pipe, is_error, lines), daemon=True)
        for pipe, is_error in ((process.stdout, False), (process.stderr, True))
    ]
    for reader in readers:
        reader.start()
    threading.Thread(target=_announce_end, args=(process, readers, lines), daemon=True).start()
    try:
        _write(session, lines)
    except (KeyboardInterrupt, DurationOver) as why:
        _interrupt(process, lines, session)
        if isinstance(why, DurationOver):
            return 0
    finally:
        if process.poll() is None:
            _signal_session(process, signal.SIGKILL)
    return process.wait()


def _started(cmd: Sequence[str], **options: Any) -> subprocess.Popen[Any]:
    try:
        return subprocess.Popen(list(cmd), **options)
    except OSError as error:
        raise CommandError(f"cannot run {cmd[0]}: {error.strerror}") from None


def _read(pipe: IO[str], is_error: bool, lines: SimpleQueue[tuple[bool, str] | None]) -> None:
    with contextlib.suppress(ValueError):  # closed at the end
        for line in pipe:
            lines.put((is_error, line.rstrip("\n")))


def _announce_end(
    process: subprocess.Popen[str], readers: Sequence[threading.Thread], lines: SimpleQueue[tuple[bool, str] | None]
) -> None:
    process.wait()
    for reader in readers:
        reader.join(timeout=1)  # what it left behind may hold the pipes open
    lines.put(None)


def _write(session: Session, lines: SimpleQueue[tuple[bool, str] | None]) -> None:
    for item in session.items(lines):
        if item is None:
            return
        _write_line(session, item)


def _write_line(session: Session, item: tuple[bool, str]) -> None:
    is_error, line = item
    (session.warn if is_error else session.print)(line)


def _interrupt(process: subprocess.Popen[str], lines: SimpleQueue[tuple[bool, str] | None], session: Session) -> None:
    """Pass an interrupt on and write what still comes."""
    _signal_session(process, signal.SIGINT)
    deadline = time.monotonic() + END_TIMEOUT
    while (left := deadline - time.monotonic()) > 0:
        try:
            item = lines.get(timeout=min(left, 0.1))  # short, for a second interrupt to come through
        except Empty:
            continue
        if item is None:
            return
        _write_line(session, item)


def _signal_session(process: subprocess.Popen[str], number: signal.Signals) -> None:
    with contextlib.suppress(ProcessLookupError):
        os.killpg(process.pid, number)
