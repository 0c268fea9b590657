"""Tab in a shell: what argcomplete's shell function gets from the `ros2` program."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from course_kit.base.polling import wait_until
from course_kit.cli.ros2.interface.field_completion import Fillable, continuations
from course_kit.cli.ros2.interface.interface import definition, types
from course_kit.cli.ros2.messages.values import parse, populate
from course_kit.cli.ros2.messages.yaml_text import to_dict
from course_kit.ros.interface_types import message_class
from course_kit.ros.spinning import context
from course_kit.ros.subscriptions import observer_node
from tests.ros2_command import COMMAND, program
from tests.terminal import Terminal


@pytest.fixture(scope="module", autouse=True)
def world(fresh_domain: None) -> Iterator[None]:
    with program("tests.ros2_transcripts.world"):
        yield


LAUNCH_FILE = """
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument

def generate_launch_description():
    return LaunchDescription([DeclareLaunchArgument("background_r"), DeclareLaunchArgument("speed")])
"""
SHELLS = {("bash", "--norc"): "bind 'set bell-style none'", ("zsh", "-f"): "autoload -U compinit; compinit -u -D"}
NO_FIELD = "structure_needs_at_least_one_member"  # of messages that are empty
TWIST = "ros2 topic pub /robot1/cmd_vel geometry_msgs/msg/Twist"


def completions(line: str, folder: Path, *python: str, log: Path = Path(os.devnull)) -> list[str]:
    answer = folder / "completions"
    variables = {
        "_ARGCOMPLETE": "1",
        "_ARGCOMPLETE_IFS": "\n",
        "_ARGCOMPLETE_STDOUT_FILENAME": str(answer),
        "COMP_LINE": line,
        "COMP_POINT": str(len(line)),
        "COMP_TYPE": "9",
    }
    words = [COMMAND[0], *python, *COMMAND[1:]]
    with log.open("w") as errors:
        subprocess.run(words, env=os.environ | variables, timeout=30, check=False, cwd=folder, stderr=errors)
    return [word.strip() for word in answer.read_text().splitlines()]


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ("ros2 serv", ["service"]),
        ("ros2 topic del", ["delay"]),
        ("ros2 topic info /ro", ["/robot1/cmd_vel", "/robot1/scan", "/rosout"]),
        ("ros2 topic list --show", ["--show-types"]),
        ("ros2 node info /rob", ["/robot1/lidar"]),
        ("ros2 service call /robot1/en", ["/robot1/enable"]),
        ("ros2 service call /robot1/enable std", ["std_srvs/srv/SetBool"]),
        ("ros2 action info /f", ["/fibonacci"]),
        ("ros2 param get /robot1/lidar be", ["beams"]),
        ("ros2 topic pub /robot1/cmd_vel geo", ["geometry_msgs/msg/Twist"]),
        ("ros2 interface show geometry_msgs/msg/TwistS", ["geometry_msgs/msg/TwistStamped"]),
        ("ros2 pkg prefix turt", ["turtlesim"]),
        ("ros2 run turtlesim turtlesim_n", ["turtlesim_node"]),
        (f"{TWIST} '{{li", ["{linear:", "{linear: {x: 0.0, y: 0.0, z: 0.0}"]),
        (f"{TWIST} '{{linear: {{", ["{linear: {x:", "{linear: {y:", "{linear: {z:"]),
        (
            f"{TWIST} '{{linear: {{x: 2.0}}, ang",
            ["{linear: {x: 2.0}, angular:", "{linear: {x: 2.0}, angular: {x: 0.0, y: 0.0, z: 0.0}"],
        ),
        ("ros2 service call /robot1/enable std_srvs/srv/SetBool '{data: t", ["{data: true", "{data: true}"]),
        ("ros2 service call /add_two_ints example_interfaces/srv/AddTwoInts ", ["'{a: 0, b: 0}'"]),
        ("ros2 action send_goal /fibonacci example_interfaces/action/Fibonacci '{", ["{order:", "{order: 0"]),
        ("ros2 launch own.launch.py spe", ["speed:="]),
        ("ros2 launch own.launch.py speed:=1 back", ["background_r:="]),
    ],
)
def test_tab_offers_what_fits(line, expected, tmp_path):
    (tmp_path / "own.launch.py").write_text(LAUNCH_FILE)
    assert completions(line, tmp_path) == expected


def test_tab_leaves_the_graph_and_does_not_vanish_from_it(tmp_path):
    try:
        node = observer_node.node()

        def participants() -> int:
            return len(node.get_publishers_info_by_topic("ros_discovery_info", no_mangle=True))

        def leaves() -> bool:
            assert wait_until(lambda: participants() == 2, 10)  # the world's, and this one
            assert completions("ros2 topic info /ro", tmp_path)
            return wait_until(lambda: participants() == 2, 2)

        # One goodbye may be lost on its way.
        assert any(leaves() for _ in range(3)), "others wait for it, for as long as its lease lasts"
    finally:
        context.stop()


def test_fields_are_offered_without_ros_and_without_numpy(tmp_path):
    log = tmp_path / "imports"
    assert completions(f"{TWIST} '{{li", tmp_path, "-X", "importtime", log=log)
    loaded = {line.rsplit("|", 1)[1].strip() for line in log.read_text().splitlines() if "|" in line}
    assert "course_kit.cli.ros2.interface.field_completion" in loaded
    assert not loaded & {"rclpy", "numpy", "geometry_msgs"}


@pytest.mark.parametrize(("shell", "setup"), SHELLS.items())
def test_a_message_is_typed_with_tab_in_a_real_shell(shell, setup):
    if shutil.which(shell[0]) is None:
        pytest.skip(f"{shell[0]} is not installed")
    variables = {"TERM": "dumb", "PATH": os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])}
    with Terminal([*shell, "-i"], variables) as terminal:
        terminal.press(f'{setup}; eval "$(register-python-argcomplete ros2)"; echo re""ady\n'.encode())
        terminal.wait_for("ready\n")
        terminal.press(b"ros2 topic pub --once -w 0 /new geometry_msgs/msg/Twist '{li\t")
        terminal.wait_for("near: ")
        terminal.press(b"\tx\t2.5, z\t-1.0}}'\n")
        terminal.wait_for("geometry_msgs.msg.Vector3(x=2.5, y=0.0, z=-1.0)")


@pytest.mark.parametrize(
    ("type_name", "begun", "expected"),
    [
        ("geometry_msgs/msg/Twist", "{linear:", ["{linear: {x: ", "{linear: {y: ", "{linear: {z: "]),
        (
            "geometry_msgs/msg/Twist",
            "{linear: {x: 1.0, y: 2",
            ["{linear: {x: 1.0, y: 2, z: ", "{linear: {x: 1.0, y: 2}"],
        ),
        ("geometry_msgs/msg/Twist", "li", ["linear: ", "linear: {x: 0.0, y: 0.0, z: 0.0}"]),
        ("std_msgs/msg/String", "{data: hello", ["{data: hello}"]),
        ("std_msgs/msg/String", "data: ", ['data: ""']),
        ("geometry_msgs/msg/PointStamped", "{header: a", ["{header: auto"]),
        ("std_msgs/msg/Header", "{stamp: n", ["{stamp: now"]),
        ("sensor_msgs/msg/LaserScan", "{ranges: [1, ", ["{ranges: [1, 0.0", "{ranges: [1, 0.0, "]),
        ("sensor_msgs/msg/LaserScan", "{ranges: [1", ["{ranges: [1, ", "{ranges: [1]"]),
        (
            "trajectory_msgs/msg/JointTrajectory",
            "{points: [{vel",
            ["{points: [{velocities: ", "{points: [{velocities: []"],
        ),
        ("geometry_msgs/msg/Twist", "{linear: {x: 1.0}}", []),
        ("geometry_msgs/msg/Twist", "{linear: [", []),
        ("geometry_msgs/msg/Twist", "{nope: ", []),
        ("geometry_msgs/msg/Twist", "}", []),
        ("geometry_msgs/msg/Twist", "{linear: {x: 'a", []),
        ("geometry_msgs/msg/Twist", "- a", []),
    ],
)
def test_what_may_follow_in_yaml(type_name, begun, expected):
    assert continuations(Fillable(type_name, definition), begun) == expected


def test_the_fields_offered_are_what_a_new_message_holds():
    for type_name in types(["msg"]):
        new, filled = message_class(type_name)(), message_class(type_name)()
        offered = parse(Fillable(type_name, definition).prototype())
        assert list(offered) == [name for name in new.get_fields_and_field_types() if name != NO_FIELD]
        populate(filled, offered)
        assert to_dict(filled) == to_dict(new)


def test_the_shell_function_is_registered_in_a_bash():
    code = 'eval "$(register-python-argcomplete ros2)"; complete -p ros2'
    path = os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])
    out = subprocess.run(["bash", "-c", code], env=os.environ | {"PATH": path}, capture_output=True, text=True)
    assert "_python_argcomplete" in out.stdout
