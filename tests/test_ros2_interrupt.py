"""Ctrl-C, or the interrupt button, ends within two seconds whatever verb of `ros2` goes on, or waits for another."""

from __future__ import annotations

import gc
import io
import shlex
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import pytest
from geometry_msgs.msg import PoseStamped
from nav_msgs.msg import Path as Walk
from rclpy.lifecycle import LifecycleNode
from rclpy.node import Node
from rclpy.serialization import serialize_message

from course_kit.base.polling import wait_until
from course_kit.cli.ros2 import command
from course_kit.lab import bags
from course_kit.lab.background.running import running
from course_kit.robots.turtlesim.node import TurtleSim
from tests.kernel import Kernel
from tests.ros2_command import program
from tests.ros2_launches import Prefix
from tests.waiting import TIMEOUT
from tests.waiting import wait_until as wait_for

pytestmark = pytest.mark.by_turns("a program or a cell for each", of="cases")

WITHIN = 2.0  # seconds
STRING = "std_msgs/msg/String"
TRIGGER = "std_srvs/srv/Trigger"
FIBONACCI = "example_interfaces/action/Fibonacci"
POLITE = """
import time
try:
    print("begun", flush=True)
    while True: time.sleep(0.1)
except KeyboardInterrupt:
    pass
"""


class Goes(NamedTuple):
    """A command line that goes on; what shows that it does; its status after the interrupt.

    That is a text which it writes, or a topic that it subscribes to, or a service that it is a client of.
    """

    line: str
    begun: str
    status: int = signal.SIGINT


VERBS = [
    Goes("topic echo /turtle1/pose", "theta: "),
    Goes(f"topic echo /silence {STRING}", "/silence"),
    Goes("topic echo /turtle1/pose --filter False", "/turtle1/pose"),
    Goes("topic hz /turtle1/pose", "average rate"),
    Goes("topic hz /nobody", "does not appear to be published yet"),
    Goes("topic bw /turtle1/pose", "Message size mean"),
    Goes("topic bw /nobody", "does not appear to be published yet"),
    Goes("topic delay /stamped", "average delay"),
    Goes("topic delay /nobody", "does not appear to be published yet"),
    Goes(f"topic pub /talk {STRING} '{{data: hello}}'", "publishing #2"),
    Goes(f"topic pub /talk {STRING} -r 9e9", "publishing #1000"),
    Goes(f"topic pub /talk {STRING} -r 1e-300", "publishing #1"),
    Goes(f"topic pub /talk {STRING} --use-sim-time -w 0", "publishing #1"),  # nobody publishes /clock
    Goes(f"topic pub /talk {STRING} --once", "Waiting for at least 1 matching"),
    Goes(f"topic pub /talk {STRING} --once -w 0 --keep-alive 9e9", "publishing #1"),
    Goes(f"service call /silent {TRIGGER}", "making request"),
    Goes(f"service call /nobody {TRIGGER}", "waiting for service"),
    Goes("service call /clear std_srvs/srv/Empty -r 9e9", "response:"),
    Goes("service call /clear std_srvs/srv/Empty -r 1e-9", "response:"),
    Goes("service echo /spawn", "No publishers on topic"),
    Goes(f"action send_goal /nobody {FIBONACCI} {{}}", "Waiting for an action server"),
    Goes(f"action send_goal /endless {FIBONACCI} {{}}", "Goal accepted", 0),
    Goes(f"action send_goal /stubborn {FIBONACCI} {{}}", "Goal accepted", 1),
    Goes("param list", "/asleep/list_parameters"),
    Goes("param dump /asleep", "/asleep/list_parameters"),
    Goes("param get /asleep a", "/asleep/get_parameters"),
    Goes("param set /asleep a 1", "/asleep/set_parameters"),
    Goes("param load /asleep PARAMETERS", "/asleep/set_parameters"),
    Goes("param delete /asleep a", "/asleep/set_parameters"),
    Goes("param describe /asleep a", "/asleep/describe_parameters"),
    Goes("lifecycle get", "/asleep/get_state"),
    Goes("lifecycle list /asleep", "/asleep/get_available_transitions"),
    Goes("doctor hello --print-period 0.2", "MULTIMACHINE"),
    Goes("doctor hello --emit-period 9e9 --print-period 0.2", "MULTIMACHINE"),
    Goes("bag record --topics /turtle1/pose -o NEW", "Subscribed to topic '/turtle1/pose'"),
    Goes("bag record --all --start-paused -o NEW", "Recording..."),
    Goes("bag play BAG --loop", "Playback until"),
    Goes("bag play BAG --start-paused", "Playback until"),
    Goes("bag play BAG --delay 9e9", "Sleep"),
    Goes("bag play BAG --rate 1e-6 --clock 1e-6", "Playback until"),
    # With --duration they stream as into a cell; those of a terminal: test_ros2_run.py, test_ros2_launch_end.py.
    Goes("run --duration 1000 demo polite", "begun", 0),
    Goes("launch --duration 1000 demo demo.launch.py", "begun", 0),
]


