"""`ros2 run`: finds executables, passes arguments, signals and exit statuses."""

from __future__ import annotations

import re
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from course_kit.cli.ros2.line_completion import complete
from course_kit.ros import packages
from tests.ros2_command import COMMAND, TIMEOUT
from tests.ros2_launches import ROOT, Prefix, RunningGroup, none_left
from tests.terminal import CTRL_C, Terminal
from tests.waiting import wait_until

WAITING = """
import os, signal, sys, time
def end(number, frame):
    print("got", signal.Signals(number).name, flush=True)
    sys.exit(int(os.environ.get("STATUS", 0)))
signal.signal(signal.SIGINT, end)
signal.signal(signal.SIGTERM, end)
print("pid", os.getpid(), flush=True)
while True:
    time.sleep(0.05)  # Python calls the handler at the end of a sleep if the signal came just before it
"""


@pytest.fixture
def prefix(tmp_path: Path) -> Prefix:
    prefix = Prefix(tmp_path / "install")
    prefix.package("demo")
    return prefix


def test_arguments_reach_the_node(prefix: Prefix) -> None:
    prefix.node("demo", "reporter")
    words = ["run", "demo", "reporter", "--flag", "7", "--ros-args", "-r", "__ns:=/robot1", "-p", "speed:=2.5"]
    with RunningGroup(*words, environment=prefix.environment) as running:
        (report,) = running.reports()
        assert report["name"] == "/robot1/launched"
        assert report["arguments"] == ["--flag", "7"]
        assert report["parameters"]["speed"] == 2.5
        running.interrupt()
        assert running.end().status == 0
        assert running.lines[-1] == "ended well"


def test_unknown_names_are_told_with_a_suggestion(prefix: Prefix) -> None:
    prefix.program("demo", "reporter", "pass")
    for words, expected in {
        ("run", "dmo", "reporter"): ["Package 'dmo' not found", "Did you mean demo?"],
        ("run", "demo", "reportr"): ["No executable found", "Did you mean reporter?"],
    }.items():
        with RunningGroup(*words, environment=prefix.environment) as running:
            assert running.end().status == 1
            assert running.lines == expected


def test_several_executables_of_one_name_are_listed(prefix: Prefix) -> None:
    paths = [prefix.program("demo", name, "pass") for name in ("twin", "more/twin")]
    with RunningGroup("run", "demo", "twin", environment=prefix.environment) as running:
        assert running.end().status == 1
        assert running.lines == ["Multiple executables found:", *(f"- {path}" for path in paths)]


def test_a_prefix_goes_before_the_executable(prefix: Prefix) -> None:
    path = prefix.program("demo", "program", "pass")
    with RunningGroup(
        "run", "--prefix", "echo 'a b'", "demo", "program", "x", environment=prefix.environment
    ) as running:
        assert running.end().status == 0
        assert running.lines == [f"a b {path} x"]


@pytest.mark.parametrize(
    ("code", "status", "last"),
    [
        ("pass", 0, None),
        ("raise SystemExit(3)", 3, "[ros2run]: Process exited with failure 3"),
        ("import os; os.kill(os.getpid(), 11)", 245, "[ros2run]: Segmentation fault"),
    ],
)
def test_exit_status_of_the_program(prefix: Prefix, code: str, status: int, last: str | None) -> None:
    prefix.program("demo", "program", code)
    with RunningGroup("run", "demo", "program", environment=prefix.environment) as running:
        assert running.end().status == status
        assert running.lines == ([] if last is None else [last])


@pytest.mark.parametrize("whole_group", [True, False])
def test_an_interrupt_reaches_the_program_once(prefix: Prefix, whole_group: bool) -> None:
    prefix.program("demo", "program", WAITING)
    with RunningGroup("run", "demo", "program", environment=prefix.environment) as running:
        pid = int(running.wait_for(r"pid (\d+)")[0])
        if whole_group:
            running.interrupt()
        else:
            running.process.send_signal(signal.SIGINT)
        assert running.end().status == 0
        assert running.lines[1:] == ["got SIGINT"]
        assert none_left([pid])


def test_sigterm_reaches_the_program(prefix: Prefix) -> None:
    prefix.program("demo", "program", WAITING)
    with RunningGroup("run", "demo", "program", environment={**prefix.environment, "STATUS": "4"}) as running:
        running.wait_for("pid")
        running.process.terminate()
        assert running.end().status == 4
        assert running.lines[1:] == ["got SIGTERM", "[ros2run]: Process exited with failure 4"]


def test_ctrl_c_in_a_terminal(prefix: Prefix) -> None:
    prefix.program("demo", "program", WAITING)
    with Terminal([*COMMAND, "run", "demo", "program"], prefix.environment) as terminal:
        terminal.wait_for("pid")
        terminal.press(CTRL_C)
        assert terminal.end() == 0
    assert terminal.text.count("got SIGINT") == 1


WITH_A_CHILD = (
    """
import subprocess, sys
print("pid", subprocess.Popen([sys.executable, "-c", "import time; time.sleep(300)"]).pid, flush=True)
"""
    + WAITING
)


@pytest.mark.parametrize("in_terminal", [True, False])
def test_nothing_is_left_when_it_is_killed(prefix: Prefix, in_terminal: bool) -> None:
    prefix.program("demo", "program", WITH_A_CHILD)
    if in_terminal:
        with Terminal([*COMMAND, "run", "demo", "program"], prefix.environment) as terminal:
            terminal.wait_for("pid", 2)
            terminal.process.kill()
            pids = [int(pid) for pid in re.findall(r"pid (\d+)", terminal.text)]
            wait_until(lambda: none_left(pids), f"end of {pids}")
    else:
        with RunningGroup("run", "demo", "program", environment=prefix.environment) as running:
            pids = [int(pid) for pid in running.wait_for(r"pid (\d+)", 2)]
            running.process.kill()
            wait_until(lambda: none_left(pids), f"end of {pids}")


def test_tab_offers_packages_and_executables(prefix: Prefix, monkeypatch: pytest.MonkeyPatch) -> None:
    prefix.program("demo", "reporter", "pass")
    monkeypatch.setenv("AMENT_PREFIX_PATH", prefix.environment["AMENT_PREFIX_PATH"])
    assert complete("run dem") == ["demo"]
    assert complete("run demo rep") == ["reporter"]


def test_the_course_s_turtlesim_is_found() -> None:
    names = {path.name for path in packages.executables("turtlesim")}
    assert {"turtlesim_node", "turtle_teleop_key", "mimic"} <= names


def test_turtlesim_runs_by_the_tutorial_s_command(prefix: Prefix) -> None:
    with RunningGroup("run", "turtlesim", "turtlesim_node", environment=prefix.environment) as running:
        running.wait_for(r"Spawning turtle \[turtle1\]")
        running.interrupt()
        assert running.end().status == 0


def test_teleop_says_that_it_needs_a_terminal(prefix: Prefix) -> None:
    done = subprocess.run(
        [sys.executable, "-m", "course_kit.cli.ros2.command", "run", "turtlesim", "turtle_teleop_key"],
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        cwd=ROOT,
        timeout=TIMEOUT,
    )
    assert done.returncode == 1
    assert "not a terminal" in done.stderr
    assert done.stdout == "[ros2run]: Process exited with failure 1\n"
