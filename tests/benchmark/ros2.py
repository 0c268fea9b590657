"""The `ros2` command: whether its lists are whole, how long they take, how fast a topic hz and bw can still read."""

from __future__ import annotations

import os
import re
import statistics
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import ExitStack

from tests.benchmark.child import Program, environment
from tests.benchmark.table import Row, at_least, at_most
from tests.domains import reserve_domain
from tests.kernel import Kernel
from tests.senders import Sender

PROCESSES, NODES = 5, 4
RATE, TOLERANCE = 15_000, 0.01
KINDS = {"String": "string", "LaserScan(360)": "scan"}
LISTS = {"topic list": PROCESSES * NODES + 2, "node list": PROCESSES * NODES, "action list": PROCESSES * NODES}
NOTE = (
    f"ros2: lists against {PROCESSES * NODES} nodes in {PROCESSES} processes, each run a process of its own; "
    "in seconds from its start to its end, and how many runs printed every line. %ros2: in a kernel that has been up "
    "for a while, without the kernel's own messages. hz and bw: another process publishes serialised messages at a "
    "steady rate (in the second column, as it kept it) and the command's last line is read; the real hz reads 5,200 "
    "of 12,000 String/s and 5,400 of 12,000 LaserScan/s."
)


def rows(quick: bool) -> Iterator[Row]:
    """All rows of this section."""
    domain = reserve_domain()
    with ExitStack() as stack:
        programs = [
            stack.enter_context(Program("full_graph", process, NODES, PROCESSES * NODES, domain=domain))
            for process in range(PROCESSES)
        ]
        for program in programs:
            program.report()
        time.sleep(1.0)
        for words, expected in LISTS.items():
            yield from lists(words.split(), expected, 10 if quick else 200, domain)
        yield in_kernel(10 if quick else 100, domain)
    yield from beside_stock(10 if quick else 40)
    for name, kind in KINDS.items():
        yield from readings(name, kind, 6.0, 1 if quick else 3)


def command(words: Sequence[str]) -> list[str]:
    """What starts `ros2 words…` as a shell does."""
    return [os.path.join(os.path.dirname(sys.executable), "ros2"), *words]


def lists(words: Sequence[str], expected: int, runs: int, domain: int) -> Iterator[Row]:
    """How many runs of a list were whole, and how long they took."""
    counts, seconds = [], []
    for _ in range(runs):
        began = time.monotonic()
        out = subprocess.run(command(words), env=environment(domain), capture_output=True, text=True, check=False)
        seconds.append(time.monotonic() - began)
        counts.append(len(out.stdout.splitlines()))
    line = " ".join(words)
    whole = sum(count == expected for count in counts)
    yield at_least(f"ros2 {line}, 20 nodes: whole", f"of {runs}", whole, runs)
    yield at_most(f"ros2 {line}, 20 nodes: median", "s", statistics.median(seconds), 0.30)
    yield Row(f"ros2 {line}, 20 nodes: slowest", "s", None, max(seconds))


def beside_stock(runs: int) -> Iterator[Row]:
    """How many lists beside nodes with DDS as it comes were whole within a second."""
    domain, seconds, counts = reserve_domain(), [], []
    with ExitStack() as stack:
        programs = [
            stack.enter_context(
                Program("full_graph", process, NODES, PROCESSES * NODES, domain=domain, profile="stock")
            )
            for process in range(PROCESSES)
        ]
        for program in programs:
            program.report()
        for run in range(runs):
            time.sleep(0.2 + 0.07 * (run % 40))  # meets their announcements, every 3 s, at varying moments
            began = time.monotonic()
            out = subprocess.run(
                command(["topic", "list"]), env=environment(domain), capture_output=True, text=True, check=False
            )
            seconds.append(time.monotonic() - began)
            counts.append(len(out.stdout.splitlines()))
    in_time = sum(count == LISTS["topic list"] and one <= 1.0 for count, one in zip(counts, seconds, strict=True))
    yield at_least("ros2 topic list, 20 stock nodes: whole within 1 s", f"of {runs}", in_time, 0.9 * runs)
    yield Row("ros2 topic list, 20 stock nodes: median", "s", None, statistics.median(seconds))
    yield Row("ros2 topic list, 20 stock nodes: slowest", "s", None, max(seconds))


def in_kernel(runs: int, domain: int) -> Row:
    """How long `%ros2 topic list` takes where the graph is known."""
    os.environ["ROS_DOMAIN_ID"] = str(domain)
    kernel = Kernel()
    try:
        kernel.run("%ros2 topic list")
        time.sleep(1.0)
        code = (
            "import io, time, contextlib, statistics\n"
            "def once():\n"
            "    began = time.perf_counter()\n"
            "    with contextlib.redirect_stdout(io.StringIO()) as out:\n"
            "        get_ipython().run_line_magic('ros2', 'topic list')\n"
            f"    assert len(out.getvalue().split()) == {LISTS['topic list']}, out.getvalue()\n"
            "    return time.perf_counter() - began\n"
            f"print(statistics.median(once() for _ in range({runs})))\n"
        )
        cell = kernel.run(code, timeout=60)
        milliseconds = float(kernel.text(cell)) * 1000
    finally:
        kernel.close()
    return at_most("%ros2 topic list, 20 nodes: median", "ms", milliseconds, 30)


def readings(name: str, kind: str, seconds: float, repetitions: int) -> Iterator[Row]:
    """What hz and bw read of a topic at 15,000 messages a second."""
    for verb in ("hz", "bw"):
        ratios, really, read = [], 0.0, 0.0
        for _ in range(repetitions):
            domain = reserve_domain()
            os.environ["ROS_DOMAIN_ID"] = str(domain)
            with Sender("/fast", kind, rate=RATE, count=int(RATE * (seconds + 3)), depth=RATE) as sender:
                words = ["topic", verb, "/fast", "--duration", str(seconds)]
                if verb == "bw":
                    words += ["--window", "10000"]
                running = subprocess.Popen(
                    command(words),
                    env=environment(int(os.environ["ROS_DOMAIN_ID"])),
                    stdout=subprocess.PIPE,
                    text=True,
                )
                sender.go()
                out = running.communicate(timeout=60)[0]
                report = sender.result()
            really, size = report["rate"], report["size"] + -report["size"] % 4  # DDS fills up to whole words
            read = _rate(out) if verb == "hz" else _bytes_per_second(out) / size
            ratios.append(read / really)
        worst = max(abs(ratio - 1) for ratio in ratios)
        within = f"within {TOLERANCE:.0%}"
        yield Row(f"ros2 topic {verb} of {name} at {RATE:,} a second", "Hz", really, read, within, worst <= TOLERANCE)


def _rate(out: str) -> float:
    return float(re.findall(r"average rate: ([\d.]+)", out)[-1])


def _bytes_per_second(out: str) -> float:
    value, unit = re.findall(r"^([\d.]+) (B|KB|MB)/s", out, flags=re.MULTILINE)[-1]
    return float(value) * {"B": 1, "KB": 1000, "MB": 1_000_000}[unit]
