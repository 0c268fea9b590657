"""A robot's simulation without ROS: its clock, its commands, its bumps, robots that come and go, who shares one."""

from __future__ import annotations

import math
import threading
import xml.etree.ElementTree as ElementTree
from collections.abc import Iterator

import numpy as np
import pytest

from course_kit.robots.robot import shape, sharing
from course_kit.robots.robot.description import urdf
from course_kit.robots.robot.picture import Cells, Seen, draw, scale_of
from course_kit.robots.robot.simulation import MAKES_UP, TICK, Simulation
from course_kit.robots.robot.vehicle import BEHIND, SILENT, Vehicle
from course_kit.robots.robot.world import Pillar, Wall, World
from tests.waiting import TIMEOUT, wait_until

BOX = World(
    "box",
    (Wall(0, 1.5, 4, 0.1), Wall(0, -1.5, 4, 0.1), Wall(2, 0, 3, 0.1, math.pi / 2), Wall(-2, 0, 3, 0.1, math.pi / 2)),
    (Pillar(-1, 1, 0.2),),
    (0.0, 0.0, 0.0),
    ((1.0, 0.0),),
)
TO_THE_WALL = 1.95 - shape.RADIUS  # m that the robot can drive ahead


def drive(simulation: Simulation, vehicle: Vehicle, linear: float, angular: float, seconds: float) -> None:
    """Give a command every tenth of a second."""
    for tick in range(round(seconds / TICK)):
        if tick % 10 == 0:
            vehicle.command(linear, angular, simulation.time)
        simulation.tick()


def ignore() -> None:
    """A rider that looks at nothing."""


@pytest.fixture
def simulation() -> Simulation:
    return Simulation(BOX)


# Commands


def a_run(seed: int) -> list[float]:
    """What is true, what the wheels say and what the laser sees after a drive."""
    world = World(BOX.name, BOX.walls, BOX.pillars, BOX.start, BOX.goals, seed)
    simulation = Simulation(world)
    vehicle = simulation.join(ignore)
    for linear, angular in ((0.2, 0.0), (0.1, 1.5), (-0.2, -2.0)):
        drive(simulation, vehicle, linear, angular, 1.0)
    return [*simulation.true_place(), *vehicle.odometry.place, *simulation.scan().tolist()]


def test_the_same_seed_and_commands_give_the_same_run() -> None:
    assert a_run(1) == a_run(1)
    assert a_run(1) != a_run(2)


def test_a_command_holds_for_half_a_second(simulation: Simulation) -> None:
    vehicle = simulation.join(ignore)
    vehicle.command(0.2, 0.0, simulation.time)
    for _ in range(50):
        simulation.tick()
    assert simulation.true_twist()[0] == pytest.approx(0.2, abs=0.02)
    for _ in range(50):  # it slows down at 1 m/s² at least
        simulation.tick()
    assert simulation.true_twist()[0] == pytest.approx(0.0, abs=0.005)
    assert vehicle.watchdog_stops == 1


def test_who_is_told_to_stand_is_not_stopped(simulation: Simulation) -> None:
    vehicle = simulation.join(ignore)
    drive(simulation, vehicle, 0.0, 0.0, 0.1)
    for _ in range(100):
        simulation.tick()
    assert vehicle.watchdog_stops == 0


# Bumps


def test_pushing_a_wall_is_one_bump(simulation: Simulation) -> None:
    vehicle = simulation.join(ignore, (1.5, 0.0, 0.0))
    drive(simulation, vehicle, 0.2, 0.0, 5.0)
    assert (vehicle.bumps, vehicle.touching) == (1, "wall")
    drive(simulation, vehicle, -0.2, 0.0, 1.5)
    assert vehicle.touching == ""
    drive(simulation, vehicle, 0.2, 0.0, 3.0)
    first, second = simulation.collisions()
    assert first.what == second.what == "wall"
    assert (TO_THE_WALL - 1.5) / shape.MAX_LINEAR < first.time < 5.0 < second.time


