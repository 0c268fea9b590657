"""The check of debugging-2: a node that logs at the right levels."""

from __future__ import annotations

import math
import re
import time
from collections.abc import Sequence
from itertools import pairwise
from typing import Any

from rcl_interfaces.msg import Log, LoggerLevel
from rcl_interfaces.srv import SetLoggerLevels
from turtlesim.msg import Pose
from turtlesim.srv import TeleportAbsolute

from course_kit.exercises.checker.assertions import chance, expect, pause, require, wait
from course_kit.exercises.checker.checks import check_of
from course_kit.exercises.checker.examination import current
from course_kit.exercises.checker.service_assertions import Client
from course_kit.exercises.checker.student_assertions import expect_running_node, lines_of
from course_kit.ros.observing.node_log import Line

DEBUG, INFO = 10, 20
POSES, SET_LEVELS, TELEPORT = "/turtle1/pose", "/quiet/set_logger_levels", "/turtle1/teleport_absolute"
LISTENED, LISTENED_LONGEST = 3.0, 6.0  # seconds, for INFO
SPACING, BEHIND = 0.85, 0.3  # seconds between two lines, on average, and that the first may be late
MANY = 60  # poses, about a second
NEARLY_ALL = 0.9
STRETCH, FEWEST = 0.5, 20  # seconds, and the poses that come in them on a busy machine
TRIES = 4  # of which one must show all: a busy machine may lose some
LATE = 0.1  # seconds that a busy node may be behind
AHEAD = 60  # lines among which a pose's is looked for: what else is logged stands between
QUIET = 0.4  # seconds without a line of DEBUG
LOOK = 0.05  # seconds from one look at all lines to the next
DRIVEN = 0.3  # metres between two poses that came, at most, for the turtle to have driven and not jumped
ASKED = 4  # times that its level is to be set: a busy machine may not answer in time
NUMBER = re.compile(r"(?<![\w.])[-+]?\d+(?:\.(\d*))?(?:e[-+]?\d+)?")

Poses = list[tuple[int, float]]  # when each came (nanoseconds), and its x


@check_of("debugging-2", watches={"/rosout": Log})
def not_so_loud() -> None:
    """It logs INFO once a second at most, and each pose when it is asked for DEBUG."""
    expect_running_node("/quiet", "Quiet")
    turtle = _Turtle()
    try:
        began = time.time_ns()
        infos = _fault_of_infos(turtle, "")
        early = _details(began, time.time())
        is_set = _set_level(DEBUG)
        try:
            began = time.time_ns()
            details = _lost_details(turtle, TRIES if is_set else 1)
            infos = infos or (_fault_of_infos(turtle, "At the level DEBUG: ", began) if is_set else "")
        finally:
            is_set = is_set and _set_level(INFO)
        falls_silent = wait(_is_quiet, 3.0, poll=LOOK)
    finally:
        turtle.go_home()
    expect("it logs `x = …` as INFO, once a second at most", not infos, infos)
    if not is_set:
        hint = _why_not_set()
    elif early:
        hint = (
            f"Before its level was set, it logged {len(early)} lines as DEBUG{_such_as(early)}: set no level in the "
            f'class. One that was set before stays until the node ends: `set_log_level("/quiet", "INFO")`.'
        )
    else:
        hint = (
            "Set back to INFO, it goes on to log DEBUG: leave its level to who sets it, and log details by `debug(…)`."
        )
    expect("its level is INFO, and can be set from outside", is_set and falls_silent and not early, hint)
    expect("at the level DEBUG it logs every pose", not details, f"{details}: `debug(…)` for each, without a throttle.")


