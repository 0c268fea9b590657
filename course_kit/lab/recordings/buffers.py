"""Serialised messages in memory, bounded: when the room is used up, the oldest go. Pure: no ROS."""

from __future__ import annotations

import sys
import threading
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

Int64s = npt.NDArray[np.int64]
CHUNK_BYTES = 4 << 20
INDEX_BYTES = 16  # two int64 for each message: when it came, where it ends


class _Chunk:
    """A run of messages of one topic: their bytes one after the other, and an index. Written once, never changed.

    The arrays come from the operating system untouched: memory is taken page by page as messages fill them.
    """

    __slots__ = ("_ends", "_receive", "_room", "arena", "count", "ends", "fill", "is_full", "nbytes", "receive_ns")

    def __init__(self, arena_bytes: int, messages: int) -> None:
        self.arena: npt.NDArray[np.uint8] = np.empty(arena_bytes, np.uint8)
        self.ends: Int64s = np.empty(messages, np.int64)
        self.receive_ns: Int64s = np.empty(messages, np.int64)
        # Writing one element through a memoryview costs a third of what it costs through numpy.
        self._room, self._ends, self._receive = self.arena.data, self.ends.data, self.receive_ns.data
        self.nbytes = arena_bytes + messages * INDEX_BYTES
        self.count = 0
        self.fill = 0
        self.is_full = False

    def append(self, message: bytes, receive_ns: int) -> bool:
        """Add a message; return False, and add nothing, if it does not fit."""
        start, count = self.fill, self.count
        end = start + len(message)
        if end > len(self._room) or count == len(self._ends):
            return False
        self._room[start:end] = message
        self._ends[count] = end
        self._receive[count] = receive_ns
        self.fill = end
        self.count = count + 1
        return True

    def seal(self) -> int:
        """Nothing more comes: give back the unused index (the unused arena was never touched); how many bytes."""
        before = self.nbytes
        self.ends, self.receive_ns = self.ends[: self.count].copy(), self.receive_ns[: self.count].copy()
        self._ends, self._receive = self.ends.data, self.receive_ns.data
        self.nbytes = self.fill + self.count * INDEX_BYTES
        self.is_full = True
        return before - self.nbytes


class Serialised:
    """Messages of one topic as they were at one moment, oldest first. Later messages change nothing here.

    `receive_ns` is an int64 array of receive times in nanoseconds since the epoch, `sizes` one of bytes.
    """

    def __init__(self, runs: Iterable[tuple[_Chunk, int, int]], dropped: int = 0) -> None:
        """Each run is a chunk, its first message and the one after its last; `dropped` went before them."""
        self._runs = [run for run in runs if run[1] < run[2]]
        self.dropped = dropped
        self._firsts = np.cumsum([0, *(stop - start for _, start, stop in self._runs)])
        self.receive_ns: Int64s = self._join(chunk.receive_ns[start:stop] for chunk, start, stop in self._runs)
        self.sizes: Int64s = self._join(
            np.diff(chunk.ends[start:stop], prepend=chunk.ends[start - 1] if start else 0)
            for chunk, start, stop in self._runs
        )

    @staticmethod
    def _join(arrays: Iterable[Int64s]) -> Int64s:
        joined = np.concatenate([np.empty(0, np.int64), *arrays])
        joined.flags.writeable = False
        return joined

    def __len__(self) -> int:
        return int(self._firsts[-1])

    def __getitem__(self, index: int) -> bytes:
        """One message as bytes; negative indices count from the end."""
        if not -len(self) <= index < len(self):
            raise IndexError(f"message {index} of {len(self)}")
        index %= len(self)
        run = int(np.searchsorted(self._firsts, index, side="right")) - 1
        chunk, start, _ = self._runs[run]
        return self._bytes(chunk, start + index - int(self._firsts[run]))

    def __iter__(self) -> Iterator[bytes]:
        for chunk, start, stop in self._runs:
            for index in range(start, stop):
                yield self._bytes(chunk, index)

    @staticmethod
    def _bytes(chunk: _Chunk, index: int) -> bytes:
        start = int(chunk.ends[index - 1]) if index else 0
        return chunk.arena[start : int(chunk.ends[index])].tobytes()

    def columns(self, offset: int, width: int) -> npt.NDArray[np.uint8]:
        """The bytes at `offset` to `offset + width` of every message: shape (messages, width).

        Raises ValueError if a message is too short for that.
        """
        if len(self) and int(self.sizes.min()) < offset + width:
            raise ValueError(f"there is a message of {self.sizes.min()} bytes: none at {offset} to {offset + width}")
        wanted = np.arange(offset, offset + width)
        parts: list[npt.NDArray[np.uint8]] = [np.empty((0, width), np.uint8)]
        for (chunk, start, stop), first in zip(self._runs, self._firsts, strict=False):
            begins = chunk.ends[start:stop] - self.sizes[first : first + stop - start]
            parts.append(chunk.arena[begins[:, None] + wanted])
        return np.concatenate(parts)


