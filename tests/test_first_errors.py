"""Errors of the first week: each gives one sentence with cause and cure, in its cell or its box and in the check."""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator
from concurrent.futures import Future

import pytest

from course_kit.ros.causes import cause_of
from course_kit.ros.causes.frames import folded, steps
from tests.domains import OF_NO_TEST
from tests.first_errors import CASES, SET_UP, Case
from tests.kernel import Kernel, kernel_after

pytestmark = pytest.mark.by_turns("a program or a cell for each", of="cases")

# What a check would be told of the class X: as its own process orders it, with the notebook's side in this kernel.
CHECKING = """
from course_kit.exercises.in_notebook import answer_host
from course_kit.exercises.domains import reserve_domain
from course_kit.base.polling import wait_until
stage = reserve_domain()

def told_in_check():
    order = {"domain": stage, "node_class": "X", "keeper": "_ros2cli_1", "threads": False}
    started = answer_host.obey({"do": "start", **order}, globals(), 5.0)
    told = [started["trace"]] if "trace" in started else wait_until(
        lambda: answer_host.obey({"do": "errors", **order}, globals(), 5.0)["value"], 5.0)
    answer_host.obey({"do": "stop", **order}, globals(), 5.0)
    return told[0]
"""
OF_LIBRARIES = re.compile(r"course_kit/(?!.*\.ipynb)|rclpy/|in _spin|spin_some|await_or_execute")


@pytest.fixture(scope="module")
def kernel() -> Iterator[Kernel]:
    with kernel_after(SET_UP + CHECKING) as one:
        yield one


def plain(text: str) -> str:
    return re.sub(r"\x1b\[[0-9;]*m", "", text)


def error_of(kernel: Kernel, cell: str) -> str:
    """The traceback that a cell shows, without colours; '' if there is none."""
    errors = [m["content"] for m in kernel.of(cell) if m["msg_type"] == "error"]
    return plain("\n".join(errors[0]["traceback"])) if errors else ""


def shown(kernel: Kernel, code: str, until: str = "") -> str:
    """What a cell shows of its error: in a traceback, or in the box of the node that it runs."""
    cell = kernel.send(code)
    kernel.finish(cell)
    if error := error_of(kernel, cell):
        return error
    kernel.until(lambda: until in kernel.shown(cell) or "✘" in kernel.shown(cell))
    return kernel.shown(cell)


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_an_error_says_its_cause_and_cure_in_a_sentence(kernel: Kernel, case: Case) -> None:
    kernel.run("stop()")
    told = shown(kernel, case.code + ("\nx = run(X)" if case.is_class else ""), case.says)
    assert told.count(case.says) == 1, told
    assert told.count("→ ") <= 1 and not OF_LIBRARIES.search(told), told
    if case.is_class and case.is_raised:
        kernel.run("stop()")
        cell = kernel.run("print(told_in_check())")
        kernel.until(lambda: kernel.text(cell))
        assert kernel.text(cell).count(case.says) == 1, kernel.text(cell)
        assert not OF_LIBRARIES.search(kernel.text(cell)), kernel.text(cell)


@pytest.fixture
def other() -> Iterator[Kernel]:
    with kernel_after(SET_UP) as one:
        yield one


def until_shown(kernel: Kernel, cell: str, said: str, timeout: float = 15.0) -> None:
    kernel.until(lambda: said in kernel.shown(cell), timeout)


def test_a_node_of_the_same_name_in_another_notebook_is_said_in_the_box_and_by_wait_for(
    kernel: Kernel, other: Kernel
) -> None:
    kernel.run("stop()")
    cell = kernel.run("same = run(Node, 'same')")
    there = other.run("same = run(Node, 'same')")
    said = (
        "Another notebook runs a node /same as well, in this domain, and others take the two for one: call stop() there"
    )
    until_shown(kernel, cell, said)
    until_shown(other, there, said)
    error = shown(kernel, "wait_for(lambda: False, timeout=0.1)")
    assert error.count(said) == 1 and "Is the node that should bring it running?" not in error
    other.run("stop()")
    kernel.until(lambda: kernel.shown(cell) == "▶ /same running", 15)


def test_a_second_node_of_the_name_that_a_cell_has_made_is_said(kernel: Kernel) -> None:
    kernel.run("stop()")
    cell = kernel.run("first = run(Node, 'twice')\nsecond = Node('twice')")
    until_shown(
        kernel, cell, "This notebook runs a node /twice as well, in this domain, and others take the two for one"
    )
    kernel.run("second.destroy_node()")
    kernel.until(lambda: kernel.shown(cell) == "▶ /twice running", 15)


def test_a_changed_domain_is_said_in_the_box(kernel: Kernel) -> None:
    kernel.run("run(Node, 'x')\nimport os\nbefore = os.environ['ROS_DOMAIN_ID']")
    cell = kernel.run(f"os.environ['ROS_DOMAIN_ID'] = '{OF_NO_TEST}'\nx = run(Node, 'x')")
    until_shown(kernel, cell, f"ROS_DOMAIN_ID is {OF_NO_TEST} by now, and the nodes of this notebook stay in domain")
    kernel.run("os.environ['ROS_DOMAIN_ID'] = before")
    kernel.until(lambda: kernel.shown(cell) == "▶ /x running", 15)


