"""A robot put into one picture by what its messages tell: frames, true places, laser, maps; what is sent anew."""

from __future__ import annotations

import io
import math

import numpy as np
import pytest
from PIL import Image

from course_kit.robots.robot import picture
from course_kit.robots.robot.picture import Cells, Seen
from course_kit.robots.robot.world import Place, Wall, World
from course_kit.views.live.robot_frames import Frames
from course_kit.views.live.robot_layers import Layers
from course_kit.views.live.seen_robot import LONGEST, SeenRobot, Trail

QUARTER = math.pi / 2
ROOM = World(
    "room", (Wall(0.0, 2.0, 6.0, 0.1), Wall(0.0, -2.0, 6.0, 0.1)), (), (1.0, 0.5, QUARTER), ((2.0, 1.0),)
)  # fmt: skip


def near(place: Place) -> object:
    return pytest.approx(place, abs=1e-9)


def test_frames_lead_up_and_down_to_one_another() -> None:
    frames = Frames()
    frames.add("map", "odom", (1.0, 0.0, QUARTER), 0.0)
    frames.add("odom", "base_link", (2.0, 0.0, 0.0), 0.0)
    frames.add("base_link", "base_scan", (0.0, 0.1, 0.0), 0.0)
    assert frames.find("base_scan", "map") == near((0.9, 2.0, QUARTER))
    assert frames.find("map", "base_link") == near((-2.0, 1.0, -QUARTER))
    assert frames.root("base_scan") == "map"
    assert frames.find("base_scan", "elsewhere") is None


def test_frames_know_where_they_were_and_begin_anew_with_time() -> None:
    frames = Frames()
    for time in (1.0, 1.1, 1.2):
        frames.add("odom", "base_link", (time, 0.0, 0.0), time)
    frames.add("odom", "base_link", (9.0, 0.0, 0.0), 1.15)  # late, so it says nothing new
    assert frames.find("base_link", "odom", 1.09) == near((1.1, 0.0, 0.0))
    assert frames.find("base_link", "odom") == near((1.2, 0.0, 0.0))
    frames.add("odom", "base_link", (0.0, 0.0, 0.0), 0.0)
    assert frames.find("base_link", "odom", 1.2) == near((0.0, 0.0, 0.0))


def test_a_loop_of_frames_ends() -> None:
    frames = Frames()
    frames.add("a", "b", (1.0, 0.0, 0.0), 0.0)
    frames.add("b", "a", (1.0, 0.0, 0.0), 0.0)
    assert frames.root("a") in ("a", "b") and frames.find("a", "c") is None


def seen(robot: SeenRobot, truth: Place | None = None) -> Seen:
    robot.look(truth)
    found = robot.seen()
    assert found is not None
    return found


def driven(*place: float) -> SeenRobot:
    """A robot whose wheels say that it is there."""
    robot = SeenRobot("robot")
    robot.drive("odom", "base_link", (place[0], place[1], place[2]), 1.0)
    return robot


def test_nothing_is_seen_of_a_robot_that_has_not_said_where_it_is() -> None:
    robot = SeenRobot("robot")
    robot.look()
    assert robot.seen() is None


def test_without_its_true_place_it_is_where_its_outermost_frame_has_it() -> None:
    robot = driven(1.0, 0.0, 0.0)
    assert seen(robot).place == near((1.0, 0.0, 0.0)) and robot.frame == "odom"
    robot.frames.add("map", "odom", (0.0, 3.0, QUARTER), 1.0)
    assert seen(robot).place == near((0.0, 4.0, QUARTER)) and robot.frame == "map"
    assert robot.trail.steps == [pytest.approx((0.0, 4.0))]  # it has not driven from one frame to the other


def test_the_drift_of_its_odometry_is_seen_beside_its_true_place() -> None:
    robot = driven(0.0, 0.0, 0.0)
    assert seen(robot, ROOM.start).estimate == near(ROOM.start)
    robot.drive("odom", "base_link", (1.0, 0.2, 0.0), 2.0)
    found = seen(robot, (1.0, 1.4, QUARTER))
    assert found.place == (1.0, 1.4, QUARTER)
    assert found.estimate == near((0.8, 1.5, QUARTER))


