"""Reads the messages of a bag ahead of the one that is due, so that reading a file never delays it."""

from __future__ import annotations

import contextlib
import threading
from collections.abc import Callable, Iterator
from queue import Empty, Queue
from typing import Any

SLICE = 0.02  # seconds: how long to wait at most before the caller has a look at keys and interrupts
END = None


class ReadAhead:
    """Reads an iterator in a thread of its own, up to `count` items ahead."""

    def __init__(self, items: Iterator[tuple[Any, int, bytes]], count: int) -> None:
        self._items = items
        self._queue: Queue[tuple[Any, int, bytes] | Exception | None] = Queue(max(1, count))
        self._closing = threading.Event()
        self._thread = threading.Thread(target=self._read, name="course_kit bag reader", daemon=True)
        self._thread.start()

    def _read(self) -> None:
        try:
            for item in self._items:
                self._queue.put(item)
                if self._closing.is_set():
                    return
            self._queue.put(END)
        except Exception as error:
            self._queue.put(error)

    def wait_until_filled(self, tick: Callable[[], None]) -> None:
        """Wait until there is no room for more, or nothing more to read."""
        while self._thread.is_alive() and not self._queue.full():
            tick()
            self._thread.join(0.002)

    def next(self, tick: Callable[[], None]) -> tuple[Any, int, bytes] | None:
        """The next item, None at the end. Raises what reading raised."""
        while True:
            try:
                item = self._queue.get(timeout=SLICE)
            except Empty:
                tick()
                continue
            if isinstance(item, Exception):
                raise item
            return item

    def close(self) -> None:
        """End the thread."""
        self._closing.set()
        with contextlib.suppress(Empty):
            while True:
                self._queue.get_nowait()  # there is room now for what the thread waits with
        self._thread.join(2.0)
