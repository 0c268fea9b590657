"""The arguments and the output of tf2_echo. Pure, no ROS."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from course_kit.lab.tf_tools.rotations import matrix, roll_pitch_yaw

USAGE = """\
Usage: tf2_echo source_frame target_frame [options]

This will echo the transform from the coordinate frame of the source_frame
to the coordinate frame of the target_frame.
Note: This is the transform to get data from target_frame into the source_frame.

Options:
  -r <rate>       Echo rate in Hz (default: 1.0)
  -t <time>       Fixed time to do the lookup (in seconds)
  -p <precision>  Output precision (default: 3)"""


class WrongArgument(ValueError):  # noqa: N818  (reads as what happened)
    """An argument that cannot be used; with the exit status for it, and whether the usage is shown."""

    def __init__(self, message: str, status: int, shows_usage: bool = False) -> None:
        super().__init__(message)
        self.status, self.shows_usage = status, shows_usage


@dataclass(frozen=True)
class Wanted:
    """What the command line asks for."""

    source: str
    target: str
    rate: float = 1.0  # Hz
    time: float | None = None  # s; None: the latest
    precision: int = 3


def read_arguments(words: list[str]) -> Wanted:
    """What the words after the program's name ask for. The rate may stand alone, as before `-r` came. WrongArgument."""
    if len(words) < 2:
        raise WrongArgument("", 1, shows_usage=True)
    source, target, *options = words
    if options and not options[0].startswith("-"):
        options.insert(0, "-r")
    rate, time, precision = 1.0, None, 3
    while options:
        option, *options = options
        if option not in ("-r", "-t", "-p") or not options:
            raise WrongArgument(f"Unknown argument: {option}", 5, shows_usage=True)
        value, *options = options
        if option == "-r":
            rate = _number(value, "rate", 2)
            if rate <= 0:
                raise WrongArgument("Rate must be positive", 2)
        elif option == "-t":
            time = _number(value, "time", 3)
        else:
            precision = _whole(value)
    return Wanted(source, target, rate, time if time is None or time >= 0 else None, precision)


def _number(value: str, what: str, status: int) -> float:
    try:
        number = float(value)
    except ValueError:
        number = math.nan
    if not math.isfinite(number):
        raise WrongArgument(f"Failed to convert {what} argument '{value}' to a floating-point number", status)
    return number


def _whole(value: str) -> int:
    try:
        precision = int(value)
    except ValueError:
        raise WrongArgument(f"Failed to convert precision argument '{value}' to an integer", 4) from None
    if precision < 0:
        raise WrongArgument("Precision must be non-negative", 4)
    return min(precision, 50)


def transform_lines(stamped: Any, precision: int = 3) -> list[str]:
    """A TransformStamped as tf2_echo prints it; as there, the nanoseconds have no leading zeros."""
    place, turn = stamped.transform.translation, stamped.transform.rotation
    position = (place.x, place.y, place.z)
    quaternion = (turn.x, turn.y, turn.z, turn.w)
    rows = matrix(quaternion)
    angles = roll_pitch_yaw(rows)

    def listed(values: Iterable[float]) -> str:
        return "[" + ", ".join(f"{value:.{precision}f}" for value in values) + "]"

    def row(values: Iterable[float]) -> str:
        return "".join(f" {value:6.{precision}f}" for value in values)

    return [
        f"At time {stamped.header.stamp.sec}.{stamped.header.stamp.nanosec}",
        f"- Translation: {listed(position)}",
        f"- Rotation: in Quaternion (xyzw) {listed(quaternion)}",
        f"- Rotation: in RPY (radian) {listed(angles)}",
        f"- Rotation: in RPY (degree) {listed(map(math.degrees, angles))}",
        "- Matrix:",
        *(row((*turned, moved)) for turned, moved in zip(rows, position, strict=True)),
        row((0.0, 0.0, 0.0, 1.0)),
    ]


def failure_lines(error: Exception, now: float, frames: str) -> list[str]:
    """What is printed where a transform is missing: when, why, and which frames there are; `now` in seconds."""
    return [f"Failure at {now:.3f}", f"Exception thrown:{error}", "The current list of frames is:", frames]
