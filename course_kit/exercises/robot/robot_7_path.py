"""The check of robot-7: a path on a map."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from builtin_interfaces.msg import Time
from nav_msgs.msg import OccupancyGrid
from nav_msgs.srv import GetPlan
from rclpy.duration import Duration

from course_kit.exercises.checker.assertions import answer, chance, expect, pause, require
from course_kit.exercises.checker.checks import check_of
from course_kit.exercises.checker.drawn_maps import DrawnMap, Point, draw
from course_kit.exercises.checker.service_assertions import Client, expect_service, no_answer
from course_kit.exercises.checker.topic_assertions import (
    expect_compatible_subscription,
    expect_subscription,
    publisher,
)
from course_kit.robots.navigation.grid_map import OCCUPIED, UNKNOWN, GridMap
from course_kit.robots.navigation.messages import LATCHED, map_message, points_of, stamped_pose
from course_kit.robots.navigation.places import Floats
from course_kit.robots.navigation.planning import length, shortest, spaced

RADIUS = 0.11  # metres from the middle of the robot to that of any blocked cell
CORNER = 0.02  # metres that a step from cell to cell may cut off
STEP = 0.1
AT_END = 0.08  # metres from the start and the goal: half the diagonal of a cell, and more
DETOUR = 1.15  # of the shortest way over cells
ANSWER = 10.0  # seconds, where the text says 5
RECEIVED = 5.0  # seconds until a map is there, on a busy machine
TAKEN = 0.5  # seconds for the callback, once a map is there


@dataclass
class Asked:
    """One request, on a map, and what came back; None: no answer."""

    drawn: DrawnMap
    goal: Point
    plan: Any

    @property
    def points(self) -> Floats:
        """The points of the plan, shape (n, 2)."""
        return np.zeros((0, 2)) if self.plan is None else points_of(self.plan)

    def clearance(self) -> tuple[float, Point]:
        """Metres to the nearest blocked cell along the path, and where that is."""
        grid_map = self.drawn.map
        rows, columns = np.nonzero((grid_map.cells >= OCCUPIED) | (grid_map.cells == UNKNOWN))
        blocked = grid_map.centres(rows, columns)
        line = spaced(self.points, 0.02)
        away = np.array([np.hypot(*(blocked - point).T).min() for point in line])
        away[~grid_map.inside(*grid_map.cells_of(line))] = 0.0
        x, y = line[int(away.argmin())]
        return float(away.min()), (float(x), float(y))

    def shortest(self) -> float:
        """Metres of the shortest way over cells."""
        costs = np.where(free(self.drawn.map), 1.0, np.inf)
        start, goal = (_cell(self.drawn.map, point) for point in (self.drawn.start, self.goal))
        way = shortest(costs, start, goal)
        return math.inf if way is None else length(self.drawn.map.centres(*np.array(way).T))


def free(grid_map: GridMap) -> Any:
    """In which cells the robot's middle may be, shape (height, width)."""
    blocked = np.where(grid_map.cells == UNKNOWN, 100, grid_map.cells)
    return GridMap(blocked, grid_map.resolution, grid_map.origin).to_wall >= RADIUS


@check_of("robot-7")
def path_finder() -> None:
    """It plans on maps that come on /map, answers with a path that keeps its distance, or with none."""
    answer()
    maps = publisher("/map", OccupancyGrid, LATCHED)
    expect_subscription("/map", OccupancyGrid)
    expect_compatible_subscription("/map", maps)
    asked, refused = [], []
    for drawn in _two_maps():
        maps.publish(map_message(drawn.map, "map", Time()))
        maps.wait_for_all_acked(Duration(seconds=RECEIVED))
        pause(TAKEN)
        client = expect_service("/get_plan", GetPlan)
        asked.append(_ask(client, drawn, drawn.goal))
        require("it answers", asked[0].plan is not None, no_answer("/get_plan", ANSWER))
        refused += [_ask(client, drawn, goal) for goal in (drawn.in_wall, drawn.shut_in, drawn.outside)]
        asked.append(_ask(client, drawn, drawn.goal))  # after refusals it goes on
    _expect_ends(asked)
    worst = min(asked, key=lambda one: one.clearance()[0])
    expect("it keeps its distance", worst.clearance()[0] > RADIUS - CORNER, _why_near(worst))
    ways = [(length(one.points) / one.shortest(), one) for one in asked]
    detour, longest = max(ways, key=lambda way: way[0])
    expect(
        "it is short",
        detour < DETOUR,
        f"It is {length(longest.points):.2f} m long, the shortest way over cells {longest.shortest():.2f} m. A step to "
        "one of eight neighbours costs its length, 1 or √2; what is looked at first is what has the least way so far "
        "*and* way left: `spent + left`. By the way left alone (greedy) it runs into the cup and stays with that.",
    )
    _expect_refusals(refused)


