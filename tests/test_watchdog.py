"""A program of the course ends in time, with its exit status and its output, although a native call never returns."""

from __future__ import annotations

import signal
import subprocess
import sys
import time
from multiprocessing import Pipe
from pathlib import Path

import pytest

from course_kit.base.shutdown import watchdog
from course_kit.exercises.protocol.channel import Channel
from tests.leftovers import made_by
from tests.waiting import TIMEOUT, wait_until

# As rclpy in a deadlock of the middleware: in a native call, and no other thread of Python's runs.
NEVER_RETURNS = """
import ctypes, sys
libc, mutex = ctypes.PyDLL(None), ctypes.create_string_buffer(64)
def stuck():
    print("held at", hex(ctypes.addressof(mutex)), file=sys.stderr, flush=True)
    libc.pthread_mutex_lock(mutex)
    libc.pthread_mutex_lock(mutex)
"""

NODE = """
from rclpy.node import Node
from course_kit.ros.program import spin
class Held(Node):
    def __init__(self):
        super().__init__("held")
        self.create_timer(0.01, self.on_timer)
    def on_timer(self):
        print("at work")
        {work}
    def destroy_node(self):
        stuck()
spin("held", Held, None)
"""

ROS2 = """
from course_kit.ros.spinning import context
from course_kit.cli.ros2 import command
context.before_stop(stuck)
command.main()
"""

SCRIPT = """
from course_kit.ros.spinning import context
context.EXIT_TIMEOUT = 0.5
context.before_stop(stuck)
context.start()
print("done")
{end}
"""

RECORDING = """
from course_kit.lab.bags.recorder import Recorder
from course_kit.cli.ros2 import command
from course_kit.cli.ros2.bag import record
record.CLOSE_TIMEOUT = 0.5
Recorder.stop = lambda self: stuck()
command.main()
"""

CHECKER = """
from course_kit.exercises.checker import __main__ as checker
from course_kit.ros.observing import domain_observer as observer
observer.DomainObserver.close = lambda self: stuck()
checker.main()
"""


# Held in the midst: while a node is made, and while it works.
HELD = {
    "a program as it starts": """
from rclpy.node import Node
from course_kit.ros.program import spin
def held():
    node = Node("held")
    stuck()
spin("held", held, None)
""",
    "a program at work": NODE.format(work="stuck()"),
    "a launch": """
from course_kit.cli.launching import lifecycle
from course_kit.cli.launching.service import LaunchService
from course_kit.cli.ros2 import command
def held(self, event):
    lifecycle._node_of(self.context)
    stuck()
LaunchService._handle = held
sys.argv[1:] = ["launch", "turtlesim", "multisim.launch.py"]
command.main()
""",
    "a verb": """
from course_kit.cli.ros2 import command
from course_kit.cli.ros2.session import Session
def held(self):
    self.node
    stuck()
Session.join = held
command.main()
""",
}


def run(code: str, *arguments: str) -> tuple[int, list[str]]:
    """Run Python code; give its exit status and the lines it printed."""
    command = [sys.executable, "-c", NEVER_RETURNS + code, *arguments]
    done = subprocess.run(command, stdout=subprocess.PIPE, text=True, timeout=60)
    return done.returncode, done.stdout.splitlines()


@pytest.mark.parametrize("status", [0, 7, 255])
def test_the_timer_ends_a_process_that_a_native_call_holds(status: int) -> None:
    code = f"from course_kit.base.shutdown import watchdog; watchdog.end_in(0.3, {status}); stuck()"
    assert run(code) == (status, [])


def test_a_cancelled_timer_ends_nothing() -> None:
    code = "import time; from course_kit.base.shutdown import watchdog; watchdog.end_in(0.1, 7); watchdog.let_live(); "
    assert run(code + "time.sleep(0.5); print('here')") == (0, ["here"])


@pytest.mark.parametrize(
    ("work", "status"), [("import os, signal; os.kill(os.getpid(), signal.SIGINT)", 0), ("raise LookupError", 1)]
)
def test_a_node_as_a_program(work: str, status: int) -> None:
    assert run(NODE.format(work=work)) == (status, ["at work"])


@pytest.mark.parametrize(("end", "status"), [("", 0), ("raise LookupError", 1)])
def test_a_script_that_uses_the_course(end: str, status: int) -> None:
    assert run(SCRIPT.format(end=end)) == (status, ["done"])


def test_the_ros2_command() -> None:
    words = ["topic", "pub", "--once", "-w", "0", "/said", "std_msgs/msg/String", "data: hello"]
    ended, printed = run(ROS2, *words)
    assert ended == 0
    assert "publishing #1: std_msgs.msg.String(data='hello')" in printed
    assert run(ROS2, "topic", "type", "/nothing")[0] == 1


