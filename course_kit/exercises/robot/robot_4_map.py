"""The check of robot-4: a map from scans."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import numpy.typing as npt
from builtin_interfaces.msg import Time
from nav_msgs.msg import OccupancyGrid
from rclpy.qos import DurabilityPolicy
from sensor_msgs.msg import LaserScan
from tf2_msgs.msg import TFMessage

from course_kit.exercises.checker.assertions import answer, chance, expect, require, wait
from course_kit.exercises.checker.checks import check_of
from course_kit.exercises.checker.examination import current
from course_kit.exercises.checker.late_scans import REMAPPED, LateScans
from course_kit.exercises.checker.robot_fixtures import PACED, Pace, a_robot, a_way, hear_tf, place_in
from course_kit.exercises.checker.topic_assertions import expect_topic, listen, publisher
from course_kit.robots.navigation.places import Place, after, inverse
from course_kit.robots.robot.world import World
from course_kit.robots.robot.worlds import world

CELL = 0.05  # m
AHEAD_OF_TIME = 0.2  # s beyond the time at which it is told for which map → odom counts
# Simulated seconds a second: whoever adds a scan for long takes fewer transforms, and where 100 of them wait, further
# ones are lost; tf2 then guesses between the others, and walls bend.
FACTOR = 2.0
OFF = (1.4, 2.4)  # m, from to: where the flat begins in map, in x and in y
WAY = 9.0  # m that the robot drives
UPDATE = 2.0  # simulated s from map to map, at most
BUSY = 2.0  # times that, for maps that are told late or lost


@check_of("robot-4")
def map_maker() -> None:
    """It makes a map of a flat never seen, with places from tf2, and keeps it for whoever comes later."""
    # scipy takes its time to be loaded.
    from course_kit.exercises.checker.judged_maps import FLOOR_SEEN, RIGHT, TRUE_WALLS, WALLS_SEEN, cause, judge
    from course_kit.robots.navigation.messages import map_of

    flat = world(chance().choice(("rooms", "office")), chance().randrange(1000))
    robot = a_robot(_off_the_origin(flat), factor=FACTOR, patience=PACED, remap=REMAPPED)
    told = Corrections(robot)
    told.tell()
    answer(use_sim_time=True)
    expect_topic("/map", OccupancyGrid)
    transforms, maps = hear_tf(), listen("/map", OccupancyGrid)
    reach = round(chance().uniform(1.8, 2.4), 2)
    scans = LateScans(robot, 0.05, 0.15, lambda scan: _see_no_further(scan, reach))
    begun = robot.simulation.time

    def go_on() -> None:
        told.tell()
        scans.pass_on()

    _drive_round(robot, go_on, Pace(robot, maps, UPDATE + 0.5))
    until = robot.simulation.time + UPDATE + 0.5

    def is_last() -> bool:
        go_on()
        return bool(robot.simulation.time > until)

    wait(is_last, 20.0, "the last map")
    seconds = robot.simulation.time - begun
    buffer = transforms.buffer()
    reference = _reference(scans.sent, buffer)
    _expect_form(maps.messages)
    qos = current().test_domain.publishers("/map")[0].qos_profile.durability
    expect(
        "it keeps the map for who comes later, and publishes it every two seconds",
        qos == DurabilityPolicy.TRANSIENT_LOCAL and len(maps) >= seconds / UPDATE / BUSY,
        f"{len(maps)} maps came in {seconds:.0f} s of simulated time, and the publisher is {qos.name.lower()}: "
        "QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL), and a timer.",
    )
    last, true = map_of(maps.last), robot.world
    judged = judge(last, true, reference)
    why = ""
    if not judged.is_good:
        why = cause(last, true, reference, told.told, _reference(scans.sent, buffer, hits_at_the_end=True))
    expect(
        "97 % of what it is sure of is right, and so are its walls",
        judged.right >= RIGHT and judged.true_walls >= TRUE_WALLS,
        f"{100 * judged.right:.0f} % of its cells are right, and {100 * judged.true_walls:.0f} % of its walls. {why}",
    )
    expect(
        "the walls and the floor that the laser has seen are there",
        judged.floor >= FLOOR_SEEN and judged.walls >= WALLS_SEEN,
        f"It has {100 * judged.floor:.0f} % of the floor and {100 * judged.walls:.0f} % of the walls. {why}",
    )


class Corrections:
    """Tells tf map → odom, so that the robot is where it truly is: as a node that finds it on the map does."""

    def __init__(self, robot: Any) -> None:
        self.robot = robot
        self.told: list[Place] = []  # where odom was in map
        self._out = publisher("/tf", TFMessage, 100)
        self._told = -math.inf

    def tell(self) -> None:
        """Once in 0.1 s of simulated time."""
        from course_kit.robots.navigation.messages import transform_of

        simulation, vehicle = self.robot.simulation, self.robot.vehicle
        if simulation.time - self._told < 0.1:
            return
        with simulation.still:
            time, place, odometry = simulation.time, simulation.true_place(vehicle.number), vehicle.odometry.place
        self._told = time
        self.told.append(after(place, inverse(odometry)))
        seconds, rest = divmod(round((time + AHEAD_OF_TIME) * 1e9), 1_000_000_000)
        link = transform_of(self.told[-1], "map", "odom", Time(sec=seconds, nanosec=rest))
        self._out.publish(TFMessage(transforms=[link]))


def _off_the_origin(flat: World) -> World:
    """The same flat elsewhere in map: no map of it begins at (0, 0), not even with a metre of unknown cells around."""
    x, y = (round(chance().uniform(*OFF), 2) for _ in range(2))
    return replace(
        flat,
        walls=tuple(replace(one, x=one.x + x, y=one.y + y) for one in flat.walls),
        pillars=tuple(replace(one, x=one.x + x, y=one.y + y) for one in flat.pillars),
        start=(flat.start[0] + x, flat.start[1] + y, flat.start[2]),
        goals=tuple((goal[0] + x, goal[1] + y) for goal in flat.goals),
    )


def _drive_round(robot: Any, go_on: Callable[[], None], pace: Pace) -> None:
    """Drive towards a goal of the world, WAY metres at most, and look around there."""
    from course_kit.robots.navigation.pursuit import Limits, Pursuit

    simulation, vehicle = robot.simulation, robot.vehicle
    goal = chance().choice(robot.world.goals)
    points = np.array(a_way(robot.world, robot.world.start[:2], goal))
    driven = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])
    pursuit = Pursuit(points[driven <= WAY], Limits())

    def is_there() -> bool:
        go_on()
        place = simulation.true_place(vehicle.number)
        pace.command(*pursuit.command(place, math.inf, math.inf))
        return pursuit.remaining(place) < 0.08

    wait(is_there, 60.0, "the robot to drive")
    until = simulation.time + 4.0

    def has_turned() -> bool:
        go_on()
        pace.command(0.0, 1.0)
        return bool(simulation.time > until)

    wait(has_turned, 20.0, "the robot to turn")
    vehicle.command(0.0, 0.0, simulation.time)


def _see_no_further(scan: LaserScan, reach: float) -> None:
    """Make it that of a laser that sees only so many metres."""
    scan.range_max = reach
    scan.ranges = [distance if distance <= reach or math.isnan(distance) else math.inf for distance in scan.ranges]


def _reference(scans: list[LaserScan], buffer: Any, hits_at_the_end: bool = False) -> Any:
    """The map that the scans give, each from where it was made; or as if each beam without a hit had one at its end."""
    from course_kit.robots.navigation.grid import Grid
    from course_kit.robots.navigation.messages import rays_of

    grid = Grid(CELL)
    for scan in scans:
        place = place_in(buffer, "map", scan.header.frame_id, scan.header.stamp)
        if place is not None:
            angles, ranges = rays_of(scan)
            grid.add(place, angles, np.minimum(ranges, scan.range_max) if hits_at_the_end else ranges, scan.range_max)
    return grid.map()


def _expect_form(maps: list[OccupancyGrid]) -> None:
    require("maps come", maps, "None came on /map. A timer of the node publishes it, as soon as there is a scan in it.")
    last = maps[-1]
    info, values = last.info, np.array(last.data)
    turn = 2 * math.atan2(info.origin.orientation.z, info.origin.orientation.w or 1.0)
    wrong = [
        f"its frame is {last.header.frame_id!r}" if last.header.frame_id != "map" else "",
        f"its resolution is {info.resolution:g}" if abs(info.resolution - CELL) > 1e-4 else "",
        f"it has {len(values)} cells, but {info.width} · {info.height} by its info"
        if len(values) != info.width * info.height
        else "",
        "it has values that are neither -1 nor from 0 to 100" if len(values) and not _are_percent(values) else "",
        f"it is turned by {turn:.2f} rad" if abs(turn) > 1e-3 else "",
        "nothing in it is known" if not (values >= 0).any() else "",
    ]
    said = ", and ".join(filter(None, wrong))
    expect(
        "it is a map of 5 cm cells in the frame `map`",
        not said,
        f"{said[0:1].upper() + said[1:]}: `%ros2 topic echo /map --once --no-arr` shows header and info.",
        needed=True,
    )


def _are_percent(values: npt.NDArray[Any]) -> bool:
    return bool(((values >= -1) & (values <= 100)).all())
