"""Fixtures and assertions about a robot: one in the test domain, its true place, its tf, how it is driven.

Its time is simulated and stands nearly still for whoever is late, so what is judged are simulated seconds. MuJoCo and
scipy take their time to be loaded, so they are, with the first robot.
"""

from __future__ import annotations

import math
import time
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from rclpy.duration import Duration
from rclpy.parameter import Parameter
from rclpy.time import Time
from tf2_msgs.msg import TFMessage
from tf2_ros import Buffer, TransformException

from course_kit.exercises.checker.assertions import require, wait
from course_kit.exercises.checker.examination import current
from course_kit.exercises.checker.wait_for_discovery import meet
from course_kit.ros.observing.received_messages import ReceivedMessages
from course_kit.ros.spinning.nodes import WITHOUT_DESCRIPTIONS

if TYPE_CHECKING:
    from course_kit.robots.robot.node import Robot
    from course_kit.robots.robot.world import Place, World

FACTOR = 4.0  # simulated seconds a second
PATIENCE = 60.0  # s of real time that there is for an answer that drives and is late
REMEMBERED = Duration(seconds=3600)  # of simulated time
SPEED = 0.2  # m/s
WAITS = 12.0  # s of real time in all that a Pace waits for an answer
PACED = 1.0  # patience of a robot with a Pace: 0.25 simulated seconds a second, for a timer that missed its moment
ROBOT = "/robot"
MATCH_TIMEOUT = 5.0


def a_robot(
    world: str | World = "rooms",
    seed: int | None = None,
    start: Place | None = None,
    factor: float = FACTOR,
    patience: float = PATIENCE,
    remap: Mapping[str, str] | None = None,
    **parameters: Any,
) -> Robot:
    """Start a robot in the test domain, as `run(Robot, …)` would; its `simulation` knows true places and collisions.

    `remap`: other names for its topics. `parameters`: further ones of the node robot, such as `scan_noise=0.0`. It ends
    with the check.
    """
    from course_kit.robots.robot.node import Robot

    observer = current().test_domain
    settings = [Parameter(name, value=value) for name, value in {"patience": patience, **parameters}.items()]
    robot = Robot(
        world=world,
        seed=seed,
        start=start,
        factor=factor,
        context=observer.context,
        enable_rosout=False,
        cli_args=["--ros-args", *(word for old, new in (remap or {}).items() for word in ("-r", f"{old}:={new}"))],
        parameter_overrides=[*WITHOUT_DESCRIPTIONS, *settings],
    )
    observer.mine.add(ROBOT)
    observer.spin(robot)
    return robot


def wait_simulated(robot: Robot, seconds: float, timeout: float) -> bool:
    """Let so many simulated seconds go by, `timeout` real ones at most; whether they did."""
    until = robot.simulation.time + seconds
    return wait(lambda: robot.simulation.time >= until, timeout, "the simulation to go on")


class Pace:
    """Drives the robot, and has time go slowly while an answer is late: then its timers miss little.

    Late is an answer of which nothing was heard for `gap` simulated seconds. It is waited for WAITS s of real time in
    all, so that one that stays silent is judged, too.
    """

    def __init__(self, robot: Robot, heard: ReceivedMessages, gap: float) -> None:
        self._robot, self._heard, self._gap = robot, heard, gap
        self._count, self._came, self._left = -1, 0.0, WAITS
        self._looked = time.monotonic()

    def command(self, linear: float, angular: float) -> None:
        """Have it drive (m/s, rad/s); to be called again and again."""
        simulation, vehicle = self._robot.simulation, self._robot.vehicle
        now, looked = simulation.time, time.monotonic()
        if len(self._heard) != self._count:
            self._count, self._came = len(self._heard), now
        is_late = now - self._came > self._gap and self._left > 0
        if is_late:
            self._left -= min(looked - self._looked, 0.1)  # the checker itself may have had no turn for longer
        self._looked = looked
        # Time goes slowly for whoever's command is older than half the time for which it holds.
        vehicle.command(linear, angular, now - (0.6 * vehicle.timeout if is_late else 0.0))


def drive(
    robot: Robot, linear: float, angular: float, seconds: float, timeout: float, pace: Pace | None = None
) -> bool:
    """Have the checker drive it (m/s, rad/s) for so many simulated seconds, then stop; whether there was time for it.

    It goes past the topics: the answer hears no command, and none is late, but for a `pace` that waits for it.
    """
    simulation, vehicle = robot.simulation, robot.vehicle
    until = simulation.time + seconds

    def is_over() -> bool:
        if pace is not None:
            pace.command(linear, angular)
        else:
            vehicle.command(linear, angular, simulation.time)
        return simulation.time >= until

    is_done = wait(is_over, timeout, "the robot to drive")
    vehicle.command(0.0, 0.0, simulation.time)
    return is_done


