"""A child process of a launch: started, read line by line, signalled, awaited."""

from __future__ import annotations

import asyncio
import contextlib
import os
import pty
import signal
import subprocess
import threading
from collections.abc import Callable, Iterable, Sequence

from course_kit.programs.process_output import LineCutter

CHUNK = 65536
# Output that grandchildren hold open is not waited for longer than this once the process has ended.
PATIENCE = 0.5


class Child:
    """A running process; what it writes goes to `on_data(source, bytes)` and `on_line(source, line)`."""

    def __init__(
        self,
        loop: asyncio.AbstractEventLoop,
        cmd: Sequence[str],
        cwd: str | None,
        env: dict[str, str],
        shell: bool,
        emulate_tty: bool,
        on_data: Callable[[str, bytes], None],
        on_line: Callable[[str, str], None],
    ) -> None:
        self._loop = loop
        self._on_data = on_data
        self._on_line = on_line
        self.ended: asyncio.Future[int] = loop.create_future()
        self._code: int | None = None
        # Of each pair, the first end is ours.
        pipes = [pty.openpty() if emulate_tty else os.pipe() for _ in range(2)]
        try:
            self._process = subprocess.Popen(
                " ".join(cmd) if shell else list(cmd),
                cwd=cwd,
                env=env,
                shell=shell,
                stdin=subprocess.PIPE,
                stdout=pipes[0][1],
                stderr=pipes[1][1],
            )
        except BaseException:
            for fd in (fd for pair in pipes for fd in pair):
                os.close(fd)
            raise
        self.pid = self._process.pid
        self._sources: dict[int, tuple[str, LineCutter]] = {}
        for source, (ours, theirs) in zip(("stdout", "stderr"), pipes, strict=True):
            os.close(theirs)
            os.set_blocking(ours, False)
            self._sources[ours] = source, LineCutter()
            loop.add_reader(ours, self._read, ours)
        threading.Thread(target=self._wait, name=f"wait for {self.pid}", daemon=True).start()

    def _wait(self) -> None:
        code = self._process.wait()
        with contextlib.suppress(RuntimeError):  # the launch is over
            self._loop.call_soon_threadsafe(self._exited, code)

    def _exited(self, code: int) -> None:
        self._code = code
        if self._sources:
            self._loop.call_later(PATIENCE, self._finish)
        else:
            self._finish()

    def _finish(self) -> None:
        for source, lines in self._sources.values():
            self._write(source, lines.rest())
        if self._code is not None and not self.ended.done():
            self.ended.set_result(self._code)

    def _read(self, fd: int) -> None:
        try:
            data = os.read(fd, CHUNK)
        except BlockingIOError:
            return
        except OSError:  # how a terminal tells its end
            data = b""
        source, lines = self._sources[fd]
        if data:
            self._on_data(source, data)
            self._write(source, (line.removesuffix("\r") for line in lines.feed(data)))
            return
        self._write(source, lines.rest())
        self._loop.remove_reader(fd)
        os.close(fd)
        del self._sources[fd]
        if not self._sources and self._code is not None:
            self._finish()

    def _write(self, source: str, lines: Iterable[str]) -> None:
        for line in lines:
            self._on_line(source, line)

    def send(self, number: signal.Signals) -> None:
        """Send a signal, unless it has ended."""
        if self._code is None:
            with contextlib.suppress(ProcessLookupError):
                self._process.send_signal(number)
