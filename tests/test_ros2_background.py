"""`%ros2 … --background` in a real kernel: the cell is done, the verb goes on under it, and what ends it ends all."""

from __future__ import annotations

import contextlib
import os
import re
import signal
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.domains import own_domain
from tests.kernel import Kernel, kernel_after
from tests.ros2_command import ros2
from tests.ros2_launches import Prefix, none_left
from tests.waiting import wait_until

pytestmark = pytest.mark.by_turns("many nodes and programs")

TALK = '%ros2 topic pub -r 20 /chatter std_msgs/msg/String "{data: a  b}" --background'
TICKING = "import os, time\nprint('pid', os.getpid(), flush=True)\nwhile True: time.sleep(0.1)"
POLITE = """
import os, sys, time
try:
    print('pid', os.getpid(), *sys.argv[1:], flush=True)
    while True: time.sleep(0.1)
except KeyboardInterrupt:
    print('polite', flush=True)
"""


@contextlib.contextmanager
def kernel_in(folder: Path) -> Iterator[Kernel]:
    """A kernel in a domain of its own, with a package of programs that go on."""
    prefix = Prefix(folder / "install")
    prefix.launch_file("demo", "demo.launch.py", f"python({POLITE!r}), python({TICKING!r})")
    prefix.program("demo", "polite", POLITE)
    with own_domain(), pytest.MonkeyPatch.context() as patch:
        for name, value in prefix.environment.items():
            patch.setenv(name, value)
        with kernel_after("from course_kit import stop\nfrom course_kit.base.programs import processes") as kernel:
            yield kernel


@pytest.fixture(scope="module")
def one_kernel(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Kernel]:
    with kernel_in(tmp_path_factory.mktemp("background")) as kernel:
        yield kernel


@pytest.fixture
def kernel(one_kernel: Kernel) -> Iterator[Kernel]:
    yield one_kernel
    one_kernel.run("stop()", 40)


def until_shown(kernel: Kernel, cell: str, pattern: str) -> re.Match[str]:
    found: re.Match[str] = kernel.until(lambda: re.search(pattern, kernel.shown(cell), re.MULTILINE), 40)
    return found


def pids(kernel: Kernel, cell: str, count: int = 1) -> list[int]:
    """The processes that say so under a cell."""
    kernel.until(lambda: len(re.findall(r"pid \d+", kernel.shown(cell))) >= count, 40)
    return [int(pid) for pid in re.findall(r"pid (\d+)", kernel.shown(cell))]


def test_a_verb_goes_on_under_its_cell_and_stop_ends_it(kernel: Kernel) -> None:
    talk = kernel.run(TALK)
    measure = kernel.run("hz = %ros2 topic hz /chatter --window 20 --background\nhz")
    assert kernel.text(measure) == "▶ ros2 topic hz /chatter --window 20 running"
    rate = until_shown(kernel, measure, r"^  average rate: (\S+)")
    assert 15 < float(rate[1]) < 25
    assert rate.string.startswith("▶ ros2 topic hz /chatter --window 20 running\n")
    assert until_shown(kernel, talk, r"publishing #\d+: std_msgs.msg.String\(data='a  b'\)")
    assert kernel.text(kernel.run("%ros2 topic type /chatter")) == "std_msgs/msg/String\n"  # the kernel is free
    processes = [int(kernel.value("hz.process.pid"))]
    kernel.run("stop()", 40)
    assert until_shown(kernel, measure, r"^■ ros2 topic hz /chatter --window 20 stopped")
    assert until_shown(kernel, talk, "^■ ros2 topic pub .* stopped")
    assert none_left(processes)
    kernel.until(lambda: kernel.value("hz") == "<ros2, stopped>")


def test_its_button_and_its_view_end_a_launch_as_ctrl_c_does(kernel: Kernel) -> None:
    for end in ("view.stop()", "view.button.click()"):
        cell = kernel.run("view = %ros2 launch demo demo.launch.py --background")
        processes = pids(kernel, cell, 2)
        kernel.run(end, 40)
        text = until_shown(kernel, cell, r"^■ ros2 launch demo demo\.launch\.py stopped(?:.*\n)*").string
        assert "[child-1] polite" in text and "[INFO] [child-1]: process has finished cleanly" in text
        assert re.search(r"\[ERROR\] \[child-2\]: process has died \[pid \d+, exit code -2, cmd", text)
        assert none_left(processes)


