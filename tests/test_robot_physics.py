"""The robot in MuJoCo against what mechanics say, its laser against geometry, its odometry against the truth. No ROS.

What follows from mechanics alone is asserted exactly; how much the tyres slip and are worn is bounded.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import pairwise

import mujoco
import numpy as np
import pytest

from course_kit.robots.robot import shape
from course_kit.robots.robot.drive import Odometry, wheel_rates
from course_kit.robots.robot.model import GRIP
from course_kit.robots.robot.physics import ANGLES, Physics
from course_kit.robots.robot.world import Pillar, Place, World
from course_kit.robots.robot.worlds import line, world
from course_kit.setup.environment import pins

GRAVITY = 9.81  # m/s²
PLAIN = World("plain", (), (), (0.0, 0.0, 0.0), ())
ORIGIN: Place = (0.0, 0.0, 0.0)
CORNERS = ((-5.0, -3.0), (1.05, -3.0), (1.05, 3.0), (-5.0, 3.0))
BEFORE_WALL = World("a hall", tuple(line(*a, *b) for a, b in pairwise((*CORNERS, CORNERS[0]))), (), ORIGIN, ())
WALL = 1.0 - shape.RADIUS  # where a robot stands before the wall, which begins at x = 1
SEEDS = range(4)


class Drive:
    """One robot with its odometry; `every` is called after each step."""

    def __init__(self, where: World = PLAIN, start: Place = ORIGIN, seed: int = 0) -> None:
        self.physics = Physics(where, [start], seed)
        self.odometry = Odometry(start)
        self.turned = self.way = 0.0  # truly, rad and m
        self.believed = 0.0  # rad, by the wheels

    def go(self, linear: float, angular: float, seconds: float, every: Callable[[], object] = lambda: None) -> None:
        self.physics.drive(0, *wheel_rates(linear, angular))
        for _ in range(round(seconds / shape.STEP)):
            before, believed = self.physics.pose(0), self.odometry.place
            self.physics.step()
            self.odometry.update(self.physics.wheels(0)[0])
            after = self.physics.pose(0)
            self.way += math.dist(before[:2], after[:2])
            self.turned += math.remainder(after[2] - before[2], math.tau)
            self.believed += math.remainder(self.odometry.place[2] - believed[2], math.tau)
            every()


# How it drives


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("speed", [0.22, 0.05, -0.15])
def test_straight_it_drives_speed_times_time(speed: float, seed: int) -> None:
    drive = Drive(seed=seed)
    drive.go(speed, 0.0, 1.0)  # until it is as fast as it was told
    x, y, heading = drive.physics.pose(0)
    drive.go(speed, 0.0, 5.0)
    to_x, to_y, to_heading = drive.physics.pose(0)
    assert to_x - x == pytest.approx(5 * speed, rel=0.02)
    # No two tyres are the same: it drifts aside, by less than 0.025 rad a metre.
    assert abs(to_heading - heading) < 0.025 * abs(5 * speed)
    assert abs(to_y - y) < 0.05 * abs(5 * speed)
    assert drive.physics.twist(0) == pytest.approx((speed, 0.0), rel=0.02, abs=0.006)


@pytest.mark.parametrize(("linear", "angular"), [(0.2, 0.5), (0.1, -0.4), (-0.15, 0.5)])
def test_a_circle_has_the_radius_v_through_omega(linear: float, angular: float) -> None:
    drive = Drive()
    drive.go(linear, angular, 1.0)
    places: list[tuple[float, float]] = []
    drive.go(linear, angular, math.tau / abs(angular), lambda: places.append(drive.physics.pose(0)[:2]))
    x, y = np.array(places).T
    # The circle through these points: x² + y² = 2 a x + 2 b y + c, in the sense of least squares.
    a, b, c = np.linalg.lstsq(np.column_stack([2 * x, 2 * y, np.ones(len(x))]), x**2 + y**2)[0]
    radius = math.sqrt(c + a * a + b * b)
    assert radius == pytest.approx(abs(linear / angular), rel=0.05)
    assert np.hypot(x - a, y - b) == pytest.approx(radius, abs=0.002)
    # Its middle is to the left where it turns left and drives forward.
    assert math.copysign(1, b) == math.copysign(1, linear / angular)


@pytest.mark.parametrize("angular", [0.3, 1.0, -1.0, shape.MAX_ANGULAR])
def test_on_the_spot_it_turns_and_stays(angular: float) -> None:
    drive = Drive()
    drive.go(0.0, angular, 8.0)
    assert math.hypot(*drive.physics.pose(0)[:2]) < 0.02
    # The tyres scrub: it turns less than the wheels say, by 1 to 5 %.
    assert 0.01 < 1 - drive.turned / drive.believed < 0.05
    assert drive.believed == pytest.approx(8 * angular, rel=0.06)


def test_wheels_do_at_most_what_motors_can_on_the_same_circle() -> None:
    assert wheel_rates(0.1, 0.0) == pytest.approx((0.1 / 0.033, 0.1 / 0.033))
    assert wheel_rates(0.0, 1.0) == pytest.approx((-0.08 / 0.033, 0.08 / 0.033))
    assert wheel_rates(9.0, 0.0) == wheel_rates(shape.MAX_LINEAR, 0.0)
    assert wheel_rates(0.0, -9.0) == wheel_rates(0.0, -shape.MAX_ANGULAR)
    left, right = wheel_rates(0.22, 2.0)
    assert right == pytest.approx(shape.MAX_WHEEL_RATE)
    assert (left + right) / (right - left) * shape.WHEEL_SEPARATION / 2 == pytest.approx(0.11)


@pytest.mark.parametrize("bad", [math.nan, math.inf])
def test_what_is_not_finite_is_refused(bad: float) -> None:
    with pytest.raises(ValueError, match=r"A velocity is finite"):
        wheel_rates(0.1, bad)
    with pytest.raises(ValueError, match=r"Wheels turn at finite rates"):
        Physics(PLAIN, [ORIGIN]).drive(0, bad, 0.0)


# Mass, motors, energy


def test_it_does_not_stop_at_once() -> None:
    drive = Drive()
    drive.go(0.22, 0.0, 2.0)
    x, speed = drive.physics.pose(0)[0], drive.physics.twist(0)[0]
    speeds = [speed]
    drive.go(0.0, 0.0, 1.0, lambda: speeds.append(drive.physics.twist(0)[0]))
    # v² / 2a if the motors brake as they can, and less than 0.1 s later: their controller follows with a delay.
    shortest = speed**2 / (2 * shape.MAX_ACCELERATION)
    assert shortest < drive.physics.pose(0)[0] - x < shortest + 0.1 * speed
    assert speeds[-1] == pytest.approx(0.0, abs=1e-3)
    assert np.diff(speeds).min() / shape.STEP > -1.2 * shape.MAX_ACCELERATION


def test_however_it_is_driven_it_accelerates_no_more_than_motors_and_tyres_allow() -> None:
    drive = Drive()
    speeds, pitches = [0.0], []

    def look() -> None:
        speeds.append(drive.physics.twist(0)[0])
        pitches.append(2 * drive.physics.imu(0)[0][1])

    for linear in (0.22, -0.22, 0.22, 0.0, -0.22):
        drive.go(linear, 0.0, 0.7, look)
    felt = np.abs(np.diff(speeds)) / shape.STEP
    assert 0.8 * shape.MAX_ACCELERATION < felt.max() < 1.25 * shape.MAX_ACCELERATION < GRIP * GRAVITY
    assert np.abs(pitches).max() < 0.03  # it does not fall over


def test_energy_comes_from_the_motors_alone() -> None:
    drive = Drive(BEFORE_WALL)
    physics, work = drive.physics, [0.0]
    spare = []

    def look() -> None:
        torque, rate = physics.data.actuator_force, physics.wheels(0)[1]
        work.append(work[-1] + float(torque @ rate) * shape.STEP)
        spare.append(start + work[-1] - physics.energy())

    start = physics.energy()
    for linear, angular, seconds in ((0.22, 0.0, 2.0), (0.1, 1.5, 1.0), (0.22, 0.0, 4.0), (0.0, -2.0, 1.0)):
        drive.go(linear, angular, seconds, look)
    # 2 % of what the motors have given is left for the integrator and for a look half a step late.
    assert min(spare) > -0.02 * max(work)
    assert max(work) > 0.05


def test_without_motors_energy_does_not_grow_even_at_a_wall() -> None:
    drive = Drive(BEFORE_WALL)
    drive.go(0.22, 0.0, 3.0)
    model = drive.physics.model
    model.actuator_gainprm[:] = model.actuator_biasprm[:] = 0.0
    energies: list[float] = []
    touched = set()

    def look() -> None:
        energies.append(drive.physics.energy())
        touched.add(drive.physics.touches(0))

    drive.go(0.0, 0.0, 4.0, look)
    # Tyres and bumper give back what they took in when they were pressed: some thousandths of it.
    lowest = np.minimum.accumulate(energies)
    assert (energies - lowest).max() < 5e-3 * (energies[0] - energies[-1])
    assert energies[0] - energies[-1] > shape.MASS * 0.21**2 / 4
    assert touched == {"", "wall"}


def test_at_rest_it_stays_at_rest() -> None:
    physics = Physics(world("rooms"), [(1.0, 1.0, 0.7)])
    physics.step(4000)
    assert physics.time == pytest.approx(20.0)
    assert physics.pose(0) == pytest.approx((1.0, 1.0, 0.7), abs=1e-3)
    assert physics.wheels(0)[0] == pytest.approx([0.0, 0.0], abs=1e-5)
    assert physics.twist(0) == pytest.approx((0.0, 0.0), abs=1e-6)
    assert physics.touches(0) == ""


# Walls, pillars, robots


def test_a_wall_stops_it_and_its_wheels_slip() -> None:
    drive = Drive(BEFORE_WALL)
    furthest = []
    drive.go(0.22, 0.0, 3.5)
    assert drive.physics.touches(0) == ""
    drive.go(0.22, 0.0, 4.0, lambda: furthest.append(drive.physics.pose(0)[0]))
    assert drive.physics.touches(0) == "wall"
    assert max(furthest) < WALL + 0.003
    x, before = drive.physics.pose(0)[0], drive.physics.wheels(0)[0]
    drive.go(0.22, 0.0, 2.0)
    assert drive.physics.pose(0)[0] == pytest.approx(x, abs=0.005)
    assert (drive.physics.wheels(0)[0] - before).mean() * shape.WHEEL_RADIUS > 0.8 * 2.0 * 0.22
    assert drive.odometry.place[0] > 1.0  # it takes itself to be behind the wall
    drive.go(-0.1, 0.0, 2.0)
    assert drive.physics.touches(0) == ""


def test_what_it_bumps_into_has_a_name() -> None:
    pillar = World("a pillar", (), (Pillar(0.5, 0.0, 0.1),), ORIGIN, ())
    physics = Physics(pillar, [ORIGIN])
    physics.drive(0, *wheel_rates(0.2, 0.0))
    physics.step(600)
    assert physics.touches(0) == "pillar"
    assert physics.pose(0)[0] < 0.4 - shape.RADIUS + 0.003


def test_a_touch_during_any_of_the_steps_is_told() -> None:
    physics = Physics(BEFORE_WALL, [(WALL - 0.002, 0.0, 0.0)])
    physics.drive(0, *wheel_rates(0.1, 0.0))
    physics.step(100)
    physics.drive(0, *wheel_rates(-0.2, 0.0))
    physics.step(400)
    assert physics.pose(0)[0] < WALL - 0.1
    assert physics.touches(0) == "wall"
    physics.step()
    assert physics.touches(0) == ""


@pytest.mark.parametrize("name", ["rooms", "maze", "office"])
def test_driven_blindly_it_goes_through_no_wall(name: str) -> None:
    where = world(name, 2)
    physics = Physics(where, [where.start])
    chance = np.random.default_rng(1)
    touched = set()
    for _ in range(60):
        physics.drive(0, *wheel_rates(*chance.uniform((-0.1, -1.5), (0.22, 1.5))))
        for _ in range(20):
            physics.step(10)
            touched.add(physics.touches(0))
            assert where.clearance(*physics.pose(0)[:2]) > shape.RADIUS - 0.004
            assert np.abs(physics.imu(0)[0][:2]).max() < 0.1  # upright
    assert "wall" in touched


def test_robots_see_and_push_each_other() -> None:
    physics = Physics(PLAIN, [ORIGIN, (1.0, 0.0, math.pi)])
    to_the_other = 1.0 - shape.LASER[0] - shape.RADIUS
    for robot in (0, 1):
        scan = physics.scan(robot)
        assert scan[0] == pytest.approx(to_the_other, abs=0.003)
        half = math.degrees(math.asin(shape.RADIUS / (1.0 - shape.LASER[0])))
        assert np.isfinite(scan).sum() == pytest.approx(2 * half, abs=2)
    physics.drive(0, *wheel_rates(0.2, 0.0))
    physics.step(2000)
    assert (physics.touches(0), physics.touches(1)) == ("robot", "robot")
    assert physics.pose(1)[0] > 1.02
    assert math.dist(physics.pose(0)[:2], physics.pose(1)[:2]) == pytest.approx(2 * shape.RADIUS, abs=0.004)


# Sensors


@pytest.mark.parametrize("name", ["rooms", "maze", "office"])
def test_the_laser_measures_what_geometry_says(name: str) -> None:
    where = world(name)
    physics = Physics(where, [where.start])
    chance = np.random.default_rng(0)
    x0, y0, x1, y1 = where.bounds()
    looked = 0
    while looked < 20:
        x, y, heading = chance.uniform((x0, y0, -math.pi), (x1, y1, math.pi))
        if where.clearance(x, y) < shape.RADIUS + 0.01:
            continue
        looked += 1
        physics.place(0, (x, y, heading))
        x, y = x + shape.LASER[0] * math.cos(heading), y + shape.LASER[0] * math.sin(heading)
        # At edges, and along walls, a hair makes much: what is measured from a millimetre beside, and a little turned,
        # bounds it.
        beside = np.array(
            [
                where.distances(x + east, y + north, heading + ANGLES + turned)
                for east, north in ((0.0, 0.0), (0.001, 0.0), (-0.001, 0.0), (0.0, 0.001), (0.0, -0.001))
                for turned in (0.0, -0.003, 0.003)
            ]
        )
        found, beside = np.minimum(physics.scan(0), shape.LONGEST), np.minimum(beside, shape.LONGEST)
        assert (found >= beside.min(axis=0) - 0.003).all()
        assert (found <= beside.max(axis=0) + 0.003).all()
        clear = np.ptp(beside, axis=0) < 0.02
        assert found[clear] == pytest.approx(beside[0][clear], abs=0.003)
        assert clear.sum() > 180


def test_scans_are_as_of_now_and_turn_with_the_robot() -> None:
    physics = Physics(BEFORE_WALL, [ORIGIN])
    to_wall = 1.0 - shape.LASER[0]
    for heading, ray in ((0.0, 0), (math.pi / 2, 270), (-math.pi / 2, 90), (math.pi, 180)):
        physics.place(0, (0.0, 0.0, heading))
        scan = physics.scan(0)
        x = shape.LASER[0] * math.cos(heading)
        assert scan[ray] == pytest.approx(1.0 - x, abs=0.002)
        assert scan.shape == (shape.RAYS,)
    physics.place(0, ORIGIN)
    physics.drive(0, *wheel_rates(0.22, 0.0))
    for _ in range(3):
        physics.step(100)
        assert physics.scan(0)[0] == pytest.approx(to_wall - physics.pose(0)[0], abs=0.002)


def test_the_imu_feels_gravity_turns_and_the_motors() -> None:
    physics = Physics(PLAIN, [(0.0, 0.0, 1.0)])
    physics.step(100)
    orientation, turning, acceleration = physics.imu(0)
    assert 2 * math.atan2(orientation[2], orientation[3]) == pytest.approx(1.0, abs=1e-3)
    assert turning == pytest.approx([0.0, 0.0, 0.0], abs=1e-6)
    assert acceleration == pytest.approx([0.0, 0.0, GRAVITY], abs=0.05)
    physics.drive(0, *wheel_rates(0.22, 0.0))
    felt = []
    for _ in range(40):
        physics.step()
        felt.append(physics.imu(0)[2][0])
    assert max(felt) == pytest.approx(shape.MAX_ACCELERATION, abs=0.25)
    physics.drive(0, *wheel_rates(0.0, 1.0))
    physics.step(400)
    assert physics.imu(0)[1] == pytest.approx([0.0, 0.0, physics.twist(0)[1]], abs=0.02)


# Odometry


def test_odometry_alone_is_exact_on_arcs() -> None:
    odometry = Odometry((1.0, 2.0, math.pi / 2))
    turn = math.pi / shape.WHEEL_RADIUS
    # Half a circle to the left of radius 1, in one update: wheels on radii 0.92 and 1.08.
    odometry.update((0.92 * turn, 1.08 * turn), elapsed=2.0)
    assert odometry.place == pytest.approx((-1.0, 2.0, -math.pi / 2))
    assert odometry.twist == pytest.approx((math.pi / 2, math.pi / 2))
    odometry.update((0.92 * turn, 1.08 * turn), elapsed=2.0)
    assert odometry.twist == (0.0, 0.0)
    assert odometry.place == pytest.approx((-1.0, 2.0, -math.pi / 2))


@pytest.mark.parametrize("seed", SEEDS)
def test_odometry_drifts_within_bounds(seed: int) -> None:
    drive = Drive(seed=seed)
    for _ in range(4):
        drive.go(0.2, 0.0, 5.0)
        drive.go(0.0, 0.0, 0.5)
        drive.go(0.0, math.pi / 4, 2.0)
        drive.go(0.0, 0.0, 0.5)
    true, believed = drive.physics.pose(0), drive.odometry.place
    assert drive.way == pytest.approx(4.0, rel=0.05)
    # Seen after a square of a metre, and at most 10 % of the way, 0.02 rad a metre and 4 % of what it has turned.
    assert 0.03 < math.dist(true[:2], believed[:2]) < 0.1 * drive.way
    assert 0.02 < abs(drive.turned - drive.believed) < 0.02 * drive.way + 0.04 * abs(drive.believed)


def test_no_two_robots_have_the_same_tyres() -> None:
    drifts = []
    for seed in range(8):
        drive = Drive(seed=seed)
        drive.go(0.22, 0.0, 4.0)
        drifts.append(drive.physics.pose(0)[2])
    assert min(drifts) < -0.002
    assert max(drifts) > 0.002
    physics = Physics(PLAIN, [ORIGIN, (0.0, 1.0, 0.0)])
    for robot in (0, 1):
        physics.drive(robot, 5.0, 5.0)
    physics.step(800)
    assert abs(physics.pose(0)[2] - physics.pose(1)[2]) > 1e-4


# Runs


def run(*, looks: bool = False, robots: int = 1, where: str = "office") -> list[float]:
    """A drive through walls' reach and all that it left, as numbers."""
    one = world(where, 3)
    physics = Physics(one, [one.start, (*one.goals[0], 0.0)][:robots], seed=5)
    chance = np.random.default_rng(2)
    for _ in range(40):
        for robot in range(robots):
            physics.drive(robot, *chance.uniform(-4, 8, 2))
        physics.step(25)
        if looks:
            physics.scan(0), physics.imu(0), physics.energy(), physics.wheels(0), physics.touches(0)
    return [*physics.data.qpos.tolist(), *physics.data.qvel.tolist(), *physics.scan(0).tolist()]


