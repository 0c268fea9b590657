"""An answer that stands in the notebook and did not get as far as a node is not called unbegun: its error is told."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.domains import OF_NO_TEST
from tests.kernel import Kernel

pytestmark = pytest.mark.by_turns("many nodes and programs")

COUNTER = "class Countdown(Node):\n    def __init__(self):\n        super().__init__('countdown')\n"
IMPORTS = "from rclpy.node import Node\nfrom course_kit import check, run, stop\n"


@pytest.fixture
def saved(tmp_path: Path) -> Path:
    """The notebook of the kernel, as it was saved last."""
    return tmp_path / "chapter.ipynb"


@pytest.fixture
def kernel(tmp_path: Path, saved: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Kernel]:
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))
    monkeypatch.setenv("JPY_SESSION_NAME", str(saved))
    one = Kernel()
    yield one
    one.close()


def verdict(kernel: Kernel, exercise: str) -> str:
    return kernel.text(kernel.run(f'from course_kit import check\ncheck("{exercise}")', 60))


def save(notebook: Path, source: str) -> None:
    cell = {"cell_type": "code", "source": source.splitlines(keepends=True)}
    notebook.write_text(json.dumps({"cells": [cell]}))


def test_an_untouched_answer_is_not_begun(kernel: Kernel, saved: Path) -> None:
    save(saved, "# class Countdown(Node):\n#     …\n")
    assert "not begun" in verdict(kernel, "topics-1")
    kernel.run("# class Countdown(Node):")
    assert "not begun" in verdict(kernel, "topics-1")


def test_an_answer_cell_that_failed_in_a_fresh_kernel_is_told_with_its_cause(kernel: Kernel) -> None:
    kernel.finish(kernel.send(COUNTER))
    said = verdict(kernel, "topics-1")
    assert "not begun" not in said
    assert "Its cell ended with NameError: name 'Node' is not defined." in said
    assert "→ No cell that has run in this kernel made Node: after a restart of the kernel, run the cells above" in said
    kernel.run(IMPORTS + COUNTER)
    assert "Its cell ended" not in verdict(kernel, "topics-1")


def test_an_answer_cell_with_a_slip_of_the_pen_is_told_with_its_line(kernel: Kernel) -> None:
    kernel.run(IMPORTS)
    kernel.finish(kernel.send(COUNTER.replace("(self):", "(self)")))
    said = verdict(kernel, "topics-1")
    assert "Its cell ended with SyntaxError: expected ':', in line 2: `def __init__(self)`." in said


def test_an_answer_cell_that_has_not_run_since_the_kernel_started_is_asked_for(kernel: Kernel, saved: Path) -> None:
    save(saved, COUNTER)
    said = verdict(kernel, "topics-1")
    assert "Its cell has not run since this kernel started: run the cell with class Countdown, then this one." in said


def test_a_check_says_that_the_domain_was_changed_too_late(kernel: Kernel) -> None:
    kernel.run(IMPORTS + COUNTER + f"run(Countdown)\nimport os\nos.environ['ROS_DOMAIN_ID'] = '{OF_NO_TEST}'")
    said = verdict(kernel, "topics-1")
    told = f"check: ROS_DOMAIN_ID is {OF_NO_TEST} by now, and the nodes of this notebook stay in domain"
    assert said.count(told) == 1
    assert "Its cell" not in said


def test_a_check_says_that_another_notebook_runs_a_node_of_the_name(kernel: Kernel) -> None:
    greeter = (
        "class Greeter(Node):\n    def __init__(self):\n        super().__init__('greeter')\n"
        "        self.get_logger().info('Nice to meet you, Ada')\nrun(Greeter)"
    )
    other = Kernel()
    try:
        other.run(IMPORTS + greeter)
        kernel.run(IMPORTS + greeter)
        # It may not have heard of the other one yet: an announcement takes its time on a busy machine.
        said = kernel.until(lambda: "✘ there is one `/greeter`" in (now := verdict(kernel, "setup-2")) and now, 40)
        assert "call stop() in the other notebooks" in said, said
    finally:
        other.close()
    kernel.run("stop(); run(Greeter)")
    kernel.until(lambda: "2 of 2 points" in verdict(kernel, "setup-2"), 20)
