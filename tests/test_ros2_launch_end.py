"""How a launch ends: Ctrl-C, signals, processes that do not listen, and no process left behind."""

from __future__ import annotations

import os
import signal
from pathlib import Path

import pytest

from tests.ros2_command import COMMAND
from tests.ros2_launches import Prefix, RunningGroup, is_alive, none_left
from tests.terminal import CTRL_C, Terminal
from tests.waiting import wait_until

DEAF = "import signal, time; signal.signal(signal.SIGINT, signal.SIG_IGN); print('deaf'); time.sleep(100)"
DEAFER = "import signal; signal.signal(signal.SIGTERM, signal.SIG_IGN);" + DEAF
COUNTING = """
import os, signal, sys, time
def count(number, frame):
    print("got", signal.Signals(number).name, flush=True)
    end = time.monotonic() + 0.3
    while time.monotonic() < end:
        time.sleep(0.01)
    sys.exit(0)
signal.signal(signal.SIGINT, count)
print("ready")
while True:
    time.sleep(0.05)  # Python calls the handler at the end of a sleep if the signal came just before it
"""
SHORT = "sigterm_timeout='0.4', sigkill_timeout='0.4'"
WARNING = "[WARNING] [launch]: user interrupted with ctrl-c (SIGINT)"


@pytest.fixture
def prefix(tmp_path: Path) -> Prefix:
    prefix = Prefix(tmp_path / "install")
    prefix.package("demo")
    return prefix


def launch(prefix: Prefix, entities: str, *words: str) -> RunningGroup:
    prefix.launch_file("demo", "demo.launch.py", entities)
    return RunningGroup("launch", *words, "demo", "demo.launch.py", environment=prefix.environment)


@pytest.mark.parametrize("whole_group", [True, False])
def test_an_interrupt_reaches_every_process_once(prefix: Prefix, whole_group: bool) -> None:
    child = f"python({COUNTING!r})"
    with launch(prefix, f"{child}, {child}") as running:
        running.wait_for("ready", 2)
        if whole_group:
            running.interrupt()
        else:
            running.process.send_signal(signal.SIGINT)
        assert running.end().status == 0
        assert running.lines.count(WARNING) == 1
        assert sorted(line for line in running.lines if "got" in line) == [
            "[child-1] got SIGINT",
            "[child-2] got SIGINT",
        ]
        # The newest first, as the real one does it.
        told = [line for line in running.lines if "sending" in line]
        assert told == [f"[INFO] [child-{n}]: sending signal 'SIGINT' to process[child-{n}]" for n in (2, 1)]
        assert len(running.wait_for("process has finished cleanly", 2)) == 2
        assert none_left(running.pids(2))


@pytest.mark.parametrize("by_key", [True, False])
def test_ctrl_c_in_a_terminal(prefix: Prefix, by_key: bool) -> None:
    prefix.launch_file("demo", "demo.launch.py", f"python({COUNTING!r}), python({COUNTING!r})")
    with Terminal([*COMMAND, "launch", "demo", "demo.launch.py"], prefix.environment) as terminal:
        terminal.wait_for("ready", 2)
        if by_key:
            terminal.press(CTRL_C)
        else:
            terminal.process.send_signal(signal.SIGINT)
        assert terminal.end() == 0
    assert terminal.text.count("got SIGINT") == 2
    # The terminal has told all processes; who interrupts the launch alone has not.
    assert terminal.text.count("sending signal") == (0 if by_key else 2)
    assert terminal.text.count("process has finished cleanly") == 2


def test_a_second_interrupt_is_ignored(prefix: Prefix) -> None:
    with launch(prefix, f"python({DEAF!r}, {SHORT})") as running:
        running.wait_for("deaf")
        running.interrupt()
        running.wait_for("ctrl-c")
        running.interrupt()
        running.wait_for(r"user interrupted with ctrl-c \(SIGINT\) again, ignoring\.\.\.")
        assert running.end().status == 0


def test_a_process_that_ignores_sigint_gets_sigterm(prefix: Prefix) -> None:
    with launch(prefix, f"python({DEAF!r}, {SHORT})") as running:
        (pid,) = running.pids()
        running.wait_for("deaf")
        running.interrupt()
        assert running.end().status == 0
        told = "failed to terminate '0.4' seconds after receiving 'SIGINT', escalating to 'SIGTERM'"
        after = running.lines[running.lines.index(f"[ERROR] [child-1]: process[child-1] {told}") :]
        assert after[1] == "[INFO] [child-1]: sending signal 'SIGTERM' to process[child-1]"
        assert after[2].startswith(f"[ERROR] [child-1]: process has died [pid {pid}, exit code -15, cmd '")
        assert not is_alive(pid)


