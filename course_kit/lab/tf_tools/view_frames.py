"""view_frames: the tree of frames as files, for Graphviz and as PDF: `ros2 run tf2_tools view_frames`."""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path

from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from tf2_msgs.srv import FrameGraph
from tf2_ros import Buffer, TransformListener

from course_kit.base.atomic_files import NotWritten, write_whole, writing
from course_kit.lab.tf_tools.frames import dot, from_yaml
from course_kit.robots.tf.broadcasters import TF, TF_STATIC
from course_kit.ros.program import own_words, program, spin_for
from course_kit.ros.subscriptions import topics

NAME = "view_frames"


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog=NAME, description="Create a diagram of the TF frames being broadcast over ROS", allow_abbrev=False
    )
    listen = "Listen to the /tf topic for this many seconds before rendering the frame tree"
    parser.add_argument("--wait-time", "-t", type=float, default=5.0, help=listen)
    parser.add_argument("-o", "--output", help="Output filename")
    parser.add_argument("--tf_topic", default=TF, help="Topic for dynamic transforms")
    parser.add_argument("--tf_static_topic", default=TF_STATIC, help="Topic for static transforms")
    return parser


def main(args: list[str] | None = None) -> None:
    """Listen, write both files, and end with exit status 0."""
    options = _parser().parse_args(own_words(NAME, args))
    try:
        remapped = {TF: topics.absolute(options.tf_topic), TF_STATIC: topics.absolute(options.tf_static_topic)}
    except ValueError as error:
        sys.exit(f"{NAME} cannot start: {error}")
    words = [word for topic, other in remapped.items() if other != topic for word in ("-r", f"{topic}:={other}")]
    with program(NAME, lambda: Node(NAME, cli_args=["--ros-args", *words]), args) as (node, executor, asked):
        try:
            _view(options, node, executor, asked)
        except NotWritten as error:
            sys.exit(str(error))


def _view(options: argparse.Namespace, node: Node, executor: SingleThreadedExecutor, asked: list[int]) -> None:
    buffer = Buffer(node=node)
    listener = TransformListener(buffer, node)
    log = node.get_logger()
    log.info(f"Listening to tf data for {options.wait_time} seconds...")
    spin_for(executor, asked, options.wait_time)
    listener.unregister()
    if asked:
        return
    log.info("Generating graph...")
    told = buffer.all_frames_as_yaml()
    log.info(f"Result:{FrameGraph.Response(frame_yaml=told)}")
    name = options.output or time.strftime("frames_%Y-%m-%d_%H.%M.%S")
    log.info(f"Exporting graph in {name}.pdf file...")
    now = node.get_clock().now().nanoseconds * 1e-9
    write_whole(Path(f"{name}.gv"), dot(told, now).encode())
    _write_picture(f"{name}.pdf", told, now)


def _write_picture(file: str, told: str, now: float) -> None:
    from course_kit.lab.tf_tools.frame_plots import draw_frames

    with writing(file):
        draw_frames(from_yaml(told, now)).savefig(file, format="pdf")


if __name__ == "__main__":
    main()
