"""The check of workspace-5: a package that drives turtles in squares."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from typing import Any

import yaml
from turtlesim.msg import Pose

from course_kit.exercises.checker import squares
from course_kit.exercises.checker.assertions import a_turtle, chance, expect, pause, wait
from course_kit.exercises.checker.checks import check_of
from course_kit.exercises.checker.examination import current
from course_kit.exercises.checker.topic_assertions import hear_the_turtle, listen
from course_kit.exercises.checker.workspace_assertions import (
    expect_executable,
    expect_installed,
    expect_nodes,
    expect_package,
    get_parameters,
    set_parameter,
    share,
    start,
)
from course_kit.robots.turtlesim import paths
from course_kit.ros.observing.received_messages import ReceivedMessages
from course_kit.ros.subscriptions import topics
from course_kit.setup.colcon import regular_files

LAP_TIMEOUT = 36.0
SLOWEST_TURN = 0.95  # rad/s that a turn reaches
TO_TAKE_EFFECT = 1.2  # seconds from a parameter to poses that follow it, on a busy machine too
METRES = 0.2  # that a turtle of the launch drives, at least
ROOMS = ("one", "two")
NO_REASON = "Callback returned an invalid type"  # what rclpy says where a callback returns no result


@check_of("workspace-5")
def patrol() -> None:
    """One turtle is driven in squares as the parameters say; two are by a launch, each with a file of its own."""
    expect_package("patrol", "ament_python")
    expect_executable("patrol", "patrol")
    (side, speed), (new_side, new_speed) = _drawn()
    a_turtle()
    driven = hear_the_turtle()
    node = start("ros2", "run", "patrol", "patrol", "--ros-args", "-p", f"side:={side}", "-p", f"speed:={speed}")
    expect_nodes(node, "/patrol")
    lap = _lap_of(driven, lambda lap: _is_driven(lap, side, speed) and _turns_fast(lap))
    expect(
        "it drives a square as `side` and `speed` say, with turns at 1 rad/s or more",
        _is_driven(lap, side, speed) and _turns_fast(lap),
        f"Started with side:={side} and speed:={speed}: {squares.described(lap)}. Straight for `side` metres at "
        f"`speed`, then a turn by 90° at 1 rad/s or more, again and again. `plot_pose` shows the path.",
    )
    changes = [("side", new_side), ("speed", new_speed)]
    chance().shuffle(changes)
    changed = [set_parameter("/patrol", name, value) for name, value in changes]
    _lap(driven, 15.0, 0.3 * math.tau)  # the side on which it is may still be one of before
    lap = _lap_of(driven, lambda lap: _is_driven(lap, new_side, new_speed))
    expect(
        "side and speed can be changed while it drives",
        all(taken for taken, _ in changed) and _is_driven(lap, new_side, new_speed),
        f"After side was set to {new_side} and speed to {new_speed}: {squares.described(lap)}. Declare both with a "
        f"default that is a float, and read them where they are used, not in __init__.",
    )
    _check_limits(driven, new_speed)
    node.stop(2.0)
    current().test_domain.tidy()
    _check_launch()


def _drawn() -> tuple[tuple[float, float], tuple[float, float]]:
    """Side and speed, those of a small square and those of a large one, whichever comes first."""
    small = round(chance().uniform(0.8, 1.2), 2), round(chance().uniform(0.8, 1.2), 2)
    large = round(chance().uniform(1.8, 2.3), 2), round(chance().uniform(1.7, 2.2), 2)
    return (small, large) if chance().random() < 0.5 else (large, small)


def _check_limits(driven: ReceivedMessages, speed: float) -> None:
    """A speed of 0 or less is refused and has no effect, a small one is taken."""
    below = round(-speed * chance().choice((chance().uniform(0.2, 0.7), chance().uniform(1.4, 2.0))), 2)  # not as fast
    refused = {value: set_parameter("/patrol", "speed", value) for value in chance().sample([0.0, below], 2)}
    kept = get_parameters("/patrol", "speed")[0]
    pause(TO_TAKE_EFFECT)
    before = len(driven)
    drives_on = wait(lambda: abs(paths.top_speed(driven.messages[before:]) - speed) < 0.15 * speed, 6.0)
    small = round(chance().uniform(0.02, 0.09), 2)
    taken, why = set_parameter("/patrol", "speed", small)
    told = [f"{value:g} was {word}" for value, answered in refused.items() if (word := _unlike_a_refusal(*answered))]
    told += [f"then it is {kept}"] if kept != speed else [] if drives_on else [f"then it does not drive {speed} m/s"]
    told += [] if taken else [f"{small} was not taken: {why}"]
    expect(
        "a speed of 0 or less is refused, with a reason; a small one is not",
        not told,
        f"After `ros2 param set /patrol speed` with {' and '.join(map(str, refused))}, and then {small}: "
        f"{', '.join(told)}. A callback for `add_on_set_parameters_callback` returns "
        f"SetParametersResult(successful=False, reason=…), and keeps nothing of what it refuses.",
    )


def _unlike_a_refusal(taken: bool | None, why: str) -> str:
    """What became of a value that was to be refused with a reason; nothing if it was."""
    if taken is None:
        return f"not answered ({why})"
    if taken:
        return "taken"
    return "refused without a reason" if why.strip() in ("", NO_REASON) else ""


def _check_launch() -> None:
    expect_installed("patrol", "launch/patrol.launch.py")
    launch = start("ros2", "launch", "patrol", "patrol.launch.py")
    expect_nodes(launch, *[f"/{room}/{name}" for room in ROOMS for name in ("turtlesim", "patrol")])
    poses = {room: listen(f"/{room}/turtle1/pose", Pose) for room in ROOMS}

    def metres() -> list[float]:
        return [paths.length(_of_turtlesim(room, heard)) for room, heard in poses.items()]

    wait(lambda: min(metres()) > METRES, 10.0, "both turtles", 0.1)
    expect(
        "the launch drives both turtles",
        min(metres()) > METRES,
        f"In ten seconds they drove {metres()[0]:.1f} m and {metres()[1]:.1f} m. Names of topics without a slash "
        f"at the beginning follow the namespace: `%ros2 topic info /one/turtle1/cmd_vel` shows who is there.",
    )
    actual = {room: get_parameters(f"/{room}/patrol", "side", "speed") for room in ROOMS}
    stated = {room: _in_file(room) for room in ROOMS}
    follow = all(value in stated[room][place] for room in ROOMS for place, value in enumerate(actual[room]))
    expect(
        "each has the values of its YAML file, which differ",
        follow and actual["one"] != actual["two"],
        f"The nodes have [side, speed] {actual['one']} and {actual['two']}, config/one.yaml and config/two.yaml say "
        f"{stated['one']} and {stated['two']}, and they should differ. A file counts for the nodes that its first "
        f"line names: /**, or the whole name with the namespace; and it must be installed.",
    )


def _of_turtlesim(room: str, heard: ReceivedMessages) -> list[Any]:
    """The poses that the simulator of a room has sent."""
    ends = current().test_domain.publishers(heard.topic)
    own = {bytes(end.endpoint_gid) for end in ends if topics.node_name(end) == f"/{room}/turtlesim"}
    return [pose for _, pose in heard.of(own)]


def _in_file(room: str) -> list[list[Any]]:
    """The sides and the speeds that the installed YAML file of a namespace has, for whichever nodes."""
    try:
        nodes = _leaves(yaml.safe_load(regular_files.text_of(share("patrol") / "config" / f"{room}.yaml") or ""))
    except yaml.YAMLError:
        nodes = []
    parameters = [node["ros__parameters"] for node in nodes if isinstance(node["ros__parameters"], dict)]
    return [[each[name] for each in parameters if name in each] for name in ("side", "speed")]


def _leaves(nodes: Any, depth: int = 5) -> list[dict[str, Any]]:
    """The nodes of a parameter file, below however many namespaces."""
    if not isinstance(nodes, dict) or depth == 0:
        return []
    if "ros__parameters" in nodes:
        return [nodes]
    return [leaf for below in nodes.values() for leaf in _leaves(below, depth - 1)]


def _is_driven(lap: list[Any], side: float, speed: float) -> bool:
    return squares.is_square(lap, side) and abs(paths.top_speed(lap) - speed) < 0.15 * speed


def _turns_fast(lap: list[Any]) -> bool:
    turns = squares.turns(lap)
    return bool(turns) and min(turns) >= SLOWEST_TURN


def _lap(driven: ReceivedMessages, timeout: float, angle: float = squares.LAP) -> list[Any]:
    """The poses from now on until the turtle has turned by an angle, or the time is over."""
    before = len(driven)

    def turned() -> float:
        headings = paths.headings(driven.messages[before:])
        return max(map(abs, headings), default=0.0)

    wait(lambda: turned() >= angle, timeout, "a lap of the turtle", 0.1)
    return driven.messages[before:]


def _lap_of(driven: ReceivedMessages, is_right: Callable[[list[Any]], bool]) -> list[Any]:
    """The next lap; another one if it is not right: a busy machine drives badly now and then."""
    for _ in range(2):
        began = time.monotonic()
        lap = _lap(driven, LAP_TIMEOUT)
        if is_right(lap) or time.monotonic() - began >= LAP_TIMEOUT:
            break
    return lap
