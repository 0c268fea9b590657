"""How much faster than real time the robot's physics are, with a scan each 0.2 s; what one scan costs."""

from __future__ import annotations

import statistics
import time
from collections.abc import Iterator

from course_kit.robots.robot import shape
from course_kit.robots.robot.drive import wheel_rates
from course_kit.robots.robot.physics import Physics
from course_kit.robots.robot.worlds import NAMES, world
from tests.benchmark.table import Row, at_least

AIM = 20  # times real time
TURN = ((0.2, 0.0), (0.1, 1.0), (0.15, -0.8), (0.0, 2.0))  # m/s, rad/s: a second each
NOTE = (
    "physics: MuJoCo without ROS, one thread, the robots driven in a pattern of a second each, bumps included; a scan "
    f"of {shape.RAYS} rays of each robot every {shape.SCAN_PERIOD:g} simulated s. The median of three runs."
)


def rows(quick: bool) -> Iterator[Row]:
    """All rows of this section."""
    seconds = 5 if quick else 40
    for name in NAMES:
        for robots in (1, 2):
            found = statistics.median(_factor(name, robots, seconds) for _ in range(1 if quick else 3))
            yield at_least(f"world {name}, robots: {robots}", "times real time", found, AIM)
    one = world()
    physics = Physics(one, [one.start])
    began = time.perf_counter()
    for _ in range(500):
        physics.scan(0)
    yield Row("a scan in the world rooms", "ms", None, (time.perf_counter() - began) / 500 * 1000)


def _factor(name: str, robots: int, seconds: int) -> float:
    """Simulated seconds a second."""
    one = world(name)
    starts = [one.start, (*one.goals[0], 0.0)][:robots]
    physics = Physics(one, starts)
    between = round(shape.SCAN_PERIOD / shape.STEP)
    began = time.perf_counter()
    for second in range(seconds):
        for robot in range(robots):
            physics.drive(robot, *wheel_rates(*TURN[(second + robot) % len(TURN)]))
        for _ in range(round(1 / shape.SCAN_PERIOD)):
            physics.step(between)
            for robot in range(robots):
                physics.scan(robot)
    return seconds / (time.perf_counter() - began)