def test_a_callback_that_does_not_return_is_said_and_neither_stopped_nor_doubled_unseen(kernel: Kernel) -> None:
    kernel.run("stop()\nimport threading\nreturns = threading.Event()")
    cell = kernel.run(
        "class X(Base):\n    def tick(self):\n        returns.wait()\n        self.destroy_timer(next(self.timers))\n"
        "x = run(X)"
    )
    until_shown(kernel, cell, "A callback has not returned since ")
    assert "(line 3 of tick: returns.wait()), and until it does this node does nothing else" in kernel.shown(cell)
    where = "/x is not stopped: a callback of it has been in line 3 of tick: returns.wait() since "
    for code in ("stop(x)", "x = run(X)", "stop()"):
        error = shown(kernel, code)
        assert where in error and "when the kernel is restarted (menu Kernel, Restart)" in error, error
        assert not OF_LIBRARIES.search(error)
    until_shown(kernel, cell, "✘ /x stuck in a callback")
    kernel.run("returns.set()")
    kernel.until(lambda: kernel.shown(cell) == "■ /x stopped", 15)
    kernel.run("y = run(Node, 'y')\nwait_for(lambda: 'x' not in y.get_node_names())")


def test_rclpy_spin_in_a_cell_says_what_to_write_and_its_node_ends_with_an_interrupt(kernel: Kernel) -> None:
    kernel.run("y = run(Node, 'y')")
    cell = kernel.send("spun = Node('spun')\nspun.create_timer(0.05, lambda: print('tick'))\nrclpy.spin(spun)")
    kernel.until(lambda: "in a notebook write run(node) in its place" in kernel.text(cell), 3)
    assert "tick" in kernel.text(cell)
    kernel.manager.interrupt_kernel()
    kernel.finish(cell, 5)
    assert error_of(kernel, cell).count("\n") < 12 and not OF_LIBRARIES.search(error_of(kernel, cell))
    kernel.run("wait_for(lambda: 'spun' not in y.get_node_names())")


MAIN = """
def main():
    rclpy.init()
    node = Node('in_main')
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        print('ended')
    finally:
        node.destroy_node()

print('begun', flush=True)
main()
"""


def test_a_main_function_as_tutorials_have_it_ends_with_an_interrupt(kernel: Kernel) -> None:
    kernel.run("y = run(Node, 'y')")
    cell = kernel.send(MAIN)
    kernel.until(lambda: "keeps this cell busy" in kernel.text(cell), 3)
    kernel.manager.interrupt_kernel()
    kernel.finish(cell, 5)
    assert "ended" in kernel.text(cell) and not error_of(kernel, cell)
    kernel.run("wait_for(lambda: 'in_main' not in y.get_node_names())")


def test_an_interrupted_wait_shows_the_cell_alone(kernel: Kernel) -> None:
    cell = kernel.send("print('waiting', flush=True)\nwait_for(lambda: False, timeout=60)")
    kernel.until(lambda: "waiting" in kernel.text(cell))
    kernel.manager.interrupt_kernel()
    kernel.finish(cell, 5)
    error = error_of(kernel, cell)
    assert "KeyboardInterrupt" in error and error.count("\n") < 12 and not OF_LIBRARIES.search(error), error


def raised_in_a_library(error: BaseException) -> BaseException:
    """Have a library raise an error; return the error with frames of that library alone."""
    future: Future[None] = Future()
    future.set_exception(error)
    with pytest.raises(type(error)):
        future.result()
    assert error.__traceback__ is not None
    return error.with_traceback(error.__traceback__.tb_next)


def test_an_interrupt_before_the_first_line_of_a_cell_has_no_frames() -> None:
    error = raised_in_a_library(KeyboardInterrupt())
    error.__context__ = raised_in_a_library(KeyError("what"))
    assert list(steps(error.__traceback__))
    with folded(error):
        assert not list(steps(error.__traceback__)) and error.__suppress_context__
    assert list(steps(error.__traceback__)) and not error.__suppress_context__


@pytest.mark.skipif(sys.version_info < (3, 11), reason="Python 3.10 cannot say that an instruction has no line")
def test_an_interrupt_at_an_instruction_without_a_line_is_shown_at_the_first_one_of_its_function() -> None:
    for_eight_units_no_line = 0x80 | 15 << 3 | 7
    code = compile("\n\nraise KeyboardInterrupt", "/cell.py", "exec")
    with pytest.raises(KeyboardInterrupt) as caught:
        exec(code.replace(co_linetable=bytes([for_eight_units_no_line])), {})
    error = caught.value
    assert [step.tb_lineno for step in steps(error.__traceback__)][-1] in (None, -1)
    assert not cause_of(error)
    with folded(error):
        assert [step.tb_lineno for step in steps(error.__traceback__)][-1] == code.co_firstlineno


def test_a_time_out_shows_its_cell_and_what_did_not_come(kernel: Kernel) -> None:
    kernel.run("stop()")
    error = shown(kernel, "wait_for(lambda: False, timeout=0.1)")
    assert "TimeoutError: the condition in" in error and error.count("\n") < 8 and not OF_LIBRARIES.search(error), error


def test_verbose_tracebacks_have_all_frames(kernel: Kernel) -> None:
    error = shown(kernel, "%xmode Verbose\nwait_for(lambda: False, timeout=0.1)")
    kernel.run("%xmode Context")
    assert "background/waiting.py" in error


def test_run_as_the_last_line_gives_the_nodes_name(kernel: Kernel) -> None:
    cell = kernel.run("run(Node, 'last')")
    results = [m["content"]["data"]["text/plain"] for m in kernel.of(cell) if m["msg_type"] == "execute_result"]
    assert results == ["/last, a Node node in the background"]
