"""The bar of what takes long: told by a comm, nothing of it in a notebook's outputs, nothing for what is quick."""

from __future__ import annotations

import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import nbformat
import pytest
from nbformat.v4 import new_code_cell, new_notebook, new_output

from course_kit.base import long_tasks
from course_kit.base.long_tasks import LongTask, long_task
from course_kit.setup.colcon.colcon_output import queued
from tests.kernel import Kernel, Message

pytestmark = pytest.mark.by_turns("many nodes and programs")

SET_UP = (
    "import time\nfrom course_kit import bags, record, run, wait_for\n"
    "from course_kit.base.long_tasks import long_task\n"
    "from rclpy.node import Node\nfrom std_msgs.msg import String\n"
    "class Talker(Node):\n    def __init__(self):\n        super().__init__('talker')\n"
    "        self.said = self.create_publisher(String, '/said', 10)\n"
    "        self.create_timer(0.1, lambda: self.said.publish(String(data='hello')))\ntalker = run(Talker)"
)


@pytest.fixture(scope="module")
def kernel(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Kernel]:
    one = Kernel(tmp_path_factory.mktemp("notebooks"))
    one.run(SET_UP)
    yield one
    one.close()


def comms(kernel: Kernel, cell: str) -> list[Message]:
    return [message for message in kernel.of(cell) if message["msg_type"].startswith("comm_")]


def bars(kernel: Kernel, code: str) -> list[dict[str, Any]]:
    """What the bar of a cell says, one after the other; [] if there is none. It is gone when the cell has ended."""
    cell = kernel.send(code)
    kernel.finish(cell, 60)
    told = comms(kernel, cell)
    kinds = [message["msg_type"] for message in told]
    assert kinds == ["comm_open", *["comm_msg"] * (len(kinds) - 2), "comm_close"][: len(kinds)]
    assert len(kinds) != 1
    return [message["content"]["data"] for message in told[:-1]]


def test_what_is_quick_has_no_bar(kernel: Kernel) -> None:
    assert bars(kernel, "wait_for(lambda: True); record('/said', count=2); time.sleep(2)") == []
    assert bars(kernel, "for _ in range(4): wait_for(lambda start=time.time(): time.time() > start + 0.5)") == []


def test_a_wait_says_for_what_and_how_long_at_most(kernel: Kernel) -> None:
    said = bars(kernel, "start = time.time()\nwait_for(lambda: time.time() > start + 3, 20, what='the third second')")
    assert [one["what"] for one in said] == ["waiting for the third second"] * len(said)
    assert re.fullmatch(r"waiting for the third second: [2-5] of at most 20 s", said[0]["text"])
    assert 0.05 < said[0]["fraction"] < said[-1]["fraction"] < 0.5


def test_a_wait_that_fails_or_is_interrupted_takes_its_bar_along(kernel: Kernel) -> None:
    assert bars(kernel, "wait_for(lambda: False, 2.5)")
    cell = kernel.send("wait_for(lambda: False, 30)")
    kernel.until(lambda: comms(kernel, cell))
    kernel.manager.interrupt_kernel()
    kernel.finish(cell)
    assert comms(kernel, cell)[-1]["msg_type"] == "comm_close"


def test_the_future_of_a_service_is_named(kernel: Kernel) -> None:
    code = (
        "from std_srvs.srv import Trigger\nclient = talker.create_client(Trigger, '/nobody')\n"
        "wait_for(client.call_async(Trigger.Request()), 2.5)"
    )
    assert bars(kernel, code)[0]["what"] == "waiting for the response of the service /nobody"


def test_the_result_of_a_goal_is_waited_for_with_its_feedback(kernel: Kernel) -> None:
    kernel.run(
        "from example_interfaces.action import Fibonacci\nfrom rclpy.action import ActionClient, ActionServer\n"
        "class Server(Node):\n    def __init__(self):\n        super().__init__('server')\n"
        "        self.server = ActionServer(self, Fibonacci, 'fibonacci', self.execute)\n"
        "    def execute(self, goal):\n        feedback = Fibonacci.Feedback()\n"
        "        for number in range(8):\n            time.sleep(0.5)\n            feedback.sequence.append(number)\n"
        "            goal.publish_feedback(feedback)\n        goal.succeed()\n        return Fibonacci.Result()\n"
        "server = run(Server)\nasker = run(Node, 'asker')\nclient = ActionClient(asker, Fibonacci, 'fibonacci')\n"
        "client.wait_for_server(20.0)\nhandle = wait_for(client.send_goal_async(Fibonacci.Goal(order=1)), 20)"
    )
    said = bars(kernel, "wait_for(handle.get_result_async(), 20)")
    assert {one["what"] for one in said} == {"waiting for the result of the action fibonacci"}
    assert any(f", {count} in sequence, " in one["text"].replace(": ", ", ") for one in said for count in range(3, 8))


def test_a_recording_says_how_much_of_it_is_there(kernel: Kernel) -> None:
    said = bars(kernel, "record('/said', seconds=3)")
    assert re.fullmatch(r"recording /said: [23] of 3 s", said[0]["text"])
    said = bars(kernel, "record('/said', count=30)")
    assert "of 30 messages" in said[0]["text"] and 0.3 < said[0]["fraction"] < said[-1]["fraction"] <= 1.0


