"""Chapter 2's project: a package that drives turtles in squares, and how it is checked."""

from __future__ import annotations

import cmath
import math
import time
from collections.abc import Sequence
from typing import Any

import yaml
from turtlesim.msg import Pose

from course_kit.examining import paths
from course_kit.examining.examination import current
from course_kit.examining.exercise import exercise
from course_kit.examining.station import Heard
from course_kit.examining.vocabulary import a_turtle, expect, wait
from course_kit.examining.vocabulary_topics import hear_the_turtle, listen
from course_kit.examining.vocabulary_workspace import (
    expect_executable,
    expect_installed,
    expect_nodes,
    expect_package,
    get_parameters,
    set_parameter,
    share,
    start,
)

LAP_TIMEOUT = 30.0
LAP = 1.15 * math.tau  # radians that the turtle turns on a lap, and more than it may overshoot
ROOMS = ("one", "two")


@exercise("workspace-5", "A patrol", points=5, level="project", timeout=150, file="patrol/package.xml")
def patrol() -> None:
    """One turtle is driven in squares as the parameters say; two are by a launch, each with a file of its own."""
    expect_package("patrol", "ament_python")
    expect_executable("patrol", "patrol")
    a_turtle()
    driven = hear_the_turtle()
    node = start("ros2", "run", "patrol", "patrol", "--ros-args", "-p", "side:=1.0", "-p", "speed:=1.0")
    expect_nodes(node, "/patrol")
    lap = _lap_of(driven, 1.0)
    expect(
        "with side 1.0 and speed 1.0 it drives a square of 1 m with 1 m/s",
        _is_square(lap, 1.0) and abs(paths.top_speed(lap) - 1.0) < 0.15,
        f"{_described(lap)}: straight for `side` metres at `speed`, then a turn by "
        f"90°, again and again. `plot_pose` shows the path.",
    )
    changed = [set_parameter("/patrol", name, 2.0) for name in ("side", "speed")]
    _lap(driven, 15.0, 0.3 * math.tau)  # the side on which it is may still be a short one
    lap = _lap_of(driven, 2.0)
    expect(
        "side and speed can be changed while it drives",
        all(taken for taken, _ in changed) and _is_square(lap, 2.0) and abs(paths.top_speed(lap) - 2.0) < 0.3,
        f"After both were set to 2.0: {_described(lap)}. Declare both with "
        f"a default that is a float, and read them where they are used, not in __init__.",
    )
    refused = [set_parameter("/patrol", "speed", value) for value in (0.0, -1.0)]
    speed = get_parameters("/patrol", "speed")[0]
    expect(
        "a speed of 0 or less is refused, with a reason",
        all(not taken and why for taken, why in refused) and speed == 2.0,
        f"After `ros2 param set /patrol speed` with 0.0 and -1.0 it is {speed}: a callback for "
        f"`add_on_set_parameters_callback` that returns SetParametersResult(successful=False, reason=…).",
    )
    node.stop(2.0)
    current().stage.tidy()
    _check_launch()


def _check_launch() -> None:
    expect_installed("patrol", "launch/patrol.launch.py")
    launch = start("ros2", "launch", "patrol", "patrol.launch.py")
    expect_nodes(launch, *[f"/{room}/{name}" for room in ROOMS for name in ("turtlesim", "patrol")])
    poses = {room: listen(f"/{room}/turtle1/pose", Pose) for room in ROOMS}

    def metres() -> list[float]:
        return [paths.length(heard.messages) for heard in poses.values()]

    wait(lambda: min(metres()) > 0.5, 10.0, "both turtles", 0.1)
    expect(
        "the launch drives both turtles",
        min(metres()) > 0.5,
        f"In ten seconds they drove {metres()[0]:.1f} m and {metres()[1]:.1f} m. Names of topics without a slash "
        f"at the beginning follow the namespace: `%ros2 topic info /one/turtle1/cmd_vel` shows who is there.",
    )
    actual = {room: get_parameters(f"/{room}/patrol", "side", "speed") for room in ROOMS}
    wanted = {room: _from_file(room) for room in ROOMS}
    expect(
        "each has the values of its YAML file",
        all(wanted.values()) and actual == wanted and actual["one"] != actual["two"],
        f"The nodes have [side, speed] {actual['one']} and {actual['two']}, config/one.yaml and config/two.yaml say "
        f"{wanted['one']} and {wanted['two']}, and they should differ. A file counts for the nodes that its first "
        f"line names: /**, or the whole name with the namespace.",
    )


def _from_file(room: str) -> list[Any] | None:
    """Side and speed as the installed YAML file of a namespace has them, for whichever node."""
    path = share("patrol") / "config" / f"{room}.yaml"
    try:
        parameters = _leaves(yaml.safe_load(path.read_text()))[0]["ros__parameters"]
        return [parameters["side"], parameters["speed"]]
    except (OSError, yaml.YAMLError, KeyError, IndexError, TypeError):
        return None


def _leaves(nodes: Any) -> list[dict[str, Any]]:
    """The nodes of a parameter file, below however many namespaces."""
    if not isinstance(nodes, dict):
        return []
    if "ros__parameters" in nodes:
        return [nodes]
    return [leaf for below in nodes.values() for leaf in _leaves(below)]


def _lap(driven: Heard, timeout: float, turn: float = LAP) -> list[Any]:
    """The poses from now on until the turtle has turned by an angle, or the time is over."""
    before = len(driven)

    def turned() -> float:
        headings = paths.headings(driven.messages[before:])
        return max(map(abs, headings), default=0.0)

    wait(lambda: turned() >= turn, timeout, "a lap of the turtle", 0.1)
    return driven.messages[before:]


def _lap_of(driven: Heard, side: float) -> list[Any]:
    """The next lap; another one if it is no square of this side: a busy machine drives badly now and then."""
    for _ in range(2):
        began = time.monotonic()
        lap = _lap(driven, LAP_TIMEOUT)
        if _is_square(lap, side) or time.monotonic() - began >= LAP_TIMEOUT:
            break
    return lap


def _extent(poses: Sequence[Any]) -> tuple[float, float]:
    """Metres from side to side, along x and along y."""
    if not poses:
        return 0.0, 0.0
    xs, ys = [pose.x for pose in poses], [pose.y for pose in poses]
    return max(xs) - min(xs), max(ys) - min(ys)


def _is_square(poses: Sequence[Any], side: float) -> bool:
    """The turtle began along x: a square of this side is as wide and as high, and its way is four sides or more.

    Four times the heading is the same on all its sides; on those of a triangle it is not.
    """
    near = 0.15 * side + 0.15
    way = paths.length(poses)
    fourfold = [cmath.exp(4j * pose.theta) for pose in poses if pose.linear_velocity > 0.05]
    is_right = bool(fourfold) and abs(sum(fourfold)) / len(fourfold) > 0.7
    return is_right and all(abs(metres - side) < near for metres in _extent(poses)) and 3.4 * side < way < 5.8 * side


def _described(poses: Sequence[Any]) -> str:
    (wide, high), way, speed = _extent(poses), paths.length(poses), paths.top_speed(poses)
    return f"It drove {way:.1f} m, over {wide:.1f} m by {high:.1f} m, with up to {speed:.1f} m/s"
