"""The arguments of static_transform_publisher: options, or the old row of numbers and names. Pure, no ROS."""

from __future__ import annotations

import math
from dataclasses import dataclass

from course_kit.lab.tf_tools.rotations import Quaternion, quaternion

PLACE, TURN, ANGLES = ("x", "y", "z"), ("qx", "qy", "qz", "qw"), ("roll", "pitch", "yaw")
FRAMES = ("frame-id", "child-frame-id")
USAGE = """\
usage: static_transform_publisher [--x X] [--y Y] [--z Z] [--qx QX] [--qy QY] [--qz QZ] [--qw QW] [--roll ROLL] \
[--pitch PITCH] [--yaw YAW] --frame-id FRAME_ID --child-frame-id CHILD_FRAME_ID

A command line utility for manually sending a static transform.

If no translation or orientation is provided, the identity transform will be published.

The translation offsets are in meters.

The rotation may be provided with roll, pitch, yaw euler angles in radians, or as a quaternion.

required arguments:
  --frame-id FRAME_ID parent frame
  --child-frame-id CHILD_FRAME_ID child frame id

optional arguments:
  --x X                 x component of translation
  --y Y                 y component of translation
  --z Z                 z component of translation
  --qx QX               x component of quaternion rotation
  --qy QY               y component of quaternion rotation
  --qz QZ               z component of quaternion rotation
  --qw QW               w component of quaternion rotation
  --roll ROLL           roll component Euler rotation
  --pitch PITCH         pitch component Euler rotation
  --yaw YAW             yaw component Euler rotation"""
OLD_STYLE = "Old-style arguments are deprecated; see --help for new-style arguments"


@dataclass(frozen=True)
class StaticTransform:
    """Where a frame is in another one, for good: metres, and a quaternion as it was given."""

    frame: str
    child: str
    position: tuple[float, float, float]
    rotation: Quaternion
    is_old_style: bool = False


def wants_help(words: list[str]) -> bool:
    """Return True if the command line asks for the usage only."""
    return "--help" in words or "-h" in words


def read_arguments(words: list[str]) -> StaticTransform:
    """What the words after the program's name ask for. ValueError, with the sentence of the real program.

    The old style is a row: x y z yaw pitch roll, or x y z qx qy qz qw, then the two frames.
    """
    given, row = _split(words)
    numbers = {name: _number(f"--{name}", text) for name, text in given.items() if name not in FRAMES}
    frame, child = (given.get(name, "") for name in FRAMES)
    if numbers.keys() & {*TURN} and numbers.keys() & {*ANGLES}:
        raise ValueError("Cannot specify both quaternion and Euler rotations")
    is_old_style = len(row) in (8, 9)
    if is_old_style:
        if given:
            raise ValueError("Cannot specify both new-style (flags) and old-style (arguments)")
        names = (*PLACE, *(ANGLES[::-1] if len(row) == 8 else TURN))
        *values, frame, child = row
        numbers = {name: _number(name, text) for name, text in zip(names, values, strict=True)}
    elif row:
        raise ValueError("Extra unparsed arguments on command-line")
    if not frame:
        raise ValueError("Frame id must not be empty")
    if not child:
        raise ValueError("Child frame id must not be empty")
    x, y, z = (numbers.get(name, 0.0) for name in PLACE)
    roll, pitch, yaw = (numbers.get(name, 0.0) for name in ANGLES)
    qx, qy, qz = (numbers.get(name, 0.0) for name in TURN[:3])
    is_turned = bool(numbers.keys() & {*ANGLES})
    turn = quaternion(roll, pitch, yaw) if is_turned else (qx, qy, qz, numbers.get("qw", 1.0))
    return StaticTransform(frame, child, (x, y, z), turn, is_old_style)


def _split(words: list[str]) -> tuple[dict[str, str], list[str]]:
    """The values of options by name, the last of each, and what is no option."""
    known = {f"--{name}": name for name in (*PLACE, *TURN, *ANGLES, *FRAMES)}
    given: dict[str, str] = {}
    row: list[str] = []
    left = iter(words)
    for word in left:
        if word not in known:
            row.append(word)
            continue
        value = next(left, None)
        if value is None:
            raise ValueError(f"Not enough arguments for {word}")
        given[known[word]] = value
    return given, row


def _number(what: str, text: str) -> float:
    try:
        number = float(text)
    except ValueError:
        number = math.nan
    if not math.isfinite(number):  # a transform that is no number is ignored by every listener
        raise ValueError(f"Failed to parse {what} argument as float")
    return number
