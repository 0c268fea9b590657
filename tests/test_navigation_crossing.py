"""A robot finds itself on a map, and crosses worlds in the physics, step by step, without ROS."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from course_kit.robots.navigation.localization import ParticleFilter
from course_kit.robots.navigation.places import Place, after
from course_kit.robots.robot.world import Pillar
from course_kit.robots.robot.worlds import world
from tests.crossing import ANGLES, LASER, cross, errors, rightness, true_map
from tests.test_navigation_maps import ROOM, scan

METRES, RADIANS = 0.15, 0.1  # that a place may be wrong by, on the way


def driven(particles: ParticleFilter, start: Place, steps: int) -> Place:
    """Drive in a circle with a scan after each 0.1 m, odometry 3 % wrong; return the true place."""
    random, truth = np.random.default_rng(5), start
    for _ in range(steps):
        truth = after(truth, (0.1, 0.0, 0.25))
        particles.move((0.097, 0.0, 0.2575))
        particles.weigh(ANGLES, scan(ROOM, after(truth, LASER), random), LASER)
    return truth


def test_particles_around_a_guess_come_together_at_the_place() -> None:
    start = (-0.4, 0.3, 0.0)
    particles = ParticleFilter(true_map(ROOM), seed=1)
    particles.gather((-0.2, 0.1, 0.2), 0.3, 0.3)
    before = particles.spread()
    truth = driven(particles, start, 15)
    metres, radians = errors(particles.place(), truth)
    assert metres < 0.08
    assert radians < 0.06
    assert particles.is_together
    assert (particles.spread() < before / 2).all()
    assert len(particles.particles) < 1000
    assert particles.weights.sum() == pytest.approx(1.0)


def test_particles_on_the_whole_map_find_the_place() -> None:
    particles = ParticleFilter(true_map(ROOM), seed=2)
    assert not particles.is_together
    truth = driven(particles, (-0.4, 0.3, 0.0), 40)
    assert errors(particles.place(), truth)[0] < 0.1


def test_a_robot_that_was_carried_away_notices_it_and_finds_itself_again() -> None:
    particles = ParticleFilter(true_map(ROOM), seed=3)
    particles.gather((1.3, -1.0, 2.0), 0.1, 0.1)
    truth = driven(particles, (-0.4, 0.3, 0.0), 60)
    assert errors(particles.place(), truth)[0] < 0.1


def test_the_mean_of_headings_does_not_fail_where_they_begin_anew() -> None:
    particles = ParticleFilter(true_map(ROOM))
    particles.gather((0.0, 0.0, math.pi), 0.01, 0.1)
    assert abs(abs(particles.place()[2]) - math.pi) < 0.02
    assert particles.spread()[2] == pytest.approx(0.1, rel=0.1)


def test_a_step_moves_particles_along_their_own_headings_and_spreads_them() -> None:
    particles = ParticleFilter(true_map(ROOM), seed=4)
    particles.gather((0.0, 0.0, math.pi / 2), 1e-6, 1e-6)
    particles.move((0.5, 0.0, 0.3))
    assert errors(particles.place(), (0.0, 0.5, math.pi / 2 + 0.3)) == pytest.approx((0, 0), abs=0.01)
    assert 0.02 < particles.spread()[1] < 0.1


def test_the_same_seed_gives_the_same_places() -> None:
    places = []
    for _ in range(2):
        particles = ParticleFilter(true_map(ROOM), seed=6)
        driven(particles, (-0.4, 0.3, 0.0), 5)
        places.append(particles.place())
    assert places[0] == places[1]


# One world of each kind; `python -m tests.crossing` drives through all of twenty seeds.
@pytest.mark.parametrize(("name", "seed"), [("rooms", 7), ("maze", 8), ("office", 4)])
def test_a_robot_crosses_rooms_that_it_has_never_seen(name: str, seed: int) -> None:
    where = world(name, seed)
    goal = max(where.goals, key=lambda one: math.dist(one, where.start[:2]))
    how = cross(where, (*goal, 0.0), seed)
    assert (how.reached, how.bumps) == (True, 0), how.why
    assert how.place_error < METRES
    assert how.heading_error < RADIANS
    right, walls = rightness(how.map, where)
    assert right > 0.98
    assert walls > 0.95


def test_on_a_map_that_it_has_it_goes_back_without_making_another() -> None:
    where = world("office")
    how = cross(where, (*where.goals[0], 1.0), 1, true_map(where))
    assert (how.reached, how.bumps, how.paths) == (True, 0, 1), how.why
    assert how.place_error < METRES
    assert how.heading_error < RADIANS
    assert how.away < 0.05 + METRES


def test_what_stands_in_the_way_and_is_not_on_the_map_is_driven_around() -> None:
    where = world("empty")  # 6 by 5 m
    goal = (5.0, 4.0, 0.0)  # 5 m away, and the pillar 3.9 m: the laser sees it on the way only
    blocked = replace(where, pillars=(Pillar(4.1, 3.3, 0.2),), start=(1.0, 1.0, 0.0))
    how = cross(blocked, goal, 1, true_map(where))
    assert (how.reached, how.bumps) == (True, 0), how.why
    assert how.paths > 1
