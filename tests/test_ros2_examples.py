"""The help of each verb of `ros2` ends with an example, and each example does what it says."""

from __future__ import annotations

import os
import shlex
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from example_interfaces.srv import AddTwoInts
from rcl_interfaces.msg import ParameterDescriptor
from rclpy.lifecycle import LifecycleNode
from rclpy.node import Node
from rclpy.qos import QoSProfile
from rclpy.service_introspection import ServiceIntrospectionState

from course_kit.cli.ros2.command import COMMANDS
from course_kit.cli.ros2.examples import EXAMPLES
from course_kit.lab.background.running import running
from course_kit.robots.turtlesim.laser import Laser
from course_kit.robots.turtlesim.node import TurtleSim
from tests.terminal import CTRL_C, Terminal
from tests.test_ros2_help import parser_of, parsers_below

pytestmark = pytest.mark.by_turns("many programs, the later ones on what the earlier have left")

# What those that go on write, until Ctrl-C.
GOING_ON = {
    "bag record": "Subscribed to topic '/turtle1/pose'",
    "launch": "[turtlesim_node-2]",
    "run": "[INFO] [",
    "service echo": "RESPONSE_SENT",
    "topic bw": "/s from ",
    "topic delay": "average delay: ",
    "topic hz": "average rate: ",
    "topic pub": "publishing #2: ",
}
MAKING = {"param dump": "turtlesim.yaml", "pkg create": "my_package/my_package/my_node.py", "bag record": "drive"}


class MyNode(Node):
    def __init__(self) -> None:
        super().__init__("my_node")
        self.declare_parameter("my_parameter", 1, ParameterDescriptor(dynamic_typing=True))


class Adder(Node):
    """Reports its calls, and calls itself."""

    def __init__(self) -> None:
        super().__init__("adder")
        service = self.create_service(AddTwoInts, "add_two_ints", self.add)
        service.configure_introspection(self.get_clock(), QoSProfile(depth=10), ServiceIntrospectionState.CONTENTS)
        self.adds = self.create_client(AddTwoInts, "add_two_ints")
        self.create_timer(0.2, lambda: self.adds.call_async(AddTwoInts.Request(a=1, b=2)))

    def add(self, request: Any, response: Any) -> Any:
        response.sum = request.a + request.b
        return response


class Talker(LifecycleNode):
    def __init__(self) -> None:
        super().__init__("lc_talker")


@pytest.fixture(scope="module", autouse=True)
def world(fresh_domain: None) -> Iterator[None]:
    with running(TurtleSim, Laser, MyNode, Adder, Talker):
        yield


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where the examples run, one after the other."""
    return tmp_path_factory.mktemp("examples")


def verbs() -> list[str]:
    """All verbs, as 'topic hz' and 'run'."""
    named = [(command, *parsers_below(parser_of(command))) for command in COMMANDS]
    return ["doctor", "wtf", *(f"{command} {verb}".strip() for command, *below in named for verb in below or [""])]


def verb_of(example: str) -> str:
    return max((verb for verb in verbs() if f"{example} ".startswith(f"{verb} ")), key=len)


@pytest.mark.parametrize("verb", verbs())
def test_the_help_of_each_verb_ends_with_an_example(verb):
    last = parser_of(*verb.split()).format_help().splitlines()[-1]
    assert last.startswith(f"Example: ros2 {verb.replace('wtf', 'doctor')}")
    assert last.removeprefix("Example: ros2 ") in EXAMPLES


@pytest.mark.parametrize("example", EXAMPLES)
def test_each_example_works(example, folder):
    verb = verb_of(example)
    path = os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])
    line = f"cd {shlex.quote(str(folder))} && exec ros2 {example}"
    with Terminal(["bash", "-c", line], {"PATH": path, "TERM": "dumb"}) as terminal:
        if verb in GOING_ON:
            terminal.wait_for(GOING_ON[verb])
            terminal.press(CTRL_C)
        status = terminal.end()
    assert status in ((0, 2, 130) if verb in GOING_ON else (0,)), terminal.text
    failed = [line for line in terminal.text.splitlines() if "failed" in line and "read-only" not in line]
    assert not failed
    assert terminal.text.strip() or (folder / MAKING[verb]).exists()
    assert verb not in MAKING or (folder / MAKING[verb]).exists()