def test_a_process_that_ignores_that_too_is_killed(prefix: Prefix) -> None:
    with launch(prefix, f"python({DEAFER!r}, {SHORT})") as running:
        running.wait_for("deaf")
        running.interrupt()
        assert running.end().status == 0
        told = "failed to terminate '0.8' seconds after receiving 'SIGTERM', escalating to 'SIGKILL'"
        assert f"[ERROR] [child-1]: process[child-1] {told}" in running.lines
        assert "exit code -9" in running.lines[-1]


@pytest.mark.slow("it waits for fifteen seconds")
def test_the_real_times_are_five_and_ten_seconds(prefix: Prefix) -> None:
    with launch(prefix, f"python({DEAFER!r})") as running:
        running.wait_for("deaf")
        running.interrupt()
        assert running.end().status == 0
        assert "'5' seconds after receiving 'SIGINT', escalating to 'SIGTERM'" in running.text
        assert "'10.0' seconds after receiving 'SIGTERM', escalating to 'SIGKILL'" in running.text


def test_processes_are_told_to_end_by_events(prefix: Prefix) -> None:
    entities = f"""
        deaf := python({DEAF!r}, {SHORT}),
        python("pass", on_exit=[EmitEvent(event=SignalProcess(
            signal_number="SIGTERM", process_matcher=matches_name("child-1")))]),
    """
    with launch(prefix, entities) as running:
        assert running.end().status == 0
        assert "[INFO] [child-1]: sending signal 'SIGTERM' to process[child-1]" in running.lines


def grandchildren(prefix: Prefix) -> RunningGroup:
    """A launch of a shell with a child of its own, both deaf, and of a program that makes itself a daemon."""
    code = (
        f"import subprocess, sys; c = subprocess.Popen([sys.executable, '-S', '-c', {DEAFER!r}]); print('pid', c.pid)"
    )
    daemon = (
        "import os, time; pid = os.fork(); pid and os._exit(0); os.setsid(); print('pid', os.getpid()); time.sleep(100)"
    )
    return launch(prefix, f"python({code + '; c.wait()'!r}), python({daemon!r}), python({DEAF!r})")


def all_pids(running: RunningGroup) -> list[int]:
    running.wait_for("deaf", 2)
    return [*running.pids(3), *(int(pid) for pid in running.wait_for(r"\] pid (\d+)", 2))]


def test_nothing_is_left_after_kill_9_of_the_launch(prefix: Prefix) -> None:
    with grandchildren(prefix) as running:
        pids = all_pids(running)
        assert sum(map(is_alive, pids)) >= 4
        os.kill(running.process.pid, signal.SIGKILL)
        wait_until(lambda: none_left(pids), f"end of {pids}", timeout=20)


def test_nothing_is_left_after_sigterm(prefix: Prefix) -> None:
    with grandchildren(prefix) as running:
        pids = all_pids(running)
        running.process.terminate()
        assert running.end().status == 1
        assert none_left(pids)
        assert [line for line in running.lines if line.startswith("[ERROR] [launch]")] == [
            "[ERROR] [launch]: user interrupted with ctrl-\\ (SIGTERM), terminating...",
            "[ERROR] [launch]: using SIGTERM can result in orphaned processes",
            "[ERROR] [launch]: make sure no processes launched are still running",
            "[ERROR] [launch]: run task was canceled",
        ]


def test_nothing_is_left_after_an_ordinary_end(prefix: Prefix) -> None:
    with grandchildren(prefix) as running:
        pids = all_pids(running)
        running.interrupt()
        assert running.end().status == 0
        assert none_left(pids)


def test_a_reader_that_goes_away_ends_the_launch(prefix: Prefix) -> None:
    talker = "import time\nwhile True: print('hello'); time.sleep(0.05)"
    with launch(prefix, f"python({talker!r})") as running:
        (pid,) = running.pids()
        running.stop_reading()
        assert running.process.wait(30) == 0
        assert not is_alive(pid)