@pytest.mark.parametrize("robots", [1, 2])
def test_the_same_commands_give_the_same_run_bit_for_bit(robots: int) -> None:
    assert run(robots=robots) == run(robots=robots)


def test_looking_changes_nothing() -> None:
    assert run(looks=True) == run()


def test_the_number_of_steps_at_once_changes_nothing() -> None:
    ends = []
    for count in (1, 10, 500):
        physics = Physics(PLAIN, [ORIGIN])
        physics.drive(0, 3.0, 5.0)
        for _ in range(500 // count):
            physics.step(count)
        ends.append(physics.data.qpos.tolist())
    assert ends[0] == ends[1] == ends[2]
    assert physics.time == pytest.approx(500 * shape.STEP)


# Robots come and go


def test_another_robot_comes_and_goes_and_the_first_drives_on() -> None:
    alone, joined = Physics(PLAIN, [ORIGIN]), Physics(PLAIN, [ORIGIN])
    for physics in (alone, joined):
        physics.drive(0, 6.0, 5.0)
        physics.step(150)
    assert joined.add((3.0, 0.0, 1.0)) == 1
    assert joined.pose(1) == pytest.approx((3.0, 0.0, 1.0), abs=1e-3)
    assert joined.pose(0) == alone.pose(0)
    for physics in (alone, joined):
        physics.step(100)
    joined.remove(1)
    for physics in (alone, joined):
        physics.step(100)
    assert joined.time == alone.time
    assert joined.pose(0) == pytest.approx(alone.pose(0), abs=1e-6)
    assert joined.wheels(0)[0] == pytest.approx(alone.wheels(0)[0], abs=1e-6)
    assert joined.add((0.0, 2.0, 0.0)) == 2
    with pytest.raises(KeyError):
        joined.pose(1)


def test_a_robot_goes_and_the_later_ones_keep_their_numbers() -> None:
    physics = Physics(PLAIN, [ORIGIN, (1.0, 0.0, 0.0), (2.0, 0.0, 0.0)])
    physics.drive(2, *wheel_rates(0.2, 0.0))
    physics.step(200)
    place = physics.pose(2)
    physics.remove(0)
    assert physics.pose(2) == place
    physics.step(200)
    assert physics.pose(2)[0] > place[0] + 0.15
    assert physics.pose(1) == pytest.approx((1.0, 0.0, 0.0), abs=1e-3)


def test_put_elsewhere_it_is_at_rest_and_its_wheels_know_nothing_of_it() -> None:
    drive = Drive()
    drive.go(0.2, 0.3, 2.0)
    believed, wheels = drive.odometry.place, drive.physics.wheels(0)[0]
    drive.physics.place(0, (-1.0, 2.0, 3.0))
    for _ in range(200):
        drive.physics.step()
        drive.odometry.update(drive.physics.wheels(0)[0])
    assert drive.physics.pose(0) == pytest.approx((-1.0, 2.0, 3.0), abs=2e-3)
    assert drive.physics.wheels(0)[0] == pytest.approx(wheels, abs=1e-3)
    assert drive.odometry.place == pytest.approx(believed, abs=1e-3)


@pytest.mark.parametrize(
    ("place", "says"),
    [
        ((0.02, 1.0, 0.0), "A robot has no room at (0.02, 1) of the world 'rooms': a wall is there."),
        ((-3.0, 1.0, 0.0), "(-3, 1) is outside the world 'rooms'."),
        ((1.1, 1.2, 0.0), "A robot has no room at (1.1, 1.2): robot 0 is there."),
        ((math.nan, 1.0, 0.0), "A robot's place is x and y in m and its heading in rad, not (nan, 1.0, 0.0)."),
    ],
)
def test_where_it_has_no_room_it_is_not_put(place: Place, says: str) -> None:
    physics = Physics(world("rooms"), [(1.2, 1.2, 0.0)])
    with pytest.raises(ValueError) as refused:
        physics.add(place)
    assert str(refused.value) == says
    assert physics.model.nu == 2


def test_mass_is_that_of_the_shape_and_mujoco_that_of_the_lock() -> None:
    physics = Physics(PLAIN, [ORIGIN])
    assert physics.model.body_mass.sum() == pytest.approx(shape.MASS)
    assert any(pin.startswith(f"mujoco=={mujoco.__version__} ;") for pin in pins.versions(["mujoco"]))
