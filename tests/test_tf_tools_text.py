"""What tf2's programs read and print, and how a tree of frames is laid out, without ROS."""

from __future__ import annotations

import itertools
import math
import random
from types import SimpleNamespace
from typing import Any

import pytest

from course_kit.lab.tf_tools import echo_text, static_arguments
from course_kit.lab.tf_tools.delays import ChainDelay, Delays, results
from course_kit.lab.tf_tools.echo_text import Wanted, WrongArgument, transform_lines
from course_kit.lab.tf_tools.frame_cards import cards, in_words
from course_kit.lab.tf_tools.frames import Frame, dot, from_yaml, loops, roots
from course_kit.lab.tf_tools.rotations import matrix, quaternion, roll_pitch_yaw
from course_kit.robots.tf.chain import chain_between
from course_kit.ros.graph.drawing import text_width

NAMED = ["--frame-id", "a", "--child-frame-id", "b"]
# What a buffer tells of a frame that moves, and of one that does not.
TOLD = """\
base_link: 
  parent: 'odom'
  broadcaster: 'default_authority'
  rate: 20.203
  most_recent_transform: 1789316146.982724
  oldest_transform: 1789316141.983575
  buffer_length: 4.999
laser: 
  parent: 'base_link'
  broadcaster: 'default_authority'
  rate: 10000.000
  most_recent_transform: 0.000000
  oldest_transform: 0.000000
  buffer_length: 0.000
"""  # noqa: W291 - as tf2 writes it


def stamped(position: tuple[float, ...], turn: tuple[float, ...], sec: int = 0, nanosec: int = 0) -> Any:
    return SimpleNamespace(
        header=SimpleNamespace(stamp=SimpleNamespace(sec=sec, nanosec=nanosec)),
        transform=SimpleNamespace(
            translation=SimpleNamespace(**dict(zip("xyz", position, strict=True))),
            rotation=SimpleNamespace(**dict(zip("xyzw", turn, strict=True))),
        ),
    )


def test_roll_pitch_and_yaw_are_what_a_quaternion_was_made_of() -> None:
    chance = random.Random(1)
    for _ in range(200):
        angles = chance.uniform(-3.1, 3.1), chance.uniform(-1.5, 1.5), chance.uniform(-3.1, 3.1)
        assert roll_pitch_yaw(matrix(quaternion(*angles))) == pytest.approx(angles, abs=1e-9)
    up = roll_pitch_yaw(((0.0, 0.0, 1.0), (0.0, 1.0, 0.0), (-1.0, 0.0, 0.0)))
    assert up == pytest.approx((0.0, math.pi / 2, 0.0))
    turned = matrix((0.0, 0.0, 1.4, 1.4))  # of another length
    assert [value for row in turned for value in row] == pytest.approx([0, -1, 0, 1, 0, 0, 0, 0, 1], abs=1e-9)


def test_a_transform_is_printed_with_the_precision_that_is_asked_for() -> None:
    lines = transform_lines(stamped((0.3, 0.0, -1.0), (0.0, 0.0, 0.0, 1.0), 7, 50_000), precision=1)
    assert lines[:3] == [
        "At time 7.50000",
        "- Translation: [0.3, 0.0, -1.0]",
        "- Rotation: in Quaternion (xyzw) [0.0, 0.0, 0.0, 1.0]",
    ]
    assert lines[-1] == "    0.0    0.0    0.0    1.0"


def test_the_rate_of_an_echo_stands_alone_or_behind_its_option() -> None:
    assert echo_text.read_arguments(["a", "b"]) == Wanted("a", "b")
    assert echo_text.read_arguments(["a", "b", "5"]) == echo_text.read_arguments(["a", "b", "-r", "5"])
    assert echo_text.read_arguments(["a", "b", "-t", "2.5", "-p", "6"]) == Wanted("a", "b", 1.0, 2.5, 6)


