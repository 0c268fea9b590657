"""A turtle simulator as it is seen through its topics: the same picture as its own, in whatever process it runs."""

from __future__ import annotations

import math
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
import pytest
from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
from rcl_interfaces.srv import SetParameters
from std_srvs.srv import Empty
from turtlesim.msg import Pose
from turtlesim.srv import Kill, SetPen, Spawn, TeleportAbsolute

from course_kit import run, stop
from course_kit.robots.turtlesim import picture
from course_kit.robots.turtlesim.node import TurtleSim
from course_kit.ros.subscriptions import clients, observer_node
from course_kit.views.live.turtle_topics import TurtleTopics
from tests.waiting import wait_until


@pytest.fixture
def sim() -> Iterator[TurtleSim]:
    node = run(TurtleSim)
    yield node
    stop()


@contextmanager
def looking(turtle: str = "turtle1", namespace: str = "") -> Iterator[TurtleTopics]:
    seen = TurtleTopics(turtle, namespace)
    try:
        yield seen
    finally:
        seen.close()


def call(service_type: Any, name: str, /, **request: Any) -> Any:
    return clients.call(service_type, name, service_type.Request(**request), 10.0, 10.0)


def names(seen: TurtleTopics) -> list[str]:
    """The turtles that are somewhere."""
    seen.look()
    seen.take()
    return sorted(name for name, turtle in seen.field.turtles.items() if turtle.pose)


def wait_for_picture(seen: TurtleTopics, sim: TurtleSim) -> None:
    """Until the picture that is seen is the simulator's own, to the last pixel."""

    def same() -> bool:
        names(seen)
        return picture.draw(seen.field.scene(), seen.field.background).tobytes() == sim.picture().tobytes()

    wait_until(same, "the same picture")


def colours(seen: TurtleTopics) -> int:
    """How many there are in the trails, with that of nobody's."""
    return len(np.unique(np.array(seen.field.scene().trails).reshape(-1, 4), axis=0))


def teleport(turtle: str, x: float, y: float) -> None:
    """Have the turtle there: the simulator does so at its next tick, and draws with the pen that it has then."""
    poses: list[Any] = []
    subscription = observer_node.subscribe(f"/{turtle}/pose", lambda *came: poses.append(came), Pose)
    call(TeleportAbsolute, f"/{turtle}/teleport_absolute", x=x, y=y, theta=1.0)
    before = len(poses)
    wait_until(lambda: len(poses) > before + 2)
    subscription.close()


def test_pens_teleports_clear_and_background_are_seen(sim: TurtleSim) -> None:
    with looking() as seen:
        wait_until(lambda: names(seen) == ["turtle1"])
        teleport("turtle1", 2.0, 3.0)
        call(SetPen, "/turtle1/set_pen", r=255, g=200, b=0, width=9)
        teleport("turtle1", 9.0, 4.0)
        call(SetPen, "/turtle1/set_pen", off=1)
        teleport("turtle1", 9.0, 9.0)
        call(SetPen, "/turtle1/set_pen", r=1, g=2, b=3, width=1)
        teleport("turtle1", 5.0, 8.0)
        wait_for_picture(seen, sim)
        assert colours(seen) == 4  # three pens, and where nobody drew

        value = ParameterValue(type=ParameterType.PARAMETER_INTEGER, integer_value=17)
        call(SetParameters, "/turtlesim/set_parameters", parameters=[Parameter(name="background_g", value=value)])
        wait_until(lambda: names(seen) and seen.field.background == (69, 17, 255))
        call(Empty, "/clear")
        wait_for_picture(seen, sim)
        assert colours(seen) == 1
        teleport("turtle1", 1.0, 1.0)  # from where it stood
        wait_for_picture(seen, sim)
        assert colours(seen) == 2


def test_turtles_come_and_go_and_begin_anew(sim: TurtleSim) -> None:
    with looking() as seen:
        for name in ("bob", "alice"):
            call(Spawn, "/spawn", x=2.0, y=2.0, name=name)
        wait_until(lambda: names(seen) == ["alice", "bob", "turtle1"])
        wait_for_picture(seen, sim)
        call(Kill, "/kill", name="bob")
        wait_until(lambda: names(seen) == ["alice", "turtle1"])
        call(Spawn, "/spawn", x=8.0, y=2.0, name="bob")
        wait_until(lambda: names(seen) == ["alice", "bob", "turtle1"])
        wait_for_picture(seen, sim)
        assert colours(seen) == 1  # no line from where the first bob was
        teleport("turtle1", 1.0, 1.0)
        call(Empty, "/reset")
        wait_until(lambda: names(seen) == ["turtle1"])
        wait_for_picture(seen, sim)


