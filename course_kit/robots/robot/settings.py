"""The parameters of the node robot: read once, when it starts."""

from __future__ import annotations

import math
from dataclasses import dataclass
from numbers import Integral, Real
from typing import Any

from rcl_interfaces.msg import ParameterDescriptor
from rclpy.node import Node

from course_kit.base.arguments import TEXT, Rule, is_text
from course_kit.robots.robot.sensors import Noise
from course_kit.robots.robot.simulation import TIMEOUT
from course_kit.robots.robot.world import Place, World
from course_kit.robots.robot.worlds import world as world_of

MOST = 1000  # times as fast as real time


def _is_world(value: Any) -> bool:
    return isinstance(value, World) or is_text(value)


def _is_place(value: Any) -> bool:
    numbers = [one for one in value if isinstance(one, Real) and not isinstance(one, bool) and math.isfinite(one)]
    return len(value) == len(numbers) == 3


WORLD = Rule("the name of a world, or a World", "'rooms'", (str, World), _is_world)
SEED = Rule("a whole number, 0 or more", "3", (Integral,), lambda value: 0 <= value < 2**63)
START = Rule("x, y in m and a heading in rad", "(1.0, 2.0, 0.0)", (tuple, list), _is_place)
FACTOR = Rule("simulated seconds a second, 0 for as fast as it goes", "5.0", (Real,), lambda value: 0 <= value <= MOST)
NOT_NEGATIVE = Rule("a number, 0 or more", "0.01", (Real,), lambda value: 0 <= value < math.inf)
SECONDS = Rule("a time in seconds, more than 0", "0.5", (Real,), lambda value: value > 0)


@dataclass(frozen=True)
class Settings:
    """What a robot is to be."""

    world: World
    start: Place | None
    factor: float | None  # None: 1, or that of the robots that are there
    stamped: bool  # whether cmd_vel is a TwistStamped
    timeout: float  # s of simulated time that a command holds
    patience: float  # s of real time that the second half of that takes at least; 0: time waits for nobody
    prefix: str  # of its frames
    noise: Noise


def check(world: Any, seed: Any, start: Any, factor: Any) -> None:
    """Raise TypeError or ValueError for what cannot be: in one sentence."""
    for name, rule, value in (
        ("world", WORLD, world),
        ("seed", SEED | None, seed),
        ("start", START | None, start),
        ("factor", FACTOR | None, factor),
    ):
        rule.check(f"Robot(): {name}", value)


def declare(node: Node, world: str | World, seed: int | None, start: Place | None, factor: float | None) -> Settings:
    """Declare the parameters with these defaults and read them. ValueError for what cannot be."""
    if isinstance(world, World) and seed is not None:
        raise ValueError(
            f"seed draws a world that is named, such as 'rooms'; the world {world.name!r} is given as it is"
        )
    name = world if isinstance(world, str) else world.name
    seed = None if seed is None else int(seed)
    place = None if start is None else list(map(float, start))  # rclpy knows no list of both kinds of numbers
    factor = None if factor is None else float(factor)
    chosen = _read(node, "world", name, WORLD, "The world: empty, rooms, maze, office")
    seed = _read(node, "seed", seed, SEED | None, "Draws another world of that kind; not set: the one of its file")
    place = _read(node, "start", place, START | None, "x, y (m) and heading (rad) at the start; not set: the world's")
    factor = _read(
        node, "factor", factor, FACTOR | None, "Simulated seconds a second, 0: as fast as it goes; not set: 1"
    )
    # The name that turtlebot3 and Nav2 have for it, and diff_drive_controller's for the next one.
    description = ParameterDescriptor(description="Whether cmd_vel is TwistStamped, else Twist", read_only=True)
    stamped = bool(node.declare_parameter("enable_stamped_cmd_vel", True, description).value)
    timeout = _read(node, "cmd_vel_timeout", TIMEOUT, SECONDS, "Simulated seconds without a command until it stops")
    patience = _read(
        node,
        "patience",
        0.0,
        NOT_NEGATIVE,
        "Real seconds for a command that is late: so long half of cmd_vel_timeout takes; 0: time waits for nobody",
    )
    namespace = node.get_namespace().strip("/")
    prefix = _read(node, "frame_prefix", f"{namespace}/" if namespace else "", TEXT, "Begins the names of its frames")
    noise = Noise(
        _read(node, "scan_noise", 0.01, NOT_NEGATIVE, "Standard deviation of the laser's ranges, m"),
        _read(node, "gyro_noise", 2e-4, NOT_NEGATIVE, "Standard deviation of the IMU's angular velocity, rad/s"),
        _read(node, "accelerometer_noise", 0.017, NOT_NEGATIVE, "Standard deviation of the IMU's acceleration, m/s²"),
    )
    there = world if isinstance(world, World) and chosen == name else world_of(chosen, seed)
    start = None if place is None else (float(place[0]), float(place[1]), float(place[2]))
    return Settings(there, start, factor, stamped, timeout, patience, prefix, noise)


def _read(node: Node, name: str, default: Any, rule: Rule, description: str) -> Any:
    # Typed by the rule: a parameter that is typed by its default would refuse 5 for 5.0, and none for not set.
    descriptor = ParameterDescriptor(description=description, read_only=True, dynamic_typing=True)
    value = node.declare_parameter(name, default, descriptor).value
    value = value.tolist() if hasattr(value, "tolist") else value
    rule.check(f"parameter {name}", value)
    return value
