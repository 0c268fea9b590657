"""Programs that a verb starts: in a terminal they share it, in a notebook their lines stream into the cell."""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import sys
from argparse import Namespace
from collections.abc import Callable, Iterable, Sequence
from functools import partial
from queue import SimpleQueue
from types import FrameType
from typing import Any

from course_kit.base.programs.orphans import Watch, with_mark
from course_kit.base.programs.process_output import read_lines
from course_kit.base.shutdown import watchdog
from course_kit.base.shutdown.signals import asking_to_end
from course_kit.cli.ros2.session import DurationOver, Session, handling
from course_kit.cli.ros2.verbs import failing

Lines = SimpleQueue[Callable[[], None] | None]  # how to write each line; None at the end

PROGRAM = (
    sys.executable,
    "-c",
    "from course_kit.cli.ros2.command import main; main()",
)  # `ros2`, where it has no script
END_TIMEOUT = 20.0  # seconds for a program to end once it was interrupted; a launch needs up to 10


def run_in_terminal(cmd: Sequence[str]) -> int:
    """Run a program on this terminal; return its exit status, negative for a signal.

    Ctrl-C reaches it by itself, as it shares the process group; SIGTERM, SIGHUP, and a SIGINT for this process alone,
    are passed on. If this process is killed, it ends too, with all that it started.
    """
    watch, in_foreground = Watch(), _is_in_foreground()

    def pass_on(number: int, _: FrameType | None) -> None:
        process.send_signal(number)  # does nothing once it has ended

    watchdog.heed_no_signals()  # the program may take longer
    try:
        process = _started(cmd, env=with_mark(os.environ, watch.token))
        with contextlib.ExitStack() as handlers:
            for number in asking_to_end():
                handlers.enter_context(handling(number, pass_on))
            while True:
                try:
                    return process.wait()
                except KeyboardInterrupt:
                    if not (in_foreground or watch.whole_group_was_interrupted()):
                        process.send_signal(signal.SIGINT)
    finally:
        watch.dismiss()


def _is_in_foreground() -> bool:
    """Return True if this process belongs to those that Ctrl-C in a terminal goes to."""
    with contextlib.suppress(OSError), open("/dev/tty", "rb", buffering=0) as terminal:
        return os.tcgetpgrp(terminal.fileno()) == os.getpgrp()
    return False


def run_in_notebook(cmd: Sequence[str], session: Session) -> int:
    """Run a program whose lines are written into the cell; return its exit status, negative for a signal.

    The interrupt button and the end of --duration send it SIGINT; a second interrupt kills it. If the kernel dies,
    it ends too, with all that it started.
    """
    watch = Watch(apart=True)
    try:
        return _streamed(cmd, session, with_mark(os.environ, watch.token))
    finally:
        watch.dismiss()


def _streamed(cmd: Sequence[str], session: Session, environment: dict[str, str]) -> int:
    process = _started(
        cmd,
        env=environment,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        start_new_session=True,  # an interrupt of the kernel's group is passed on by us, once
    )
    assert process.stdout is not None and process.stderr is not None
    lines: Lines = SimpleQueue()
    streams = [(process.stdout, session.print), (process.stderr, session.warn)]
    for pipe, write in streams.copy():

        def take(line: str, write: Callable[[str], None] = write) -> None:
            lines.put(partial(write, line))

        def end() -> None:
            streams.pop()
            if not streams:
                process.wait()  # it may have closed them and still have something to do
                lines.put(None)

        with pipe:
            read_lines(os.dup(pipe.fileno()), lambda: process.poll() is not None, take, end)
    duration_over = False
    try:
        _write(session.items(lines))
    except (KeyboardInterrupt, DurationOver) as why:
        duration_over = isinstance(why, DurationOver)
        _signal_session(process, signal.SIGINT)
        with contextlib.suppress(DurationOver):
            _write(Session(Namespace(duration=END_TIMEOUT)).items(lines))
    finally:
        if process.poll() is None:
            _signal_session(process, signal.SIGKILL)
        status = process.wait()
    return 0 if duration_over else status


def _started(cmd: Sequence[str], **options: Any) -> subprocess.Popen[Any]:
    with failing(OSError, say=lambda error: f"cannot run {cmd[0]}: {error.strerror}"):
        return subprocess.Popen(list(cmd), **options)


def _write(lines: Iterable[Callable[[], None] | None]) -> None:
    for write in lines:
        if write is None:
            return
        write()


def _signal_session(process: subprocess.Popen[bytes], number: signal.Signals) -> None:
    with contextlib.suppress(ProcessLookupError):
        os.killpg(process.pid, number)