def test_who_looks_later_sees_what_was_drawn_before(sim: TurtleSim) -> None:
    call(SetPen, "/turtle1/set_pen", r=255, g=200, b=0, width=5)
    teleport("turtle1", 2.0, 3.0)
    value = ParameterValue(type=ParameterType.PARAMETER_INTEGER, integer_value=17)
    call(SetParameters, "/turtlesim/set_parameters", parameters=[Parameter(name="background_r", value=value)])
    with looking() as seen:
        wait_for_picture(seen, sim)
        assert seen.field.background == (17, 86, 255)


def test_a_simulator_in_another_process_and_its_end_are_seen() -> None:
    with looking() as seen:
        assert names(seen) == []
        with subprocess.Popen(
            [sys.executable, "-m", "course_kit.robots.turtlesim"], stdout=subprocess.DEVNULL
        ) as process:
            wait_until(lambda: names(seen) == ["turtle1"])
            call(Spawn, "/spawn", x=2.0, y=2.0, name="bob")
            wait_until(lambda: names(seen) == ["bob", "turtle1"])
            process.terminate()
        wait_until(lambda: names(seen) == [])


def test_simulators_of_two_namespaces_are_kept_apart(sim: TurtleSim) -> None:
    run(TurtleSim, namespace="/robot2")
    with looking() as seen, looking("turtle1", "/robot2") as other:
        call(Spawn, "/robot2/spawn", x=2.0, y=2.0, name="bob")
        wait_until(lambda: names(other) == ["bob", "turtle1"])
        assert names(seen) == ["turtle1"]


def test_a_turtle_that_is_nowhere_is_not_drawn(sim: TurtleSim) -> None:
    with looking() as seen:
        wait_until(lambda: names(seen) == ["turtle1"])
        seen.field.move("turtle1", math.nan, 1.0, 0.0)
        assert seen.field.scene().figures == []
        assert picture.in_words(seen.field.scene()) == "The turtles' field: no turtle; nothing is drawn."
        wait_for_picture(seen, sim)


@pytest.fixture
def silent() -> Iterator[TurtleSim]:
    """A simulator that says of its pens what the original says: nothing."""
    yield run(TurtleSim, cli_args=["--ros-args", "-r", "_drawing:=_not_asked_for"])
    stop()


def test_of_a_simulator_that_tells_no_pens_the_colours_under_the_turtles_do(silent: TurtleSim) -> None:
    with looking() as seen:
        wait_until(lambda: names(seen) == ["turtle1"])
        teleport("turtle1", 2.0, 3.0)
        wait_for_picture(seen, silent)
        call(SetPen, "/turtle1/set_pen", r=255, g=200, b=0, width=3)
        teleport("turtle1", 9.0, 4.0)
        wait_for_picture(seen, silent)
        call(SetPen, "/turtle1/set_pen", off=1)
        teleport("turtle1", 9.0, 9.0)
        wait_for_picture(seen, silent)
        call(SetPen, "/turtle1/set_pen", r=1, g=2, b=3, width=3)
        teleport("turtle1", 5.0, 8.0)
        wait_for_picture(seen, silent)
        assert colours(seen) == 4
        call(Spawn, "/spawn", x=3.0, y=9.0, name="bob")
        wait_until(lambda: names(seen) == ["bob", "turtle1"])
        call(Empty, "/clear")
        wait_for_picture(seen, silent)
        assert colours(seen) == 1
        call(Kill, "/kill", name="bob")
        wait_until(lambda: names(seen) == ["turtle1"])
        teleport("turtle1", 1.0, 1.0)
        call(Kill, "/kill", name="turtle1")  # the original has a new publisher after every reset
        call(Empty, "/reset")
        wait_for_picture(seen, silent)
        assert colours(seen) == 1
        teleport("turtle1", 1.0, 9.0)
        wait_for_picture(seen, silent)
        assert colours(seen) == 2
