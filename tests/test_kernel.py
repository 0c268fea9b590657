"""The background in a real Jupyter kernel: where output goes, interrupt, restart, end."""

from __future__ import annotations

import os
import re
import time
from pathlib import Path

import pytest

from course_kit.base.shutdown import shared_memory
from tests.kernel import Kernel
from tests.waiting import wait_until

DEFINITIONS = """
import time
import rclpy
from rclpy.node import Node
from std_msgs.msg import String
from course_kit import run, stop, wait_for, nodes, logs

class Talker(Node):
    def __init__(self, name="talker"):
        super().__init__(name)
        self.count = 0
        self.create_timer(0.01, self.tick)

    def tick(self):
        self.count += 1
"""


@pytest.fixture
def kernel():
    kernel = Kernel()
    kernel.run(DEFINITIONS)
    yield kernel
    kernel.close()


def test_a_nodes_log_lines_appear_under_the_cell_that_runs_it(kernel):
    started = kernel.run("talker = run(Talker)")
    assert kernel.text(started) == "▶ /talker running"
    later = kernel.run("talker.get_logger().info('battery is full');")
    kernel.until(lambda: "[INFO] [/talker] battery is full" in kernel.shown(started))
    assert kernel.text(later) == ""
    kernel.run("stop(talker)")
    kernel.until(lambda: kernel.shown(started).startswith("■ /talker stopped"))


def test_who_logs_a_line_is_found_without_a_search_through_all_modules(kernel):
    kernel.run("import inspect\ndef caller():\n    return inspect.getmodule(inspect.currentframe().f_back)")
    assert kernel.text(kernel.run("print(caller().__name__)")) == "__main__\n"


def test_an_exception_in_a_callback_appears_under_the_cell_that_runs_the_node(kernel):
    started = kernel.run(
        "class Faulty(Talker):\n    def tick(self):\n        raise ValueError('no battery')\n"
        "faulty = run(Faulty, 'faulty')"
    )
    later = kernel.run("other = run(Talker, 'other'); wait_for(lambda: other.count > 3)")
    kernel.until(lambda: "✘ a callback of /faulty raised ValueError: no battery" in kernel.shown(started))
    assert "line 3 in tick: raise ValueError('no battery')" in kernel.shown(started)
    assert "no battery" not in kernel.text(later)
    assert kernel.shown(started).count("raised ValueError") == 1
    assert "[FATAL]" not in kernel.shown(started)
    assert "stderr" not in [m["content"].get("name") for m in kernel.messages]


def test_what_a_callback_prints_appears_under_the_cell_that_runs_the_node(kernel):
    started = kernel.run(
        "class Printer(Talker):\n    def tick(self):\n        self.count += 1\n        print('tick', self.count)\n"
        "printer = run(Printer, 'printer')"
    )
    before = kernel.run("wait_for(lambda: printer.count > 20);")
    later = kernel.run("n = printer.count; wait_for(lambda: printer.count > n + 20);")
    kernel.until(lambda: "tick 20\n" in kernel.text(started))
    assert kernel.text(before) == kernel.text(later) == ""


@pytest.mark.parametrize(
    "waiting",
    [
        "wait_for(lambda: False, timeout=600)",
        "wait_for(rclpy.task.Future(), timeout=600)",
        "rclpy.spin(Node('idle'))",
        "idle = Node('idle'); rclpy.spin_until_future_complete(idle, rclpy.task.Future())",
        "from std_srvs.srv import Empty; talker.create_client(Empty, 'nothing').call(Empty.Request())",
    ],
    ids=["condition", "future", "spin", "spin_until_future_complete", "client.call"],
)
def test_interrupting_a_cell_that_waits_ends_the_cell_and_not_ros(kernel, waiting):
    kernel.run("talker = run(Talker)")
    cell = kernel.send(f"print('waiting', flush=True)\n{waiting}")
    kernel.until(lambda: "waiting" in kernel.text(cell))
    time.sleep(0.3)  # into the wait itself: there is nothing to see from outside
    kernel.manager.interrupt_kernel()
    kernel.finish(cell, timeout=5)
    assert [m["content"]["ename"] for m in kernel.of(cell) if m["msg_type"] == "error"] == ["KeyboardInterrupt"]
    kernel.run("n = talker.count; wait_for(lambda: talker.count > n + 3); assert rclpy.ok()")


def test_a_restarted_kernel_starts_afresh(kernel):
    kernel.run("talker = run(Talker)")
    kernel.client.stop_channels()
    kernel.manager.restart_kernel(now=False)
    kernel.connect()
    kernel.run(DEFINITIONS)
    kernel.run("talker = run(Talker); wait_for(lambda: talker.count > 3)")
    kernel.run("wait_for(lambda: talker.get_node_names().count('talker') == 1)")


def test_what_a_killed_kernel_leaves_in_shared_memory_goes_with_the_start_of_the_next(kernel):
    kernel.run("talker = run(Talker)")
    opened = Path(f"/proc/{kernel.manager.provisioner.process.pid}/fd").iterdir()
    locks = [lock for lock in map(os.path.realpath, opened) if re.fullmatch(r"/dev/shm/fastrtps_[0-9a-f]{16}_el", lock)]
    left = [Path(lock.removesuffix("_el")) for lock in locks]  # its own: it maps those of other processes too
    assert left
    newest = max(path.stat().st_mtime for path in left)
    wait_until(lambda: time.time() - newest > shared_memory.NEW)
    kernel.client.stop_channels()
    kernel.manager.restart_kernel(now=True)
    kernel.connect()
    kernel.run("import rclpy; rclpy.init()")
    assert not any(path.exists() for path in left)


def test_a_kernel_ends_cleanly_while_nodes_run(kernel):
    kernel.run("talkers = [run(Talker, f'talker{n}') for n in range(5)]; wait_for(lambda: talkers[-1].count > 3)")
    process = kernel.manager.provisioner.process
    kernel.client.shutdown()
    assert process.wait(timeout=10) == 0
