"""turtle_teleop_key: keys from a notebook and from a terminal, against a real simulator."""

from __future__ import annotations

import signal
import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
import pytest
from geometry_msgs.msg import Twist
from rclpy.action import ActionServer
from rclpy.executors import SingleThreadedExecutor
from rclpy.parameter import Parameter
from turtlesim.action import RotateAbsolute
from turtlesim.msg import Pose
from turtlesim.srv import Spawn

from course_kit.base.keyboard import first_key
from course_kit.robots.turtlesim.teleop import HEADINGS, KEYS, Teleop
from tests.terminal import Terminal
from tests.test_turtlesim_node import Ros, Spinning, ros
from tests.waiting import TIMEOUT, wait_until

__all__ = ["ros"]  # the fixture

ARROWS = {"up": (2.0, 0.0), "down": (-2.0, 0.0), "left": (0.0, 2.0), "right": (0.0, -2.0)}


@pytest.fixture
def teleop(ros: Ros) -> Iterator[Teleop]:
    node = Teleop(context=ros.context)
    spinning = Spinning(SingleThreadedExecutor(context=ros.context), node)
    yield node
    spinning.stop()
    assert spinning.errors == []


def listen(ros: Ros, topic: str = "turtle1/cmd_vel") -> list[Twist]:
    twists: list[Twist] = []
    ros.observer.create_subscription(Twist, topic, twists.append, 10)
    wait_until(lambda: ros.observer.count_publishers(topic), f"publisher of {topic}")
    return twists


def matched(teleop: Teleop) -> Teleop:
    assert teleop._rotate is not None
    wait_until(teleop._rotate.server_is_ready, "action server")
    return teleop


def values(twist: Twist) -> tuple[float, float]:
    others = (twist.linear.y, twist.linear.z, twist.angular.x, twist.angular.y)
    assert others == (0.0, 0.0, 0.0, 0.0)
    return twist.linear.x, twist.angular.z


def test_names(ros: Ros, teleop: Teleop) -> None:
    assert teleop.get_fully_qualified_name() == "/teleop_turtle"
    assert [teleop.get_parameter(name).value for name in ("scale_linear", "scale_angular")] == [2.0, 2.0]
    assert teleop.count_publishers("/turtle1/cmd_vel") == 1


def test_each_arrow_publishes_one_twist(ros: Ros, teleop: Teleop) -> None:
    twists = listen(ros)
    wait_until(lambda: teleop.count_subscribers("turtle1/cmd_vel"), "match")
    for key in ARROWS:
        assert teleop.press(key)
    wait_until(lambda: len(twists) >= 4, "four twists")
    assert [values(twist) for twist in twists] == list(ARROWS.values())


def test_another_turtle_can_be_driven(ros: Ros) -> None:
    node = Teleop("anna", namespace="robot1", context=ros.context)
    spinning = Spinning(SingleThreadedExecutor(context=ros.context), node)
    ros.run(namespace="robot1")
    ros.call(Spawn, "robot1/spawn", x=5.0, y=5.0, name="anna")
    poses = ros.listen(Pose, "robot1/anna/pose")
    matched(node).press("e")
    wait_until(lambda: poses[-1].theta > 0.2, "turn")
    wait_until(lambda: node.count_subscribers("/robot1/anna/cmd_vel"), "match")
    node.press("up")
    wait_until(lambda: poses[-1].linear_velocity == 2.0, "movement")
    spinning.stop()


def test_scales_are_parameters(ros: Ros, teleop: Teleop) -> None:
    twists = listen(ros)
    wait_until(lambda: teleop.count_subscribers("turtle1/cmd_vel"), "match")
    teleop.set_parameters([Parameter("scale_linear", value=0.5), Parameter("scale_angular", value=3.0)])
    teleop.press("down")
    teleop.press("left")
    wait_until(lambda: len(twists) == 2, "two twists")
    assert [values(twist) for twist in twists] == [(-0.5, 0.0), (0.0, 3.0)]


def test_letters_ask_for_headings(ros: Ros, teleop: Teleop) -> None:
    asked: list[float] = []

    def execute(goal: Any) -> RotateAbsolute.Result:
        asked.append(goal.request.theta)
        goal.succeed()
        return RotateAbsolute.Result()

    server = ActionServer(ros.observer, RotateAbsolute, "turtle1/rotate_absolute", execute)
    matched(teleop)
    for key in "gtredcvb":
        assert teleop.press(key)
    wait_until(lambda: len(asked) == 8, "eight goals")
    expected = [0.0, 0.7854, 1.5708, 2.3562, 3.1416, -2.3562, -1.5708, -0.7854]
    assert asked == [float(np.float32(theta)) for theta in expected]
    ros.request(server.destroy)  # in the executor that waits for it


def test_letter_turns_the_turtle_and_f_cancels(ros: Ros, teleop: Teleop) -> None:
    ros.run()
    poses = ros.listen(Pose, "turtle1/pose")
    matched(teleop).press("e")
    wait_until(lambda: poses[-1].theta > 0.2, "turn")
    teleop.press("f")
    ros.wait_for_log("info", "Rotation goal canceled")
    wait_until(lambda: poses[-1].angular_velocity == 0.0, "stop")
    assert poses[-1].theta < 2.3


def test_f_right_after_a_letter_cancels_too(ros: Ros, teleop: Teleop) -> None:
    ros.run()
    matched(teleop).press("d")
    teleop.press("f")
    ros.wait_for_log("info", "Rotation goal canceled")


