"""The rules and numbers of turtlesim, tick by tick, without ROS."""

from __future__ import annotations

import math
import subprocess
import sys
import time

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from course_kit.robots.turtlesim import picture
from course_kit.robots.turtlesim.field import EXTENT, MIDDLE, SIZE, Field, float32
from course_kit.robots.turtlesim.turtle import Outcome, Reading, normalise
from course_kit.robots.turtlesim.world import World

TICK = 16_000_000  # nanoseconds
SECOND = 1_000_000_000
WHITE = (255, 255, 255)
PEN = (179, 184, 255)


class Run:
    """A world with its time; the tick that starts the clock is done."""

    def __init__(self) -> None:
        self.now = 0
        self.world = World(self.now)
        assert self.world.tick(self.now) == {}
        self.log()

    def tick(self, times: int = 1, name: str = "turtle1") -> Reading:
        for _ in range(times):
            self.now += TICK
            readings = self.world.tick(self.now)
        return readings[name]

    def drive(self, forward: float, turning: float = 0.0, sideways: float = 0.0) -> None:
        self.world.command("turtle1", forward, sideways, turning, self.now)

    def log(self) -> list[tuple[str, str]]:
        return [(line.level, line.text) for line in self.world.take_log()]


@pytest.fixture
def run() -> Run:
    return Run()


# The field and the start


def test_field_is_11_088889_metres_wide() -> None:
    assert EXTENT == 11.088889122009277
    assert MIDDLE == 5.544444561004639


def test_turtle1_starts_in_the_middle_and_looks_right(run: Run) -> None:
    assert run.tick().pose == (5.544444561004639, 5.544444561004639, 0.0, 0.0, 0.0)


def test_start_is_logged() -> None:
    assert World(0).take_log() == [
        ("info", "Spawning turtle [turtle1] at x=[5.544445], y=[5.544445], theta=[0.000000]")
    ]


def test_first_tick_only_starts_the_clock() -> None:
    world = World(0)
    world.teleport_absolute("turtle1", 1.0, 2.0, 0.0)
    assert world.tick(0) == {}
    assert world.tick(TICK)["turtle1"].pose[:2] == (1.0, 2.0)


def test_pure_part_imports_no_ros() -> None:
    code = "import sys, course_kit.robots.turtlesim.picture; sys.exit('rclpy' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], timeout=60).returncode == 0


# Velocity commands


def test_one_command_of_2_moves_2_metres_in_steps_of_32_mm(run: Run) -> None:
    run.drive(2.0)
    places = [run.tick().pose.x for _ in range(80)]
    steps = np.diff([MIDDLE, *places])
    moving = steps > 0
    assert moving.sum() == 62
    assert moving[:62].all()
    assert steps[:62] == pytest.approx(0.032, abs=1e-6)
    assert places[-1] - MIDDLE == pytest.approx(62 * 0.032, abs=1e-6)


def test_command_holds_for_exactly_one_second(run: Run) -> None:
    run.drive(1.0)
    at_one_second = run.world.tick(run.now + SECOND)["turtle1"].pose
    just_after = run.world.tick(run.now + SECOND + 1)["turtle1"].pose
    assert at_one_second.linear_velocity == 1.0
    assert at_one_second.x == float32(MIDDLE + 0.016)
    assert just_after.linear_velocity == 0.0
    assert just_after.x == at_one_second.x


def test_turtle_moves_along_the_new_heading(run: Run) -> None:
    run.drive(1.0, turning=math.pi / 2)
    pose = run.tick().pose
    theta = math.pi / 2 * 0.016
    assert pose.theta == float32(theta)
    assert pose.x == float32(MIDDLE + math.cos(theta) * 0.016)
    assert pose.y == pytest.approx(MIDDLE + math.sin(theta) * 0.016, abs=1e-6)


def test_sideways_is_to_the_left(run: Run) -> None:
    run.drive(3.0, sideways=4.0)
    pose = run.tick().pose
    assert pose.x == pytest.approx(MIDDLE + 3 * 0.016, abs=1e-6)
    assert pose.y == pytest.approx(MIDDLE + 4 * 0.016, abs=1e-6)
    assert pose.linear_velocity == 5.0


