"""Chapter 6's exercises on what runs and what was recorded: what each asks, and how it is checked."""

from __future__ import annotations

import math
import time
from typing import Any

from rcl_interfaces.msg import Log, LoggerLevel
from rcl_interfaces.srv import SetLoggerLevels
from turtlesim.msg import Pose

from course_kit import bags
from course_kit.examining import paths
from course_kit.examining.examination import current
from course_kit.examining.exercise import exercise
from course_kit.examining.vocabulary import expect, expect_value, parts, pause, require, wait
from course_kit.examining.vocabulary_services import Client
from course_kit.examining.vocabulary_student import expect_running_node
from course_kit.faults import all_faults
from course_kit.faults.vocabulary import expect_well

DEBUG, INFO = 10, 20
MANY = 60  # lines, more than a throttle lets through
SEEDS = (9, 31, 17)
DRIVEN = ("/turtle1/cmd_vel", "/turtle1/pose")
SCANS, POSES = "/scan", "/turtle1/pose"
SET_LEVELS = "/quiet/set_logger_levels"


@exercise("debugging-1", "Who keeps, who loses", points=2, level="warm-up", timeout=5, value=True)
def who_keeps(value: Any) -> None:
    """The topic that is kept for latecomers, and the one that may lose messages."""
    kept, lossy = map(_absolute, parts(value, 2))
    for text, given, wanted, policy in (
        ("the topic that is kept for those who come later", kept, "/speed_limit", "Durability TRANSIENT_LOCAL"),
        ("the topic that may lose messages", lossy, SCANS, "Reliability BEST_EFFORT"),
    ):
        hint = f"Its publisher has {policy}: `%ros2 topic info -v` of each topic shows it."
        expect_value(text, given, wanted, hint)


def _absolute(name: Any) -> Any:
    return f"/{name.strip('/')}" if isinstance(name, str) else name


@exercise(
    "debugging-2",
    "Not so loud",
    points=3,
    level="medium",
    timeout=25,
    node_class="Quiet",
    watches={"/rosout": Log, POSES: Pose},
)
def not_so_loud() -> None:
    """It logs INFO once a second at most, and each pose when it is asked for DEBUG."""
    expect_running_node("/quiet", "Quiet")
    poses = current().watched[POSES]
    before = poses.received
    require(
        "a turtle runs beside it",
        wait(lambda: poses.received >= before + 10, 5.0),
        "No pose came on `/turtle1/pose`: `run(TurtleSim)`, and leave it running.",
    )
    began = time.time_ns()
    pause(3.0)
    infos = [line for line in _lines_since(began) if line.level >= INFO]
    expect(
        "it logs `x = …` as INFO, once a second at most",
        2 <= len(infos) <= 4 and all(line.msg.startswith("x = ") and line.level == INFO for line in infos),
        f"In 3 s it logged {len(infos)} lines{_such_as(infos)}: `throttle_duration_sec=1.0` as an argument of "
        f"`info(…)` leaves the others out.",
    )
    is_set = expect(
        "its level can be set from outside",
        _set_level(DEBUG),
        f"It has no service `{SET_LEVELS}`, or does not answer: make the node with "
        '`super().__init__("quiet", enable_logger_service=True)`.',
    )
    try:
        began = time.time_ns()
        wait(lambda: len(_details_since(began)) >= MANY, 4.0)
        details = _details_since(began)
    finally:
        if is_set:
            _set_level(INFO)
    expect(
        "at the level DEBUG it logs every pose",
        len(details) >= MANY,
        f"In 4 s, with about 250 poses, it logged {len(details)} lines as DEBUG{_such_as(details)}: `debug(…)` for "
        f"each pose, without a throttle.",
    )


def _lines_since(began: int) -> list[Any]:
    """What /quiet has logged since a time (nanoseconds)."""
    return [line.message for line in current().student.node_log().lines("quiet") if line.received >= began]


def _details_since(began: int) -> list[Any]:
    return [line for line in _lines_since(began) if line.level == DEBUG]


def _such_as(lines: list[Any]) -> str:
    return f", such as {lines[-1].msg!r}" if lines else ""


def _set_level(level: int) -> bool:
    client = Client(SET_LEVELS, SetLoggerLevels, current().student)
    response = client.ask(levels=[LoggerLevel(name="quiet", level=level)]).response
    return response is not None and all(result.successful for result in response.results)


@exercise("debugging-4", "A bag of a circle", points=2, level="medium", timeout=20, value=True)
def circle(value: Any) -> None:
    """A bag with the two topics and nothing else, in which the turtle goes round once."""
    require("the answer is the path of a bag", isinstance(value, str), f'You gave {value!r}: a text, such as "circle".')
    bag, hint = None, ""
    try:
        bag = bags.info(current().folder / value)
    except (bags.BagError, OSError) as error:
        hint = f"{error} The path is seen from the folder in which the notebook lies."
    require("there is a bag", bag is not None, hint)
    assert bag is not None
    names = sorted(topic.name for topic in bag.topics if topic.count)
    expect(
        "it has both topics and nothing else, for at least 5 s",
        names == sorted(DRIVEN) and bag.seconds >= 5.0,
        f"It has messages of {', '.join(names) or 'nothing'}, and is {bag.seconds:.1f} s long: name the topics to "
        f"`bags.record(…)`, and drive while it records.",
    )
    poses = [message for _, _, message in bags.read(bag.path, POSES)]
    turned, fastest = abs(paths.headings(poses)[-1]), paths.top_speed(poses)
    expect(
        "the turtle goes round once, at 1 m/s or more",
        turned >= 0.97 * math.tau and fastest >= 0.99,
        f"In the bag it turns by {math.degrees(turned):.0f}° and drives at {fastest:.1f} m/s at most: a circle takes "
        f"2π / angular.z seconds.",
    )


@exercise("debugging-6", "Three patients", points=5, level="harder", timeout=25, value=True)
def three_patients(value: Any) -> None:
    """The causes of three faults, the last of which is repaired."""
    for seed, cause in zip(SEEDS, parts(value, len(SEEDS)), strict=True):
        fault = all_faults.pick(seed)
        known = cause in all_faults.FAULTS if isinstance(cause, str) else False
        expect(
            f"the cause of seed {seed}",
            cause == fault.id,
            f"You gave {cause!r}. "
            + (all_faults.find(cause).evidence if known else "It is an id, as `faults.catalogue()` lists them."),
        )
    expect_well(points=2)