class Stamps(Node):
    """Publishes what has a header."""

    def __init__(self) -> None:
        super().__init__("stamps")
        self.publisher = self.create_publisher(PoseStamped, "stamped", 10)
        self.create_timer(0.05, self.publish)

    def publish(self) -> None:
        message = PoseStamped()
        message.header.stamp = self.get_clock().now().to_msg()
        self.publisher.publish(message)


class Walks(Node):
    """Publishes paths so long that a command which reads them does little else."""

    def __init__(self) -> None:
        super().__init__("walks")
        publisher = self.create_publisher(Walk, "walk", 10)
        walk = serialize_message(Walk(poses=[PoseStamped()] * 2000))
        self.create_timer(0.05, lambda: publisher.publish(walk))


@pytest.fixture(scope="module")
def turtle(fresh_domain: None) -> Iterator[Node]:
    """A simulator, servers that behave badly in a process of their own, and /asleep, which nobody spins."""
    with program("tests.ros2_servers"), running(TurtleSim, Stamps) as (node, _):
        asleep = LifecycleNode("asleep")
        yield node
        asleep.destroy_node()


@pytest.fixture(scope="module")
def files(turtle: Node, tmp_path_factory: pytest.TempPathFactory) -> Iterator[dict[str, str]]:
    """A bag, a parameter file, and a package with a program and a launch file that go on."""
    folder = tmp_path_factory.mktemp("interrupt")
    with bags.record(folder / "bag", "/turtle1/pose") as recording:
        wait_for(lambda: recording.message_count > 10)
    parameters = folder / "parameters.yaml"
    parameters.write_text("/asleep: {ros__parameters: {a: 1}}")
    prefix = Prefix(folder / "install")
    prefix.program("demo", "polite", POLITE)
    prefix.launch_file("demo", "demo.launch.py", f"python({POLITE!r})")
    with pytest.MonkeyPatch.context() as patch:
        for name, value in prefix.environment.items():
            patch.setenv(name, value)
        yield {"BAG": str(folder / "bag"), "PARAMETERS": str(parameters)}


@pytest.fixture(scope="module")
def kernel(files: dict[str, str]) -> Iterator[Kernel]:
    kernel = Kernel()
    yield kernel
    kernel.close()


def is_used(name: str, node: Node) -> bool:
    """Return True if somebody subscribes to a topic of that name, or is a client of such a service."""
    return name.startswith("/") and bool(node.count_subscribers(name) or node.count_clients(name))