class _Turtle:
    """The turtle that runs beside the student's node."""

    def __init__(self) -> None:
        self._heard = current().student.listen(POSES, Pose)
        comes = wait(lambda: len(self._heard) >= 10, 5.0)
        client = Client(TELEPORT, TeleportAbsolute, current().student) if comes else None
        self._home = self._heard.last if comes else Pose()
        can_jump = client is not None and client.ask(**_place(self._home)).response is not None
        hint = "No pose came on `/turtle1/pose`" if not comes else f"Nobody serves `{TELEPORT}`"
        require("a turtle runs beside it", can_jump, f"{hint}: `run(TurtleSim)`, and leave it running.")
        assert client is not None
        self._client, self._x = client, self._home.x

    def jump(self) -> None:
        """Be somewhere else, where x is neither what it was nor y."""
        while abs((x := chance().uniform(1.5, 9.5)) - self._x) < 1.5:
            pass
        while abs((y := chance().uniform(1.5, 9.5)) - x) < 1.5:
            pass
        self._x = x
        self._client.ask(x=x, y=y, theta=chance().uniform(-3.0, 3.0))

    def go_home(self) -> None:
        """Be where it was before the check."""
        self._client.ask(**_place(self._home))

    def poses(self, since: int, until: float = math.inf) -> Poses:
        """The poses that came between two times (nanoseconds)."""
        return [(when, pose.x) for when, pose in self._heard.arrivals if since <= when <= until]

    def xs(self, since: int, until: float = math.inf) -> list[float]:
        """The x of each pose that came between two times (nanoseconds)."""
        return [x for _, x in self.poses(since, until)]


def _place(pose: Pose) -> dict[str, float]:
    return {"x": pose.x, "y": pose.y, "theta": pose.theta}


def _fault_of_infos(turtle: _Turtle, when: str, began: int = 0) -> str:
    """Nothing if it logs `x = …` as INFO, and neither that nor anything else more often than once a second.

    Without a time at which that began (nanoseconds), it begins now, with a jump.
    """
    if not began:
        began = time.time_ns()
        turtle.jump()
        pause(LISTENED)
    wait(lambda: _told(began), LISTENED_LONGEST - (time.time_ns() - began) * 1e-9, poll=LOOK)
    told, seconds = _told(began), (time.time_ns() - began) * 1e-9
    others = [line for line in _lines_since(began, INFO) if line not in told]
    wrong = [line for line in told if not _tells_of(turtle.xs(*_about(line)), line.message.msg[4:])]
    span = _logged_at(told[-1]) - _logged_at(told[0]) if told else 0.0
    hint = f"{when}In {seconds:.0f} s it logged {len(told)} lines `x = …` as INFO or above{_such_as(told)}"
    if not told:
        seen = f", but {others[-1].message.msg!r}" if others else ""
        return f"{hint}{seen}: at least one in five seconds, beginning with `x = `."
    if wrong:
        return (
            f"{hint}, and no pose with the x of {wrong[-1].message.msg!r} had just come: log `pose.x` of the message."
        )
    if any(line.message.level != INFO for line in told):
        return f"{hint}, not all of them as INFO: `self.get_logger().info(…)`."
    if len(others) > seconds + 2:
        return (
            f"{when}In {seconds:.0f} s it logged {len(others)} other lines as INFO or above{_such_as(others)}: what is "
            f"for details is DEBUG."
        )
    if span < SPACING * (len(told) - 1) - BEHIND:
        return f"{hint}: `throttle_duration_sec=1.0` as an argument of `info(…)` leaves the others out."
    return ""


def _lost_details(turtle: _Turtle, tries: int) -> str:
    """Nothing if it logs, as DEBUG, the x of the poses that come, once at least; else what is seen instead."""
    for _ in range(tries):
        began = time.time_ns()
        turtle.jump()
        wait(lambda: len(turtle.xs(began)) >= MANY, 3.0, poll=LOOK)  # noqa: B023  (it ends before the loop goes on)
        poses, until = turtle.poses(began), time.time() + LATE
        if wait(lambda: _has_all(poses, _followed(poses, _details(began, until))), 1.0, poll=LOOK):  # noqa: B023
            return ""
    seen = _details(began, until)
    return (
        f"While {len(poses)} poses came it logged {len(seen)} lines as DEBUG{_such_as(seen)}, and "
        f"{len(_followed(poses, seen))} of them have the x of the poses"
    )


