"""static_transform_publisher: says for good where one frame is in another.

ros2 run tf2_ros static_transform_publisher --x 0.1 --yaw 1.57 --frame-id base_link --child-frame-id laser
"""

from __future__ import annotations

import secrets
import string
import sys
from functools import partial

from geometry_msgs.msg import TransformStamped
from rcl_interfaces.msg import ParameterDescriptor
from rclpy.node import Node
from rclpy.parameter import Parameter
from tf2_ros import StaticTransformBroadcaster

from course_kit.lab.tf_tools.static_arguments import OLD_STYLE, USAGE, StaticTransform, read_arguments, wants_help
from course_kit.ros.private_api.rclpy_parts import nameless_logger
from course_kit.ros.program import own_words, program, spin_for

NAME = "static_transform_publisher"
LETTERS = string.digits + string.ascii_letters
NUMBERS = [f"translation.{axis}" for axis in "xyz"] + [f"rotation.{axis}" for axis in "xyzw"]


class StaticTransformPublisher(Node):
    """The node of one static transform, which has it as parameters. ValueError if a frame is to be in itself."""

    def __init__(self, wanted: StaticTransform) -> None:
        name = f"{NAME}_{''.join(secrets.choice(LETTERS) for _ in range(16))}"
        numbers = dict(zip(NUMBERS, (*wanted.position, *wanted.rotation), strict=True))
        given = numbers | {"frame_id": wanted.frame, "child_frame_id": wanted.child}
        super().__init__(name, parameter_overrides=[Parameter(key, value=value) for key, value in given.items()])
        for key, value in given.items():
            self.declare_parameter(key, value, ParameterDescriptor(read_only=True))
        if wanted.frame == wanted.child:
            said = f"cannot publish static transform from '{wanted.frame}' to '{wanted.child}', exiting"
            self.get_logger().error(said)
            self.destroy_node()
            raise ValueError("child_frame_id cannot equal frame_id")
        message = TransformStamped(child_frame_id=wanted.child)
        message.header.frame_id = wanted.frame
        message.header.stamp = self.get_clock().now().to_msg()
        place, turn = message.transform.translation, message.transform.rotation
        place.x, place.y, place.z = wanted.position
        turn.x, turn.y, turn.z, turn.w = wanted.rotation
        self._broadcaster = StaticTransformBroadcaster(self)
        self._broadcaster.sendTransform(message)
        self.get_logger().info(
            f"Spinning until stopped - publishing transform\ntranslation: {_quoted(wanted.position)}\n"
            f"rotation: {_quoted(wanted.rotation)}\nfrom '{wanted.frame}' to '{wanted.child}'"
        )


def _quoted(values: tuple[float, ...]) -> str:
    return "(" + ", ".join(f"'{value:f}'" for value in values) + ")"


def main(args: list[str] | None = None) -> None:
    """Publish until Ctrl-C or SIGTERM; exit status 0."""
    words = own_words(NAME, args)
    if wants_help(words):
        print(USAGE)
        return
    try:
        wanted = read_arguments(words)
    except ValueError as error:
        nameless_logger().error(f"error parsing command line arguments: {error}")
        print(USAGE)
        sys.exit(1)
    if wanted.is_old_style:
        nameless_logger().warning(OLD_STYLE)
    try:
        with program(NAME, partial(StaticTransformPublisher, wanted), args) as (_, executor, asked):
            while not asked:
                spin_for(executor, asked, 1.0)
    except ValueError as error:
        sys.exit(f"{NAME} cannot start: {error}")


if __name__ == "__main__":
    main()
