"""A robot crosses a world in the physics, without ROS: scan, map or place, path and pursuit of course_kit.

`python -m tests.crossing` drives through many worlds and prints how it went.
"""

from __future__ import annotations

import math
import sys
import time
from collections import deque
from dataclasses import dataclass

import numpy as np

from course_kit.robots.navigation.grid_map import GridMap
from course_kit.robots.navigation.journey import Journey
from course_kit.robots.navigation.localization import ParticleFilter
from course_kit.robots.navigation.places import Floats, Place, after, between, hits, inverse, moved, wrapped
from course_kit.robots.navigation.planning import CostMap, PlanError, plan
from course_kit.robots.navigation.pursuit import Limits
from course_kit.robots.navigation.scan_matching import Slam
from course_kit.robots.robot import shape
from course_kit.robots.robot.drive import Odometry, wheel_rates
from course_kit.robots.robot.physics import Physics
from course_kit.robots.robot.world import World
from course_kit.robots.robot.worlds import world

LASER: Place = (shape.LASER[0], shape.LASER[1], 0.0)
ANGLES = np.arange(shape.RAYS, dtype=np.float64) * (2 * math.pi / shape.RAYS)
NOISE = 0.01  # metres of standard deviation
TICK, TICKS_A_SCAN = 0.1, 2
RADIUS = shape.RADIUS + 0.04  # metres from walls for which paths are planned
LIMITS = Limits(radius=shape.RADIUS)
REMEMBERED = 25  # scans, as the planner does
PATIENCE = 600.0  # simulated seconds


@dataclass
class Crossing:
    """How it went; metres, radians, simulated seconds."""

    reached: bool
    why: str
    seconds: float
    away: float  # from the goal, in truth
    bumps: int  # ticks in which it touched something
    place_error: float  # the largest on the way
    heading_error: float
    odometry_error: float  # at the end, of the wheels alone
    paths: int
    map: GridMap


class Driven:
    """One robot in the physics and what it knows of itself."""

    def __init__(self, where: World, seed: int) -> None:
        self.physics = Physics(where, [where.start], seed=seed)
        self.odometry = Odometry(angles=self.physics.wheels(0)[0].tolist())
        self.random = np.random.default_rng(seed)
        self.bumps = 0

    def drive(self, linear: float, angular: float) -> None:
        """One tick."""
        self.physics.drive(0, *wheel_rates(linear, angular))
        for _ in range(round(TICK / shape.STEP / 4)):
            self.physics.step(4)
            self.odometry.update(self.physics.wheels(0)[0].tolist(), 4 * shape.STEP)
            self.bumps += self.physics.touches(0) != ""

    def scan(self) -> Floats:
        """With noise, and nan where the laser sees nothing that is so near."""
        ranges = self.physics.scan(0) + self.random.normal(0, NOISE, shape.RAYS)
        ranges[ranges < shape.SHORTEST] = np.nan
        return ranges


def errors(place: Place, truth: Place) -> tuple[float, float]:
    """Metres and radians between two places."""
    return math.dist(place[:2], truth[:2]), abs(wrapped(place[2] - truth[2]))


def cross(where: World, goal: Place, seed: int = 0, known: GridMap | None = None) -> Crossing:
    """Drive from the start to a goal: on a map that is made on the way, or by a particle filter on a known one."""
    driven, journey = Driven(where, seed), Journey(goal, LIMITS)
    slam, particles = Slam(where.start), None
    if known is not None:
        particles = ParticleFilter(known, seed)
        particles.gather(where.start, 0.1, 0.1)
    worst: Floats = np.zeros(2)
    before: Place = driven.odometry.place
    in_map: Place = where.start  # of the frame odom
    count = 0
    points: Floats = np.zeros((0, 2))
    seen: deque[Floats] = deque(maxlen=REMEMBERED)
    while journey.end is None and driven.physics.time < PATIENCE:
        odometry = driven.odometry.place
        if count % TICKS_A_SCAN == 0:
            ranges = driven.scan()
            points = moved(hits(ANGLES, ranges), LASER)
            if particles is None:
                slam.update(after(odometry, LASER), ANGLES, ranges, shape.LONGEST)
                in_map = slam.odom
            else:
                particles.move(between(before, odometry))
                before = odometry
                particles.weigh(ANGLES, ranges, LASER)
                in_map = after(particles.place(), inverse(odometry))
            seen.append(moved(points, after(in_map, odometry)))
        count += 1
        place = after(in_map, odometry)
        worst = np.maximum(worst, errors(place, driven.physics.pose(0)))
        if count % 10 == 1:
            grid_map = known or slam.grid.map()
            cost_map = CostMap(grid_map.with_hits(np.vstack(seen)), RADIUS, into_unknown=known is None)
            journey.check(cost_map, place)
            if journey.wants_path(driven.physics.time):
                try:
                    journey.follow(plan(cost_map, place[:2], goal[:2]))
                except PlanError as refused:
                    journey.fail(refused.code, str(refused))
        driven.drive(*journey.tick(driven.physics.time, place, points))
    truth = driven.physics.pose(0)
    end = journey.end
    return Crossing(
        end is not None and end.arrived, end.why if end else "time is over", driven.physics.time,
        math.dist(truth[:2], goal[:2]), driven.bumps, float(worst[0]), float(worst[1]),
        errors(after(where.start, driven.odometry.place), truth)[0], journey.paths, known or slam.grid.map(),
    )  # fmt: skip


def true_map(where: World) -> GridMap:
    """What it looks like in truth."""
    cells, corner = where.occupancy()
    return GridMap(cells, 0.05, corner)


def rightness(made: GridMap, where: World) -> tuple[float, float]:
    """Shares of the cells that a map says something of that are right, within a cell; and of those that are walls."""
    truth = true_map(where)
    rows, columns = np.nonzero((made.cells >= 65) | ((made.cells >= 0) & (made.cells <= 25)))
    points = made.centres(rows, columns)
    said_wall = made.cells[rows, columns] >= 65
    to_wall = truth.wall_distances(points)
    right = np.where(said_wall, to_wall <= 0.0501, truth.at(points) < 65)
    return float(right.mean()), float(right[said_wall].mean())


def main() -> None:
    """Worlds by name and seed on the command line: `rooms 3 maze 7`; without, all of them."""
    words = sys.argv[1:]
    wanted = list(zip(words[::2], map(int, words[1::2]), strict=True)) or [
        (name, seed) for name in ("rooms", "maze", "office") for seed in range(21)
    ]
    for name, seed in wanted:
        where = world(name, seed or None)
        goal = (*max(where.goals, key=lambda one: math.dist(one, where.start[:2])), 0.0)
        for known in (None, true_map(where)):
            began = time.perf_counter()
            how = cross(where, goal, seed, known)
            right = rightness(how.map, where) if known is None else (1.0, 1.0)
            print(
                f"{name:7}{seed:3} {'known' if known else 'new':6}{how.reached!s:6}{how.seconds:6.0f} s  "
                f"{how.away:.3f} m away  bumps {how.bumps:3}  errors {how.place_error:.3f} m "
                f"{how.heading_error:.3f} rad  "
                f"odometry {how.odometry_error:.2f} m  paths {how.paths:3}  map {right[0]:.3f} {right[1]:.3f}  "
                f"{time.perf_counter() - began:5.1f} s of work  {how.why}",
                flush=True,
            )


if __name__ == "__main__":
    main()