def test_the_ros2_command_at_sigterm() -> None:
    """Also its shared memory is gone."""
    words = ["topic", "pub", "/said", "std_msgs/msg/String", "data: hello"]
    process = subprocess.Popen([sys.executable, "-c", NEVER_RETURNS + ROS2, *words], stdout=subprocess.PIPE, text=True)
    try:
        assert process.stdout is not None
        assert any("publishing #1" in line for line in process.stdout)
        left = made_by(process.pid)
        assert left
        process.terminate()
        assert process.wait(TIMEOUT) == 128 + signal.SIGTERM
        assert not [path for path in left if path.exists()]
    finally:
        process.kill()
        process.wait()


def test_the_checker() -> None:
    ours, theirs = Pipe()
    process = subprocess.Popen(
        [sys.executable, "-c", NEVER_RETURNS + CHECKER, str(theirs.fileno())], pass_fds=[theirs.fileno()]
    )
    try:
        theirs.close()
        channel = Channel(ours)
        channel.send({"check": "nothing"})
        assert "refused" in (channel.receive(60) or {})
        channel.close()
        assert process.wait(TIMEOUT) == 1
    finally:
        process.kill()
        process.wait()


@pytest.mark.by_turns("a program for each", of="cases")
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
@pytest.mark.parametrize("what", HELD)
def test_a_signal_ends_what_a_native_call_holds(what: str, number: signal.Signals) -> None:
    """Also its shared memory is gone."""
    command = [sys.executable, "-c", NEVER_RETURNS + HELD[what], "topic", "list"]
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as process:
        try:
            assert process.stderr is not None
            mutex = next(line for line in process.stderr if "held at" in line).split()[-1]
            wait_until(lambda: mutex in Path(f"/proc/{process.pid}/syscall").read_text().split())
            left = made_by(process.pid)
            assert left
            began = time.monotonic()
            process.send_signal(number)
            assert process.wait(TIMEOUT) == 128 + number
            assert time.monotonic() - began < watchdog.END_TIMEOUT + 1.0
            assert not [path for path in left if path.exists()]
        finally:
            process.kill()


def test_a_second_signal_ends_a_recording_whose_end_is_held(tmp_path: Path) -> None:
    command = [sys.executable, "-c", NEVER_RETURNS + RECORDING, "bag", "record", "-a", "-o", str(tmp_path / "bag")]
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as process:
        try:
            assert process.stderr is not None
            assert any("Recording..." in line for line in process.stderr)
            process.send_signal(signal.SIGINT)
            assert any("held at" in line for line in process.stderr)
            process.send_signal(signal.SIGINT)
            assert process.wait(TIMEOUT) == 128 + signal.SIGINT
        finally:
            process.kill()


def test_what_ends_by_itself_after_a_signal_has_its_own_status() -> None:
    code = "import os, signal, time; from course_kit.base.shutdown import watchdog"
    code += "\nsignal.signal(15, lambda *_: os._exit(7));"
    assert run(f"{code} watchdog.end_after_signals(); os.kill(os.getpid(), 15); time.sleep(9)") == (7, [])


def test_what_has_to_go_on_heeds_no_signal() -> None:
    code = "import os, signal, time; from course_kit.base.shutdown import watchdog; signal.signal(15, lambda *_: None);"
    code += "watchdog.end_after_signals(0.1); os.kill(os.getpid(), 15); watchdog.heed_no_signals(); time.sleep(0.5);"
    assert run(code + "print('here')") == (0, ["here"])


def test_a_fault_of_its_own_is_told() -> None:
    """Such as a bus error; a thread to which no signals go ends the process without a word."""
    code = """
from pathlib import Path
from course_kit.base.shutdown import watchdog
from course_kit.base.polling import wait_until
tasks = set(Path("/proc/self/task").iterdir())
watchdog.begin()
(task,) = set(Path("/proc/self/task").iterdir()) - tasks
def blocked():
    mask = int((task / "status").read_text().partition("SigBlk:")[2].split()[0], 16)
    return [number for number in (2, 4, 7, 8, 11, 15) if mask >> (number - 1) & 1]
wait_until(lambda: blocked() == [2, 15], 20.0)  # until a thread begins, all are
print(blocked())
"""
    assert run(code) == (0, ["[2, 15]"])


def test_a_forked_child_has_a_watchdog_of_its_own() -> None:
    code = """
import os
from course_kit.base.shutdown import watchdog
watchdog.begin()
if child := os.fork():
    print(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))
else:
    watchdog.end_in(0.2, 7)
    stuck()
"""
    assert run(code) == (0, ["7"])