def drive_along(robot: Robot, points: Sequence[tuple[float, float]], timeout: float, speed: float = SPEED) -> bool:
    """Have the checker drive it along a path in the map (m), by its true place; whether it got to the end."""
    import numpy as np

    from course_kit.robots.navigation.pursuit import Limits, Pursuit

    simulation, vehicle = robot.simulation, robot.vehicle
    pursuit = Pursuit(np.array(points, np.float64), Limits(speed=speed))

    def is_there() -> bool:
        place = simulation.true_place(vehicle.number)
        vehicle.command(*pursuit.command(place, math.inf, math.inf), simulation.time)
        return pursuit.remaining(place) < 0.08

    is_done = wait(is_there, timeout, "the robot to drive")
    vehicle.command(0.0, 0.0, simulation.time)
    return is_done


def a_way(world: World, start: tuple[float, float], goal: tuple[float, float]) -> list[tuple[float, float]]:
    """A path (m) from one place of a world to another on which a robot touches nothing."""
    from course_kit.robots.navigation.grid_map import GridMap
    from course_kit.robots.navigation.planning import CostMap, plan
    from course_kit.robots.robot.shape import RADIUS

    cells, origin = world.occupancy()
    points = plan(CostMap(GridMap(cells, 0.05, origin), RADIUS + 0.04), start, goal)
    return [(float(x), float(y)) for x, y in points]


def hear_robot(topic: str, message_type: Any) -> ReceivedMessages:
    """Hear what the robot of a_robot() says on a topic, and nobody else, until the check ends."""
    heard = current().test_domain.listen(topic, message_type, own=True)
    wait(lambda: len(heard), MATCH_TIMEOUT, f"the robot's {topic}")
    return heard


class Transforms:
    """What the answer and the checker's own nodes have told tf, from the moment on in which it was made."""

    def __init__(self) -> None:
        observer = current().test_domain

        def counts(publisher: bytes) -> bool:
            return observer.is_own(publisher) or observer.counts(publisher)

        self._moving, self._static = (ReceivedMessages(TFMessage, topic, counts) for topic in ("/tf", "/tf_static"))
        observer.hear(self._moving)
        observer.hear(self._static, kept=True)

    def buffer(self) -> Buffer:
        """A tf2 Buffer with all of it; it takes a millisecond for a simulated second, so it is made once a finding."""
        buffer = Buffer(REMEMBERED)
        for heard, put in ((self._static, buffer.set_transform_static), (self._moving, buffer.set_transform)):
            for message in heard.messages:
                for transform in message.transforms:
                    put(transform, "")
        return buffer

    def track(self, parent: str, child: str) -> list[tuple[float, Place]]:
        """The places (m, m, rad) of a frame in its parent as they were told, each with its time in s, by time."""
        from course_kit.robots.navigation.messages import place_of

        told = [one for message in self._moving.messages for one in message.transforms]
        links = [one for one in told if (one.header.frame_id, one.child_frame_id) == (parent, child)]
        return sorted((seconds_of(one.header.stamp), place_of(one.transform)) for one in links)

    def has(self, inside: str, frame: str) -> bool:
        """Return True if tf tells where a frame is in another."""
        return place_in(self.buffer(), inside, frame) is not None


def hear_tf() -> Transforms:
    """Hear what is told on /tf and /tf_static, until the check ends, and what was said there for good before.

    After answer(), whose nodes have found the checker's subscriptions when this returns.
    """
    heard = Transforms()
    meet(current().test_domain, "/tf", "/tf_static")
    return heard


def place_in(buffer: Buffer, inside: str, frame: str, stamp: Any = None) -> Place | None:
    """Where a frame is in another (m, m, rad) at a message's stamp, or as of late; None if the buffer does not know."""
    from course_kit.robots.navigation.messages import place_of

    try:
        found = buffer.lookup_transform(inside, frame, Time() if stamp is None else Time.from_msg(stamp))
    except TransformException:
        return None
    return place_of(found.transform)


def seconds_of(stamp: Any) -> float:
    """A stamp in seconds."""
    return float(stamp.sec + stamp.nanosec * 1e-9)


def expect_stamped(text: str, messages: Sequence[Any], robot: Robot) -> None:
    """The messages' stamps are of simulated time, neither zero nor that of this machine."""
    stamps = [seconds_of(one.header.stamp) for one in messages]
    hint = "No message came."
    if stamps:
        hint = (
            f"Its stamp is {stamps[-1]:.2f} s, and simulated time is {robot.simulation.time:.2f} s. Take over the "
            "stamp of the scan, or `self.get_clock().now().to_msg()` of the node, which is run with use_sim_time."
        )
    require(text, stamps and 0.0 < stamps[-1] <= robot.simulation.time + 1.0, hint)
