"""The worlds of robot-9: who plans once, drives straight on or knows a way by heart does not get to the goal."""

from __future__ import annotations

from random import Random

import numpy as np
import pytest

from course_kit.exercises.robot_exam import KINDS
from course_kit.exercises.robot_exam_worlds import FARTHEST, SHORTEST, draw
from course_kit.exercises.robot_exam_worlds import _first_map as first_map
from course_kit.navigation import planning
from course_kit.navigation.places import between
from course_kit.robot.shape import RADIUS
from course_kit.robot.worlds import world


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


@pytest.mark.parametrize("chance", [5, 9])  # at 9 a plan that keeps the planner's margin would get there by luck
def test_a_plan_made_at_the_start_leads_into_a_wall_also_with_the_margin_of_the_planner(chance: int) -> None:
    task = draw("office", Random(chance))
    costs = planning.CostMap(first_map(task.world), RADIUS + 0.04, into_unknown=True)
    first = planning.plan(costs, task.world.start[:2], task.goal)
    assert task.world.clearances(*first.T).min() < 0
