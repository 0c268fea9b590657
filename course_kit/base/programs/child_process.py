"""A child process of the notebook: started, read line by line, signalled, awaited, and never left behind.

It carries a mark in its environment, and so does all that it starts. Should the kernel die, a watcher ends whatever
carries its marks (course_kit/base/programs/orphans.py).
"""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import threading
from collections import deque
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Future, wait
from pathlib import Path

from course_kit.base.arguments import SIGNAL, TEXT, WAIT, takes
from course_kit.base.programs.orphans import Watch, end_all, marked, with_mark
from course_kit.base.programs.process_output import as_seen, open_terminal, read_lines
from course_kit.base.shutdown import watchdog

KEPT_LINES = 10_000
PATIENCE = 5.0  # seconds that a process has to end, after SIGINT and again after SIGTERM
KILL_TIMEOUT = 5.0


class Process:
    """A child process: its lines, its state, its exit status. wait_for(process) waits for its end."""

    def __init__(
        self,
        command: Sequence[str],
        name: str,
        environment: Mapping[str, str],
        folder: Path | None = None,
        on_line: Callable[[str], None] | None = None,
        in_terminal: bool = True,
        hand_over: Sequence[int] = (),
    ) -> None:
        """`on_line` is called with each line, in another thread. Reading begins with begin().

        `hand_over` are file descriptors of this process that it gets too, under the same numbers.
        """
        self.command = tuple(command)
        self.name = name
        self.stopped = False  # whether stop() ended it
        self._kept: deque[str] = deque(maxlen=KEPT_LINES)
        self._on_line = on_line
        self._ended: Future[int] = Future()
        self._lock = threading.Lock()
        self._mark = _watch().new_mark()
        watchdog.begin()  # the process may be one of ROS without a watchdog of its own
        self._ours, theirs = open_terminal() if in_terminal else os.pipe()
        try:
            self._popen = subprocess.Popen(
                self.command,
                env=with_mark(environment, self._mark),
                cwd=folder,
                stdin=subprocess.DEVNULL,
                stdout=theirs,
                stderr=subprocess.STDOUT,
                pass_fds=hand_over,
                start_new_session=True,  # an interrupt of the notebook is not one of the process
            )
        except OSError as error:
            os.close(self._ours)
            raise _cannot_start(self.command[0], folder, error) from None
        finally:
            os.close(theirs)
        self.pid = self._popen.pid

    def begin(self) -> None:
        """Read what it writes from now on."""
        read_lines(self._ours, lambda: self._popen.poll() is not None, self._keep, self._end)

    def __repr__(self) -> str:
        return f"{self.name}: {self.state}"

    @property
    def status(self) -> int | None:
        """The exit status: None while it runs, negative for the signal that ended it."""
        return self._ended.result() if self._ended.done() else None

    @property
    def is_running(self) -> bool:
        """True if the process has not ended."""
        return not self._ended.done()

    @property
    def state(self) -> str:
        """In words: running, stopped, ended or failed, and how."""
        status = self.status
        if status is None:
            return "running"
        how = f"exit status {status}" if status >= 0 else signal.Signals(-status).name
        if self.stopped:
            return f"stopped ({how})"
        return f"ended ({how})" if status == 0 else f"failed ({how})"

    @property
    def lines(self) -> list[str]:
        """What it has written, the newest 10,000 lines, without colours; both of its streams as in a terminal."""
        with self._lock:
            return list(self._kept)

    @property
    def output(self) -> str:
        """The same as one text."""
        return "\n".join(self.lines)

    @takes(text=TEXT)
    def says(self, text: str) -> bool:
        """Return True if a line with `text` in it has come."""
        return any(text in line for line in self.lines)

    @takes(number=SIGNAL)
    def send_signal(self, number: int) -> None:
        """Send a signal to it and to what it started, as a terminal does for Ctrl-C; nothing if it has ended."""
        if self._popen.poll() is None:
            with contextlib.suppress(ProcessLookupError):
                os.killpg(self.pid, number)

    @takes(patience=WAIT)
    def stop(self, patience: float = PATIENCE) -> int:
        """End it as Ctrl-C does (SIGINT), after `patience` seconds with SIGTERM, then with SIGKILL; return its status.

        What it started ends too. A process that has ended stays as it is.
        """
        self._ask_to_end(patience)
        end_all(self._mark)
        wait([self._ended], KILL_TIMEOUT)
        return self._popen.wait(KILL_TIMEOUT)

    def _ask_to_end(self, patience: float) -> None:
        if self._popen.poll() is not None:
            return
        self.stopped = True
        # Twice: rclpy's executor misses one that comes just as it begins to wait, and would wait on for ever.
        interrupts = [(signal.SIGINT, patience / 2)] * 2
        for number, timeout in (*interrupts, (signal.SIGTERM, patience), (signal.SIGKILL, KILL_TIMEOUT)):
            self.send_signal(number)
            with contextlib.suppress(subprocess.TimeoutExpired):
                self._popen.wait(timeout)
                return

    @takes(timeout=WAIT)
    def wait(self, timeout: float) -> int:
        """Wait for its end; return the exit status. TimeoutError if it still runs after `timeout` seconds."""
        if not wait([self._ended], timeout).done:
            what, hint = self.explain_wait()
            raise TimeoutError(f"{what} did not come within {timeout:g} s. {hint}")
        return self._ended.result()

    # What wait_for() needs.

    def done(self) -> bool:
        """Return True if it has ended, and all that it wrote has been read."""
        return self._ended.done()

    def result(self) -> int | None:
        """The exit status."""
        return self.status

    def add_done_callback(self, callback: Callable[[Process], None]) -> None:
        """Have `callback(process)` called once it has ended, in another thread; at once if it has."""
        self._ended.add_done_callback(lambda _: callback(self))

    def explain_wait(self) -> tuple[str, str]:
        """What is waited for, and what to look at if it does not come."""
        last = self.lines[-1:]
        said = f"its last line is: {last[0]}" if last else "it has written nothing"
        return f"the end of `{self.name}`", f"The process still runs, and {said}"

    # Called by the thread that reads.

    def _keep(self, line: str) -> None:
        line = as_seen(line)
        with self._lock:
            self._kept.append(line)
        if self._on_line is not None:
            self._on_line(line)

    def _end(self) -> None:
        self._ended.set_result(self._popen.wait())


def _cannot_start(program: str, folder: Path | None, error: OSError) -> OSError:
    if folder is not None and not folder.is_dir():
        return FileNotFoundError(f"the folder {folder} does not exist, so {program!r} cannot run in it")
    if isinstance(error, FileNotFoundError):
        return FileNotFoundError(f"there is no command {program!r}. Is it spelt so, and is its environment sourced?")
    return type(error)(f"cannot run {program!r}: {error.strerror}")


_lock = threading.Lock()
_watches: dict[int, Watch] = {}  # by the process that began it: a forked child gets one of its own


def _watch() -> Watch:
    """The watcher of this Python process, started with its first process."""
    with _lock:
        if os.getpid() not in _watches:
            _watches[os.getpid()] = Watch(apart=True)
        return _watches[os.getpid()]


def dismiss_watcher() -> None:
    """End the watcher, as this process does; unless something is left for it to end."""
    watch = _watches.get(os.getpid())
    if watch is not None and not marked(watch.token):
        watch.dismiss()