@pytest.mark.parametrize("made_of_the_world", [True, False])
def test_a_map_lies_in_the_world_or_where_the_robot_began(made_of_the_world: bool) -> None:
    robot = driven(0.0, 0.0, 0.0)
    seen(robot, ROOM.start)
    robot.frames.add("map", "odom", ROOM.start if made_of_the_world else (0.0, 0.0, 0.0), 1.0)
    assert seen(robot, ROOM.start).estimate == near(ROOM.start)
    assert robot.named((2.0, 1.0, 0.0)) == near((2.0, 1.0, 0.0) if made_of_the_world else (0.5, -1.0, -QUARTER))
    robot.drive("odom", "base_link", (1.0, 0.0, 0.0), 2.0)  # what its localization has wrong from now on stays so
    assert seen(robot, ROOM.start).estimate == near((1.0, 1.5, QUARTER))


def test_an_estimate_and_a_goal_lie_in_their_frames() -> None:
    robot = driven(1.0, 0.0, 0.0)
    robot.frames.add("map", "odom", (1.0, 1.0, 0.0), 1.0)
    robot.lay("goal", "base_link", (1.0, 0.0, 0.0))
    robot.lay("estimate", "map", (0.5, 0.5, 0.0))
    robot.lay("plan", "odom", np.array([[0.0, 0.0], [1.0, 0.0]]))
    robot.lay("particles", "odom", np.array([[0.0, 0.0, 0.3]]))
    robot.lay("map", "base_link", Cells(np.zeros((2, 2), np.int8), 1.0, (0.0, 2.0), QUARTER))
    found = seen(robot)
    assert found.cells is not None and (*found.cells.corner, found.cells.heading) == near((2.0, 3.0, QUARTER))
    assert found.goal == near((3.0, 1.0, 0.0)) and found.estimate == near((0.5, 0.5, 0.0))
    assert np.allclose(found.path, [[1.0, 1.0], [2.0, 1.0]]) and np.allclose(found.particles, [[1.0, 1.0, 0.3]])


def test_what_lies_in_an_unknown_frame_is_not_drawn_and_told() -> None:
    robot = driven(1.0, 0.0, 0.0)
    robot.lay("plan", "map", np.array([[0.0, 0.0]]))
    assert len(seen(robot).path) == 0
    assert robot.notes == [
        "The plan is not drawn: it is in frame 'map', and no transform on /tf or /tf_static says where that is in "
        "'odom'."
    ]
    robot.frames.add("map", "odom", (0.0, 0.0, 0.0), 1.0)
    assert len(seen(robot).path) == 1 and robot.notes == []


def test_a_scan_is_seen_from_where_the_robot_was_then() -> None:
    robot = driven(0.0, 0.0, 0.0)
    robot.frames.add("base_link", "base_scan", (-0.1, 0.0, 0.0), 0.0)
    robot.scan("base_scan", 1.0, np.array([[1.0, 0.0]]))
    robot.drive("odom", "base_link", (0.0, 0.0, QUARTER), 1.2)  # it has turned meanwhile
    assert np.allclose(seen(robot).hits, [[0.9, 0.0]])
    assert np.allclose(seen(robot, (1.0, 1.0, 0.0)).hits, [[1.0, 0.1]])  # the same, from its true place
    robot.drive("odom", "base_link", (0.0, 0.0, QUARTER), 9.0)  # its laser says nothing any more
    assert len(seen(robot).hits) == 0


def test_a_trail_has_no_step_over_a_jump_and_does_not_grow_for_ever() -> None:
    trail = Trail()
    for step in range(3):
        trail.go((0.1 * step, 0.0, 0.0))
    trail.go((0.201, 0.0, 0.0))  # no step
    version = trail.version
    assert len(trail.steps) == 3
    trail.go((5.0, 5.0, 0.0))
    assert trail.steps == [(5.0, 5.0)] and trail.version != version
    for step in range(2 * LONGEST):
        trail.go((5.0 + 0.05 * step, 5.0, 0.0))
    assert len(trail.steps) <= LONGEST


