"""tf2_echo: where one frame is in another, again and again: `ros2 run tf2_ros tf2_echo map base_link`."""

from __future__ import annotations

import sys

from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.time import Time
from tf2_ros import Buffer, TransformException, TransformListener

from course_kit.lab.tf_tools.echo_text import (
    USAGE,
    Wanted,
    WrongArgument,
    failure_lines,
    read_arguments,
    transform_lines,
)
from course_kit.lab.tf_tools.waiting import wait_for_transform
from course_kit.ros.program import own_words, program, spin_for

NAME = "tf2_echo"


def main(args: list[str] | None = None) -> None:
    """Echo until Ctrl-C or SIGTERM; exit status 0."""
    try:
        wanted = read_arguments(own_words(NAME, args))
    except WrongArgument as error:
        if str(error):
            print(error, file=sys.stderr)
        if error.shows_usage:
            print(USAGE)
        sys.exit(error.status)
    with program(NAME, lambda: Node(NAME), args) as (node, executor, asked):
        _echo(wanted, node, executor, asked)


def _echo(wanted: Wanted, node: Node, executor: SingleThreadedExecutor, asked: list[int]) -> None:
    buffer = Buffer()
    listener = TransformListener(buffer, node)
    time = Time() if wanted.time is None else Time(nanoseconds=int(wanted.time * 1e9))
    wait_for_transform(buffer, (wanted.source, wanted.target), time, node, executor, asked, 1.0 / wanted.rate)
    while not asked:
        try:
            lines = transform_lines(buffer.lookup_transform(wanted.source, wanted.target, time), wanted.precision)
        except TransformException as error:
            lines = failure_lines(error, node.get_clock().now().nanoseconds * 1e-9, buffer.all_frames_as_string())
        print("\n".join(lines), flush=True)
        spin_for(executor, asked, 1.0 / wanted.rate)
    listener.unregister()


if __name__ == "__main__":
    main()
