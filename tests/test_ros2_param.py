"""`ros2 param`: parameters that are dumped, loaded, described and deleted."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from threading import Event
from typing import Any

import pytest
import yaml
from rcl_interfaces.msg import FloatingPointRange, ParameterDescriptor
from rcl_interfaces.srv import GetParameters
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from rclpy.parameter import Parameter

from course_kit.lab.background.running import run, stop
from course_kit.ros.spinning import context
from course_kit.ros.subscriptions import observer_node
from tests.ros2_command import ros2
from tests.ros2_running import Running
from tests.waiting import wait_until

pytestmark = pytest.mark.usefixtures("fresh_domain")


class Robot(Node):
    """Has a parameter whose name is the beginning of another one's, and one that may be deleted."""

    def __init__(self) -> None:
        super().__init__("robot")
        limits = FloatingPointRange(from_value=0.1, to_value=0.9)
        self.declare_parameter("wheel", 4)
        self.declare_parameter("wheel.radius", 0.2, ParameterDescriptor(floating_point_range=[limits]))
        self.declare_parameter("arm.joints", ["shoulder", "elbow"])
        self.declare_parameter("spare", True, ParameterDescriptor(dynamic_typing=True))


class Forgetful(Node):
    """Leaves the first request without an answer, as a node does that has not found the client."""

    def __init__(self) -> None:
        super().__init__("forgetful", start_parameter_services=False)
        self.ends, self._asked = Event(), 0
        group = ReentrantCallbackGroup()
        self.create_service(GetParameters, "~/get_parameters", self._answer, callback_group=group)

    def _answer(self, request: Any, response: Any) -> Any:
        self._asked += 1
        if self._asked == 1:
            self.ends.wait(60)
        return GetParameters.Response(values=[Parameter("a", value=7).get_parameter_value()])


@pytest.fixture
def robot(fresh_domain: Any) -> Iterator[Node]:
    node = run(Robot)
    yield node
    stop(node)


def test_parameters_are_dumped_and_loaded(robot: Node, tmp_path: Path) -> None:
    dumped = ros2("param", "dump", "/robot")
    parameters = yaml.safe_load(dumped.out)["/robot"]["ros__parameters"]
    assert (parameters["wheel"], parameters["wheel.radius"]) == (4, 0.2)
    assert parameters["arm"] == {"joints": ["shoulder", "elbow"]}
    file = tmp_path / "robot.yaml"
    file.write_text(yaml.dump({"/robot": {"ros__parameters": {"wheel": 6, "wheel.radius": 0.4, "spare": 1}}}))
    loaded = ros2("param", "load", "/robot", str(file))
    assert loaded.out == "".join(f"Set parameter {name} successful\n" for name in ("spare", "wheel", "wheel.radius"))
    assert robot.get_parameter("wheel.radius").value == 0.4
    file.write_text(yaml.dump({"/robot": {"ros__parameters": {"wheel.radius": 2.0}}}))
    refused = ros2("param", "load", "/robot", str(file))
    assert (refused.out, refused.status) == ("", 0)
    assert refused.err.startswith("Set parameter wheel.radius failed: ")


def test_what_cannot_be_loaded_is_said_in_a_line(robot: Node, tmp_path: Path) -> None:
    file = tmp_path / "robot.yaml"
    for text, error in (
        (None, f"No such file or directory: '{file}'\n"),
        ("{a: 1", f"{file} is no YAML: while parsing"),
        ("{/other: {wheel: 1}}", "YAML file is not a valid ROS parameter file for node /other\n"),
        ("{/robot: {ros__parameters: {1: 2}}}", f"{file} is no parameter file: write '/robot: {{ros__parameters:"),
        ("{}", "Param file does not contain selected parameters\n"),
    ):
        if text is not None:
            file.write_text(text)
        outcome = ros2("param", "load", "/robot", str(file))
        assert (outcome.out, outcome.status, outcome.err.count("\n")) == ("", 1, 1)
        assert outcome.err.startswith(error)