def _details(since: int, until: float) -> list[Line]:
    """What was logged as DEBUG between two times: nanoseconds, seconds."""
    return [line for line in _lines_since(since) if line.message.level == DEBUG and _logged_at(line) <= until]


def _followed(poses: Poses, lines: Sequence[Line]) -> list[Line]:
    """The lines that have the x of a pose, in their order, one for each."""
    place, found = 0, []
    for _, x in poses:
        near = range(place, min(place + AHEAD, len(lines)))
        line = next((number for number in near if _shows(lines[number].message.msg, x)), None)
        if line is not None:
            place = line + 1
            found.append(lines[line])
    return found


def _has_all(poses: Poses, lines: Sequence[Line]) -> bool:
    """Return True if there are as many lines as poses, in a stretch at least: a busy node loses poses, many at once."""
    if len(lines) >= NEARLY_ALL * len(poses):
        return True
    for line in lines:
        begin = _logged_at(line)
        came = sum(begin <= when * 1e-9 < begin + STRETCH for when, _ in poses)
        logged = sum(begin <= _logged_at(one) < begin + STRETCH for one in lines)
        if came >= FEWEST and logged >= NEARLY_ALL * came:
            return True
    return False


def _shows(text: str, x: float) -> bool:
    """Return True if a number in a text is x, to as many decimals as it has."""
    found = [(float(match[0]), len(match[1] or "")) for match in NUMBER.finditer(text)]
    return any(abs(number - x) <= 1.01 * 10.0**-decimals + 1e-4 for number, decimals in found)


def _tells_of(xs: Sequence[float], text: str) -> bool:
    """Return True if a number in a text is one of these x, or lies between two: a busy machine loses poses."""
    numbers = [float(match[0]) for match in NUMBER.finditer(text)]
    drives = [sorted(step) for step in pairwise(xs) if abs(step[1] - step[0]) < DRIVEN]
    return any(_shows(text, x) for x in xs) or any(low < n < high for n in numbers for low, high in drives)


def _is_quiet() -> bool:
    lines = _lines_since(time.time_ns() - int(QUIET * 1e9))
    return not any(line.message.level == DEBUG for line in lines)


def _told(since: int) -> list[Line]:
    return [line for line in _lines_since(since, INFO) if line.message.msg.startswith("x = ")]


def _lines_since(since: int, level: int = 0) -> list[Line]:
    """What the node has logged since a time (nanoseconds), at a level or above it."""
    return [line for line in lines_of("quiet") if line.received >= since and line.message.level >= level]


def _logged_at(line: Line) -> float:
    stamp: Any = line.message.stamp
    return float(stamp.sec + stamp.nanosec * 1e-9)


def _about(line: Line) -> tuple[int, float]:
    """From when to when a pose came that a line may tell of: also the last one of a second, as a timer has it."""
    return int((_logged_at(line) - 1.5) * 1e9), line.received + 0.5e9


def _such_as(lines: Sequence[Line]) -> str:
    return f", such as {lines[-1].message.msg!r}" if lines else ""


def _set_level(level: int) -> bool:
    client = Client(SET_LEVELS, SetLoggerLevels, current().student)
    for _ in range(ASKED):
        response = client.ask(levels=[LoggerLevel(name="quiet", level=level)]).response
        if response is not None:
            return all(result.successful for result in response.results)
    return False


def _why_not_set() -> str:
    """What to do if its level could not be set."""
    if any(SET_LEVELS in node.service_servers for node in current().student.offered()):
        return (
            f"`{SET_LEVELS}` did not set it in time: a callback of the node takes long, or the machine is busy. If no "
            f"callback waits or loops, run this cell again."
        )
    return (
        f'It has no service `{SET_LEVELS}`: make the node with `super().__init__("quiet", enable_logger_service=True)`.'
    )
