"""The checker's process: it stays, is replaced, goes with its kernel; whatever the student's node does, it answers."""

from __future__ import annotations

import os
import signal
import statistics
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import psutil  # type: ignore[import-untyped]
import pytest

from tests.exercises.chapter import changed
from tests.exercises.services.services_1_lamp import LAMP
from tests.exercises.topics.topics_1_countdown import COUNTDOWN
from tests.kernel import Kernel
from tests.waiting import wait_until

pytestmark = [
    pytest.mark.usefixtures("fresh_domain"),
    pytest.mark.by_turns("many nodes and programs"),
]

IMPORTS = """
from example_interfaces.srv import AddTwoInts
from rclpy.node import Node
from std_msgs.msg import Int32, String
from course_kit import check, logs, nodes, run, stop, wait_for
from course_kit.exercises.in_notebook import checker_client
"""
LOOPS = changed(
    COUNTDOWN, ("        if self.publisher.get", "        while True:\n            pass\n        if self.publisher.get")
)
SLEEPS = changed(
    COUNTDOWN, ("        if self.publisher.get", "        import time; time.sleep(1000)\n        if self.publisher.get")
)


@contextmanager
def notebook(state: Path) -> Iterator[Kernel]:
    """A kernel with what chapters import; progress is kept in the folder `state`."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_STATE_HOME", str(state))
        made = Kernel()
    try:
        made.run(IMPORTS)
        yield made
    finally:
        made.close()


@pytest.fixture(scope="module")
def state(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("state")


@pytest.fixture(scope="module")
def shared(state: Path) -> Iterator[Kernel]:
    with notebook(state) as kernel:
        yield kernel


@pytest.fixture
def kernel(shared: Kernel) -> Kernel:
    """One for several tests, without what the one before has left in it."""
    shared.run("from course_kit import stop; stop()")
    shared.run("%reset -f")
    shared.run(IMPORTS)
    return shared


@pytest.fixture
def own_kernel(tmp_path: Path) -> Iterator[Kernel]:
    """One that is the test's alone, and may end with it."""
    with notebook(tmp_path) as kernel:
        yield kernel


def shown(kernel: Kernel, code: str) -> str:
    return kernel.text(kernel.run(code, 60)).strip()


def checker_of(kernel: Kernel) -> int:
    return int(shown(kernel, "checker_client.pid()"))


def is_gone(pid: int) -> bool:
    try:
        return psutil.Process(pid).status() == psutil.STATUS_ZOMBIE
    except psutil.NoSuchProcess:
        return True


def wait(condition: Callable[[], bool], timeout: float = 15.0) -> None:
    deadline = time.monotonic() + timeout
    while not condition():
        assert time.monotonic() < deadline
        time.sleep(0.05)


def test_a_warm_check_costs_little_more_than_what_is_observed(kernel: Kernel):
    kernel.run('check("topics-1")')
    times = [float(shown(kernel, _timed('check("topics-1")'))) for _ in range(9)]
    assert statistics.median(times) < 0.1, times


def _timed(code: str) -> str:
    return (
        "import contextlib, io, time\n"
        "from IPython.utils.capture import capture_output\n"
        f"began = time.monotonic()\nwith capture_output():\n    {code}\ntime.monotonic() - began"
    )


@pytest.fixture
def one_heap(monkeypatch: pytest.MonkeyPatch) -> None:
    """All threads of processes begun from now on share a heap: a new thread's own one keeps megabytes that are free."""
    monkeypatch.setenv("MALLOC_ARENA_MAX", "1")


@pytest.mark.timeout(180)
@pytest.mark.usefixtures("one_heap")
def test_fifty_checks_leave_the_memory_as_it_was(own_kernel: Kernel):
    own_kernel.run(changed(LAMP, ("lamp = run(Lamp)", "")))
    assert "2 of 2" in shown(own_kernel, 'check("services-1")')
    processes = [
        psutil.Process(checker_of(own_kernel)),
        psutil.Process(int(shown(own_kernel, "import os; os.getpid()"))),
    ]
    looks = []
    for _ in range(30):  # until the allocator has what it keeps
        assert "2 of 2" in shown(own_kernel, 'check("services-1")')
        looks.append([p.num_threads() for p in processes])  # some come and go
    before = [process.memory_info().rss for process in processes]
    threads, files = [max(each) for each in zip(*looks, strict=True)], [p.num_fds() for p in processes]
    for _ in range(50):
        assert "2 of 2" in shown(own_kernel, 'check("services-1")')
    grown = [p.memory_info().rss - earlier for p, earlier in zip(processes, before, strict=True)]
    print("grown by", [round(one / 1e6, 1) for one in grown], "MB of", [round(one / 1e6) for one in before])
    assert all(one < 2e6 for one in grown), grown
    wait_until(lambda: all(p.num_threads() <= most for p, most in zip(processes, threads, strict=True)))
    assert all(p.num_fds() <= earlier + 2 for p, earlier in zip(processes, files, strict=True))


def test_a_killed_checker_is_replaced(kernel: Kernel):
    assert "not begun" in shown(kernel, 'check("topics-1")')
    first = checker_of(kernel)
    os.kill(first, signal.SIGKILL)
    assert "not begun" in shown(kernel, 'check("topics-1")')
    assert checker_of(kernel) != first


@pytest.mark.timeout(60)
def test_a_checker_killed_during_a_check_is_replaced(kernel: Kernel):
    kernel.run(changed(COUNTDOWN, ("countdown = run(Countdown)", "")))
    kernel.run('check("topics-2")')
    first = checker_of(kernel)
    cell = kernel.send('check("topics-1")')
    time.sleep(1.0)  # in the midst of what the check observes
    os.kill(first, signal.SIGKILL)
    kernel.finish(cell, 40)
    assert "2 of 2 points" in kernel.text(cell)


