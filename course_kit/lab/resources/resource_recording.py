"""CPU and memory of the processes that nodes live in, over time: what htop and ps show, by node.

A notebook is one process with many nodes. Each node that run() started has a thread of its own, so its share of the
CPU is measured too; memory is the whole process's.
"""

from __future__ import annotations

import functools
import threading
import time
import weakref
from collections import defaultdict, deque
from collections.abc import Iterator, Mapping
from contextlib import AbstractContextManager
from dataclasses import dataclass, field

import numpy as np
import psutil  # type: ignore[import-untyped]

from course_kit.base.arguments import NODE, SPAN, takes
from course_kit.base.long_tasks import long_task
from course_kit.base.text import stands_still, table
from course_kit.lab.background import running
from course_kit.lab.recordings.rate_statistics import Float64s, Int64s
from course_kit.lab.resources.processes_with_nodes import NOTEBOOK, NodeProcess, node_processes
from course_kit.ros.spinning import context

PERIOD = 0.5  # seconds between two looks
SHORTEST = 40_000_000  # nanoseconds that a sample is about at least: the system counts CPU in steps of 0.01 s
LOOK_PERIOD = 2.0  # seconds between two looks at who is there
KEPT = 100_000  # samples of each: at 0.5 s those of 14 hours
MEGABYTE = 1e6


@dataclass(frozen=True)
class Usage:
    """What one process, or one node's thread, used; all arrays have the shape (samples,)."""

    label: str
    nodes: tuple[str, ...]
    pid: int
    is_thread: bool  # of a node in the notebook; its memory is that of the notebook and left nan
    when_ns: Int64s  # nanoseconds since the epoch, the end of the span that each value is about
    cpu: Float64s  # percent of one core, so 200 is two cores, as htop shows it
    memory: Float64s  # MB (1e6 bytes) resident, libraries that are shared with others included

    def __len__(self) -> int:
        return len(self.cpu)


@dataclass
class _Meter:
    """What is watched, and what it used so far."""

    label: str
    nodes: tuple[str, ...]
    pid: int
    native_id: int | None = None
    before: tuple[int, float] | None = None  # when, CPU seconds
    samples: deque[tuple[int, float, float]] = field(default_factory=lambda: deque(maxlen=KEPT))

    def add(self, now_ns: int, cpu_seconds: float, memory: float) -> None:
        if self.before is not None:
            before_ns, before_seconds = self.before
            if now_ns - before_ns < SHORTEST:
                return
            percent = 100.0 * (cpu_seconds - before_seconds) / ((now_ns - before_ns) * 1e-9)
            self.samples.append((now_ns, max(0.0, percent), memory))
        self.before = now_ns, cpu_seconds

    def usage(self) -> Usage:
        when_ns, cpu, memory = zip(*self.samples, strict=True) if self.samples else ((), (), ())
        used = np.array(when_ns, np.int64), np.array(cpu, np.float64), np.array(memory, np.float64)
        return Usage(self.label, self.nodes, self.pid, self.native_id is not None, *used)


class _Sampler:
    """The thread that looks. It holds no ResourceRecording, so that one nobody holds any more ends."""

    def __init__(self, period: float) -> None:
        self.period = period
        self.start_ns = time.time_ns()
        self.lock = threading.Lock()
        self.meters: dict[tuple[int, str | None], _Meter] = {}
        self.without_pid: list[NodeProcess] = []
        self.error: Exception | None = None
        self.ending = threading.Event()
        self._process = functools.cache(psutil.Process)
        self.thread = threading.Thread(target=self._sample_on, name="course_kit resources", daemon=True)

    def _sample_on(self) -> None:
        looked = -LOOK_PERIOD
        due = time.monotonic()
        while True:
            try:
                if time.monotonic() - looked >= LOOK_PERIOD:
                    self.look()
                    looked = time.monotonic()
                self.sample()
            except Exception as error:  # ROS was shut down, for instance
                self.error = error
                break
            due = max(due + self.period, time.monotonic())
            if self.ending.wait(due - time.monotonic()):
                self.sample()
                break
        context.ended(self.stop)

    def stop(self, timeout: float = 2.0) -> None:
        """End the thread; wait so long for it."""
        self.ending.set()
        self.thread.join(timeout)

    def look(self) -> None:
        """See who is there now."""
        there = node_processes()
        threads = {thread.name: thread.native_id for thread in threading.enumerate()}
        own = {node.get_fully_qualified_name() for node in running.nodes()}
        with self.lock:
            self.without_pid = [one for one in there if one.pid is None]
            for one in there:
                if one.pid is None:
                    continue
                meter = self.meters.setdefault((one.pid, None), _Meter(one.label, one.nodes, one.pid))
                meter.nodes = one.nodes
                if one.program != NOTEBOOK:
                    continue
                for name in sorted(own & threads.keys()):
                    thread = self.meters.setdefault((one.pid, name), _Meter(name, (name,), one.pid))
                    if thread.native_id != threads[name]:  # the cell was run again
                        thread.native_id, thread.before = threads[name], None

    def sample(self) -> None:
        """Read the counters of all that is watched."""
        with self.lock:
            own = psutil.Process().threads() if any(key[1] is not None for key in self.meters) else []
            of_threads = {thread.id: thread.user_time + thread.system_time for thread in own}
            for meter in self.meters.values():
                if meter.native_id is not None:
                    if meter.native_id in of_threads:
                        meter.add(time.time_ns(), of_threads[meter.native_id], float("nan"))
                    continue
                try:
                    process = self._process(meter.pid)
                    with process.oneshot():
                        used, memory = process.cpu_times(), process.memory_info().rss
                except psutil.Error:  # it has ended
                    continue
                meter.add(time.time_ns(), used.user + used.system, memory / MEGABYTE)