def test_a_pillar_and_a_robot_are_told_apart(simulation: Simulation) -> None:
    left = simulation.join(ignore, (-1.0, 0.4, math.pi / 2))
    right = simulation.join(ignore, (1.0, 0.0, 0.0))
    simulation.join(ignore, (1.4, 0.0, 0.0))
    for _ in range(40):
        for vehicle in (left, right):
            vehicle.command(0.2, 0.0, simulation.time)
        for _ in range(10):
            simulation.tick()
    assert [bump.what for bump in simulation.collisions(left.number)] == ["pillar"]
    assert {bump.what for bump in simulation.collisions(right.number)} == {"robot"}


# The clock


class Hand:
    """A clock that somebody moves; it goes on by itself by `own` seconds each time that it is read."""

    def __init__(self, own: float = 0.0) -> None:
        self.now, self.own = 100.0, own

    def __call__(self) -> float:
        self.now += self.own
        return self.now


@pytest.mark.parametrize("factor", [0.5, 1.0, 5.0])
def test_it_keeps_to_its_factor(factor: float) -> None:
    clock = Hand()
    simulation = Simulation(BOX, factor, clock)
    simulation.join(ignore)
    for _ in range(101):
        simulation.advance()
        clock.now += 0.01
    assert simulation.time == pytest.approx(factor, abs=TICK * (1 + factor))


def test_it_makes_up_for_a_short_stall_and_not_for_a_long_one() -> None:
    clock = Hand()
    simulation = Simulation(BOX, 1.0, clock)
    simulation.join(ignore)
    simulation.advance()
    clock.now += MAKES_UP / 2
    simulation.advance()
    assert simulation.time == pytest.approx(MAKES_UP / 2, abs=2 * TICK)
    clock.now += 3600
    simulation.advance()
    assert simulation.time == pytest.approx(1.5 * MAKES_UP, abs=3 * TICK)


def pass_by(simulation: Simulation, clock: Hand, seconds: float) -> float:
    """Have so many seconds go by; return how much simulated time went by meanwhile."""
    end, before = clock.now + seconds, simulation.time
    while clock.now < end:
        simulation.advance()
    return simulation.time - before


def test_time_is_slow_while_a_command_is_late() -> None:
    clock = Hand(own=0.0005)
    simulation = Simulation(BOX, 0.0, clock)
    vehicle = simulation.join(ignore, patience=2.0)
    vehicle.command(0.2, 0.0, simulation.time)
    # A command holds for 0.5 s, and the second half of that takes 2 s of real time.
    assert pass_by(simulation, clock, 1.0) == pytest.approx(0.25 + 0.125, abs=0.03)
    vehicle.command(0.2, 0.0, simulation.time)
    assert pass_by(simulation, clock, 0.05) == pytest.approx(0.25, abs=0.03)
    assert vehicle.watchdog_stops == 0
    assert pass_by(simulation, clock, 3.0) > 1.0
    assert vehicle.watchdog_stops == 1


def test_time_is_no_faster_than_real_time_while_odometry_is_corrected_late() -> None:
    clock = Hand(own=0.0005)
    simulation = Simulation(BOX, 0.0, clock)
    vehicle = simulation.join(ignore, patience=2.0)
    unhindered = pass_by(simulation, clock, 0.5)
    assert unhindered > 1.0
    vehicle.correct(simulation.time - BEHIND - 0.1, simulation.time)
    assert pass_by(simulation, clock, 0.5) == pytest.approx(0.5, abs=0.02)
    vehicle.correct(simulation.time, simulation.time)  # on time, until it is old again
    assert pass_by(simulation, clock, 0.5) == pytest.approx(BEHIND + 0.5, abs=0.1)


def test_time_goes_on_if_nobody_corrects_odometry_any_more() -> None:
    clock = Hand(own=0.0005)
    simulation = Simulation(BOX, 0.0, clock)
    vehicle = simulation.join(ignore, patience=2.0)
    vehicle.correct(-1.0, simulation.time)
    assert pass_by(simulation, clock, SILENT - 0.5) == pytest.approx(SILENT - 0.5, abs=0.1)
    vehicle.correct(-1.0, simulation.time)  # the same again: a transform that nobody works on
    assert pass_by(simulation, clock, 1.0) > 1.5


