"""A child process of a launch: started, read line by line, awaited."""

from __future__ import annotations

import asyncio
import contextlib
import os
import pty
import subprocess
import threading
from collections.abc import Callable, Iterable, Sequence

from course_kit.base.programs.process_output import CHUNK, PATIENCE, LineCutter


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
        # Of each pair, the first end is ours.
        pipes = [pty.openpty() if emulate_tty else os.pipe() for _ in range(2)]
        try:
            self.process = subprocess.Popen(
                " ".join(cmd) if shell else cmd,
                cwd=cwd,
                env=env,
                shell=shell,
                stdin=subprocess.PIPE,
                stdout=pipes[0][1],
                stderr=pipes[1][1],
            )
        except BaseException:
            for ours, _ in pipes:
                os.close(ours)
            raise
        finally:
            for _, theirs in pipes:
                os.close(theirs)
        self._sources = {
            ours: (name, LineCutter()) for name, (ours, _) in zip(("stdout", "stderr"), pipes, strict=True)
        }
        for fd in self._sources:
            loop.add_reader(fd, self._read, fd)
        threading.Thread(target=self._wait, name=f"wait for {self.process.pid}", daemon=True).start()

    def _wait(self) -> None:
        self.process.wait()
        with contextlib.suppress(RuntimeError):  # the launch is over
            self._loop.call_soon_threadsafe(self._exited)

    def _exited(self) -> None:
        self._loop.call_later(PATIENCE if self._sources else 0, self._finish)

    def _finish(self) -> None:
        for source, lines in self._sources.values():
            self._write(source, lines.rest())
        if not self.ended.done():
            self.ended.set_result(self.process.returncode)

    def _read(self, fd: int) -> None:
        data = b""
        with contextlib.suppress(OSError):  # how a terminal tells its end
            data = os.read(fd, CHUNK)
        source, lines = self._sources[fd]
        if data:
            self._on_data(source, data)
            self._write(source, (line.removesuffix("\r") for line in lines.feed(data)))
            return
        self._write(source, lines.rest())
        self._loop.remove_reader(fd)
        os.close(fd)
        del self._sources[fd]
        if not self._sources and self.process.returncode is not None:
            self._finish()

    def _write(self, source: str, lines: Iterable[str]) -> None:
        for line in lines:
            self._on_line(source, line)