CELLS = Cells(np.array([[0, 100, -1], [0, 0, 100]], np.int8), 1.0, (-1.0, -1.0))


def test_only_what_is_new_is_sent() -> None:
    layers, trail = Layers(), Trail()
    trail.go((0.0, 0.0, 0.0))
    robot = Seen((0.0, 0.0, 0.0), hits=[(1.0, 2.0)], cells=CELLS)

    def news() -> list[str]:
        return [layer.told["layer"] for layer in layers.news(ROOM, [robot], [trail], text="now")]

    assert news() == ["ground", "robots", "text", "hits", "path", "particles", "map", "trail"]
    assert news() == []
    trail.go((0.1, 0.0, 0.0))
    robot.hits = [(1.0, 2.5)]
    assert news() == ["hits", "trail"]
    layers.forget()
    assert len(news()) == 8


def test_a_trail_is_sent_step_by_step_and_whole_after_a_jump() -> None:
    layers, trail = Layers(), Trail()
    robot = Seen((0.0, 0.0, 0.0))

    def sent() -> tuple[int, int]:
        (layer,) = [one for one in layers.news(None, [robot], [trail]) if one.told["layer"] == "trail"]
        return layer.told["from"], len(layer.data) // 8

    for place in ((0.0, 0.0, 0.0), (0.1, 0.0, 0.0)):
        trail.go(place)
    assert sent() == (0, 2)
    trail.go((0.2, 0.0, 0.0))
    assert sent() == (2, 1)
    trail.go((5.0, 0.0, 0.0))
    assert sent() == (0, 1)


def test_a_map_is_sent_as_a_picture_of_its_cells_the_lowest_row_first() -> None:
    (sent,) = [one for one in Layers().news(ROOM, [Seen((0, 0, 0), cells=CELLS)], []) if one.told["layer"] == "map"]
    drawn = np.array(Image.open(io.BytesIO(sent.data)))
    assert sent.told["place"] == (-1.0, -1.0, 0.0) and sent.told["resolution"] == 1.0
    free, occupied, unknown = drawn[0]
    assert drawn.shape == (2, 3) and occupied < unknown < free and list(drawn[1]) == [free, free, occupied]


def test_what_is_shown_of_an_unknown_world_only_grows() -> None:
    layers = Layers()
    boxes = []
    for x in (0.0, 0.3, 4.0, 0.0):
        news = layers.news(None, [Seen((x, 0.0, 0.0))], [])
        boxes += [one.told["box"] for one in news if one.told["layer"] == "ground"]
    (x0, _, x1, _), (x2, _, x3, _) = boxes  # one for all small moves, and one for the large one
    assert x2 == x0 and x3 >= x1 + 3.0


def test_a_turned_map_is_drawn_where_it_lies() -> None:
    cells = Cells(np.array([[100, 0]], np.int8), 1.0, (0.0, 0.0), QUARTER)  # up from the origin, to its left
    assert cells.bounds() == pytest.approx((-1.0, 0.0, 0.0, 2.0))
    drawn = picture.draw(ROOM, [Seen((2.5, -1.0, 0.0), cells=cells)])
    scale = picture.scale_of(ROOM, [])

    def colour(x: float, y: float) -> object:
        across, down = map(round, scale.pixel(x, y))
        return drawn.getpixel((across, down))

    assert (colour(-0.5, 0.5), colour(-0.5, 1.5)) == ((85, 85, 85), (255, 255, 255))
    assert colour(0.5, 0.5) == picture.FLOOR


def test_a_picture_is_told_in_words() -> None:
    robot = Seen((1.0, 0.5, 0.0), [(0, 1)], [], [(0, 0), (3, 4)], (2.0, 1.0, 0.0), CELLS, estimate=(1.1, 0.5, 0.1))
    assert picture.in_words(ROOM, [robot]) == (
        "The world room from above: robot at (1.00, 0.50) m, heading 0.00 rad, which it takes to be (1.10, 0.50) m, "
        "heading 0.10 rad, its goal at (2.00, 1.00) m, a plan of 5.00 m, 1 hit of its laser, a map of which 83 % are "
        "known."
    )