def test_speed_is_positive_in_reverse_and_turning_keeps_its_sign(run: Run) -> None:
    run.drive(-2.0, turning=-1.5)
    pose = run.tick().pose
    assert pose.x < MIDDLE
    assert (pose.linear_velocity, pose.angular_velocity) == (2.0, -1.5)


def test_heading_goes_from_pi_to_minus_pi(run: Run) -> None:
    run.world.teleport_absolute("turtle1", 5, 5, 3.14)
    run.drive(0.0, turning=1.0)
    assert run.tick().pose.theta == pytest.approx(3.14 + 0.016 - math.tau)


# The wall


def test_wall_is_logged_on_every_tick_and_keeps_the_velocity(run: Run) -> None:
    run.world.teleport_absolute("turtle1", EXTENT, MIDDLE, 0.0)
    run.drive(2.0)
    poses = [run.tick().pose for _ in range(3)]
    line = ("warn", "Oh no! I hit the wall! (Clamping from [x=11.120889, y=5.544445])")
    assert run.log() == [line] * 3
    assert {pose.x for pose in poses} == {11.088889122009277}
    assert {pose.linear_velocity for pose in poses} == {2.0}


def test_wall_message_counts_y_from_the_top(run: Run) -> None:
    run.world.teleport_absolute("turtle1", 5.0, EXTENT, math.pi / 2)
    run.drive(1.0)
    assert run.tick().pose.y == 11.088889122009277
    assert run.log() == [("warn", "Oh no! I hit the wall! (Clamping from [x=5.000000, y=-0.016000])")]


def test_bottom_wall_is_at_y_0(run: Run) -> None:
    run.world.teleport_absolute("turtle1", 5.0, 0.01, -math.pi / 2)
    run.drive(1.0)
    assert run.tick().pose.y == 0.0


# Pen, trails and colour sensor


def test_colour_is_white_off_a_trail_and_the_pens_on_one(run: Run) -> None:
    assert run.tick().color == WHITE
    run.drive(10.0)
    moving = [run.tick().color for _ in range(5)]
    assert moving == [WHITE] * 5  # the sensor looks before the tick's line is drawn
    run.drive(0.0)
    assert run.tick().color == PEN


def test_lifted_pen_draws_nothing_and_keeps_its_colour(run: Run) -> None:
    run.world.set_pen("turtle1", (255, 0, 0), 5, off=False)
    run.world.set_pen("turtle1", (0, 255, 0), 1, off=True)
    run.drive(10.0)
    run.tick(5)
    run.drive(0.0)
    assert run.tick().color == WHITE
    pen = run.world.turtles["turtle1"].pen
    assert (pen.color, pen.width, pen.down) == ((255, 0, 0), 5, False)


def test_pen_draws_in_its_new_colour_when_put_down(run: Run) -> None:
    run.world.set_pen("turtle1", (0, 0, 0), 1, off=True)
    run.world.set_pen("turtle1", (1, 2, 3), 1, off=False)
    run.drive(10.0)
    run.tick(5)
    run.drive(0.0)
    assert run.tick().color == (1, 2, 3)


@pytest.mark.parametrize(("width", "pixels"), [(0, 1), (1, 1), (2, 2), (3, 3), (10, 10), (255, 255)])
def test_trail_is_as_wide_as_the_pen(run: Run, width: int, pixels: int) -> None:
    run.world.set_pen("turtle1", (0, 0, 0), width, off=False)
    run.world.teleport_absolute("turtle1", 10.0, MIDDLE, 0.0)
    run.tick()
    column = np.array(run.world.scene().trails)[:, 350, 3]
    assert (column > 0).sum() == pixels


def test_trail_of_a_curve_has_no_gaps(run: Run) -> None:
    run.world.set_pen("turtle1", (9, 9, 9), 1, off=False)
    run.drive(1.0, turning=1.0)
    passed = []
    for _ in range(60):
        run.tick()
        passed.append(run.world.turtles["turtle1"].point)
    field = run.world._field
    assert {field.color_at(point) for point in passed} == {(9, 9, 9)}