def test_slow_time_is_never_faster_than_its_factor() -> None:
    clock = Hand(own=0.0005)
    simulation = Simulation(BOX, 0.5, clock)
    simulation.join(ignore, patience=2.0).correct(-1.0, simulation.time)
    assert pass_by(simulation, clock, 2.0) == pytest.approx(1.0, abs=0.05)


def test_without_patience_time_waits_for_nobody() -> None:
    clock = Hand(own=0.0005)
    simulation = Simulation(BOX, 0.0, clock)
    vehicle = simulation.join(ignore)
    vehicle.correct(-1.0, simulation.time)
    vehicle.command(0.2, 0.0, simulation.time)
    assert pass_by(simulation, clock, 0.5) > 1.0


def test_as_fast_as_it_goes_it_still_returns() -> None:
    simulation = Simulation(BOX, 0.0, Hand(own=0.0005))
    simulation.join(ignore)
    simulation.advance()
    assert 2 <= simulation.ticks <= 5


def test_an_empty_world_stands_still(simulation: Simulation) -> None:
    simulation.advance()
    assert simulation.ticks == 0


def test_who_comes_while_another_is_at_it_returns_at_once(simulation: Simulation) -> None:
    entered, go_on = threading.Event(), threading.Event()

    def wait() -> None:
        entered.set()
        go_on.wait(TIMEOUT)

    simulation.join(wait)
    worker = threading.Thread(target=simulation.tick)
    worker.start()
    wait_until(entered.is_set)
    simulation.advance()  # would wait for ever
    assert worker.is_alive()
    go_on.set()
    worker.join(TIMEOUT)
    assert simulation.ticks == 1


# Robots come and go


def test_one_that_has_no_start_finds_a_free_one_beside_the_first(simulation: Simulation) -> None:
    vehicles = [simulation.join(ignore) for _ in range(4)]
    places = [simulation.true_place(one.number) for one in vehicles]
    assert places[0][:2] == pytest.approx(BOX.start[:2])
    apart = [math.dist(one[:2], other[:2]) for one in places for other in places if one is not other]
    assert 2 * shape.RADIUS < min(apart) < 1.0
    assert all(BOX.clearance(x, y) > shape.RADIUS for x, y, _ in places)


def test_a_start_in_a_wall_is_refused_and_nothing_is_left_of_it(simulation: Simulation) -> None:
    with pytest.raises(ValueError, match="no room"):
        simulation.join(ignore, (2.0, 0.0, 0.0))
    assert simulation.is_empty


def test_the_others_go_on_when_one_leaves(simulation: Simulation) -> None:
    told: list[int] = []
    first = simulation.join(lambda: told.append(0))
    second = simulation.join(lambda: told.append(1), (0.0, -1.0, 0.0))
    drive(simulation, second, 0.2, 0.0, 1.0)
    before = simulation.true_twist(second.number)
    simulation.leave(first.number)
    told.clear()
    simulation.tick()
    assert told == [1]
    assert simulation.first == second.number
    assert simulation.true_twist(second.number) == pytest.approx(before, abs=0.01)
    assert simulation.time == pytest.approx(1.0 + TICK)


def test_who_is_put_elsewhere_still_takes_itself_to_be_there(simulation: Simulation) -> None:
    vehicle = simulation.join(ignore)
    simulation.place((1.0, -1.0, 1.5))
    simulation.tick()
    assert simulation.true_place() == pytest.approx((1.0, -1.0, 1.5), abs=0.01)
    assert vehicle.odometry.place == pytest.approx((0.0, 0.0, 0.0), abs=0.001)


def test_beams_end_at_walls_and_pillars(simulation: Simulation) -> None:
    simulation.join(ignore, (-0.5, 0.5, 2.0))
    hits = simulation.hits()
    assert len(hits) > 300
    assert max(abs(BOX.clearance(x, y)) for x, y in hits) < 0.005


# Who shares a simulation


@pytest.fixture
def riders() -> Iterator[list[tuple[Simulation, Vehicle]]]:
    riders: list[tuple[Simulation, Vehicle]] = []
    yield riders
    for simulation, vehicle in riders:
        sharing.leave(simulation, vehicle)


