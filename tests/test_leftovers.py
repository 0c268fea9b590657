"""However a program ends, no process is left and no shared memory; that of a killed one goes with the next start."""

from __future__ import annotations

import contextlib
import json
import os
import re
import signal
import time
import uuid
from collections.abc import Callable, Iterator
from pathlib import Path
from urllib.parse import parse_qs, urlsplit
from urllib.request import Request, urlopen

import psutil  # type: ignore[import-untyped]
import pytest
import rclpy
from rclpy.node import Node
from websocket import create_connection

from course_kit.base.shutdown import shared_memory
from tests import lab
from tests.domains import own_domain
from tests.kernel import Kernel
from tests.leftovers import made_by
from tests.ros2_command import COMMAND, ros2
from tests.ros2_launches import none_left
from tests.terminal import CTRL_C, Terminal
from tests.waiting import wait_until

pytestmark = pytest.mark.by_turns("a program or a cell for each", of="cases")

PROGRAMS = {
    "a program": ("run", "turtlesim", "turtlesim_node"),
    "a verb": ("topic", "pub", "/chatter", "std_msgs/msg/String", "data: hello"),
    "a recording": ("bag", "record", "-a", "-o", "{folder}/bag"),
    "a launch": ("launch", "{folder}/two.launch.py"),
}
LAUNCH = """
from launch import LaunchDescription
from launch_ros.actions import Node
def generate_launch_description():
    names = ("one", "two")
    return LaunchDescription([Node(package="turtlesim", executable="turtlesim_node", namespace=n) for n in names])
"""
STATUSES = {"a program": 0, "a verb": 128 + signal.SIGHUP, "a recording": 0, "a launch": 1}  # if the terminal closes
ENDS: dict[str, Callable[[Terminal], object]] = {
    "Ctrl-C": lambda terminal: terminal.press(CTRL_C),
    "SIGTERM": lambda terminal: terminal.process.terminate(),
    "its terminal closes": lambda terminal: terminal.close(),
    "kill -9": lambda terminal: terminal.process.kill(),
}


def family(pid: int) -> list[int]:
    return [pid, *(child.pid for child in psutil.Process(pid).children(recursive=True))]


def segments(pids: list[int]) -> list[Path]:
    """The shared memory that these processes have made."""
    return [path for pid in pids for path in made_by(pid)]


@pytest.fixture
def domain() -> Iterator[int]:
    with own_domain() as domain:
        yield domain


@pytest.mark.parametrize("how", ENDS)
@pytest.mark.parametrize("what", PROGRAMS)
def test_nothing_is_left(what: str, how: str, domain: int, tmp_path: Path) -> None:
    (tmp_path / "two.launch.py").write_text(LAUNCH)
    words = [word.format(folder=tmp_path) for word in PROGRAMS[what]]
    with Terminal([*COMMAND, *words]) as terminal:
        participants = 2 if what == "a launch" else 1
        wait_until(lambda: len(segments(family(terminal.process.pid))) >= 2 * participants, pause=terminal._read)
        pids = family(terminal.process.pid)
        left = segments(pids)
        ENDS[how](terminal)
        wait_until(lambda: none_left(pids), f"end of {pids}")
        if how == "its terminal closes":
            assert terminal.process.wait() == STATUSES[what]
    assert_gone(left, domain, how == "kill -9")


WORK = """
from rclpy.node import Node
from std_msgs.msg import Int32
from course_kit import check, run

class Hello(Node):
    def __init__(self):
        super().__init__("hello")

run(Hello)
check("topics-1")
"""


SIGNALS = {"SIGTERM": signal.SIGTERM, "SIGHUP": signal.SIGHUP, "kill -9": signal.SIGKILL}


@contextlib.contextmanager
def observer_in(domain: int) -> Iterator[Node]:
    """A node of this process in a domain."""
    context = rclpy.Context()
    rclpy.init(context=context, domain_id=domain)
    node = rclpy.create_node("observer", context=context)
    try:
        yield node
    finally:
        node.destroy_node()
        context.shutdown()


def assert_gone(left: list[Path], domain: int, is_sudden: bool) -> None:
    """No segment is there, of what ended suddenly after the next start of a program in the domain."""
    if is_sudden:
        newest = max((path.stat().st_mtime for path in left if path.exists()), default=0.0)
        wait_until(lambda: time.time() - newest > shared_memory.NEW)
        ros2("node", "list", ROS_DOMAIN_ID=str(domain))
    assert not [path for path in left if path.exists()]


@pytest.mark.parametrize("how", ["properly", *SIGNALS])
def test_nothing_of_a_kernel_is_left(how: str, domain: int) -> None:
    """A kernel with a node and a checker. ipykernel handles no signal of its end, so each is as sudden as kill -9."""
    with observer_in(domain) as observer:
        kernel = Kernel()
        kernel.run(WORK, 60.0)
        pid = int(kernel.text(kernel.run("import os; print(os.getpid())")))
        pids = family(pid)
        left = segments(pids)
        assert len(left) >= 6  # of the notebook's participants, and of the checker's
        wait_until(lambda: "hello" in observer.get_node_names())
        if how == "properly":
            kernel.client.shutdown()
        else:
            os.kill(pid, SIGNALS[how])
        wait_until(lambda: none_left(pids), f"end of {pids}")
        if how == "properly":
            wait_until(lambda: "hello" not in observer.get_node_names(), timeout=4.0)  # before its lease ends
        kernel.client.stop_channels()
        kernel.manager.shutdown_kernel(now=True)
    assert_gone(left, domain, how != "properly")


def run_in_new_kernel(address: str, code: str) -> int:
    """Have a JupyterLab start a kernel and run code in it, as its page does; return the kernel's process."""
    parts = urlsplit(address)
    token = parse_qs(parts.query)["token"][0]
    request = Request(f"http://{parts.netloc}/api/kernels", b"{}", {"Authorization": f"token {token}"}, method="POST")
    with urlopen(request, timeout=30) as answer:
        kernel = json.load(answer)["id"]
    socket = create_connection(f"ws://{parts.netloc}/api/kernels/{kernel}/channels?token={token}", timeout=60)
    try:
        header = {"msg_id": uuid.uuid4().hex, "msg_type": "execute_request", "session": "test", "version": "5.3"}
        content = {"code": f"{code}\nimport os; print('pid', os.getpid())", "silent": False}
        socket.send(
            json.dumps({"header": header, "parent_header": {}, "metadata": {}, "content": content, "channel": "shell"})
        )
        said = ""
        while not (found := re.search(r"pid (\d+)", said)):
            heard = json.loads(socket.recv())
            said += heard["content"].get("text", "") if heard["msg_type"] == "stream" else ""
        return int(found[1])
    finally:
        socket.close()


@pytest.mark.parametrize("how", SIGNALS)
def test_nothing_of_a_jupyterlab_is_left(how: str, domain: int, tmp_path: Path) -> None:
    with lab.server(tmp_path, tmp_path) as address:
        kernel = run_in_new_kernel(address, WORK)
        server = psutil.Process(kernel).ppid()
        pids = family(server)
        left = segments(pids)
        assert len(left) >= 6
        os.kill(server, SIGNALS[how])
        wait_until(lambda: none_left(pids), f"end of {pids}")
    assert_gone(left, domain, how != "SIGTERM")