def test_turtles_move_in_name_order_on_one_field(run: Run) -> None:
    run.world.kill("turtle1")
    for name in ("second", "first"):
        run.world.spawn(name, 2.0, 5.0, 0.0, run.now)
    run.world.set_pen("second", (0, 0, 0), 1, off=True)
    run.world.teleport_absolute("first", 8.0, 5.0, 0.0)
    assert run.tick(name="second").color == PEN  # on the line that first has drawn in this tick


def test_line_from_far_away_is_drawn_where_it_crosses_the_field() -> None:
    field = Field()
    started = time.thread_time()
    field.draw_line((-3e38, 5.0), (3e38, 5.0), PEN, 3)
    field.draw_line((1e30, -1e30), (1e38, -1e38), PEN, 255)
    assert time.thread_time() - started < 1.0
    assert field.color_at((0.0, 5.0)) == field.color_at((EXTENT, 5.0)) == PEN
    assert field.color_at((5.0, 3.0)) == WHITE


# Teleports


def test_teleports_take_effect_in_order_at_the_next_tick(run: Run) -> None:
    run.world.teleport_absolute("turtle1", 2.0, 3.0, 1.0)
    run.world.teleport_relative("turtle1", 2.0, -1.0)
    assert run.world.turtles["turtle1"].x == MIDDLE
    pose = run.tick().pose
    assert pose[:3] == pytest.approx((4.0, 3.0, 0.0), abs=1e-6)


def test_relative_teleport_turns_first_then_moves(run: Run) -> None:
    run.world.teleport_relative("turtle1", 1.0, math.pi / 2)
    pose = run.tick().pose
    assert pose[:3] == pytest.approx((MIDDLE, MIDDLE + 1.0, math.pi / 2), abs=1e-6)


def test_teleport_draws_a_line_if_the_pen_is_on(run: Run) -> None:
    run.world.teleport_absolute("turtle1", 2.0, 2.0, 0.0)
    assert run.tick().color == PEN
    run.world.set_pen("turtle1", PEN, 3, off=True)
    run.world.teleport_absolute("turtle1", 9.0, 2.0, 0.0)
    assert run.tick().color == WHITE


def test_teleport_keeps_velocity_and_command_clock(run: Run) -> None:
    run.drive(1.0)
    run.now += SECOND - TICK
    run.world.teleport_absolute("turtle1", 2.0, 2.0, 0.0)
    assert run.tick().pose.x == float32(2.0 + 0.016)
    assert run.tick().pose.linear_velocity == 0.0


def test_teleport_above_the_field_clamps_silently_and_beside_it_hits_the_wall(run: Run) -> None:
    run.world.teleport_absolute("turtle1", 5.0, 20.0, 0.0)
    assert run.tick().pose.y == 11.088889122009277
    assert run.log() == []
    run.world.teleport_absolute("turtle1", 20.0, 5.0, 0.0)
    assert run.tick().pose.x == 11.088889122009277
    assert run.log() == [("warn", "Oh no! I hit the wall! (Clamping from [x=20.000000, y=6.088889])")]


# Spawn, kill, clear, reset


def test_spawn_says_where(run: Run) -> None:
    assert run.world.spawn("anna", 1.0, 2.0, 0.5, run.now) == "anna"
    assert run.log() == [("info", "Spawning turtle [anna] at x=[1.000000], y=[2.000000], theta=[0.500000]")]
    assert run.tick(name="anna").pose == (1.0, 2.0, 0.5, 0.0, 0.0)


def test_spawn_computes_y_in_float32_as_the_original(run: Run) -> None:
    run.world.spawn("anna", 1.0, 0.1, 0.0, run.now)
    pose = run.tick(name="anna").pose
    assert pose.x == 1.0
    assert pose.y != float32(0.1)
    assert pose.y == float(np.float32(EXTENT) - (np.float32(EXTENT) - np.float32(0.1)))