def test_f_without_a_turn_does_nothing(ros: Ros, teleop: Teleop) -> None:
    assert teleop.press("f")


def test_letter_without_a_simulator_says_what_to_do(ros: Ros, teleop: Teleop) -> None:
    teleop.press("g")
    text = "No action server /turtle1/rotate_absolute: start a turtlesim there, then press again"
    ros.wait_for_log("warn", text, node="teleop_turtle")


def test_q_is_the_last_key(ros: Ros, teleop: Teleop) -> None:
    assert not teleop.press("q")
    assert all(teleop.press(key) for key in KEYS if key != "q")


def test_unknown_key_is_refused(ros: Ros, teleop: Teleop) -> None:
    with pytest.raises(ValueError, match="no key 'x'; its keys are up, down, left, right, g, t, r"):
        teleop.press("x")


def test_keys_pressed_in_many_threads_all_arrive(ros: Ros, teleop: Teleop) -> None:
    twists = listen(ros)
    wait_until(lambda: teleop.count_subscribers("turtle1/cmd_vel"), "match")
    threads = [threading.Thread(target=teleop.press, args=("up",)) for _ in range(5)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(TIMEOUT)
    wait_until(lambda: len(twists) == 5, "five twists")


# The terminal


@pytest.mark.parametrize(
    ("typed", "key", "rest"),
    [
        (b"\x1b[A", "up", b""),
        (b"\x1b[Bq", "down", b"q"),
        (b"\x1bOC", "right", b""),  # as some terminals send them
        (b"\x1b[D\x1b[D", "left", b"\x1b[D"),
        (b"gt", "g", b"t"),
        (b"\x1b[1;5A", None, b""),  # Ctrl and up
        (b"\x1b[3~f", None, b"f"),  # the delete key
        (b"\xc3\xb6", None, b"\xb6"),
    ],
)
def test_first_key(typed: bytes, key: str | None, rest: bytes) -> None:
    assert first_key(typed) == (key, rest)


@contextmanager
def teleop_in_a_terminal(*arguments: str) -> Iterator[Terminal]:
    """The program, once it has told how it is used. That its window is closed, it is to see by itself."""
    command = [sys.executable, "-m", "course_kit.robots.turtlesim.teleop", *arguments]
    with Terminal(command, is_controlling=False) as terminal:
        terminal.wait_for("quit\n\n")  # all of it: what still prints when its window is closed fails
        yield terminal


def test_terminal_keys_drive_and_q_quits(ros: Ros) -> None:
    with teleop_in_a_terminal("--ros-args", "-r", "__ns:=/robot1", "-p", "scale_linear:=1.5") as terminal:
        twists = listen(ros, "/robot1/turtle1/cmd_vel")

        def publishers() -> list[tuple[str, str]]:
            infos = ros.observer.get_publishers_info_by_topic("/robot1/turtle1/cmd_vel")
            return [(info.node_name, info.node_namespace) for info in infos]

        wait_until(lambda: publishers() == [("teleop_turtle", "/robot1")], "teleop_turtle in the graph")
        assert terminal.settings() != terminal.before

        def driven() -> bool:
            terminal.press(b"\x1b[A")
            return bool(twists)

        wait_until(driven, "twist")  # the first keys may come before both sides are matched
        terminal.press(b"xy\x1b[B\x1bOD")
        wait_until(lambda: len(twists) >= 3 and values(twists[-1]) == (0.0, 2.0), "twists")
        assert values(twists[0]) == (1.5, 0.0)
        assert values(twists[-2]) == (-1.5, 0.0)
        terminal.press(b"q")
        assert terminal.end() == 0, terminal.text
        assert terminal.settings() == terminal.before
        assert "Traceback" not in terminal.text


def test_terminal_letter_turns_the_turtle(ros: Ros) -> None:
    ros.run()
    poses = ros.listen(Pose, "turtle1/pose")
    with teleop_in_a_terminal() as terminal:
        name = "turtle1/rotate_absolute/_action/feedback"
        wait_until(lambda: ros.observer.count_subscribers(name), "action client")

        def turns() -> bool:
            terminal.press(b"t")
            return poses[-1].theta > 0.1

        wait_until(turns, "turn")
        wait_until(lambda: abs(poses[-1].theta - HEADINGS["t"]) < 0.03, "heading")
        terminal.press(b"q")
        assert terminal.end() == 0, terminal.text


@pytest.mark.parametrize("end", [signal.SIGINT, signal.SIGTERM])
def test_terminal_is_restored_after_a_signal(end: signal.Signals) -> None:
    with teleop_in_a_terminal() as terminal:
        assert terminal.settings() != terminal.before
        terminal.process.send_signal(end)
        assert terminal.end() == 0, terminal.text
        assert terminal.settings() == terminal.before
        assert "Traceback" not in terminal.text


def test_program_ends_when_its_terminal_is_closed() -> None:
    with teleop_in_a_terminal() as terminal:
        terminal.close()
        assert terminal.end() == 0, terminal.text


def test_program_without_a_terminal_says_so() -> None:
    command = [sys.executable, "-m", "course_kit.robots.turtlesim.teleop"]
    done = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=60)
    assert done.returncode == 1
    assert done.stderr.splitlines() == [
        "teleop_turtle reads keys, but its standard input is not a terminal: start it in one"
    ]
