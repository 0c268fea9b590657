"""A live view that has ended leaves nothing behind, however often it is opened and closed."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any

import pytest

from tests.kernel import Kernel, kernel_after
from tests.waiting import wait_until

pytestmark = [pytest.mark.cpu_bound, pytest.mark.by_turns("views that are opened again and again", of="cases")]

SET_UP = """
import ctypes, gc, json, threading
import psutil
from rclpy.node import Node
from turtlesim.msg import Pose
from course_kit import run
from course_kit.views.live import tabs
from course_kit import show_graph
from course_kit.views.live.life import alive
from course_kit import watch_logs
from course_kit import watch_rates
from course_kit import watch_resources
from course_kit import show_robot
from course_kit import drive
from course_kit import watch_values
from course_kit.lab.node_logs import rosout
from course_kit import Robot as Burger

class Robot(Node):
    def __init__(self):
        super().__init__("robot")
        self.poses = self.create_publisher(Pose, "/turtle1/pose", 10)
        self.create_timer(0.1, lambda: self.poses.publish(Pose(x=1.0)))

robot = run(Robot)
burger = run(Burger, namespace="/burger")

def left():
    gc.collect()
    ctypes.CDLL(None).malloc_trim(0)  # what was freed goes back to the system, which counts it otherwise
    return {
        # Calls of services end within seconds.
        "threads": sorted(t.name for t in threading.enumerate() if not t.name.startswith(("call of", "course_kit p"))),
        "comms": len(get_ipython().kernel.comm_manager.comms),
        "listeners": len(rosout.listeners),
        "live": len(alive) + len(tabs._live),
        "subscriptions": robot.count_subscribers("/turtle1/pose"),
        "megabytes": psutil.Process().memory_info().rss / 1e6,
    }
"""
WARM_UP = 50  # views, until what is made once is made: the 11th to 50th of a robot take 33 MB, the next 50 take 2 MB
KINDS = {
    "rates": "watch_rates('/turtle1/pose')",
    "values": "watch_values('/turtle1/pose.x')",
    "resources": "watch_resources()",
    "logs": "watch_logs()",
    "graph": "show_graph()",
    "turtle": "drive()",
    "robot": "show_robot(burger)",
    "ros2": "get_ipython().run_line_magic('ros2', 'topic list --background')",
}


@pytest.fixture(scope="module")
def kernel() -> Iterator[Kernel]:
    with kernel_after(SET_UP) as one:
        yield one


def left(kernel: Kernel) -> dict[str, Any]:
    """What there is in the kernel's process."""
    cell = kernel.run("print(json.dumps(left()))")
    kernel.until(lambda: kernel.text(cell))
    return dict(json.loads(kernel.text(cell)))


@pytest.fixture(scope="module")
def warm() -> set[str]:
    """The kinds of views that the kernel has opened and closed WARM_UP times."""
    return set()


def open_and_close(kernel: Kernel, kind: str, times: int) -> None:
    for _ in range(times // 10):
        kernel.run(f"for _ in range(10): {KINDS[kind]}.stop()", 120)
        kernel.messages.clear()  # thousands, which would be looked through again and again


def opened_and_closed(kernel: Kernel, warm: set[str], kind: str, times: int) -> None:
    if kind not in warm:
        open_and_close(kernel, kind, WARM_UP)
        warm.add(kind)
    before = left(kernel)
    open_and_close(kernel, kind, times)

    def is_as_before() -> bool:
        now = left(kernel)
        print(kind, now)
        return now.pop("megabytes") < 1.05 * before["megabytes"] and now == {name: before[name] for name in now}

    # ipykernel has a socket for each thread that sends, and closes those of ended ones every ten seconds.
    wait_until(is_as_before, timeout=40)


@pytest.mark.parametrize("kind", KINDS)
def test_a_view_that_is_opened_and_closed_leaves_nothing(kernel: Kernel, warm: set[str], kind: str) -> None:
    opened_and_closed(kernel, warm, kind, 10)


@pytest.mark.slow(reason="100 times each kind takes up to a minute")
@pytest.mark.timeout(900)
@pytest.mark.parametrize("kind", KINDS)
def test_a_view_that_is_opened_and_closed_a_hundred_times_leaves_nothing(
    kernel: Kernel, warm: set[str], kind: str
) -> None:
    opened_and_closed(kernel, warm, kind, 100)
