"""The worlds of robot-9: who plans once, drives straight on or knows a way by heart does not get to the goal."""

from __future__ import annotations

from random import Random

import numpy as np
import pytest

from course_kit.exercises.robot import exam_worlds
from course_kit.exercises.robot.exam_worlds import FARTHEST, SHORTEST, Planner, Point, draw
from course_kit.exercises.robot.robot_9_exam import KINDS, Crossing
from course_kit.robots.navigation.grid import Grid
from course_kit.robots.navigation.grid_map import GridMap
from course_kit.robots.navigation.places import after, between, moved
from course_kit.robots.navigation.planning import START_OCCUPIED, CostMap, PlanError, plan
from course_kit.robots.robot.shape import LASER, LONGEST, RADIUS, RAYS
from course_kit.robots.robot.world import World
from course_kit.robots.robot.worlds import world
from tests.crossing import cross

pytestmark = [pytest.mark.cpu_bound, pytest.mark.by_turns("a drive through a world for each", of="cases")]


@pytest.mark.parametrize("kind", KINDS)
def test_no_mistake_leads_to_the_goal(kind: str) -> None:
    task = draw(kind, Random(5))
    assert task.world == world(kind, task.world.seed)  # run(Robot, world=…, seed=…) repeats it
    assert task.goal in task.world.goals
    assert SHORTEST < task.way < FARTHEST
    straight = np.linspace(task.world.start[:2], task.goal, 500)
    assert task.world.clearances(*straight.T).min() <= 0
    seen = between(task.world.start, (*task.goal, 0.0))[:2]
    for known in map(world, KINDS):
        for goal in known.goals:
            assert np.hypot(*np.subtract(seen, between(known.start, (*goal, 0.0))[:2])) >= 0.5


def seen_from_the_start(where: World) -> GridMap:
    """The first map of a robot, in its own frame; not the draw's, with which a wrong frame would be wrong in both."""
    grid, angles = Grid(), np.radians(np.arange(RAYS))
    x, y, heading = after(where.start, (LASER[0], LASER[1], 0.0))
    grid.add((LASER[0], LASER[1], 0.0), angles, where.distances(x, y, angles + heading), LONGEST)
    return grid.map()


# Drawn without a look at the way round, these took the robot 90 to 128 s, 0.7 to 0.9 of what is allowed.
@pytest.mark.parametrize(("kind", "chance"), [("rooms", 71078), ("rooms", 72066), ("rooms", 71003), ("maze", 71106)])
def test_who_plans_anew_comes_there_in_time(kind: str, chance: int) -> None:
    task = draw(kind, Random(chance))
    how = cross(task.world, (*task.goal, 0.0), seed=1)
    assert how.reached and not how.bumps, how.why
    assert how.seconds < 0.7 * Crossing(task, "", 0.0, 0.0, 0, True, None).allowed


# In each, a draw that asked one planner only, and took a wall's very end for a wall, had one that got there by luck.
@pytest.mark.parametrize(("kind", "chance"), [("office", 7), ("office", 9), ("rooms", 8), ("maze", 8)])
def test_a_plan_made_at_the_start_leads_into_a_wall_also_with_the_margin_of_the_planner(kind: str, chance: int) -> None:
    task = draw(kind, Random(chance))
    costs = CostMap(seen_from_the_start(task.world), RADIUS + 0.04, into_unknown=True)
    first = plan(costs, (0.0, 0.0), between(task.world.start, (*task.goal, 0.0))[:2])
    assert task.world.clearances(*moved(first, task.world.start).T).min() < 0


def test_a_world_in_which_a_planner_gets_stuck_is_not_drawn(monkeypatch: pytest.MonkeyPatch) -> None:
    """Hundreds of draws do not meet one, so the first task gets it here."""
    refused: list[tuple[World, Point]] = []
    found_way = exam_worlds._found_way

    def stuck_at_first(where: World, goal: Point, planner: Planner, enough: float) -> float:
        if not refused:
            refused.append((where, goal))
            raise PlanError(START_OCCUPIED, "the start (1.32, -0.69) is in a wall")
        return found_way(where, goal, planner, enough)

    monkeypatch.setattr(exam_worlds, "_found_way", stuck_at_first)
    task = draw("rooms", Random(8))
    assert refused and refused[0] != (task.world, task.goal)