def test_names_are_counted_up_until_one_is_free(run: Run) -> None:
    assert run.world.spawn("turtle3", 1, 1, 0, run.now) == "turtle3"
    assert run.world.spawn("", 1, 1, 0, run.now) == "turtle2"
    assert run.world.spawn("", 1, 1, 0, run.now) == "turtle4"
    run.world.kill("turtle4")
    assert run.world.spawn("", 1, 1, 0, run.now) == "turtle5"


def test_spawn_of_a_name_that_exists(run: Run) -> None:
    assert run.world.spawn("turtle1", 1, 1, 0, run.now) == ""
    assert run.log() == [("error", "A turtle named [turtle1] already exists")]
    assert run.tick().pose.x == MIDDLE


def test_spawn_does_not_clamp_but_the_first_tick_does(run: Run) -> None:
    assert run.world.spawn("far", 20.0, 5.0, 0.0, run.now) == "far"
    assert run.world.turtles["far"].x == 20.0
    assert run.tick(name="far").pose.x == 11.088889122009277


def test_spawned_turtle_stands_still(run: Run) -> None:
    run.world.spawn("anna", 1.0, 1.0, 0.0, run.now)
    assert run.tick(100, name="anna").pose == (1.0, 1.0, 0.0, 0.0, 0.0)


def test_kill(run: Run) -> None:
    assert run.world.kill("turtle1")
    assert run.world.tick(run.now) == {}
    assert run.log() == []
    assert not run.world.kill("turtle1")
    assert run.log() == [("error", "Tried to kill turtle [turtle1], which does not exist")]


def test_killed_turtle_ignores_what_it_is_told(run: Run) -> None:
    run.world.kill("turtle1")
    run.drive(1.0)
    run.world.teleport_absolute("turtle1", 1, 1, 1)
    run.world.set_pen("turtle1", PEN, 3, off=True)
    assert run.world.rotate("turtle1", 1.0).outcome is Outcome.ABORTED
    assert run.log() == []


def test_clear_wipes_trails_only(run: Run) -> None:
    run.world.teleport_absolute("turtle1", 2.0, 2.0, 0.0)
    assert run.tick().color == PEN
    run.world.clear()
    assert run.log() == [("info", "Clearing turtlesim.")]
    reading = run.tick()
    assert reading.color == WHITE
    assert reading.pose[:2] == (2.0, 2.0)


def test_reset_begins_again(run: Run) -> None:
    run.world.spawn("", 1, 1, 0, run.now)
    run.world.spawn("anna", 1, 1, 0, run.now)
    run.world.set_pen("turtle1", (1, 2, 3), 9, off=True)
    run.world.teleport_absolute("anna", 9.0, 9.0, 0.0)
    run.tick()
    run.log()
    run.world.reset(run.now)
    assert run.log() == [
        ("info", "Resetting turtlesim."),
        ("info", "Spawning turtle [turtle1] at x=[5.544445], y=[5.544445], theta=[0.000000]"),
    ]
    assert list(run.world.turtles) == ["turtle1"]
    assert run.tick().pose == (MIDDLE, MIDDLE, 0.0, 0.0, 0.0)
    assert run.world.turtles["turtle1"].pen.color == PEN
    assert not np.array(run.world.scene().trails)[:, :, 3].any()
    assert run.world.spawn("", 1, 1, 0, run.now) == "turtle2"


# rotate_absolute


def test_rotation_to_1_57_takes_97_ticks(run: Run) -> None:
    rotation = run.world.rotate("turtle1", 1.57)
    readings = []
    while rotation.outcome is None:
        readings.append(run.tick())
    assert [reading.pose.angular_velocity for reading in readings] == [1.0] * 97 + [0.0]
    assert rotation.outcome is Outcome.SUCCEEDED
    assert rotation.delta == -1.5520000457763672
    remaining = [reading.remaining for reading in readings]
    assert remaining[0] == float32(1.57)
    assert remaining[-1] == pytest.approx(1.57 - 1.552, abs=1e-6)
    assert run.log() == [("info", "Rotation goal completed successfully")]
    assert run.tick().remaining is None


