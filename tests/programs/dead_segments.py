"""Puts dead segments into the way of ROS programs and tells how long each of them was held by one.

    python -m tests.programs.dead_segments CASE COUNT    prints the seconds, as JSON; CASE is one of CASES below

It is run with a /dev/shm of its own (`in_own_shared_memory`), where only its own programs meet what it puts there.
"""

from __future__ import annotations

import itertools
import json
import os
import random
import shlex
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path

from course_kit.base.shutdown.shared_memory import FOLDER
from course_kit.setup.environment.user_domain import FLOWS_BELOW
from tests.kernel import Kernel
from tests.ros2_command import COMMAND

FIRST_PORT = int(os.environ["COURSE_KIT_PORT_BASE"]) - FLOWS_BELOW  # of those that every context takes one of
PORT_SIZE = 52_400  # bytes
# A maker was killed before it gave its file a length, before it wrote the state, and before the state was "ready".
DEAD = {"empty": b"", "zero": bytes(PORT_SIZE), "initializing": b"\1" + bytes(PORT_SIZE - 1)}
HANGS = 60.0  # seconds after which a program counts as one that hangs
PLAIN = """
import rclpy
rclpy.init()
node = rclpy.create_node("plain")
print("here", flush=True)
node.destroy_node()
rclpy.shutdown()
"""
LAUNCH = """
import sys
from launch import LaunchDescription
from launch.actions import ExecuteProcess
def generate_launch_description():
    return LaunchDescription([ExecuteProcess(cmd=[sys.executable, "plain.py"], output="screen")])
"""
NODE = "import rclpy\nfrom rclpy.node import Node\nfrom course_kit import check, run\n"
AGAIN = "rclpy.try_shutdown()\nnode = run(Node, 'hello')"
NO_CHECKER = "from course_kit.exercises.in_notebook import checker_client\nclient.close()"
CHECK = "check('setup-2')"


def in_own_shared_memory(*command: str) -> list[str]:
    """A command line for root that runs a command with an empty /dev/shm of its own; what it starts ends with it."""
    script = f"mount -t tmpfs -o mode=1777 tmpfs {FOLDER} && exec {shlex.join(command)}"
    return ["unshare", "--mount", "--pid", "--fork", "--kill-child", "--mount-proc", "sh", "-c", script]


def put_dead_port() -> Path:
    """Put a dead segment where the next context looks for a port of its own; return it."""
    ports = (FOLDER / f"fastrtps_port{number}" for number in itertools.count(FIRST_PORT))
    port = next(path for path in ports if not path.exists())
    port.write_bytes(random.choice(list(DEAD.values())))
    return port


def _seconds(act: Callable[[], object]) -> float:
    """How long something takes with a dead segment in its way. AssertionError if it does not meet it."""
    port = put_dead_port()
    found = port.stat().st_ino
    began = time.monotonic()
    act()
    taken = time.monotonic() - began
    assert not port.exists() or port.stat().st_ino != found, f"{port.name} was in nobody's way"
    return taken


def _ends_well(*command: str) -> None:
    done = subprocess.run(command, capture_output=True, text=True, timeout=HANGS)
    assert done.returncode == 0, done.stdout + done.stderr


def ros2() -> Iterator[float]:
    """A verb of `ros2`, alone on the machine."""
    while True:
        yield _seconds(lambda: _ends_well(*COMMAND, "topic", "list"))


def launched() -> Iterator[float]:
    """A plain program of rclpy's that a launch starts."""
    Path("plain.py").write_text(PLAIN)
    Path("one.launch.py").write_text(LAUNCH)
    while True:
        yield _seconds(lambda: _ends_well(*COMMAND, "launch", "one.launch.py"))


def kernel() -> Iterator[float]:
    """A notebook's kernel that starts ROS."""
    notebook = Kernel()
    try:
        notebook.run(NODE, HANGS)
        while True:
            yield _seconds(lambda: notebook.run(AGAIN, HANGS))
    finally:
        notebook.close()


def checker() -> Iterator[float]:
    """A checker that a notebook starts."""
    notebook = Kernel()
    try:
        notebook.run(NODE + AGAIN, HANGS)
        while True:
            notebook.run(NO_CHECKER)
            yield _seconds(lambda: notebook.run(CHECK, HANGS))
    finally:
        notebook.close()


CASES: dict[str, Callable[[], Iterator[float]]] = {
    "ros2": ros2,
    "launched": launched,
    "kernel": kernel,
    "checker": checker,
}


def main() -> None:
    """Be the program."""
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        print(json.dumps(list(itertools.islice(CASES[sys.argv[1]](), int(sys.argv[2])))))


if __name__ == "__main__":
    main()