class ResourceRecording(Mapping[str, Usage], AbstractContextManager["ResourceRecording"]):
    """What the processes of nodes used up to now, by label: a table. .stop() ends it.

    `recorded.of('/talker')` is the usage of the process, or of the notebook's thread, that a node lives in.
    """

    def __init__(self, period: float) -> None:
        self._sampler = _Sampler(period)
        self.start_ns = self._sampler.start_ns
        self._finalizer = weakref.finalize(self, self._sampler.ending.set)
        self._finalizer.atexit = False
        context.before_stop(self._sampler.stop)  # a thread that looked for nodes later would start ROS again
        self._sampler.thread.start()

    @property
    def is_running(self) -> bool:
        """True if the recording goes on."""
        return self._sampler.thread.is_alive()

    def stop(self) -> ResourceRecording:
        """End it; what it has stays. Returns itself; safe to call twice."""
        self._sampler.stop(5.0)
        return self

    def __exit__(self, *_: object) -> None:
        self.stop()

    @takes(node=NODE)
    def of(self, node: str) -> Usage:
        """What the process or thread of one node used. KeyError names those that are known."""
        name = "/" + node.strip("/")
        matching = [one for one in self.values() if name in one.nodes]
        if not matching:
            known = sorted({name for one in self.values() for name in one.nodes})
            raise KeyError(f"no process of a node {name} was measured; there are {', '.join(known) or 'none'}")
        return next((one for one in matching if one.is_thread), matching[0])

    def _usages(self) -> list[Usage]:
        with self._sampler.lock:
            return [meter.usage() for meter in self._sampler.meters.values()]

    def __getitem__(self, label: str) -> Usage:
        for one in self._usages():
            if label == one.label:
                return one
        raise KeyError(f"{label} was not measured; there are {', '.join(self)}")

    def __iter__(self) -> Iterator[str]:
        return iter([one.label for one in self._usages()])

    def __len__(self) -> int:
        return len(self._sampler.meters)

    def __repr__(self) -> str:
        return "\n".join([table(self.rows(), left=2), *self.notes()])

    def rows(self) -> list[tuple[str, ...]]:
        """A table: headings, then a row a process or thread; its first two columns are names."""
        rows: list[tuple[str, ...]] = [("process", "nodes", "CPU mean", "max", "last", "memory", "grew")]
        for one in self._usages():
            name = f"  thread of {one.label}" if one.is_thread else one.label
            nodes = "" if one.is_thread else _short(one.nodes)
            rows.append((name, nodes, *_cells(one)))
        return rows

    def notes(self) -> list[str]:
        """What could not be measured, and why."""
        by_reason: dict[str, list[str]] = defaultdict(list)
        for unknown in self._sampler.without_pid:
            by_reason[unknown.program] += unknown.nodes
        lines = [f"{reason}: {', '.join(names)}" for reason, names in by_reason.items()]
        if self._sampler.error is not None:
            lines.append(stands_still("This recording", self._sampler.error))
        return lines


def _short(names: tuple[str, ...]) -> str:
    return ", ".join(names) if len(names) <= 3 else f"{', '.join(names[:2])} and {len(names) - 2} more"


def _cells(usage: Usage) -> tuple[str, ...]:
    if not len(usage):
        return ("-",) * 5
    cpu = tuple(f"{value:.0f} %" for value in (usage.cpu.mean(), usage.cpu.max(), usage.cpu[-1]))
    if usage.is_thread:
        return (*cpu, "", "")
    return (*cpu, f"{usage.memory[-1]:.0f} MB", f"{usage.memory[-1] - usage.memory[0]:+.1f} MB")


@takes(seconds=SPAN | None, period=SPAN)
def record_resources(seconds: float | None = None, period: float = PERIOD) -> ResourceRecording:
    """Record CPU and memory of all processes with ROS nodes until .stop(), or for some `seconds`.

    `period` in seconds is how often is looked; the system counts CPU in steps of 0.01 s. Processes that come later
    join. A node whose process is not known, for instance on another machine, is named below the table.
    """
    if period < 0.05:
        raise ValueError(f"period={period:g} is too short: the system counts CPU in steps of 0.01 s, give 0.05 or more")
    recording = ResourceRecording(period)
    if seconds is not None:
        with long_task("recording CPU and memory", seconds):
            recording._sampler.ending.wait(seconds)
        recording.stop()
    return recording
