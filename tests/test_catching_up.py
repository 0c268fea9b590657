"""catch_up(): what a chapter has defined above a cell is there again after a restart, and what a student made stays."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

import pytest

from course_kit import catch_up
from tests.kernel import Kernel

pytestmark = pytest.mark.by_turns("many nodes and programs")

BROKEN_IMPORT = """
import builtins

def imported(name, *args, real=builtins.__import__, **kwargs):
    if name == "geometry_msgs.msg":
        raise ImportError("no wheel of it here")
    return real(name, *args, **kwargs)

builtins.__import__ = imported
"""
CATCH_UP = "from course_kit import catch_up\ncatch_up({cell!r})"


@pytest.fixture
def kernel() -> Iterator[Kernel]:
    kernel = Kernel()
    yield kernel
    kernel.close()


def caught_up(kernel: Kernel, cell: str) -> str:
    return kernel.text(kernel.run(CATCH_UP.format(cell=cell), 60.0))


def test_a_fresh_kernel_has_all_that_stands_above_and_nothing_of_what_stands_below(kernel: Kernel) -> None:
    said = caught_up(kernel, "topics-square-drive")
    assert said.startswith("Caught up: ")
    assert said.count("\n") == 1
    names = kernel.run("[name in globals() for name in ('Talker', 'Listener', 'Square', 'GoTo', 'talker')]")
    assert kernel.text(names) == "[True, True, True, False, False]"
    assert caught_up(kernel, "topics-square-drive") == "Nothing to catch up on: all that stands above is defined.\n"


def test_a_method_in_a_cell_of_its_own_is_in_its_class_again(kernel: Kernel) -> None:
    caught_up(kernel, "topics-goto-corners")
    assert kernel.text(kernel.run("GoTo.steer is steer")) == "True"


def test_what_the_student_has_defined_stays(kernel: Kernel) -> None:
    kernel.run("class Talker: mine = True")
    caught_up(kernel, "topics-square-drive")
    assert kernel.text(kernel.run("Talker.mine, Listener.__name__")) == "(True, 'Listener')"


def test_nothing_is_started(kernel: Kernel) -> None:
    caught_up(kernel, "services-stop-all")
    assert kernel.text(kernel.run("import rclpy; from course_kit import nodes; nodes(), rclpy.ok()")) == "([], False)"


def test_a_workspace_is_built_again_and_stays_when_nothing_is_missing(tmp_path: Path) -> None:
    with closing(Kernel(tmp_path)) as kernel:
        assert caught_up(kernel, "workspace-processes-talker").startswith("Caught up: ")
        assert (tmp_path / "ros2_ws/install/my_first_pkg").is_dir()
        mine = tmp_path / "ros2_ws/src/my_first_pkg/mine.txt"
        mine.touch()
        assert caught_up(kernel, "workspace-processes-talker").startswith("Nothing to catch up on")
        assert mine.exists()


def test_a_cell_that_fails_is_named(kernel: Kernel) -> None:
    kernel.run(BROKEN_IMPORT)
    cell = kernel.send(CATCH_UP.format(cell="topics-square-drive"))
    kernel.finish(cell)
    error = [m["content"] for m in kernel.of(cell) if m["msg_type"] == "error"][-1]
    assert error["ename"] == "RuntimeError"
    assert "catch_up stopped at the cell topics-types-fields" in error["evalue"]


def test_a_program_is_told_to_import() -> None:
    with pytest.raises(RuntimeError, match="works only in a notebook"):
        catch_up("topics-square-drive")