@pytest.mark.parametrize(
    ("start", "goal", "turn"),
    [
        (0.0, -1.0, -1),
        (0.0, 1.0, 1),
        (3.0, -3.0, 1),
        (-3.0, 3.0, -1),
        (0.0, 4.0, -1),
        (0.5, 0.5 + math.tau, 0),
    ],
)
def test_rotation_takes_the_shorter_way(run: Run, start: float, goal: float, turn: int) -> None:
    run.world.teleport_absolute("turtle1", 5, 5, start)
    run.tick()
    rotation = run.world.rotate("turtle1", goal)
    assert run.tick().pose.angular_velocity == turn
    run.tick(200)
    assert rotation.outcome is Outcome.SUCCEEDED
    assert math.copysign(1, rotation.delta) == -turn or abs(rotation.delta) < 0.02
    assert abs(normalise(run.tick().pose.theta - goal)) < 0.02


def test_rotation_stops_the_turtles_way_and_outlasts_a_second(run: Run) -> None:
    run.drive(1.0)
    run.tick()
    rotation = run.world.rotate("turtle1", 3.0)
    x = run.world.turtles["turtle1"].x
    poses = [run.tick().pose for _ in range(180)]
    assert {pose.linear_velocity for pose in poses} == {0.0}
    assert {pose.x for pose in poses} == {float32(x)}
    assert rotation.outcome is None
    run.tick(20)
    assert rotation.outcome is Outcome.SUCCEEDED


def test_cancel_ends_at_the_next_tick_with_the_result_so_far(run: Run) -> None:
    rotation = run.world.rotate("turtle1", 1.57)
    run.tick(10)
    rotation.canceling = True
    reading = run.tick()
    assert rotation.outcome is Outcome.CANCELED
    assert rotation.delta == float32(-9 * 0.016)
    assert reading.pose.angular_velocity == 0.0
    assert reading.remaining is None
    assert run.log() == [("info", "Rotation goal canceled")]


def test_velocity_command_aborts_a_rotation(run: Run) -> None:
    rotation = run.world.rotate("turtle1", 1.57)
    run.tick(10)
    run.drive(2.0)
    assert rotation.outcome is Outcome.ABORTED
    assert rotation.delta == float32(-9 * 0.016)
    assert run.log() == [("warn", "Velocity command received during rotation goal. Aborting goal")]
    pose = run.tick().pose
    assert (pose.linear_velocity, pose.angular_velocity) == (2.0, 0.0)


def test_new_goal_aborts_the_running_one(run: Run) -> None:
    first = run.world.rotate("turtle1", 1.57)
    run.tick(10)
    second = run.world.rotate("turtle1", -1.57)
    text = "Rotation goal received before a previous goal finished. Aborting previous goal"
    assert run.log() == [("warn", text)]
    assert (first.outcome, second.outcome) == (Outcome.ABORTED, None)
    assert run.tick().pose.angular_velocity == -1.0


@pytest.mark.parametrize("end", ["kill", "reset"])
def test_rotation_is_aborted_when_its_turtle_goes(run: Run, end: str) -> None:
    rotation = run.world.rotate("turtle1", 1.57)
    if end == "kill":
        run.world.kill("turtle1")
    else:
        run.world.reset(run.now)
    assert rotation.outcome is Outcome.ABORTED


# Numbers that are none


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf])
def test_numbers_that_are_not_finite_are_refused_with_an_error(run: Run, bad: float) -> None:
    run.drive(bad)
    run.drive(0.0, turning=bad)
    run.world.teleport_absolute("turtle1", 1.0, bad, 0.0)
    run.world.teleport_relative("turtle1", 1.0, bad)
    assert run.world.spawn("anna", bad, 1.0, 0.0, run.now) == ""
    assert run.world.rotate("turtle1", bad).outcome is Outcome.ABORTED
    log = run.log()
    assert [level for level, _ in log] == ["error"] * 6
    assert log[0][1] == f"Ignored cmd_vel of [turtle1]: its numbers must be finite, not [{bad}, 0.0, 0.0]"
    assert run.tick().pose == (MIDDLE, MIDDLE, 0.0, 0.0, 0.0)