@pytest.mark.parametrize(
    ("words", "told", "status"),
    [
        (["a"], "", 1),
        (["a", "b", "fast"], "Failed to convert rate argument 'fast' to a floating-point number", 2),
        (["a", "b", "-r", "0"], "Rate must be positive", 2),
        (["a", "b", "-r", "nan"], "Failed to convert rate argument 'nan' to a floating-point number", 2),
        (["a", "b", "-t", "noon"], "Failed to convert time argument 'noon' to a floating-point number", 3),
        (["a", "b", "-p", "1.5"], "Failed to convert precision argument '1.5' to an integer", 4),
        (["a", "b", "-p", "-1"], "Precision must be non-negative", 4),
        (["a", "b", "-r"], "Unknown argument: -r", 5),
        (["a", "b", "1", "2"], "Unknown argument: 2", 5),
    ],
)
def test_what_an_echo_cannot_use_is_told_with_its_exit_status(words: list[str], told: str, status: int) -> None:
    with pytest.raises(WrongArgument) as error:
        echo_text.read_arguments(words)
    assert (str(error.value), error.value.status) == (told, status)


def test_a_static_transform_is_read_from_options_and_from_both_old_rows() -> None:
    read = static_arguments.read_arguments
    assert read(NAMED) == static_arguments.StaticTransform("a", "b", (0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0))
    assert read([*NAMED, "--x", "-1", "--qz", "1", "--qw", "0"]).rotation == (0.0, 0.0, 1.0, 0.0)
    turned = read([*NAMED, "--roll", "0.1", "--pitch", "0.2", "--yaw", "0.3"])
    old = read(["0", "0", "0", "0.3", "0.2", "0.1", "a", "b"])  # yaw comes first
    assert old.rotation == turned.rotation == quaternion(0.1, 0.2, 0.3)
    assert old.is_old_style and not turned.is_old_style
    assert read(["1", "2", "3", "0", "0", "0", "1", "a", "b"]).position == (1.0, 2.0, 3.0)


@pytest.mark.parametrize(
    ("words", "told"),
    [
        ([], "Frame id must not be empty"),
        (["--frame-id", "a"], "Child frame id must not be empty"),
        ([*NAMED, "--x"], "Not enough arguments for --x"),
        ([*NAMED, "--x", "one"], "Failed to parse --x argument as float"),
        ([*NAMED, "--yaw", "nan"], "Failed to parse --yaw argument as float"),
        ([*NAMED, "--yaw", "1", "--qz", "1"], "Cannot specify both quaternion and Euler rotations"),
        ([*NAMED, "--frame_id", "a"], "Extra unparsed arguments on command-line"),
        (["0", "0", "0", "0", "0", "up", "a", "b"], "Failed to parse roll argument as float"),
        (["--x", "1", *"000000ab"], "Cannot specify both new-style (flags) and old-style (arguments)"),
    ],
)
def test_what_is_no_static_transform_is_told_in_the_words_of_the_real_program(words: list[str], told: str) -> None:
    with pytest.raises(ValueError) as error:
        static_arguments.read_arguments(words)
    assert str(error.value) == told


def test_delays_and_rates_are_those_of_the_messages() -> None:
    delays = Delays()
    assert delays.broadcaster_lines() == []
    for step in range(5):
        now = 100.0 + step * 0.1
        delays.take([("odom", now - 0.02), ("laser", now - 0.04 - 0.01 * step)], now)
    author = "<no authority available>"
    assert results(delays, None, [], ChainDelay()) == [
        "", "", "", "RESULTS: for all Frames", "", "Frames:",
        f"Frame: laser, published by {author}, Average Delay: 0.06, Max Delay: 0.08",
        f"Frame: odom, published by {author}, Average Delay: 0.02, Max Delay: 0.02",
        "", "All Broadcasters:", f"Node: {author} 12.5 Hz, Average Delay: 0.04 Max Delay: 0.05",
    ]  # fmt: skip
    assert len(delays.frame_lines(["odom", "map"])) == 1
    old = ChainDelay()
    old.take(2.0)
    old.take(1.0)
    assert old.average == pytest.approx(0.0298) and old.longest == 2.0


