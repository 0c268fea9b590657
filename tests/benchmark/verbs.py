"""Each verb of the `ros2` command, in a process of its own, beside twenty nodes: how long a user waits for it."""

from __future__ import annotations

import signal
import statistics
import subprocess
import tempfile
import time
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path

from course_kit.cli.ros2.command import COMMANDS
from tests.benchmark.child import Program, environment
from tests.benchmark.ros2 import NODES, PROCESSES, command
from tests.benchmark.table import Row, at_most
from tests.domains import reserve_domain

NOTE = (
    f"verbs: each beside {PROCESSES * NODES} nodes in {PROCESSES} processes, the median of runs in turn, from the "
    "start of the process to its end; those with an asterisk go on, and the time is that to their first line. The real "
    "`topic list` takes 0.65 s there, with its daemon."
)
NODE, SERVICE, ACTION = "/robot_0_0", "/robot_0_0/reset", "/robot_0_0/count"
TRIGGER, FIBONACCI, SCAN = "std_srvs/srv/Trigger", "example_interfaces/action/Fibonacci", "sensor_msgs/msg/LaserScan"
LIMITS = {"topic list": 0.30}
TABS = [
    "topic info /",
    "node info /",
    f"param get {NODE} ",
    "service call /",
    "action send_goal /",
    "topic pub /scan sen",
]
TAB_LIMIT = 0.30  # seconds
LAUNCH_FILE = """
from launch import LaunchDescription
from launch.actions import ExecuteProcess

def generate_launch_description():
    return LaunchDescription([ExecuteProcess(cmd=["true"])])
"""
PARAMETERS = "/**:\n  ros__parameters:\n    use_sim_time: false\n"
LAUNCH, BAG, PARAMETER_FILE, MADE = "once.launch.py", "recorded", "parameters.yaml", "made"
ENDING = [
    ["topic", "list"],
    ["topic", "info", "-v", "/scan"],
    ["topic", "type", "/scan"],
    ["topic", "find", SCAN],
    ["topic", "echo", "--once", "/scan"],
    ["topic", "pub", "--once", "-w", "0", "/said", "std_msgs/msg/String", "{data: hi}"],
    ["node", "list"],
    ["node", "info", NODE],
    ["service", "list"],
    ["service", "info", SERVICE],
    ["service", "type", SERVICE],
    ["service", "find", TRIGGER],
    ["service", "call", SERVICE, TRIGGER],
    ["action", "list"],
    ["action", "info", ACTION],
    ["action", "type", ACTION],
    ["action", "send_goal", ACTION, FIBONACCI, "{order: 1}"],
    ["param", "list", NODE],
    ["param", "get", NODE, "use_sim_time"],
    ["param", "set", NODE, "use_sim_time", "false"],
    ["param", "describe", NODE, "use_sim_time"],
    ["param", "dump", NODE],
    ["param", "load", NODE, PARAMETER_FILE],
    ["param", "delete", NODE, "nothing"],
    ["lifecycle", "nodes"],
    ["interface", "list"],
    ["interface", "show", SCAN],
    ["interface", "proto", SCAN],
    ["interface", "package", "std_msgs"],
    ["interface", "packages"],
    ["pkg", "list"],
    ["pkg", "prefix", "std_msgs"],
    ["pkg", "xml", "std_msgs"],
    ["pkg", "executables", "turtlesim"],
    ["pkg", "create", "made"],
    ["daemon", "status"],
    ["doctor"],
    ["bag", "info", BAG],
    ["bag", "play", BAG],
    ["launch", LAUNCH],
]
GOING_ON = [
    ["topic", "hz", "/scan"],
    ["topic", "bw", "/scan"],
    ["topic", "delay", "/scan"],
    ["run", "turtlesim", "turtlesim_node"],
    ["bag", "record", "-o", MADE, "/scan"],
]


def rows(quick: bool) -> Iterator[Row]:
    """All rows of this section."""
    domain, runs = reserve_domain(), 3 if quick else 30
    with ExitStack() as stack:
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="course-kit-verbs-")))
        Path(folder, LAUNCH).write_text(LAUNCH_FILE)
        Path(folder, PARAMETER_FILE).write_text(PARAMETERS)
        programs = [
            stack.enter_context(Program("full_graph", process, NODES, PROCESSES * NODES, domain=domain))
            for process in range(PROCESSES)
        ]
        for program in programs:
            program.report()
        scans = ["topic", "pub", "-r", "100", "/scan", SCAN, "{header: auto}"]
        stack.enter_context(_going_on(scans, folder, domain))
        _seconds(["bag", "record", "-o", BAG, "--duration", "1", "/scan"], folder, domain)
        for words in (words for words in [*ENDING, *GOING_ON] if words[0] in COMMANDS):
            goes_on = words in GOING_ON
            measure = _seconds_to_first_line if goes_on else _seconds
            median = statistics.median(measure(words, folder, domain, run) for run in range(runs if not goes_on else 3))
            verb = " ".join(word for word in words[:2] if "." not in word and word != BAG)
            what = f"ros2 {verb}{' *' if goes_on else ''}"
            yield at_most(what, "s", median, LIMITS[verb]) if verb in LIMITS else Row(what, "s", None, median)
        for line in TABS:
            median = statistics.median(_seconds_to_names(f"ros2 {line}", folder, domain) for _ in range(runs))
            yield at_most(f"Tab after `ros2 {line}`", "s", median, TAB_LIMIT)


def _seconds(words: Sequence[str], folder: Path, domain: int, run: int = 0) -> float:
    """From the start of a command to its end."""
    here = folder if words[1:2] != ["create"] else Path(tempfile.mkdtemp(dir=folder))
    began = time.monotonic()
    done = subprocess.run(
        command(words), cwd=here, env=environment(domain), capture_output=True, text=True, check=False, timeout=60
    )
    if done.returncode not in (0, 1):
        raise RuntimeError(f"`ros2 {' '.join(words)}` failed: {done.stderr}")
    return time.monotonic() - began


def _seconds_to_names(line: str, folder: Path, domain: int) -> float:
    """From a press of Tab behind a line to what it offers."""
    offered = folder / "offered"
    of_shell = {"_ARGCOMPLETE": "1", "COMP_LINE": line, "COMP_POINT": str(len(line)), "COMP_TYPE": "9"}
    variables = {**environment(domain), **of_shell, "_ARGCOMPLETE_STDOUT_FILENAME": str(offered)}
    began = time.monotonic()
    subprocess.run(command([]), cwd=folder, env=variables, check=False, timeout=60)
    seconds = time.monotonic() - began
    if not offered.read_text():
        raise RuntimeError(f"Tab after `{line}` offers nothing")
    return seconds


def _seconds_to_first_line(words: Sequence[str], folder: Path, domain: int, run: int) -> float:
    began = time.monotonic()
    with _going_on([f"{word}_{run}" if word == MADE else word for word in words], folder, domain):
        return time.monotonic() - began


@contextmanager
def _going_on(words: Sequence[str], folder: Path, domain: int) -> Iterator[None]:
    """A command that has written its first line, until the block ends."""
    running = subprocess.Popen(
        command(words),
        cwd=folder,
        env=environment(domain),
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        start_new_session=True,
    )
    assert running.stdout is not None
    try:
        if not running.stdout.readline():
            raise RuntimeError(f"`ros2 {' '.join(words)}` wrote nothing")
        draining = subprocess.Popen(["cat"], stdin=running.stdout, stdout=subprocess.DEVNULL)
        yield
    finally:
        running.send_signal(signal.SIGINT)
        running.wait(timeout=20)
        running.stdout.close()
    draining.wait(timeout=20)