# Whatever comes, what always holds

single = st.floats(width=32, allow_nan=False, allow_infinity=False)
double = st.floats(allow_nan=False, allow_infinity=False)


@given(double)
def test_normalised_angle_is_in_range_and_the_same_direction(angle: float) -> None:
    result = normalise(angle)
    assert -math.pi <= result < math.pi
    assert math.cos(result) == pytest.approx(math.cos(math.remainder(angle, math.tau)), abs=1e-9)
    if -math.pi <= angle < math.pi:
        assert result == angle


@given(st.lists(st.tuples(st.sampled_from("abcd"), double, double, double), max_size=8))
def test_turtle_is_on_the_field_after_every_tick(orders: list[tuple[str, float, float, float]]) -> None:
    run = Run()
    for kind, a, b, c in orders:
        if kind == "a":
            run.world.command("turtle1", a, b, c, run.now)
        elif kind == "b":
            run.world.teleport_absolute("turtle1", a, b, c)
        elif kind == "c":
            run.world.teleport_relative("turtle1", a, b)
        else:
            run.world.spawn("", a, b, c, run.now)
        run.now += TICK
        for reading in run.world.tick(run.now).values():
            assert 0 <= reading.pose.x <= EXTENT
            assert 0 <= reading.pose.y <= EXTENT
            assert abs(reading.pose.theta) <= float32(math.pi)
            assert reading.pose.linear_velocity >= 0


@given(single, single)
def test_every_rotation_arrives(start: float, goal: float) -> None:
    run = Run()
    run.world.teleport_absolute("turtle1", 5, 5, start)
    run.tick()
    rotation = run.world.rotate("turtle1", goal)
    for _ in range(200):
        run.tick()
    assert rotation.outcome is Outcome.SUCCEEDED
    assert abs(rotation.delta) <= math.pi + 0.02


# The picture


def pixels(run: Run, background: tuple[int, int, int] = (69, 86, 255)) -> np.ndarray:
    return np.array(picture.draw(run.world.scene(), background))


def test_picture_shows_background_trail_and_turtle(run: Run) -> None:
    run.world.teleport_absolute("turtle1", 9.0, MIDDLE, 0.0)
    run.tick()
    seen = pixels(run, (10, 20, 30))
    assert seen.shape == (SIZE, SIZE, 3)
    assert tuple(seen[5, 5]) == (10, 20, 30)
    assert tuple(seen[250, 300]) == PEN
    around = seen[235:265, 390:420].reshape(-1, 3)
    assert (around != (10, 20, 30)).any(axis=1).mean() > 0.9  # its shell


def test_turtle_looks_where_it_heads(run: Run) -> None:
    right = pixels(run)
    run.world.teleport_relative("turtle1", 0.0, math.pi / 2)
    run.tick()
    up = pixels(run)
    box = slice(220, 281)
    assert not np.array_equal(right[box, box], up[box, box])
    turned = np.rot90(right[box, box])
    assert np.abs(turned.astype(int) - up[box, box]).mean() < 12


def test_turtles_have_shells_of_different_colours(run: Run) -> None:
    for number in range(1, len(picture.SHELLS)):
        run.world.spawn("", number, 1.0, 0.0, run.now)
    figures = run.world.scene().figures
    assert sorted(figure.shell for figure in figures) == list(range(len(picture.SHELLS)))
    images = {picture.turtle_image(figure.shell, 0).tobytes() for figure in figures}
    assert len(images) == len(picture.SHELLS)


def test_picture_does_not_change_afterwards(run: Run) -> None:
    scene = run.world.scene()
    before = np.array(picture.draw(scene, WHITE))
    run.world.teleport_absolute("turtle1", 1.0, 1.0, 0.0)
    run.tick()
    assert np.array_equal(before, np.array(picture.draw(scene, WHITE)))


def test_turtle_outside_the_field_can_be_drawn(run: Run) -> None:
    run.world.spawn("far", 3e38, -3e38, 1e30, run.now)
    assert pixels(run).shape == (SIZE, SIZE, 3)
