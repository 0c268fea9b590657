"""What processes leave in shared memory, a hundred that end in one way after the other."""

from __future__ import annotations

import os
import signal
import sys
import time
from collections.abc import Callable, Iterator
from functools import partial
from unittest import mock

from course_kit.base.shutdown import shared_memory
from tests.benchmark.child import Program
from tests.benchmark.students import shared_memory_in_use
from tests.benchmark.table import Row, at_most
from tests.domains import reserve_domain
from tests.kernel import Kernel

NOTE = (
    "leftovers: processes with a node, one after the other, each killed as soon as the node is there. Megabytes in "
    "shared memory more than before, as they end and once the next program has started: what is younger than 5 s "
    "stays until then."
)
LIMIT = 10.0  # MB, of a hundred
NODE = "import rclpy\nfrom rclpy.node import Node\nfrom course_kit import run\nnode = run(Node, 'hello')"
ENDS = {"SIGTERM": signal.SIGTERM, "SIGHUP": signal.SIGHUP, "kill -9": signal.SIGKILL}


def rows(quick: bool) -> Iterator[Row]:
    """All rows of this section."""
    count, domain = 10 if quick else 100, reserve_domain()
    for how, number in ENDS.items():
        yield from ended(f"plain nodes, {how}", count, partial(end_program, domain, number))
    yield from ended("kernels, kill -9", count, partial(end_kernel, domain))


def ended(what: str, count: int, end_one: Callable[[], None]) -> Iterator[Row]:
    """What is left when so many have ended, and when another one has started after that."""
    before = shared_memory_in_use()
    for number in range(count):
        print(f"\rleftovers: {what}, {number + 1} of {count} ", end="", file=sys.stderr)
        end_one()
    print(file=sys.stderr)
    yield Row(f"{count} {what}", "MB", course=(shared_memory_in_use() - before) * 1e-6)
    time.sleep(shared_memory.NEW + 0.5)
    shared_memory.tidy()
    yield at_most(f"{count} {what}, after the next start", "MB", (shared_memory_in_use() - before) * 1e-6, LIMIT)


def end_program(domain: int, number: int) -> None:
    """Start a plain node and end it by a signal."""
    with Program("idle_node", domain=domain) as program:
        program.report()
        os.kill(program.pid, number)


def end_kernel(domain: int) -> None:
    """Start a kernel with a node and kill it."""
    with mock.patch.dict(os.environ, {"ROS_DOMAIN_ID": str(domain)}):
        kernel = Kernel()
    kernel.run(NODE, 60.0)
    kernel.close()
