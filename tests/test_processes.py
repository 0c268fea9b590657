"""start(): programs as child processes, their lines, their end, and that none is left behind."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from course_kit import start, stop, wait_for
from course_kit.base.programs import processes
from course_kit.base.programs.process_output import LONGEST_LINE, LineCutter, as_seen
from tests.kernel import Kernel
from tests.ros2_launches import is_alive, none_left
from tests.waiting import wait_until

DEAF = "import signal, time; [signal.signal(n, signal.SIG_IGN) for n in (2, 15)]; print('deaf'); time.sleep(100)"
INTERRUPTED = """
import time
print('ready')
try:
    while True:
        time.sleep(0.05)
except KeyboardInterrupt:
    print('interrupted')
"""
# A child in a session of its own and one without a parent: what a shell's job control and daemons make.
FAMILY = """
import os, subprocess, sys, time
sleep = [sys.executable, '-c', 'import time; time.sleep(100)']
own = subprocess.Popen(sleep, start_new_session=True)
shell = f'"{sys.executable}" -c "import time; time.sleep(100)" > /dev/null 2>&1 & echo $!'
orphan = int(subprocess.run(['sh', '-c', shell], capture_output=True, text=True).stdout)
print('family', os.getpid(), own.pid, orphan)
time.sleep(100)
"""


def python(code: str, name: str | None = None) -> processes.Process:
    return start([sys.executable, "-c", code], name=name or code[:40])


@pytest.fixture(autouse=True)
def ended() -> Iterator[None]:
    yield
    processes.stop_all(patience=0.2)


def test_lines_are_kept_and_the_exit_status_is_told():
    process = python("import sys; print('one'); print('two', file=sys.stderr); print('end', end=''); sys.exit(3)")
    assert wait_for(process, timeout=20) == 3
    assert process.lines == ["one", "two", "end"]
    assert (process.status, process.state, process.is_running) == (3, "failed (exit status 3)", False)


def test_a_line_arrives_while_the_process_runs_without_a_flush():
    process = python("import time; print('ready'); time.sleep(100)")
    wait_for(lambda: process.says("ready"), timeout=20)
    assert (process.status, process.state) == (None, "running")


def test_stop_interrupts_as_ctrl_c_does():
    process = python(INTERRUPTED)
    wait_for(lambda: process.says("ready"), timeout=20)
    assert process.stop() == 0
    assert process.lines[-1] == "interrupted"
    assert process.state == "stopped (exit status 0)"
    assert process.stop() == 0  # again does nothing


def test_stop_interrupts_again_what_has_missed_the_first_interrupt():
    misses_one = (
        "import signal, sys, time\nheard = []\n"
        "signal.signal(signal.SIGINT, lambda *_: sys.exit(0) if heard else heard.append(1))\n"
        "print('ready', flush=True)\ntime.sleep(60)\ntime.sleep(60)"
    )
    process = start([sys.executable, "-c", misses_one])
    wait_for(lambda: process.says("ready"), timeout=20)
    assert process.stop(patience=10.0) == 0


def test_stop_kills_what_does_not_listen():
    process = python(DEAF)
    wait_for(lambda: process.says("deaf"), timeout=20)
    assert process.stop(patience=0.2) == -signal.SIGKILL
    assert process.state == "stopped (SIGKILL)"


def test_stop_ends_what_the_process_started():
    process = python(FAMILY)
    wait_for(lambda: process.says("family"), timeout=20)
    family = [int(pid) for pid in process.lines[0].split()[1:]]
    assert all(is_alive(pid) for pid in family)
    stop(process)
    assert none_left(family)


def test_the_same_command_again_replaces_the_process_and_a_name_keeps_both():
    code = "print('ready'); import time; time.sleep(100)"
    first, second = python(code), python(code)
    assert not first.is_running and first.stopped
    third = python(code, name="another")
    assert second.is_running and third.is_running
    stop()
    assert processes.running() == []


def test_a_timeout_says_what_the_process_does():
    process = python("import time; print('still here'); time.sleep(100)", name="sleeper")
    wait_for(lambda: process.says("still here"), timeout=20)
    with pytest.raises(TimeoutError, match=r"the end of `sleeper` .* 0\.1 s.* still runs, and its last line is: still"):
        wait_for(process, timeout=0.1)
    with pytest.raises(TimeoutError, match="still runs"):
        process.wait(0.1)


def test_a_wait_for_what_a_failed_process_should_have_done_names_it():
    process = python("raise SystemExit(3)", name="early end")
    wait_for(process, timeout=20)
    with pytest.raises(TimeoutError, match=r"`early end` failed \(exit status 3\)"):
        wait_for(lambda: process.says("ready"), timeout=0.1)


@pytest.mark.parametrize(
    ("command", "error", "says"),
    [
        ("no_such_command --now", FileNotFoundError, "there is no command 'no_such_command'"),
        ("ls | wc", ValueError, "without a shell"),
        ("source install/setup.bash && ros2 run demo talker", ValueError, "without a shell"),
        ("echo 'open", ValueError, "No closing quotation"),
        ("", ValueError, "needs a command"),
    ],
)
def test_bad_commands_are_refused_in_one_line(command, error, says):
    with pytest.raises(error, match=says) as raised:
        start(command)
    assert "\n" not in str(raised.value)


def test_a_folder_that_is_not_there_is_named(tmp_path):
    with pytest.raises(FileNotFoundError, match=r"the folder .*nowhere does not exist"):
        start("ls", folder=tmp_path / "nowhere")


def test_folder_and_environment_are_those_given(tmp_path):
    process = start("bash -c 'pwd; echo \"[$MINE]\"'", environment={**os.environ, "MINE": "yes"}, folder=tmp_path)
    assert wait_for(process, timeout=20) == 0
    assert process.lines == [str(tmp_path), "[yes]"]


def test_a_flood_is_read_and_its_end_is_kept():
    process = python("for n in range(30_000): print(n)")
    assert wait_for(process, timeout=60) == 0
    assert process.lines[-1] == "29999" and len(process.lines) == 10_000


def test_lines_are_cut_anywhere_and_have_no_colours():
    cutter = LineCutter()
    text = "\x1b[31mréd\x1b[0m\r\n10 %\r100 %\nrest".encode()
    lines = [as_seen(line) for n in range(len(text)) for line in cutter.feed(text[n : n + 1])]
    assert lines == ["réd", "100 %"]
    assert cutter.rest() == ["rest"] and cutter.rest() == []


def test_a_line_without_end_is_cut():
    cutter = LineCutter()
    lines = [line for _ in range(50) for line in cutter.feed(b"x" * 65536)] + cutter.rest()
    assert sum(map(len, lines)) == 50 * 65536
    assert max(map(len, lines)) <= LONGEST_LINE + 65536


def test_a_program_that_ends_ends_its_processes(tmp_path):
    program = tmp_path / "program.py"
    program.write_text(
        f"from course_kit import start, wait_for\np = start(['{sys.executable}', '-c', {FAMILY!r}])\n"
        "wait_for(lambda: p.says('family'), timeout=20)\nprint(p.lines[0])\n"
    )
    began = time.monotonic()
    done = subprocess.run([sys.executable, program], capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stderr) == (0, "")
    assert time.monotonic() - began < 20
    assert none_left([int(pid) for pid in done.stdout.split()[1:]])


@pytest.fixture
def kernel() -> Iterator[Kernel]:
    kernel = Kernel()
    try:
        kernel.run(f"from course_kit import start, stop, wait_for; import os, sys\nFAMILY = {FAMILY!r}")
        yield kernel
    finally:
        kernel.close()


def family(kernel: Kernel) -> list[int]:
    cell = kernel.run(
        "p = start([sys.executable, '-c', FAMILY], name='family'); wait_for(lambda: p.says('family'), timeout=20);"
        "print('\\n' + p.lines[0])"
    )
    line = next(line for line in kernel.text(cell).splitlines() if line.startswith("family"))
    return [int(pid) for pid in line.split()[1:]]


def test_lines_appear_under_the_cell_that_started_the_process(kernel):
    started = kernel.run("p = start('bash -c \"echo hello; read -t 100 < <(sleep 100)\"', name='greeter')")
    kernel.until(lambda: kernel.shown(started) == "▶ greeter running\n  hello")
    later = kernel.run("stop(p)")
    kernel.until(lambda: kernel.shown(started).startswith("■ greeter stopped (SIGINT)"))
    assert kernel.text(later) == ""


def test_a_failure_is_shown_under_the_cell(kernel):
    started = kernel.run("p = start('ls /no/such/place')")
    kernel.until(lambda: kernel.shown(started).startswith("✘ ls /no/such/place failed (exit status 2)\n  ls: "))


def test_an_interrupt_of_the_notebook_leaves_the_process_alone(kernel):
    pids = family(kernel)
    cell = kernel.send("print('waiting', flush=True); wait_for(p, timeout=600)")
    kernel.until(lambda: "waiting" in kernel.text(cell))  # an interrupt before the cell's first line goes unseen
    kernel.manager.interrupt_kernel()
    kernel.finish(cell)
    assert [m["content"]["ename"] for m in kernel.of(cell) if m["msg_type"] == "error"] == ["KeyboardInterrupt"]
    assert all(is_alive(pid) for pid in pids)


def test_nothing_is_left_when_the_kernel_is_killed(kernel):
    pids = family(kernel)
    os.kill(int(kernel.text(kernel.run("print(os.getpid())"))), signal.SIGKILL)
    wait_until(lambda: none_left(pids), f"end of {pids}", timeout=20)


@pytest.mark.parametrize("now", [True, False], ids=["at once", "politely"])
def test_nothing_is_left_when_the_kernel_is_restarted(kernel, now):
    pids = family(kernel)
    watchers = watchers_of(pids[0])
    kernel.client.stop_channels()
    kernel.manager.restart_kernel(now=now)
    kernel.connect()
    wait_until(lambda: none_left([*pids, *watchers]), f"end of {pids} and {watchers}", timeout=20)


def test_nothing_is_left_when_the_kernel_is_shut_down(kernel):
    pids = family(kernel)
    watchers = watchers_of(pids[0])
    assert watchers
    process = kernel.manager.provisioner.process
    kernel.client.shutdown()
    assert process.wait(timeout=20) == 0
    assert none_left(pids)
    wait_until(lambda: none_left(watchers), f"end of {watchers}", timeout=10)


def watchers_of(pid: int) -> list[int]:
    """The watcher of the kernel that started a process: another child of the kernel."""
    kernel = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[1]
    found = []
    for entry in Path("/proc").glob("[0-9]*"):
        try:
            is_child = (entry / "stat").read_text().rpartition(")")[2].split()[1] == kernel
            if is_child and b"orphans.py" in (entry / "cmdline").read_bytes():
                found.append(int(entry.name))
        except OSError:
            continue
    return found
