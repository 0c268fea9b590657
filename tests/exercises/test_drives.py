"""What of a turtle's path was driven, by which commands, and where it was put; without ROS."""

from __future__ import annotations

import time
from collections import namedtuple
from types import SimpleNamespace

import pytest

from course_kit.exercises.checker import drives
from course_kit.exercises.checker.drives import Commands, steps_of

Pose = namedtuple("Pose", "x y theta linear_velocity angular_velocity", defaults=(0.0, 0.0, 0.0))
SECOND = 1_000_000_000
TICK = 16_000_000


def line(speed: float, count: int, x: float = 0.0, begin: int = 0) -> list[tuple[int, Pose]]:
    """Poses of a turtle that drives to the right, and comes to rest."""
    way = [(begin + n * TICK, Pose(x + n * abs(speed) * 0.016, 5.0, 0.0, abs(speed))) for n in range(count)]
    return [*way, (begin + count * TICK, way[-1][1]._replace(linear_velocity=0.0))]


def twist(x: float, y: float = 0.0) -> SimpleNamespace:
    return SimpleNamespace(linear=SimpleNamespace(x=x, y=y))


def test_what_is_driven_is_one_drive_and_nothing_of_it_was_put():
    poses = line(2.0, 100)
    assert len(drives.drives(steps_of(poses))) == 1
    assert drives.driven(steps_of(poses)) == pytest.approx(99 * 0.032)
    assert drives.carried(steps_of(poses)) == 0.0


def test_poses_that_come_late_or_are_lost_are_no_teleports():
    poses = line(8.0, 200)
    late = [(when + (90_000_000 if 50 < place < 60 else 0), pose) for place, (when, pose) in enumerate(poses)]
    lost = poses[:50] + poses[62:120] + poses[121:]
    for heard in (late, lost):
        assert len(drives.drives(steps_of(heard))) == 1
        assert drives.driven(steps_of(heard)) == pytest.approx(199 * 0.128, abs=0.2)


@pytest.mark.parametrize("step", [0.05, 0.3, 4.0])
def test_small_and_great_teleports_are_no_drive(step: float):
    poses = [(n * TICK, Pose(n * step, 5.0)) for n in range(40)]
    assert drives.driven(steps_of(poses)) == 0.0
    assert drives.carried(steps_of(poses)) == pytest.approx(39 * step)
    assert len(drives.drives(steps_of(poses))) >= min(39 * step / 0.3, 39)


def test_a_teleport_after_a_rest_and_with_a_command_is_one():
    rest = [(0, Pose(1.0, 5.0)), (600 * SECOND, Pose(1.0, 5.0))]
    assert len(drives.drives(steps_of([*rest, *line(2.0, 20, x=9.0, begin=600 * SECOND + TICK)]))) == 2
    assert len(drives.drives(steps_of([*rest, *line(2.0, 20, x=1.03, begin=600 * SECOND + TICK)]))) == 1


def test_a_corner_where_a_drive_begins_is_not_one_that_it_came_to():
    drive = [pose for _, pose in line(2.0, 200)]
    assert not drives.came_to(drive, (0.0, 5.0), 1.0)
    assert drives.came_to(drive, (6.0, 5.0), 1.0)
    assert drives.came_to([*drive, *reversed(drive)], (0.0, 5.0), 1.0)
    assert not drives.came_to(drive, (9.0, 5.0), 1.0)


def test_a_command_explains_its_speed_while_it_holds_and_no_other():
    commands = Commands([(10 * SECOND, twist(-2.0)), (40 * SECOND, twist(-2.0)), (41 * SECOND, twist(3.0, 4.0))])
    assert all(commands.explain(when * SECOND, 2.0) for when in (10, 25, 40))
    assert not commands.explain(5 * SECOND, 2.0) and not commands.explain(45 * SECOND, 2.0)
    assert not commands.explain(25 * SECOND, 1.0)
    assert commands.explain(42 * SECOND, 5.0) and commands.explain(42 * SECOND, 3.0)
    assert not Commands([]).explain(SECOND, 2.0)


def test_what_a_new_publisher_says_first_may_be_missed():
    commands = Commands([], newcomers=[30 * SECOND, 10 * SECOND])
    assert commands.explain(11 * SECOND, 7.0) and commands.explain(31 * SECOND, 7.0)
    assert not commands.explain(20 * SECOND, 7.0)
    assert drives.driven(steps_of(line(2.0, 50, begin=10 * SECOND)), commands) > 1.0
    assert drives.driven(steps_of(line(2.0, 50, begin=20 * SECOND)), commands) == 0.0


def test_what_came_of_an_earlier_command_is_not_counted():
    early, late = (10 * SECOND, twist(2.0)), (10 * SECOND + SECOND // 2, twist(2.0))
    since = 10 * SECOND + SECOND // 4
    assert Commands([]).first_effect(since) == since
    assert Commands([early]).first_effect(since) == 12 * SECOND
    assert Commands([early, late]).first_effect(since) == late[0]
    assert Commands([(SECOND, twist(2.0))]).first_effect(since) == since
    assert Commands([], newcomers=[10 * SECOND, 11 * SECOND]).first_effect(since) == 12 * SECOND  # it was not heard
    assert Commands([late], newcomers=[10 * SECOND]).first_effect(since) == late[0]
    poses = line(2.0, 60, begin=10 * SECOND)
    assert drives.moved_since(steps_of(poses), Commands([early]).first_effect(since)) == 0.0
    assert drives.moved_since(steps_of(poses), Commands([early, late]).first_effect(since)) > 0.5


def test_a_quarter_of_an_hour_of_driving_is_judged_in_seconds():
    poses = line(2.0, 50_000)
    commands = Commands([(n * TICK, twist(2.0 + n % 7)) for n in range(50_000)])
    began = time.process_time()
    assert drives.driven(steps_of(poses), commands) > 1000
    assert len(drives.drives(steps_of(poses))) == 1
    assert time.process_time() - began < 3