def test_a_file_is_loaded_whichever_nodes_it_names(robot: Node, tmp_path: Path) -> None:
    """What the node's own name stands before counts most, what /** stands before least."""
    file, own, every = tmp_path / "some.yaml", {"wheel": 1}, {"wheel": 2, "wheel.radius": 0.5}
    other = {"wheel": 3, "arm": {"joints": ["wrist"]}}

    def load(*options: str, **groups: Any) -> tuple[str, str]:
        file.write_text(yaml.dump({name: {"ros__parameters": group} for name, group in groups.items()}))
        outcome = ros2("param", "load", "/robot", str(file), *options)
        assert not outcome.err or outcome.status == 1
        return outcome.out, outcome.err

    assert load(**{"/**": every})[0].count("successful\n") == 2
    assert (robot.get_parameter("wheel").value, robot.get_parameter("wheel.radius").value) == (2, 0.5)
    assert load(**{"/other": other})[0] == "Set parameter arm.joints successful\nSet parameter wheel successful\n"
    assert (robot.get_parameter("wheel").value, robot.get_parameter("arm.joints").value) == (3, ["wrist"])
    load(**{"/robot": own, "/other": other, "/**": every})
    assert robot.get_parameter("wheel").value == 1
    assert load("--no-use-wildcard", **{"/**": every}) == ("", "Param file does not contain selected parameters\n")
    assert load("--no-use-wildcard", **{"/**": {"wheel": 9}, "/robot": {"spare": False}})[0].count("\n") == 1
    assert robot.get_parameter("wheel").value == 1


@pytest.mark.parametrize(
    ("verb", "rest", "said"),
    [
        ("delete", "spare", "Deleted parameter successfully"),
        ("describe", "wheel", "Parameter name: wheel"),
        ("dump", "", "wheel: 4"),
        ("get", "wheel", "Integer value is: 4"),
        ("list", "", "  wheel"),
        ("load", "<file>", "Set parameter wheel successful"),
        ("set", "wheel 5", "Set parameter successful"),
    ],
)
def test_a_node_that_only_starts_is_waited_for(verb: str, rest: str, said: str, tmp_path: Path) -> None:
    file = tmp_path / "file.yaml"
    file.write_text("{/**: {ros__parameters: {wheel: 5}}}")
    words = ["param", verb, "/robot", *rest.replace("<file>", str(file)).split()]
    absent = ros2(*words, "--timeout", "0")
    assert (absent.out, absent.err, absent.status) == ("", "Node not found\n", 1)
    with Running(*words, "--timeout", "50") as waiting:
        wait_until(lambda: any(name.startswith("_ros2cli") for name in observer_node.node().get_node_names()))
        node = run(Robot)
        outcome = waiting.end()
        stop(node)
    assert (outcome.err, outcome.status) == ("", 0)
    assert said in outcome.out


def test_a_node_that_does_not_know_the_command_yet_is_met_first() -> None:
    context.start()  # an executor needs it
    node = run(Forgetful, executor=MultiThreadedExecutor(2))
    try:
        outcome = ros2("param", "get", "/forgetful", "a")
        assert (outcome.out, outcome.err, outcome.status) == ("Integer value is: 7\n", "", 0)
    finally:
        node.ends.set()
        stop(node)


def test_parameters_are_described_and_deleted(robot: Node) -> None:
    assert ros2("param", "describe", "/robot", "wheel.radius", "spare").out == (
        "Parameter name: wheel.radius\n  Type: double\n  Constraints:\n    Min value: 0.1\n    Max value: 0.9\n"
        "Parameter name: spare\n  Type: boolean\n  Constraints:\n"
    )
    assert ros2("param", "delete", "/robot", "spare").out == "Deleted parameter successfully\n"
    refused = ros2("param", "delete", "/robot", "wheel")
    assert (refused.out, refused.status) == ("", 0)
    assert refused.err.startswith("Deleting parameter failed: ")
    names = ros2("param", "list", "/robot", "--filter", "^w", "--param-type").out
    assert names == "  wheel (type: integer)\n  wheel.radius (type: double)\n"
    assert ros2("param", "list", "/robot", "--filter", "(").err.startswith("Invalid regular expression '(': ")