@dataclass(slots=True)
class _Channel:
    """What is kept of one topic, and how many messages of it came."""

    chunks: list[_Chunk] = field(default_factory=list)
    appended: int = 0


class MessageBuffer:
    """Keeps the serialised messages of several topics within `max_bytes` in all, and `keep` messages of each.

    One thread appends, any thread takes snapshots. Raises ValueError for limits that hold nothing.
    """

    def __init__(self, topics: Iterable[str], max_bytes: int = 1 << 30, keep: int | None = None) -> None:
        self._channels = {topic: _Channel() for topic in topics}
        if not self._channels:
            raise ValueError("name at least one topic")
        if keep is not None and keep < 1:
            raise ValueError(f"keep={keep} keeps nothing: give the number of messages to keep, 1 or more")
        # Some chunks for each topic, so that the oldest can go while most of the room stays in use.
        self._chunk_bytes = min(CHUNK_BYTES, max_bytes // (8 * len(self._channels)))
        if self._chunk_bytes < 256:
            least = 256 * 8 * len(self._channels)
            raise ValueError(
                f"max_bytes={max_bytes} is too little for {len(self._channels)} topics: give {least} or more"
            )
        self._keep = sys.maxsize if keep is None else keep
        self._messages_per_chunk = min(self._chunk_bytes // 48, max(self._keep, 64))
        self._max_bytes = max_bytes
        self._lock = threading.Lock()
        self._nbytes = 0

    @property
    def nbytes(self) -> int:
        """Bytes reserved for messages and their index: never more than max_bytes."""
        return self._nbytes

    def counts(self, topic: str) -> tuple[int, int]:
        """How many messages of a topic are kept, and how many have gone."""
        channel = self._channels[topic]
        with self._lock:
            held, appended = sum(chunk.count for chunk in channel.chunks), channel.appended
        kept = min(held, self._keep)
        return kept, appended - kept

    def appender(self, topic: str) -> Any:
        """A function (message, receive_ns) that appends to `topic`: what a subscription's callback calls."""
        channel, lock = self._channels[topic], self._lock

        def append(message: bytes, receive_ns: int) -> None:
            with lock:
                channel.appended += 1
                if not (channel.chunks and channel.chunks[-1].append(message, receive_ns)):
                    self._append_to_new_chunk(channel, message, receive_ns)

        return append

    def _append_to_new_chunk(self, channel: _Channel, message: bytes, receive_ns: int) -> None:
        arena_bytes, messages = self._chunk_bytes * 2 // 3, self._messages_per_chunk
        if len(message) > arena_bytes:
            arena_bytes, messages = len(message), 1
        needed = arena_bytes + messages * INDEX_BYTES
        if needed > self._max_bytes:  # it would not fit even alone
            return
        if channel.chunks:
            self._nbytes -= channel.chunks[-1].seal()
        self._free_not_kept(channel)
        while self._nbytes + needed > self._max_bytes:
            self._free_oldest()
        chunk = _Chunk(arena_bytes, messages)
        chunk.append(message, receive_ns)
        channel.chunks.append(chunk)
        self._nbytes += chunk.nbytes

    def _free_not_kept(self, channel: _Channel) -> None:
        """Free the chunks that lie wholly before the last `keep` messages."""
        held = sum(chunk.count for chunk in channel.chunks)
        while channel.chunks and held - channel.chunks[0].count >= self._keep:
            held -= channel.chunks[0].count
            self._free_first(channel)

    def _free_oldest(self) -> None:
        """Free the full chunk that ended first; a chunk that is still being filled only if there is no other."""
        full = [c for c in self._channels.values() if c.chunks and c.chunks[0].is_full]
        candidates = full or [c for c in self._channels.values() if c.chunks]
        self._free_first(min(candidates, key=lambda c: c.chunks[0].receive_ns[c.chunks[0].count - 1]))

    def _free_first(self, channel: _Channel) -> None:
        self._nbytes -= channel.chunks.pop(0).nbytes

    def snapshot(self, topic: str) -> Serialised:
        """The messages of a topic that are kept now."""
        channel = self._channels[topic]
        with self._lock:
            chunks = [(chunk, chunk.count) for chunk in channel.chunks]
            appended = channel.appended
        held = sum(count for _, count in chunks)
        kept = min(held, self._keep)
        runs, skip = [], held - kept
        for chunk, count in chunks:
            first = min(skip, count)
            skip -= first
            runs.append((chunk, first, count))
        return Serialised(runs, dropped=appended - kept)