def test_a_topic_that_nobody_publishes_is_named(kernel: Kernel) -> None:
    assert bars(kernel, "record('/nothing', timeout=2.5)")[0]["what"] == "waiting for a publisher of /nothing"


def test_a_bag_that_plays_says_where_it_is(kernel: Kernel) -> None:
    kernel.run("with bags.record('bag', '/said') as bag: wait_for(lambda: bag.message_count > 30, 30)")
    for code in ("bags.play('bag')", "%ros2 bag play bag"):
        said = bars(kernel, code)
        assert said[-1]["what"] == "playing bag" and " of 3 s" in said[-1]["text"]
        assert 0.3 < said[-1]["fraction"] <= 1.0


def test_a_command_with_a_duration_says_how_much_of_it_is_over(kernel: Kernel) -> None:
    said = bars(kernel, "%ros2 topic echo /said --duration 3")
    assert re.fullmatch(r"ros2 topic echo /said --duration 3: [23] of 3 s", said[0]["text"])


def test_a_check_says_how_long_it_takes_at_most(kernel: Kernel) -> None:
    code = "class Countdown(Node):\n    def __init__(self):\n        super().__init__('countdown')\n"
    code += "        time.sleep(4)  # and it counts nothing\nfrom course_kit import check\ncheck('topics-1')"
    said = bars(kernel, code)
    assert {one["what"] for one in said} == {"checking topics-1"}
    assert said[-1]["text"].endswith(" of at most 35 s") and said[-1]["fraction"] < 1


def test_of_tasks_within_tasks_the_one_whose_length_is_known_is_shown(kernel: Kernel) -> None:
    code = "with long_task('outer'), long_task('middle', 4, 'steps') as middle, long_task('inner', 9):\n"
    said = bars(
        kernel,
        code + "    middle.done = 1\n    time.sleep(2)\n    middle.done, middle.doing = 3, 'last'\n    time.sleep(1)",
    )
    assert re.fullmatch(r"middle: 1 of 4 steps, \d s", said[0]["text"])
    assert re.fullmatch(r"middle: last, 3 of 4 steps, \d s", said[-1]["text"])
    assert said[0]["fraction"] == 0.25


def test_a_wait_in_another_thread_is_no_cells(kernel: Kernel) -> None:
    code = "import threading\nother = threading.Thread(target=lambda: wait_for(lambda: False, 2.5))\nother.start()\n"
    assert bars(kernel, code + "time.sleep(2.5)") == []


@pytest.mark.timeout(240)
def test_a_build_says_how_many_packages_are_built(kernel: Kernel) -> None:
    kernel.run(
        "from course_kit import Workspace\nws = Workspace('ws')\n"
        "for name in ('first', 'second'):\n"
        "    folder = ws.src / name\n    folder.mkdir()\n"
        "    (folder / 'package.xml').write_text(f'<package format=\"3\"><name>{name}</name><version>0.0.0</version>'\n"
        "        '<description/><maintainer email=\"a@b.c\">a</maintainer><license>A</license>'\n"
        "        '<export><build_type>ament_python</build_type></export></package>')\n"
        "    (folder / 'setup.py').write_text('import time; time.sleep(1.5)\\nfrom setuptools import setup\\n'\n"
        '        f\'setup(name="{name}", version="0.0.0")\')\n'
    )
    said = bars(kernel, "ws.build('--executor', 'sequential')")
    texts = [one["text"] for one in said]
    assert {one["what"] for one in said} == {"colcon build"}
    assert any(" first, 0 of 2 packages" in text for text in texts), texts
    assert any(" second, 1 of 2 packages" in text for text in texts), texts
    assert {one["fraction"] for one in said} <= {None, 0.0, 0.5, 1.0}


def test_a_notebook_keeps_nothing_of_it_under_nbval(tmp_path: Path) -> None:
    """The stored output of a cell that takes long is compared, and the bar is no part of it."""
    source = (
        "import time\nfrom course_kit import wait_for\nstart = time.time()\nwait_for(lambda: time.time() > start + 3)"
    )
    cell = new_code_cell(
        source, execution_count=1, outputs=[new_output("execute_result", {"text/plain": "True"}, execution_count=1)]
    )
    notebook = new_notebook(cells=[cell])
    notebook.metadata["kernelspec"] = {"name": "python3", "display_name": "Python 3", "language": "python"}
    nbformat.write(notebook, tmp_path / "long.ipynb")
    command = [sys.executable, "-m", "pytest", "--nbval", "-q", "-p", "no:cacheprovider", "long.ipynb"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=100)
    assert done.returncode == 0, done.stdout


def test_without_a_listener_a_task_is_only_told_in_words() -> None:
    told: list[LongTask] = []
    long_tasks.listeners.add(told.append)
    try:
        with long_task("x" * 300, 8, at_most=True) as task:
            task.done = 2
            state = task.state()
    finally:
        long_tasks.listeners.remove(told.append)
    assert told == [task, task] and task.is_over
    assert state["fraction"] == 0.25
    assert str(state["text"]).endswith("…: 2 of at most 8 s") and len(str(state["what"])) == long_tasks.LONGEST


def test_the_packages_of_a_build_are_counted_in_its_events(tmp_path: Path) -> None:
    events = tmp_path / "events.log"
    assert queued(events) is None
    events.write_text("[0] (-) TimerEvent: {}\n[0.1] (a) JobQueued: {'identifier': 'a'}\n[0.1] (b) JobQueued: {}\n")
    assert queued(events) == 2