def test_a_chain_leads_over_the_lowest_frame_that_both_are_in() -> None:
    parent_of = {"odom": "map", "base": "odom", "laser": "base", "goal": "odom", "door": "hall", "a": "b", "b": "a"}.get
    assert chain_between("map", "laser", parent_of) == ["map", "odom", "base", "laser"]
    assert chain_between("laser", "map", parent_of) == ["laser", "base", "odom", "map"]
    assert chain_between("goal", "laser", parent_of) == ["goal", "odom", "base", "laser"]
    assert chain_between("laser", "laser", parent_of) == ["laser"]
    assert chain_between("laser", "door", parent_of) == chain_between("map", "a", parent_of) == []


def test_what_a_buffer_tells_is_read_and_written_for_graphviz() -> None:
    moving, static = from_yaml(TOLD, 1789316147.0)
    assert (moving.parent, moving.rate, moving.is_static) == ("odom", 20.203, False)
    assert moving.age == pytest.approx(0.017, abs=1e-3)
    assert static == Frame("laser", "base_link", is_static=True)
    assert dot(TOLD, 1789316147.5) == (
        "digraph G {\n"
        '"odom" -> "base_link"[label=" Broadcaster: default_authority\\nAverage rate: 20.203\\nBuffer length: 4.999\\n'
        'Most recent transform: 1789316146.982724\\nOldest transform: 1789316141.983575\\n"];\n'
        '"base_link" -> "laser"[label=" Broadcaster: default_authority\\nAverage rate: 10000.0\\nBuffer length: 0.0\\n'
        'Most recent transform: 0.0\\nOldest transform: 0.0\\n"];\n'
        "edge [style=invis];\n"
        ' subgraph cluster_legend { style=bold; color=black; label ="view_frames Result";\n'
        '"Recorded at time: 1789316147.5"[ shape=plaintext ] ;\n'
        '}->"odom";\n}'
    )
    assert from_yaml("[]", 0.0) == from_yaml("", 0.0) == []
    assert dot("[]", 0.0) == 'digraph G { "No tf data received" }'


def forest(seed: int) -> list[Frame]:
    """Some trees, and sometimes a loop."""
    chance = random.Random(seed)
    names = [f"frame_{number}" for number in range(chance.randrange(2, 30))]
    parents = {name: chance.choice([*names[:number], f"root_{number}"]) for number, name in enumerate(names)}
    if chance.random() < 0.3:
        parents[names[0]] = names[-1]
    return [Frame(name, parent, (f"/node_{len(name)}",), rate=10.0, age=0.0) for name, parent in parents.items()]


@pytest.mark.parametrize("seed", range(30))
def test_no_box_of_a_tree_lies_on_another_and_children_stand_to_the_right(seed: int) -> None:
    frames = forest(seed)
    made, wires, width, height = cards(frames, text_width)
    assert len(made) == len({name for frame in frames for name in (frame.name, frame.parent)})
    assert len(wires) == len(frames)
    boxes = {card.box.key: card.box for card in made}
    for one, other in itertools.combinations(boxes.values(), 2):
        beside = one.x + one.width < other.x or other.x + other.width < one.x
        assert beside or one.y + one.height < other.y or other.y + other.height < one.y
    for box in boxes.values():
        assert box.x >= 0 and box.y >= 0 and box.x + box.width <= width + 1e-9 and box.y + box.height <= height + 1e-9
    back = [frame for frame in frames if boxes[frame.name].x <= boxes[frame.parent].x]
    assert len(back) == len(loops(frames))


def test_a_loop_is_told_as_wrong() -> None:
    frames = [Frame("a", "b"), Frame("b", "c"), Frame("c", "a"), Frame("d", "a", is_static=True)]
    assert roots(frames) == [] and [sorted(loop) for loop in loops(frames)] == [["a", "b", "c"]]
    assert in_words(frames) == (
        "4 frames. a in b (once). Wrong: in a loop: it is in itself. b in c (once). Wrong: in a loop: it is in itself. "
        "c in a (once). Wrong: in a loop: it is in itself. d in a (static)."
    )


def test_a_frame_that_comes_no_more_is_told_as_wrong() -> None:
    assert "base in odom (10 Hz, from /robot). Wrong: last 3 s ago." in in_words(
        [Frame("base", "odom", ("/robot",), rate=10.0, age=3.0)]
    )
    assert "Wrong" not in in_words([Frame("base", "odom", rate=0.5, age=3.0), Frame("laser", "base", is_static=True)])