def _two_maps() -> tuple[DrawnMap, DrawnMap]:
    """Two maps, of which the first does not lead to the goal of the second: there it is blocked."""
    first = second = draw(chance())
    while UNKNOWN < first.map.at(np.array([second.goal]))[0] < OCCUPIED:
        second = draw(chance())
    return first, second


def _ask(client: Client, drawn: DrawnMap, goal: Point) -> Asked:
    start, end = (stamped_pose((*point, 0.0), "map", Time()) for point in (drawn.start, goal))
    response = client.ask(ANSWER, start=start, goal=end).response
    return Asked(drawn, goal, None if response is None else response.plan)


def _cell(grid_map: GridMap, point: Point) -> tuple[int, int]:
    rows, columns = grid_map.cells_of(np.array([point]))
    return int(rows[0]), int(columns[0])


def _expect_ends(asked: list[Asked]) -> None:
    """Each path is one in the frame map, from its start to its goal, without a gap."""
    faults = [_fault(one) for one in asked]
    hint = next(filter(None, faults), "")
    if hint and not faults[0]:
        hint = f"On the first map it was right, and then another came on /map: plan on the newest. {hint}"
    expect("a path in `map` from start to goal, no step above 0.1 m", not hint, hint, needed=True)


def _fault(one: Asked) -> str:
    """What is wrong with the ends and the steps of a path; nothing if all is right."""
    points, grid_map = one.points, one.drawn.map
    if one.plan is None:
        return no_answer("/get_plan", ANSWER)
    if len(points) < 2:
        return (
            f"There is a way from {_shown(one.drawn.start)} to {_shown(one.goal)}, the plan has {len(points)} poses. "
            "Blocked are cells of 65 and more, and -1; what is nearer than 0.11 m to one of them; nothing else."
        )
    if one.plan.header.frame_id != "map":
        return f"The frame_id in the plan's header is {one.plan.header.frame_id!r}: it is map, as that of the request."
    ends = points[0], points[-1]
    if max(math.dist(end, want) for end, want in zip(ends, (one.drawn.start, one.goal), strict=True)) > AT_END:
        origin, side = np.array(grid_map.origin), grid_map.resolution
        meant = {
            "those are cells: metres are (cell + 0.5) · resolution + origin": (points + 0.5) * side + origin,
            "the map's origin is missing: cell [0, 0] has its corner at info.origin.position": points + origin,
            "x and y are exchanged: a column is x, a row is y": points[:, ::-1],
            "it is the wrong way round: from goal to start": points[::-1],
            "rows and columns of cells are exchanged": (points - origin)[:, ::-1] + origin,
        }
        near = [why for why, path in meant.items() if math.dist(path[0], one.drawn.start) < 0.15]
        return (
            f"From {_shown(one.drawn.start)} to {_shown(one.goal)} was asked, and it leads from {_shown(ends[0])} to "
            f"{_shown(ends[1])}{f': {near[0]}' if near else ''}."
        )
    step = float(np.hypot(*np.diff(points, axis=0).T).max())
    if step > STEP + 1e-3:
        return f"Two of its poses are {step:.2f} m apart: who follows it would not know how to drive between them."
    return ""


def _why_near(one: Asked) -> str:
    away, point = one.clearance()
    value = int(one.drawn.map.at(np.array([point]))[0])
    hint = f"At {_shown(point)} it is {away:.2f} m from the middle of a blocked cell, nearer than 0.11 m"
    if value == UNKNOWN:
        return f"{hint}: in a cell of -1. That is less than 65, and unknown: who drives there may fall down the stairs."
    if value >= OCCUPIED:
        return f"{hint}: in a wall, of {value}. Cells from 65 on are walls, and `data[row * width + column]` is one."
    return (
        f"{hint}. The robot is no point: grow walls *and* unknown cells by its radius, in metres, before you plan, by "
        "`distance_transform_edt(~blocked) * resolution`, and keep to cells that are 0.11 m away or more."
    )


def _expect_refusals(refused: list[Asked]) -> None:
    """No path where there is none, and an answer all the same."""
    kinds = ["in a wall", "in a room without a door", "outside of the map"] * 2
    wrong = [(kind, one) for kind, one in zip(kinds, refused, strict=True) if one.plan is None or one.plan.poses]
    hint = ""
    if wrong:
        kind, one = wrong[0]
        hint = f"To a goal {kind}, {_shown(one.goal)}, "
        hint += (
            f"it answered a path of {len(one.plan.poses)} poses: an empty Path says that there is none."
            if one.plan is not None
            else "no answer came: the callback raises or never ends. An empty Path says that there is none."
        )
    expect("no path where there is none", not wrong, hint)


def _shown(point: Any) -> str:
    return f"({point[0]:.2f}, {point[1]:.2f})"