def test_the_checker_goes_with_its_kernel(own_kernel: Kernel):
    own_kernel.run('check("topics-1")')
    checker = checker_of(own_kernel)
    os.kill(int(shown(own_kernel, "import os; os.getpid()")), signal.SIGKILL)
    wait(lambda: is_gone(checker))


def test_the_checker_goes_when_the_kernel_ends_in_good_order(own_kernel: Kernel):
    own_kernel.run('check("topics-1")')
    checker = checker_of(own_kernel)
    own_kernel.manager.shutdown_kernel(now=False)
    wait(lambda: is_gone(checker))


def test_interrupting_a_check_leaves_the_notebook_as_it_was(kernel: Kernel):
    kernel.run(COUNTDOWN)
    kernel.run('check("topics-2")')
    cell = kernel.send('check("topics-1")')
    kernel.until(lambda: any(m["content"].get("execution_state") == "busy" for m in kernel.of(cell)))
    time.sleep(1.0)  # in the midst of what the check observes
    kernel.manager.interrupt_kernel()
    kernel.finish(cell, 20)
    assert "2 of 2 points" in shown(kernel, 'check("topics-1")')
    assert shown(kernel, "[n.get_name() for n in nodes()]") == "['countdown']"


@pytest.mark.timeout(90)
@pytest.mark.parametrize("source", [LOOPS, SLEEPS], ids=["loops", "sleeps"])
def test_a_node_that_blocks_is_told_so_in_time(kernel: Kernel, source: str):
    kernel.run(changed(source, ("countdown = run(Countdown)", "")))
    began = time.monotonic()
    text = shown(kernel, 'check("topics-1")')
    assert time.monotonic() - began < 20
    assert "0 of 2 points" in text and "Nothing came" in text
    assert "not begun" in shown(kernel, 'check("topics-2")')


@pytest.mark.timeout(60)
def test_a_constructor_that_never_returns_is_told_so_in_time(kernel: Kernel):
    kernel.run(
        changed(
            COUNTDOWN,
            ("self.left = 10", "self.left = 10\n        while True:\n            pass"),
            ("countdown = run(Countdown)", ""),
        )
    )
    text = shown(kernel, 'check("topics-1")')
    assert "did not return" in text and "is never spun" in text


@pytest.mark.timeout(60)
def test_the_students_nodes_are_left_as_they_were(kernel: Kernel):
    kernel.run(LAMP + "\nlamp.is_on = True\nasker = run(Node, 'asker')")
    assert "2 of 2 points" in shown(kernel, 'check("services-1")')
    assert shown(kernel, "lamp.is_on, [n.get_name() for n in nodes()]") == "(True, ['lamp', 'asker'])"
    kernel.run("lamp.get_logger().info('still logged')")
    kernel.run("wait_for(lambda: any('still logged' in line.text for line in logs('lamp')))")
    names = shown(kernel, "sorted(n for n in asker.get_node_names() if not n.startswith('_'))")
    assert names == "['asker', 'lamp']"


def test_bad_questions_get_a_clear_line(kernel: Kernel):
    assert shown(kernel, 'check("topic-1")').startswith(
        "check: there is no exercise 'topic-1'. Did you mean 'topics-1'?"
    )
    assert "takes no value" in shown(kernel, 'check("topics-1", 3)')
    assert "object is no plain value" in shown(kernel, 'check("setup-1", object())')
    assert shown(kernel, 'check("setup-1", "x" * 11_000_000)') == (
        "check: the value cannot be checked: it is 11 MB long as text, and a check takes 10 MB at most"
    )


def test_strict_raises_for_what_is_begun_and_not_right(kernel: Kernel):
    kernel.run("import os; os.environ['COURSE_KIT_STRICT'] = '1'")
    kernel.run('check("topics-1")')  # not begun
    kernel.run("class Countdown: pass")
    cell = kernel.send('check("topics-1")')
    kernel.finish(cell, 20)
    kernel.run("del os.environ['COURSE_KIT_STRICT']")
    errors = [m["content"]["ename"] for m in kernel.of(cell) if m["msg_type"] == "error"]
    assert errors == ["AssertionError"]


def test_progress_is_kept_and_drawn(kernel: Kernel, state: Path):
    kernel.run(changed(LAMP, ("lamp = run(Lamp)", "")))
    kernel.run('check("services-1")')
    kernel.run("%load_ext course_kit.exercises.in_notebook.check")
    text = shown(kernel, "%progress")
    assert "✔ services-1" in text and "○ services-2" in text
    assert (state / "ros2-notebook-course" / "progress.json").exists()


def test_progress_begins_with_the_total_and_the_chapter_at_hand(kernel: Kernel):
    def order() -> list[str]:
        return [line.split("  ")[0] for line in shown(kernel, "%progress").splitlines() if not line.startswith(" ")]

    kernel.run('check("services-1")')
    assert order()[:4] == ["The course", "4 · Services", "1 · Setup checks", "2 · Workspace"]
    kernel.run("import os; os.environ['JPY_SESSION_NAME'] = '/home/a student/06_debugging.ipynb'")  # as Jupyter's does
    assert order()[:3] == ["The course", "6 · Debugging", "1 · Setup checks"]
    kernel.run("del os.environ['JPY_SESSION_NAME']")


def test_a_class_found_under_another_name_is_asked_for(kernel: Kernel):
    kernel.run(changed(COUNTDOWN, ("class Countdown", "class CountDown"), ("run(Countdown)", "run(CountDown)")))
    assert "The exercise asks for that name" in shown(kernel, 'check("topics-1")')
