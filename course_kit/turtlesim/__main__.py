"""turtlesim as a process of its own: python -m course_kit.turtlesim --ros-args -r __ns:=/robot1"""

from __future__ import annotations

from rclpy.executors import SingleThreadedExecutor

from course_kit.turtlesim.node import TurtleSim
from course_kit.turtlesim.program import program


def main(args: list[str] | None = None) -> None:
    """Run the simulator until Ctrl-C or SIGTERM; exit status 0."""
    with program("turtlesim", args) as is_to_end:
        node = TurtleSim()
        executor = SingleThreadedExecutor()
        executor.add_node(node)
        while not is_to_end():
            executor.spin_once(timeout_sec=1)
        node.destroy_node()


if __name__ == "__main__":
    main()