def join(riders: list[tuple[Simulation, Vehicle]], owner: str, world: World, factor: float | None = None) -> Simulation:
    riders.append(sharing.join(owner, world, factor, ignore, None, 0.5))
    return riders[-1][0]


def test_the_same_world_is_shared_within_an_owner(riders: list[tuple[Simulation, Vehicle]]) -> None:
    other_seed = World(BOX.name, BOX.walls, BOX.pillars, BOX.start, BOX.goals, 3)
    mine = join(riders, "me", BOX)
    assert join(riders, "me", World(BOX.name, BOX.walls, BOX.pillars, BOX.start, BOX.goals)) is mine
    assert join(riders, "me", other_seed) is not mine
    assert join(riders, "you", BOX) is not mine


def test_a_second_factor_is_refused(riders: list[tuple[Simulation, Vehicle]]) -> None:
    mine = join(riders, "me", BOX, 5.0)
    assert join(riders, "me", BOX) is mine
    with pytest.raises(ValueError, match="runs at factor 5 already"):
        join(riders, "me", BOX, 1.0)


def test_the_last_one_ends_it(riders: list[tuple[Simulation, Vehicle]]) -> None:
    mine = join(riders, "me", BOX)
    mine.tick()
    sharing.leave(*riders.pop())
    assert join(riders, "me", BOX).ticks == 0


# What it looks like


def test_the_picture_shows_what_is_there() -> None:
    seen = Seen((1.0, -1.0, 0.0), hits=[(1.5, 0.5)], path=[(0.0, 0.0), (0.5, 0.0)], goal=(-1.0, -1.0))
    picture = draw(BOX, [seen], 400)
    assert max(picture.size) == 400
    scale = scale_of(BOX, [seen], 400)

    def color(x: float, y: float) -> tuple[int, ...]:
        across, down = scale.pixel(x, y)
        pixel = picture.getpixel((int(across), int(down)))
        assert isinstance(pixel, tuple)
        return pixel

    floor = color(-0.5, -0.5)
    assert min(floor) > 230
    assert max(color(2.0, 0.0)) < 100  # a wall
    assert max(color(-1.0, 1.0)) < 100  # the pillar
    for x, y in ((1.5, 0.5), (0.25, 0.0), (0.95, -1.06)):
        assert color(x, y) != floor
    assert scale.place(*scale.pixel(1.2, -0.7)) == pytest.approx((1.2, -0.7))
    words = picture.info["Description"]
    assert words.startswith("The world box from above: robot at (1.00, -1.00) m, heading 0.00 rad")
    assert "its goal at (-1.00, -1.00) m" in words


def test_a_map_is_drawn_the_right_way_up() -> None:
    values = np.full((20, 40), -1, np.int8)
    values[:5] = 0  # the lower rows: small y
    values[15:, :5] = 100  # at the top left
    cells = Cells(values, 0.1, (10.0, 20.0))
    seen = Seen((12.0, 21.0, 0.0), cells=cells)
    greys, scale = np.asarray(draw(None, [seen], 420).convert("L")), scale_of(None, [seen], 420)

    def grey(x: float, y: float) -> int:
        across, down = scale.pixel(x, y)
        return int(greys[int(down), int(across)])

    assert grey(12.0, 20.2) > 250
    assert grey(10.2, 21.8) < 100
    assert 180 < grey(13.0, 21.8) < 230


def test_the_description_has_the_robots_measures() -> None:
    robot = ElementTree.fromstring(urdf("robot2/"))
    links = {one.attrib["name"] for one in robot.iter("link")}
    assert links == {
        f"robot2/{name}"
        for name in ("base_link", "base_footprint", "base_scan", "imu_link", "wheel_left_link", "wheel_right_link")
    }
    masses = sum(float(one.attrib["value"]) for one in robot.iter("mass"))
    assert masses == pytest.approx(shape.MASS)
    children = {one.find("child").attrib["link"] for one in robot.iter("joint")}  # type: ignore[union-attr]
    assert links - children == {"robot2/base_link"}