def run_interrupted(words: list[str], begun: str, turtle: Node, output: io.StringIO) -> tuple[int, float | None]:
    """The exit status of a command line that is interrupted once it has begun, and after how many seconds it ended.

    None if it had not begun: then it ended by itself, or was interrupted after a time-out.
    """
    main, sent, has_ended = threading.main_thread().ident, [], threading.Event()
    assert main is not None

    def interrupt() -> None:
        if wait_until(lambda: has_ended.is_set() or is_used(begun, turtle) or begun in output.getvalue(), TIMEOUT):
            sent.append(time.monotonic())
        if not has_ended.is_set():
            signal.pthread_kill(main, signal.SIGINT)

    thread = threading.Thread(target=interrupt)
    gc.collect()  # an interrupt in a destructor of what other tests have left is lost
    gc.disable()
    thread.start()
    try:
        status = command.run(words)
        ended = time.monotonic()
    finally:
        has_ended.set()
        thread.join()
        gc.enable()
    return status, (ended - sent[0] if sent and sent[0] < ended else None)


@pytest.mark.parametrize("goes", VERBS, ids=lambda goes: goes.line)
def test_an_interrupt_ends_it(
    goes: Goes, turtle: Node, files: dict[str, str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    wait_for(lambda: not is_used(goes.begun, turtle))  # by the one before
    output, more = io.StringIO(), files | {"NEW": str(tmp_path / "new")}
    for stream in ("stdout", "stderr"):
        monkeypatch.setattr(sys, stream, output)
    words = [more.get(word, word) for word in shlex.split(goes.line)]
    status, seconds = run_interrupted(words, goes.begun, turtle, output)
    written = output.getvalue()[-2000:]
    assert seconds is not None, f"it had not begun: {written}"
    assert (status, seconds < WITHIN) == (goes.status, True), f"after {seconds:.1f} s: {written}"
    assert "Traceback" not in written
    assert turtle.context.ok()


def test_an_interrupt_in_the_midst_of_a_message_is_no_error(turtle: Node, monkeypatch: pytest.MonkeyPatch) -> None:
    with running(Walks):
        for _ in range(20):
            wait_for(lambda: not is_used("/walk", turtle))
            output = io.StringIO()
            monkeypatch.setattr(sys, "stdout", output)
            words = ["topic", "echo", "/walk", "--field", "header.frame_id"]
            status, seconds = run_interrupted(words, "---", turtle, output)
            assert (status, seconds is not None and seconds < WITHIN) == (signal.SIGINT, True)


# An interrupt while the command is still importing what its verb needs.
EARLY = """
import signal, sys
from course_kit.cli.ros2 import command

class Interrupting:
    def find_spec(self, name, *_):
        if name == "course_kit.cli.ros2.topic.topic":
            signal.raise_signal(signal.SIGINT)

sys.meta_path.insert(0, Interrupting())
command.main()
"""


def test_an_interrupt_before_a_verb_runs_ends_quietly() -> None:
    ended = subprocess.run(
        [sys.executable, "-c", EARLY, "topic", "list"], capture_output=True, text=True, timeout=TIMEOUT
    )
    assert (ended.stdout, ended.stderr, ended.returncode) == ("", "", signal.SIGINT)


@pytest.mark.parametrize(
    ("line", "begun"),
    [
        (f"topic pub /talk {STRING} -r 9e9", "publishing #100:"),
        (f"topic pub /talk {STRING} -r 9e9 -p 0", "beginning loop"),
        ("topic hz /nobody", "does not appear to be published yet"),
        (f"service call /nobody {TRIGGER}", "waiting for service"),
        ("run demo polite", "begun"),
        ("launch demo demo.launch.py", "begun"),
    ],
)
def test_the_interrupt_button_ends_it(line: str, begun: str, kernel: Kernel) -> None:
    cell = kernel.send(f"%ros2 {line}")
    kernel.until(lambda: begun in kernel.text(cell), TIMEOUT)
    kernel.manager.interrupt_kernel()
    interrupted = time.time()
    kernel.finish(cell)
    # By the kernel's clock: what it had written by then takes this test long to read.
    idle = next(m for m in kernel.of(cell) if m["content"].get("execution_state") == "idle")
    assert idle["header"]["date"].timestamp() - interrupted < WITHIN
    assert "Traceback" not in kernel.text(cell)