def test_a_recording_that_is_ended_closes_its_bag(kernel: Kernel, tmp_path: Path) -> None:
    until_shown(kernel, kernel.run(TALK), r"publishing #\d+:")
    cell = kernel.run(f"record = %ros2 bag record --topics /chatter -o {tmp_path}/bag --background")
    until_shown(kernel, cell, "Subscribed to topic '/chatter'")
    kernel.run("%ros2 topic echo --once /chatter")  # and more come until the recording ends
    kernel.run("record.stop()", 40)
    said = ros2("bag", "info", f"{tmp_path}/bag").out
    assert re.search(r"Topic: /chatter \| Type: std_msgs/msg/String \| Count: [1-9]", said)


def test_the_next_run_of_its_cell_ends_it_first(kernel: Kernel) -> None:
    first = kernel.run("%ros2 run demo polite one --background", identity="a")
    other = kernel.run("%ros2 run demo polite other --background", identity="b")
    ended, goes_on = pids(kernel, first), pids(kernel, other)
    again = kernel.run("%ros2 run demo polite two --background", 40, identity="a")
    assert none_left(ended) and not none_left(goes_on)
    until_shown(kernel, first, "^■ ros2 run demo polite one stopped")
    assert until_shown(kernel, again, r"^▶ ros2 run demo polite two running\n  pid \d+ two$")
    # Of a front end that does not say which cell runs, the same line is the same verb.
    third = kernel.run("%ros2 run demo polite two --background", 40)
    until_shown(kernel, again, "^■ ros2 run demo polite two stopped")
    assert until_shown(kernel, third, r"^▶ ros2 run demo polite two running\n  pid \d+ two$")
    assert not none_left(goes_on)


def test_what_ends_by_itself_says_how(kernel: Kernel) -> None:
    found = kernel.run("%ros2 interface show --background std_msgs/msg/Bool")
    assert until_shown(kernel, found, r"^■ ros2 interface show std_msgs/msg/Bool ended \(exit status 0\)\n")
    missing = kernel.run("view = %ros2 topic type /nobody --background")
    assert until_shown(kernel, missing, r"^✘ ros2 topic type /nobody failed \(exit status 1\)$")
    kernel.until(lambda: kernel.value("view.is_running") == "False")
    kernel.run("view.stop()")
    assert kernel.shown(missing).startswith("✘ ros2 topic type /nobody failed (exit status 1)")


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ("topic hz --background", r"usage: ros2 topic hz (.|\n)*required: topic_name\n"),
        ("topic hz /a --window 0 --background", r"usage: ros2 topic hz (.|\n)*-w: value must be a positive integer\n"),
        ("--background", r"usage: ros2 (.|\n)*"),
        ("topic --background", r"usage: ros2 topic (.|\n)*"),
        ("topic hz 'a --background", r"ros2: No closing quotation.*\n"),
        ("run demo polite <long> --background", "ros2: cannot run .*: Argument list too long\n"),
    ],
)
def test_what_is_wrong_is_said_in_the_cell(kernel: Kernel, line: str, expected: str) -> None:
    assert re.fullmatch(expected, kernel.text(kernel.run(f"%ros2 {line.replace('<long>', 'x' * 200_000)}")))
    assert kernel.value("processes.running()") == "[]"


def test_a_program_has_an_option_of_that_name_to_itself(kernel: Kernel) -> None:
    cell = kernel.send("%ros2 run demo polite --background yes")
    kernel.until(lambda: re.search(r"pid \d+ --background yes\n", kernel.text(cell)), 20)
    kernel.manager.interrupt_kernel()
    kernel.finish(cell)


def test_nothing_is_left_when_the_kernel_ends(tmp_path: Path) -> None:
    with kernel_in(tmp_path) as kernel:
        processes = pids(kernel, kernel.run("%ros2 launch demo demo.launch.py --background"), 2)
        kernel.client.stop_channels()
        kernel.manager.restart_kernel()
        kernel.connect()
        wait_until(lambda: none_left(processes), f"end of {processes}")
        processes = pids(kernel, kernel.run("%ros2 launch demo demo.launch.py --background"), 2)
        os.kill(int(kernel.value("__import__('os').getpid()")), signal.SIGKILL)
        wait_until(lambda: none_left(processes), f"end of {processes}")


def test_tab_and_the_help_know_it_in_a_notebook(kernel: Kernel) -> None:
    for line in ("%ros2 topic hz /chatter --backg", "%ros2 run demo polite --backg"):
        matches = kernel.client.complete(line, len(line), reply=True, timeout=60)["content"]["matches"]
        assert "--background" in [match.strip() for match in matches], line
    assert "--background" in kernel.text(kernel.run("%ros2 --help"))
    assert "--background" in kernel.text(kernel.run("%ros2 launch --help"))


def test_a_terminal_refuses_it_and_does_not_offer_it() -> None:
    refused = ros2("topic", "list", "--background")
    assert (refused.status, refused.out) == (2, "")
    assert refused.err.endswith("in a terminal write & after the command line\n")
    assert "--background" not in ros2("topic", "list", "--help").out
